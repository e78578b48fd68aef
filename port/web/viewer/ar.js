// Augmented reality (WebXR): puts the scene upright on a floor or table of the room. A ring shows where the scene will
// stand, on a surface that WebXR hit tests find. A tap or trigger puts the scene there. Dragging the scene moves it,
// dragging elsewhere turns it, and two fingers turn and scale it.
import { button, ICONS } from './body.js'
import { programOf } from './eyes.js'
import { add, dot, unit } from './motion.js'
import { numbers, Place } from './xr.js'

const TABLE = 0.5 // metres: longest side of a scene in the size 'table'
const [LEAST, MOST] = [0.02, 200] // metres: limits of the longest side of a scene that fingers scale
const LEVEL = Math.cos(Math.PI / 6) // smallest vertical component of the unit normal of a surface that counts as level
const BEFORE = 0.7 // metres: distance from the user to the near side of the scene if no surface is known
const BELOW = 1.2 // metres: assumed height of the eyes above an unknown floor
const PATIENCE_MS = 8000 // milliseconds without a known surface; then a tap puts the scene in front of the user
const HINT_MS = 8000
const REACH = 20 // metres: longest ray from a pointer to the floor
const TURNING = 4 // ratio of the angle by which the scene turns to the angle of a drag
const [RING_LEAST, RING_MOST] = [0.06, 0.5]

// for each size of the scene: the metres of a scene unit
const SIZES = { table: (longest) => TABLE / longest, true: () => 1 }
const OTHER = { table: 'true', true: 'table' }
const NAMES = { table: 'On the table', true: 'True size' }
const HINTS = {
  search: 'Point at the floor or a table and move slowly, until a ring is there',
  ready: 'Tap: the scene will stand on the ring',
  stands: 'Drag the scene to move it, or beside it to turn it; two fingers make it larger and smaller',
}

const VERTEX = `#version 300 es
uniform mat4 projection;
uniform mat4 view;
uniform vec4 ring;
out vec2 at;
void main() {
  at = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  gl_Position = projection * view * vec4(ring.xyz + ring.w * vec3(at.x, 0.0, at.y), 1.0);
}`
// The shader draws a white ring between dark edges, which is visible on any floor. Colours are premultiplied.
const FRAGMENT = `#version 300 es
precision highp float;
in vec2 at;
out vec4 colour;
void main() {
  float from = abs(length(at) - 0.88);
  float pixel = fwidth(length(at));
  float white = clamp((0.06 - from) / pixel + 0.5, 0.0, 1.0);
  float all = clamp((0.1 - from) / pixel + 0.5, 0.0, 1.0);
  colour = vec4(vec3(white * all), max(white, 0.5) * all);
}`

const sheet = new CSSStyleSheet()
sheet.replaceSync(`
#inRoom { position: fixed; inset: 0; z-index: 1; color: var(--text); }
#inRoom > * { backdrop-filter: none; }
#inRoom .panel { padding: 8px 14px; text-align: center; }
#inRoom .card { top: calc(16px + env(safe-area-inset-top)); }
#inRoom .bar { bottom: calc(16px + env(safe-area-inset-bottom)); }
#inRoom .words { padding: 0 14px; white-space: nowrap; }`)

function panelOf({ root, language }, acts) {
  const panel = document.createElement('div')
  Object.assign(panel, { id: 'inRoom', hidden: true })
  panel.innerHTML = `<p class="panel card" role="status"></p><div class="bar">
<button id="roomSize" class="words" type="button"></button>
<button id="roomAnew" class="words" type="button">Put it elsewhere</button>
${button('roomEnd', 'Back to the page', ICONS.close)}</div>`
  root.append(panel)
  language.write(panel)
  const [hint, bar] = panel.children
  bar.addEventListener('beforexrselect', (event) => event.preventDefault())
  for (const [id, act] of Object.entries(acts)) bar.querySelector(`#${id}`).onclick = act
  return { panel, hint, size: bar.querySelector('#roomSize') }
}

function rayOf({ position, matrix }) {
  return { from: numbers(position), along: [-matrix[8], -matrix[9], -matrix[10]] }
}

function meetsLevel({ from, along }, height) {
  const far = (height - from[1]) / along[1]
  return far > 0 && far < REACH ? add(from, along, far) : null
}

