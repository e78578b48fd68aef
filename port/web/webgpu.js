// The back end 'webgpu' executes the plan of a frame (webgpu.c) with the shaders of kernels/compute, and shows the
// picture in the same submission. The status that the device reports is read later. It enlarges the GPU buffers of
// later frames.

import { parts, texts } from './stages.js'

const STATUS = 16               // number of 32-bit words in the status of a frame (FXS_COMPUTE_STATUS)
const [UNIFORMS, MEMORY, COUNTS] = [0, 1, 2]            // indices of buffers, see kernels/compute/records.h
const BUFFERS = 7               // number of GPU buffers: FXS_COMPUTE_BUFFERS without FXS_COMPUTE_DOWNLOAD
const [NONE, HEADS, ROWS] = [-1, -2, -3]
const FLIGHTS = 3               // largest number of submitted frames that the device has not finished
const STRIDE = 1024             // size of a uniform block in bytes: FXS_COMPUTE_STRIDE
const STEP = 15
const PLACE = 10
const EYES = 2
const PLACE_STRIDE = 256        // distance of two eyes' places in their buffer, in bytes
const [TIMES, TIMES_AT] = ['timestamp-query', 4 * STATUS * EYES]     // optional feature; its two times in a status
const LOST = 'the WebGPU device was lost: open another Screen'
const LATER = /animate_chunk|trace_tiles|finish_traced|name_pixels/     // shaders that few frames need
const NOTHING = 0xffffffff      // depth of a pixel without a depth: FXS_NOTHING
const TARGETS = { colour: 1, meanDepth: 1, depth: 1, ids: 2 }
const [OCCLUDER, BACKDROP, IMAGES] = [4, 5, 6]          // indices of the two input images; number of images

// The shaders before and after the stages of a frame. One shader writes the picture to a texture; a texture of an 8-bit
// format stores k / 255 exactly. Another shader converts the caller's depth buffer to the occluder (depths that hide
// Gaussians).
const ENDS = `
struct Place {
    corner: vec2<i32>,
    size: vec2<i32>,
    colour: i32,
    occluder: i32,
    planes: vec2<f32>,
    linear: i32,
}
@group(0) @binding(0) var<uniform> place: Place;
@group(0) @binding(1) var<storage, read> memory: array<u32>;
@group(0) @binding(1) var<storage, read_write> hiding: array<u32>;
@group(0) @binding(2) var depths: texture_depth_2d;

@vertex
fn cover(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32>
{
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn show(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32>
{
    let pixel = vec2<i32>(at.xy) - place.corner;
    return unpack4x8unorm(memory[place.colour + pixel.y * place.size.x + pixel.x]);
}

@compute @workgroup_size(8, 8)
fn hide(@builtin(global_invocation_id) id: vec3<u32>)
{
    let pixel = vec2<i32>(id.xy);
    if (any(pixel >= place.size)) {
        return;
    }
    // 1 / distance, or of an orthographic camera the distance
    let value = mix(place.planes.x, place.planes.y, textureLoad(depths, pixel + place.corner, 0));
    let linear = place.linear != 0;
    let z = select(1.0 / value, value, linear);
    let low = min(place.planes.x, place.planes.y);
    let high = max(place.planes.x, place.planes.y);
    let nothing = select(value <= low, value >= high, linear) || z >= 4294967040.0;
    hiding[place.occluder + pixel.y * place.size.x + pixel.x] = select(u32(z), ${NOTHING}u, nothing);
}`
const FORMATS = ['rgba8unorm', 'bgra8unorm', 'rgba16float', 'rgba32float']
const ONE_OVER = { srcFactor: 'one', dstFactor: 'one-minus-src-alpha' }

// ---- Devices --------------------------------------------------------------------------------------------------

const lineOf = ({ message }) => message.split('\n')[0]

let own

