// Settings files, annotations, camera tracks and films of the viewer. The viewer loads this module on first use.
import { staysInside } from 'fixsplat/read.js'
import { Markers } from './markers.js'
import { Player } from './player.js'
import { MOST_SECONDS, listsOf, settingsOf, textOfSettings } from './settings.js'
import { rules } from './tour_style.js'
import { Track, upright } from './track.js'
import { addressOf, nameOf, textAt } from './views.js'

const KEY_S = 2 // seconds from the last key of a track to a key that the user adds
const FLIGHT_MS = 1000
const NEARER = 0.6
const LONGEST_S = 0.5 // longest time step of a playing track in seconds
const WAIT_MS = 100 // milliseconds until a frame of a film with missing parts of the scene is drawn again
const PATIENCE_MS = 30000 // longest wait of a film for missing parts of a streamed scene, in milliseconds
const GIVEN = ['background', 'skybox', 'budget', 'detail', 'turn', 'ar', 'tone', 'exposure', 'vignette']
const OWN = ['mode', 'speed', 'sharpness', 'colours', 'eyeHeight']

const pause = (ms) => new Promise((done) => setTimeout(done, ms))
/** Returns true if a picture is in the folder of the settings file or below, or has a data: address. */
const isOwn = (url) => /^data:/i.test(url.trim()) || staysInside(url.trim())
const reduced = () => matchMedia('(prefers-reduced-motion: reduce)').matches

export class Tour {
  #host
  #markers
  #player
  #keys = null
  #annotations = []
  #tracks = []
  #index = -1
  #edits = false
  #track = 0
  #made = null
  #seconds = 0
  #plays = false
  #last = null
  #filming = null
  #reading = null
  #given = []
  #home = null
  #start = null

