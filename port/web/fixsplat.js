// fixsplat for browsers and Node: the same bytes as the library everywhere. fixsplat.d.ts says what there is.

import { Files, inNode } from './read.js'

const SHOWN = 100000            // Gaussians of a preview, at most
const PAUSE = 400               // milliseconds before the first, and at least between two
// A module with one function that uses simd128.
const WITH_SIMD = [0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15,
                   253, 98, 11]

/** Whether this machine runs the faster module. */
export const hasSimd = WebAssembly.validate(new Uint8Array(WITH_SIMD))

// ---- Modules --------------------------------------------------------------------------------------------------

async function compileFrom(url) {
  if (inNode && url.protocol === 'file:')
    return WebAssembly.compile(await (await import('node:fs/promises')).readFile(url))
  const answer = await fetch(url)
  if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`)
  return answer.headers.get('content-type') === 'application/wasm'
    ? WebAssembly.compileStreaming(answer)
    : WebAssembly.compile(await answer.arrayBuffer())
}

/** An instance, whose functions take and give numbers at one place of its memory. */
class Module {
  constructor(module, imports) {
    const env = {
      ...imports,
      tan: Math.tan,
      number: (x, at, room) => this.write(String(Number.isInteger(x) ? x : +x.toPrecision(6)), at >>> 0, room),
    }
    this.c = new WebAssembly.Instance(module, { env, gl: this.#webgl(module) }).exports
    this.numbers = this.c.start() >>> 0
  }

  /** What the module wants of OpenGL: the functions of webgl.js that are `this.gl` when they are called. */
  #webgl(module) {
    const wanted = WebAssembly.Module.imports(module).filter((one) => one.module === 'gl')
    return Object.fromEntries(wanted.map(({ name }) => [name, (...values) => this.gl[name](...values)]))
  }

  put(...values) {
    new Float64Array(this.c.memory.buffer, this.numbers).set(values.flat())
  }

  get(first, end) {
    return Array.from(new Float64Array(this.c.memory.buffer, this.numbers, end).subarray(first))
  }

  bytes(at, length) {
    return new Uint8Array(this.c.memory.buffer, at >>> 0, length)
  }

  write(text, at, room) {
    return new TextEncoder().encodeInto(text, this.bytes(at, room)).written
  }

  /** The text at a place, up to its 0. */
  text(at) {
    const bytes = new Uint8Array(this.c.memory.buffer, at >>> 0)
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)))
  }

  error() {
    return new Error(this.text(this.c.words()))
  }

  /** What a function returned, unless that is an error. */
  check(result) {
    if (result < 0) throw this.error()
    return result
  }

  /** The same of a place in memory. */
  place(at) {
    if (!at) throw this.error()
    return at >>> 0
  }

  /** A copy of some bytes, which `release` frees. */
  copy(bytes) {
    const at = this.place(this.c.allocate(bytes.length))
    this.bytes(at, bytes.length).set(bytes)
    return at
  }

  /** The same of a text, with a 0 behind it. */
  copyText(text) {
    return this.copy(new TextEncoder().encode(`${text}\0`))
  }
}

/** What is made once; but again after it failed. */
const once = (made, name, make) =>
  (made[name] ??= make().catch((error) => {
    delete made[name]
    throw error
  }))

const compiled = {}
const compile = (name) =>
  once(compiled, name, () => compileFrom(new URL(`${name}.wasm`, import.meta.url)))
const cores = {}
const coreFor = ({ simd = hasSimd }) => coreOf(simd ? 'simd' : 'core')
const coreOf = (name) => once(cores, name, async () => new Module(await compile(name)))

// ---- Opening --------------------------------------------------------------------------------------------------

const numberOf = (names, value) => {
  if (!names.includes(value)) throw new Error(`${value}: expected one of ${names.join(', ')}`)
  return names.indexOf(value)
}

/** Packs files of which a share has come, or at most `most` of their Gaussians. The module is dropped with all of its
    memory. Returns the bytes of an .fxs file or an error, and the names of files that were wanted and are not there. */
function runImport(module, files, options, share = 1, most = 0) {
  const { profile = 'default', axes = 'file', maxGaussians = 0, maxMemory = 0, progress } = options
  const all = files.all
  const missing = new Set()
  const reader = new Module(module, {
    progress: (done) => progress?.({ stage: 'prepare', done }),
    size: (file) => all[file].bytes.length,
    read(file, offset, out, size) {
      if (offset + (size >>> 0) > all[file].there) return -1
      reader.bytes(out, size >>> 0).set(all[file].bytes.subarray(offset, offset + (size >>> 0)))
      return 0
    },
    beside(at) {
      const name = reader.text(at)
      const number = files.numberOf(name)
      if (number < 0) missing.add(name)
      return number
    },
  })
  const [kind, directions] = [numberOf(['default', 'compact', 'small'], profile), numberOf(['file', 'rub', 'rdf'], axes)]
  const name = reader.copyText(all[0].name)
  reader.put(maxGaussians, maxMemory, share)
  try {
    if (reader.c.import(name, kind, directions, most) < 0) return { missing, error: reader.error() }
  } catch (error) {
    if (!(error instanceof WebAssembly.RuntimeError)) throw error
    return { missing, error: new Error(`${all[0].name}: cannot be read: ${error.message}`) }
  }
  return { missing, bytes: reader.bytes(...reader.get(0, 2)) }
}

/** A packed scene from files of another format. */
async function pack(files, options) {
  const module = await compile('import')
  let result = runImport(module, files, options)
  while (result.missing.size && (await files.ask(result.missing))) result = runImport(module, files, options)
  if (result.error) throw result.error
  return result.bytes
}

/** A function that hands over a scene of what has come so far: the share, and whether it is to be now. */
function previewsOf(files, core, options) {
  const quietly = { ...options, progress: undefined }
  let last = performance.now()
  let pause = PAUSE
  return async (share, isNow) => {
    const start = performance.now()
    if (!options.preview || !share || (!isNow && start < last + pause)) return
    let scene
    try {
      const { bytes } = runImport(await compile('import'), files, quietly, share, SHOWN)
      if (bytes?.length) scene = new Scene(await core, files.all[0].name, bytes)
    } catch {
      return                    // the scene itself is what counts, and its error
    }
    if (scene) await options.preview(scene)
    last = performance.now()
    pause = Math.max(PAUSE, 4 * (last - start))
  }
}

export async function load(source, options = {}) {
  const files = new Files()
  const core = coreFor(options)
  const preview = previewsOf(files, core, options)
  core.catch(() => {})          // who waits for it hears of it
  const file = await files.open(source, async (file, share) => {
    options.progress?.({ stage: 'download', done: share, bytes: file.there })
    if (file.there < 4 || file.isPacked) return
    compile('import').catch(() => {})
    if (share < 1) await preview(share, false)
  })
  if (file.isPacked) return new Scene(await core, file.name, file.bytes)
  await preview(1, true)
  return new Scene(await core, file.name, await pack(files, options))
}

export class Scene {
  #core
  #data
  #scene

  constructor(core, name, bytes) {
    this.#core = core
    this.#data = core.copy(bytes)
    const text = core.copyText(name)
    try {
      this.#scene = core.place(core.c.open(text, this.#data, bytes.length))
    } catch (error) {
      core.c.release(this.#data)
      throw error
    } finally {
      core.c.release(text)
    }
    const [count, shDegree, profile, ...box] = core.get(0, 9)
    Object.assign(this, { name, count, shDegree, profile: ['default', 'compact', 'small'][profile] })
    Object.assign(this, { low: box.slice(0, 3), high: box.slice(3), bytes: bytes.length })
  }

  /** Its module and place there; no part of the interface. */
  get inside() {
    if (!this.#scene) throw new Error(`${this.name}: was freed`)
    return [this.#core, this.#scene]
  }

  /** The packed scene: an .fxs file. */
  get packed() {
    return this.inside && this.#core.bytes(this.#data, this.bytes).slice()
  }

  render(camera, options) {
    return render([{ scene: this }], camera, options)
  }

  pick(x, y, camera, options) {
    return pick(x, y, [{ scene: this }], camera, options)
  }

  free() {
    if (!this.#scene) return
    this.#core.c.release(this.#scene)
    this.#core.c.release(this.#data)
    this.#scene = 0
  }
}

// ---- Frames ---------------------------------------------------------------------------------------------------

const MAX_CROPS = 8

/** These numbers, where they are as many as there should be. */
function all(name, count, numbers) {
  const flat = Array.isArray(numbers) || ArrayBuffer.isView(numbers) ? Array.from(numbers).flat() : []
  if (flat.length !== count || !flat.every((x) => typeof x === 'number'))
    throw new Error(`${name}: expected ${count} numbers`)
  return flat
}

function placeObject(core, object, i) {
  const { scene, translation = [0, 0, 0], rotation = [1, 0, 0, 0], scale = 1, opacity = 1 } = object
  const { tint = [1, 1, 1], visible = true, id = i, crops = [] } = object
  const [own, at] = scene.inside
  if (own !== core) throw new Error(`${scene.name}: loaded with another \`simd\` than the first object`)
  const box = ({ low, high, keep }) => [...all('low', 3, low), ...all('high', 3, high), keep === 'outside']
  const where = [...all('translation', 3, translation), ...all('rotation', 4, rotation), scale, opacity]
  core.put(where, all('tint', 3, tint), visible, id, crops.length, crops.slice(0, MAX_CROPS).flatMap(box))
  core.check(core.c.place(at))
}

