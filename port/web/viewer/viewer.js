// The element <fixsplat-viewer src=... cameras=... view=...>, which shows a scene in a page. The page index.html
// consists of one such element.
import { Engine } from './engine.js'
import { listenToKeys, listenToPointers } from './input.js'
import { Pilot } from './pilot.js'
import { Picture, backends } from './picture.js'
import { Panels } from './panels.js'
import { body } from './body.js'
import { Language } from './language.js'
import { addressOf, cameraOf, fetchViews, nameOf, textOf, viewsOf } from './views.js'

const STILL_MS = 150 // after the last motion
const BUDGETS = [5e4, 1e5, 2e5, 3e5, 5e5, 75e4, 1e6, 15e5, 2e6, 3e6, 5e6] // of the slider; behind the last, no limit
const DARK = '#0e1116'
const LIGHT = '#eef0f3'
const OF_HEADSETS = /OculusBrowser|Wolvic|Pico/i // browsers that have WebXR on secure pages alone

const template = document.createElement('template')
const style = new URL('./viewer.css', import.meta.url)
template.innerHTML = `<style>:host { opacity: 0 }</style><link rel="stylesheet" href="${style}">${body}`

export class Viewer extends HTMLElement {
  static observedAttributes = ['src', 'cameras', 'view', 'background', 'budget', 'detail', 'backend', 'poster', 'turn',
    'settings', 'annotation', 'skybox', 'lang']

  #headset = null
  #engine = null // of the scene on show
  #opening = null // what is loading: { engine, name, source, views, view }
  #taken = Promise.resolve() // one scene after the other
  #scene = null // its name, count and box
  #source = '' // its address, where it has one
  #picture
  #pilot = new Pilot(this, (moving) => this.#moved(moving))
  #good = null // the camera of the last picture
  #linked = null // that of the attribute `view`, where the scene began with it
  #busy = false
  #switching = false
  #held = false // the scene stays as it is: a trial has a copy of it, or another takes its place
  #changed = false
  #missing = 0 // parts that the last picture lacked
  #stuck = false // and that do not come
  #movedAt = -Infinity
  #settings = { sharpness: 1, colours: true }
  #language = new Language()
  #tour = null // of annotations, tracks and settings files, once there is any: a promise of it, and it
  #touring = null
  #begins = null // a promise: the settings file has been read
  #noSky = '' // the address of a sky that cannot be had
  #ui
  #panels

  constructor() {
    super()
    this.attachShadow({ mode: 'open', delegatesFocus: true }).append(template.content.cloneNode(true))
    this.#panels = new Panels(this.shadowRoot, this.#language)
    this.#ui = this.#panels.ui
    this.#picture = new Picture(this.#ui.stage)
    this.#listen()
    this.#setMode('orbit')
    this.#language.take(this.shadowRoot)
  }

