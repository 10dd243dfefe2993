// What a person chooses.

import { addFile, byId, element, list } from './elements.js';

const CHOICES = ['width', 'allocator', 'estimator', 'integrator', 'filter', 'samples', 'relative'];

export class Controls {
  #scenes = [];
  #layer = 'Beauty';
  #isPaused = false;
  onDevice = () => {};
  onScene = () => {};
  onChoice = () => {};
  onLayer = () => {};
  onPause = () => {};
  onReset = () => {};
  onSave = () => {};

  constructor() {
    byId('computer').addEventListener('change', () => this.onDevice());
    byId('scene').addEventListener('change', () => this.onScene());
    for (const id of CHOICES) {
      byId(id).addEventListener('change', () => this.onChoice());
    }
    byId('exposure').addEventListener('input', () => this.onLayer());
    byId('pause').addEventListener('click', () => this.#pause());
    byId('reset').addEventListener('click', () => this.onReset());
    byId('save').addEventListener('click', () => this.onSave());
    byId('controls').addEventListener('submit', (event) => event.preventDefault());
  }

  // Fills the lists with what there is.
  fill({ scenes, allocators, estimators, integrators, filters, layers, device }) {
    this.#scenes = scenes;
    list('scene', scenes.map(({ name }) => name));
    list('allocator', allocators, 'runs');
    list('estimator', estimators, 'bilateral');
    list('integrator', integrators, 'auto');
    list('filter', filters);
    byId('filter').prepend(new Option('none', '', true, true));
    byId('layers').replaceChildren(...layers.map((name, index) => {
      const title = `${name} (key ${index + 1})`;
      const button = element('button', { type: 'button', title, 'data-layer': name }, name);
      button.addEventListener('click', () => this.setLayer(name));
      return button;
    }));
    this.#press();
    this.setDevice('cpu', device, null);
  }

  // Says which kernels the browser compiles.
  setCompiling(kernels) {
    const names = kernels.join(', ');
    byId('compiling').textContent = names ? `The browser compiles ${names}` : '';
  }

  // A scene of files, which is chosen from now on.
  addScene(name) {
    addFile('scene', name).value = name;
  }

  computer() {
    return byId('computer').value;
  }

  // Says what renders, and why it is not what was chosen.
  setDevice(name, device, why) {
    byId('computer').value = name;
    const by = name === 'cpu' ? `${device}, in WebAssembly` : device;
    const reason = why ? ` There is no GPU: ${why}.` : '';
    byId('device').textContent = `Rendered by ${by}.${reason}`;
    document.documentElement.dataset.device = name;
  }

  scene() {
    return byId('scene').value;
  }

  layer() {
    return this.#layer;
  }

  isPaused() {
    return this.#isPaused;
  }

  exposure() {
    return Number(byId('exposure').value);
  }

  choices() {
    const value = (id) => byId(id).value;
    return {
      width: Number(value('width')),
      allocator: value('allocator'),
      estimator: value('estimator'),
      integrator: value('integrator'),
      filter: value('filter') || null,
      relative: byId('relative').checked,
      samples: value('samples') ? Number(value('samples')) : null,
      seed: 0,
    };
  }

  setLayer(name) {
    this.#layer = name;
    if (name === 'Denoised' && !byId('filter').value) {
      byId('filter').value = 'auto';
      this.onChoice();
    }
    this.#press();
    this.onLayer();
  }

  setOpening() {
    byId('scene-note').textContent = 'Loading the scene';
  }

  setScene({ name, triangles, warnings }) {
    const known = this.#scenes.find((scene) => scene.name === this.scene());
    const what = known ? `${known.description}. ` : `${name}. `;
    const unit = triangles === 1 ? 'triangle' : 'triangles';
    const count = `${triangles.toLocaleString('en')} ${unit}. `;
    byId('scene-note').textContent = what + count + warnings.join(' ');
  }

  // A key that was pressed on the picture. Returns whether it is one of ours.
  key(key) {
    const button = byId('layers').children[Number(key) - 1];
    if (button) {
      this.setLayer(button.dataset.layer);
    } else if (key === ' ') {
      this.#pause();
    } else if (key.toLowerCase() === 'r') {
      this.onReset();
    } else {
      return false;
    }
    return true;
  }

  #pause() {
    this.#isPaused = !this.#isPaused;
    byId('pause').textContent = this.#isPaused ? 'Go on' : 'Pause';
    this.onPause();
  }

  #press() {
    for (const button of byId('layers').children) {
      button.setAttribute('aria-pressed', String(button.dataset.layer === this.#layer));
    }
  }
}
