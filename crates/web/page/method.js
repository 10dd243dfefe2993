// The method step by step: the stages of a round, one at a time.

import { addFile, byId, element, list } from './elements.js';
import { legend, paint } from './picture.js';

const CHOICES = ['scene', 'width', 'allocator', 'estimator', 'budget', 'relative', 'beside'];

export class Method {
  #tell;
  // Stages of the round that is shown, with the pixels of their pictures.
  #stages = [];
  #round = 0;
  #at = 0;
  // Which render a round must be of to be shown.
  #number = 0;
  #isWaiting = false;
  #isOpen = false;
  #isKnown = false;

  // `tell` tells the worker something.
  constructor(tell) {
    this.#tell = tell;
    for (const choice of CHOICES) {
      byId(`method-${choice}`).addEventListener('change', () => this.#begin());
    }
    byId('back').addEventListener('click', () => this.#go(-1));
    byId('next').addEventListener('click', () => this.#go(1));
    byId('next-round').addEventListener('click', () => this.#next());
    byId('method-controls').addEventListener('submit', (event) => event.preventDefault());
    byId('method').addEventListener('keydown', (event) => this.#key(event));
  }

  // Fills the lists with what there is.
  fill({ scenes, allocators, estimators }) {
    list('method-scene', scenes.map(({ name }) => name));
    list('method-allocator', allocators, 'runs');
    list('method-estimator', estimators, 'bilateral');
    this.#isKnown = true;
    this.#mayBegin();
  }

  // A scene of files. If the one that was looked at is gone, another one begins.
  addScene(name) {
    const before = byId('method-scene').value;
    const place = addFile('method-scene', name);
    if (byId('method').hidden && place.querySelector(`option[value="${CSS.escape(before)}"]`)) {
      place.value = before;
      return;
    }
    place.value = name;
    if (this.#number > 0) {
      this.#begin();
    }
  }

  // What is computed on has changed: all begins anew.
  setDevice(name) {
    byId('method-beside').disabled = name !== 'webgpu';
    if (this.#number > 0) {
      this.#begin();
    }
  }

  // It is looked at.
  open() {
    byId('method').focus({ preventScroll: true });
    this.#isOpen = true;
    this.#mayBegin();
  }

  // Begins the first render once it is looked at and there is something to choose.
  #mayBegin() {
    if (this.#isOpen && this.#isKnown && this.#number === 0) {
      this.#begin();
    }
  }

  #begin() {
    const value = (choice) => byId(`method-${choice}`).value;
    const choices = {
      width: Number(value('width')),
      allocator: value('allocator'),
      estimator: value('estimator'),
      relative: byId('method-relative').checked,
      budget: Number(value('budget')),
      beside: byId('method-beside').checked && !byId('method-beside').disabled,
    };
    this.#number += 1;
    this.#tell({ kind: 'method', scene: value('scene'), choices });
    this.#ask();
  }

  #next() {
    if (!this.#isWaiting) {
      this.#ask();
    }
  }

  #ask() {
    this.#isWaiting = true;
    byId('method').setAttribute('aria-busy', 'true');
    this.#tell({ kind: 'round', number: this.#number });
  }

  // A round has been rendered.
  show({ number, round, stages, pixels }) {
    if (number !== this.#number) {
      return;
    }
    this.failed();
    let first = 0;
    const take = (picture) => {
      const length = 4 * picture.size[0] * picture.size[1];
      const part = pixels.slice(first, first + length);
      first += length;
      return { ...picture, pixels: part };
    };
    this.#stages = stages.map((stage) => ({ ...stage, pictures: stage.pictures.map(take) }));
    [this.#round, this.#at] = [round, 0];
    const button = ({ name }, index) => {
      const made = element('button', { type: 'button', 'data-stage': name }, name);
      made.addEventListener('click', () => this.#show(index));
      return made;
    };
    byId('stages').replaceChildren(...this.#stages.map(button));
    if (document.activeElement === document.body) {
      byId('method').focus({ preventScroll: true });
    }
    this.#show(0);
  }

  // Nothing is waited for any more.
  failed() {
    this.#isWaiting = false;
    byId('method').removeAttribute('aria-busy');
  }

  #go(step) {
    const to = this.#at + step;
    if (to >= this.#stages.length) {
      this.#next();
    } else if (to >= 0) {
      this.#show(to);
    }
  }

  #show(index) {
    this.#at = index;
    const { name, text, facts, pictures, kernels, beside } = this.#stages[index];
    byId('stage-name').textContent =
      `Round ${this.#round}, stage ${index + 1} of ${this.#stages.length}: ${name}`;
    byId('stage-text').textContent = text;
    byId('stage-pictures').replaceChildren(...pictures.map(figure));
    byId('stage-facts').replaceChildren(...facts.flatMap(({ key, label, value }) => [
      element('dt', {}, label), element('dd', { 'data-fact': key }, value),
    ]));
    const by = kernels.length > 0 ? `Kernels: ${kernels.join(', ')}. ` : '';
    byId('stage-beside').textContent = by + (kernels.length > 0 ? beside?.text ?? '' : '');
    byId('stage-beside').dataset.same = String(beside?.same);
    for (const [at, button] of [...byId('stages').children].entries()) {
      button.setAttribute('aria-pressed', String(at === index));
    }
    byId('back').disabled = index === 0;
    const isLast = index + 1 === this.#stages.length;
    byId('next').textContent = isLast ? 'Next round' : 'Next';
    byId('next-round').hidden = isLast;
    Object.assign(byId('method').dataset, { round: this.#round, stage: name });
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches('select, input')) {
      return;
    }
    if (event.key === 'ArrowRight') {
      this.#go(1);
    } else if (event.key === 'ArrowLeft') {
      this.#go(-1);
    } else if (event.key.toLowerCase() === 'n') {
      this.#next();
    } else {
      return;
    }
    event.preventDefault();
  }
}

// A picture with its legend and what it shows.
function figure({ size: [width, height], pixels, title, ticks, colors }) {
  const canvas = element('canvas', { role: 'img', 'aria-label': title });
  paint(canvas, width, height, pixels);
  const bar = element('canvas', { 'aria-hidden': 'true' });
  const marks = element('div', { class: 'ticks' });
  const place = element('div', { class: 'legend' }, bar, marks);
  legend(place, bar, marks, ticks, colors);
  return element('figure', {}, canvas, place, element('figcaption', {}, title));
}
