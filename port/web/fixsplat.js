// The package for browsers and Node, which runs the C library as WebAssembly modules. A reader module packs a scene
// file into the bytes of an .fxs file, the format that is drawn. The reader module is then dropped. Threads are workers
// that run the same module on shared memory.

import { hasModule, inNode, moduleOf, ofSystem, startThread } from './fixsplat_assets.js'
import { Files, nameOf, SourceFile, urlOf } from './read.js'

export { setAssets } from './fixsplat_assets.js'

const SHOWN = 100000            // largest number of Gaussians in a preview
const PAUSE = 400               // milliseconds before the first preview of a scene, and between previews
const SOON = 1000
// A WebAssembly module with one function that uses simd128, to detect support.
const WITH_SIMD = [0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15,
                   253, 98, 11]

// Relaxed simd128 makes multiplication faster. On x86, i16x8.q15mulr_sat_s takes five instructions, and
// i16x8.relaxed_q15mulr_s takes one. The results differ only for -32768 * -32768, which no picture depends on.
const PRECISE = [253, 130, 1]
const RELAXED = [253, 145, 2]
const WITH_RELAXED = [0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 15, 1, 13, 0, 65, 0, 253, 15,
                      65, 0, 253, 15, ...RELAXED, 11]
const runs = (code) => WebAssembly.validate(new Uint8Array(code))

export const hasSimd = runs(WITH_SIMD)
export const hasRelaxed = runs(WITH_RELAXED)

// ---- WebAssembly modules --------------------------------------------------------------------------------------

async function compileFrom(answer, relaxes) {
  return !relaxes && answer.headers.get('content-type') === 'application/wasm'
    ? WebAssembly.compileStreaming(answer)
    : compiledOf(new Uint8Array(await answer.arrayBuffer()), relaxes)
}

/** Compiles a WebAssembly module. `relaxes` replaces the opcodes of i16x8.q15mulr_sat_s by relaxed opcodes of the same
    length. tests/scripts/web.sh checks that the bytes of these opcodes occur nowhere else in the module. */
function compiledOf(code, relaxes) {
  for (let at = relaxes ? code.indexOf(PRECISE[0]) : -1; at >= 0; at = code.indexOf(PRECISE[0], at + 1))
    if (code[at + 1] === PRECISE[1] && code[at + 2] === PRECISE[2]) code.set(RELAXED, at)
  return WebAssembly.compile(code)
}

/** Functions of a WebAssembly module exchange numbers through one array of doubles, by put and get. */
class Module {
  constructor(module, imports = {}, threads = 1) {
    const env = {
      ...imports,
      tan: Math.tan,
      real: (at, length) => Number(new TextDecoder().decode(this.bytes(at, length))),
      number: (x, at, room) => this.write(String(Number.isInteger(x) ? x : +x.toPrecision(6)), at >>> 0, room),
    }
    this.c = { memory: imports.memory, ...new WebAssembly.Instance(module, { env, gl: this.#webgl(module) }).exports }
    this.numbers = this.c.start(threads) >>> 0
    this.c.may_wait?.(mayWait() ? 1 : 0)
    this.stack = this.c.__stack_pointer?.value
    this.scenes = 0
    this.pagers = []
    this.ahead = false
    this.fetches = true
  }

  #webgl(module) {
    const wanted = WebAssembly.Module.imports(module).filter((one) => one.module === 'gl')
    return Object.fromEntries(wanted.map(({ name }) => [name, (...values) => this.gl[name](...values)]))
  }

  put(...values) {
    if (values.some((value) => value instanceof Object)) throw new Error('expected a number, and got several')
    new Float64Array(this.c.memory.buffer, this.numbers, values.length).set(values)
  }

  get(first, end) {
    return Array.from(new Float64Array(this.c.memory.buffer, this.numbers, end).subarray(first))
  }

  bytes(at, length) {
    return new Uint8Array(this.c.memory.buffer, at >>> 0, length)
  }

  write(text, at, room) {
    const bytes = new TextEncoder().encode(text).subarray(0, room)
    this.bytes(at, room).set(bytes)
    return bytes.length
  }

  text(at) {
    const bytes = new Uint8Array(this.c.memory.buffer, at >>> 0)
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)))
  }

  error() {
    return new Error(this.text(this.c.words()))
  }

  /** Returns the result of a module function, or throws the module's error message if the result is negative. */
  check(result) {
    if (result < 0) throw this.error()
    return result
  }

  place(at) {
    if (!at) throw this.error()
    return at >>> 0
  }

  /** Calls a drawing function of the module. After a trap of WebAssembly, waits for the threads, which still use the
      frame's memory. */
  draw(name, ...args) {
    try {
      const result = this.check(this.c[name](...args))
      this.looked()
      return result
    } catch (error) {
      this.c.settle?.()
      if (this.stack) this.c.__stack_pointer.value = this.stack
      throw error
    }
  }

  /** Has the loaders of streamed scenes request what the frame lacks. */
  looked() {
    if (this.fetches) for (const pager of this.pagers) pager.looked(this.ahead)
  }

  drawn() {
    const [drawn, missing] = this.get(0, 2)
    return { drawn, missing: missing + this.pagers.reduce((sum, pager) => sum + pager.pending, 0) }
  }

  packedBytes(name, header) {
    const [text, at] = [this.copyText(name), this.copy(header)]
    try {
      this.check(this.c.paged_header(text, at))
      return this.get(0, 1)[0]
    } finally {
      this.c.release(text)
      this.c.release(at)
    }
  }

  /** Copies bytes into the module's memory. The caller frees the copy with `release`. */
  copy(bytes) {
    const at = this.place(this.c.allocate(bytes.length))
    this.bytes(at, bytes.length).set(bytes)
    return at
  }

  copyText(text) {
    return this.copy(new TextEncoder().encode(`${text}\0`))
  }
}