function placeAll(objects) {
  if (!objects.length) throw new Error('no objects')
  const [core] = objects[0].scene.inside
  core.check(core.c.begin(objects.length))
  objects.forEach((object, i) => placeObject(core, object, i))
  return core
}

/** An entry of a cameras.json, whose rotation has the camera's axes as columns. */
function takePinhole(core, camera, width, height) {
  const { fx, fy = fx, near = 0, orthographic = false } = camera
  const [w, h] = [camera.width ?? width, camera.height ?? height]
  const rows = all('rotation', 9, camera.rotation)
  const columns = [0, 3, 6, 1, 4, 7, 2, 5, 8].map((i) => rows[i])
  core.put(fx, fy, camera.cx ?? w / 2, camera.cy ?? h / 2, columns, all('position', 3, camera.position), near)
  core.check(core.c.camera(w, h, width, height, orthographic ? 1 : 0))
}

function takeCamera(core, camera, width, height) {
  if (camera.rotation) return takePinhole(core, camera, width, height)
  const { fov = 50, near = 0 } = camera
  const up = all('up', 3, camera.up ?? [0, -1, 0])
  if (!camera.eye) {
    core.put(up, fov, near)
    return core.check(core.c.see_all(width, height))
  }
  core.c.middle()
  core.put(all('eye', 3, camera.eye), all('look', 3, camera.look ?? core.get(0, 3)), up, fov, near)
  return core.check(core.c.look_at(width, height))
}