function meetsBox({ from, along }, { low, high }) {
  let [enters, leaves] = [0, Infinity]
  for (let i = 0; i < 3; i++) {
    const [a, b] = [low[i], high[i]].map((side) => (side - from[i]) / along[i])
    if (Number.isNaN(a) || Number.isNaN(b)) continue
    enters = Math.max(enters, Math.min(a, b))
    leaves = Math.min(leaves, Math.max(a, b))
  }
  return enters <= leaves
}

const least = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI))

function apart([a, b], { matrix }) {
  const axis = (i) => [matrix[4 * i], matrix[4 * i + 1], matrix[4 * i + 2]]
  const [p, q] = [a, b].map(({ along }) => [0, 1].map((i) => dot(along, axis(i)) / -dot(along, axis(2))))
  const to = [q[0] - p[0], q[1] - p[1]]
  return { far: Math.hypot(...to), angle: Math.atan2(to[1], to[0]) }
}

/** The class Stand places the scene in the room in the AR mode. It is the mode's Guide (see xr.js). */
class Stand {
  #host
  #session
  #size
  #hits = null // WebXR hit test source; null if the device does not find surfaces
  #ring = null
  #floor = false
  #since = 0
  #taps = false
  #asked = null
  #held = []
  #rays = []
  #moves = false
  #program = null
  #said = ''
  #saidAt = 0
  #panel

