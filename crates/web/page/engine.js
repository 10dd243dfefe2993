// The library, as WebAssembly: questions and answers as objects.

import { Gpu, missing } from './gpu.js';

const decoder = new TextDecoder();
const encoder = new TextEncoder();

export class Engine {
  #exports;
  #ask;
  #state;

  constructor(exports, state) {
    this.#exports = exports;
    this.#state = state;
    // Where WebAssembly cannot wait, no GPU is opened, and nothing waits.
    this.#ask = missing() ? exports.ask : WebAssembly.promising(exports.ask);
  }

  // Loads the library from an address, where it is as gzip.
  static async load(address) {
    const state = { memory: null, gpu: null };
    const text = (first, bytes) =>
      decoder.decode(new Uint8Array(state.memory.buffer, first, bytes));
    const imports = {
      raystream: {
        now: () => performance.now(),
        random: (first, bytes) => {
          crypto.getRandomValues(new Uint8Array(state.memory.buffer, first, bytes));
        },
        report: (first, bytes) => {
          throw new Error(`a part of the program has failed: ${text(first, bytes)}`);
        },
      },
      raystream_gpu: gpuImports(state, text),
    };
    const file = await fetch(address);
    if (!file.ok) {
      throw new Error(`${address} cannot be loaded: ${file.status}`);
    }
    const module = file.body.pipeThrough(new DecompressionStream('gzip'));
    const response = new Response(module, { headers: { 'Content-Type': 'application/wasm' } });
    const { instance } = await WebAssembly.instantiateStreaming(response, imports);
    state.memory = instance.exports.memory;
    return new Engine(instance.exports, state);
  }

  #bytes(first, length) {
    return new Uint8Array(this.#exports.memory.buffer, first, length);
  }

  #put(...parts) {
    const length = parts.reduce((sum, part) => sum + part.length, 0);
    const input = this.#bytes(this.#exports.reserve(length), length);
    let at = 0;
    for (const part of parts) {
      input.set(part, at);
      at += part.length;
    }
  }

  // The answer to a question; an error where that is one.
  async ask(question) {
    this.#put(encoder.encode(JSON.stringify(question)));
    const length = await this.#ask();
    const answer = JSON.parse(decoder.decode(this.#bytes(this.#exports.answer_first(), length)));
    if (answer !== null && typeof answer.error === 'string') {
      throw new Error(answer.error);
    }
    return answer;
  }

  // Opens the browser's GPU, if that has not been done; `kernels` is the address of what it runs.
  // `onCompile` is told which kernels the browser compiles.
  async openGpu(kernels, onCompile) {
    const reason = missing();
    if (reason) {
      throw new Error(reason);
    }
    if (!this.#state.gpu || this.#state.gpu.isLost()) {
      this.#state.gpu = await Gpu.open(() => this.#exports.memory.buffer, kernels);
      this.#state.gpu.onCompile = onCompile;
      await this.ask({ ask: 'gpu', ...this.#state.gpu.facts() });
    }
  }

  // A copy of the pixels that were painted last, four bytes each.
  pixels([width, height]) {
    const length = 4 * width * height;
    return new Uint8ClampedArray(this.#bytes(this.#exports.pixels_first(), length));
  }

  // Keeps files for a scene that is opened later, in place of those before: pairs of a name and
  // bytes.
  setFiles(files) {
    this.#exports.clear_files();
    for (const [name, bytes] of files) {
      const encoded = encoder.encode(name);
      this.#put(encoded, bytes);
      this.#exports.add_file(encoded.length);
    }
  }
}

// What the library imports for a GPU. What returns a promise has the library wait for it.
function gpuImports(state, text) {
  const waiting = (call) => (missing() ? call : new WebAssembly.Suspending(call));
  let failure = new Uint8Array();
  return {
    allocate: waiting((bytes) => state.gpu.allocate(bytes)),
    free: (buffer) => state.gpu.free(buffer),
    write: (...which) => state.gpu.write(...which),
    read: waiting((...which) => state.gpu.read(...which)),
    run: waiting((first, bytes, ...parameters) => state.gpu.run(text(first, bytes), parameters)),
    failure: () => {
      failure = encoder.encode(state.gpu.failure() ?? '');
      return failure.length;
    },
    failure_text: (first) => {
      new Uint8Array(state.memory.buffer, first, failure.length).set(failure);
    },
  };
}
