// What the library asks of WebGPU. It waits for the GPU by JSPI: a call of its own returns when the
// promise is kept that it got for it.

// What of a device's limits is asked for as it is.
const LIMITS = ['maxBufferSize', 'maxStorageBufferBindingSize', 'maxComputeWorkgroupStorageSize'];
// Bytes that are copied to the host at once.
const PIECE = 64 << 20;
// Kinds of bindings, as the library writes them.
const TYPES = { u: 'uniform', r: 'read-only-storage', w: 'storage' };

// Why there is no WebGPU for the library here; null if there is.
export function missing() {
  if (!navigator.gpu) {
    return 'this browser has no WebGPU';
  }
  if (!('Suspending' in WebAssembly)) {
    return 'this browser has no JSPI, by which WebAssembly waits for a GPU';
  }
  return null;
}

export class Gpu {
  #device;
  #memory;
  #sources;
  #buffers = new Map();
  #next = 1;
  #pipelines = new Map();
  #staging = null;
  #failure = null;
  #isLost = false;
  // Kernels whose pipelines are being made.
  #making = new Set();
  // Is told which these are, since they may take long.
  onCompile = () => {};

  // Opens the browser's GPU; an error says why there is none. `memory` gives the library's bytes,
  // `kernels` is the address of the kernels as gzip.
  static async open(memory, kernels) {
    const adapter = await navigator.gpu.requestAdapter({ powerPreference: 'high-performance' });
    if (!adapter) {
      throw new Error('this browser has found no GPU for WebGPU');
    }
    const requiredLimits = Object.fromEntries(LIMITS.map((name) => [name, adapter.limits[name]]));
    const device = await adapter.requestDevice({ requiredLimits });
    const file = await fetch(kernels);
    if (!file.ok) {
      throw new Error(`${kernels} cannot be loaded: ${file.status}`);
    }
    const text = new Response(file.body.pipeThrough(new DecompressionStream('gzip')));
    const gpu = new Gpu();
    gpu.#device = device;
    gpu.#memory = memory;
    gpu.#sources = await text.json();
    device.addEventListener('uncapturederror', ({ error }) => gpu.#failed(error));
    device.lost.then((info) => {
      gpu.#isLost = true;
      gpu.#failed({ message: `the device was lost: ${info.message}` });
    });
    return gpu;
  }

  // Whether the browser has taken it away: then another one may be opened.
  isLost() {
    return this.#isLost;
  }

  // What the library wants to know of it.
  facts() {
    const { limits, adapterInfo } = this.#device;
    const { vendor, architecture, description } = adapterInfo ?? {};
    const name = description || [vendor, architecture].filter(Boolean).join(' ');
    return {
      name: `WebGPU${name ? `, ${name}` : ''}`,
      buffer_bytes: Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize),
      alignment: limits.minStorageBufferOffsetAlignment,
      row: limits.maxComputeWorkgroupsPerDimension,
    };
  }

