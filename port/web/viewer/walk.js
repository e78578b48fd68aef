// Walking: the eye stays at its height above the ground, low steps are climbed, and walls stop the walk. A height map
// finds ground and walls. The height map is a small orthographic picture of depths, straight down from the eye. With
// the viewer's attribute `walls`, voxels stop the walk instead.
import { add, cross, dot, unit } from './motion.js'

const CELLS = 48
const FOCAL = 4096 // the renderer rounds focal lengths (pixels for a scene unit) to multiples of 1 / FOCAL
// The constants from CELL to PACE are lengths, as multiples of the eye's height above the ground.
const CELL = 1 / 16
const REACH = 1.25 // distance from the middle of a height map beyond which a walk waits for the next map
const STALE = 0.4 // distance from the middle of a height map beyond which the next map is requested
const FOOT = 0.12 // radius around a point in which the height of the ground is measured
const BODY = 0.2 // smallest distance of the eye to walls
const STEP = 0.25 // largest height of a step that is climbed
const DROP = 2 // largest depth that is stepped down; a deeper drop is a hole
const STRIDE = 0.05 // longest single step of the walk, in heights of the eye
const BACK = 0.4 // distance before a point chosen by the user at which the walk ends
const PACE = 2.5 // distance walked in a second at a speed setting of 1
const LEAST = 3 // number of blocked cells of the height map that stop the walk; fewer cells are stray Gaussians
const EASE = 10 // rate a second at which the eye exponentially approaches its height above the ground
const STALE_MS = 1000 // milliseconds after which a height map is renewed
const GLIDE_MS = 500
const TRIES = 8
// Angles in radians between the wanted direction and the directions that are tried to walk along a wall.
const ASIDE = [0, 20, -20, 40, -40, 60, -60, 80, -80].map((degrees) => (degrees * Math.PI) / 180)

/** Returns the mean of the middle half of a list, robust against stray Gaussians. */
function middle(list) {
  const [from, to] = [list.length >> 2, list.length - (list.length >> 2)]
  const half = list.sort((a, b) => a - b).slice(from, to)
  return half.reduce((sum, x) => sum + x, 0) / half.length
}

/** A height map of the scene below a place; `up` is the up direction. `cell` is the size of a cell in scene units. */
class Ground {
  constructor(facts) {
    Object.assign(this, facts)
    this.time = performance.now()
    this.level = dot(this.place, this.axes.up)
  }

  /** Returns the heights of the height map's cells around a point; -Infinity for an empty cell. */
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
  #feet = 0
  #floats = false
  #eye = null // position of the eye after the last step of walking; if the eye is elsewhere, begin() must be called
  #usual = { scene: null, height: 1 }
  #last = 0
  #walls = {}

  /** `host` is an object with functions. draw(camera, size) returns a promise of depths. height() returns the wanted
      height of the eye; 0: the estimated height. walls() returns the address of a .voxel.json; null: none. */
  constructor(pilot, host) {
    this.#pilot = pilot
    this.#host = host
  }

  get height() {
    return this.#host.height() || this.#usual.height
  }

  get usual() {
    return this.#usual.height
  }

  get #up() {
    return unit(this.#pilot.up)
  }

  /** Returns the horizontal direction of view of a camera. If the camera looks straight up or down, its up vector gives
      the direction. */
  #level(camera) {
    const up = this.#up
    const ahead = add(camera.look, camera.eye, -1)
    const flat = (a) => add(a, up, -dot(a, up))
    const level = flat(ahead)
    const steep = Math.hypot(...level) < 1e-3 * Math.hypot(...ahead)
    return unit(steep ? flat(camera.up.map((x) => -Math.sign(dot(ahead, up)) * x)) : level)
  }

  /** Begins a walk by moving the eye to its height above the ground. The place is in front of the given point, else
      below the camera, else on the way to the camera's target. */
  async begin(point = null) {
    const own = (this.#asking = {})
    const { camera } = this.#pilot
    await Promise.all([this.#findUsual(), this.#findWalls()])
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

  /** Estimates the eye's height above the ground from the start view, else as an eighth of the scene's height. */
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

  async #findWalls() {
    const address = this.#host.walls()
    if (this.#walls.address === address) return
    const walls = (this.#walls = { address })
    const read = address && import('./voxels.js').then((file) => file.readVoxels(address))
    walls.voxels = await read?.catch(({ message }) => this.#host.note(message))
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

  #groundAt(ground, point, height, low = -Infinity, high = Infinity) {
    const found = ground.heights(point, FOOT * height).filter((y) => y > low && y <= high)
    return found.length ? middle(found) : null
  }

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

  #before(point, camera) {
    return add(add(point, this.#level(camera), -BACK * this.height), this.#up, this.height)
  }

  #upright(camera, eye) {
    const up = this.#up
    const ahead = add(camera.look, eye, -1)
    const rise = dot(ahead, up)
    const far = dot(add(ahead, up, -rise), this.#level(camera))
    const level = Math.max(far, this.height)
    const look = add(add(eye, this.#level(camera), level), up, Math.max(-level, Math.min(rise, level)))
    return { ...camera, eye, look, up, flat: false, shift: [0, 0], fov: camera.flat ? this.#pilot.fov : camera.fov }
  }

  // ---- Walking ------------------------------------------------------------------------------------------------------

  /** Walks to the right and ahead. Both arguments are walking times in seconds at full speed. */
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

  /** Takes one step of the walk, along a wall if the way is blocked. Returns the new position. */
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

  #stops(place) {
    const limit = this.#feet + STEP * this.height
    const { voxels } = this.#walls
    if (voxels) return voxels.stops(place, this.#up, BODY * this.height, limit, this.#feet + this.height)
    return this.#ground.heights(place, BODY * this.height).filter((y) => y > limit).length
  }

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

  stand() {
    if (this.#pilot.camera?.eye === this.#eye) this.#ease()
  }

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