async function makeDevice() {
  const adapter = await globalThis.navigator?.gpu?.requestAdapter({ powerPreference: 'high-performance' })
  if (!adapter) throw new Error('there is no WebGPU here')
  const { maxStorageBufferBindingSize, maxBufferSize } = adapter.limits
  const requiredLimits = { maxStorageBufferBindingSize, maxBufferSize }
  const requiredFeatures = adapter.features.has(TIMES) ? [TIMES] : []
  const device = await adapter.requestDevice({ requiredLimits, requiredFeatures }).catch((error) => {
    throw new Error(`there is no WebGPU device: ${lineOf(error)}`)
  })
  device.lost.then(() => (own = undefined))
  return device
}

function ownDevice() {
  own ??= makeDevice()
  own.catch(() => (own = undefined))
  return own
}

async function pipelineOf(kind, device, what, module, descriptor) {
  try {
    return await device[`create${kind}PipelineAsync`](descriptor)
  } catch (error) {
    const { messages } = await module.getCompilationInfo()
    const [first] = messages.filter(({ type }) => type === 'error')
    const words = first ? `line ${first.lineNum}: ${lineOf(first)}` : lineOf(error)
    throw new Error(`${what} does not compile: ${words}`)
  }
}

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
    const module = stage
      ? this.#module(stage, () => parts[stage].map((part) => texts[part]).join('\n'))
      : this.#module('ends', () => ENDS)
    const descriptor = { layout: 'auto', compute: { module, entryPoint } }
    return (this.#made[entryPoint] ??= pipelineOf('Compute', this.#device, entryPoint, module, descriptor))
  }

  show(format, over) {
    const module = this.#module('ends', () => ENDS)
    const target = { format, blend: over ? { color: ONE_OVER, alpha: ONE_OVER } : undefined }
    const descriptor = { layout: 'auto', vertex: { module }, fragment: { module, targets: [target] } }
    return (this.#made[`${format} ${over}`] ??= pipelineOf('Render', this.#device, 'show', module, descriptor))
  }
}

const programs = new WeakMap()

function programsOf(device) {
  if (!programs.has(device)) programs.set(device, new Programs(device))
  return programs.get(device)
}

// ---- Frames ---------------------------------------------------------------------------------------------------

function checkTexture(name, texture, isKind, kind, usage, [x, y, width, height]) {
  if (!isKind(texture?.format)) throw new Error(`${name} needs a texture of ${kind}`)
  if (!(texture.usage & GPUTextureUsage[usage])) throw new Error(`${name} needs a texture with the usage ${usage}`)
  if (!(x >= 0 && y >= 0 && x + width <= texture.width && y + height <= texture.height && texture.sampleCount === 1))
    throw new Error(`${width} x ${height} pixels from ${x}, ${y} on do not lie in the texture of ${name}`)
}

function checkInto({ texture, x = 0, y = 0, depth, over }, width, height, alpha) {
  const place = [x, y, width, height]
  const isColour = (format) => FORMATS.includes(format)
  const isDepth = (format) => /^depth/.test(format)
  checkTexture('`into`', texture, isColour, `one of ${FORMATS.join(', ')}`, 'RENDER_ATTACHMENT', place)
  if (depth) checkTexture('`into.depth`', depth.texture, isDepth, 'depths', 'TEXTURE_BINDING', place)
  if (depth && !(depth.planes?.length === 2 && depth.planes.every((plane) => plane > 0)))
    throw new Error('`into.depth` needs two planes, the distances that 0 and 1 stand for')
  if (depth?.linear && !depth.planes.every(Number.isFinite)) throw new Error('`into.depth.linear` needs finite planes')
  if (over && !alpha) throw new Error('`into.over` needs `alpha`')
}

function checkTargets(targets, pixels) {
  for (const [name, buffer] of Object.entries(targets)) {
    const bytes = 4 * TARGETS[name] * pixels
    if (!bytes) throw new Error(`${name}: expected one of ${Object.keys(TARGETS).join(', ')}`)
    if (!(buffer?.size >= bytes && buffer.usage & GPUBufferUsage.COPY_DST))
      throw new Error(`${name} needs a buffer of ${bytes} bytes with the usage COPY_DST`)
  }
}

