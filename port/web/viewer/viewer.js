// <fixsplat-viewer src=... cameras=... view=... background=... noui>: a scene to look at. index.html is one of them.
import { Engine } from './engine.js'
import { listenToKeys, listenToPointers } from './input.js'
import * as motion from './motion.js'
import { body, keys } from './body.js'

const STILL_MS = 150 // after the last motion
const AIM_MS = 40 // of a picture in motion
const GLIDE_MS = 350
const MOST_PIXELS = 1 << 23
const DIVISORS = [1, 1.5, 2, 3, 4] // beyond, the time is the same

const template = document.createElement('template')
const style = new URL('./viewer.css', import.meta.url)
template.innerHTML = `<style>:host { opacity: 0 }</style><link rel="stylesheet" href="${style}">${body}`

const nameOf = (url) => decodeURIComponent(new URL(url, document.baseURI).pathname.split('/').pop()) || 'scene'
const hasNumbers = (list, count) => Array.isArray(list) && list.length === count && list.every(Number.isFinite)
const isView = (v) =>
  v?.rotation?.length === 3 &&
  v.rotation.every((row) => hasNumbers(row, 3)) &&
  hasNumbers(v.position, 3) &&
  v.fx > 0 &&
  v.height > 0

/** The views of a cameras.json. */
function viewsOf(name, text) {
  let views
  try {
    views = JSON.parse(text)
  } catch {
    throw new Error(`${name}: this is no list of views: it is not JSON`)
  }
  if (!Array.isArray(views) || !views.length || !views.every(isView))
    throw new Error(`${name}: expected a list of views, each with rotation, position, fx and height`)
  return views
}

/** A camera from the text of a link, or null. */
function cameraOf(text) {
  const n = (text ?? '').split(',').map(Number)
  if (!hasNumbers(n, 10)) return null
  return { eye: n.slice(0, 3), look: n.slice(3, 6), up: n.slice(6, 9), fov: n[9] }
}

export class Viewer extends HTMLElement {
  static observedAttributes = ['src', 'cameras', 'view', 'background']

  #headset = null
  #engine = null // of the scene on show
  #opening = null // of the one that is loading
  #scene = null // its name, count and box
  #source = '' // its address, where it has one
  #views = []
  #index = 0
  #camera = null
  #good = null // the camera of the last picture
  #up = [0, -1, 0]
  #divisor = 1 // of width and height in motion
  #busy = false
  #changed = false
  #movedAt = -Infinity
  #settings = { sharpness: 1, speed: 0.5, colours: true, fov: 50 }
  #ui = {}

  constructor() {
    super()
    this.attachShadow({ mode: 'open', delegatesFocus: true }).append(template.content.cloneNode(true))
    for (const element of this.shadowRoot.querySelectorAll('[id]')) this.#ui[element.id] = element
    this.#ui.list.innerHTML = keys.map(([key, does]) => `<dt>${key}</dt><dd>${does}</dd>`).join('')
    this.#listen()
  }