function sizeOf(camera, options) {
  const width = options.width ?? camera.width ?? 1280
  const height = options.height ?? camera.height ?? 720
  if (![width, height].every((n) => Number.isInteger(n) && n >= 1 && n <= 16384))
    throw new Error(`${width} x ${height} pixels: expected 1 to 16384 each`)
  return [width, height]
}

function begin(objects, camera, options) {
  const [width, height] = sizeOf(camera, options)
  const core = placeAll(objects)
  takeCamera(core, camera, width, height)
  return [core, width, height]
}

/** What every frame takes of its options. */
const valuesOf = ({ background = 0, shDegree = 3, cutoff = 'mahalanobis', maxMemory = 0 }) => [
  background,
  shDegree,
  cutoff === 'square' ? 1 : 0,
  maxMemory,
]

export function render(objects, camera = {}, options = {}) {
  return renderTo(...begin(objects, camera, options), options)
}

function renderTo(core, width, height, options) {
  const pixels = core.place(core.c.allocate(4 * width * height))
  try {
    core.check(core.c.render(pixels, options.alpha ? 1 : 0, ...valuesOf(options)))
    return new Uint8ClampedArray(core.bytes(pixels, 4 * width * height))
  } finally {
    core.c.release(pixels)
  }
}

export function pick(x, y, objects, camera = {}, options = {}) {
  const [core] = begin(objects, camera, options)
  if (!core.check(core.c.pick(x, y, options.maxMemory ?? 0))) return null
  const [object, gaussian, depth, ...position] = core.get(0, 6)
  return { object, gaussian, depth, position }
}

// ---- Screens --------------------------------------------------------------------------------------------------

/** A picture's colours as a canvas takes them: not times the coverage. */
function divided(pixels) {
  for (let at = 0; at < pixels.length; at += 4)
    for (let c = at, alpha = pixels[at + 3]; alpha && c < at + 3; c++) pixels[c] = (pixels[c] * 255) / alpha
  return pixels
}

/** A canvas of two dimensions, with pictures of the processor. */
class Copied {
  #context
  #pixels