  // The first thing to go wrong is the cause of the others.
  #failed({ message }) {
    this.#failure ??= message;
  }

  // What has gone wrong since this was last asked; null for nothing.
  failure() {
    const failure = this.#failure;
    this.#failure = null;
    return failure;
  }

  #bytes(first, length) {
    return new Uint8Array(this.#memory(), first, length);
  }

  // A buffer's number; 0 where there is no room.
  async allocate(size) {
    const { STORAGE, COPY_SRC, COPY_DST } = GPUBufferUsage;
    this.#device.pushErrorScope('out-of-memory');
    const buffer = this.#device.createBuffer({ size, usage: STORAGE | COPY_SRC | COPY_DST });
    if (await this.#device.popErrorScope()) {
      return 0;
    }
    this.#next += 1;
    this.#buffers.set(this.#next, buffer);
    return this.#next;
  }

  free(number) {
    this.#buffers.get(number)?.destroy();
    this.#buffers.delete(number);
  }

  write(number, firstByte, first, length) {
    const buffer = this.#buffers.get(number);
    this.#device.queue.writeBuffer(buffer, firstByte, this.#bytes(first, length));
  }

  async read(number, firstByte, first, length) {
    for (let at = 0; at < length; at += PIECE) {
      await this.#readPiece(number, firstByte + at, first + at, Math.min(PIECE, length - at));
    }
  }

  async #readPiece(number, firstByte, first, length) {
    const staging = this.#stagingOf(length);
    const encoder = this.#device.createCommandEncoder();
    encoder.copyBufferToBuffer(this.#buffers.get(number), firstByte, staging, 0, length);
    this.#device.queue.submit([encoder.finish()]);
    try {
      await staging.mapAsync(GPUMapMode.READ, 0, length);
      this.#bytes(first, length).set(new Uint8Array(staging.getMappedRange(0, length)));
      staging.unmap();
    } catch (error) {
      this.#failed(error);
    }
  }

  // A buffer of at least `size` bytes that the host can read, kept from read to read.
  #stagingOf(size) {
    if (!this.#staging || this.#staging.size < size) {
      this.#staging?.destroy();
      const { MAP_READ, COPY_DST } = GPUBufferUsage;
      this.#staging = this.#device.createBuffer({ size, usage: MAP_READ | COPY_DST });
    }
    return this.#staging;
  }

  // Runs launches one after the other, and waits for them.
  async run(text, [firstParameter, parameterBytes]) {
    const launches = JSON.parse(text);
    const device = this.#device;
    try {
      const pipelines = await Promise.all(launches.map((launch) => this.#pipeline(launch)));
      const parameters = device.createBuffer({
        size: parameterBytes,
        usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST,
      });
      device.queue.writeBuffer(parameters, 0, this.#bytes(firstParameter, parameterBytes));
      const encoder = device.createCommandEncoder();
      const pass = encoder.beginComputePass();
      for (const [at, launch] of launches.entries()) {
        const { pipeline, layout } = pipelines[at];
        pass.setPipeline(pipeline);
        pass.setBindGroup(0, this.#bindGroup(layout, launch, parameters));
        pass.dispatchWorkgroups(...launch.grid);
      }
      pass.end();
      device.queue.submit([encoder.finish()]);
      await device.queue.onSubmittedWorkDone();
      parameters.destroy();
    } catch (error) {
      this.#failed(error);
    }
  }

  #bindGroup(layout, { parameters: [offset, size], views }, parameters) {
    const storage = views.map(([buffer, offset, size]) => (
      { buffer: this.#buffers.get(buffer), offset, size }));
    const all = [{ buffer: parameters, offset, size }, ...storage];
    const entries = all.map((resource, binding) => ({ binding, resource }));
    return this.#device.createBindGroup({ layout, entries });
  }

  // The pipeline of a launch, made when it is first asked for.
  #pipeline({ kernel, abilities, access }) {
    const key = `${kernel} ${abilities}`;
    if (!this.#pipelines.has(key)) {
      this.#pipelines.set(key, this.#made(kernel, abilities, access));
    }
    return this.#pipelines.get(key);
  }

  async #made(kernel, abilities, access) {
    const device = this.#device;
    const code = this.#sources[kernel];
    const entries = [...access].map((letter, binding) => (
      { binding, visibility: GPUShaderStage.COMPUTE, buffer: { type: TYPES[letter] } }));
    const layout = device.createBindGroupLayout({ entries });
    const constants = code.includes('@id(0)') ? { 0: abilities ?? 0 } : {};
    const module = device.createShaderModule({ label: kernel, code });
    this.#making.add(kernel);
    this.onCompile([...this.#making]);
    try {
      const pipeline = await device.createComputePipelineAsync({
        label: kernel,
        layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
        compute: { module, entryPoint: kernel, constants },
      });
      return { pipeline, layout };
    } finally {
      this.#making.delete(kernel);
      this.onCompile([...this.#making]);
    }
  }
}
