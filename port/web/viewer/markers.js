// Annotations: numbered markers on the picture, and the caption of the selected marker. A small picture of depths tells
// which markers are hidden by the scene; these markers are faded.
import { ICONS, button, panel } from './body.js'
import { project } from './motion.js'

// minimum milliseconds between two depth tests of the markers; slow tests wait longer, 5 times the time of a test
const AGAIN_MS = 250
const SMALL = 320

const LINK = ICONS.share
export const REMOVE = 'M5 7h14M10 7V4h4v3M7 7l1 13h8l1-13'

const captionBody = `
<p id="captionText"></p>
<div id="editing" hidden><input id="newTitle" aria-label="Title" placeholder="Title" maxlength="200">
<textarea id="newText" aria-label="Text" placeholder="Text" maxlength="5000"></textarea></div>
<footer>${button('earlier', 'Previous annotation (,)', ICONS.before)}<span id="place" translate="no"></span>
${button('later', 'Next annotation (.)', ICONS.after)}${button('linkTo', 'Copy a link to this annotation', LINK)}
${button('remove', 'Take this annotation away', REMOVE, 'hidden')}</footer>`

export class Markers {
  #host
  #list = []
  #buttons = []
  #layer = document.createElement('div')
  #ui = {}
  #timer = 0
  #lookedAt = -Infinity
  #pause = AGAIN_MS
  #looking = false

  constructor(host, acts) {
    this.#host = host
    this.acts = acts
    this.#layer.id = 'markers'
    this.#layer.className = 'ui'
    this.#layer.translate = false
    ;(host.root.getElementById('stick') ?? host.ui.stage).after(this.#layer)
    host.ui.options.insertAdjacentHTML('beforebegin', panel('caption', 'Annotation', 'closeCaption', captionBody))
    for (const element of [...host.root.querySelectorAll('#caption, #caption [id]')]) this.#ui[element.id] = element
    const ui = this.#ui
    ui.title = ui.caption.querySelector('h2')
    ui.title.translate = ui.captionText.translate = false
    ui.caption.setAttribute('aria-live', 'polite')
    ui.earlier.onclick = () => acts.step(-1)
    ui.later.onclick = () => acts.step(1)
    ui.linkTo.onclick = () => acts.link()
    ui.remove.onclick = () => acts.remove()
    ui.closeCaption.onclick = () => acts.close()
    ui.editing.oninput = () => acts.change({ title: ui.newTitle.value, text: ui.newText.value })
    host.language.write(ui.caption)
  }

  show(annotations) {
    this.#list = annotations
    this.#buttons = annotations.map(({ title }, i) => {
      const one = document.createElement('button')
      Object.assign(one, { type: 'button', className: 'marker', textContent: i + 1, title, hidden: true })
      one.setAttribute('aria-expanded', 'false')
      one.setAttribute('aria-controls', 'caption')
      one.onclick = () => this.acts.choose(i)
      return one
    })
    this.#layer.replaceChildren(...this.#buttons)
    this.name()
    this.place()
  }

  name() {
    const { language } = this.#host
    this.#list.forEach(({ title }, i) => {
      const name = language.of('Annotation {0} of {1}', i + 1, this.#list.length)
      this.#buttons[i].setAttribute('aria-label', title ? `${name}: ${title}` : name)
    })
  }

  choose(index, isEditing) {
    const ui = this.#ui
    if (index < 0 && ui.caption.matches(':focus-within')) this.#leave()
    this.#buttons.forEach((one, i) => one.setAttribute('aria-expanded', i === index))
    const { title = '', text = '' } = this.#list[index] ?? {}
    ui.caption.hidden = index < 0
    ui.title.textContent = title || this.#host.language.of('Annotation {0}', index + 1)
    ui.captionText.textContent = text
    ui.captionText.hidden = isEditing || !text
    ui.editing.hidden = ui.remove.hidden = !isEditing
    if (ui.newTitle.value !== title) ui.newTitle.value = title
    if (ui.newText.value !== text) ui.newText.value = text
    ui.place.textContent = this.#list.length > 1 ? `${index + 1} / ${this.#list.length}` : ''
    ui.earlier.hidden = ui.later.hidden = this.#list.length < 2
  }

  #leave() {
    const marker = this.#layer.querySelector('[aria-expanded="true"]:not([hidden])')
    ;(marker ?? this.#host.ui.stage).focus({ focusVisible: false })
  }

  write() {
    this.#ui.newTitle.focus()
  }

  entitle(index) {
    const { title } = this.#list[index]
    this.#buttons[index].title = title
    this.#ui.title.textContent = title || this.#host.language.of('Annotation {0}', index + 1)
    this.name()
  }

  place() {
    const { element, camera } = this.#host
    const [width, height, seen] = [element.clientWidth, element.clientHeight, camera()]
    if (!seen || !width || !height) return
    this.#list.forEach(({ position }, i) => {
      const { x, y, depth } = project(seen, position, width, height)
      const one = this.#buttons[i]
      one.hidden = !(depth > 0 && x > 0 && y > 0 && x < width && y < height)
      if (one.hidden) return
      one.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`
      one.style.zIndex = Math.min(Math.round(1e6 / depth), 1e9)
    })
    clearTimeout(this.#timer)
    this.#timer = setTimeout(() => this.#look(), Math.max(this.#lookedAt + this.#pause - performance.now(), 0))
  }

  async #look() {
    const { element, camera, depths, radius } = this.#host
    const seen = camera()
    const scale = SMALL / Math.max(element.clientWidth, element.clientHeight)
    if (this.#looking || !seen || !this.#list.length || !(scale > 0) || !Number.isFinite(scale)) return
    const [width, height] = [element.clientWidth, element.clientHeight].map((n) => Math.max(1, Math.round(scale * n)))
    const placed = ({ position }, i) => ({ one: this.#buttons[i], ...project(seen, position, width, height) })
    const visible = this.#list.map(placed).filter(({ one }) => !one.hidden)
    const pixels = visible.map(({ x, y }) => [Math.floor(x), Math.floor(y)])
    this.#looking = true
    const start = performance.now()
    const found = await depths(pixels, seen, width, height).catch(() => null)
    this.#looking = false
    this.#lookedAt = performance.now()
    this.#pause = Math.max(AGAIN_MS, 5 * (this.#lookedAt - start))
    const slack = 0.01 * radius()
    found?.forEach((depth, i) => visible[i].one.classList.toggle('behind', depth < 0.97 * visible[i].depth - slack))
    if (camera() !== seen) this.place()
  }
}