  constructor(host) {
    this.#host = host
    const sheet = new CSSStyleSheet()
    sheet.replaceSync(rules)
    host.style(sheet)
    this.#markers = new Markers(host, {
      choose: (index) => (index === this.#index ? this.close() : this.goTo(index)),
      step: (by) => this.step(by),
      link: () => host.copy(host.linkTo(this.#index)),
      close: () => this.close(),
      change: (words) => this.#change(words),
      remove: () => this.#remove(),
    })
    this.#player = new Player(host, {
      toggle: () => this.toggle(),
      seek: (time) => this.seek(time),
      choose: (index) => this.choose(index),
      film: () => this.#saveFilm(),
      edit: () => this.#editKeys(),
    })
  }

  // ---- Settings files -----------------------------------------------------------------------------------------------

  async read(source) {
    const own = (this.#reading = {})
    const isAddress = typeof source === 'string'
    const name = isAddress ? nameOf(source) : (source.name ?? 'settings')
    const told = () => source.text?.() ?? JSON.stringify(source)
    const text = await Promise.resolve(isAddress ? textAt(source, 'there are no settings at this address') : told()).catch((error) => {
      if (own === this.#reading) throw error
    })
    if (own !== this.#reading) return []
    const { settings, words } = settingsOf(name, text)
    if ((isAddress || source.text) && !isOwn(settings.skybox ?? 'none')) {
      words.push(`${name}: skybox: leaves the folder of this file: left out`)
      delete settings.skybox
    }
    this.#take(settings, isAddress ? addressOf(source) : document.baseURI)
    return words
  }

  #take({ camera = null, annotations = [], tracks = [], start = null, ...attributes }, base) {
    const { element } = this.#host
    for (const name of this.#given) element.removeAttribute(name)
    if (attributes.skybox) attributes.skybox = new URL(attributes.skybox, base).href
    this.#given = GIVEN.filter((name) => attributes[name] && !element.hasAttribute(name))
    for (const name of this.#given) element.setAttribute(name, attributes[name] === true ? '' : attributes[name])
    const own = OWN.filter((name) => name in attributes)
    element.settings = Object.fromEntries(own.map((name) => [name, attributes[name]]))
    this.#home = camera
    this.#start = start
    this.annotations = annotations
    this.tracks = tracks
  }

  get home() {
    return this.#home && this.#cameraOf(this.#home)
  }

  begin() {
    const start = this.#start
    this.#start = null
    if (start === 'annotation' && this.#annotations.length) this.goTo(0)
    if (start === 'track' && this.#tracks.length && !reduced()) this.play()
  }

  get saved() {
    const { element, current } = this.#host
    const all = { ...element.settings, skybox: element.getAttribute('skybox') }
    const names = [...GIVEN.filter((name) => element.hasAttribute(name)), ...OWN]
    const { annotations, tracks } = this
    const values = Object.fromEntries(names.map((name) => [name, all[name]]))
    return { ...values, camera: this.#poseOf(current()), annotations, tracks }
  }

  get savedText() {
    return textOfSettings(this.saved)
  }

  #poseOf({ eye, look, up, fov }) {
    return { eye, look, up, fov }
  }

  #cameraOf(pose, aspect = this.#host.aspect()) {
    return { flat: false, shift: [0, 0], ...upright({ ...pose, up: pose.up ?? this.#host.up() }, aspect) }
  }

  // ---- Annotations --------------------------------------------------------------------------------------------------

  get annotations() {
    return structuredClone(this.#annotations)
  }
  set annotations(list) {
    this.#annotations = listsOf({ annotations: list }).annotations
    this.#edits = false
    this.close()
    this.#markers.show(this.#annotations)
  }

  get index() {
    return this.#index
  }

  async goTo(index, from = 0) {
    const [one, { length }] = [this.#annotations[index], this.#annotations]
    const range = length ? `, expected ${from} to ${from + length - 1}` : ''
    if (!one) throw new Error(`annotation ${index + from}: there are ${length}${range}`)
    this.pause()
    this.#keys?.toggle(false)
    this.#choose(index)
    const current = this.#host.current()
    if (!current) return false
    const { camera, position } = one
    const eye = position.map((x, i) => x + NEARER * (current.eye[i] - x))
    return this.#host.fly(camera ? this.#cameraOf(camera) : { ...current, eye, look: position }, FLIGHT_MS)
  }

  step(by) {
    const { length } = this.#annotations
    if (length) this.goTo(this.#index < 0 ? (by > 0 ? 0 : length - 1) : (this.#index + by + length) % length)
  }

  close() {
    if (this.#index >= 0) this.#choose(-1)
  }

  escape() {
    this.close()
    this.#keys?.toggle(false)
  }

  #choose(index) {
    this.#index = index
    this.#markers.choose(index, this.#edits)
    this.#host.tell('annotation', { index, annotation: this.annotations[index] ?? null })
  }

  mark(position) {
    this.#annotations.push({ position, title: '', text: '', camera: this.#poseOf(this.#host.current()) })
    this.#edits = true
    this.#markers.show(this.#annotations)
    this.#choose(this.#annotations.length - 1)
    this.#markers.write()
  }

  #change(words) {
    Object.assign(this.#annotations[this.#index], words)
    this.#markers.entitle(this.#index)
  }

  #remove() {
    this.#annotations.splice(this.#index, 1)
    this.close()
    this.#markers.show(this.#annotations)
  }

  // ---- Tracks -------------------------------------------------------------------------------------------------------

  get #path() {
    const [told, up] = [this.#tracks[this.#track], this.#host.up()]
    if (!told) return null
    if (this.#made?.told !== told || this.#made.up !== up) this.#made = { told, up, path: new Track(told, up) }
    return this.#made.path
  }

  get tracks() {
    return structuredClone(this.#tracks)
  }
  set tracks(list) {
    this.#tracks = listsOf({ tracks: list }).tracks
    this.choose(0)
  }

  choose(index) {
    this.pause()
    this.#track = index
    this.#seconds = 0
    this.#player.show(this.#tracks, index)
    this.#showKeys()
    this.#tell()
  }

  addKey() {
    const keys = this.#tracks[this.#track]?.keys ?? []
    const time = keys.length ? keys.at(-1).time + KEY_S : 0
    this.#setKeys([...keys, { time, ...this.#poseOf(this.#host.current()) }])
    return keys.length + 1
  }

  /** Gives the chosen track other keys. The track still ends with its last key, if it did. A track without keys is
      removed. */
  #setKeys(keys) {
    const index = this.#track
    const track = this.#tracks[index] ?? { name: '', loop: 'none', smoothness: 1, step: false, keys: [], duration: 0 }
    const end = (list) => list.at(-1)?.time || 1
    const duration = track.duration > end(track.keys) ? Math.max(track.duration, end(keys)) : end(keys)
    const tracks = [...this.#tracks]
    tracks.splice(index, 1, ...(keys.length ? [{ ...track, keys, duration }] : []))
    this.tracks = tracks
    if (tracks[index]) this.choose(index)
  }

  #moveKey(i, time) {
    const { keys } = this.#tracks[this.#track]
    const [key, others] = [{ ...keys[i], time }, keys.filter((one) => one !== keys[i])]
    const isFree = others.every((one) => one.time !== time)
    if (!isFree) this.#host.note('Another key has this time')
    const moved = [...others, key].sort((a, b) => a.time - b.time)
    if (isFree && time >= 0 && time <= MOST_SECONDS) this.#setKeys(moved)
    this.#showKeys(moved.indexOf(key))
  }

  async #editKeys() {
    const { Keys } = await import('./keys.js')
    this.#keys ??= new Keys(this.#host, {
      seek: (time) => this.seek(time),
      move: (i, time) => this.#moveKey(i, time),
      remove: (i) => {
        this.#setKeys(this.#tracks[this.#track].keys.filter((_, k) => k !== i))
        this.#showKeys(i)
      },
      save: (command) => this.#host.saveTrack(command),
    })
    this.close()
    this.#showKeys()
    this.#keys.toggle()
  }

  #showKeys(index) {
    this.#keys?.show(this.#tracks[this.#track], this.#command, index)
  }

  /** The command that renders the film of the chosen track, from the settings file that the page saves. */
  get #command() {
    const { scene, size, element } = this.#host
    const [width, height] = ['width', 'height'].map((name) => Math.max(2 * Math.round(size()[name] / 2), 2))
    const file = `'${scene().replaceAll("'", "'\\''")}'`
    const track = this.#track ? ` --track ${this.#track}` : ''
    const how = `--fps 30 --size ${width}x${height} --bg ${element.settings.background.slice(1)}`
    return `fixsplat render ${file} --path settings.json${track} ${how} -o film.mp4`
  }

  get duration() {
    return this.#path?.duration ?? 0
  }
  get time() {
    return this.#path?.timeAt(this.#seconds) ?? 0
  }
  get paused() {
    return !this.#plays
  }

  #tell() {
    this.#player.tell(this.time, this.duration, this.#plays)
  }

  #show() {
    this.#last = this.#cameraOf(this.#path.at(this.time))
    this.#host.show(this.#last)
    this.#tell()
    this.#host.tell('timeupdate', { time: this.time, track: this.#track })
  }

  play(index = this.#track) {
    if (!this.#tracks[index]) throw new Error(`track ${index}: there are ${this.#tracks.length}`)
    if (index !== this.#track) this.choose(index)
    if (this.#plays || this.#filming) return
    if (this.#path.ends && this.#seconds >= this.duration) this.#seconds = 0
    this.#plays = true
    this.close()
    this.#show()
    this.#host.tell('play', { track: index })
    let before = performance.now()
    const step = (now) => {
      if (!this.#plays) return
      if (this.#host.current() !== this.#last) return this.pause()
      this.#seconds += Math.min((now - before) / 1000, LONGEST_S)
      before = now
      this.#show()
      if (this.#path.ends && this.#seconds >= this.duration) this.#end()
      else requestAnimationFrame(step)
    }
    requestAnimationFrame(step)
  }

  #end() {
    this.pause()
    this.#host.tell('ended', { track: this.#track })
  }

  pause() {
    if (!this.#plays) return
    this.#plays = false
    this.#tell()
    this.#host.tell('pause', { track: this.#track })
  }

  toggle() {
    if (!this.#path) return
    if (this.#plays) this.pause()
    else this.play()
  }

  seek(seconds) {
    if (!this.#path || !(seconds >= 0)) return
    this.pause()
    this.#seconds = Math.min(seconds, this.duration)
    this.#last = null
    this.#show()
  }

  // ---- Films --------------------------------------------------------------------------------------------------------

  async film({ track = this.#track, rate, bitrate, progress = () => {}, ...size } = {}) {
    const told = this.#tracks[track]
    if (!told) throw new Error(`track ${track}: there are ${this.#tracks.length}`)
    const path = new Track(told, this.#host.up())
    const { width, height } = { ...this.#host.size(), ...size }
    const seconds = path.duration * (path.loop === 'pingpong' ? 2 : 1)
    const { filmOf } = await import('./film.js')
    const draw = (at, w, h) => this.#whole(this.#cameraOf(path.at(path.timeAt(at)), w / h), w, h, at)
    return filmOf({ width, height, rate, bitrate, seconds }, draw, progress)
  }

  async #whole(camera, ...frame) {
    const until = performance.now() + PATIENCE_MS
    for (;;) {
      const { pixels, missing } = await this.#host.draw(camera, ...frame)
      if (!missing) return pixels
      if (performance.now() > until) throw new Error('Parts of the scene do not come: there is no film')
      await pause(WAIT_MS)
    }
  }

  async #saveFilm() {
    const host = this.#host
    if (this.#filming) return (this.#filming.stopped = true)
    this.pause()
    const filming = (this.#filming = { stopped: false })
    const progress = (share) => {
      if (filming.stopped) throw filming
      this.#player.filming(share)
    }
    try {
      const { blob, codec, frames, width, height } = await this.film({ progress })
      host.save(blob, `${this.#tracks[this.#track].name || 'film'}.webm`)
      const words = 'Film saved: {0} frames of {1}, by {2}, which changes their bytes: what went in is exact'
      host.note(words, frames, `${width} × ${height}`, codec)
    } catch (error) {
      if (error === filming) host.note('The film was stopped')
      else host.say(error)
    }
    this.#filming = null
    this.#player.filming(null)
    this.#tell()
  }

  drawn() {
    this.#markers.place()
  }

  rename() {
    this.#markers.name()
    this.#player.show(this.#tracks, this.#track)
    this.#showKeys()
    this.#tell()
  }
}
