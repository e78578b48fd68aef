// The player of moving scenes: the clock that chooses the time of each picture, and its bar of controls. The viewer
// loads this module with the first moving scene.
import { button } from './body.js'
import { PLAY, showPlays } from './player.js'

const BACK = 'M18 5l-9 7 9 7zM6 5v14'
const ON = 'M6 5l9 7-9 7zM18 5v14'
const LOOP = 'M17 2l4 4-4 4M21 6H7a4 4 0 0 0-4 4v1M7 22l-4-4 4-4M3 18h14a4 4 0 0 0 4-4v-1'
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4]
const USUAL_RATE = 30 // frames a second by which a scene without frames of its own is stepped
const WITHIN = 1 / 256 // share of a frame behind its first moment, so that rounded times do not show the frame before
const ROUNDED = 1 / 64 // share of a frame that a duration may be too long
const MOST_SPEED = 100
const LONGEST_S = 0.5 // longest time step of a playing scene in seconds
const AHEAD_S = 2 // seconds of play whose parts are requested before they are needed

const rules = `
#mover { --bar: 60px; bottom: calc(8px + var(--bar) + var(--below, 0px)); width: min(480px, calc(100% - 12px));
  align-items: center; }
#mover input { flex: 1; min-width: 50px; }
#mover select { height: 30px; border: 0; background: transparent; }
#mover output { min-width: 92px; text-align: center; color: var(--quiet); font-size: 13px; white-space: nowrap;
  font-variant-numeric: tabular-nums; }
#player:not([hidden]) ~ #mover { bottom: calc(56px + var(--bar) + var(--below, 0px)); }
:host(:not([ui])) #note:has(~ #mover:not([hidden])) { bottom: calc(126px + var(--below, 0px)); }
:host(:not([ui])) #player:not([hidden]) ~ #note:has(~ #mover:not([hidden])) { bottom: calc(174px + var(--below, 0px)); }
:host([ui]) #mover { --bar: 6px; }
#mover:not([hidden]) ~ section.panel { --lift: calc(122px + var(--below, 0px)); bottom: var(--lift);
  max-height: calc(100% - 18px - var(--lift)); }
#player:not([hidden]) ~ #mover:not([hidden]) ~ section.panel { --lift: calc(170px + var(--below, 0px)); }
@container (max-width: 400px) {
  #mover { --bar: 44px; }
  #mover button { min-width: 30px; }
  #mover output { min-width: 76px; }
  #mover:not([hidden]) ~ section.panel { bottom: calc(6px + var(--below, 0px)); max-height: calc(100% - 12px); }
}
@container (max-width: 340px) {
  #mover output { display: none; }
}
`

export class Moving {
  #host
  #ui = {}
  #motion = null // { duration, rate, loops } of the scene
  #time = 0
  #plays = false
  #before = 0 // when the time was read last, in milliseconds
  #waits = false // true if the last picture lacked parts of the scene; the time then stands still
  #begun = false
  #frame = null // number of the frame that was asked for last
  #source = null // of the sound
  sound = null

  constructor(host) {
    this.#host = host
    const sheet = new CSSStyleSheet()
    sheet.replaceSync(rules)
    host.style(sheet)
    const bar = document.createElement('div')
    Object.assign(bar, { id: 'mover', className: 'ui bar', hidden: true })
    bar.setAttribute('role', 'group')
    bar.setAttribute('aria-label', 'Moving scene')
    const speeds = SPEEDS.map((speed) => `<option value="${speed}">× ${speed}</option>`)
    bar.innerHTML = `${button('run', 'Play (K)', PLAY)}${button('back', 'Frame back (,)', BACK)}
      <input id="moment" type="range" min="0" step="any" aria-label="Time">${button('on', 'Frame on (.)', ON)}
      <output id="seconds" aria-live="off" translate="no"></output>
      <select id="pace" aria-label="Speed of the scene" translate="no">${speeds.join('')}</select>
      ${button('again', 'Again and again', LOOP)}`
    host.ui.note.after(bar)
    for (const element of bar.querySelectorAll('[id]')) this.#ui[element.id] = element
    this.#ui.bar = bar
    this.#listen()
    host.language.write(bar)
  }

