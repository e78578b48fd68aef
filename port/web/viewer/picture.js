// The picture of a scene in the page: the canvases, the back end that draws on them, and the size of the picture while
// the camera moves.

const AIM_MS = 40 // of a picture in motion
const DIVISORS = [1, 1.5, 2, 3, 4] // beyond, the time is the same
const MOST_PIXELS = 1 << 23
const LEAST_PIXELS = 1 << 14
const SHOWN_MS = 100 // after a worker's picture, the browser shows it
const AGAIN_MS = 5000 // a context that is lost sooner is not asked for again
const TRIES = 3
const BY_PROCESSOR = /swiftshader|llvmpipe|softpipe|software|basic render/i // what WebGL is drawn by

export const backends = {
  wasm: 'the processor',
  webgl2: 'the graphics card',
  'webgl2-quads': 'the graphics card, roughly',
}

let screens = 0

export class Picture {
  #stage
  #screen = null // what is drawn on: { engine, id, canvas, backend, openedAt }
  #tried = true
  #most = MOST_PIXELS
  #divisor = 1 // of width and height in motion

  /** The stage's last child is what is seen: a canvas, or what stands there until the first picture. */
  constructor(stage) {
    this.#stage = stage
  }

  get backend() {
    return this.#screen?.backend
  }

  /** Draws with a back end from now on, or with the one that a trial finds the faster. False where it is another. */
  async open(engine, wanted) {
    const screen = await this.#open(engine, wanted || 'wasm').catch(() => null)
    if (engine !== this.#screen?.engine) [this.#divisor, this.#most] = [1, MOST_PIXELS]
    this.#screen = screen ?? (await this.#open(engine, 'wasm'))
    this.#tried = !!wanted
    return !!screen
  }

  close() {
    this.#screen = null
    this.#stage.replaceChildren()
  }

  /** A canvas below what is seen; its id is 0 where a worker cannot have one and gives pixels instead. */
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
    const divisor = moving ? this.#divisor : 1
    const scale = Math.min(1, Math.sqrt(this.#most / (width * height))) / divisor
    const [w, h] = [width, height].map((n) => Math.max(1, Math.round(n * scale)))
    return { width: w, height: h, divisor }
  }

  /** What was drawn, or null where that is of no use any more. */
  async draw(camera, { divisor, ...options }) {
    const screen = this.#screen
    const { pixels, lost, ...facts } = await screen.engine.ask('draw', screen.id, camera, options)
    if (lost || screen !== this.#screen) return null
    if (pixels) paint(screen.canvas, pixels, options)
    this.#show(screen)
    this.#choose(divisor, facts.milliseconds)
    return { width: options.width, height: options.height, divisor, ...facts, backend: screen.backend }
  }

  #show({ canvas }) {
    if (!canvas.nextSibling) return
    setTimeout(() => {
      for (let last; (last = canvas.nextSibling); last.remove()) last.free?.()
    }, SHOWN_MS)
  }

  /** A picture's time tells by how much the next in motion is to be smaller. */
  #choose(divisor, milliseconds) {
    const fits = (d) => (milliseconds * divisor ** 2) / d ** 2 <= AIM_MS
    const now = DIVISORS.indexOf(this.#divisor)
    const wanted = DIVISORS.findIndex((d) => fits(d) || d === DIVISORS.at(-1))
    const step = Math.sign(wanted - now)
    this.#divisor =
      divisor === 1 ? DIVISORS[wanted] : DIVISORS[step < 0 && milliseconds > AIM_MS / 2 ? now : now + step]
  }

  /** Half as many pixels from now on; false where they are few already. */
  shrink({ width, height }) {
    this.#most = (width * height) / 2
    return this.#most >= LEAST_PIXELS
  }

  // ---- Back ends ----------------------------------------------------------------------------------------------------

  /** The other exact back end's turn, once, out of sight and in a worker of its own: where that is the faster, it draws
      from now on, and this is its engine. */
  async try(newEngine, camera, options) {
    if (this.#tried || !hasGraphicsCard()) return null
    this.#tried = true
    const own = this.#screen
    const engine = newEngine()
    const other = await this.#copy(engine, own).catch(() => null)
    const wins = other && (await isFaster(other, own, camera, options).catch(() => false))
    if (wins && own === this.#screen) {
      this.#screen = other
      return engine
    }
    engine.end()
    other?.canvas.remove()
    return null
  }

  /** Of a scene of which only parts are here there is no copy, and so no trial. */
  async #copy(engine, own) {
    await engine.open(await own.engine.ask('packed'))
    return this.#open(engine, 'webgl2')
  }

  /** Goes on after a context was lost: with another of the same kind, or with the processor. */
  async lost(id) {
    const { engine, id: own, backend, openedAt } = this.#screen ?? {}
    if (!engine || id !== own) return false
    await this.open(engine, performance.now() - openedAt > AGAIN_MS ? backend : 'wasm')
    return true
  }
}

function paint(canvas, pixels, { width, height }) {
  Object.assign(canvas, { width, height })
  canvas.getContext('2d').putImageData(new ImageData(pixels, width), 0, 0)
}

/** Not where the processor does its work. */
function hasGraphicsCard() {
  if (!globalThis.OffscreenCanvas) return false
  const gl = document.createElement('canvas').getContext('webgl2', { failIfMajorPerformanceCaveat: true })
  const info = gl?.getExtension('WEBGL_debug_renderer_info')
  const name = gl?.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER)
  gl?.getExtension('WEBGL_lose_context')?.loseContext()
  return !!gl && !BY_PROCESSOR.test(name)
}

async function isFaster(other, own, camera, { divisor, ...options }) {
  const least = async ({ engine }, id) => {
    const times = []
    while (times.length < TRIES) {
      const { milliseconds, lost } = await engine.ask('draw', id, camera, options)
      times.push(lost ? Infinity : milliseconds)
    }
    return Math.min(...times)
  }
  return (await least(other, other.id)) < (await least(own, 0))
}
