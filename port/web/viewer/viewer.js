// The element <fixsplat-viewer> shows the scene of its attribute `src`, and a scene for each <fixsplat-scene> element
// inside. The attribute `src` and the method `open` load a scene in a new worker (#openAlone). The new worker replaces
// the present worker when the scene has arrived. Further scenes are loaded in the present worker (#load).
import { addressIn } from 'fixsplat/fixsplat_assets.js'
import { Engine, HOME } from './engine.js'
import { listenToKeys, listenToPointers } from './input.js'
import { Pilot } from './pilot.js'
import { Picture, backends } from './picture.js'
import { Panels } from './panels.js'
import { body } from './body.js'
import { Language, askedFor } from './language.js'
import { Item, PlacedScene, WATCHED } from './scenes.js'
import { style } from './style.js'
import { addressOf, cameraOf, checkedCamera, fetchViews, nameOf, textOf, viewsOf } from './views.js'

const STILL_MS = 150 // milliseconds without motion after which the picture is at rest
const GLIDE_MS = 1000 // default duration of flyTo in milliseconds
const KEPT_S = 60
const HINT_MS = 5000
// Steps of the quality slider: the largest number of Gaussians in a picture. One more step means no limit.
const BUDGETS = [5e4, 1e5, 2e5, 3e5, 5e5, 75e4, 1e6, 15e5, 2e6, 3e6, 5e6]
const LOOK = ['tone', 'exposure', 'vignette']
const DARK = '#0e1116'
const LIGHT = '#eef0f3'
// user agents of headset browsers, which offer WebXR on secure pages only
const OF_HEADSETS = /OculusBrowser|Wolvic|Pico/i

const MOST_AWAY = 2 // number of viewers that keep their scenes in memory after removal from the page
const away = new Set()

const template = document.createElement('template')
template.innerHTML = body
const sheet = new CSSStyleSheet()
sheet.replaceSync(style)

export class Viewer extends HTMLElement {
  static observedAttributes = ['src', 'cameras', 'view', 'background', 'budget', 'detail', 'backend', 'poster', 'turn',
    'settings', 'annotation', 'skybox', 'lang', 'label', 'eye-height', 'joystick', 'noui', 'ui', 'ar', 'edit',
    'time', 'playing', 'speed', 'loop', 'sound', 'muted', 'volume', ...LOOK]

  #headset = null
  #room = null
  #engine = null
  #opening = null
  #adding = null
  #taken = Promise.resolve()
  #gathered = Promise.resolve()
  #items = []
  #main = null
  #src = null
  #dropped = []
  #leaving = 0
  #isHere = false
  #scene = null
  #picture
  #pilot = new Pilot(this, (moving, byHand) => this.#moved(moving, byHand))
  #good = null
  #asked = null
  #linked = null
  #busy = false
  #switching = false
  #held = false
  #changed = false
  #missing = 0
  #stuck = false
  #movedAt = -Infinity
  #hintedAt = -Infinity
  #settings = { sharpness: 1, colours: true, enlarge: 1 }
  #language = new Language()
  #acts
  #stick = null
  #touches = matchMedia('(pointer: coarse)').matches
  #tour = null
  #touring = null
  #begins = null
  #moving = null // promise of the player of moving scenes; null before the first moving scene
  #clock = null // this player
  #editing = null
  #noSky = ''
  #ui
  #panels

  constructor() {
    super()
    this.attachShadow({ mode: 'open', delegatesFocus: true }).append(template.content.cloneNode(true))
    this.shadowRoot.adoptedStyleSheets = [sheet]
    this.#panels = new Panels(this.shadowRoot, this.#language)
    this.#ui = this.#panels.ui
    this.#picture = new Picture(this.#ui.stage)
    this.#listen()
    this.#setMode('orbit')
    this.#language.take(this.shadowRoot)
    const watched = { childList: true, subtree: true, attributeFilter: WATCHED }
    new MutationObserver(() => this.#gather()).observe(this, watched)
  }

  #restyle(change) {
    this.shadowRoot.adoptedStyleSheets = change([...this.shadowRoot.adoptedStyleSheets])
  }