  connectedCallback() {
    this.state = 'empty'
    this.resized = new ResizeObserver(() => this.#change())
    this.resized.observe(this)
    this.theme = matchMedia('(prefers-color-scheme: light)')
    this.theme.onchange = () => this.#change()
    this.shown = () => this.#change()
    document.addEventListener('visibilitychange', this.shown)
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches
    for (const name of still ? ['poster'] : ['poster', 'turn'])
      this.attributeChangedCallback(name, null, this.getAttribute(name))
    this.#choose()
    if (this.hasAttribute('settings')) this.#readSettings()
    if (this.hasAttribute('src')) this.#openAttribute()
    this.#findHeadset()
  }

  disconnectedCallback() {
    this.resized.disconnect()
    this.theme.onchange = null
    document.removeEventListener('visibilitychange', this.shown)
    this.#pilot.turnByItself(false)
    this.#cancel()
    this.#close()
  }

  attributeChangedCallback(name, before, value) {
    if (!this.isConnected || before === value) return
    if (name === 'src' && value) this.#openAttribute()
    if (name === 'cameras' && this.#scene) this.#changeViews(value)
    if (name === 'view') this.#pilot.show(cameraOf(value))
    if (['background', 'budget', 'detail', 'skybox'].includes(name)) this.#change()
    if (name === 'settings' && value) this.#readSettings()
    if (name === 'annotation' && this.#scene) this.#goToAttribute()
    if (name === 'lang') this.#choose()
    if (name === 'backend') this.#redraw(() => this.#engine && this.#switch(this.#engine))
    if (name === 'poster' && value) this.#showPoster(value)
    if (name === 'turn') this.#pilot.turnByItself(value !== null)
  }

  /** empty, loading, moving or still. */
  get state() {
    return this.getAttribute('state')
  }
  set state(value) {
    this.setAttribute('state', value)
  }

  /** What draws: wasm, webgl2, webgl2-quads or webgpu. */
  get backend() {
    return this.#picture.backend
  }

  /** eye, look, up and fov, ten numbers with commas, or thirteen: as the attribute `view`. */
  get view() {
    return this.#pilot.camera ? textOf(this.#pilot.camera) : ''
  }

  /** The viewer's page with this scene and view. */
  get link() {
    const link = new URL('./index.html', import.meta.url)
    link.searchParams.set('scene', this.#source)
    const cameras = this.getAttribute('cameras')
    if (cameras) link.searchParams.set('cameras', addressOf(cameras))
    for (const name of ['settings', 'skybox'])
      if (this.hasAttribute(name)) link.searchParams.set(name, addressOf(this.getAttribute(name)))
    for (const name of ['background', 'budget', 'detail'])
      if (this.hasAttribute(name)) link.searchParams.set(name, this.getAttribute(name))
    link.hash = `view=${this.view}`
    return link.href
  }

  // ---- Annotations, camera tracks and settings files ----------------------------------------------------------------

  /** Fetched with the first of them. */
  #tourNow() {
    return (this.#touring ??= import('./tour.js').then(({ Tour }) => (this.#tour = new Tour(this.#tourHost()))))
  }

  #tourHost() {
    const link = document.createElement('link')
    Object.assign(link, { rel: 'stylesheet', href: new URL('./tour.css', import.meta.url) })
    this.shadowRoot.append(link)
    const ask = (...args) => this.#engine.ask(...args)
    const sized = (width, height) => ({ ...this.#frame(), width, height })
    return {
      element: this,
      root: this.shadowRoot,
      ui: this.#ui,
      language: this.#language,
      camera: () => this.#good,
      current: () => this.#pilot.camera,
      up: () => this.#pilot.up,
      radius: () => this.#pilot.radius,
      aspect: () => this.clientWidth / this.clientHeight || 1,
      size: () => this.#frame(),
      show: (camera) => this.#pilot.follow(camera),
      fly: (camera) => this.#pilot.glide(camera),
      focus: (point) => this.#pilot.goTo(point),
      draw: (camera, ...size) => ask('draw', 0, this.#pilot.rendered(sized(...size), camera), sized(...size)),
      depths: (pixels, camera, ...size) =>
        ask('depths', pixels, this.#pilot.rendered(sized(...size), camera), sized(...size)),
      linkTo: (index) => this.#linkTo(index),
      copy: (link) => this.#copy(link),
      save: (blob, name) => this.#save(blob, name),
      note: (...words) => this.#panels.note(...words),
      say: (error) => this.#panels.say(error),
      tell: (name, detail) => this.dispatchEvent(new CustomEvent(name, { detail })),
    }
  }

  /** Reads a settings file of ours or of supersplat-viewer: an address, a File or what such a file says. Lines about what
      of it is left out. */
  async readSettings(source) {
    const tour = await this.#tourNow()
    const words = await tour.read(source)
    if (words.length) this.#panels.say(new Error(words.join('\n')))
    if (this.#scene) this.#takeViews(this.#pilot.views)
    return words
  }

  #readSettings() {
    this.#begins = this.readSettings(this.getAttribute('settings')).catch((error) => this.#panels.say(error))
  }

  #goToAttribute() {
    const number = Number(this.getAttribute('annotation'))
    if (number) this.goTo(number - 1).catch((error) => this.#panels.say(error))
  }

  get annotations() {
    return this.#tour?.annotations ?? []
  }
  set annotations(list) {
    this.#give('annotations', list)
  }

  get tracks() {
    return this.#tour?.tracks ?? []
  }
  set tracks(list) {
    this.#give('tracks', list)
  }

  #give(name, list) {
    this.#tourNow().then((tour) => (tour[name] = list)).catch((error) => this.#panels.say(error))
  }

  async goTo(index) {
    return (await this.#tourNow()).goTo(index)
  }

  async play(track) {
    return (await this.#tourNow()).play(track)
  }

  pause() {
    this.#tour?.pause()
  }

  seek(seconds) {
    this.#tour?.seek(seconds)
  }

  get time() {
    return this.#tour?.time ?? 0
  }

  get duration() {
    return this.#tour?.duration ?? 0
  }

  get paused() {
    return this.#tour?.paused ?? true
  }

  async film(options) {
    return (await this.#tourNow()).film(options)
  }

  /** The page, with the same settings, at an annotation. */
  #linkTo(index) {
    const link = new URL(this.link)
    link.hash = `annotation=${index + 1}`
    return link.href
  }

  async #mark() {
    if (!this.#scene) return
    const found = await this.#pick(0.5, 0.5, this.#frame()).catch(() => null)
    if (!found) return this.#panels.note('Nothing there')
    this.#toggle(null)
    ;(await this.#tourNow()).mark(found.position)
  }

  async #addKey() {
    if (!this.#scene) return
    this.#panels.note('The track has {0} views', (await this.#tourNow()).addKey())
  }

  async #saveSettings() {
    if (!this.#scene) return
    const { savedText } = await this.#tourNow()
    this.#save(new Blob([savedText], { type: 'application/json' }), 'settings.json')
    this.#panels.note('Settings saved')
  }

  async #choose() {
    const asked = [this.getAttribute('lang'), ...(navigator.languages ?? [navigator.language])].filter(Boolean)
    if (!(await this.#language.choose(asked))) return
    if (this.#scene) this.#panels.entitle(this.#scene)
    this.#tour?.rename()
  }

  // ---- Opening ------------------------------------------------------------------------------------------------------

  #openAttribute() {
    return this.open(this.getAttribute('src'), this.#fetchViews(), cameraOf(this.getAttribute('view')))
  }

  /** The views that the attribute `cameras` names; none where that fails. */
  async #fetchViews() {
    const url = this.getAttribute('cameras')
    return url ? fetchViews(url).catch((error) => this.#panels.say(error) ?? []) : []
  }

  async #changeViews(url) {
    const views = await this.#fetchViews()
    if (this.#scene && url === this.getAttribute('cameras')) this.#takeViews(views)
  }

  /** A picture that stands there until the scene's first. */
  #showPoster(url) {
    if (this.#scene) return
    this.#ui.stage.querySelector('img')?.remove()
    this.#ui.stage.append(Object.assign(new Image(), { src: url, alt: '' }))
  }

  /** Opens a file, files or an address; the scene there was stays where that fails. True where it is open. */
  async open(source, views = [], view = null) {
    const isAddress = typeof source === 'string'
    const name = isAddress ? nameOf(source) : (source.name ?? source[0]?.name ?? 'scene')
    this.#cancel()
    const opening = (this.#opening = { name, source, views, view })
    this.#begin(name)
    try {
      if (!globalThis.WebAssembly) throw new Error('This browser has no WebAssembly, or it is switched off')
      if (isAddress) opening.source = addressOf(source)
      opening.engine = this.#newEngine((told) => this.#hear(opening, told))
      const scene = await opening.engine.open(opening.source, !this.#scene)
      await this.#take(opening, scene)
      if (this.hasAttribute('annotation')) this.#goToAttribute()
      else if (!opening.view) this.#tour?.begin()
      return opening.engine === this.#engine
    } catch (error) {
      if (this.#opening !== opening) return false
      this.#cancel()
      this.#panels.say(error)
      return false
    } finally {
      if (this.#opening === opening) this.#begun()
    }
  }

  /** Puts another scene in the place of the one on show, by the same camera and without a word. False where there is none,
      or not now. */
  async replace(url) {
    const engine = this.#engine
    if (!engine || this.#opening || this.#held) return false
    this.#held = true
    const scene = await engine.open(addressOf(url)).finally(() => (this.#held = false))
    if (engine !== this.#engine) return false
    this.#scene = scene
    this.#panels.entitle(scene)
    this.#pilot.take(scene)
    this.#change()
    return true
  }

  #newEngine(hear) {
    return new Engine(hear, Number(this.getAttribute('threads')) || undefined)
  }

  /** Ends what is loading, and with it what is already seen of it. */
  #cancel() {
    const { engine } = this.#opening ?? {}
    this.#begun()
    engine?.end()
    if (engine && engine === this.#engine) this.#close()
    this.state = this.#scene ? 'still' : 'empty'
  }

  #close() {
    this.#headset?.end()
    this.#engine?.end()
    this.#engine = this.#scene = null
    this.#picture.close()
    this.removeAttribute('open')
    this.state = 'empty'
  }

  #begin(name) {
    this.state = 'loading'
    this.#panels.begin(name)
  }

  #begun() {
    this.#opening = null
    this.#ui.loading.hidden = true
    if (!this.#busy) this.#change()
  }

  #hear(opening, told) {
    if (told.stage === 'lost') this.#redraw(() => this.#picture.lost(told.id))
    else if (told.stage === 'noSky') this.#sayNoSky(told)
    else if (told.stage === 'changed') this.#hearOfParts(opening, told.words)
    else if (!opening || opening !== this.#opening) return
    else if (told.stage === 'preview') this.#take(opening, told.scene).catch(() => {}) // the whole will tell
    else this.#panels.progress(opening.name, told)
  }

  #sayNoSky({ url, words }) {
    if (this.#noSky === this.getAttribute('skybox')) return
    this.#noSky = this.getAttribute('skybox')
    this.#panels.say(new Error(words))
    this.#change()
  }

  /** Parts of a scene have come; or, with words, no more will. */
  #hearOfParts(opening, words) {
    if (!opening || opening.engine !== this.#engine) return
    if (words) {
      this.#stuck = true
      this.#panels.say(new Error(words))
    }
    if (this.#missing || words) this.#change()
  }

  async #take(opening, scene) {
    const [views] = await Promise.all([opening.views, this.#begins])
    return this.#inTurn(() => this.#takeNext(opening, scene, views))
  }

  /** One change of what draws after the other. */
  #inTurn(change) {
    return (this.#taken = this.#taken.catch(() => {}).then(change))
  }

  /** Draws anew where something else draws now; where the scene was closed meanwhile nobody wants to know. */
  #redraw(change) {
    const engine = this.#engine
    this.#inTurn(change).then(
      (is) => is && this.#change(),
      (error) => engine && engine === this.#engine && this.#panels.say(error)
    )
  }

  /** A scene, or as much of it as has come. */
  async #takeNext(opening, scene, views) {
    const { engine, source, view } = opening
    if (opening !== this.#opening) return
    if (engine !== this.#engine) {
      this.#headset?.end()
      await this.#switch(engine)
      if (opening !== this.#opening) return
      this.#engine?.end()
      this.#engine = engine
      this.#busy = this.#pilot.touched = false
      if (this.matches(':focus-within')) this.#ui.stage.focus({ focusVisible: false })
    }
    this.#scene = scene
    this.#missing = 0
    this.#stuck = false
    this.#source = typeof source === 'string' ? source : ''
    this.setAttribute('open', '')
    this.#panels.entitle(scene)
    this.#pilot.take(scene)
    if (this.#pilot.touched) this.#change()
    else this.#takeViews(views, view)
  }

  #takeViews(views, view = null) {
    this.#ui.before.hidden = this.#ui.after.hidden = !views.length
    this.#good = null
    this.#linked = view
    this.#pilot.takeViews(views, view, () => this.#tour?.home ?? null)
    this.#showSettings()
  }

  async #openFiles(files) {
    const list = [...files]
    const isViews = ({ name }) => /\.json$/i.test(name) && !/(tileset|meta)\.json$/i.test(name)
    const [views, scene] = [list.find(isViews), list.filter((file) => !isViews(file))]
    if (scene.length && !(await this.open(scene.length > 1 ? scene : scene[0]))) return
    if (!views) return
    try {
      if (!this.#scene) throw new Error(`${views.name}: open a scene first, then its views`)
      const text = await views.text()
      if (/^\s*\{/.test(text)) await this.readSettings(views)
      else this.#takeViews(viewsOf(views.name, text))
    } catch (error) {
      this.#panels.say(error)
    }
  }

  // ---- Pictures -----------------------------------------------------------------------------------------------------

  get #isMoving() {
    return performance.now() - this.#movedAt < STILL_MS
  }

  get #background() {
    const given = this.getAttribute('background')
    const colour = /^#[0-9a-f]{6}$/i.test(given) ? given : this.theme.matches ? LIGHT : DARK
    return parseInt(colour.slice(1), 16)
  }

  #frame(moving = false) {
    const [width, height] = [this.clientWidth, this.clientHeight].map(
      (n) => n * devicePixelRatio * this.#settings.sharpness
    )
    const size = this.#picture.size(width, height, moving)
    const url = this.getAttribute('skybox')
    const sky = url && url !== this.#noSky ? { url: new URL(url, document.baseURI).href, up: this.#pilot.up } : null
    const bounds = { budget: this.#budget, detail: Math.min(this.#numberOf('detail'), 16384) }
    return { ...size, ...bounds, sky, background: this.#background, shDegree: this.#settings.colours ? 3 : 0 }
  }

  /** That of an attribute; 0 where it is none above 0. */
  #numberOf(name) {
    return Math.max(Number(this.getAttribute(name)), 0) || 0
  }

  /** Splats, where the attribute `budget` has them. */
  get #budget() {
    return Math.round(this.#numberOf('budget')) || undefined
  }

  /** The place of the slider for the budget that there is. */
  get #budgetPlace() {
    const place = BUDGETS.findIndex((budget) => budget >= this.#budget)
    return place < 0 ? BUDGETS.length : place
  }

  #setBudget(place) {
    const budget = BUDGETS[place]
    if (budget) this.setAttribute('budget', budget)
    else this.removeAttribute('budget')
    this.#showSettings()
  }

  /** One step of the slider, in a scene with levels. */
  #stepBudget(step) {
    if (!this.#scene?.levels) return this.#panels.note('This scene has no levels of detail: all of it is drawn')
    const whole = BUDGETS.filter((budget) => budget < this.#scene.count).length
    const place = Math.max((this.#budget < this.#scene.count ? this.#budgetPlace : whole) + step, 0)
    this.#setBudget(place < whole ? place : BUDGETS.length)
    this.#panels.note(this.#panels.ui.budget.textContent)
  }

  #change() {
    this.#changed = true
    this.#draw()
  }

  #moved(moving) {
    if (moving) this.#movedAt = performance.now()
    this.#change()
  }

  get #wanted() {
    const asked = this.getAttribute('backend')
    return asked in backends ? asked : ''
  }

  /** Draws with what the attribute `backend` says, or what turns out to be the fastest. */
  async #switch(engine) {
    this.#switching = true
    const has = await this.#picture.open(engine, this.#wanted).finally(() => (this.#switching = false))
    if (!has) this.#panels.note('This browser does not draw scenes on the graphics card: the processor does')
    return true
  }

  /** One picture at a time; what has changed meanwhile is drawn after it. */
  async #draw() {
    if (this.#busy || this.#switching || !this.#scene || document.hidden) return
    if (!this.clientWidth || !this.clientHeight || this.#headset?.isOn) return
    const engine = this.#engine
    const options = this.#frame(this.#isMoving)
    this.#busy = true
    this.#changed = false
    if (this.#isMoving) this.state = 'moving'
    try {
      await this.#drawNow(engine, options)
    } catch (error) {
      if (engine === this.#engine) this.#refused(error)
    }
    if (engine !== this.#engine) return
    this.#busy = false
    this.#after(options)
  }

  async #drawNow(engine, options) {
    const { camera } = this.#pilot
    const picture = await this.#picture.draw(this.#pilot.rendered(options), options)
    if (engine !== this.#engine || !picture) return
    this.#missing = picture.missing ?? 0
    if (!this.#good) this.#panels.greet()
    this.#good = camera
    this.#panels.read(picture)
    this.dispatchEvent(new CustomEvent('picture', { detail: picture }))
    this.#tour?.drawn()
  }

  /** Where there is no room for so many pixels, there are fewer; where the renderer does not reach, nothing moves. */
  #refused(error) {
    if (/memory/.test(error.message) && this.#picture.shrink(this.#frame())) {
      this.#panels.note('There is too little memory for a picture of this size: it has fewer pixels')
      this.#changed = true
    } else if (this.#good && this.#good !== this.#pilot.camera) this.#pilot.camera = this.#good
    else {
      this.#panels.say(error)
      if (this.#linked && this.#linked === this.#pilot.camera) this.#pilot.show(this.#pilot.start)
    }
  }

  #after({ divisor }) {
    if (this.#changed) return requestAnimationFrame(() => this.#draw())
    clearTimeout(this.timer)
    if (this.#isMoving || divisor > 1) this.timer = setTimeout(() => this.#change(), STILL_MS)
    else if (this.#opening || (this.#missing && !this.#stuck)) this.state = 'loading'
    else this.#rest()
  }

  /** What there is time for when nothing moves. */
  async #rest() {
    this.state = 'still'
    const [engine, options] = [this.#engine, this.#frame()]
    if (this.#pilot.isFlying) {
      const found = await this.#pick(0.5, 0.5, this.#frame(true)).catch(() => null)
      this.#pilot.ahead = found?.position ?? null
    }
    if (this.#held) return
    this.#held = true
    const newEngine = () => this.#newEngine((told) => this.#hear(null, told))
    const trial = this.#picture.try(newEngine, this.#pilot.rendered(options), options)
    const other = await trial.finally(() => (this.#held = false))
    if (!other) return
    engine.end()
    this.#engine = other
    this.#busy = false
    this.#change()
  }

  // ---- Views --------------------------------------------------------------------------------------------------------

  showView(index) {
    const { views } = this.#pilot
    if (!views.length || !this.#scene) return
    this.#pilot.index = (index + views.length) % views.length
    const { img_name: name } = views[this.#pilot.index]
    this.#pilot.glide(this.#pilot.start)
    this.#panels.note(name ? 'View {0} of {1}: {2}' : 'View {0} of {1}', this.#pilot.index + 1, views.length, name)
  }

  /** What is seen at a place of the picture, whose sides are 1. */
  #pick(x, y, options) {
    const at = [x * options.width, y * options.height].map(Math.floor)
    return this.#engine.ask('pick', ...at, this.#pilot.rendered(options), options)
  }

  async #focus(x, y) {
    if (!this.#scene) return
    const found = await this.#pick(x / this.clientWidth, y / this.clientHeight, this.#frame()).catch(() => null)
    if (found) this.#pilot.goTo(found.position)
    else this.#panels.note('Nothing there')
  }

  // ---- Headset ------------------------------------------------------------------------------------------------------

  /** A button where there is one, and where there would be one if the page were secure. */
  async #findHeadset() {
    const button = this.#ui.headset
    const { xr } = navigator
    button.hidden = xr
      ? !(await xr.isSessionSupported('immersive-vr').catch(() => false))
      : isSecureContext || !OF_HEADSETS.test(navigator.userAgent)
    if (xr && !button.hidden) this.#headset ??= await this.#newHeadset()
    const words = 'A headset needs a page of https://, or of the machine that it is on (http://localhost)'
    button.onclick = () => (xr ? this.#headset.enter() : this.#panels.say(new Error(words)))
  }

  /** It stands at the page's camera; the page's picture stays as it is meanwhile. */
  async #newHeadset() {
    const { Headset } = await import('./xr.js')
    return new Headset({
      engine: () => this.#engine,
      backend: () => this.backend,
      scene: () => this.#scene,
      view: () => this.#pilot,
      options: () => this.#frame(),
      drawn: (detail) => this.dispatchEvent(new CustomEvent('eyes', { detail })),
      say: (error) => this.#panels.say(error),
      changed: (isOn) => {
        this.toggleAttribute('headset', isOn)
        this.#change()
      },
    })
  }

  // ---- Buttons and keys ---------------------------------------------------------------------------------------------

  async #screenshot() {
    if (!this.#scene) return
    const options = this.#frame()
    const { name } = this.#scene
    const bytes = await this.#engine
      .ask('png', this.#pilot.rendered(options), options)
      .catch((error) => this.#panels.say(error))
    if (!bytes) return
    this.#save(new Blob([bytes], { type: 'image/png' }), `${name}.png`)
    this.#panels.note('Picture saved')
  }

  #save(blob, name) {
    const url = URL.createObjectURL(blob)
    Object.assign(document.createElement('a'), { href: url, download: name }).click()
    setTimeout(() => URL.revokeObjectURL(url), 1000)
  }

  #copyLink() {
    if (this.#scene) this.#copy(this.link)
  }

  async #copy(link) {
    if (!this.#source) return this.#panels.note('This scene is a file of yours: a link cannot hold it')
    const copied = await navigator.clipboard?.writeText(link).then(
      () => true,
      () => false
    )
    this.#panels.note(copied ? 'Link copied: it opens this view' : link)
  }

  #toggle(panel) {
    this.#showSettings()
    this.#panels.toggle(panel)
  }

  #showSettings() {
    const { camera, turns } = this.#pilot
    const background = `#${this.#background.toString(16).padStart(6, '0')}`
    this.#panels.set({ background, flat: !!camera?.flat, turn: turns, backend: this.#wanted, budget: this.#budgetPlace })
    this.#ui.levels.hidden = !this.#scene?.levels
    this.#ui.budget.textContent = this.#budget
      ? this.#language.of('at most {0}', this.#language.number(this.#budget))
      : this.#language.of('without limit')
    if (camera && !camera.flat) this.#panels.set({ fov: camera.fov })
  }

  #fullScreen() {
    if (document.fullscreenElement) document.exitFullscreen()
    else this.requestFullscreen?.().catch(() => this.#panels.note('This browser keeps the page as it is'))
  }

  /** orbit or fly. */
  #setMode(mode) {
    this.#pilot.mode = mode
    this.#panels.setMode(mode)
    if (this.#scene) this.#change()
  }

  /** The mouse looks around without a button, until Escape. */
  #capture() {
    this.#setMode('fly')
    this.#ui.stage.requestPointerLock?.()?.catch(() => this.#panels.note('This browser keeps the mouse to itself'))
  }

  #press(key) {
    const pilot = this.#pilot
    const does = {
      h: () => this.#toggle(this.#ui.help),
      Escape: () => (this.#toggle(null), this.#tour?.close()),
      k: () => this.#tour?.toggle(),
      ',': () => this.#tour?.step(-1),
      '.': () => this.#tour?.step(1),
      o: () => this.#ui.file.click(),
      n: () => this.showView(pilot.index + 1),
      p: () => this.showView(pilot.index - 1),
      r: () => this.#scene && pilot.glide(pilot.start),
      0: () => this.#scene && pilot.glide(pilot.whole),
      1: () => this.#setMode('orbit'),
      2: () => this.#setMode('fly'),
      g: () => this.#capture(),
      t: () => this.toggleAttribute('turn'),
      b: () => this.#stepBudget(-1),
      v: () => this.#stepBudget(1),
      i: () => this.#screenshot(),
      l: () => this.#copyLink(),
      f: () => this.#fullScreen(),
      '+': () => pilot.zoom(0.9),
      '-': () => pilot.zoom(1 / 0.9),
    }
    does[key.length === 1 ? key.toLowerCase() : key]?.()
  }

  #set({ name, value, checked }) {
    const pilot = this.#pilot
    const does = {
      background: () => this.setAttribute('background', value),
      backend: () => this.setAttribute('backend', value),
      budget: () => this.#setBudget(Number(value)),
      turn: () => this.toggleAttribute('turn', checked),
      flat: () => pilot.flatten(checked),
      speed: () => (pilot.speed = Number(value)),
      fov: () => pilot.widen(Number(value)),
      up: () => pilot.upright(value ? value.split(',').map(Number) : undefined),
      readout: () => (this.#ui.readout.hidden = !checked),
      sharpness: () => (this.#settings.sharpness = Number(value)),
      colours: () => (this.#settings.colours = checked),
    }
    does[name]()
    this.#change()
  }

  #listen() {
    const ui = this.#ui
    const acts = this.#pilot.acts({ focus: (x, y) => this.#focus(x, y), press: (key) => this.#press(key) })
    const held = listenToKeys(this, acts)
    listenToPointers(ui.stage, acts, () => held.has('Space'))
    const clicks = {
      choose: 'o',
      add: 'o',
      before: 'p',
      after: 'n',
      orbit: '1',
      fly: '2',
      home: 'r',
      share: 'l',
      photo: 'i',
      keys: 'h',
      full: 'f',
    }
    for (const [id, key] of Object.entries(clicks)) ui[id].onclick = () => this.#press(key)
    ui.mark.onclick = () => this.#mark()
    ui.addKey.onclick = () => this.#addKey()
    ui.save.onclick = () => this.#saveSettings()
    ui.set.onclick = () => this.#toggle(ui.options)
    for (const id of ['closeHelp', 'closeOptions']) ui[id].onclick = () => this.#toggle(null)
    ui.file.onchange = () => this.#openFiles(ui.file.files).then(() => (ui.file.value = ''))
    ui.options.oninput = (event) => this.#set(event.target)
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
}

customElements.define('fixsplat-viewer', Viewer)
