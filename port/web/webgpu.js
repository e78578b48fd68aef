// Frames by WebGPU. The module in C plans them (kernels/compute/plan.c), the shaders are those of kernels/compute, and
// here the plans are carried out. A frame is shown when the device says that all of its lists fitted; else it is done
// again with more room. Pixels stay on the device.

import { parts, texts } from './stages.js'

const STATUS = 16               // words, as FXS_COMPUTE_STATUS
const [UNIFORMS, MEMORY, COUNTS, PICTURE] = [0, 1, 2, 5]       // as in kernels/compute/records.h,
const BUFFERS = 8               // but for the one that OpenGL reads back
const [NONE, HEADS, ROWS] = [-1, -2, -3]
const STRIDE = 1024             // bytes of a uniform, as FXS_COMPUTE_STRIDE
const STEP = 13                 // words of fxs_step
const LOST = 'the WebGPU device was lost: open another Screen'

// The picture's words as colours. Formats of 8 bits take k / 255 exactly.
const SHOW = `
@group(0) @binding(0) var<storage, read> picture: array<u32>;
@group(0) @binding(1) var<uniform> place: vec4<i32>;       // x, y, width, where the colours begin
@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32>
{
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
@fragment fn show(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32>
{
    let pixel = vec2<i32>(at.xy) - place.xy;
    return unpack4x8unorm(picture[place.w + pixel.y * place.z + pixel.x]);
}`
const FORMATS = ['rgba8unorm', 'bgra8unorm', 'rgba16float', 'rgba32float']

// ---- Devices --------------------------------------------------------------------------------------------------

let own                         // of the Screens that are given none

async function makeDevice() {
  const adapter = await globalThis.navigator?.gpu?.requestAdapter({ powerPreference: 'high-performance' })
  if (!adapter) throw new Error('there is no WebGPU here')
  const { maxStorageBufferBindingSize, maxBufferSize } = adapter.limits
  const device = await adapter.requestDevice({ requiredLimits: { maxStorageBufferBindingSize, maxBufferSize } })
  device.lost.then(() => (own = undefined))
  return device
}

function ownDevice() {
  own ??= makeDevice()
  own.catch(() => (own = undefined))
  return own
}

/** A pipeline, or an Error with the line that does not compile. */
async function pipelineOf(kind, device, what, module, descriptor) {
  try {
    return await device[`create${kind}PipelineAsync`](descriptor)
  } catch (error) {
    const { messages } = await module.getCompilationInfo()
    const [first] = messages.filter(({ type }) => type === 'error')
    const words = first ? `line ${first.lineNum}: ${first.message}` : error.message
    throw new Error(`${what} does not compile: ${words}`)
  }
}

/** The programs of a device, each made when it is first asked for. */
class Programs {
  #device
  #modules = {}
  #made = {}

  constructor(device) {
    this.#device = device
  }

  #module(name, code) {
    return (this.#modules[name] ??= this.#device.createShaderModule({ code: code() }))
  }