const KINDS = ['validation', 'out-of-memory', 'internal']

/** The part of a Screen that draws with WebGPU. At most one frame waits to be drawn; a newer frame replaces the waiting
    frame. */
export class Computed {
  #canvas
  #core
  #valuesOf
  #context
  #format
  #parts
  #names
  #pipelines = {}
  #rooms
  #pool
  #buffers = []
  #groups = []
  #bound = 0
  #statuses
  #submitted = 0
  #flights = []
  #settled = Promise.resolve()
  #place
  #times
  #ticks
  #scenes = new Map()
  #edited = new Set()
  #next
  #running
  #failure
  #last
  #freed = false

  constructor(canvas, core, device, pool, valuesOf) {
    this.#canvas = canvas
    this.#pool = pool
    this.#core = core
    this.#valuesOf = valuesOf
    this.device = device
    this.lost = false
    device.lost.then(() => (this.lost = true))
  }

  static async open(canvas, core, { device, pool }, valuesOf) {
    if (!core.c.gpu_open) throw new Error('the module without simd128 has no WebGPU')
    const way = new Computed(canvas, core, device ?? (await ownDevice()), pool, valuesOf)
    await way.#open()
    return way
  }

  async #open() {
    this.#names = this.#core.text(this.#core.c.gpu_programs()).trim().split(' ')
    await this.#need(...this.#names.filter((name) => !LATER.test(name)))
    if (this.#canvas) await this.#take(this.#canvas)
    if (this.lost) throw new Error(LOST)
    const { maxStorageBufferBindingSize, maxBufferSize } = this.device.limits
    this.#rooms = this.#core.place(this.#core.c.gpu_open(Math.min(maxStorageBufferBindingSize, maxBufferSize)))
    const usage = GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST
    this.#statuses = Array.from({ length: FLIGHTS }, () => this.#buffer(TIMES_AT + 16, usage))
    if (this.device.features.has(TIMES)) {
      this.#times = this.device.createQuerySet({ type: 'timestamp', count: 2 })
      this.#ticks = this.#buffer(16, GPUBufferUsage.QUERY_RESOLVE | GPUBufferUsage.COPY_SRC)
    }
    this.#place = this.#buffer(EYES * PLACE_STRIDE, GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST)
  }