  #listen() {
    const { run, back, on, moment, pace, again } = this.#ui
    run.onclick = () => this.toggle()
    back.onclick = () => this.step(-1)
    on.onclick = () => this.step(1)
    moment.oninput = () => this.seek(Number(moment.value))
    moment.onkeydown = ({ key }) => this.#host.press(key)
    pace.onchange = () => this.#host.element.setAttribute('speed', pace.value)
    again.onclick = () => this.repeat()
  }

  // ---- Scenes -------------------------------------------------------------------------------------------------------

  /** Takes the motion of the scene; null: the scene is still. `sound` is an address, or the sound in its file. */
  take(motion, sound = null) {
    this.#motion = motion
    this.#ui.bar.hidden = !motion
    this.#hear(motion && sound)
    if (!motion) return this.pause()
    this.#time = this.#within(this.#time)
    this.#ui.moment.max = motion.duration
    this.changed()
  }

  async #hear(source) {
    if (source === this.#source) return
    this.#source = source
    this.sound?.end()
    this.sound = null
    const { Sound } = source ? await import('./sound.js') : {}
    if (source && source === this.#source) this.sound = new Sound(this.#host, this.#ui.bar, source)
    this.#follow()
  }

  #follow() {
    this.sound?.follow(this.#time, this.runs, this.speed)
  }

  /** Begins anew for another scene. */
  reset() {
    this.pause()
    this.#begun = this.#waits = false
    this.#time = Math.max(Number(this.#host.element.getAttribute('time')), 0) || 0
  }

  /** Starts a scene once, when its first picture is complete. */
  begin() {
    if (!this.#motion || this.#begun) return
    this.#begun = true
    const isStill = matchMedia('(prefers-reduced-motion: reduce)').matches
    const asked = this.#host.element.getAttribute('playing')
    if (asked === null ? !isStill : asked !== 'false') this.play()
  }

  /** Shows an attribute of the element that has changed. */
  changed() {
    const { pace, again } = this.#ui
    const { speed } = this
    if (![...pace.options].some(({ value }) => Number(value) === speed)) pace.add(new Option(`× ${speed}`, speed))
    pace.value = speed
    again.setAttribute('aria-pressed', this.loop)
    this.#show()
  }

  // ---- Clock --------------------------------------------------------------------------------------------------------

  get duration() {
    return this.#motion?.duration ?? 0
  }

  get speed() {
    const speed = Number(this.#host.element.getAttribute('speed'))
    return speed > 0 && speed <= MOST_SPEED ? speed : 1
  }

  get loop() {
    const asked = this.#host.element.getAttribute('loop')
    return asked === null ? !!this.#motion?.loops : asked !== 'none'
  }

  get playing() {
    return this.#plays
  }

  /** True while the time of a playing scene goes on. */
  get runs() {
    return this.#plays && !this.#waits
  }

  get time() {
    this.#advance()
    return this.#time
  }

  /** The seconds of play, from the time of the next picture on, whose parts are requested early. */
  get ahead() {
    return AHEAD_S * Math.max(this.speed, 1)
  }

  #within(time) {
    const { duration } = this
    if (!duration) return 0
    if (time < duration) return Math.max(time, 0)
    return this.loop ? time % duration : duration
  }

  /** Returns the time of the scene in a film that starts at the scene's start. */
  timeAt(seconds) {
    return this.#within(seconds + this.#later)
  }

  /** The seconds from the first moment of a frame to the moment that shows it. */
  get #later() {
    return this.#motion?.rate ? WITHIN / this.#motion.rate : 0
  }

  #advance() {
    const now = performance.now()
    const seconds = Math.min((now - this.#before) / 1000, LONGEST_S)
    this.#before = now
    if (this.runs) this.#time = this.#within(this.#time + seconds * this.speed)
    this.#follow()
  }

  /** Takes the number of parts of the scene that a picture lacked. */
  drawn(missing) {
    this.#advance()
    this.#waits = missing > 0
  }

  play() {
    if (!this.#motion || this.#plays) return
    if (!this.loop && this.#time >= this.duration) this.#time = 0
    this.#plays = this.#begun = true
    this.#before = performance.now()
    this.#host.tell('play', { track: null })
    this.#show()
    const step = () => {
      if (!this.#plays) return
      this.#tick()
      if (!this.loop && this.#time >= this.duration) this.#end()
      else requestAnimationFrame(step)
    }
    requestAnimationFrame(step)
  }

  /** Asks for a picture, unless the frame is still the same. */
  #tick() {
    const { rate } = this.#motion
    this.#advance()
    const frame = rate ? Math.floor(this.#time * rate) : this.#time
    if (frame === this.#frame) return
    this.#frame = frame
    this.#update()
  }

  #update() {
    this.#show()
    this.#host.change()
    this.#host.tell('timeupdate', { time: this.#time, track: null })
  }

  #end() {
    this.pause()
    this.#host.tell('ended', { track: null })
  }

  pause() {
    if (!this.#plays) return
    this.#advance()
    this.#plays = false
    this.#frame = null
    this.#show()
    this.#host.change()
    this.#host.tell('pause', { track: null })
  }

  /** Multiplies the speed. */
  hurry(times) {
    if (this.#motion) this.#host.element.setAttribute('speed', Math.min(this.speed * times, MOST_SPEED))
  }

  /** Changes between once, and again and again. */
  repeat() {
    if (this.#motion) this.#host.element.setAttribute('loop', this.loop ? 'none' : '')
  }

  toggle() {
    if (this.#plays) this.pause()
    else this.play()
  }

  /** Shows a time in seconds. A playing scene plays on from there. */
  seek(seconds) {
    if (!(seconds >= 0)) return
    this.#advance()
    this.#time = this.#motion ? this.#within(seconds) : seconds
    this.#waits = false
    this.#update()
  }

  step(frames) {
    if (!this.#motion) return
    this.pause()
    const rate = this.#motion.rate || USUAL_RATE
    const frame = Math.floor(this.#time * rate + ROUNDED) + frames
    const count = Math.max(Math.ceil(this.duration * rate - ROUNDED), 1)
    const wrapped = this.loop ? (frame + count) % count : Math.min(Math.max(frame, 0), count - 1)
    this.seek(wrapped / rate + this.#later)
  }

  #show() {
    const { run, moment, seconds } = this.#ui
    const [time, duration] = [this.#time, this.duration].map((n) => n.toFixed(n < 60 ? 2 : 1))
    moment.value = this.#time
    moment.setAttribute('aria-valuetext', `${time} s / ${duration} s`)
    seconds.textContent = `${time} / ${duration} s`
    showPlays(run, this.#plays, this.#host.language)
    this.#follow()
  }

  rename() {
    this.#host.language.write(this.#ui.bar)
    this.#show()
  }
}
