// The sound of a moving scene: it follows the scene's time, and has a button in the scene's bar. The player of moving
// scenes loads this module with the first sound.
import { button } from './body.js'
import { showAs } from './player.js'
import { addressOf, nameOf } from './views.js'

const CONE = 'M4 9.5v5h4l5 4v-13l-5 4z'
const LOUD = `${CONE}M16 9a4.5 4.5 0 0 1 0 6M18.5 6.5a8 8 0 0 1 0 11`
const SILENT = `${CONE}M16.5 9.5l5 5M21.5 9.5l-5 5`
const APART_S = 0.1 // largest difference in seconds, by the clock, between the times of the sound and of the scene
const PAUSED_S = 0.01 // the same in a paused scene
const [SLOWEST, FASTEST] = [1 / 16, 16] // range of speeds at which browsers play sound

export class Sound {
  #host
  #name
  #audio = new Audio()
  #button
  #own // volume in the scene's file
  #told = '' // muted and volume
  #isAsked = false // true until the browser answers a request to play
  #hasEnded = false

  /** Loads a sound: an address, or a sound of the package fixsplat. */
  constructor(host, bar, source) {
    this.#host = host
    this.#name = typeof source === 'object' || /^data:/i.test(source) ? 'sound' : nameOf(source)
    this.#own = source.volume
    bar.insertAdjacentHTML('beforeend', button('mute', '', LOUD))
    this.#button = bar.lastElementChild
    this.#button.onclick = () => this.toggle()
    bar.append(this.#audio)
    this.#audio.onerror = () => this.#fail(new Error(`${this.#name}: this browser does not play this sound`))
    this.#load(source).catch((error) => this.#fail(error))
  }

  async #load(source) {
    if (source.failure) throw new Error(source.failure)
    const blob = source.bytes ? new Blob([source.bytes], { type: source.type }) : await this.#fetch(source)
    if (!this.#hasEnded) this.#audio.src = URL.createObjectURL(blob)
  }

  /** Fetches the whole sound, since not all servers answer the requests for parts that a browser seeks with. */
  async #fetch(url) {
    const answer = await fetch(addressOf(url)).catch(() => ({}))
    if (!answer.ok) throw new Error(`${this.#name}: there is no sound at this address`)
    return answer.blob()
  }

  #fail(error) {
    if (this.#hasEnded) return
    this.end()
    this.#host.say(error)
  }

  end() {
    this.#hasEnded = true
    this.#audio.pause()
    URL.revokeObjectURL(this.#audio.src)
    this.#audio.remove()
    this.#button.remove()
  }

  toggle() {
    this.#host.element.toggleAttribute('muted')
  }

  /** Shows the state of the attributes muted and volume. */
  #show() {
    const { element, language } = this.#host
    const volume = Number(element.getAttribute('volume') ?? this.#own ?? 1)
    const [audio, { muted }] = [this.#audio, element]
    showAs(this.#button, language.of(muted ? 'Sound on (M)' : 'Sound off (M)'), muted ? SILENT : LOUD)
    audio.volume = volume >= 0 && volume <= 1 ? volume : 1
    const told = `${muted} ${volume}`
    if (this.#told && told !== this.#told) this.#host.tell('volumechange', { muted, volume: audio.volume })
    this.#told = told
  }

  /** Follows the scene, which shows a time in seconds. A muted sound is paused. */
  follow(time, runs, speed) {
    const [audio, { muted, isConnected }] = [this.#audio, this.#host.element]
    this.#show()
    if (muted || !audio.readyState) return audio.pause()
    const isHeard = runs && isConnected && !document.hidden && time < audio.duration
    const most = isHeard ? APART_S * Math.max(speed, 1) : PAUSED_S
    const to = Math.min(time, audio.duration)
    if (Math.abs(audio.currentTime - to) > most && !audio.seeking) audio.currentTime = to
    if (speed < SLOWEST || speed > FASTEST || !isHeard) return audio.pause()
    if (audio.playbackRate !== speed) audio.playbackRate = speed
    if (audio.paused && !this.#isAsked) this.#play()
  }

  /** Plays. If the browser refuses sound before the user has touched the page, the sound starts muted. */
  #play() {
    this.#isAsked = true
    this.#audio.play().catch(({ name }) => {
      if (name === 'NotAllowedError') this.#host.element.muted = true
    }).finally(() => (this.#isAsked = false))
  }
}