  async #take(canvas) {
    this.#context = canvas.getContext('webgpu')
    if (!this.#context) throw new Error('the canvas has a context of another kind: take another canvas')
    this.#format = navigator.gpu.getPreferredCanvasFormat()
    await programsOf(this.device).show(this.#format, false)
    const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_DST
    this.#context.configure({ device: this.device, format: this.#format, alphaMode: 'premultiplied', usage })
  }

  async #need(...names) {
    const missing = names.filter((name) => !this.#pipelines[name])
    const made = await Promise.all(missing.map((name) => programsOf(this.device).of(name)))
    missing.forEach((name, i) => (this.#pipelines[name] = made[i]))
  }

  // ---- Buffers ------------------------------------------------------------------------------------------------

  #giveBack() {
    this.#forget(() => true)
    for (const buffer of this.#buffers) buffer.destroy()
    this.#buffers = []
    this.#groups = []
    this.#core.c.gpu_reset(this.#rooms)
  }

  #buffer(size, usage, mappedAtCreation = false) {
    return this.device.createBuffer({ size, usage, mappedAtCreation })
  }

  #reserve(sizes, limit) {
    const { STORAGE, UNIFORM, INDIRECT, COPY_SRC, COPY_DST } = GPUBufferUsage
    const bytes = sizes.map((size, i) => Math.max(size, this.#buffers[i]?.size ?? 64))
    const sum = bytes.reduce((a, b) => a + b)
    if (limit && sum > limit) throw new Error(`too little memory: the frame takes ${sum} bytes of the device`)
    bytes.forEach((size, i) => {
      if (size === this.#buffers[i]?.size) return
      this.#buffers[i]?.destroy()
      this.#buffers[i] = this.#buffer(size, (i ? STORAGE | INDIRECT : UNIFORM) | COPY_SRC | COPY_DST)
      if (i % BUFFERS === MEMORY) this.#write(i, 0, this.#core.c.gpu_table(), this.#core.get(0, 1)[0])
    })
  }

  /** Writes bytes of the module's memory to a GPU buffer. The bytes are copied first, since some browsers refuse shared
      memory. */
  #write(buffer, to, at, bytes) {
    this.device.queue.writeBuffer(this.#buffers[buffer], to, this.#core.bytes(at, bytes).slice())
  }

  #upload(at, part) {
    this.#core.c.gpu_pieces(this.#rooms, at, part)
    const [bytes, ...pieces] = this.#core.get(0, 10)
    const buffer = this.#buffer(Math.max(bytes, 64), GPUBufferUsage.STORAGE, true)
    const to = new Uint8Array(buffer.getMappedRange())
    for (let i = 0; i < 9; i += 3) to.set(this.#core.bytes(pieces[i], pieces[i + 1]), pieces[i + 2])
    buffer.unmap()
    return buffer
  }

  #copyOf(scene) {
    if (!this.#scenes.has(scene)) {
      const at = scene.inside[1]
      const count = this.#core.check(this.#core.c.gpu_parts(this.#rooms, at))
      const rows = Array.from({ length: count }, (_, part) => this.#upload(at, part))
      this.#scenes.set(scene, { heads: this.#upload(at, HEADS), rows })
    }
    return this.#scenes.get(scene)
  }

  #poolOf(scene) {
    const [, , pager] = scene.inside
    const scoped = (act) => this.#scoped(act)
    if (!this.#scenes.has(scene)) this.#scenes.set(scene, pager.poolOn(this.device, this.#rooms, scoped, this.#pool))
    return this.#scenes.get(scene).use()
  }

  /** Uploads a scene anew with the next frame. */
  forget(scene) {
    this.#edited.add(scene)
  }

  #forget(which) {
    for (const [scene, copy] of this.#scenes)
      if (which(scene)) {
        for (const buffer of [copy.heads, ...copy.rows]) buffer?.destroy()
        copy.free?.()
        this.#scenes.delete(scene)
      }
  }

  // ---- Drawing ------------------------------------------------------------------------------------------------

  draw(core, width, height, { alpha, into, backdrop, targets = {}, depthBits = 16, ...options }, objects, count) {
    if (this.lost) throw new Error(LOST)
    if (into?.length && into.length !== count) throw new Error('`into`: expected one target for each eye')
    const eyes = Array.from({ length: count }, (_, i) => {
      const place = { ...(Array.isArray(into) ? into[i] : { ...into, x: (into?.x ?? 0) + i * width }) }
      if (into && !place.texture && this.#context) place.texture = this.#partsOf(this.#canvas)
      return { place, targets: [].concat(targets)[i] ?? {} }
    })
    for (const { place, targets } of eyes) {
      checkTargets(targets, width * height)
      this.#checkPlace(into && place, count * width, width, height, alpha, Object.keys(targets).length > 0)
    }
    const scenes = objects.map(({ scene }) => scene)
    const pools = scenes.map((scene) => scene.paged && this.#poolOf(scene))
    for (const scene of scenes) core.check(core.c.gpu_parts(this.#rooms, scene.inside[1]))
    const [background, shDegree, square, budget, detail, limit] = this.#valuesOf(core, options)
    const isAsked = (name) => name === 'colour' || eyes.some(({ targets }) => targets[name])
    const asked = [...Object.keys(TARGETS).map(isAsked), eyes.some(({ place }) => place.depth), !!backdrop]
    const bits = asked.reduce((sum, is, i) => sum + (is ? 2 ** i : 0), 0)
    const values = [alpha ? 1 : 0, depthBits, bits, background, shDegree, square, budget, detail]
    const at = core.place(core.c.gpu_begin(this.#rooms, ...values))
    const facts = core.drawn()
    const [, , moves] = core.get(0, 3)
    core.looked()
    if (this.#next) core.c.gpu_end(this.#next.at)
    this.#next = { at, scenes, pools, width, height, eyes, isWhole: !into, backdrop, depthBits, bits, limit, moves }
    this.#running ??= this.#run()
    return facts
  }

  #checkPlace(into, whole, width, height, alpha, hasTargets) {
    const most = this.device.limits.maxTextureDimension2D
    if (!into && !this.#context && !hasTargets)
      throw new Error('a Screen without a canvas draws `into` a texture, or `targets`')
    if (!into && this.#context && Math.max(whole, height) > most)
      throw new Error(`${whole} x ${height} pixels are more than the device's canvas can have`)
    if (into) checkInto(into, width, height, alpha)
  }

  async #run() {
    while (this.#next) {
      const frame = this.#next
      this.#next = undefined
      if (this.#flights.length === FLIGHTS) await this.#flights.shift()
      await this.#carryOut(frame).catch((error) => this.#settle(Promise.reject(error)))
      this.#core.c.gpu_end(frame.at)
    }
    this.#running = undefined
  }

  /** Notes the outcome of a frame when it is known, in the order of the frames. */
  #settle(outcome) {
    const known = Promise.allSettled([this.#settled, outcome]).then(([, { reason }]) => {
      this.#failure = reason
      if (reason && !this.#freed) this.#giveBack()
    })
    this.#settled = known
    return known
  }

  async #carryOut(frame) {
    const core = this.#core
    this.#forget((scene) => scene.isFreed || this.#edited.has(scene))
    this.#edited.clear()
    for (const eye of frame.eyes) {
      const { texture, over = false } = eye.place
      const format = texture?.format ?? this.#format
      eye.show = format && (await programsOf(this.device).show(format, over))
    }
    if (frame.bits & ~(1 | (1 << BACKDROP))) await this.#need('trace_tiles', 'finish_traced', 'name_pixels', 'hide')
    if (frame.moves) await this.#need('animate_chunk')
    await Promise.all(frame.pools.map(({ made }) => made))
    this.#stay()
    const status = this.#statuses[this.#submitted++ % FLIGHTS]
    const words = this.#scoped(() => this.#submit(frame, status))
    this.#last = frame
    this.#flights.push(this.#settle(words.then((words) => this.#look(words, frame.eyes.length))))
  }

  #look(words, eyes) {
    this.#stay()
    const [start, end] = new BigUint64Array(words.buffer, TIMES_AT)
    this.milliseconds = Number(end - start) / 1e6 || undefined
    this.#core.put(...words)
    this.#core.check(this.#core.c.gpu_look(this.#rooms, eyes))
  }

  #stay() {
    if (this.#freed) throw new Error('the Screen was freed')
  }

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
    if (error) throw error instanceof Error ? error : new Error(lineOf(error))
    return given.value
  }

  #submit(frame, status) {
    const core = this.#core
    core.check(core.c.gpu_lay_out(frame.at))
    const facts = core.get(0, 7 + IMAGES + BUFFERS)
    const [uniforms, bytes, places, placesBytes, placesAt, steps, count] = facts
    frame.images = facts.slice(7, 7 + IMAGES)
    const words = new Int32Array(core.c.memory.buffer, steps, STEP * count).slice()
    const sizes = facts.slice(7 + IMAGES)
    this.#reserve(frame.eyes.flatMap(() => sizes), frame.limit)
    this.#write(UNIFORMS, 0, uniforms, bytes)
    frame.eyes.forEach(({ place }, eye) => {
      const memory = eye * BUFFERS + MEMORY
      const { images, backdrop } = frame
      this.#writePlace(frame, place, eye)
      if (backdrop) this.device.queue.writeBuffer(this.#buffers[memory], 4 * images[BACKDROP], backdrop)
      this.#write(memory, placesAt, places, placesBytes)
    })
    const copies = frame.scenes.map((scene, i) => frame.pools[i] || this.#copyOf(scene))
    for (const pool of frame.pools) pool.check?.()
    const encoder = this.device.createCommandEncoder()
    const timestampWrites = { querySet: this.#times, beginningOfPassWriteIndex: 0, endOfPassWriteIndex: 1 }
    const pass = encoder.beginComputePass(this.#times && { timestampWrites })
    this.#bound = 0
    frame.eyes.forEach(({ place }, eye) => place.depth && this.#hide(pass, frame, place, eye))
    for (let i = 0; i < words.length; i += STEP) this.#step(pass, copies, words.subarray(i, i + STEP))
    pass.end()
    frame.eyes.forEach((of, eye) => {
      encoder.copyBufferToBuffer(this.#buffers[eye * BUFFERS + COUNTS], 0, status, 4 * STATUS * eye, 4 * STATUS)
      this.#show(encoder, frame, of, eye)
    })
    if (this.#times) {
      encoder.resolveQuerySet(this.#times, 0, 2, this.#ticks, 0)
      encoder.copyBufferToBuffer(this.#ticks, 0, status, TIMES_AT, 16)
    }
    this.device.queue.submit([encoder.finish()])
    for (const pool of frame.pools) pool.upload?.()
    return this.#read(status)
  }

  async #read(status) {
    await status.mapAsync(GPUMapMode.READ)
    const words = new Uint32Array(status.getMappedRange()).slice()
    status.unmap()
    return words
  }

  #writePlace({ width, height, images, depthBits }, { x = 0, y = 0, depth }, eye) {
    const { planes = [], linear = false } = depth ?? {}
    const words = new Int32Array(PLACE)
    words.set([x, y, width, height, images[0], images[OCCLUDER]])
    new Float32Array(words.buffer).set(planes.map((plane) => (plane * 2 ** depthBits) ** (linear ? 1 : -1)), 6)
    words[8] = linear ? 1 : 0
    this.device.queue.writeBuffer(this.#place, PLACE_STRIDE * eye, words)
  }

  /** Binds the resources of a shader. The bind groups of the last frame are reused if possible, since making them is
      slow. */
  #bind(pass, pipeline, group, resources) {
    const kept = this.#groups[this.#bound]
    const isKept = (resource, i) =>
      resource === kept.resources[i] || (resource?.buffer && resource.buffer === kept.resources[i]?.buffer &&
                                         resource.offset === kept.resources[i].offset)
    if (!(kept?.pipeline === pipeline && kept.group === group && resources.every(isKept))) {
      const entries = resources.map((resource, binding) => ({ binding, resource })).filter(({ resource }) => resource)
      const made = this.device.createBindGroup({ layout: pipeline.getBindGroupLayout(group), entries })
      this.#groups[this.#bound] = { pipeline, group, resources, made }
    }
    pass.setBindGroup(group, this.#groups[this.#bound++].made)
  }

  #step(pass, copies, [program, , x, y, arguments_, argumentsAt, a, b, c, d, uniform, object, part, eye, frame]) {
    const pipeline = this.#pipelines[this.#names[program]]
    const { heads, rows } = copies[object] ?? {}
    const own = (number) => this.#buffers[eye * BUFFERS + number]
    const bufferOf = (number) => (number === HEADS ? heads : number === ROWS ? rows[part] : own(number))
    const buffer = this.#buffers[UNIFORMS]
    const uniforms = (uniform ? [frame, uniform] : [frame]).map((offset) => ({ buffer, offset, size: STRIDE }))
    pass.setPipeline(pipeline)
    this.#bind(pass, pipeline, 0, uniforms)
    this.#bind(pass, pipeline, 1, [a, b, c, d].map((number) => (number === NONE ? null : { buffer: bufferOf(number) })))
    if (arguments_ === NONE) pass.dispatchWorkgroups(x, y)
    else pass.dispatchWorkgroupsIndirect(own(arguments_), argumentsAt)
  }

  #placed(eye) {
    const place = { buffer: this.#place, offset: PLACE_STRIDE * eye, size: 4 * PLACE }
    return [place, { buffer: this.#buffers[eye * BUFFERS + MEMORY] }]
  }

  #hide(pass, { width, height }, { depth }, eye) {
    const view = depth.texture.createView({ aspect: 'depth-only' })
    pass.setPipeline(this.#pipelines.hide)
    this.#bind(pass, this.#pipelines.hide, 0, [...this.#placed(eye), view])
    pass.dispatchWorkgroups(Math.ceil(width / 8), Math.ceil(height / 8))
  }

  #show(encoder, frame, { targets, show }, eye) {
    Object.keys(TARGETS).forEach((name, i) => {
      const bytes = 4 * TARGETS[name] * frame.width * frame.height
      if (targets[name]) this.#copy(encoder, eye, frame.images[i], targets[name], bytes)
    })
    if (show) this.#showColours(encoder, frame, eye)
  }

  #copy(encoder, eye, from, to, bytes) {
    encoder.copyBufferToBuffer(this.#buffers[eye * BUFFERS + MEMORY], 4 * from, to, 0, bytes)
  }

  #showColours(encoder, { width, height, eyes, isWhole }, eye) {
    if (isWhole) this.#resize(eyes.length * width, height)
    const { place, show: pipeline } = eyes[eye]
    const { texture = this.#context.getCurrentTexture(), x = 0, y = 0, layer = 0 } = place
    const view = texture.createView({ dimension: '2d', baseArrayLayer: layer, arrayLayerCount: 1 })
    const target = { view, loadOp: isWhole && !eye ? 'clear' : 'load', storeOp: 'store' }
    const pass = encoder.beginRenderPass({ colorAttachments: [target] })
    pass.setPipeline(pipeline)
    this.#bind(pass, pipeline, 0, this.#placed(eye))
    pass.setScissorRect(x, y, width, height)
    pass.draw(3)
    pass.end()
    if (isWhole) this.#parts = undefined
    if (texture !== this.#parts) return
    const shown = this.#context.getCurrentTexture()
    encoder.copyTextureToTexture({ texture }, { texture: shown }, [shown.width, shown.height])
  }

  #partsOf({ width, height }) {
    if (this.#parts?.width === width && this.#parts.height === height) return this.#parts
    const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC
    return (this.#parts = this.device.createTexture({ size: [width, height], format: this.#format, usage }))
  }

  /** Resizes the canvas, which clears its pixels. Therefore called only when a complete picture follows. */
  #resize(width, height) {
    if (this.#canvas.width !== width || this.#canvas.height !== height) Object.assign(this.#canvas, { width, height })
  }

  async finish() {
    await this.#running
    await this.#settled
    if (this.#failure) throw this.#failure
  }

  async pixels() {
    await this.finish()
    if (!this.#last) throw new Error('nothing was drawn yet')
    return this.#scoped(() => this.#readColours(this.#last))
  }

  async #readColours({ width, height, images }) {
    const size = 4 * width * height
    const buffer = this.#buffer(size, GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST)
    const encoder = this.device.createCommandEncoder()
    this.#copy(encoder, 0, images[0], buffer, size)
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
    for (const made of [...this.#statuses, this.#place, this.#times, this.#ticks]) made?.destroy()
    this.#core.c.release(this.#rooms)
    this.#context?.unconfigure()
  }
}
