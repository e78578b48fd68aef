// The parts of the viewer that show text and buttons: the bar, panels, progress, errors and notes.
import { listOf } from './body.js'
import { backends } from './picture.js'

const NOTE_MS = 4000
const PAUSE_MS = 1000 // between pictures: no rate

export class Panels {
  ui = {}
  #root
  #timer
  #greeted = false
  #readAt = 0

  constructor(root) {
    this.#root = root
    for (const element of root.querySelectorAll('[id]')) this.ui[element.id] = element
    this.ui.closeError.onclick = () => (this.ui.error.hidden = true)
  }

  entitle({ name, count }) {
    this.ui.name.textContent = name
    this.ui.count.textContent = `${count.toLocaleString('en')} splats`
  }

  begin(name) {
    this.ui.error.hidden = true
    this.ui.loading.hidden = false
    this.progress(name, { stage: 'download' })
  }

  progress(name, { stage, done, bytes }) {
    const what = stage === 'download' ? 'Loading' : 'Preparing'
    const size = bytes ? `, ${(bytes / 1e6).toFixed(1)} MB` : ''
    this.ui.stageOf.textContent = `${what} ${name}${size}`
    this.ui.percent.textContent = done === undefined ? '' : `${Math.floor(100 * done)} %`
    if (done === undefined) this.ui.bar.removeAttribute('value')
    else this.ui.bar.value = done
  }

  say(error) {
    this.ui.words.textContent = error.message
    this.ui.error.hidden = false
  }

  note(text) {
    this.ui.note.textContent = text
    clearTimeout(this.#timer)
    this.#timer = setTimeout(() => (this.ui.note.textContent = ''), NOTE_MS)
  }

  /** With the first picture. */
  greet(scrolls) {
    if (this.#greeted || this.ui.note.textContent) return
    this.#greeted = true
    const hovers = matchMedia('(hover: hover)').matches
    const wheel = scrolls ? 'Ctrl and wheel' : 'wheel'
    this.note(hovers ? `Drag to turn, ${wheel} to zoom. H: keys` : 'Drag to turn, pinch to zoom')
  }

  /** Shows a panel or puts it away; the other is put away. */
  toggle(panel) {
    const { help, options, keys, set, stage } = this.ui
    for (const other of [help, options]) other.hidden = other !== panel || !other.hidden
    keys.setAttribute('aria-expanded', !help.hidden)
    set.setAttribute('aria-expanded', !options.hidden)
    if (panel && !panel.hidden) panel.querySelector('button').focus()
    else stage.focus({ focusVisible: false })
  }

  setMode(mode) {
    const { stage, help, list } = this.ui
    for (const name of ['orbit', 'fly']) this.ui[name].setAttribute('aria-pressed', name === mode)
    help.querySelector('h2').textContent = mode === 'fly' ? 'Keys in flight' : 'Keys'
    list.innerHTML = listOf(mode)
    const does = mode === 'fly' ? 'look around, W A S D to fly' : 'turn it'
    stage.setAttribute('aria-label', `The scene. Drag or use the arrow keys to ${does}; H lists the keys.`)
  }

  /** The settings as they are. */
  set(values) {
    for (const [name, value] of Object.entries(values)) {
      const field = this.#root.querySelector(`[name=${name}]`)
      if (field.type === 'checkbox') field.checked = value
      else field.value = value
    }
  }

  /** What a picture took, and how much of the scene it shows. */
  read({ width, height, milliseconds, backend, drawn, missing }) {
    const now = performance.now()
    const between = now - this.#readAt
    this.#readAt = now
    const rate = between < PAUSE_MS ? `${Math.round(1000 / between)} a second, ` : ''
    const took = `${Math.round(milliseconds)} ms by ${backends[backend]}, ${width} × ${height}`
    const coming = missing ? `, ${missing} parts to come` : ''
    const splats = drawn === undefined ? '' : `, ${drawn.toLocaleString('en')} splats${coming}`
    this.ui.readout.textContent = rate + took + splats
    this.ui.draws.textContent = `Now ${took}${splats}`
  }
}
