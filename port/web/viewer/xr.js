// Shows the scene in a headset or a phone by WebXR. The worker draws a picture for each eye at the latest pose of the
// head. Each frame shows the latest complete pictures, reprojected to the present pose (eyes.js), since drawing takes
// longer than a frame.
import { cameraOf, Eyes, Scale } from './eyes.js'
import { add, cross, distance, dot, rotate, unit } from './motion.js'

const REACH = 2 // metres: distance from the head to the target of the camera when VR starts
const NEAR = 0.1
const AIM_MS = 50 // drawing time in milliseconds to aim at for the pictures of both eyes
const METRES_A_SECOND = 1.5
const TURN = Math.PI / 6
// Deflection of a thumbstick that starts a turn, and deflection below which the next turn is allowed.
const [PUSHED, IDLE] = [0.7, 0.3]
const DEAD = 0.15

/** The placement of the user's room in the scene: its axes (right, up, back), its origin, and the number of scene units
    in a metre. */
export class Place {
  constructor(axes, units, origin = [0, 0, 0]) {
    Object.assign(this, { axes, units, origin })
  }

  /** Returns a placement of the room with a level floor. The horizontal direction (hx, hz) of the room becomes the
      camera's direction of view. */
  static towards([hx, hz], { camera, up }, units) {
    const y = unit(up)
    const level = (a) => add(a, y, -dot(a, y))
    const forward = add(camera.look, camera.eye, -1)
    const steep = Math.hypot(...level(forward)) < 0.01 * Math.hypot(...forward)
    const ahead = unit(level(steep ? camera.up.map((x) => -Math.sign(dot(forward, y)) * x) : forward))
    const right = cross(ahead, y)
    const mixed = (a, b) => add(ahead.map((x) => a * x), right, b)
    return new Place([mixed(hx, -hz), y, mixed(hz, hx)], units)
  }

  static of(view, { matrix, position }) {
    const place = Place.towards(unit([-matrix[8], -matrix[10]]), view, distance(view.camera) / REACH)
    return place.held(numbers(position), view.camera.eye)
  }

  turned([x, y, z]) {
    return [0, 1, 2].map((i) => x * this.axes[0][i] + y * this.axes[1][i] + z * this.axes[2][i])
  }

  at(point) {
    return add(this.origin, this.turned(point), this.units)
  }

  from(there) {
    const to = add(there, this.origin, -1)
    return this.axes.map((axis) => dot(axis, to) / this.units)
  }

  held(point, there) {
    const moved = new Place(this.axes, this.units)
    moved.origin = add(there, moved.turned(point), -this.units)
    return moved
  }

  shifted(by, times) {
    return new Place(this.axes, this.units, add(this.origin, by, times))
  }

  /** Returns the placement of the room, turned to the right about the vertical. The number of scene units in a metre is
      multiplied by `times`. */
  changed(angle, times) {
    const axes = this.axes.map((axis) => rotate(axis, this.axes[1], -angle))
    return new Place(axes, this.units * times, this.origin)
  }

  about(point, angle, times) {
    return this.changed(angle, times).held(point, this.at(point))
  }
}

export const numbers = ({ x, y, z }) => [x, y, z]

const stickOf = ({ gamepad }) => (gamepad ? gamepad.axes.slice(gamepad.axes.length >= 4 ? 2 : 0) : [])
const pushed = (x = 0) => (Math.abs(x) < DEAD ? 0 : x)

const drop = (gl) => gl?.getExtension('WEBGL_lose_context')?.loseContext()

/** The class Walker is the Guide of the VR mode, which places the room in the scene. It starts at the page's camera,
    and the user moves by thumbsticks. */
class Walker {
  #host
  #turning = false

  constructor(host) {
    this.#host = host
  }

