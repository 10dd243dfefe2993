// The page: what is chosen goes to the worker, what the worker makes is shown.

import { Controls } from './controls.js';
import { Curve } from './curve.js';
import { FileDrop } from './files.js';
import { Hands } from './hands.js';
import { byId, problem } from './elements.js';
import { Method } from './method.js';
import { Picture } from './picture.js';

// Milliseconds without a movement after which the camera is at rest.
const REST = 250;

const worker = new Worker('worker.js', { type: 'module' });
const picture = new Picture();
const curve = new Curve();
const controls = new Controls();
const method = new Method((message) => worker.postMessage(message));
// Which order a picture follows: those of orders before are not shown.
let number = 0;
let isMoving = false;
let resting;
let pixel = null;

function order(message) {
  number += 1;
  worker.postMessage({ number, ...message });
}

function move(motion) {
  isMoving = true;
  order({ kind: 'move', motion });
  clearTimeout(resting);
  resting = setTimeout(rest, REST);
}

function rest() {
  isMoving = false;
  curve.clear();
  order({ kind: 'rest' });
}

function open() {
  controls.setOpening();
  curve.clear();
  order({ kind: 'open', scene: controls.scene(), choices: controls.choices() });
}

// What is open is gone with the device.
function setDevice() {
  controls.setOpening();
  worker.postMessage({ kind: 'device', name: controls.computer() });
}

function choose() {
  curve.clear();
  order({ kind: 'choose', choices: controls.choices() });
}

function show() {
  worker.postMessage({ kind: 'show', layer: controls.layer(), exposure: controls.exposure() });
}

function inspect() {
  if (pixel) {
    worker.postMessage({ kind: 'inspect', x: pixel[0], y: pixel[1] });
  }
}

// Renders unless it was told to pause, or something else is looked at.
function pause() {
  const paused = controls.isPaused() || byId('render').hidden;
  worker.postMessage({ kind: 'pause', paused });
}

function view(name) {
  for (const each of ['render', 'method']) {
    byId(each).hidden = each !== name;
    byId(`to-${each}`).setAttribute('aria-pressed', String(each === name));
  }
  pause();
  if (name === 'method') {
    method.open();
  }
}

const told = {
  known(known) {
    controls.fill(known);
    method.fill(known);
    open();
  },
  device({ name, device, why }) {
    controls.setDevice(name, device, why);
    open();
    method.setDevice(name);
  },
  found({ scene }) {
    controls.addScene(scene);
    method.addScene(scene);
    open();
  },
  compiling({ kernels }) {
    controls.setCompiling(kernels);
  },
  scene(facts) {
    controls.setScene(facts);
  },
  picture(shown) {
    if (shown.number !== number) {
      return;
    }
    problem(null);
    picture.show(shown);
    document.documentElement.dataset.samples = shown.samples;
    if (!isMoving && !shown.moving) {
      curve.add(shown);
      inspect();
    }
  },
  pixel({ rows }) {
    picture.showPixel(rows);
  },
  round(told) {
    problem(null);
    method.show(told);
  },
  problem({ message }) {
    problem(message);
    method.failed();
  },
};

worker.addEventListener('message', ({ data }) => told[data.kind]?.(data));
worker.addEventListener('error', (event) => problem(event.message || 'the worker has failed'));

controls.onDevice = setDevice;
controls.onScene = open;
controls.onChoice = choose;
controls.onLayer = show;
controls.onPause = pause;
controls.onReset = () => move({ reset: true });
controls.onSave = () => picture.save(controls.scene());
new Hands(byId('picture'), {
  move,
  pick: (place) => {
    pixel = picture.pixel(place);
    inspect();
  },
  key: (key) => controls.key(key),
});
new FileDrop((files) => {
  problem(null);
  worker.postMessage({ kind: 'files', files }, files.map(([, buffer]) => buffer));
}, problem);
byId('to-render').addEventListener('click', () => view('render'));
byId('to-method').addEventListener('click', () => view('method'));
