// The picture, its legend, and what is known of one of its pixels.

import { byId, element } from './elements.js';

export class Picture {
  #canvas = byId('picture');

  // Shows what the worker has painted.
  show({ size: [width, height], pixels, title, ticks, colors, progress, done }) {
    paint(this.#canvas, width, height, pixels);
    byId('title').textContent = title;
    byId('status').textContent = done ? `${progress}   done` : progress;
    legend(byId('legend'), byId('legend-bar'), byId('legend-ticks'), ticks, colors);
  }

  // The pixel at a place of the canvas on the screen; null outside of the picture.
  pixel([x, y]) {
    const { width, height, clientWidth, clientHeight } = this.#canvas;
    const scale = Math.min(clientWidth / width, clientHeight / height);
    const column = Math.floor((x - (clientWidth - scale * width) / 2) / scale);
    const row = Math.floor((y - (clientHeight - scale * height) / 2) / scale);
    const isInside = column >= 0 && row >= 0 && column < width && row < height;
    return isInside ? [column, row] : null;
  }

  showPixel(rows) {
    const entry = ([name, value]) => [element('dt', {}, name), element('dd', {}, value)];
    const entries = rows.flatMap(entry);
    byId('pixel').replaceChildren(...entries);
  }

  // Has the browser save the picture as it is shown.
  save(name) {
    this.#canvas.toBlob((blob) => {
      const link = element('a', { href: URL.createObjectURL(blob), download: `${name}.png` });
      link.click();
      URL.revokeObjectURL(link.href);
    });
  }
}

// Puts pixels on a canvas, of their own size.
export function paint(canvas, width, height, pixels) {
  if (canvas.width !== width || canvas.height !== height) {
    [canvas.width, canvas.height] = [width, height];
  }
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.putImageData(new ImageData(pixels, width, height), 0, 0);
}

// Shows which colours stand for which numbers; hides the place where there are none.
export function legend(place, bar, marks, ticks, colors) {
  place.hidden = colors.length === 0 || ticks.length === 0;
  if (place.hidden) {
    return;
  }
  const pixels = new Uint8ClampedArray(colors.flatMap(([r, g, b]) => [r, g, b, 255]));
  paint(bar, colors.length, 1, pixels);
  marks.replaceChildren(...ticks.map(([place, text]) => {
    const style = `left: ${100 * place}%; transform: translateX(${-100 * place}%)`;
    return element('span', { style }, text);
  }));
}