  connectedCallback() {
    this.state = this.#scene ? 'still' : 'empty'
    this.resized = new ResizeObserver(() => this.#change())
    this.resized.observe(this)
    this.theme = matchMedia('(prefers-color-scheme: light)')
    this.theme.onchange = () => this.#change()
    if (this.hasAttribute('src') && !this.#scene) this.#openAttribute()
    if (navigator.xr || !isSecureContext) this.#findHeadset()
  }

  disconnectedCallback() {
    this.#headset?.end()
    this.resized.disconnect()
    this.#engine?.end()
    this.#opening?.end()
    this.#engine = this.#opening = this.#scene = null
    this.removeAttribute('open')
  }

  attributeChangedCallback(name, before, value) {
    if (!this.isConnected || before === value) return
    if (name === 'src' && value) this.#openAttribute()
    if (name === 'cameras' && this.#scene) this.#fetchViews().then((views) => this.#takeViews(views))
    if (name === 'view') this.#show(cameraOf(value))
    if (name === 'background') this.#change()
  }

  /** empty, loading, moving or still. */
  get state() {
    return this.getAttribute('state')
  }
  set state(value) {
    this.setAttribute('state', value)
  }

  /** eye, look, up and fov, ten numbers with commas: as the attribute `view`. */
  get view() {
    const { eye, look, up, fov } = this.#camera
    return [...eye, ...look, ...up, fov].join()
  }

  /** The viewer's page with this scene and view. */
  get link() {
    const link = new URL('./index.html', import.meta.url)
    link.searchParams.set('scene', this.#source)
    const cameras = this.getAttribute('cameras')
    if (cameras) link.searchParams.set('cameras', new URL(cameras, document.baseURI))
    if (this.hasAttribute('background')) link.searchParams.set('background', this.getAttribute('background'))
    link.hash = `view=${this.view}`
    return link.href
  }

  // ---- Opening ------------------------------------------------------------------------------------------------------

  async #openAttribute() {
    const views = this.#fetchViews()
    if (await this.open(new URL(this.getAttribute('src'), document.baseURI).href, views))
      this.#show(cameraOf(this.getAttribute('view')))
  }

  /** The views that the attribute `cameras` names; none where that fails. */
  async #fetchViews() {
    const url = this.getAttribute('cameras')
    if (!url) return []
    try {
      const answer = await fetch(new URL(url, document.baseURI)).catch(() => null)
      if (!answer?.ok) throw new Error(`${nameOf(url)}: there are no views at this address`)
      return viewsOf(nameOf(url), await answer.text())
    } catch (error) {
      this.#say(error)
      return []
    }
  }

  #takeViews(views) {
    this.#views = views
    this.#index = 0
    this.#up = views.length ? motion.upOf(views, this.#up) : [0, -1, 0]
    this.#ui.before.hidden = this.#ui.after.hidden = !views.length
    this.#good = null
    this.#show(this.#start())
  }

  /** The view that it starts with and goes back to: of the file of views, or the whole scene. */
  #start() {
    if (this.#views.length) return motion.ofView(this.#views[this.#index], this.#scene)
    return motion.seeAll(this.#scene, this.#up, this.#settings.fov, this.clientWidth / this.clientHeight || 1)
  }

  /** Opens a file or an address; the scene there was stays where that fails. True where it is open. */
  async open(source, views = []) {
    const name = source.name ?? nameOf(source)
    this.#opening?.end()
    const engine = (this.#opening = new Engine((progress) => this.#progress(name, progress)))
    this.#begin(name)
    try {
      const scene = await engine.ask('open', name, source)
      this.#take(engine, scene, typeof source === 'string' ? source : '', await views)
      return true
    } catch (error) {
      engine.end()
      this.#say(error)
      this.state = this.#scene ? 'still' : 'empty'
      return false
    } finally {
      if (this.#opening === engine) this.#opening = null
      this.#ui.loading.hidden = true
    }
  }

  #begin(name) {
    this.#ui.error.hidden = true
    this.#ui.loading.hidden = false
    this.state = 'loading'
    this.#progress(name, { stage: 'download' })
  }

  #progress(name, { stage, done, bytes }) {
    const what = stage === 'download' ? 'Loading' : 'Preparing'
    const size = bytes ? `, ${(bytes / 1e6).toFixed(1)} MB` : ''
    this.#ui.stage.textContent = `${what} ${name}${size}`
    this.#ui.percent.textContent = done === undefined ? '' : `${Math.floor(100 * done)} %`
    if (done === undefined) this.#ui.bar.removeAttribute('value')
    else this.#ui.bar.value = done
  }

  #take(engine, scene, source, views) {
    this.#headset?.end()
    this.#engine?.end()
    this.#engine = engine
    this.#busy = false
    this.#scene = scene
    this.#source = source
    this.#divisor = 1
    this.setAttribute('open', '')
    this.#ui.name.textContent = scene.name
    this.#ui.count.textContent = `${scene.count.toLocaleString('en')} splats`
    if (this.matches(':focus-within')) this.#ui.canvas.focus({ focusVisible: false })
    this.#takeViews(views)
  }

  async #openFiles(files) {
    const list = [...files]
    const isViews = (file) => /\.json$/i.test(file.name) && !/tileset/i.test(file.name)
    const [views, scene] = [list.find(isViews), list.find((file) => !isViews(file))]
    if (scene && !(await this.open(scene))) return
    if (!views) return
    try {
      if (!this.#scene) throw new Error(`${views.name}: open a scene first, then its views`)
      this.#takeViews(viewsOf(views.name, await views.text()))
    } catch (error) {
      this.#say(error)
    }
  }

  // ---- Pictures -----------------------------------------------------------------------------------------------------

  get #isMoving() {
    return performance.now() - this.#movedAt < STILL_MS
  }

