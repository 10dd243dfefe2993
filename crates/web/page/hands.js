// What hands do with the picture: pointers, the wheel and keys, as movements of the camera.

// Radians that the camera turns for a height of the picture.
const TURN = 3;
// Radians for a key.
const STEP = 0.08;
// A pointer that has gone no farther has clicked.
const CLICK = 4;

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const NEARER = { '+': 1.1, '=': 1.1, '-': 1 / 1.1, _: 1 / 1.1 };

export class Hands {
  #canvas;
  #does;
  // Where pointers are that are down.
  #pointers = new Map();
  #travelled = 0;

  // `does` has `move` (a movement), `pick` (a place on the canvas) and `key` (whether it is known).
  constructor(canvas, does) {
    this.#canvas = canvas;
    this.#does = does;
    canvas.addEventListener('pointerdown', (event) => this.#down(event));
    canvas.addEventListener('pointermove', (event) => this.#moved(event));
    canvas.addEventListener('pointerup', (event) => this.#up(event));
    canvas.addEventListener('pointercancel', (event) => this.#pointers.delete(event.pointerId));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener('keydown', (event) => this.#key(event));
  }

  #down(event) {
    this.#canvas.setPointerCapture(event.pointerId);
    this.#canvas.focus({ preventScroll: true });
    this.#pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
    this.#travelled = this.#pointers.size > 1 ? Infinity : 0;
  }

  #moved(event) {
    const before = this.#pointers.get(event.pointerId);
    if (!before) {
      return;
    }
    const now = [event.offsetX, event.offsetY];
    const other = [...this.#pointers].find(([id]) => id !== event.pointerId)?.[1];
    this.#pointers.set(event.pointerId, now);
    const step = [now[0] - before[0], now[1] - before[1]];
    this.#travelled += Math.hypot(...step);
    if (other) {
      const distance = (place) => Math.max(Math.hypot(place[0] - other[0], place[1] - other[1]), 1);
      this.#does.move({ zoom: distance(now) / distance(before) });
    } else if (this.#travelled > CLICK) {
      this.#drag(step, event.shiftKey || (event.buttons & 2) !== 0);
    }
  }

  #drag(step, isAcross) {
    const parts = step.map((way) => way / this.#canvas.clientHeight);
    this.#does.move(isAcross ? { pan: parts } : { orbit: parts.map((part) => TURN * part) });
  }

  #up(event) {
    if (this.#pointers.delete(event.pointerId) && this.#travelled <= CLICK) {
      this.#does.pick([event.offsetX, event.offsetY]);
    }
  }

  #wheel(event) {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1);
    this.#does.move({ zoom: Math.exp(-0.0015 * Math.max(-400, Math.min(400, pixels))) });
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) {
      return;
    }
    const arrow = ARROWS[event.key];
    if (arrow) {
      const step = arrow.map((way) => STEP * way);
      this.#does.move(event.shiftKey ? { pan: step } : { orbit: step });
    } else if (NEARER[event.key]) {
      this.#does.move({ zoom: NEARER[event.key] });
    } else if (!this.#does.key(event.key)) {
      return;
    }
    event.preventDefault();
  }
}
