// Walking: the eye stays at its height above the ground. The ground and walls are found in a map of heights, a small
// picture of depths that the worker draws straight down from the eye, of what lies around. It is drawn as every picture
// is, so it has what people see: all scenes, at their places, with the levels of detail that there are.
import { add, cross, dot, unit } from './motion.js'

const CELLS = 48 // of a map's side
const FOCAL = 4096 // the renderer's steps of a focal length, in pixels a unit
// The rest of these lengths are in heights of the eye.
const CELL = 1 / 16
const REACH = 1.25 // from the middle of a map: beyond, the next is waited for
const STALE = 0.4 // so far from there the next is asked for
const FOOT = 0.12 // around it the ground is looked at
const BODY = 0.2 // as near things come
const STEP = 0.25 // is climbed
const DROP = 2 // is gone down; what lies deeper is a hole
const STRIDE = 0.05 // of one step of the way, at most
const BACK = 0.4 // from a point that is gone to
const PACE = 2.5 // a second, at a speed of 1
const LEAST = 3 // cells that stop: fewer are stray Gaussians
const EASE = 10 // of what the eye lacks of its height, a second
const STALE_MS = 1000
const GLIDE_MS = 500
const TRIES = 8 // places for the first step, from the camera to what it looks at
const ASIDE = [0, 20, -20, 40, -40, 60, -60, 80, -80].map((degrees) => (degrees * Math.PI) / 180) // along a wall

/** The mean of the middle half, which stray Gaussians do not move. */
function middle(list) {
  const [from, to] = [list.length >> 2, list.length - (list.length >> 2)]
  const half = list.sort((a, b) => a - b).slice(from, to)
  return half.reduce((sum, x) => sum + x, 0) / half.length
}

/** Heights of what is below a place, along `up`: cells of `cell` units, for an eye of one height. */
class Ground {
  constructor(facts) {
    Object.assign(this, facts)
    this.time = performance.now()
    this.level = dot(this.place, this.axes.up)
  }

  /** Of cells around a point; -Infinity where nothing is. */
  heights(point, radius) {
    const from = add(point, this.place, -1)
    const [x, y] = [this.axes.right, this.axes.down].map((axis) => dot(from, axis) / this.cell + CELLS / 2 - 0.5)
    const far = radius / this.cell
    const found = []
    for (let j = Math.ceil(y - far); j <= y + far; j++)
      for (let i = Math.ceil(x - far); i <= x + far; i++)
        if (Math.min(i, j) >= 0 && Math.max(i, j) < CELLS && (i - x) ** 2 + (j - y) ** 2 <= far ** 2)
          found.push(this.level - this.depths[CELLS * j + i])
    return found
  }

  /** How far a point is from the middle, across. */
  distance(point) {
    const from = add(point, this.place, -1)
    return Math.hypot(dot(from, this.axes.right), dot(from, this.axes.down))
  }
}

export class Walker {
  #pilot
  #host
  #ground = null
  #asking = null
  #feet = 0 // how high the ground is on which it stands
  #floats = false // where there has been no ground yet
  #eye = null // where it has put the eye; another one is elsewhere, and has to come down
  #usual = { scene: null, height: 1 }
  #last = 0 // of rising and sinking

  /** The host has scene(), height() (0 for the usual one), draw(camera, size), a promise of depths, and note(words). */
  constructor(pilot, host) {
    this.#pilot = pilot
    this.#host = host
  }

  /** Of the eye above the ground, scene units. */
  get height() {
    return this.#host.height() || this.#usual.height
  }

  /** Where no number is given. */
  get usual() {
    return this.#usual.height
  }

  get #up() {
    return unit(this.#pilot.up)
  }

