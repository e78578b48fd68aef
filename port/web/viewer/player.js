// The bar of controls for camera tracks: play and pause, a slider, a choice of the track, and a button that makes a
// film.
import { button } from './body.js'

export const PLAY = 'M7 4.5v15l12-7.5z'
const PAUSE = 'M8 5v14M16 5v14'
const KEYS = 'M3 12h18M7 9l3 3-3 3-3-3zM17 9l3 3-3 3-3-3z'
const FILM = 'M4 5h16v14H4zM8 5v14M16 5v14M4 9.5h4M4 14.5h4M16 9.5h4M16 14.5h4'

/** Gives a button another name and icon. */
export function showAs(button, words, path) {
  if (button.title === words) return
  for (const name of ['title', 'aria-label']) button.setAttribute(name, words)
  button.querySelector('path').setAttribute('d', path)
}

/** Changes a button for play to one for pause, or back. */
export function showPlays(play, plays, language) {
  showAs(play, language.of(plays ? 'Pause (K)' : 'Play (K)'), plays ? PAUSE : PLAY)
}

export class Player {
  #host
  #ui = {}

  constructor(host, acts) {
    this.#host = host
    const bar = document.createElement('div')
    Object.assign(bar, { id: 'player', className: 'ui bar', hidden: true })
    bar.setAttribute('role', 'group')
    bar.setAttribute('aria-label', 'Camera track')
    bar.innerHTML = `${button('play', 'Play (K)', PLAY)}
      <select id="track" aria-label="Track" translate="no" hidden></select>
      <input id="time" type="range" min="0" step="any" aria-label="Time"><output id="clock" aria-live="off" translate="no"></output>
      ${button('film', 'Save a film', FILM)}${button('editKeys', 'Keys of the track', KEYS)}`
    host.ui.note.before(bar)
    for (const element of bar.querySelectorAll('[id]')) this.#ui[element.id] = element
    const ui = (this.#ui = { ...this.#ui, bar })
    ui.play.onclick = () => acts.toggle()
    ui.time.oninput = () => acts.seek(Number(ui.time.value))
    ui.time.onkeydown = ({ key }) => {
      if (key.toLowerCase() === 'k') acts.toggle()
    }
    ui.track.onchange = () => acts.choose(Number(ui.track.value))
    ui.film.onclick = () => acts.film()
    ui.editKeys.onclick = () => acts.edit()
    host.language.write(bar)
  }

  show(tracks, index) {
    const { bar, track, time } = this.#ui
    const { language } = this.#host
    bar.hidden = !tracks.length
    if (!tracks.length) return
    const options = tracks.map(({ name }, i) => new Option(name || language.of('Track {0}', i + 1), i))
    track.replaceChildren(...options)
    track.hidden = tracks.length < 2
    track.value = index
    time.max = tracks[index].duration
  }

  tell(time, duration, plays) {
    const { time: slider, clock, play } = this.#ui
    slider.value = time
    slider.setAttribute('aria-valuetext', `${time.toFixed(1)} s / ${duration.toFixed(1)} s`)
    clock.textContent = `${time.toFixed(1)} / ${duration.toFixed(1)} s`
    showPlays(play, plays, this.#host.language)
  }

  filming(share) {
    const { film, clock, time, play, track } = this.#ui
    const words = this.#host.language.of(share === null ? 'Save a film' : 'Stop the film')
    film.setAttribute('aria-pressed', share !== null)
    for (const name of ['title', 'aria-label']) film.setAttribute(name, words)
    for (const one of [time, play, track]) one.disabled = share !== null
    if (share !== null) clock.textContent = `${Math.floor(100 * share)} %`
  }
}
