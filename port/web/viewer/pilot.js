// Moves the camera of the viewer: glides between views, and applies the input of pointers and keys in the modes orbit,
// fly and walk.
import * as motion from './motion.js'

const GLIDE_MS = 350
const IDLE_MS = 2500 // milliseconds without input before the scene turns by itself
const TURN = 0.25 // speed of the turning scene in radians a second
const UPRIGHT = [0, -1, 0]
const BY_KEY = 400
const BY_ZOOM = 4 // seconds of walking that replace a zoom by 100 % in the walk mode

export class Pilot {
  camera = null
  mode = 'orbit' // how the user moves the camera: 'orbit', 'fly' or 'walk'
  walker = null
  up = UPRIGHT
  views = []
  index = 0
  home = () => null
  speed = 0.5
  fov = 50
  ahead = null
  turns = false
  touched = false
  gliding = null
  #element
  #moved
  #scene = null
  #given = false
  #actedAt = 0
  #turning = 0

  /** The caller's function moved(isMoving, byHand) is called after each change of the camera. */
  constructor(element, moved) {
    this.#element = element
    this.#moved = moved
  }

  take(scene) {
    this.#scene = scene
    this.ahead = null
  }

  takeViews(views, view, home = () => null) {
    this.views = views
    this.index = 0
    this.home = views.length ? () => null : home
    const { first } = this.#scene
    this.#given = false
    this.up = views.length && !first.known ? motion.upOf(views, this.up) : first.up
    const settings = this.home()
    if (settings && !motion.isLevel(settings, this.up)) this.up = settings.up
    this.show(view ?? this.start)
  }

  get start() {
    return this.#given ? motion.level(this.#begins, this.up) : this.#begins
  }

  get #begins() {
    const home = this.home()
    if (home) return home
    const view = this.views[this.index] ?? (this.up === this.#scene.first.up ? this.#scene.start : null)
    return view ? motion.ofView(view, this.#scene, this.#aspect) : this.whole
  }

  get #aspect() {
    const { clientWidth, clientHeight } = this.#element
    return clientWidth / clientHeight || 1
  }

  get whole() {
    const { first } = this.#scene
    const asFound = this.up === first.up ? first : undefined
    return motion.seeAll(this.#scene, this.up, this.fov, this.#aspect, asFound)
  }

  get radius() {
    return Math.max(Math.hypot(...motion.add(this.#scene.high, this.#scene.low, -1)) / 2, 1e-3)
  }

  rendered({ width, height }, camera = this.camera) {
    return motion.rendered(camera, width, height, Math.min(this.radius / 100, 0.2))
  }

  show(camera) {
    if (!camera || !this.#scene) return
    this.camera = camera
    this.#moved(false, false)
  }

  follow(camera) {
    if (!this.#scene) return
    this.#actedAt = performance.now()
    this.touched = true
    this.#move(camera)
  }

  #move(camera, byHand = false) {
    this.camera = camera
    this.#moved(true, byHand)
  }

  async glide(to, duration = GLIDE_MS) {
    if (!this.#scene) return false
    const [from, start] = [this.camera, performance.now()]
    this.#actedAt = start
    this.touched = true
    if (duration <= 0 || matchMedia('(prefers-reduced-motion: reduce)').matches) return this.show(to) ?? true
    const own = (this.gliding = {})
    return new Promise((done) => {
      let last = from
      const end = (isThere) => {
        if (this.gliding === own) this.gliding = null
        done(isThere)
      }
      const step = (now) => {
        if (this.camera !== last || this.gliding !== own) return end(false)
        const t = Math.max(0, Math.min((now - start) / duration, 1))
        this.#actedAt = now
        this.#move((last = t < 1 ? motion.between(from, to, t) : to))
        if (t < 1) requestAnimationFrame(step)
        else end(true)
      }
      requestAnimationFrame(step)
    })
  }

  goTo(point) {
    if (this.walks) return this.walker?.begin(point)
    const eye = motion.add(point, motion.add(this.camera.eye, point, -1), 0.6)
    this.glide({ ...this.camera, eye, look: point })
  }

  flatten(flat) {
    if (this.#scene) this.show(motion.flatten(this.camera, flat, this.fov))
  }

  widen(fov) {
    this.fov = fov
    if (this.#scene) this.show({ ...this.camera, fov })
  }

  upright(up) {
    this.#given = !!up
    this.up = up ?? this.#scene?.first.up ?? UPRIGHT
    if (this.#scene) this.show(this.start)
  }

  turnByItself(on) {
    if (this.turns === on) return
    this.turns = on
    cancelAnimationFrame(this.#turning)
    let last = performance.now()
    const step = (now) => {
      const seconds = Math.min((now - last) / 1000, 0.1)
      last = now
      if (this.camera && now - this.#actedAt > IDLE_MS)
        this.#move(motion.orbit(this.camera, this.up, TURN * seconds, 0))
      this.#turning = requestAnimationFrame(step)
    }
    if (on) this.#turning = requestAnimationFrame(step)
  }

  // ---- Input of pointers and keys -----------------------------------------------------------------------------------

  acts(others) {
    const names = ['drag', 'look', 'pan', 'zoom', 'fly', 'arrows', 'turn']
    return { ...others, ...Object.fromEntries(names.map((name) => [name, (...args) => this[name](...args)])) }
  }

  act(camera) {
    this.touched = true
    this.#actedAt = performance.now()
    this.#move(camera, true)
  }

  /** Turns the camera by a drag of dx, dy pixels. A drag across the height of the element is half a turn. */
  #turned(turn, dx, dy) {
    const angle = Math.PI / this.#element.clientHeight
    if (this.#scene && (dx || dy)) this.act(turn(this.camera, this.up, dx * angle, dy * angle))
  }

  get isFlying() {
    return this.mode === 'fly'
  }

  get walks() {
    return this.mode === 'walk'
  }

  drag(dx, dy) {
    this.#turned(this.mode === 'orbit' ? motion.orbit : motion.lookAround, dx, dy)
  }

  look(dx, dy) {
    this.#turned(motion.lookAround, dx, dy)
  }

  pan(dx, dy) {
    if (this.walks) this.drag(dx, dy)
    else if (this.#scene) this.act(motion.pan(this.camera, this.#element.clientHeight, dx, dy))
  }

  zoom(factor) {
    if (!this.#scene) return
    if (this.walks) this.walker?.go(0, BY_ZOOM * (1 - factor))
    else if (this.isFlying && !this.camera.flat) this.act(motion.fly(this.camera, 0, 0, (1 - factor) * this.#reach))
    else this.act(motion.zoom(this.camera, factor, 1e-4 * this.radius))
  }

  fly(right, down, forward) {
    if (!this.#scene || !(right || down || forward)) return
    if (this.walks) {
      this.turn(-down, 0)
      return this.walker?.go(right, forward)
    }
    const step = this.speed * this.#reach
    this.act(motion.fly(this.camera, right * step, down * step, forward * step))
  }

  arrows(right, down) {
    if (this.walks) this.fly(right, 0, -down)
    else this.turn(right, down)
  }

  turn(right, down) {
    const sign = this.mode === 'orbit' ? -BY_KEY : BY_KEY
    this.drag(sign * right, sign * down)
  }

  get #reach() {
    const to = this.isFlying ? this.ahead : this.camera.look
    const far = to ? motion.distance({ eye: this.camera.eye, look: to }) : this.radius
    return Math.min(Math.max(far, 0.05 * this.radius), 2 * this.radius)
  }
}