  constructor(canvas) {
    this.#context = canvas.getContext('2d')
    if (!this.#context) throw new Error('the canvas has a context of another kind: take another canvas')
  }

  draw(core, width, height, options) {
    this.#pixels = renderTo(core, width, height, options)
    const shown = options.alpha ? divided(this.#pixels.slice()) : this.#pixels
    this.#context.putImageData(new ImageData(shown, width), 0, 0)
  }

  pixels() {
    return this.#pixels.slice()
  }

  finish() {}
  free() {}
}

const CONTEXT = { alpha: true, antialias: false, depth: false, stencil: false, preserveDrawingBuffer: true }

/** A canvas of WebGL 2, which the module draws on. */
class Drawn {
  #core
  #functions
  #place
  #quads

  constructor(canvas, core, Functions, quads) {
    this.gl = canvas.getContext('webgl2', CONTEXT)
    if (!this.gl) throw new Error('there is no WebGL 2 here, or the canvas has a context of another kind')
    if (this.lost) throw new Error("the canvas's WebGL context is lost: take another canvas")
    if (!core.c.gl_open) throw new Error('the module without simd128 has no WebGL')
    this.#core = core
    this.#quads = quads ? 1 : 0
    this.#functions = core.gl = new Functions(this.gl, core)
    this.#place = core.place(core.c.gl_open())
  }

  get lost() {
    return this.gl.isContextLost()
  }

  draw(core, width, height, { into, alpha, ...options }) {
    const { framebuffer = null, x = 0, y = 0 } = into ?? {}
    const { gl } = this
    if (!into && (gl.drawingBufferWidth !== width || gl.drawingBufferHeight !== height) && !this.lost)
      throw new Error(`${width} x ${height} pixels are more than the device's canvas can have`)
    core.gl = this.#functions
    const name = core.gl.nameOf(framebuffer)
    const result = core.c.gl_render(this.#place, this.#quads, name, x, y, alpha ? 1 : 0, ...valuesOf(options))
    if (this.lost) throw new Error('the WebGL context was lost: open another Screen, on another canvas')
    core.check(result)
  }

  pixels() {
    const { gl } = this
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight]
    const rows = new Uint8Array(4 * width * height)
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rows)
    const pixels = new Uint8ClampedArray(rows.length)
    for (let y = 0, row = 4 * width; y < height; y++)
      pixels.set(rows.subarray(row * (height - 1 - y), row * (height - y)), row * y)
    return pixels
  }

  /** Reading a pixel waits for all draws; a fence is looked at every 4 ms. */
  finish() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4))
  }

  free() {
    this.#core.gl = this.#functions
    this.#core.c.gl_close(this.#place)
    this.#functions.close()
  }
}

export class Screen {
  #canvas
  #core
  #way

  constructor(canvas, backend, core, way) {
    this.#canvas = canvas
    this.#core = core
    this.#way = way
    this.backend = backend
  }

  static async open(canvas, backend, options = {}) {
    const core = await coreFor(options)
    if (backend === 'wasm') return new Screen(canvas, backend, core, new Copied(canvas))
    if (backend !== 'webgl2' && backend !== 'webgl2-quads')
      throw new Error(`${backend}: expected wasm, webgl2 or webgl2-quads`)
    const { Functions } = await import('./webgl.js')
    return new Screen(canvas, backend, core, new Drawn(canvas, core, Functions, backend === 'webgl2-quads'))
  }

  get inside() {
    if (!this.#way) throw new Error('the Screen was freed')
    return this.#way
  }

  get lost() {
    return !!this.inside.lost
  }

  get gl() {
    return this.inside.gl
  }

  draw(objects, camera = {}, options = {}) {
    const way = this.inside
    const [core, width, height] = begin(objects, camera, options)
    if (core !== this.#core) throw new Error('the Screen and the scenes are of different modules')
    if (!options.into && (this.#canvas.width !== width || this.#canvas.height !== height))
      Object.assign(this.#canvas, { width, height })
    way.draw(core, width, height, options)
  }

  pixels() {
    return this.inside.pixels()
  }

  async finish() {
    this.inside.finish()
  }

  free() {
    this.#way?.free()
    this.#way = undefined
  }
}

// ---- Pictures -------------------------------------------------------------------------------------------------

function crc32(bytes) {
  let crc = -1
  for (const byte of bytes) {
    crc ^= byte
    for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0)
  }
  return ~crc
}

function chunkOf(type, data) {
  const chunk = new Uint8Array(data.length + 12)
  const view = new DataView(chunk.buffer)
  view.setUint32(0, data.length)
  new TextEncoder().encodeInto(type, chunk.subarray(4))
  chunk.set(data, 8)
  view.setInt32(data.length + 8, crc32(chunk.subarray(4, data.length + 8)))
  return chunk
}

export async function png(pixels, width, height) {
  const rows = new Uint8Array((4 * width + 1) * height)
  for (let y = 0; y < height; y++)
    rows.set(pixels.subarray(4 * width * y, 4 * width * (y + 1)), (4 * width + 1) * y + 1)
  const header = new DataView(new ArrayBuffer(13))
  header.setUint32(0, width)
  header.setUint32(4, height)
  header.setUint16(8, 0x0806)   // 8 bits, RGBA
  const deflated = new Blob([rows]).stream().pipeThrough(new CompressionStream('deflate'))
  const body = new Uint8Array(await new Response(deflated).arrayBuffer())
  const chunks = [['IHDR', new Uint8Array(header.buffer)], ['IDAT', body], ['IEND', new Uint8Array(0)]]
  const parts = [Uint8Array.of(137, 80, 78, 71, 13, 10, 26, 10), ...chunks.map(([type, data]) => chunkOf(type, data))]
  return new Uint8Array(await new Blob(parts).arrayBuffer())
}