  of(entryPoint) {
    const stage = Object.keys(parts).find((name) => texts[name].includes(`fn ${entryPoint}(`))
    const module = this.#module(stage, () => parts[stage].map((part) => texts[part]).join('\n'))
    const descriptor = { layout: 'auto', compute: { module, entryPoint } }
    return (this.#made[entryPoint] ??= pipelineOf('Compute', this.#device, entryPoint, module, descriptor))
  }

  show(format) {
    const module = this.#module('show', () => SHOW)
    const descriptor = { layout: 'auto', vertex: { module }, fragment: { module, targets: [{ format }] } }
    return (this.#made[format] ??= pipelineOf('Render', this.#device, 'show', module, descriptor))
  }
}

const programs = new WeakMap()

function programsOf(device) {
  if (!programs.has(device)) programs.set(device, new Programs(device))
  return programs.get(device)
}

// ---- Frames ---------------------------------------------------------------------------------------------------

const KINDS = ['validation', 'out-of-memory', 'internal']

/** Draws the frames of a Screen, one after the other: of those that wait meanwhile, the last. */
export class Computed {
  #canvas
  #core
  #valuesOf
  #context
  #format                      // of the canvas
  #names                       // of the programs, by their numbers,
  #pipelines = {}              // and those that are there, by their names
  #rooms                       // the place of the device's rooms in the module
  #buffers = []
  #status
  #corner                      // the uniform of SHOW
  #scenes = new Map()          // their copies: { heads, rows }
  #next                        // the frame that waits
  #running                     // until none does
  #failure                     // of the last frame,
  #last                        // or what it was: { width, height, colour }
  #freed = false

  constructor(canvas, core, device, valuesOf) {
    this.#canvas = canvas
    this.#core = core
    this.#valuesOf = valuesOf
    this.device = device
    this.lost = false
    device.lost.then(() => (this.lost = true))
  }

  static async open(canvas, core, { device }, valuesOf) {
    if (!core.c.gpu_open) throw new Error('the module without simd128 has no WebGPU')
    const way = new Computed(canvas, core, device ?? (await ownDevice()), valuesOf)
    await way.#open()
    return way
  }

  async #open() {
    this.#names = this.#core.text(this.#core.c.gpu_programs()).trim().split(' ')
    await this.#need(...this.#names.filter((name) => !/trace_tiles|name_pixels/.test(name)))
    if (this.#canvas) await this.#take(this.#canvas)
    this.#begin()
  }

  async #take(canvas) {
    this.#context = canvas.getContext('webgpu')
    if (!this.#context) throw new Error('the canvas has a context of another kind: take another canvas')
    this.#format = navigator.gpu.getPreferredCanvasFormat()
    await programsOf(this.device).show(this.#format)
    this.#context.configure({ device: this.device, format: this.#format, alphaMode: 'premultiplied' })
  }

  async #need(...names) {
    const missing = names.filter((name) => !this.#pipelines[name])
    const made = await Promise.all(missing.map((name) => programsOf(this.device).of(name)))
    missing.forEach((name, i) => (this.#pipelines[name] = made[i]))
  }

  // ---- Buffers ------------------------------------------------------------------------------------------------

  /** With little room, as at first. */
  #begin() {
    const { maxStorageBufferBindingSize, maxBufferSize } = this.device.limits
    this.#rooms = this.#core.place(this.#core.c.gpu_open(Math.min(maxStorageBufferBindingSize, maxBufferSize)))
    this.#status = this.#buffer(4 * STATUS, GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST)
    this.#corner = this.#buffer(16, GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST)
  }

  #giveBack() {
    this.#forget(() => true)
    for (const buffer of [...this.#buffers, this.#status, this.#corner]) buffer.destroy()
    this.#buffers = []
    this.#last = undefined
    this.#core.c.release(this.#rooms)
  }

  #buffer(size, usage, mappedAtCreation = false) {
    return this.device.createBuffer({ size, usage, mappedAtCreation })
  }

  /** Makes the buffers as large as the plan wants them. */
  #reserve(sizes, limit) {
    const { STORAGE, UNIFORM, INDIRECT, COPY_SRC, COPY_DST } = GPUBufferUsage
    const bytes = sizes.map((size, i) => Math.max(size, this.#buffers[i]?.size ?? 64))
    const sum = bytes.reduce((a, b) => a + b)
    if (limit && sum > limit) throw new Error(`too little memory: the frame takes ${sum} bytes of the device`)
    bytes.forEach((size, i) => {
      if (size === this.#buffers[i]?.size) return
      this.#buffers[i]?.destroy()
      this.#buffers[i] = this.#buffer(size, (i ? STORAGE | INDIRECT : UNIFORM) | COPY_SRC | COPY_DST)
      if (i === MEMORY) this.#write(MEMORY, 0, this.#core.c.gpu_table(), this.#core.get(0, 1)[0])
    })
  }

  /** Of a copy: not every browser takes memory that threads share. */
  #write(buffer, to, at, bytes) {
    this.device.queue.writeBuffer(this.#buffers[buffer], to, this.#core.bytes(at, bytes).slice())
  }

  /** A part of a scene, or its heads. */
  #upload(at, part) {
    this.#core.c.gpu_pieces(this.#rooms, at, part)
    const [bytes, ...pieces] = this.#core.get(0, 10)
    const buffer = this.#buffer(Math.max(bytes, 64), GPUBufferUsage.STORAGE, true)
    const to = new Uint8Array(buffer.getMappedRange())
    for (let i = 0; i < 9; i += 3) to.set(this.#core.bytes(pieces[i], pieces[i + 1]), pieces[i + 2])
    buffer.unmap()
    return buffer
  }

  /** The copy of a scene, which is made once. */
  #copyOf(scene) {
    if (!this.#scenes.has(scene)) {
      const at = scene.inside[1]
      const count = this.#core.check(this.#core.c.gpu_parts(this.#rooms, at))
      const rows = Array.from({ length: count }, (_, part) => this.#upload(at, part))
      this.#scenes.set(scene, { heads: this.#upload(at, HEADS), rows })
    }
    return this.#scenes.get(scene)
  }

  #forget(which) {
    for (const [scene, { heads, rows }] of this.#scenes)
      if (which(scene)) {
        for (const buffer of [heads, ...rows]) buffer.destroy()
        this.#scenes.delete(scene)
      }
  }

  // ---- Drawing ------------------------------------------------------------------------------------------------

  /** Plans a frame, and has it drawn when the one before it is. */
  draw(core, width, height, { alpha, into, ...options }, objects) {
    if (this.lost) throw new Error(LOST)
    this.#checkPlace(into, width, height)
    const scenes = objects.map(({ scene }) => scene)
    for (const scene of scenes) core.check(core.c.gpu_parts(this.#rooms, scene.inside[1]))
    const [background, shDegree, square, budget, detail, limit] = this.#valuesOf(core, options)
    const values = [alpha ? 1 : 0, 0, 16, background, shDegree, square, budget, detail]
    const at = core.place(core.c.gpu_begin(this.#rooms, ...values))
    const [drawn] = core.get(0, 1)
    if (this.#next) core.c.gpu_end(this.#next.at)
    this.#next = { at, scenes, width, height, into, limit }
    this.#running ??= this.#run()
    return { drawn, missing: 0 }
  }

  #checkPlace(into, width, height) {
    const most = this.device.limits.maxTextureDimension2D
    if (!into && !this.#context) throw new Error('a Screen without a canvas draws `into` a texture')
    if (!into && Math.max(width, height) > most)
      throw new Error(`${width} x ${height} pixels are more than the device's canvas can have`)
    if (!into) return
    const { texture, x = 0, y = 0 } = into
    if (!FORMATS.includes(texture?.format)) throw new Error(`\`into\` needs a texture of one of ${FORMATS.join(', ')}`)
    if (!(x >= 0 && y >= 0 && x + width <= texture.width && y + height <= texture.height))
      throw new Error(`${width} x ${height} pixels from ${x}, ${y} on do not lie in the texture`)
  }

  async #run() {
    while (this.#next) {
      const frame = this.#next
      this.#next = this.#failure = undefined
      try {
        await this.#carryOut(frame)
      } catch (error) {
        this.#failure = error
        if (!this.#freed) this.#giveBack()
        if (!this.#freed) this.#begin()
      } finally {
        this.#core.c.gpu_end(frame.at)
      }
    }
    this.#running = undefined
  }

  /** Until all of it fits; then it is shown. */
  async #carryOut(frame) {
    const core = this.#core
    this.#forget((scene) => scene.isFreed)
    const show = await programsOf(this.device).show(frame.into?.texture.format ?? this.#format)
    do {
      this.#stay()
      const words = await this.#scoped(() => this.#submit(frame))
      this.#stay()
      core.put(...words)
    } while (core.check(core.c.gpu_look(frame.at)))
    this.#last = frame
    await this.#scoped(() => this.#show(frame, show))
  }

  #stay() {
    if (this.#freed) throw new Error('the Screen was freed')
  }

  /** What a function gives, or the device's error. */
  async #scoped(act) {
    let result, thrown
    for (const kind of KINDS) this.device.pushErrorScope(kind)
    try {
      result = act()
    } catch (error) {
      thrown = error
    }
    const errors = Promise.all(KINDS.map(() => this.device.popErrorScope()))
    const [given, found] = await Promise.allSettled([result, errors])
    if (this.lost) throw new Error(LOST)
    const error = thrown ?? found.reason ?? found.value.find((one) => one) ?? given.reason
    if (error instanceof GPUOutOfMemoryError) throw new Error('the device is out of memory')
    if (error) throw error instanceof Error ? error : new Error(error.message)
    return given.value
  }

  /** Has the device do the plan's steps. Returns a promise of the status. */
  #submit(frame) {
    const core = this.#core
    core.check(core.c.gpu_lay_out(frame.at))
    const [uniforms, bytes, places, placesBytes, placesAt, steps, count, colour, , ...sizes] = core.get(0, 9 + BUFFERS)
    const words = new Int32Array(core.c.memory.buffer, steps, STEP * count).slice()
    frame.colour = colour
    this.#reserve(sizes, frame.limit)
    this.#write(UNIFORMS, 0, uniforms, bytes)
    this.#write(MEMORY, placesAt, places, placesBytes)
    const copies = frame.scenes.map((scene) => this.#copyOf(scene))
    const encoder = this.device.createCommandEncoder()
    const pass = encoder.beginComputePass()
    for (let i = 0; i < words.length; i += STEP) this.#step(pass, copies, words.subarray(i, i + STEP))
    pass.end()
    encoder.copyBufferToBuffer(this.#buffers[COUNTS], 0, this.#status, 0, 4 * STATUS)
    this.device.queue.submit([encoder.finish()])
    return this.#read()
  }

  async #read() {
    await this.#status.mapAsync(GPUMapMode.READ)
    const words = new Uint32Array(this.#status.getMappedRange()).slice()
    this.#status.unmap()
    return words
  }

  /** An fxs_step. */
  #step(pass, copies, [program, , x, y, indirect, indirectAt, ...rest]) {
    const pipeline = this.#pipelines[this.#names[program]]
    const [uniform, object, part] = rest.slice(4)
    const bufferOf = (number) =>
      number === HEADS ? copies[object].heads : number === ROWS ? copies[object].rows[part] : this.#buffers[number]
    const bound = (resource, binding) => ({ binding, resource })
    const uniforms = [0, ...(uniform ? [uniform] : [])].map((offset) => ({ buffer: this.#buffers[UNIFORMS], offset, size: STRIDE }))
    const entries = rest.slice(0, 4).flatMap((number, i) => (number === NONE ? [] : [bound({ buffer: bufferOf(number) }, i)]))
    const groups = [uniforms.map(bound), entries]
    pass.setPipeline(pipeline)
    groups.forEach((entries, i) =>
      pass.setBindGroup(i, this.device.createBindGroup({ layout: pipeline.getBindGroupLayout(i), entries })))
    if (indirect === NONE) pass.dispatchWorkgroups(x, y)
    else pass.dispatchWorkgroupsIndirect(this.#buffers[indirect], indirectAt)
  }

  #show({ width, height, into, colour }, pipeline) {
    if (!into) this.#resize(width, height)
    const { texture = this.#context.getCurrentTexture(), x = 0, y = 0 } = into ?? {}
    this.device.queue.writeBuffer(this.#corner, 0, new Int32Array([x, y, width, colour]))
    const encoder = this.device.createCommandEncoder()
    const target = { view: texture.createView(), loadOp: into ? 'load' : 'clear', storeOp: 'store' }
    const pass = encoder.beginRenderPass({ colorAttachments: [target] })
    const entries = [this.#buffers[PICTURE], this.#corner].map((buffer, binding) => ({ binding, resource: { buffer } }))
    pass.setPipeline(pipeline)
    pass.setBindGroup(0, this.device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }))
    pass.setScissorRect(x, y, width, height)
    pass.draw(3)
    pass.end()
    this.device.queue.submit([encoder.finish()])
  }

  /** Not before there is a picture of the new size. */
  #resize(width, height) {
    if (this.#canvas.width !== width || this.#canvas.height !== height) Object.assign(this.#canvas, { width, height })
  }

  async finish() {
    await this.#running
    if (this.#failure) throw this.#failure
  }

  async pixels() {
    await this.finish()
    const { width, height, colour } = this.#last
    const size = 4 * width * height
    const buffer = this.#buffer(size, GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST)
    const encoder = this.device.createCommandEncoder()
    encoder.copyBufferToBuffer(this.#buffers[PICTURE], 4 * colour, buffer, 0, size)
    this.device.queue.submit([encoder.finish()])
    await buffer.mapAsync(GPUMapMode.READ)
    const pixels = new Uint8ClampedArray(buffer.getMappedRange()).slice()
    buffer.destroy()
    return pixels
  }

  free() {
    this.#freed = true
    if (this.#next) this.#core.c.gpu_end(this.#next.at)
    this.#next = undefined
    this.#giveBack()
    this.#context?.unconfigure()
  }
}
