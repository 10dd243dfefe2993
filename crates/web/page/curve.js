// The error of the picture over time, both logarithmic.

import { byId, drawn } from './elements.js';

const [LEFT, RIGHT, TOP, BOTTOM] = [46, 292, 8, 98];
// Points at most: where there are more, every other one goes.
const MOST = 256;

const percent = (error) => `${Number((100 * error).toPrecision(2))} %`;
const seconds = (time) => `${Number(time.toPrecision(2))} s`;

export class Curve {
  #points = [];

  clear() {
    this.#points = [];
    this.#draw();
  }

  // Adds what is known of a picture.
  add({ seconds, relative_error: error }) {
    if (!(error > 0) || !(seconds > 0)) {
      return;
    }
    this.#points.push([seconds, error]);
    if (this.#points.length > MOST) {
      this.#points = this.#points.filter((_, index) => index % 2 === 1);
    }
    this.#draw();
  }

  #draw() {
    const svg = byId('curve');
    const axis = drawn('line', { x1: LEFT, x2: RIGHT, y1: BOTTOM, y2: BOTTOM });
    svg.replaceChildren(axis);
    if (this.#points.length < 2) {
      return;
    }
    const [xs, ys] = [0, 1].map((i) => span(this.#points.map((point) => Math.log(point[i]))));
    const place = ([time, error]) => [
      LEFT + (RIGHT - LEFT) * along(xs, Math.log(time)),
      BOTTOM + (TOP - BOTTOM) * along(ys, Math.log(error)),
    ].map((number) => number.toFixed(1)).join(' ');
    svg.append(drawn('path', { d: `M ${this.#points.map(place).join(' L ')}` }));
    const text = (x, y, anchor, words) => {
      svg.append(drawn('text', { x, y, 'text-anchor': anchor }, words));
    };
    text(LEFT - 4, TOP + 8, 'end', percent(Math.exp(ys[1])));
    text(LEFT - 4, BOTTOM, 'end', percent(Math.exp(ys[0])));
    text(LEFT, BOTTOM + 14, 'start', seconds(Math.exp(xs[0])));
    text(RIGHT, BOTTOM + 14, 'end', seconds(Math.exp(xs[1])));
  }
}

const span = (numbers) => [Math.min(...numbers), Math.max(...numbers)];
const along = ([low, high], number) => (high > low ? (number - low) / (high - low) : 0.5);
