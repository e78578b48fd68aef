// Editing by hand: a row of tools that select Gaussians by a lasso, a brush, a box, a sphere or clicks on an object, and
// delete them or all others. The Editor in the worker has the list of edits.
import { button } from './body.js'
import { add, cross, project, unit } from './motion.js'

const LEAST = 3 // CSS pixels between two points of a stroke
const STILL = 4 // CSS pixels that the pointer moves at most in a click on an object
const SOON = 500 // milliseconds after which the viewer says that it looks for an object
const STEP = 0.5 // distance between two discs of a brush, in its radius
const TOOLS = {
  lasso: ['Lasso', 'M12 4c5 0 9 2.4 9 5.5S17 15 12 15s-9-2.4-9-5.5S7 4 12 4zM7 14.5c-2 1.5-1 3 0 3.5s1 2-1 3'],
  brush: ['Brush', 'M20 3L10 13M8.5 13.5c-3 0-2.5 4-5.5 5.5 4 2 9 1 9-2.5a3 3 0 0 0-3.5-3z'],
  box: ['Box', 'M12 3l8 4.5v9L12 21l-8-4.5v-9zM4 7.5l8 4.5 8-4.5M12 12v9'],
  object: ['Object', 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5M10 9l7 3-3 1-1 3z'],
  sphere: ['Sphere', 'M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zM3 12c4 3.5 14 3.5 18 0'],
}
const ACTS = {
  delete: ['Delete the selection (Delete)', 'M4 7h16M9 7V4h6v3M6 7l1 13h10l1-13M10 11v5M14 11v5'],
  keep: ['Keep only the selection', 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5M9 12l2 2 4-4'],
  undo: ['Undo (Ctrl+Z)', 'M8 5L4 9l4 4M4 9h10a5.5 5.5 0 0 1 0 11h-4'],
  redo: ['Redo (Ctrl+Y)', 'M16 5l4 4-4 4M20 9H10a5.5 5.5 0 0 0 0 11h4'],
  scene: ['Save the scene', 'M12 4v11M7.5 10.5L12 15l4.5-4.5M5 19h14'],
  list: ['Save the edits', 'M6 3h8l4 4v14H6zM9 11h6M9 14.5h6M9 18h4'],
  leave: ['End editing', 'M6 6l12 12M18 6L6 18'],
}

const rules = `
#tools { bottom: calc(66px + var(--below, 0px)); flex-wrap: wrap; justify-content: center; align-items: center;
  width: max-content; }
#tools span { display: flex; }
#tools label { min-height: 0; gap: 4px; padding: 0 6px; }
#tools select, #tools input { height: 30px; width: auto; background: transparent; border: 1px solid var(--line);
  border-radius: 7px; padding: 0 6px; }
#tools input[type="range"] { width: 90px; padding: 0; border: 0; }
#tools input[name="numbers"] { width: 210px; }
#tools output { min-width: 90px; padding: 0 8px; color: var(--quiet); font-variant-numeric: tabular-nums; }
#tools:not([hidden]) ~ #note { bottom: auto; top: calc(58px + var(--above, 0px)); }
#stage[data-tool] { cursor: crosshair; }
#marks, #stroke { position: absolute; inset: 0; width: 100%; height: 100%; pointer-events: none; }
#marks { opacity: 0.75; }
#stroke { fill: none; stroke: var(--accent); stroke-width: 1.5; stroke-linecap: round; stroke-linejoin: round; }
:host(:not([open])) #tools { display: none; }
@container (max-width: 400px) { #tools { bottom: calc(50px + var(--below, 0px)); } }`

const buttons = (table) => Object.entries(table).map(([id, [name, path]]) => button(id, name, path)).join('')
const row = `
<span role="group" aria-label="Select by">${buttons(TOOLS)}</span>
<label id="wide">Size of the brush <input name="size" type="range" min="4" max="120" value="24"></label>
<input name="numbers" aria-label="Numbers of the box or the sphere" autocomplete="off">
<select name="how" aria-label="Selection"><option value="">New</option><option value="add">Add</option>
  <option value="subtract">Subtract</option></select>
<label><input name="front" type="checkbox"> Front only</label>
<output id="chosen"></output>
${buttons(ACTS)}`

const round = (x) => Number(x.toPrecision(6))
const distance = ([ax, ay], [bx, by]) => Math.hypot(bx - ax, by - ay)

/** Radius in scene units of a circle on the screen around a point. */
function radiusOf(camera, point, pixels, width, height) {
  const right = unit(cross(add(camera.look, camera.eye, -1), camera.up))
  const [a, b] = [point, add(point, right)].map((one) => project(camera, one, width, height))
  return pixels / distance([a.x, a.y], [b.x, b.y])
}

export class Edit {
  #host
  #bar
  #tools = {}
  #tool = null
  #stroke = null
  #chosen = 0
  #marking = false
  #next = Promise.resolve()

  constructor(host) {
    this.#host = host
    const sheet = new CSSStyleSheet()
    sheet.replaceSync(rules)
    host.style(sheet)
    const { stage, note } = host.ui
    this.marks = Object.assign(document.createElement('canvas'), { id: 'marks' })
    this.path = document.createElementNS('http://www.w3.org/2000/svg', 'svg')
    this.path.id = 'stroke'
    for (const part of [this.marks, this.path]) part.ariaHidden = 'true'
    this.#bar = Object.assign(document.createElement('nav'), { id: 'tools', className: 'ui bar', ariaLabel: 'Edit by hand' })
    this.#bar.innerHTML = row
    stage.after(this.marks, this.path)
    note.before(this.#bar)
    host.language.take(this.#bar)
    for (const one of this.#bar.querySelectorAll('[id], [name]')) this.#tools[one.id || one.name] = one
    for (const tool of Object.keys(TOOLS)) this.#tools[tool].onclick = () => this.#take(tool)
    for (const act of Object.keys(ACTS)) this.#tools[act].onclick = () => this[act]()
    this.#tools.numbers.onchange = () => this.#byNumbers()
    for (const name of ['pointerdown', 'pointermove', 'pointerup', 'pointercancel'])
      stage.addEventListener(name, (event) => this.#point(event), { capture: true })
    host.element.addEventListener('keydown', (event) => this.#key(event), { capture: true })
    host.element.addEventListener('frame', () => this.#mark())
    host.element.addEventListener('load', () => {
      this.#chosen = 0
      this.leave()
    })
  }

  get isOn() {
    return !this.#bar.hidden
  }

  async begin() {
    this.#bar.hidden = false
    this.#take('lasso')
    await this.#do('facts')
  }

  leave() {
    this.#bar.hidden = true
    this.#take(null)
    if (this.#chosen) this.#do('clear')
  }

  // ---- Acts -----------------------------------------------------------------------------------------------------

  delete() {
    return this.#act('delete')
  }

  keep() {
    return this.#act('keep')
  }

  async undo() {
    const { done } = this.facts
    if (done) this.#host.changed(await this.#do('go', done - 1))
  }

  async redo() {
    const { done, last } = this.facts
    if (done < last) this.#host.changed(await this.#do('go', done + 1))
  }

  async #act(act) {
    const { left, chosen } = await this.#do('facts')
    if (!chosen) return this.#host.note('Nothing is selected')
    if (chosen === left) return this.#host.note('Nothing would be left')
    this.#host.changed(await this.#do('act', act))
  }

  async scene() {
    const bytes = await this.#host.edit('write')
    this.#host.save(new Blob([bytes]), `${this.#host.name()}-edited.fxs`)
    this.#host.note('Scene saved')
  }

  async list() {
    const text = JSON.stringify(await this.#host.edit('edits'))
    this.#host.save(new Blob([text], { type: 'application/json' }), `${this.#host.name()}-edits.json`)
    this.#host.note('Edits saved')
  }

  /** Calls the Editor, one call after the other, and shows what is selected. */
  #do(name, ...args) {
    const host = this.#host
    const call = async () => {
      const wait = args[0]?.shape === 'object' && setTimeout(() => host.note('Looking for the object'), SOON)
      this.facts = await host.edit(name, ...args).finally(() => clearTimeout(wait))
      const { left, chosen, done, last } = this.facts
      this.#chosen = chosen
      this.#tools.chosen.textContent = host.language.of('{0} selected', host.language.number(chosen))
      for (const [id, is] of [['delete', chosen], ['keep', chosen % left], ['undo', done], ['redo', done < last]])
        this.#tools[id].disabled = !is
      for (const id of ['scene', 'list']) this.#tools[id].disabled = !done
      await this.#mark()
      return this.facts
    }
    this.#next = this.#next.catch(() => {}).then(call)
    const isNothing = /nothing i[sn] |object 1: /
    this.#next.catch((error) => (isNothing.test(error.message) ? host.note('Nothing there') : host.say(error)))
    return this.#next
  }

  async #mark() {
    if (this.#marking) return
    this.#marking = true
    try {
      const size = this.#host.size()
      const marks = this.isOn && this.#chosen ? await this.#host.edit('marks', this.#host.rendered(size), size) : null
      this.marks.hidden = !marks
      if (!marks) return
      Object.assign(this.marks, { width: marks.width, height: marks.height })
      this.marks.getContext('2d').putImageData(new ImageData(marks.pixels, marks.width), 0, 0)
    } finally {
      this.#marking = false
    }
  }

  // ---- Tools ----------------------------------------------------------------------------------------------------

  #take(tool) {
    this.#tool = tool
    for (const name of Object.keys(TOOLS)) this.#tools[name].setAttribute('aria-pressed', name === tool)
    const isFlat = tool === 'lasso' || tool === 'brush'
    this.#tools.wide.hidden = tool !== 'brush'
    this.#tools.numbers.hidden = tool !== 'box' && tool !== 'sphere'
    this.#tools.front.parentNode.hidden = !isFlat
    if (tool === 'object') this.#host.note('Click an object, or drag a box around it. Alt: not this')
    if (tool) this.#host.ui.stage.dataset.tool = tool
    else delete this.#host.ui.stage.dataset.tool
    this.#end()
  }

  #end() {
    this.#stroke = null
    this.path.replaceChildren()
  }

  #key(event) {
    const key = event.key.toLowerCase()
    const isText = event.composedPath()[0].matches?.('input:not([type="range"], [type="checkbox"]), textarea')
    if (!this.isOn || isText) return
    const isCtrl = event.ctrlKey || event.metaKey
    const does =
      isCtrl && key === 'z' ? (event.shiftKey ? 'redo' : 'undo')
      : isCtrl && key === 'y' ? 'redo'
      : key === 'delete' || key === 'backspace' ? 'delete'
      : key === 'escape' ? 'drop'
      : null
    if (!does) return
    event.preventDefault()
    event.stopImmediatePropagation()
    this[does]()
  }

  drop() {
    if (this.#stroke) this.#end()
    else if (this.#chosen) this.#do('clear')
    else this.leave()
  }

  #point(event) {
    if (!this.#tool || !this.isOn) return
    const { type, offsetX, offsetY, pointerId, button: pressed } = event
    const stroke = this.#stroke
    if (type === 'pointerdown' && !stroke && !pressed && event.isPrimary) this.#down([offsetX, offsetY], event)
    else if (!stroke || stroke.id !== pointerId) return
    else if (type === 'pointermove') this.#drag([offsetX, offsetY])
    else if (type === 'pointerup') this.#up()
    else if (type === 'pointercancel') this.#end()
    event.stopImmediatePropagation()
  }

  #down(point, event) {
    const { stage } = this.#host.ui
    stage.setPointerCapture(event.pointerId)
    stage.focus({ focusVisible: false })
    const how = event.shiftKey ? 'add' : event.altKey ? 'subtract' : this.#tools.how.value
    this.#stroke = { id: event.pointerId, points: [point], how, camera: this.#host.current() }
    if (this.#tool === 'box' || this.#tool === 'sphere') this.#stroke.found = this.#host.element.pick(...point)
    this.#draw()
  }

  #drag(point) {
    const { points } = this.#stroke
    if (distance(points.at(-1), point) < LEAST) return
    if (this.#stroke.found || this.#tool === 'object') points[1] = point
    else points.push(point)
    this.#draw()
  }

  #draw() {
    const { points } = this.#stroke
    const [[x, y]] = points
    const [u, v] = points.at(-1)
    const r = distance([x, y], [u, v])
    const shapes = {
      lasso: ['path', { d: `M${points.join('L')}Z` }],
      brush: ['path', { d: `M${points.join('L')}l0 0`, 'stroke-width': 2 * this.#wide, 'stroke-opacity': 0.35 }],
      box: ['rect', { x: x - r, y: y - r, width: 2 * r, height: 2 * r }],
      sphere: ['circle', { cx: x, cy: y, r }],
      object: ['path', { d: `M${x},${y}H${u}V${v}H${x}Z` }],
    }
    const [name, values] = shapes[this.#tool]
    const drawn = document.createElementNS('http://www.w3.org/2000/svg', name)
    for (const [key, value] of Object.entries(values)) drawn.setAttribute(key, value)
    this.path.replaceChildren(drawn)
  }

  get #wide() {
    return Number(this.#tools.size.value)
  }

  #up() {
    const { points, found, how, camera } = this.#stroke
    const tool = this.#tool
    this.#end()
    if (found) return this.#byPlace(tool, found, points, how, camera)
    const { width, height } = this.#host.size()
    const { clientWidth, clientHeight } = this.#host.element
    const [sx, sy] = [width / clientWidth, height / clientHeight]
    const scaled = points.map(([x, y]) => [Math.floor(x * sx), Math.floor(y * sy)])
    if (tool === 'object') {
      const ends = distance(points[0], points.at(-1)) > STILL ? [scaled[0], scaled.at(-1)] : [scaled[0], scaled[0]]
      const within = (x, size) => Math.min(Math.max(x, 0), size - 1)
      const corner = (end) => [within(end(...ends.map(([x]) => x)), width), within(end(...ends.map(([, y]) => y)), height)]
      const hint = [...corner(Math.min), ...corner(Math.max), how === 'subtract' ? 0 : 1]
      return this.#select({ shape: tool, points: hint }, 'add', camera)
    }
    if (tool === 'lasso' && points.length < 3) return this.#do('clear')
    const radius = Math.min(Math.max(Math.round(this.#wide * sx), 1), 1024)
    this.#select({ shape: tool, points: tool === 'lasso' ? scaled.flat() : discs(scaled, radius) }, how, camera)
  }

  async #byPlace(tool, found, points, how, camera) {
    const at = (await found)?.position
    const { clientWidth, clientHeight } = this.#host.element
    const pixels = distance(points[0], points.at(-1))
    if (!at) return this.#host.note('Nothing there')
    if (!pixels) return this.#do('clear')
    const r = radiusOf(camera, at, pixels, clientWidth, clientHeight)
    const numbers = tool === 'box' ? [...at.map((x) => x - r), ...at.map((x) => x + r)] : [...at, r]
    this.#tools.numbers.value = numbers.map(round).join(', ')
    this.#byNumbers(how)
  }

  #byNumbers(how = this.#tools.how.value) {
    const numbers = this.#tools.numbers.value.split(/[\s,]+/).filter(Boolean).map(Number)
    const wanted = this.#tool === 'box' ? 6 : 4
    if (numbers.length !== wanted || !numbers.every(Number.isFinite))
      return this.#host.note('A box has 6 numbers, a sphere 4')
    this.#select({ shape: this.#tool, numbers }, how)
  }

  #select(shape, how, camera = this.#host.current()) {
    const size = this.#host.size()
    const front = this.#tools.front.checked && !!shape.points && shape.shape !== 'object'
    if (!how) this.#do('clear')
    const asked = { ...shape, ...(front && { front }), ...(how === 'subtract' && { subtract: true }) }
    return this.#do('select', asked, this.#host.rendered(size, camera), size)
  }
}

/** Discs along a stroke, as x, y and radius of each. */
function discs(points, radius) {
  const step = Math.max(1, STEP * radius)
  const between = (a, b) => {
    const count = Math.ceil(distance(a, b) / step)
    return Array.from({ length: count }, (_, i) => a.map((x, axis) => Math.round(x + ((b[axis] - x) * (i + 1)) / count)))
  }
  const all = points.flatMap((point, i) => (i ? between(points[i - 1], point) : [point]))
  return all.flatMap((point) => [...point, radius])
}
