// The picture in the page: its canvas, back end and size. The first back end is 'wasm', unless the page names another.
// A trial then times the GPU back ends once, and the fastest back end draws.

const MOST_PIXELS = 1 << 23
const LEAST_PIXELS = 1 << 14
const SHOWN_MS = 100
const AGAIN_MS = 5000 // milliseconds: a back end that loses its context sooner after its opening is not opened again
const TRIES = 3
const MOST_TRIES = 50 // number of pictures after which a back end that lacks parts of a streamed scene is given up
const BY_PROCESSOR = /swiftshader|llvmpipe|lavapipe|softpipe|software|basic render/i
const NEXT = { webgpu: 'webgl2', webgl2: 'wasm' }

export const backends = {
  wasm: 'the processor',
  webgpu: 'the graphics card',
  webgl2: 'the graphics card and the processor',
}

let screens = 0

export class Picture {
  #stage
  #screen = null
  #tried = true
  #most = MOST_PIXELS
  #scale = 1 // width of moving pictures, as a share of the full width; the worker chooses it

  constructor(stage) {
    this.#stage = stage
  }

  get backend() {
    return this.#screen?.backend
  }

  /** Opens the back end `wanted` for drawing. If `wanted` is not given, opens 'wasm', and a later trial may choose the
      GPU. Returns false if a wanted back end of the GPU fails and 'wasm' replaces it. */
  async open(engine, wanted) {
    const backend = wanted || 'wasm'
    const screen = await this.#openNext(engine, backend)
    if (engine !== this.#screen?.engine) [this.#scale, this.#most] = [1, MOST_PIXELS]
    this.#screen = screen
    this.#tried = !!wanted
    return screen.backend === backend || screen.backend !== 'wasm'
  }

  #openNext(engine, backend) {
    return this.#open(engine, backend).catch((error) => {
      if (!NEXT[backend]) throw error
      return this.#openNext(engine, NEXT[backend])
    })
  }

  close() {
    if (this.#screen) free(this.#screen.canvas)
    this.#screen = null
    this.#stage.replaceChildren()
  }

  /** Makes a canvas below the visible canvas and opens a back end. The id 0 means that the browser has no canvas for
      workers, so the worker returns pixels. */
  async #open(engine, backend) {
    const canvas = document.createElement('canvas')
    const id = canvas.transferControlToOffscreen ? ++screens : 0
    if (!id && backend !== 'wasm') throw new Error('no canvas for a worker')
    if (id) await engine.ask('screen', id, canvas.transferControlToOffscreen(), backend)
    if (id) canvas.free = () => engine.ask('close', id).catch(() => {})
    this.#stage.prepend(canvas)
    return { engine, id, canvas, backend, openedAt: performance.now() }
  }

  // ---- Drawing ------------------------------------------------------------------------------------------------------

  size(width, height, moving) {
    const divisor = moving ? 1 / this.#scale : 1
    const scale = Math.min(1, Math.sqrt(this.#most / (width * height))) / divisor
    const [w, h] = [width, height].map((n) => Math.max(1, Math.round(n * scale)))
    return { width: w, height: h, divisor, moving }
  }

  async draw(camera, { divisor, moving, ...options }) {
    const screen = this.#screen
    const { pixels, lost, scale, ...facts } = await screen.engine.ask('draw', screen.id, camera, options, moving)
    if (lost || screen !== this.#screen) return null
    if (pixels) paint(screen.canvas, pixels, options)
    this.#show(screen)
    this.#scale = scale
    return { width: options.width, height: options.height, divisor, ...facts, backend: screen.backend }
  }

  #show({ canvas }) {
    if (!canvas.nextSibling) return
    setTimeout(() => {
      while (canvas.nextSibling) free(canvas.nextSibling)
    }, SHOWN_MS)
  }

  shrink({ width, height }) {
    this.#most = (width * height) / 2
    return this.#most >= LEAST_PIXELS
  }

  // Times the GPU back ends once. If one of them is faster than the present back end, returns the engine (worker) that
  // draws with it, else null.
  async try(newEngine, copy, camera, options) {
    if (this.#tried) return null
    this.#tried = true
    const own = this.#screen
    const backends = await ofGraphicsCard()
    if (!backends.length || own !== this.#screen) return null
    const engine = newEngine()
    const others = await this.#copies(engine, copy, backends).catch(() => [])
    const found = await fastest(own, others, camera, options).catch(() => own)
    const wins = found !== own && own === this.#screen
    for (const other of others) if (!wins || other !== found) free(other.canvas)
    if (wins) [this.#screen, this.#scale] = [found, 1]
    else if (engine !== own.engine) engine.end()
    return wins ? engine : null
  }

  async #copies(engine, copy, backends) {
    await copy(engine)
    const opened = []
    for (const backend of backends) opened.push(await this.#open(engine, backend).catch(() => null))
    return opened.filter(Boolean)
  }

  async lost(id) {
    const { engine, id: own, backend, openedAt } = this.#screen ?? {}
    if (!engine || id !== own) return false
    await this.open(engine, performance.now() - openedAt > AGAIN_MS ? backend : NEXT[backend])
    return true
  }
}

function paint(canvas, pixels, { width, height }) {
  Object.assign(canvas, { width, height })
  canvas.getContext('2d').putImageData(new ImageData(pixels, width), 0, 0)
}

function free(canvas) {
  canvas.free?.()
  canvas.remove()
}

async function ofGraphicsCard() {
  if (!globalThis.OffscreenCanvas) return []
  return [(await hasWebGpu()) && 'webgpu', hasWebGl() && 'webgl2'].filter(Boolean)
}

async function hasWebGpu() {
  const { info } = (await navigator.gpu?.requestAdapter().catch(() => null)) ?? {}
  const names = [info?.vendor, info?.architecture, info?.device, info?.description]
  return !!info && !info.isFallbackAdapter && !names.some((name) => BY_PROCESSOR.test(name))
}

function hasWebGl() {
  const gl = document.createElement('canvas').getContext('webgl2', { failIfMajorPerformanceCaveat: true })
  const info = gl?.getExtension('WEBGL_debug_renderer_info')
  const name = gl?.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER)
  gl?.getExtension('WEBGL_lose_context')?.loseContext()
  return !!gl && !BY_PROCESSOR.test(name)
}

async function fastest(own, others, camera, { divisor, ...options }) {
  const least = async ({ engine }, id) => {
    const times = []
    for (let i = 0; times.length < TRIES && i < MOST_TRIES; i++) {
      const { milliseconds, lost, missing } = await engine.ask('draw', id, camera, options)
      if (lost || !missing) times.push(lost ? Infinity : milliseconds)
    }
    return Math.min(...times)
  }
  let [found, time] = [own, others.length ? Infinity : 0]
  for (const other of others) {
    const taken = await least(other, other.id).catch(() => Infinity)
    if (taken < time) [found, time] = [other, taken]
  }
  return found === own || (await least(own, 0)) <= time ? own : found
}