  constructor(host) {
    this.#host = host
    this.#size = host.size()
    host.style(sheet)
    this.#panel = panelOf(host, {
      roomSize: () => this.#resize(),
      roomAnew: () => (this.#asked = () => null),
      roomEnd: () => this.#session?.end().catch(() => {}),
    })
  }

  get options() {
    const optionalFeatures = ['local-floor', 'hit-test', 'dom-overlay']
    return { optionalFeatures, domOverlay: { root: this.#panel.panel } }
  }

  async begin(session, floor) {
    this.#session = session
    this.#floor = floor === 'local-floor'
    this.#panel.panel.hidden = !session.domOverlayState
    this.#name()
    session.addEventListener('select', () => (this.#taps = true))
    session.addEventListener('selectstart', ({ inputSource }) => this.#hold([...this.#held, inputSource]))
    session.addEventListener('selectend', ({ inputSource }) =>
      this.#hold(this.#held.filter((source) => source !== inputSource)))
    try {
      this.#hits = await session.requestHitTestSource({ space: await session.requestReferenceSpace('viewer') })
    } catch {} // a device without hit tests refuses the request, and the scene is placed without a surface
    this.#since = performance.now()
  }

  end() {
    this.#panel.panel.remove()
  }

  step(place, now) {
    const asked = this.#asked
    const taps = this.#taps
    this.#asked = null
    this.#taps = false
    if (!this.#host.scene()) return place
    if (place && asked) place = asked(place)
    place = place ? this.#drag(place, now) : this.#stand(now, taps)
    this.#say(place ? 'stands' : this.#ring ? 'ready' : 'search')
    return place
  }

  #say(state) {
    const { hint } = this.#panel
    const now = performance.now()
    hint.hidden = state === 'stands' && state === this.#said && now - this.#saidAt > HINT_MS
    if (state === this.#said) return
    hint.textContent = this.#host.language.of(HINTS[state])
    this.#said = state
    this.#saidAt = now
  }

  #name() {
    this.#panel.size.textContent = this.#host.language.of(NAMES[OTHER[this.#size]])
  }

  // ---- Placing the scene --------------------------------------------------------------------------------------------

  get #longest() {
    const { low, high } = this.#host.scene()
    return Math.max(...add(high, low, -1), 1e-6)
  }

  get #scale() {
    return SIZES[this.#size](this.#longest)
  }

  /** Returns the middle of the underside of the scene's box: the middle of the box minus h up. h is half the height of
      the box along the unit vector `up`, the sum of |up_i| side_i / 2. */
  get #foot() {
    const { low, high } = this.#host.scene()
    const up = unit(this.#host.view().up)
    const sides = add(high, low, -1)
    const h = up.reduce((sum, x, i) => sum + (Math.abs(x) * sides[i]) / 2, 0)
    return add(low.map((x, i) => (x + high[i]) / 2), up, -h)
  }

  #stand({ pose, frame, space }, taps) {
    this.#ring = this.#hits && this.#surface(frame, space)
    if (this.#ring) return taps ? this.#at(this.#ring, pose.transform) : null
    const waits = this.#hits && !(taps && performance.now() - this.#since > PATIENCE_MS)
    return waits ? null : this.#at(this.#ahead(pose.transform), pose.transform)
  }

  #surface(frame, space) {
    const found = frame.getHitTestResults(this.#hits).map((hit) => hit.getPose(space)?.transform)
    const level = found.find((one) => one && one.matrix[5] > LEVEL)
    return level ? numbers(level.position) : null
  }

  #ahead({ position, matrix }) {
    const [x, z] = this.#heading(matrix)
    const far = BEFORE + (this.#longest * this.#scale) / 2
    const height = this.#floor ? 0 : position.y - BELOW
    return [position.x + far * x, height, position.z + far * z]
  }

  /** Returns the horizontal direction of view of a device. If the device looks straight down, its upper edge gives the
      direction. */
  #heading(matrix) {
    const ahead = [-matrix[8], -matrix[10]]
    return unit(Math.hypot(...ahead) > 0.01 ? ahead : [matrix[4], matrix[6]])
  }

  #at(point, { position, matrix }) {
    const to = [point[0] - position.x, point[2] - position.z]
    const heading = Math.hypot(...to) > 0.01 ? unit(to) : this.#heading(matrix)
    return Place.towards(heading, this.#host.view(), 1 / this.#scale).held(point, this.#foot)
  }

  #resize() {
    this.#size = OTHER[this.#size]
    this.#name()
    this.#asked = (place) => place.about(place.from(this.#foot), 0, 1 / this.#scale / place.units)
  }

  #hold(sources) {
    this.#held = sources
    this.#rays = []
  }

  #drag(place, { pose, frame, space }) {
    const poses = this.#held.map((source) => frame.getPose(source.targetRaySpace, space))
    const now = poses.every(Boolean) ? poses.map(({ transform }) => rayOf(transform)) : []
    const before = this.#rays
    this.#rays = now
    if (!now.length) return place
    const fingers = this.#held.filter(({ targetRayMode }) => targetRayMode === 'screen')
    if (!before.length) this.#moves = meetsBox(this.#inScene(now[0], place), this.#host.scene())
    else if (fingers.length === 2 && now.length === 2) return this.#pinch(place, before, now, pose.transform)
    else if (now.length === 1) return this.#pull(place, before[0], now[0])
    return place
  }

  #inScene({ from, along }, place) {
    return { from: place.at(from), along: place.turned(along) }
  }

  #pull(place, before, now) {
    const foot = place.from(this.#foot)
    if (this.#moves) {
      const [a, b] = [before, now].map((ray) => meetsLevel(ray, foot[1]))
      return a && b ? place.held(add(foot, add(b, a, -1)), this.#foot) : place
    }
    const [a, b] = [before, now].map(({ along }) => Math.atan2(along[0], -along[2]))
    return place.about(foot, TURNING * least(b - a), 1)
  }

  #pinch(place, before, now, head) {
    const [a, b] = [before, now].map((rays) => apart(rays, head))
    const [low, high] = [LEAST, MOST].map((metres) => metres / this.#longest)
    const scale = Math.min(Math.max(b.far / Math.max(a.far, 1e-3) / place.units, low), high)
    return place.about(place.from(this.#foot), least(b.angle - a.angle), 1 / scale / place.units)
  }

  get #radius() {
    return Math.min(Math.max((this.#longest * this.#scale) / 2, RING_LEAST), RING_MOST)
  }

  show(gl, { projectionMatrix, transform }, { x, y, width, height }) {
    if (!this.#ring || !this.#host.scene()) return
    this.#program ??= programOf(gl, VERTEX, FRAGMENT)
    const at = (name) => gl.getUniformLocation(this.#program, name)
    gl.useProgram(this.#program)
    gl.viewport(x, y, width, height)
    gl.uniformMatrix4fv(at('projection'), false, projectionMatrix)
    gl.uniformMatrix4fv(at('view'), false, transform.inverse.matrix)
    gl.uniform4f(at('ring'), ...this.#ring, this.#radius)
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4)
  }
}

export const AR = {
  session: 'immersive-ar',
  name: 'AR:',
  lost: 'AR: its graphics context was lost',
  spaces: ['local-floor', 'local'],
  clear: true,
  Guide: Stand,
}
