// The library, as WebAssembly: questions and answers as objects.

const decoder = new TextDecoder();
const encoder = new TextEncoder();

export class Engine {
  #exports;

  constructor(exports) {
    this.#exports = exports;
  }

  // Loads the library from an address, where it is as gzip.
  static async load(address) {
    const state = { memory: null };
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
    };
    const file = await fetch(address);
    if (!file.ok) {
      throw new Error(`${address} cannot be loaded: ${file.status}`);
    }
    const module = file.body.pipeThrough(new DecompressionStream('gzip'));
    const response = new Response(module, { headers: { 'Content-Type': 'application/wasm' } });
    const { instance } = await WebAssembly.instantiateStreaming(response, imports);
    state.memory = instance.exports.memory;
    return new Engine(instance.exports);
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
    const length = await this.#exports.ask();
    const answer = JSON.parse(decoder.decode(this.#bytes(this.#exports.answer_first(), length)));
    if (answer !== null && typeof answer.error === 'string') {
      throw new Error(answer.error);
    }
    return answer;
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