  connectedCallback() {
    clearTimeout(this.#leaving)
    this.#leaving = 0
    if (this.#isHere) return this.#readSrc()
    this.#isHere = true
    away.delete(this)
    this.state = this.#scene || this.#opening ? 'loading' : 'empty'
    for (const item of this.#items) item.keep()
    this.resized = new ResizeObserver(() => {
      this.#fitPoster()
      this.#change()
    })
    this.resized.observe(this)
    this.theme = matchMedia('(prefers-color-scheme: light)')
    this.theme.onchange = () => this.#change()
    this.shown = () => this.#change()
    document.addEventListener('visibilitychange', this.shown)
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches
    for (const name of still ? ['poster', 'edit'] : ['poster', 'edit', 'turn'])
      this.attributeChangedCallback(name, null, this.getAttribute(name))
    this.#choose()
    this.#look()
    if (this.hasAttribute('settings')) this.#readSettings()
    this.#readSrc()
    this.#gather()
    this.#findHeadset()
    this.joined = () => import('./gamepad.js').then(({ join }) => this.#isHere && join(this, this.#acts))
    addEventListener('gamepadconnected', this.joined)
    try {
      if (navigator.getGamepads().some(Boolean)) this.joined()
    } catch {}
  }

  /** Waits after the element is removed, so that a viewer that is moved within the document keeps running. */
  disconnectedCallback() {
    this.#leaving = setTimeout(() => this.#leave())
  }

  #leave() {
    this.#isHere = false
    this.resized.disconnect()
    this.theme.onchange = null
    document.removeEventListener('visibilitychange', this.shown)
    removeEventListener('gamepadconnected', this.joined)
    this.#pilot.turnByItself(false)
    this.#headset?.end()
    const isLoading = this.#opening
    this.#cancel()
    if (isLoading) this.#src = null
    for (const item of this.#items) this.#letGo(item)
    away.add(this)
    if (away.size > MOST_AWAY) [...away][0].#end()
  }

  #end() {
    away.delete(this)
    for (const item of this.#items) item.keep()
    this.#items = []
    this.#main = this.#src = null
    this.#close()
  }

  attributeChangedCallback(name, before, value) {
    if (!this.isConnected || before === value) return
    if (name === 'src') this.#readSrc()
    if (name === 'cameras' && this.#scene) this.#changeViews(value)
    if (name === 'view') this.#goTo(cameraOf(value))
    if (['background', 'budget', 'detail', 'skybox'].includes(name)) this.#change()
    if (name === 'settings' && value) this.#readSettings()
    if (name === 'annotation' && this.#scene) this.#goToAttribute()
    if (name === 'lang') this.#choose()
    if (name === 'label') this.#entitle()
    if (name === 'eye-height') this.#pilot.walker?.stand()
    if (['joystick', 'noui', 'ui'].includes(name)) this.#showStick()
    if (name === 'ar') this.#findHeadset()
    if (name === 'time') this.#clock?.seek(Number(value))
    if (name === 'playing') this.playing = value !== 'false'
    if (name === 'sound' && this.#scene) this.#takeMotion().catch((error) => this.#fail(error))
    if (['speed', 'loop', 'muted', 'volume'].includes(name)) this.#clock?.changed()
    if (LOOK.includes(name)) this.#look()
    if (name === 'edit') this.#ui.edit.hidden = value === null
    if (name === 'backend') this.#redraw(() => this.#engine && this.#switch(this.#engine))
    if (name === 'poster' && value) this.#showPoster(value)
    if (name === 'turn') this.#pilot.turnByItself(value !== null)
  }

  get state() {
    return this.getAttribute('state')
  }
  set state(value) {
    this.setAttribute('state', value)
  }

  get backend() {
    return this.#picture.backend
  }
  set backend(name) {
    this.#setAttribute('backend', name)
  }

  get view() {
    return this.#pilot.camera ? textOf(this.#pilot.camera) : ''
  }
  set view(text) {
    this.#setAttribute('view', text)
  }

  /** Sets an attribute, or removes it for null and undefined, which React may pass. */
  #setAttribute(name, value) {
    if (value === null || value === undefined) this.removeAttribute(name)
    else this.setAttribute(name, value)
  }

  get camera() {
    return this.#pilot.camera && structuredClone(this.#pilot.camera)
  }
  set camera(camera) {
    if (this.#scene) this.#goTo(checkedCamera(camera, this.#pilot.camera))
    else this.#asked = camera && checkedCamera(camera)
  }

  #goTo(camera) {
    if (camera && this.#scene) this.#pilot.touched = true
    this.#pilot.show(camera)
  }

  async flyTo(camera, { duration = GLIDE_MS } = {}) {
    if (!this.#scene) return false
    return this.#pilot.glide(checkedCamera(camera, this.#pilot.camera), duration)
  }

  async pick(x, y) {
    if (!this.#scene || !this.clientWidth || !this.clientHeight) return null
    const found = await this.#pick(x / this.clientWidth, y / this.clientHeight, this.#frame()).catch(() => null)
    if (!found) return null
    const { key, gaussian, depth, position } = found
    const item = this.#items.find((one) => one.key === key)
    return item ? { position, depth, gaussian, scene: item.told } : null
  }

  get settings() {
    return Object.fromEntries(Object.entries(this.#table).map(([name, [get]]) => [name, get()]))
  }
  set settings(values) {
    if (typeof values === 'string') return this.setAttribute('settings', values)
    const names = Object.keys(this.#table)
    for (const name of Object.keys(values))
      if (!names.includes(name)) throw new Error(`${name}: expected one of ${names.join(', ')}`)
    for (const [name, value] of Object.entries(values)) this.#table[name][1](value)
    this.#change()
    this.#showSettings()
  }

  get #address() {
    const { source } = this.#main ?? {}
    return typeof source === 'string' ? source : ''
  }

  /** Returns a link to the scene and the present view. The link goes to this page if `linksHere` is set, or if a
      bundler left the viewer's page out. */
  get link() {
    const link = this.linksHere ? null : addressIn('viewer/index.html', HOME)
    if (!link) return `${location.href.replace(/#.*/, '')}#view=${this.view}`
    link.searchParams.set('scene', this.#address)
    const cameras = this.getAttribute('cameras')
    if (cameras) link.searchParams.set('cameras', addressOf(cameras))
    for (const name of ['settings', 'skybox', 'sound'])
      if (this.hasAttribute(name)) link.searchParams.set(name, addressOf(this.getAttribute(name)))
    for (const name of ['label', 'background', 'budget', 'detail', 'eye-height', 'speed', 'loop', ...LOOK])
      if (this.hasAttribute(name)) link.searchParams.set(name, this.getAttribute(name))
    if (this.#moves && this.paused) {
      link.searchParams.set('time', this.time)
      link.searchParams.set('playing', false)
    }
    link.hash = `view=${this.view}`
    return link.href
  }

  // ---- Annotations, camera tracks and settings files ----------------------------------------------------------------

  #tourNow() {
    return (this.#touring ??= import('./tour.js').then(({ Tour }) => (this.#tour = new Tour(this.#tourHost()))))
  }

  #tourHost() {
    const ask = async (...args) => this.#engine.ask(...args)
    // `seconds` is the time in a film
    const sized = (width, height, seconds) => {
      const time = seconds === undefined ? {} : { time: this.#clock?.timeAt(seconds) }
      return { ...this.#frame(), width, height, ...time }
    }
    return {
      element: this,
      root: this.shadowRoot,
      style: (sheet) => this.#restyle((sheets) => [...sheets, sheet]),
      ui: this.#ui,
      language: this.#language,
      camera: () => this.#good,
      current: () => this.#pilot.camera,
      up: () => this.#pilot.up,
      radius: () => this.#pilot.radius,
      aspect: () => this.clientWidth / this.clientHeight || 1,
      size: () => this.#frame(),
      show: (camera) => this.#pilot.follow(camera),
      fly: (camera, duration) => this.#pilot.glide(camera, duration),
      draw: (camera, ...size) => ask('draw', 0, this.#pilot.rendered(sized(...size), camera), sized(...size)),
      depths: (pixels, camera, ...size) =>
        ask('depths', pixels, this.#pilot.rendered(sized(...size), camera), sized(...size)),
      linkTo: (index) => this.#linkTo(index),
      copy: (link) => this.#copyAddress(link),
      save: (blob, name) => this.#save(blob, name),
      saveTrack: (command) => this.#saveSettings(command),
      scene: () => this.#shown[0].name,
      note: (...words) => this.#panels.note(...words),
      say: (error) => this.#fail(error),
      tell: (name, detail) => this.#tell(name, detail),
      change: () => this.#change(),
      press: (key) => [',', '.', 'k'].includes(key.toLowerCase()) && this.#press(key),
    }
  }

  async readSettings(source) {
    const tour = await this.#tourNow()
    const words = await tour.read(source)
    if (words.length) this.#fail(new Error(words.join('\n')))
    if (this.#scene && tour.home) this.#takeViews(this.#pilot.views)
    if (this.#scene) tour.begin()
    return words
  }

  #readSettings() {
    this.#begins = this.readSettings(this.getAttribute('settings')).catch((error) => this.#fail(error))
  }

  #beginTour(view) {
    if (this.hasAttribute('annotation')) this.#goToAttribute()
    else if (!view) this.#tour?.begin()
  }

  #goToAttribute() {
    const number = Number(this.getAttribute('annotation'))
    if (number) this.#tourNow().then((tour) => tour.goTo(number - 1, 1)).catch((error) => this.#fail(error))
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
    this.#tourNow().then((tour) => (tour[name] = list)).catch((error) => this.#fail(error))
  }

  async goTo(index) {
    return (await this.#tourNow()).goTo(index)
  }

  async play(track) {
    return (await (track === undefined && this.#moves ? this.#moving : this.#tourNow())).play(track)
  }

  pause() {
    if (this.#moves && !this.#clock) this.#setAttribute('playing', 'false')
    this.#clock?.pause()
    this.#tour?.pause()
  }

  seek(seconds) {
    if (this.#moves && !this.#clock) this.#moving.then(() => this.seek(seconds))
    else this.#player?.seek(seconds)
  }

  get time() {
    return this.#player?.time ?? this.#moment.time ?? 0
  }
  set time(seconds) {
    this.seek(Number(seconds))
  }

  get duration() {
    return this.#player?.duration ?? this.#scene?.moving?.duration ?? 0
  }

  get paused() {
    return this.#moves ? !this.#clock?.playing : (this.#tour?.paused ?? true)
  }

  get playing() {
    return !this.paused
  }
  set playing(plays) {
    if (!this.#player) this.#setAttribute('playing', plays ? '' : 'false')
    else if (plays) this.play()
    else this.pause()
  }

  get speed() {
    return this.#clock?.speed ?? (Number(this.getAttribute('speed')) || 1)
  }
  set speed(speed) {
    this.#setAttribute('speed', speed)
  }

  get loop() {
    return this.#clock?.loop ?? false
  }
  set loop(loops) {
    this.#setAttribute('loop', typeof loops === 'boolean' ? (loops ? '' : 'none') : loops)
  }

  get sound() {
    return this.getAttribute('sound')
  }
  set sound(url) {
    this.#setAttribute('sound', url)
  }

  get muted() {
    return this.hasAttribute('muted')
  }
  set muted(is) {
    this.toggleAttribute('muted', !!is)
  }

  get volume() {
    return Number(this.getAttribute('volume') ?? 1)
  }
  set volume(volume) {
    this.#setAttribute('volume', volume)
  }

  async film(options) {
    return (await this.#tourNow()).film(options)
  }

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

  async #saveSettings(command = '') {
    if (!this.#scene) return
    const { savedText } = await this.#tourNow()
    this.#save(new Blob([savedText], { type: 'application/json' }), 'settings.json')
    this.#panels.note((await this.#copies(command)) ? 'Settings saved, command copied' : 'Settings saved')
  }

  async #copies(text) {
    return !!text && navigator.clipboard?.writeText(text).then(() => true, () => false)
  }

  async #edit() {
    const [item, ...more] = this.#shown
    if (!item) return
    this.#toggle(null)
    const isMoved = Object.keys(item.place).length > 0
    if (this.#moves) return this.#panels.note('A moving scene cannot be edited')
    if (more.length || isMoved || this.#scene.paged)
      return this.#panels.note('To edit, open one scene alone, whole and where it is')
    const { Edit } = await import('./edit.js')
    this.#editing ??= new Edit({
      ...this.#tourHost(),
      edit: (...args) => this.#engine.ask('edit', this.#shown[0].key, ...args),
      rendered: (size, camera) => this.#pilot.rendered(size, camera),
      name: () => this.#shown[0].name.replace(/\.[^.]*$/, ''),
      changed: ({ left }) => {
        this.#scene.count = left
        this.#entitle()
        this.#change()
      },
    })
    await this.#editing.begin()
  }

  async #choose() {
    if (!(await this.#language.choose(askedFor(this.getAttribute('lang'))))) return
    this.#entitle()
    this.#showSettings()
    this.#tour?.rename()
    this.#clock?.rename()
  }

  // ---- Moving scenes ------------------------------------------------------------------------------------------------

  get #moves() {
    return !!this.#scene?.moving
  }

  /** The player of the moving scene, or of the camera track of a still scene. */
  get #player() {
    return this.#moves ? this.#clock : this.#tour
  }

  async #takeMotion() {
    if (this.#moves) this.#moving ??= import('./moving.js').then(({ Moving }) => new Moving(this.#tourHost()))
    if (!this.#moving) return
    const clock = await this.#moving
    if (clock !== this.#clock) clock.reset()
    this.#clock = clock
    const { sound = null } = this.#shown.map(({ facts }) => facts).find(({ sound }) => sound) ?? {}
    clock.take(this.#scene?.moving ?? null, this.getAttribute('sound') || sound)
    if (this.state === 'still' && !this.#held) clock.begin()
  }

  /** The time of a moving scene for a picture, and the seconds behind it whose parts are requested early. */
  get #moment() {
    if (!this.#moves) return {}
    return this.#clock ? { time: this.#clock.time, ahead: this.#clock.ahead } : { time: this.#numberOf('time') }
  }

  // ---- Opening a scene ----------------------------------------------------------------------------------------------

  #readSrc() {
    const src = this.getAttribute('src')
    if (src === this.#src) return
    this.#src = src
    if (src) this.open(src, this.#fetchViews(), cameraOf(this.getAttribute('view')))
    else this.clear()
  }

  clear() {
    if (this.#opening && !this.#opening.item.element) this.#cancel()
    this.#main = null
    for (const element of this.#dropped.splice(0)) element.remove()
    this.#gather()
  }

  async #fetchViews() {
    const url = this.getAttribute('cameras')
    return url ? fetchViews(url).catch((error) => this.#fail(error) ?? []) : []
  }

  async #changeViews(url) {
    const views = await this.#fetchViews()
    if (this.#scene && url === this.getAttribute('cameras')) this.#takeViews(views)
  }

  get #hasLook() {
    return LOOK.some((name) => this.hasAttribute(name))
  }

  async #look() {
    if (!this.#hasLook && !this.shadowRoot.getElementById('look')) return
    const { look } = await import('./look.js')
    const { tone, exposure, vignette } = this.settings
    look(this.shadowRoot, { tone, exposure, vignette })
  }

  #showPoster(url) {
    if (this.#scene) return
    const image = Object.assign(new Image(), { src: url, alt: '' })
    this.#ui.stage.style.background = this.getAttribute('background') ?? ''
    this.#ui.stage.querySelector('img')?.remove()
    this.#ui.stage.append(image)
    this.#fitPoster()
  }

  /** Gives the poster the height of the first picture, by the formula of ofView in motion.js. */
  #fitPoster() {
    const image = this.#ui.stage.querySelector('img')
    const [heights, widths] = (this.getAttribute('poster-frame') ?? '').split(' ').map(Number)
    const aspect = this.clientWidth / this.clientHeight
    if (!image || !(heights > 0 && widths > 0)) return
    const tall = aspect < 1 ? Math.min(heights / widths, 1 / aspect) / aspect : 1
    image.style.height = `${(100 * heights) / Math.max(tall, 1)}%`
  }

  async open(source, views = [], view = null) {
    const item = this.#keptOf(source) ?? new Item(source)
    this.#cancel()
    if (!item.engine) return this.#openAlone(item, views, view)
    this.#main = item
    const isOpen = await this.#gather()
    if (!isOpen) return false
    this.#takeViews(await views, view)
    this.#tell('load', item.told)
    return true
  }

  #keptOf(source) {
    const { source: address } = new Item(source)
    const isKept = (item) => item.source === address && !item.element && item !== this.#main
    return this.#items.find((item) => isKept(item) && item.engine && item.engine === this.#engine)
  }

  add(source, place = {}) {
    const element = Object.assign(new PlacedScene(), place)
    if (typeof source === 'string') element.src = source
    else element.source = source
    return this.appendChild(element)
  }

  async #openAlone(item, views, view) {
    const opening = (this.#opening = { item, views, view })
    this.#begin(item)
    try {
      if (!globalThis.WebAssembly) throw new Error('no WebAssembly')
      if (typeof item.source === 'string') addressOf(item.source)
      opening.engine = this.#newEngine((told) => this.#hear(opening, told))
      await this.#take(opening, await opening.engine.open(item.key, item.source, item.place, !this.#scene))
      if (opening.engine !== this.#engine) return false
      this.#asked = null
      this.#tell('load', item.told)
      this.#beginTour(view ?? this.#asked)
      return true
    } catch (error) {
      if (this.#opening !== opening) return false
      item.failed = true
      this.#cancel()
      this.#fail(error, item)
      this.#gather()
      return false
    } finally {
      if (this.#opening === opening) {
        this.#begun()
        this.#gather()
      }
    }
  }

  async replace(url) {
    const [engine, item] = [this.#engine, this.#main]
    if (!this.#scene || !item || item.engine !== engine || this.#opening || this.#held) return false
    this.#held = true
    const source = addressOf(url)
    const facts = await engine.open(item.key, source, item.place).finally(() => (this.#held = false))
    if (engine !== this.#engine) return false
    Object.assign(item, { source, facts })
    this.#show(facts.whole)
    this.#change()
    return true
  }

  // ---- Several scenes -----------------------------------------------------------------------------------------------

  get scenes() {
    return this.#scene ? this.#shown.map((item) => item.told) : []
  }

  get #wantedItems() {
    const elements = [...this.querySelectorAll('fixsplat-scene')].filter((one) => one.source || one.getAttribute('src'))
    return [this.#main, ...elements.map((element) => this.#itemOf(element))].filter((item) => item && !item.failed)
  }

  get #shown() {
    return this.#wantedItems.filter((item) => item.engine && item.engine === this.#engine)
  }

  #itemOf(element) {
    const item = new Item(element.source ?? element.getAttribute('src'), element)
    const own = this.#items.find((other) => other.element === element && other.source === item.source)
    if (!own) this.#items.push(item)
    return own ?? item
  }

  /** Loads, places and removes scenes until the viewer shows exactly the scenes that its attributes and elements ask
      for. */
  #gather() {
    const next = () => this.#gatherNow().catch((error) => this.#engine && this.#fail(error))
    return (this.#gathered = this.#gathered.then(next).then(() => !!this.#scene))
  }

  async #gatherNow() {
    if (!this.#isHere || this.#opening) return
    const wanted = this.#wantedItems
    for (const item of this.#items) {
      if (wanted.includes(item)) item.keep()
      else this.#letGo(item)
    }
    const engine = this.#engine
    const missing = wanted.find((item) => !item.engine || item.engine !== engine)
    if (missing && !engine) {
      this.#openAlone(missing, this.#fetchViews(), cameraOf(this.getAttribute('view')))
      return
    }
    this.#adding = missing
    try {
      if (missing) await this.#load(engine, missing)
      if (engine && engine === this.#engine && !this.#opening) await this.#place(engine)
    } finally {
      this.#adding = null
      if (missing && !this.#opening) this.#begun()
    }
    if (missing) this.#gather()
  }

  async #load(engine, item) {
    const { bytes } = item
    if (!bytes) this.#begin(item)
    try {
      const facts = await engine.open(item.key, bytes ?? item.source, item.place)
      if (engine !== this.#engine) return
      Object.assign(item, { engine, bytes: null, facts: bytes ? item.facts : facts })
      if (!bytes) this.#tell('load', item.told)
    } catch (error) {
      if (engine !== this.#engine) return
      item.failed = true
      this.#fail(error, item)
    }
  }

  async #place(engine) {
    const list = this.#shown.map(({ key, place }) => ({ key, place }))
    for (const item of this.#shown) if (item.wrong) this.#fail(item.wrong, item)
    const [placed, keys] = [JSON.stringify(list), list.map(({ key }) => key).join()]
    if (this.#scene && placed === engine.placed) return
    if (!list.length) return this.#showNothing()
    const whole = await engine.ask('place', list)
    if (engine !== this.#engine) return
    const isOther = engine.keys !== keys
    Object.assign(engine, { placed, keys })
    if (!this.#scene) await this.#inTurn(() => this.#switch(engine))
    if (engine !== this.#engine) return
    this.#show(whole)
    const { touched, views } = this.#pilot
    if (isOther && !touched && !this.#linked && !views.length) {
      this.#pilot.show(this.#pilot.start)
      if (this.#pilot.walks) this.#walk()
    } else this.#change()
  }

  /** Frees a scene that is no longer shown after `keep` seconds. Ends the worker if no other scene is in it. */
  #letGo(item) {
    const seconds = this.hasAttribute('keep') ? this.#numberOf('keep') : KEPT_S
    item.let(seconds, () => {
      this.#items = this.#items.filter((other) => other !== item)
      if (item === this.#main) this.#main = this.#src = null
      item.engine?.ask('free', item.key).catch(() => {})
      if (this.#items.some(({ engine }) => engine && engine === this.#engine)) return
      if (this.#isHere) this.#close()
      else this.#end()
    })
  }

  #show(whole) {
    const [first, ...more] = this.#shown
    const name = first?.facts.name ?? whole.name
    this.#scene = { ...whole, name: more.length ? this.#language.of('{0} and {1} more', name, more.length) : name }
    this.setAttribute('open', '')
    this.#entitle()
    this.#pilot.take(this.#scene)
    this.#takeMotion().catch((error) => this.#fail(error))
  }

  #entitle() {
    if (this.#scene) this.#panels.entitle(this.#scene, this.getAttribute('label'))
  }

  #showNothing() {
    this.#headset?.end()
    this.#scene = null
    this.#clock?.take(null)
    this.#picture.close()
    this.removeAttribute('open')
    this.state = this.#opening ? 'loading' : 'empty'
  }

  #newEngine(hear) {
    return new Engine(hear, Number(this.getAttribute('threads')) || undefined)
  }

  #cancel() {
    const { engine } = this.#opening ?? {}
    this.#begun()
    engine?.end()
    if (engine && engine === this.#engine) this.#close()
    this.state = this.#scene ? 'still' : 'empty'
  }

  #close() {
    const engine = this.#engine
    if (this.#main?.engine === engine) this.#main = null
    this.#showNothing()
    this.#leaveTo(null)
    engine?.end()
  }

  #leaveTo(engine, there = []) {
    this.#items = this.#items.filter((item) => item === this.#main || item.element || there.includes(item))
    for (const item of this.#items) item.engine = there.includes(item) ? engine : null
    this.#engine = engine
  }

  #begin({ name }) {
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
    else if (told.stage === 'preview') {
      // a preview that fails is ignored, since loading the whole scene reports the error
      if (opening === this.#opening) this.#take(opening, told.scene).catch(() => {})
    } else this.#hearOfProgress([this.#opening?.item, this.#adding].find((item) => item?.key === told.key), told)
  }

  #hearOfProgress(item, { stage, done, bytes }) {
    if (!item || item.bytes) return
    this.#panels.progress(item.name, { stage, done, bytes })
    this.#tell('progress', { source: item.source, name: item.name, element: item.element, stage, done, bytes })
  }

  #tell(event, detail) {
    this.dispatchEvent(new CustomEvent(event, { detail }))
  }

  /** Loads the scenes again that could not be loaded without a network. */
  #retry() {
    if (!this.#isHere) return
    for (const item of this.#items) item.failed = false
    if (!this.#scene && !this.#opening) this.#src = null
    this.#readSrc()
    this.#gather()
  }

  async #fail(cause, { source } = {}) {
    if (source && navigator.onLine === false) addEventListener('online', () => this.#retry(), { once: true })
    // If words.js, which translates errors, cannot be loaded, the message of the error is shown unchanged.
    const bare = { wordsOf: ({ message }) => ({ kind: 'other', words: message }) }
    const { wordsOf } = await import('./words.js').catch(() => bare)
    const { kind, words: message } = wordsOf(cause, (...words) => this.#language.of(...words))
    const error = Object.assign(new Error(message, { cause }), { kind, source })
    this.#panels.say(error)
    this.dispatchEvent(new ErrorEvent('error', { message, error }))
  }

  #sayNoSky({ url, words }) {
    if (this.#noSky === this.getAttribute('skybox')) return
    this.#noSky = this.getAttribute('skybox')
    this.#fail(new Error(words))
    this.#change()
  }

  #hearOfParts(opening, words) {
    if (opening && opening.engine !== this.#engine) return
    if (words) {
      this.#stuck = true
      this.#fail(new Error(words))
    }
    // a picture that is being drawn may lack the parts that have come
    if (this.#missing || this.#busy || words) this.#change()
  }

  async #take(opening, scene) {
    const [views] = await Promise.all([opening.views, this.#begins])
    return this.#inTurn(() => this.#takeNext(opening, scene, views))
  }

  #inTurn(change) {
    return (this.#taken = this.#taken.catch(() => {}).then(change))
  }

  #redraw(change) {
    const engine = this.#engine
    this.#inTurn(change).then(
      (is) => is && this.#change(),
      (error) => engine && engine === this.#engine && this.#fail(error)
    )
  }

  async #takeNext(opening, facts, views) {
    const { engine, item, view } = opening
    if (opening !== this.#opening) return
    if (engine !== this.#engine) {
      this.#headset?.end()
      await this.#switch(engine)
      await this.#packAll()
      if (opening !== this.#opening) return
      this.#takeWorker(engine, item)
      this.#clock?.reset()
    }
    item.facts = facts
    this.#missing = 0
    this.#stuck = false
    this.#show(facts.whole)
    if (this.#pilot.touched) this.#change()
    else this.#takeViews(views, view ?? this.#asked)
  }

  async #packAll() {
    for (const item of this.#shown.filter(({ element }) => element))
      // The bytes are null for a streamed scene, which cannot be packed into one file.
      item.bytes = await this.#engine.ask('packed', item.key).catch(() => null)
  }

  #takeWorker(engine, item) {
    const old = this.#engine
    if (!item.element) this.#main = item
    if (!this.#items.includes(item)) this.#items.push(item)
    this.#leaveTo(engine, [item])
    old?.end()
    Object.assign(engine, { placed: JSON.stringify([{ key: item.key, place: item.place }]), keys: `${item.key}` })
    this.#busy = this.#pilot.touched = false
    if (this.matches(':focus-within')) this.#ui.stage.focus({ focusVisible: false })
  }

  #takeViews(views, view = null) {
    this.#ui.before.hidden = this.#ui.after.hidden = !views.length
    this.#good = null
    this.#linked = view
    this.#pilot.takeViews(views, view, () => this.#tour?.home ?? null)
    if (this.#pilot.walks) this.#walk()
    this.#showSettings()
  }

  async #takeDrop(entries, files) {
    try {
      await this.#openFiles(await (await import('./drop.js')).filesOf(entries, files))
    } catch (error) {
      this.#fail(error)
    }
  }

  async #openFiles(files) {
    try {
      const { scenes, views } = (await import('./drop.js')).scenesIn(files)
      if (scenes.length && !(await this.#openScenes(scenes))) return
      if (!scenes.length && !views) throw new Error(files.length ? 'no scene' : 'no files')
      if (!views) return
      if (!this.#scene) throw new Error(`${views.name}: open a scene first, then its views`)
      const text = await views.text()
      if (/^\s*\{/.test(text)) await this.readSettings(views)
      else this.#takeViews(viewsOf(views.name, text))
    } catch (error) {
      this.#fail(error)
    }
  }

  async #openScenes([first, ...more]) {
    if (!(await this.open(first))) return false
    this.removeAttribute('label') // the attribute label named the former scene
    for (const element of this.#dropped.splice(0)) element.remove()
    this.#dropped = more.map((files) => this.add(files))
    if (more.length) this.#panels.note('{0} scenes in one picture', more.length + 1)
    return true
  }

  // ---- Pictures -----------------------------------------------------------------------------------------------------

  get #isMoving() {
    return performance.now() - this.#movedAt < STILL_MS || !!this.#clock?.runs
  }

  get #colour() {
    const given = this.getAttribute('background')
    return /^#[0-9a-f]{6}$/i.test(given) ? given : this.theme?.matches ? LIGHT : DARK
  }

  get #background() {
    return parseInt(this.#colour.slice(1), 16)
  }

  #frame(moving = false) {
    const [width, height] = [this.clientWidth, this.clientHeight].map(
      (n) => n * devicePixelRatio * this.#settings.sharpness
    )
    const size = this.#picture.size(width, height, moving)
    const url = this.getAttribute('skybox')
    const sky = url && url !== this.#noSky ? { url: new URL(url, document.baseURI).href, up: this.#pilot.up } : null
    const bounds = { budget: this.#budget, detail: Math.min(this.#numberOf('detail'), 16384) }
    return { ...size, ...bounds, ...this.#moment, sky, background: this.#background, shDegree: this.#settings.colours ? 3 : 0 }
  }

  #numberOf(name) {
    return Math.max(Number(this.getAttribute(name)), 0) || 0
  }

  get #budget() {
    return Math.round(this.#numberOf('budget')) || undefined
  }

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

  #moved(moving, byHand) {
    if (moving) this.#movedAt = performance.now()
    this.#change()
    this.#tell('camera', { camera: this.camera, byHand })
  }

  get #wanted() {
    const asked = this.getAttribute('backend')
    return asked in backends ? asked : ''
  }

  async #switch(engine) {
    this.#switching = true
    const has = await this.#picture.open(engine, this.#wanted).finally(() => (this.#switching = false))
    if (!has) this.#panels.note('This browser does not draw scenes on the graphics card: the processor does')
    return true
  }

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
    if (this.#scene) this.#after(options)
  }

  async #drawNow(engine, options) {
    const { camera } = this.#pilot
    const picture = await this.#picture.draw(this.#pilot.rendered(options), options)
    if (engine !== this.#engine || !picture) return
    this.#missing = picture.missing ?? 0
    if (!this.#good) this.#panels.greet(this.getAttribute('wheel') === 'page')
    this.#good = camera
    this.#panels.read(picture)
    this.#clock?.drawn(this.#stuck ? 0 : this.#missing)
    this.#tell('frame', picture)
    this.#tour?.drawn()
  }

  #refused(error) {
    if (/memory/.test(error.message) && this.#picture.shrink(this.#frame())) {
      this.#panels.note('There is too little memory for a picture of this size: it has fewer pixels')
      this.#changed = true
    } else if (this.#good && this.#good !== this.#pilot.camera) this.#pilot.camera = this.#good
    else {
      this.#fail(error)
      if (this.#linked && this.#linked === this.#pilot.camera) this.#pilot.show(this.#pilot.start)
    }
  }

  #after({ divisor }) {
    if (this.#changed) return requestAnimationFrame(() => this.#draw())
    clearTimeout(this.timer)
    if (this.#isMoving || divisor > 1) this.timer = setTimeout(() => this.#change(), STILL_MS)
    else if (this.#opening || this.#adding || (this.#missing && !this.#stuck)) this.state = 'loading'
    else this.#rest()
  }

  async #rest() {
    this.state = 'still'
    const [engine, options] = [this.#engine, this.#frame()]
    if (this.#pilot.isFlying) {
      const found = await this.#pick(0.5, 0.5, this.#frame(true)).catch(() => null)
      this.#pilot.ahead = found?.position ?? null
    }
    if (this.#held) return
    this.#held = true
    // a streamed scene is not copied: its own worker tries the GPU
    const newEngine = () => (this.#scene.paged ? engine : this.#newEngine((told) => this.#hear(null, told)))
    const list = this.#shown
    const copy = (other) => other === engine || this.#copy(engine, other, list)
    const trial = this.#picture.try(newEngine, copy, this.#pilot.rendered(options), options)
    const other = await trial.finally(() => (this.#held = false))
    this.#clock?.begin()
    if (!other) return
    if (other !== engine) {
      this.#leaveTo(other, list)
      engine.end()
      this.#busy = false
      this.#gather()
    }
    this.#change()
  }

  async #copy(engine, other, items) {
    const list = items.map(({ key, place }) => ({ key, place }))
    for (const { key, place } of list) await other.open(key, await engine.ask('packed', key), place)
    await other.ask('place', list)
    Object.assign(other, { placed: JSON.stringify(list), keys: list.map(({ key }) => key).join() })
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

  #pick(x, y, options) {
    const at = [x * options.width, y * options.height].map(Math.floor)
    return this.#engine.ask('pick', ...at, this.#pilot.rendered(options), options)
  }

  async #click(x, y) {
    const found = await this.pick(x, y)
    if (this.#scene) this.#tell('pick', { x, y, found })
  }

  async #focus(x, y) {
    if (!this.#scene) return
    const found = await this.pick(x, y)
    if (found) this.#pilot.goTo(found.position)
    else this.#panels.note('Nothing there')
  }

  // ---- Headset ------------------------------------------------------------------------------------------------------

  /** Shows the buttons for VR and AR if the browser supports them. A headset browser shows the VR button on an insecure
      page too, where the button tells why VR is not available. */
  async #findHeadset() {
    const { headset, room, arSize } = this.#ui
    const { xr } = navigator
    const has = (mode) => xr?.isSessionSupported(mode).catch(() => false)
    const [vr, ar] = await Promise.all(['immersive-vr', 'immersive-ar'].map(has))
    if (vr || ar) this.#headset ??= await this.#newHeadset()
    if (ar) this.#room ??= (await import('./ar.js')).AR
    headset.hidden = xr ? !vr : isSecureContext || !OF_HEADSETS.test(navigator.userAgent)
    room.hidden = arSize.hidden = !ar || this.getAttribute('ar') === 'off'
    const words = 'A headset needs a page of https://, or of the machine that it is on (http://localhost)'
    headset.onclick = () => (xr ? this.#headset.enter() : this.#fail(new Error(words)))
    room.onclick = () => this.#headset.enter(this.#room)
  }

  get #inRoom() {
    const asked = this.getAttribute('ar')
    return ['true', 'off'].includes(asked) ? asked : 'table'
  }

  async #newHeadset() {
    const { Headset } = await import('./xr.js')
    return new Headset({
      engine: () => this.#engine,
      backend: () => this.backend,
      scene: () => this.#scene,
      view: () => this.#pilot,
      options: () => this.#frame(),
      size: () => this.#inRoom,
      root: this.shadowRoot,
      style: (sheet) => this.#restyle((sheets) => [...new Set([...sheets, sheet])]),
      language: this.#language,
      drawn: (detail) => {
        this.#clock?.drawn(0)
        this.#tell('eyes', detail)
      },
      say: (error) => this.#fail(error),
      changed: (isOn) => {
        this.toggleAttribute('headset', isOn)
        this.#change()
      },
    })
  }

  // ---- Buttons and keys ---------------------------------------------------------------------------------------------

  async picture({ scale = 1 } = {}) {
    if (!this.#scene) throw new Error('no scene')
    const frame = this.#frame()
    const [width, height] = [frame.width, frame.height].map((n) => Math.round(scale * n))
    const options = { ...frame, width, height }
    const bytes = await this.#engine.ask('png', this.#pilot.rendered(options), options)
    return new Blob([bytes], { type: 'image/png' })
  }

  async #screenshot() {
    if (!this.#scene) return
    const { name } = this.#scene
    const { enlarge } = this.#settings
    if (enlarge > 1) this.#panels.note('Drawing the picture')
    try {
      this.#save(await this.picture({ scale: enlarge }), `${name}.png`)
      this.#panels.note(this.#hasLook ? 'Picture saved, without tone curve, exposure and vignette' : 'Picture saved')
    } catch (error) {
      this.#fail(error)
    }
  }

  #save(blob, name) {
    const url = URL.createObjectURL(blob)
    Object.assign(document.createElement('a'), { href: url, download: name }).click()
    setTimeout(() => URL.revokeObjectURL(url), 1000)
  }

  #copyLink() {
    if (this.#scene) this.#copyAddress(this.link)
  }

  async #copyAddress(link) {
    if (!this.#address) return this.#panels.note('This scene is a file of yours: a link cannot hold it')
    this.#panels.note((await this.#copies(link)) ? 'Link copied: it opens this view' : link)
  }

  #toggle(panel) {
    this.#showSettings()
    this.#panels.toggle(panel)
  }

  #showSettings() {
    const { camera, turns } = this.#pilot
    const [background, flat, ar] = [this.#colour, !!camera?.flat, this.#inRoom]
    this.#panels.set({ background, flat, turn: turns, backend: this.#wanted, budget: this.#budgetPlace, ar })
    for (const name of LOOK) this.#panels.set({ [name]: this.#table[name][0]() })
    this.#ui.levels.hidden = !this.#scene?.levels
    this.#ui.budget.textContent = this.#budget
      ? this.#language.of('at most {0}', this.#language.number(this.#budget))
      : this.#language.of('without limit')
    if (camera && !camera.flat) this.#panels.set({ fov: camera.fov })
    const { walks, walker } = this.#pilot
    this.#ui.tall.hidden = !walks || !walker
    if (walker) this.#panels.set({ eyeHeight: Math.log2(walker.height / walker.usual) })
    this.#ui.angle.textContent = `${Math.round(camera?.fov ?? this.#pilot.fov)}°`
  }

  #fullScreen() {
    if (document.fullscreenElement) document.exitFullscreen()
    else this.requestFullscreen?.().catch(() => this.#panels.note('This browser keeps the page as it is'))
  }

  #setMode(mode) {
    this.#pilot.mode = mode
    this.#panels.setMode(mode)
    this.#showStick()
    this.#tell('mode', { mode })
    if (mode === 'walk') this.#walk()
    else if (this.#scene) this.#change()
  }

  async #walk() {
    const { Walker } = await import('./walk.js')
    const pilot = this.#pilot
    pilot.walker ??= new Walker(pilot, {
      scene: () => this.#scene,
      height: () => this.#numberOf('eye-height'),
      walls: () => this.getAttribute('walls'),
      draw: async (camera, size) => this.#engine.ask('heights', camera, { ...this.#frame(), sky: null, ...size }),
      note: (words) => this.#panels.note(words),
    })
    if (!this.#scene || !pilot.walks) return
    await pilot.walker.begin()
    this.#showSettings()
  }

  async #showStick() {
    const auto = this.#touches && !this.matches('[noui], [ui]') ? '' : 'none'
    const is = this.#pilot.mode !== 'orbit' && (this.getAttribute('joystick') ?? auto) !== 'none'
    if (is) this.#stick ??= import('./joystick.js').then(({ joystick }) => joystick(this.shadowRoot, this.#acts))
    if (this.#stick) (await this.#stick).hidden = !is
  }

  #capture() {
    if (!this.#pilot.walks) this.#setMode('fly')
    this.#ui.stage.requestPointerLock?.()?.catch(() => this.#panels.note('This browser keeps the mouse to itself'))
  }

  #press(key) {
    const pilot = this.#pilot
    const does = {
      h: () => this.#toggle(this.#ui.help),
      Escape: () => [this.#toggle(null), this.#tour?.escape()],
      k: () => this.#player?.toggle(),
      ',': () => this.#player?.step(-1),
      '.': () => this.#player?.step(1),
      '[': () => this.#clock?.hurry(0.5),
      ']': () => this.#clock?.hurry(2),
      y: () => this.#clock?.repeat(),
      m: () => this.#clock?.sound?.toggle(),
      o: () => this.#ui.file.click(),
      n: () => this.showView(pilot.index + 1),
      p: () => this.showView(pilot.index - 1),
      r: () => this.#scene && pilot.glide(pilot.start),
      0: () => this.#scene && pilot.glide(pilot.whole),
      1: () => this.#setMode('orbit'),
      2: () => this.#setMode('fly'),
      3: () => this.#setMode('walk'),
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

  #table = {
    background: [() => this.#colour, (value) => this.#setAttribute('background', value)],
    backend: [() => this.#wanted, (value) => this.#setAttribute('backend', value)],
    budget: [() => this.#budget ?? 0, (value) => this.#setAttribute('budget', value || null)],
    detail: [() => this.#numberOf('detail'), (value) => this.#setAttribute('detail', value || null)],
    ar: [() => this.#inRoom, (value) => this.#setAttribute('ar', value)],
    turn: [() => this.hasAttribute('turn'), (value) => this.toggleAttribute('turn', !!value)],
    mode: [() => this.#pilot.mode, (value) => this.#setMode(['fly', 'walk'].includes(value) ? value : 'orbit')],
    eyeHeight: [() => this.#numberOf('eye-height'), (value) => this.#setAttribute('eye-height', value || null)],
    speed: [() => this.#pilot.speed, (value) => (this.#pilot.speed = Number(value))],
    fov: [() => this.#pilot.camera?.fov ?? this.#pilot.fov, (value) => this.#pilot.widen(Number(value))],
    flat: [() => !!this.#pilot.camera?.flat, (value) => this.#pilot.flatten(!!value)],
    up: [() => [...this.#pilot.up], (value) => this.#pilot.upright(value ? [...value] : undefined)],
    sharpness: [() => this.#settings.sharpness, (value) => (this.#settings.sharpness = Number(value))],
    colours: [() => this.#settings.colours, (value) => (this.#settings.colours = !!value)],
    tone: [
      () => this.getAttribute('tone') || 'linear',
      (value) => this.#setAttribute('tone', value === 'linear' ? null : value),
    ],
    exposure: [
      () => Number(this.getAttribute('exposure')) || 0,
      (value) => this.#setAttribute('exposure', Number(value) || null),
    ],
    vignette: [
      () => Math.min(this.#numberOf('vignette'), 1),
      (value) => this.#setAttribute('vignette', Number(value) || null),
    ],
    enlarge: [() => this.#settings.enlarge, (value) => (this.#settings.enlarge = Number(value) || 1)],
    readout: [() => !this.#ui.readout.hidden, (value) => (this.#ui.readout.hidden = !value)],
  }

  #set({ name, type, value, checked }) {
    if (name === 'budget') return this.#setBudget(Number(value))
    if (name === 'eyeHeight') value = this.#pilot.walker.usual * 2 ** value
    const up = name === 'up' && value ? value.split(',').map(Number) : null
    this.#table[name][1](name === 'up' ? up : type === 'checkbox' ? checked : value)
    if (name === 'fov') this.#showSettings()
    this.#change()
  }

  #listen() {
    const ui = this.#ui
    const acts = (this.#acts = this.#pilot.acts({
      focus: (x, y) => this.#focus(x, y),
      click: (x, y) => this.#click(x, y),
      press: (key) => this.#press(key),
      takesWheel: (event) => this.#takesWheel(event),
    }))
    ui.stage.addEventListener('pointerdown', ({ pointerType }) => {
      if (pointerType !== 'touch' || this.#touches) return
      this.#touches = true
      this.#showStick()
    })
    const held = listenToKeys(this, acts)
    listenToPointers(ui.stage, acts, () => held.has('Space'))
    const clicks = {
      choose: 'o',
      add: 'o',
      before: 'p',
      after: 'n',
      orbit: '1',
      fly: '2',
      walk: '3',
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
    ui.edit.onclick = () => this.#edit().catch((error) => this.#fail(error))
    ui.set.onclick = () => this.#toggle(ui.options)
    for (const id of ['closeHelp', 'closeOptions']) ui[id].onclick = () => this.#toggle(null)
    ui.file.onchange = () => this.#openFiles([...ui.file.files]).then(() => (ui.file.value = ''))
    ui.options.oninput = (event) => this.#set(event.target)
    this.#listenToDrops()
  }

  #takesWheel({ ctrlKey, timeStamp }) {
    if (this.getAttribute('wheel') !== 'page' || ctrlKey || this.matches(':focus-within')) return true
    if (timeStamp - this.#hintedAt > HINT_MS) this.#panels.note('Click the scene, or hold Ctrl, and the wheel zooms')
    this.#hintedAt = timeStamp
    return false
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
      // items and files are read now, because the browser empties dataTransfer after the event
      const { items, files } = event.dataTransfer
      this.#takeDrop([...items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean), [...files])
    })
  }
}

export { PlacedScene }
if (!customElements.get('fixsplat-viewer')) customElements.define('fixsplat-viewer', Viewer)