const once = (made, name, make) =>
  (made[name] ??= make().catch((error) => {
    delete made[name]
    throw error
  }))

const compiled = {}
const compile = (name) =>
  once(compiled, name, async () =>
    compileFrom(await moduleOf(name), hasRelaxed && ['simd', 'threads'].includes(name)))
const cores = {}
const coreOf = (name) => once(cores, name, async () => new Module(await compile(name)))

// ---- Threads --------------------------------------------------------------------------------------------------

const MOST_THREADS = 64
const USUAL_THREADS = 8
const STACK = 131072            // bytes of stack for each drawing thread
const PAGES = 16                // initial size of a shared memory in pages of 64 KiB; the Makefile has the same number

const canShare = typeof SharedArrayBuffer === 'function' && (inNode || globalThis.crossOriginIsolated === true)

/** Returns true if this thread may block in Atomics.wait. A page's main thread may not. */
function mayWait() {
  try {
    return Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, 0) === 'timed-out'
  } catch {
    return false
  }
}

const processors = async () => (inNode ? (await ofSystem()).processors() : navigator.hardwareConcurrency)

function sharedMemory(maximum = 65536) {
  try {
    return new WebAssembly.Memory({ initial: PAGES, maximum, shared: true })
  } catch (error) {
    if (maximum <= 4096) throw error
    return sharedMemory(maximum / 2)
  }
}

const oneMore = async (core, module, stack = STACK) =>
  startThread({ module, memory: core.c.memory, stack: core.place(core.c.allocate(stack)) + stack })

async function threadedCore(threads) {
  const module = await compile('threads')
  const core = new Module(module, { memory: sharedMemory() }, threads)
  const started = Array.from({ length: threads - 1 }, () => oneMore(core, module).catch(() => null))
  core.workers = Promise.all(started)   // the promise keeps the workers from being garbage-collected
  return core
}

async function threadsFor({ simd = hasSimd, threads }) {
  if (threads !== undefined && !(Number.isInteger(threads) && threads >= 1 && threads <= MOST_THREADS))
    throw new Error(`${threads} threads: expected 1 to ${MOST_THREADS}`)
  return simd && hasSimd && canShare ? (threads ?? Math.min(await processors(), USUAL_THREADS)) : 1
}

async function coreFor(options) {
  const { simd = hasSimd } = options
  const count = await threadsFor(options)
  if (count > 1)
    try {
      return await once(cores, `threads ${count}`, () => threadedCore(count))
    } catch {}                  // if threads cannot be started, one thread draws
  return coreOf(simd ? 'simd' : 'core')
}

export async function end() {
  for (const [name, made] of Object.entries(cores)) {
    const core = await made.catch(() => null)
    if (!core || core.scenes || cores[name] !== made) continue
    delete cores[name]
    core.c.end?.()
  }
}

// ---- Opening a scene ------------------------------------------------------------------------------------------

const numberOf = (names, value) => {
  if (!names.includes(value)) throw new Error(`${value}: expected one of ${names.join(', ')}`)
  return names.indexOf(value)
}

const PACKING_STACK = 262144    // bytes of stack for each thread that packs
const MUCH = 8e6                // bytes: a smaller file is packed faster without threads

async function readersFor(file, options) {
  const { simd = hasSimd } = options
  const { name } = file
  const [p, k] = file.first(2)
  if (!simd || !hasSimd) return ['import_core']
  // the bytes PK, the signature of a zip file
  const isSog = (p === 0x50 && k === 0x4b) || /(^|\/)(lod-)?meta\.json$/.test(name)
  const isShared = hasModule('import_threads') && (await threadsFor(options)) > 1
  const others = isShared ? ['import_threads', 'import'] : ['import']
  return isSog ? ['import_sog', ...others] : [...others, 'import_sog']
}

function readerOf(module, imports, threads) {
  const isShared = WebAssembly.Module.imports(module).some(({ kind }) => kind === 'memory')
  const reader = new Module(module, isShared ? { ...imports, memory: sharedMemory() } : imports)
  const started = Array.from({ length: isShared ? threads - 1 : 0 }, () =>
    oneMore(reader, module, PACKING_STACK).catch(() => null))
  reader.workers = Promise.all(started)
  return reader
}