  /** Moves the user by the thumbsticks. The left stick moves in the direction of view. The right stick turns, and moves
      up and down. */
  step(place, { pose, session, seconds }) {
    const { matrix, position } = pose.transform
    place ??= Place.of(this.#host.view(), pose.transform)
    const axis = (i) => place.turned([matrix[4 * i], matrix[4 * i + 1], matrix[4 * i + 2]])
    const step = seconds * METRES_A_SECOND * place.units
    let turn = 0
    for (const source of session.inputSources) {
      const [x, y] = stickOf(source)
      if (source.handedness === 'right') turn = x ?? 0
      if (source.handedness === 'right') place = place.shifted(place.axes[1], -pushed(y) * step)
      else place = place.shifted(axis(0), pushed(x) * step).shifted(axis(2), pushed(y) * step)
    }
    if (Math.abs(turn) < IDLE) this.#turning = false
    if (Math.abs(turn) < PUSHED || this.#turning) return place
    this.#turning = true
    return place.about(numbers(position), Math.sign(turn) * TURN, 1)
  }
}

/** A mode (VR or AR) has the type of the WebXR session, texts, and the class Guide. It also lists the reference spaces
    to try in order. A Guide places the room in the scene: step(place, now) returns the Place of a frame, or null if
    none is chosen yet. */
export const VR = {
  session: 'immersive-vr',
  name: 'The headset:',
  lost: 'The headset: its graphics context was lost',
  spaces: ['local'],
  clear: false,
  Guide: Walker,
}

export class Headset {
  #host
  #mode
  #guide
  #session = null
  #space
  #layer
  #eyes
  #gl
  #scale
  #place = null
  #asked = null
  #entering = false
  #grips = []
  #last = 0

  constructor(host) {
    this.#host = host
  }

  get isOn() {
    return !!this.#session
  }

  async enter(mode = VR) {
    if (this.#session || this.#entering) return this.end()
    this.#entering = true
    this.#mode = mode
    this.#guide = new mode.Guide(this.#host)
    let gl
    try {
      gl = this.#open()
      this.#session = await navigator.xr.requestSession(mode.session, this.#guide.options)
      await this.#begin(gl)
    } catch (error) {
      if (this.#session) this.end()
      else this.#close(gl)
      this.#host.say(new Error(`${mode.name} ${error.message}`))
    }
    this.#entering = false
  }

  end() {
    this.#session?.end().catch(() => {})
  }

  #open() {
    const how = { xrCompatible: true, ...this.#buffers }
    const gl = document.createElement('canvas').getContext('webgl2', how)
    if (!gl) throw new Error('there is no WebGL 2, which shows the pictures there')
    return gl
  }

  get #buffers() {
    return { alpha: this.#mode.clear, antialias: false, depth: false, stencil: false }
  }

  async #begin(gl) {
    const session = this.#session
    session.addEventListener('end', () => this.#ended(gl))
    gl.canvas.addEventListener('webglcontextlost', () => {
      if (this.#session !== session) return
      this.end()
      this.#host.say(new Error(this.#mode.lost))
    })
    await gl.makeXRCompatible?.()
    this.#gl = gl
    this.#eyes = new Eyes(gl)
    this.#layer = new XRWebGLLayer(session, gl, this.#buffers)
    this.#layer.fixedFoveation = 0
    session.updateRenderState({ baseLayer: this.#layer })
    const name = await this.#takeSpace(session)
    await this.#guide.begin?.(session, name)
    this.#space.addEventListener('reset', () => (this.#place = null))
    this.#scale = new Scale(AIM_MS)
    this.#place = null
    this.#asked = null
    this.#host.changed(true)
    const step = (now, frame) => {
      session.requestAnimationFrame(step)
      this.#frame(now, frame)
    }
    session.requestAnimationFrame(step)
  }

  async #takeSpace(session) {
    const { spaces } = this.#mode
    for (const name of spaces) {
      this.#space = await session.requestReferenceSpace(name).catch((error) => {
        if (name === spaces.at(-1)) throw error
      })
      if (this.#space) return name
    }
  }

  #ended(gl) {
    this.#session = this.#layer = this.#eyes = this.#gl = this.#asked = null
    this.#close(gl)
    this.#host.changed(false)
  }

  #close(gl) {
    drop(gl)
    this.#guide.end?.()
  }

  #frame(now, frame) {
    const pose = frame.getViewerPose(this.#space)
    if (!pose) return
    const [space, session, seconds] = [this.#space, this.#session, Math.min((now - this.#last) / 1000, 0.1)]
    this.#place = this.#guide.step(this.#place, { pose, frame, space, session, seconds })
    if (this.#place) this.#pull(frame)
    this.#last = now
    const engine = this.#host.engine()
    if (this.#place && engine && engine !== this.#asked?.engine) this.#ask(engine, pose.views.slice(0, 2))
    this.#show(pose.views)
  }

  #camera(view, size) {
    return cameraOf(view, this.#place, size, NEAR * this.#place.units)
  }

  #show(views) {
    const [gl, eyes] = [this.#gl, this.#eyes]
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.#layer.framebuffer)
    eyes.ground = this.#mode.clear ? null : this.#host.options().background
    gl.clear(gl.COLOR_BUFFER_BIT)
    views.forEach((view, i) => {
      const viewport = this.#layer.getViewport(view)
      if (!viewport.width) return
      if (!this.#place) return this.#guide.show(gl, view, viewport)
      const camera = this.#camera(view, viewport)
      if (eyes.cameras && this.#host.scene()) eyes.draw(i, camera, this.#far(camera), viewport)
    })
  }

  #far({ rotation, position }) {
    const { low, high } = this.#host.scene()
    const middle = low.map((x, i) => (x + high[i]) / 2 - position[i])
    return Math.max(dot(middle, rotation.map((row) => row[2])), Math.hypot(...add(high, low, -1)) / 4)
  }

  async #ask(engine, views) {
    const asked = (this.#asked = { engine })
    const scale = this.#scale.value
    const size = this.#scale.of(this.#layer.getViewport(views[0]))
    const cameras = views.map((view) => this.#camera(view, size))
    const { width, height } = cameras[0]
    const start = performance.now()
    const options = { ...this.#host.options(), alpha: this.#mode.clear, width, height }
    const pair = await engine.ask('eyes', cameras, options, this.#host.backend()).catch((error) => ({ error }))
    if (asked !== this.#asked || engine !== this.#host.engine()) return
    this.#asked = null
    if (pair.error) {
      this.end()
      return this.#host.say(pair.error)
    }
    const milliseconds = performance.now() - start
    this.#eyes.take(cameras, pair)
    if (this.#session.visibilityState !== 'hidden') this.#scale.take(milliseconds)
    this.#host.drawn({ cameras, width, height, scale, milliseconds })
  }

  #pull(frame) {
    const gripping = [...this.#session.inputSources].filter((s) => s.gripSpace && s.gamepad?.buttons[1]?.pressed)
    const now = gripping.map((source) => ({ source, pose: frame.getPose(source.gripSpace, this.#space) }))
      .filter(({ pose }) => pose).map(({ source, pose }) => ({ source, point: numbers(pose.transform.position) }))
    const before = this.#grips
    this.#grips = now
    if (!now.length || now.length !== before.length || now.some(({ source }, i) => source !== before[i].source)) return
    const middle = (grips) => grips[0].point.map((x, i) => (x + grips.at(-1).point[i]) / 2)
    const there = this.#place.at(middle(before))
    if (now.length === 2) {
      const [from, to] = [before, now].map(([a, b]) => add(b.point, a.point, -1))
      const angle = ([x, , z]) => Math.atan2(z, x)
      const times = Math.hypot(...from) / Math.max(Math.hypot(...to), 0.01)
      this.#place = this.#place.changed(angle(from) - angle(to), times)
    }
    this.#place = this.#place.held(middle(now), there)
  }
}
