// The visible texts and buttons of the viewer: bar, panels, progress, errors, notes.
import { listOf } from './body.js'
import { backends } from './picture.js'

const NOTE_MS = 4000
const PAUSE_MS = 1000

const KEYS = { orbit: 'Keys', fly: 'Keys in flight', walk: 'Keys on foot' }
const HINTS = {
  orbit: 'The scene. Drag or use the arrow keys to turn it; H lists the keys.',
  fly: 'The scene. Drag or use the arrow keys to look around, W A S D to fly; H lists the keys.',
  walk: 'The scene. Drag to look around, W A S D or the arrow keys to walk; H lists the keys.',
}

export class Panels {
  ui = {}
  #root
  #timer
  #greeted = false
  #readAt = 0

  constructor(root, language) {
    this.#root = root
    this.language = language
    for (const element of root.querySelectorAll('[id]')) this.ui[element.id] = element
    this.ui.closeError.onclick = () => (this.ui.error.hidden = true)
  }

  entitle({ name, count }, label) {
    this.ui.name.textContent = label || name
    this.ui.count.textContent = this.language.of('{0} splats', this.language.number(count))
  }

  begin(name) {
    this.ui.error.hidden = true
    this.ui.loading.hidden = false
    this.progress(name, { stage: 'download' })
  }

  progress(name, { stage, done, bytes }) {
    const size = bytes ? `, ${(bytes / 1e6).toFixed(1)} MB` : ''
    this.ui.stageOf.textContent = this.language.of(stage === 'download' ? 'Loading {0}' : 'Preparing {0}', name) + size
    this.ui.percent.textContent = done === undefined ? '' : `${Math.floor(100 * done)} %`
    if (done === undefined) this.ui.bar.removeAttribute('value')
    else this.ui.bar.value = done
  }

  say(error) {
    this.ui.words.textContent = error.message.split('\n').map((line) => this.language.of(line)).join('\n')
    this.ui.error.hidden = false
  }

  note(words, ...values) {
    this.ui.note.textContent = this.language.of(words, ...values)
    clearTimeout(this.#timer)
    this.#timer = setTimeout(() => (this.ui.note.textContent = ''), NOTE_MS)
  }

  greet(scrolls) {
    if (this.#greeted || this.ui.note.textContent) return
    this.#greeted = true
    const hovers = matchMedia('(hover: hover)').matches
    const byWheel = scrolls ? 'Drag to turn, Ctrl and wheel to zoom. H: keys' : 'Drag to turn, wheel to zoom. H: keys'
    this.note(hovers ? byWheel : 'Drag to turn, pinch to zoom')
  }

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
    for (const name of ['orbit', 'fly', 'walk']) this.ui[name].setAttribute('aria-pressed', name === mode)
    help.querySelector('h2').textContent = KEYS[mode]
    list.innerHTML = listOf(mode)
    stage.setAttribute('aria-label', HINTS[mode])
    for (const one of [help, stage]) this.language.write(one)
  }

  set(values) {
    for (const [name, value] of Object.entries(values)) {
      const field = this.#root.querySelector(`[name=${name}]`)
      if (field.type === 'checkbox') field.checked = value
      else field.value = value
    }
  }

  read({ width, height, milliseconds, backend, drawn, missing }) {
    const now = performance.now()
    const between = now - this.#readAt
    this.#readAt = now
    const { language } = this
    const rate = between < PAUSE_MS ? [language.of('{0} a second', Math.round(1000 / between))] : []
    const by = language.of(backends[backend])
    const took = language.of('{0} ms by {1}, {2}', Math.round(milliseconds), by, `${width} × ${height}`)
    const splats = drawn === undefined ? [] : [language.of('{0} splats', language.number(drawn))]
    const coming = missing ? [language.of('{0} parts to come', missing)] : []
    this.ui.readout.textContent = [...rate, took, ...splats, ...coming].join(', ')
    this.ui.draws.textContent = [language.of('Now {0}', took), ...splats, ...coming].join(', ')
  }
}