// Packs the files of a scene with a new reader module. `share` is the downloaded share of the first file. `most` is the
// largest number of Gaussians of a preview; 0: no limit. With `look`, only checks the first file. In the result,
// isElsewhere tells that another module may read the file, and isShort that bytes have not arrived.
function runImport(module, files, options, { share = 1, most = 0, look = 0, threads }) {
  const { profile = 'default', axes = 'file', maxGaussians = 0, maxMemory = 0, progress } = options
  const all = files.all
  const missing = new Set()
  let reader
  let isShort = false
  const imports = {
    progress: (done) => progress?.({ stage: 'prepare', done }),
    size: (file) => look || Math.max(all[file].total, all[file].there),
    read(file, offset, out, size) {
      if (offset + (size >>> 0) > all[file].there) {
        isShort = true
        return -1
      }
      all[file].copy(offset, reader.bytes(out, size))
      return 0
    },
    beside(at) {
      const name = reader.text(at)
      const number = files.numberOf(name)
      if (number < 0) missing.add(name)
      return number
    },
  }
  const kind = numberOf(['default', 'compact', 'small'], profile)
  const directions = numberOf(['file', 'rub', 'rdf'], axes)
  try {
    reader = readerOf(module, imports, threads)
  } catch (error) {
    return { missing, error, isElsewhere: true }
  }
  const name = reader.copyText(all[0].name)
  reader.put(maxGaussians, maxMemory, share, threads)
  try {
    const result = look ? reader.c.look(name, directions) : reader.c.import(name, kind, directions, most)
    if (result) return { missing, isShort, error: reader.error(), isElsewhere: result > 0 }
  } catch (error) {
    if (!(error instanceof WebAssembly.RuntimeError)) throw error
    return { missing, error: new Error(`${all[0].name}: cannot be read: ${error.message}`) }
  } finally {
    reader.c.end?.()
  }
  return look ? { missing } : { missing, bytes: reader.bytes(...reader.get(0, 2)), sound: soundOf(reader) }
}

function soundOf(reader) {
  const [found, type, at, bytes, volume] = reader.get(2, 7)
  if (!found) return null
  if (found < 0) return { failure: reader.error().message }
  return { type: reader.text(type), bytes: reader.bytes(at, bytes).slice(), volume }
}

async function importBy(files, options, how) {
  const isFew = how.most || how.look || files.all[0].there < MUCH
  const threads = isFew ? 1 : await threadsFor(options)
  let result
  for (const name of await readersFor(files.all[0], options)) {
    const module = await compile(name)
    do result = runImport(module, files, options, { ...how, threads })
    while (!how.look && result.missing.size && (await files.ask(result.missing)))
    if (!result.isElsewhere) break
  }
  return result
}

async function importAll(files, options, how = {}) {
  const result = await importBy(files, options, how)
  if (result.error) throw result.error
  return result
}

// ---- First bytes of a file ------------------------------------------------------------------------------------

const HEAD = 4096               // number of first bytes of a file by which fxs_format_by_content recognises its format
const PACKED_HEAD = 192
const MOST_TEXT = 2 ** 30       // largest size in bytes of an index file: FXS_TEXT_MAX

/** Returns the size of a .ply file, which the reader states in its error for a file that is too short. Returns 0 if the
    size is unknown. */
async function leastOf(file, lookAs) {
  for (let size = 256; size <= file.there && file.starts('ply'); size *= 2) {
    const { error } = await lookAs(size)
    const found = error?.message.match(/asks for at least (\d+) bytes/)
    if (found) return Number(found[1])
  }
  return 0
}