  #size(divisor) {
    const [w, h] = [this.clientWidth, this.clientHeight].map((n) => n * devicePixelRatio * this.#settings.sharpness)
    const scale = Math.min(1, Math.sqrt(MOST_PIXELS / (w * h))) / divisor
    return { width: Math.max(1, Math.round(w * scale)), height: Math.max(1, Math.round(h * scale)) }
  }

  get #background() {
    const given = this.getAttribute('background') ?? (this.theme.matches ? '#eef0f3' : '#0e1116')
    return /^#[0-9a-f]{6}$/i.test(given) ? parseInt(given.slice(1), 16) : 0
  }

  #frame(divisor) {
    return { ...this.#size(divisor), background: this.#background, shDegree: this.#settings.colours ? 3 : 0 }
  }

  #change() {
    this.#changed = true
    this.#draw()
  }

  #move(camera) {
    this.#camera = camera
    this.#movedAt = performance.now()
    this.#change()
  }

  /** One picture at a time; what has changed meanwhile is drawn after it. */
  async #draw() {
    if (this.#busy || this.#headset?.isOn || !this.#engine || !this.clientWidth || !this.clientHeight) return
    const engine = this.#engine
    const divisor = this.#isMoving ? this.#divisor : 1
    this.#busy = true
    this.#changed = false
    this.state = this.#isMoving ? 'moving' : this.state
    try {
      await this.#picture(engine, this.#camera, divisor)
    } catch (error) {
      this.#refused(error)
    }
    if (engine !== this.#engine) return
    this.#busy = false
    this.#after(divisor)
  }

  async #picture(engine, camera, divisor) {
    const options = this.#frame(divisor)
    const { pixels, milliseconds } = await engine.ask('render', camera, options)
    if (engine !== this.#engine) return
    const { canvas } = this.#ui
    const { width, height } = options
    Object.assign(canvas, { width, height })
    canvas.getContext('2d', { alpha: false }).putImageData(new ImageData(pixels, width), 0, 0)
    this.#good = camera
    this.#choose(divisor, milliseconds)
    this.dispatchEvent(new CustomEvent('picture', { detail: { width, height, divisor, milliseconds } }))
  }

  /** Where the renderer does not reach, the camera stays where it was. */
  #refused(error) {
    if (this.#good && this.#good !== this.#camera) this.#camera = this.#good
    else this.#say(error)
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

  #after(divisor) {
    if (this.#changed) return requestAnimationFrame(() => this.#draw())
    clearTimeout(this.timer)
    if (this.#isMoving || divisor > 1) this.timer = setTimeout(() => this.#change(), STILL_MS)
    else if (!this.#opening) this.state = 'still'
  }

  // ---- Views --------------------------------------------------------------------------------------------------------

  #show(camera) {
    if (!camera || !this.#scene) return
    this.#camera = camera
    this.#change()
  }

  showView(index) {
    if (!this.#views.length || !this.#scene) return
    this.#index = (index + this.#views.length) % this.#views.length
    const { img_name: name } = this.#views[this.#index]
    this.#glide(this.#start())
    this.#note(`View ${this.#index + 1} of ${this.#views.length}${name ? `: ${name}` : ''}`)
  }

  #glide(to) {
    const [from, start] = [this.#camera, performance.now()]
    const step = (now) => {
      if (this.#camera !== last) return
      const t = Math.max(0, Math.min((now - start) / GLIDE_MS, 1))
      this.#move((last = t < 1 ? motion.between(from, to, t) : to))
      if (t < 1) requestAnimationFrame(step)
    }
    let last = from
    if (matchMedia('(prefers-reduced-motion: reduce)').matches) this.#show(to)
    else requestAnimationFrame(step)
  }

  get #radius() {
    return Math.max(Math.hypot(...motion.add(this.#scene.high, this.#scene.low, -1)) / 2, 1e-3)
  }

  async #focus(x, y) {
    if (!this.#scene) return
    const options = this.#frame(1)
    const at = [(x * options.width) / this.clientWidth, (y * options.height) / this.clientHeight].map(Math.floor)
    const found = await this.#engine.ask('pick', ...at, this.#camera, options).catch((error) => this.#say(error))
    if (!found) return this.#note('Nothing there')
    const near = motion.add(found.position, motion.add(this.#camera.eye, found.position, -1), 0.6)
    this.#glide({ ...this.#camera, eye: near, look: found.position })
  }

  /** A headset stands at the page's camera, whose picture stays as it is meanwhile. */
  async #findHeadset() {
    const { offerHeadset } = await import('./xr.js')
    this.#headset ??= await offerHeadset(this.#ui.headset, {
      ask: (cameras, options) => this.#engine.ask('eyes', cameras, options, 'wasm'),
      view: () => ({ camera: this.#camera, up: this.#up }),
      options: () => this.#frame(1),
      drawn: (detail) => this.dispatchEvent(new CustomEvent('eyes', { detail })),
      say: (error) => this.#say(error),
      changed: (isOn) => {
        this.toggleAttribute('headset', isOn)
        this.#change()
      },
    })
  }

  // ---- Buttons and keys ---------------------------------------------------------------------------------------------

  async #screenshot() {
    if (!this.#scene) return
    const bytes = await this.#engine.ask('png', this.#camera, this.#frame(1))
    const url = URL.createObjectURL(new Blob([bytes], { type: 'image/png' }))
    Object.assign(document.createElement('a'), { href: url, download: `${this.#scene.name}.png` }).click()
    setTimeout(() => URL.revokeObjectURL(url), 1000)
    this.#note('Picture saved')
  }

  async #copyLink() {
    if (!this.#scene) return
    if (!this.#source) return this.#note('This scene is a file of yours: a link cannot hold it')
    const copied = await navigator.clipboard?.writeText(this.link).then(
      () => true,
      () => false
    )
    this.#note(copied ? 'Link copied: it opens this view' : this.link)
  }

  #toggle(panel) {
    this.shadowRoot.querySelector('[name=background]').value = `#${this.#background.toString(16).padStart(6, '0')}`
    for (const other of [this.#ui.help, this.#ui.options]) other.hidden = other !== panel || !other.hidden
    this.#ui.keys.setAttribute('aria-expanded', !this.#ui.help.hidden)
    this.#ui.set.setAttribute('aria-expanded', !this.#ui.options.hidden)
    if (!panel?.hidden) panel?.querySelector('button').focus()
    else this.#ui.canvas.focus({ focusVisible: false })
  }

  #fullScreen() {
    if (document.fullscreenElement) document.exitFullscreen()
    else this.requestFullscreen?.().catch(() => this.#note('This browser keeps the page as it is'))
  }

  #press(key) {
    const does = {
      h: () => this.#toggle(this.#ui.help),
      Escape: () => this.#toggle(null),
      o: () => this.#ui.file.click(),
      n: () => this.showView(this.#index + 1),
      p: () => this.showView(this.#index - 1),
      r: () => this.#scene && this.#glide(this.#start()),
      i: () => this.#screenshot(),
      l: () => this.#copyLink(),
      f: () => this.#fullScreen(),
      '+': () => this.#zoom(0.9),
      '-': () => this.#zoom(1 / 0.9),
    }
    does[key.length === 1 ? key.toLowerCase() : key]?.()
  }

  #zoom(factor) {
    if (this.#scene) this.#move(motion.zoom(this.#camera, factor, 1e-4 * this.#radius))
  }

  /** What pointers and keys do. Half a turn across the height. */
  get #acts() {
    const turned = (turn) => (dx, dy) => {
      const angle = Math.PI / this.clientHeight
      if (this.#scene && (dx || dy)) this.#move(turn(this.#camera, this.#up, dx * angle, dy * angle))
    }
    return {
      orbit: turned(motion.orbit),
      look: turned(motion.lookAround),
      pan: (dx, dy) => this.#scene && this.#move(motion.pan(this.#camera, this.clientHeight, dx, dy)),
      zoom: (factor) => this.#zoom(factor),
      focus: (x, y) => this.#focus(x, y),
      press: (key) => this.#press(key),
      fly: (...way) => {
        const step = this.#scene && this.#settings.speed * this.#radius
        if (step && way.some(Boolean)) this.#move(motion.fly(this.#camera, ...way.map((x) => x * step)))
      },
    }
  }

  #set(event) {
    const { name, value, checked } = event.target
    if (name === 'background') return this.setAttribute('background', value)
    if (name === 'up') {
      this.#up = value.split(',').map(Number)
      return this.#scene && this.#show(this.#start())
    }
    this.#settings[name] = name === 'colours' ? checked : Number(value)
    if (name === 'fov' && this.#camera) this.#camera = { ...this.#camera, fov: Number(value) }
    if (this.#scene) this.#change()
  }

  #listen() {
    const ui = this.#ui
    const held = listenToKeys(this, this.#acts)
    listenToPointers(ui.canvas, this.#acts, () => held.has('Space'))
    const clicks = {
      choose: 'o',
      add: 'o',
      before: 'p',
      after: 'n',
      home: 'r',
      share: 'l',
      photo: 'i',
      keys: 'h',
      full: 'f',
    }
    for (const [id, key] of Object.entries(clicks)) ui[id].onclick = () => this.#press(key)
    ui.set.onclick = () => this.#toggle(ui.options)
    for (const id of ['closeHelp', 'closeOptions']) ui[id].onclick = () => this.#toggle(null)
    ui.closeError.onclick = () => (ui.error.hidden = true)
    ui.file.onchange = () => this.#openFiles(ui.file.files).then(() => (ui.file.value = ''))
    ui.options.oninput = (event) => this.#set(event)
    this.#listenToDrops()
  }

  #listenToDrops() {
    const over = (is) => (event) => {
      event.preventDefault()
      this.toggleAttribute('over', is)
    }
    this.addEventListener('dragover', over(true))
    this.addEventListener('dragleave', over(false))
    this.addEventListener('drop', (event) => {
      over(false)(event)
      this.#openFiles(event.dataTransfer.files)
    })
  }

  // ---- Words --------------------------------------------------------------------------------------------------------

  #say(error) {
    this.#ui.words.textContent = error.message
    this.#ui.error.hidden = false
  }

  #note(text) {
    this.#ui.note.textContent = text
    clearTimeout(this.noteTimer)
    this.noteTimer = setTimeout(() => (this.#ui.note.textContent = ''), 4000)
  }
}

customElements.define('fixsplat-viewer', Viewer)
