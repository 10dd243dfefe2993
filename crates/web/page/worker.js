// The worker that renders: it does what the page tells it, and renders when it is told nothing.

import { Engine } from './engine.js';

// Milliseconds of rendering between two looks at what the page says.
const TURN = 50;
// Milliseconds between two pictures; the first come sooner.
const INTERVAL = 200;

// What can be asked without an open scene.
const APART = ['open', 'show', 'pause', 'method', 'round', 'device', 'files', 'ask'];

const waiting = [];
let wake = () => {};
let engine;
const shown = { layer: 'Beauty', exposure: 0 };
let isOpen = false;
let isPaused = false;
let hasMore = false;
let number = 0;
let first = 0;
let last = 0;

addEventListener('message', ({ data }) => {
  waiting.push(data);
  wake();
});

// Lets messages in.
const breathe = () => new Promise((resolve) => {
  const { port1, port2 } = new MessageChannel();
  port1.onmessage = () => {
    port1.close();
    resolve();
  };
  port2.postMessage(null);
});

async function paint() {
  const picture = await engine.ask({ ask: 'paint', ...shown });
  const pixels = engine.pixels(picture.size);
  last = performance.now();
  postMessage({ kind: 'picture', number, layer: shown.layer, ...picture, pixels }, [pixels.buffer]);
}

function begin(to) {
  number = to;
  hasMore = true;
  first = performance.now();
  last = 0;
}

const does = {
  async open({ scene, choices, number }) {
    isOpen = false;
    const facts = await engine.ask({ ask: 'open', scene, choices });
    isOpen = true;
    begin(number);
    postMessage({ kind: 'scene', ...facts });
  },
  // Keeps files that were given, in place of those before.
  async files({ files }) {
    engine.setFiles(files.map(([name, buffer]) => [name, new Uint8Array(buffer)]));
    postMessage({ kind: 'found', ...await engine.ask({ ask: 'found' }) });
  },
  // Computes on another device; on the CPU if that is not there.
  async device({ name }) {
    isOpen = false;
    let why = null;
    if (name === 'webgpu') {
      try {
        const onCompile = (kernels) => postMessage({ kind: 'compiling', kernels });
        await engine.openGpu('kernels.json.gz', onCompile);
      } catch (error) {
        [name, why] = ['cpu', error.message];
      }
    }
    const { device } = await engine.ask({ ask: 'device', name });
    postMessage({ kind: 'device', name, device, why });
  },
  async choose({ choices, number }) {
    await engine.ask({ ask: 'choose', choices });
    begin(number);
  },
  async move({ motion, number }) {
    await engine.ask({ ask: 'move', ...motion });
    begin(number);
  },
  async rest({ number }) {
    await engine.ask({ ask: 'rest' });
    begin(number);
  },
  async show({ layer, exposure }) {
    Object.assign(shown, { layer, exposure });
    if (isOpen && last > 0) {
      await paint();
    }
  },
  async pause({ paused }) {
    isPaused = paused;
  },
  async inspect({ x, y }) {
    postMessage({ kind: 'pixel', rows: await engine.ask({ ask: 'inspect', x, y }) });
  },
  async method({ scene, choices }) {
    await engine.ask({ ask: 'method', scene, choices });
  },
  async round({ number }) {
    const told = await engine.ask({ ask: 'round' });
    const sizes = told.stages.flatMap(({ pictures }) => pictures.map(({ size }) => size));
    const count = sizes.reduce((sum, [width, height]) => sum + width * height, 0);
    const pixels = engine.pixels([count, 1]);
    postMessage({ kind: 'round', number, ...told, pixels }, [pixels.buffer]);
  },
  // Any other question, for an answer.
  async ask({ question, id }) {
    postMessage({ kind: 'answer', id, answer: await engine.ask(question) });
  },
};

// Movements that wait are one movement.
function joined(message) {
  while (message.kind === 'move' && waiting[0]?.kind === 'move') {
    const { motion, number } = waiting.shift();
    const [before, after] = [message.motion, motion];
    const sum = (key) => [0, 1].map((i) => (before[key]?.[i] ?? 0) + (after[key]?.[i] ?? 0));
    const zoom = (message.motion.zoom ?? 1) * (motion.zoom ?? 1);
    const reset = Boolean(message.motion.reset || motion.reset);
    const both = { orbit: sum('orbit'), pan: sum('pan'), zoom, reset };
    message = { kind: 'move', number, motion: both };
  }
  return message;
}

async function render() {
  const { more } = await engine.ask({ ask: 'render', milliseconds: last === 0 ? 1 : TURN });
  hasMore = more;
  const now = performance.now();
  const interval = now - first < 2000 ? INTERVAL / 2 : INTERVAL;
  if (!more || now - last >= interval) {
    await paint();
  }
}

async function turn() {
  if (waiting.length > 0) {
    const message = joined(waiting.shift());
    if (isOpen || APART.includes(message.kind)) {
      await does[message.kind](message);
    }
  } else if (isOpen && hasMore && !isPaused) {
    await render();
    await breathe();
  } else {
    await new Promise((resolve) => {
      wake = resolve;
    });
  }
}

async function run() {
  engine = await Engine.load('raystream.wasm.gz');
  postMessage({ kind: 'known', ...await engine.ask({ ask: 'known' }) });
  for (;;) {
    try {
      await turn();
    } catch (error) {
      hasMore = false;
      postMessage({ kind: 'problem', message: error.message });
    }
  }
}

run().catch((error) => postMessage({ kind: 'problem', message: error.message }));