// Throws an Error if the first bytes of a file are not a scene. Also throws if the file is far longer than its header
// says. Returns the number of downloaded bytes at which the next check is due.
async function lookAt(file, files, options) {
  const core = file.isPacked && (await coreFor(options))
  const lookAs = (look) => importBy(files, { ...options, progress: undefined }, { look })
  const isIndex = /^\s*\{/.test(String.fromCharCode(...file.first(16)))
  const least = core ? core.packedBytes(file.name, file.first(PACKED_HEAD)) : await leastOf(file, lookAs)
  if (least) file.limit(least)
  if (isIndex) file.most = MOST_TEXT
  if (core || isIndex) return Infinity
  const { missing, error, isShort } = await lookAs(file.total || file.most)
  if (isShort || missing.size) return 16 * file.there
  if (error) throw error
  return Infinity
}

// Returns a function (share, isNow, waited) that makes a preview of the loading scene when a preview is due. `share` is
// the downloaded share of the file. `isNow` makes a preview at once. `waited` is the number of milliseconds that were
// spent on checks of the file.
function previewsOf(files, options) {
  const quietly = { ...options, progress: undefined }
  let began = performance.now()
  let last
  let took = 0
  return async (share, isNow, waited = 0) => {
    const start = performance.now()
    began += waited
    last = last === undefined ? start : last + waited
    const isSoon = (start - began) * (1 - share) < Math.max(SOON, 4 * took) * share
    if (!options.preview || !share || (!isNow && (isSoon || start < last + Math.max(PAUSE, 4 * took)))) return
    let scene
    try {
      const { bytes } = await importAll(files, quietly, { share, most: SHOWN })
      if (bytes.length) scene = sceneOf(await coreFor(options), SourceFile.of(files.all[0].name, bytes))
    } catch {
      return
    }
    if (scene) await options.preview(scene)
    last = performance.now()
    took = last - start
  }
}

function sceneOf(core, file) {
  const { name, there: bytes } = file
  const text = core.copyText(name)
  let data
  try {
    data = core.place(core.c.allocate(bytes))
    file.copy(0, core.bytes(data, bytes))
    const at = core.place(core.c.open(text, data, bytes))
    return new Scene(core, { name, at, data, bytes, facts: core.get(0, 13) })
  } catch (error) {
    core.c.release(data)
    throw error
  } finally {
    core.c.release(text)
  }
}

async function paged(source, options) {
  if (options.paging === false || !(typeof source === 'string' || source instanceof URL)) return {}
  const url = await urlOf(String(source)).catch(() => null)
  if (!url || !/^https?:$/.test(url.protocol) || !/\.fxs$/i.test(url.pathname)) return {}
  const { openPaged } = await import('./paged.js')
  const { core, pager, at, facts, answer } = await openPaged(url, nameOf(url), () => coreFor(options), options)
  return { answer, scene: pager && new Scene(core, { name: nameOf(url), at, pager, bytes: pager.bytes, facts }) }
}

export async function load(source, options = {}) {
  need(isObject(options), 'options: expected an object')
  const { signal } = options
  signal?.throwIfAborted()
  const files = new Files(options)
  const preview = previewsOf(files, options)
  coreFor(options).catch(() => {})
  const { scene, answer } = await paged(source, options)
  if (scene) return scene
  let next = HEAD
  const file = await files.open(source, async (file, share) => {
    options.progress?.({ stage: 'download', done: share, bytes: file.there })
    const start = performance.now()
    if (file.there >= next) next = await lookAt(file, files, options)
    const waited = performance.now() - start
    if (file.there < 4 || file.isPacked) return
    readersFor(file, options).then(([name]) => compile(name)).catch(() => {})
    if (share < 1) await preview(share, false, waited)
  }, answer && Promise.resolve(answer))
  if (!file.isPacked) await preview(1, true)
  signal?.throwIfAborted()
  const { bytes, sound = null } = file.isPacked ? {} : await importAll(files, options)
  const core = await coreFor(options)   // another module instance, if the caller has called end() during loading
  signal?.throwIfAborted()
  return Object.assign(sceneOf(core, bytes ? SourceFile.of(file.name, bytes) : file), { sound })
}

export class Scene {
  sound = null
  #core
  #data
  #scene
  #pager

  constructor(core, { name, at, data, pager, bytes, facts }) {
    const [count, shDegree, profile, ...rest] = facts
    this.#core = core
    this.#data = data
    this.#scene = at
    this.#pager = pager
    Object.assign(this, { name, count, shDegree, profile: ['default', 'compact', 'small'][profile], bytes })
    Object.assign(this, { low: rest.slice(0, 3), high: rest.slice(3, 6), levels: rest[6] === 1, paged: !!pager })
    Object.assign(this, { duration: rest[7], rate: rest[8], loops: rest[9] === 1 })
    core.scenes++
    core.chosen = null   // drops the cached choice of a view, since a new scene may have the address of a freed scene
  }

  get threads() {
    return this.#core.c.threads?.() ?? 1
  }

  get isFreed() {
    return !this.#scene
  }

  /** For internal use: the module, the address of the scene in the module's memory, and the scene's loader (Pager). */
  get inside() {
    if (!this.#scene) throw new Error(`${this.name}: was freed`)
    return [this.#core, this.#scene, this.#pager]
  }

  get first() {
    return firstView([{ scene: this }])
  }

  get start() {
    const [core, at] = this.inside
    if (!core.c.start_view(at)) return null
    const [fy, ...rest] = core.get(0, 14)
    const rotation = [0, 1, 2].map((i) => [3, 6, 9].map((k) => rest[k + i]))
    return { width: 2, height: 2, fx: fy, fy, position: rest.slice(0, 3), rotation, reach: rest[12] }
  }

  get packed() {
    if (this.inside[2]) throw new Error(`${this.name}: only parts of it are here: load it with \`paging: false\``)
    return this.#core.bytes(this.#data, this.bytes).slice()
  }

  get failure() {
    return this.#pager?.failure ?? null
  }

  foresee(camera, options) {
    return foresee([{ scene: this }], camera, options)
  }

  prefetch(from, to) {
    const times = [from, to].map(checkedTime)
    return this.inside[2]?.prefetch(...times) ?? 0
  }

  async complete(camera, options) {
    while (lookFor([{ scene: this }], camera, options, false)) await this.inside[2].arrival()
  }

  render(camera, options) {
    return render([{ scene: this }], camera, options)
  }

  renderStereo(left, right, options) {
    return renderStereo([{ scene: this }], left, right, options)
  }

  pick(x, y, camera, options) {
    return pick(x, y, [{ scene: this }], camera, options)
  }

  free() {
    if (!this.#scene) return
    if (this.#pager) {
      this.#core.pagers = this.#core.pagers.filter((pager) => pager !== this.#pager)
      this.#pager.end()
    } else {
      this.#core.c.release(this.#scene)
      this.#core.c.release(this.#data)
    }
    this.#core.scenes--
    this.#scene = 0
  }
}

// ---- Frames ---------------------------------------------------------------------------------------------------

const MAX_CROPS = 8

function all(name, count, numbers) {
  const flat = Array.isArray(numbers) || ArrayBuffer.isView(numbers) ? Array.from(numbers).flat() : []
  if (flat.length !== count || !flat.every((x) => typeof x === 'number'))
    throw new Error(`${name}: expected ${count} numbers`)
  return flat
}

function need(is, words, Kind = TypeError) {
  if (!is) throw new Kind(words)
}

const isObject = (value) => typeof value === 'object' && value !== null

function insideOf(object, i) {
  need(isObject(object), `object ${i}: expected an object with a scene`)
  need(isObject(object.scene) && 'inside' in object.scene, `object ${i}: scene: expected what \`load\` returns`)
  return object.scene.inside
}

const MOST_SECONDS = 1e6

function checkedTime(time) {
  need(Math.abs(time) <= MOST_SECONDS, `time ${time}: expected seconds, within ${MOST_SECONDS}`)
  return time
}

function placeObject(core, object, i) {
  const { scene, translation = [0, 0, 0], rotation = [1, 0, 0, 0], scale = 1, opacity = 1 } = object
  const { tint = [1, 1, 1], visible = true, id = i, crops = [], time = 0 } = object
  const [own, at] = insideOf(object, i)
  need(Array.isArray(crops) && crops.every(isObject), `object ${i}: crops: expected a list of boxes`)
  if (own !== core) throw new Error(`${scene.name}: loaded with other \`simd\` or \`threads\` than the first object`)
  const box = ({ low, high, keep }) => [...all('low', 3, low), ...all('high', 3, high), keep === 'outside']
  const where = [...all('translation', 3, translation), ...all('rotation', 4, rotation), scale, opacity]
  const kept = crops.slice(0, MAX_CROPS).flatMap(box)
  core.put(...where, ...all('tint', 3, tint), visible, id, crops.length, checkedTime(time), ...kept)
  core.check(core.c.place(at))
}

function placeAll(objects, time = 0) {
  need(Array.isArray(objects), 'objects: expected a list')
  if (!objects.length) throw new Error('no objects')
  const [core] = insideOf(objects[0], 0)
  core.check(core.c.begin(objects.length, checkedTime(time)))
  objects.forEach((object, i) => placeObject(core, object, i))
  core.pagers = [...new Set(objects.map(({ scene }) => scene.inside[2]))].filter(Boolean)
  return core
}

function takePinhole(core, camera, width, height) {
  const { fx, fy = fx, near = 0, orthographic = false } = camera
  const [w, h] = [camera.width ?? width, camera.height ?? height]
  const rows = all('rotation', 9, camera.rotation)
  const columns = [0, 3, 6, 1, 4, 7, 2, 5, 8].map((i) => rows[i])
  core.put(fx, fy, camera.cx ?? w / 2, camera.cy ?? h / 2, ...columns, ...all('position', 3, camera.position), near)
  core.check(core.c.camera(w, h, width, height, orthographic ? 1 : 0))
}

function chosen(core, objects) {
  const key = JSON.stringify(objects.map(({ scene, time, ...how }) => [scene.inside[1], how]))
  if (core.chosen?.key !== key) {
    core.check(core.c.choose())
    core.chosen = { key, first: core.get(0, 14) }
  }
  return core.chosen.first
}

export function firstView(objects) {
  const first = chosen(placeAll(objects), objects)
  const [up, from, low, high] = [0, 3, 7, 10].map((at) => first.slice(at, at + 3))
  return { up, from, part: first[6], low, high, known: first[13] === 1 }
}

function takeCamera(core, objects, camera, width, height) {
  if (camera.rotation) return takePinhole(core, camera, width, height)
  const { fov = 50, near = 0 } = camera
  if (!camera.eye && !camera.up) {
    const isPlaced = Object.keys(objects[0]).some((name) => !['scene', 'time'].includes(name))
    const alone = objects.length === 1 && !isPlaced && camera.fov === undefined
    if (alone && core.check(core.c.see_start(objects[0].scene.inside[1], near, width, height))) return undefined
    core.put(...chosen(core, objects).slice(0, 13), fov, near)
    return core.check(core.c.see_first(width, height))
  }
  const up = all('up', 3, camera.up ?? [0, -1, 0])
  if (!camera.eye) {
    core.put(...up, fov, near)
    return core.check(core.c.see_all(width, height))
  }
  core.c.middle()
  core.put(...all('eye', 3, camera.eye), ...all('look', 3, camera.look ?? core.get(0, 3)), ...up, fov, near)
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
  need(isObject(camera), 'camera: expected an object')
  need(isObject(options), 'options: expected an object')
  const [width, height] = sizeOf(camera, options)
  const { depthBits = 16, fetch = true, time } = options
  if (!(depthBits >= 1 && depthBits <= 28)) throw new Error(`depthBits ${depthBits}: expected 1 to 28`)
  const core = placeAll(objects, time)
  core.fetches = fetch
  takeCamera(core, objects, camera, width, height)
  return [core, width, height]
}

function limitOf({ maxMemory = 0 }) {
  need(maxMemory >= 0, `maxMemory ${maxMemory}: expected a number of bytes`)
  return Math.min(maxMemory, 2 ** 32 - 1)
}

function budgetOf({ pagers }, { budget }) {
  if (budget !== undefined && !(Number.isInteger(budget) && budget >= 0))
    throw new Error(`budget ${budget}: expected a number of Gaussians`)
  const most = Math.min(...pagers.map((pager) => pager.most))
  if (budget && budget > most)
    throw new Error(`budget ${budget}: the pool has room for ${most}; a larger \`paging.memory\` has room for more`)
  return Math.min(budget || Math.min(...pagers.map((pager) => pager.budget || Infinity)), 2 ** 32 - 1)
}

function boundsOf(core, options) {
  const { detail = 0 } = options
  const budget = budgetOf(core, options)
  if (!(detail >= 0 && detail <= 16384)) throw new Error(`detail ${detail}: expected pixels, at most 16384`)
  return [budget === 2 ** 32 - 1 ? 0 : budget, Math.round(256 * detail), limitOf(options)]
}

function valuesOf(core, { background = 0, shDegree = 3, cutoff = 'mahalanobis', ...options }) {
  need(Number.isFinite(background), `background ${background}: expected a number`)
  need(Number.isFinite(shDegree), `shDegree ${shDegree}: expected a number`)
  return [background, shDegree, cutoff === 'square' ? 1 : 0, ...boundsOf(core, options)]
}

// For each colour format and each other target: the type of the array and the count of numbers a pixel. The order is
// that of take_targets in web_core.c.
const FORMATS = {
  rgba8: [Uint8ClampedArray, 4],
  premultiplied: [Uint8ClampedArray, 4],
  rgb565: [Uint16Array, 1],
  premultiplied16: [Uint16Array, 4],
}
const TARGETS = {
  colour: null,
  coverage: [Uint8Array, 1],
  meanDepth: [Uint32Array, 1],
  depth: [Uint32Array, 1],
  ids: [Uint32Array, 2],
  occluder: [Uint32Array, 1],
  backdrop: [Uint8ClampedArray, 4],
}
const READ = ['occluder', 'backdrop']

function oneOf(table, name) {
  if (!Object.hasOwn(table, name)) throw new Error(`${name}: expected one of ${Object.keys(table).join(', ')}`)
  return Object.keys(table).indexOf(name)
}

function layOut(asked, format, pixels, start) {
  let end = start
  const parts = Object.keys(asked).filter((name) => asked[name]).map((name) => {
    const place = oneOf(TARGETS, name)
    const [type, each] = TARGETS[name] ?? FORMATS[format]
    const given = READ.includes(name) && asked[name]
    const [at, count] = [end, each * pixels]
    if (given && given.length !== count) throw new Error(`${name}: expected ${count} numbers`)
    end += 64 * Math.ceil((count * type.BYTES_PER_ELEMENT) / 64)
    return { name, place, type, given, at, count }
  })
  return { parts, end }
}

function planOf(width, height, eyes, { targets = { colour: true }, alpha }) {
  const ofEyes = Array.isArray(targets) ? targets : Array(eyes).fill(targets)
  need(ofEyes.every(isObject), 'targets: expected an object')
  if (ofEyes.length !== eyes) throw new Error(`targets: expected those of ${eyes === 1 ? 'one eye' : 'two eyes'}`)
  const { colour } = ofEyes[0]
  const format = typeof colour === 'string' ? colour : alpha ? 'premultiplied' : 'rgba8'
  const code = oneOf(FORMATS, format)
  let bytes = 0
  const plans = ofEyes.map((asked) => {
    const { parts, end } = layOut(asked, format, width * height, bytes)
    bytes = end
    return parts
  })
  return { code, bytes, plans }
}

function memoryFor(plans, width, height) {
  const given = plans.map((parts) => parts.filter((part) => !part.given))
  try {
    return given.map((parts) => parts.map(({ type, count }) => new type(count)))
  } catch (error) {
    const bytes = given.flat().reduce((sum, { type, count }) => sum + count * type.BYTES_PER_ELEMENT, 0)
    const words = `${width} x ${height} pixels: there is no memory for their ${Math.ceil(bytes / 1e6)} MB`
    throw new RangeError(words, { cause: error })
  }
}

function draw(core, width, height, eyes, options) {
  const { depthBits = 16, targets } = options
  const { code, bytes, plans } = planOf(width, height, eyes, options)
  const copies = memoryFor(plans, width, height)
  const block = core.place(core.c.allocate(Math.min(bytes, 2 ** 32 - 1)))
  const numbersOf = ({ type, at, count }) => new type(core.c.memory.buffer, block + at, count)
  const taken = (parts, eye) =>
    parts.filter(({ given }) => !given).map((part, i) => {
      copies[eye][i].set(numbersOf(part))
      return [part.name, copies[eye][i]]
    })
  try {
    for (const part of plans.flat()) if (part.given) numbersOf(part).set(part.given)
    const places = Array(7 * eyes).fill(0)
    plans.forEach((parts, eye) => parts.forEach(({ place, at }) => (places[7 * eye + place] = block + at)))
    core.put(...places)
    core.draw('render', code, depthBits, ...valuesOf(core, options))
    const facts = { width, height, ...core.drawn() }
    const all = plans.map(taken)
    return all.map((parts) => (targets ? { ...facts, ...Object.fromEntries(parts) } : parts[0][1]))
  } finally {
    core.c.release(block)
  }
}

export function render(objects, camera = {}, options = {}) {
  const [core, width, height] = begin(objects, camera, options)
  const { rows } = options
  if (!rows) return draw(core, width, height, 1, options)[0]
  const [first, count] = rows
  const is = [first, count].every(Number.isInteger) && first >= 0 && count >= 1 && first + count <= height
  need(is, `rows ${rows}: expected the first row and the number of rows, of ${height}`, RangeError)
  core.c.crop(first, count)
  return draw(core, width, count, 1, options)[0]
}

export function renderStereo(objects, left, right, options = {}) {
  need(isObject(right), 'camera: expected an object')
  const [core, width, height] = begin(objects, left, options)
  takeCamera(core, objects, right, width, height)
  return draw(core, width, height, 2, options)
}

function lookFor(objects, camera = {}, options = {}, ahead = true) {
  const [core] = begin(objects, camera, options)
  core.ahead = ahead
  try {
    if (core.pagers.length) core.draw('foresee', ...boundsOf(core, options))
  } finally {
    core.ahead = false
  }
  return core.pagers.reduce((sum, pager) => sum + pager.lacking + pager.pending, 0)
}

export function foresee(objects, camera, options) {
  return lookFor(objects, camera, options)
}

export function pick(x, y, objects, camera = {}, options = {}) {
  const [core, width, height] = begin(objects, camera, options)
  need([x, y].every((n) => typeof n === 'number'), `pick: ${x}, ${y}: expected two numbers`)
  const [column, row] = [x, y].map(Math.trunc)
  const isIn = column >= 0 && column < width && row >= 0 && row < height
  need(isIn, `pick: ${x}, ${y}: expected a pixel of a picture of ${width} x ${height}`, RangeError)
  if (!core.draw('pick', x, y, ...boundsOf(core, options))) return null
  const [object, gaussian, depth, ...position] = core.get(0, 6)
  return { object, gaussian, depth, position }
}

/** Returns an Editor, which selects and deletes Gaussians of a scene. */
export async function edit(scene) {
  const { Editor } = await import('./editor.js')
  return new Editor(scene, begin)
}

// ---- Screens --------------------------------------------------------------------------------------------------

function divided(pixels) {
  for (let at = 0; at < pixels.length; at += 4)
    for (let c = at, alpha = pixels[at + 3]; alpha && c < at + 3; c++) pixels[c] = (pixels[c] * 255) / alpha
  return pixels
}

function resize(canvas, width, height) {
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height })
}

class Copied {
  #context
  #pixels

  constructor(canvas) {
    // In a worker, a canvas whose pixels lie in main memory is faster if the GPU is emulated.
    this.#context = canvas.getContext('2d', { willReadFrequently: !globalThis.document })
    if (!this.#context) throw new Error('the canvas has a context of another kind: take another canvas')
  }

  draw(core, width, height, options) {
    resize(this.#context.canvas, width, height)
    const { backdrop } = options
    const [drawn] = draw(core, width, height, 1, { ...options, targets: backdrop && { colour: true, backdrop } })
    this.#pixels = backdrop ? drawn.colour : drawn
    const facts = core.drawn()
    const shown = options.alpha ? divided(this.#pixels.slice()) : this.#pixels
    this.#context.putImageData(new ImageData(shown, width), 0, 0)
    return facts
  }

  pixels() {
    return this.#pixels.slice()
  }

  finish() {}
  free() {}
}

const CONTEXT = { alpha: true, antialias: false, depth: false, stencil: false, preserveDrawingBuffer: true }

class Drawn {
  #core
  #functions
  #place
  #gone = false

  constructor(canvas, core, Functions) {
    this.gl = canvas.getContext('webgl2', CONTEXT)
    canvas.addEventListener('webglcontextlost', () => (this.#gone = true))
    if (!this.gl) throw new Error('there is no WebGL 2 here, or the canvas has a context of another kind')
    if (this.lost) throw new Error("the canvas's WebGL context is lost: take another canvas")
    if (!core.c.gl_open) throw new Error('the module without simd128 has no WebGL')
    this.#core = core
    this.#functions = core.gl = new Functions(this.gl, core)
    this.#place = this.#functions.call(() => core.place(core.c.gl_open()))
  }

  /** True if the WebGL context was lost. The answer stays true even if the browser restores the context, since the
      restored context has no objects. */
  get lost() {
    return (this.#gone ||= this.gl.isContextLost())
  }

  #textureOf(pixels, width, height) {
    const { gl } = this
    const rows = ['ROW_LENGTH', 'SKIP_ROWS', 'SKIP_PIXELS'].map((name) => gl[`UNPACK_${name}`])
    const states = [gl.UNPACK_FLIP_Y_WEBGL, gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, ...rows]
    const before = states.map((state) => gl.getParameter(state))
    const [bound, buffer] = [gl.TEXTURE_BINDING_2D, gl.PIXEL_UNPACK_BUFFER_BINDING].map((name) => gl.getParameter(name))
    const bytes = new Uint8Array(pixels.buffer, pixels.byteOffset, pixels.length)
    const texture = gl.createTexture()
    states.forEach((state, i) => gl.pixelStorei(state, i ? 0 : 1))
    gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, null)
    gl.bindTexture(gl.TEXTURE_2D, texture)
    for (const side of ['MIN', 'MAG']) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${side}_FILTER`], gl.NEAREST)
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes)
    gl.bindTexture(gl.TEXTURE_2D, bound)
    gl.bindBuffer(gl.PIXEL_UNPACK_BUFFER, buffer)
    states.forEach((state, i) => gl.pixelStorei(state, before[i]))
    return texture
  }

  draw(core, width, height, { into, alpha, backdrop, ...options }) {
    const { framebuffer = null, x = 0, y = 0, depth } = into ?? {}
    const { gl } = this
    if (!into) resize(gl.canvas, width, height)
    if (!into && (gl.drawingBufferWidth !== width || gl.drawingBufferHeight !== height) && !this.lost)
      throw new Error(`${width} x ${height} pixels are more than the device's canvas can have`)
    core.gl = this.#functions
    if (depth && !(depth.planes?.length === 2 && depth.planes.every((plane) => plane > 0)))
      throw new Error('`into.depth` needs two planes, the distances that 0 and 1 stand for')
    const values = [x, y, ...(depth?.planes ?? [0, 0]), alpha ? 1 : 0, ...valuesOf(core, options)]
    const texture = backdrop ? this.#textureOf(backdrop, width, height) : null
    let failure
    try {
      core.gl.call((gl) => {
        const names = [framebuffer, depth?.texture, texture].map((object) => gl.nameOf(object))
        core.draw('gl_render', this.#place, ...names, ...values)
      })
    } catch (error) {
      failure = error
    } finally {
      if (texture) gl.deleteTexture(texture)
    }
    if (this.lost) throw new Error('the WebGL context was lost: open another Screen, on another canvas')
    if (failure) throw failure
    return core.drawn()
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

  /** Reads a pixel to wait for the GPU, because browsers poll a fence only every 4 ms. */
  finish() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4))
  }

  free() {
    this.#core.gl = this.#functions
    this.#core.c.gl_close(this.#place)
    this.#functions.close()
    this.#core.gl = undefined
  }
}

const BACKENDS = ['wasm', 'webgl2', 'webgpu']

async function wayOf(canvas, backend, core, options) {
  if (backend === 'wasm') return new Copied(canvas)
  if (backend === 'webgpu') return (await import('./webgpu.js')).Computed.open(canvas, core, options, valuesOf)
  const { Functions } = await import('./webgl.js')
  return new Drawn(canvas, core, Functions)
}

export class Screen {
  #core
  #way

  constructor(backend, core, way) {
    this.#core = core
    this.#way = way
    this.backend = backend
    core.scenes++               // the Screen counts as a scene, so the module stays in memory until the Screen is freed
  }

  static async open(canvas, backend, options = {}) {
    numberOf(BACKENDS, backend)
    const core = await coreFor(options)
    return new Screen(backend, core, await wayOf(canvas, backend, core, options))
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

  get device() {
    return this.inside.device
  }

  get milliseconds() {
    return this.inside.milliseconds
  }

  draw(objects, camera = {}, options = {}) {
    const way = this.inside
    const [left, right] = [].concat(camera)
    if (right && this.backend !== 'webgpu') throw new Error('only WebGPU draws two eyes at once')
    const [core, width, height] = begin(objects, left, options)
    if (right) takeCamera(core, objects, right, width, height)
    if (core !== this.#core) throw new Error('the Screen and the scenes are of different modules')
    if (options.backdrop && options.backdrop.length !== 4 * width * height)
      throw new Error(`backdrop: expected ${4 * width * height} numbers`)
    return way.draw(core, width, height, options, objects, right ? 2 : 1)
  }

  pixels() {
    return this.inside.pixels()
  }

  async finish() {
    await this.inside.finish()
  }

  /** Drops the device's copy of a scene that was edited. */
  forget(scene) {
    this.inside.forget?.(scene)
  }

  free() {
    if (!this.#way) return
    this.#way.free()
    this.#way = undefined
    this.#core.scenes--
  }
}

// ---- Frame rates ----------------------------------------------------------------------------------------------

export class Pace {
  #core
  #at

  static async open(options = {}) {
    const pace = new Pace()
    pace.#core = await coreFor(options)
    pace.#core.scenes++
    return pace
  }

  begin({ milliseconds, least = 1, scale = 1 }) {
    const [core, shares] = [this.#core, [least, scale].map((share) => Math.round(65536 * share))]
    this.#at = core.place(core.c.pace(this.#at ?? 0, 1e6 * milliseconds, ...shares))
    Object.assign(this, { scale, isTooSlow: false })
  }

  step(milliseconds) {
    this.#core.check(this.#core.c.pace_step(this.#at, 1e6 * milliseconds))
    const [scale, reason] = this.#core.get(0, 2)
    Object.assign(this, { scale: scale / 65536, isTooSlow: reason === 3 })
  }

  free() {
    this.#core.c.release(this.#at ?? 0)
    this.#core.scenes--
  }
}

// ---- PNG files ------------------------------------------------------------------------------------------------

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

/** Inserts the filter byte 0 before each row of a picture. */
function filtered(pixels, width) {
  const rows = new Uint8Array(pixels.length + pixels.length / (4 * width))
  for (let at = 0, to = 1; at < pixels.length; at += 4 * width, to += 4 * width + 1)
    rows.set(pixels.subarray(at, at + 4 * width), to)
  return rows
}

async function* partsOf(pixels, width, bytes) {
  let there = 0
  for await (const part of ArrayBuffer.isView(pixels) ? [pixels] : pixels) {
    need(ArrayBuffer.isView(part) && part.length % (4 * width) === 0, 'png: pixels: expected parts of whole rows')
    there += part.length
    yield filtered(part, width)
  }
  need(there === bytes, `png: ${there} bytes of pixels: expected ${bytes}`, RangeError)
}

export async function png(pixels, width, height) {
  const isMany = isObject(pixels) && Symbol.asyncIterator in pixels
  need(isMany || ArrayBuffer.isView(pixels), 'png: pixels: expected an array of bytes')
  const isSize = [width, height].every((n) => Number.isInteger(n) && n >= 1)
  need(isSize, `png: ${width} x ${height} pixels: expected 1 or more each`, RangeError)
  const bytes = 4 * width * height
  const words = `png: ${pixels.length} bytes of pixels: ${width} x ${height} have ${bytes}`
  need(isMany || pixels.length === bytes, words, RangeError)
  const header = new DataView(new ArrayBuffer(13))
  header.setUint32(0, width)
  header.setUint32(4, height)
  header.setUint16(8, 0x0806)   // PNG header: 8 bits a channel, RGBA
  const parts = partsOf(pixels, width, bytes)
  let fault
  const rows = new ReadableStream({
    async pull(stream) {
      const { value, done } = await parts.next().catch((error) => (fault = error, { done: true }))
      if (done) stream.close()
      else stream.enqueue(value)
    },
  })
  const deflated = rows.pipeThrough(new CompressionStream('deflate'))
  const body = new Uint8Array(await new Response(deflated).arrayBuffer())
  if (fault) throw fault
  const chunks = [['IHDR', new Uint8Array(header.buffer)], ['IDAT', body], ['IEND', new Uint8Array(0)]]
  const whole = [Uint8Array.of(137, 80, 78, 71, 13, 10, 26, 10), ...chunks.map(([type, data]) => chunkOf(type, data))]
  return new Uint8Array(await new Blob(whole).arrayBuffer())
}