  /** A level direction; that of the camera's up where it looks straight up or down. */
  #level(camera) {
    const up = this.#up
    const ahead = add(camera.look, camera.eye, -1)
    const flat = (a) => add(a, up, -dot(a, up))
    const level = flat(ahead)
    const steep = Math.hypot(...level) < 1e-3 * Math.hypot(...ahead)
    return unit(steep ? flat(camera.up.map((x) => -Math.sign(dot(ahead, up)) * x)) : level)
  }

  /** Stands on the ground: in front of a point, or below the camera, or where there is the first on the way to what the
      camera looks at. */
  async begin(point = null) {
    const own = (this.#asking = {})
    const { camera } = this.#pilot
    await this.#findUsual()
    const spot = point ? this.#before(point, camera) : await this.#spot(camera)
    if (own === this.#asking && camera === this.#pilot.camera) await this.#settle(camera, spot)
    if (own === this.#asking) this.#asking = null
  }

  async #settle(camera, spot) {
    this.#floats = !spot
    if (!spot) this.#host.note('There is no ground below')
    const to = this.#upright(camera, spot ?? camera.eye)
    const isFar = Math.hypot(...add(to.eye, camera.eye, -1)) > STRIDE * this.height
    if (!(await this.#pilot.glide(to, isFar ? GLIDE_MS : 0))) return
    this.#ground = await this.#map(to.eye, this.height)
    if (!this.#ground) return
    this.#eye = to.eye
    this.#feet = this.#groundAt(this.#ground, to.eye, this.height) ?? dot(to.eye, this.#up) - this.height
    this.#ease()
  }

  /** A photograph is taken from eye level. Where the camera was chosen to show all, the scene's own height tells. */
  async #findUsual() {
    const scene = this.#host.scene()
    if (this.#usual.scene === scene) return
    const { low, high, start } = scene
    const up = this.#up
    const tall = Math.max(up.reduce((sum, x, i) => sum + Math.abs(x) * (high[i] - low[i]), 0), 1e-3)
    const isTaken = start || this.#pilot.views.length || this.#pilot.home()
    const { eye } = this.#pilot.start
    const ground = isTaken && (await this.#map(eye, tall / 16))
    const feet = ground ? this.#groundAt(ground, eye, tall / 16) : null
    const height = feet === null ? tall / 8 : Math.min(dot(eye, up) - feet, tall / 2)
    this.#usual = { scene, height: Math.max(height, tall / 100) }
  }

  async #map(eye, height) {
    const up = this.#up
    const forward = up.map((x) => -x)
    const aside = Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1]
    const right = unit(add(aside, up, -dot(aside, up)))
    const axes = { up, right, down: cross(forward, right) }
    const fx = Math.max(1, Math.round(FOCAL / (CELL * height))) / FOCAL
    const [near, half] = [height / 50, CELLS / 2]
    const rotation = [0, 1, 2].map((i) => [right[i], axes.down[i], forward[i]])
    const camera = { rotation, position: eye, fx, cx: half, cy: half, near, orthographic: true }
    const size = { width: CELLS, height: CELLS }
    const depths = await this.#host.draw({ ...camera, ...size }, size).catch(() => null)
    return depths && new Ground({ place: eye, axes, cell: 1 / fx, height, depths })
  }

  /** How high the ground below a point is, between two heights; null where there is none. */
  #groundAt(ground, point, height, low = -Infinity, high = Infinity) {
    const found = ground.heights(point, FOOT * height).filter((y) => y > low && y <= high)
    return found.length ? middle(found) : null
  }

  /** A place for the eye, above ground. */
  async #spot(camera) {
    const up = this.#up
    const way = add(camera.look, camera.eye, -1)
    const level = add(way, up, -dot(way, up))
    for (let i = 0; i <= TRIES; i++) {
      const place = add(camera.eye, level, i / TRIES)
      const ground = await this.#map(place, this.height)
      const feet = ground && this.#groundAt(ground, place, this.height)
      if (feet !== null) return add(place, up, feet + this.height - dot(place, up))
    }
    return null
  }

  /** In front of a point that was looked at from a camera, the eye at its height above it. */
  #before(point, camera) {
    return add(add(point, this.#level(camera), -BACK * this.height), this.#up, this.height)
  }

  /** A camera at a place, that looks where it did, or ahead where that is too near or too far up or down. */
  #upright(camera, eye) {
    const up = this.#up
    const ahead = add(camera.look, eye, -1)
    const rise = dot(ahead, up)
    const far = dot(add(ahead, up, -rise), this.#level(camera))
    const level = Math.max(far, this.height)
    const look = add(add(eye, this.#level(camera), level), up, Math.max(-level, Math.min(rise, level)))
    return { ...camera, eye, look, up, flat: false, shift: [0, 0], fov: camera.flat ? this.#pilot.fov : camera.fov }
  }

  // ---- Steps --------------------------------------------------------------------------------------------------------

  /** To the right and ahead, seconds at full speed. */
  go(right, forward) {
    const { camera } = this.#pilot
    if (!this.#host.scene() || !(right || forward)) return
    if (camera.eye !== this.#eye || this.#ground?.height !== this.height) {
      if (!this.#asking) this.begin()
      return
    }
    const up = this.#up
    const ahead = this.#level(camera)
    const way = add(ahead.map((x) => x * forward), cross(ahead, up), right)
    const whole = Math.hypot(...way) * this.#pilot.speed * PACE * this.height
    const steps = Math.ceil(whole / (STRIDE * this.height))
    let place = camera.eye
    for (let i = 0; i < steps; i++) place = this.#step(place, unit(way), whole / steps)
    if (place !== camera.eye) this.#put(place)
    this.#look(place)
    this.#ease()
  }

  /** One step, or as much of it along a wall as there is room for. */
  #step(place, way, length) {
    const up = this.#up
    const now = this.#stops(place)
    for (const angle of ASIDE) {
      const turned = add(way.map((x) => x * Math.cos(angle)), cross(up, way), Math.sin(angle))
      const next = add(place, turned, length * Math.cos(angle))
      if (this.#ground.distance(next) > REACH * this.height) return place
      if (this.#stops(next) > Math.max(now, LEAST - 1)) continue
      this.#stand(next)
      return next
    }
    return place
  }

  /** Cells around a place that are too high for a step. */
  #stops(place) {
    const limit = this.#feet + STEP * this.height
    return this.#ground.heights(place, BODY * this.height).filter((y) => y > limit).length
  }

  /** On the ground there; over a hole the last one counts. */
  #stand(place) {
    const { height } = this
    const low = this.#floats ? -Infinity : this.#feet - DROP * height
    const feet = this.#groundAt(this.#ground, place, height, low, this.#feet + STEP * height)
    if (feet === null) return
    this.#feet = feet
    this.#floats = false
  }

  #put(eye) {
    const { camera } = this.#pilot
    this.#eye = eye
    this.#pilot.act({ ...camera, eye, look: add(camera.look, add(eye, camera.eye, -1)) })
  }

  /** Has the next map drawn, where this one is of another place or time. */
  async #look(place) {
    const { height } = this
    const level = this.#feet + height
    const isNear = this.#ground.distance(place) < STALE * height && Math.abs(this.#ground.level - level) < STEP * height
    if (this.#asking || (isNear && performance.now() - this.#ground.time < STALE_MS)) return
    const own = (this.#asking = {})
    const ground = await this.#map(add(place, this.#up, level - dot(place, this.#up)), height)
    if (own !== this.#asking) return
    this.#asking = null
    if (!ground || this.#pilot.camera.eye !== this.#eye) return
    this.#ground = ground
    this.#stand(this.#eye)
    this.#ease()
  }

  /** The height is another. */
  stand() {
    if (this.#pilot.camera?.eye === this.#eye) this.#ease()
  }

  /** Brings the eye to its height, a part of the way with each picture, unless the camera is on its way elsewhere. */
  #ease() {
    if (this.#last) return
    const step = (now) => {
      const seconds = Math.min((now - this.#last) / 1000, 0.1)
      const up = this.#up
      const { eye } = this.#pilot.camera
      const lacks = eye === this.#eye && !this.#pilot.gliding ? this.#feet + this.height - dot(eye, up) : 0
      const isNear = Math.abs(lacks) < 1e-3 * this.height
      if (lacks) this.#put(add(eye, up, isNear ? lacks : lacks * (1 - Math.exp(-EASE * seconds))))
      this.#last = isNear ? 0 : now
      if (!isNear) requestAnimationFrame(step)
    }
    this.#last = performance.now()
    requestAnimationFrame(step)
  }
}
