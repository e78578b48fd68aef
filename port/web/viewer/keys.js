// The panel of a camera track's keys: moves keys in time, removes keys, and states the command that renders the film.
import { button, panel } from './body.js'
import { REMOVE } from './markers.js'

const EYE = 'M3 12c3-6 15-6 18 0-3 6-15 6-18 0zM12 9.5a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5z'

const inside = `
<ol id="keyList"></ol>
<textarea id="command" rows="3" readonly translate="no" aria-label="The same film by the command"></textarea>
<p class="making"><button id="saveTrack" type="button">Save settings, copy the command</button></p>`

export class Keys {
  #host
  #acts
  #ui = {}

  constructor(host, acts) {
    this.#host = host
    this.#acts = acts
    host.ui.options.insertAdjacentHTML('beforebegin', panel('trackKeys', 'Keys of the track', 'closeTrackKeys', inside))
    for (const element of [...host.root.querySelectorAll('#trackKeys, #trackKeys [id]')]) this.#ui[element.id] = element
    this.#ui.closeTrackKeys.onclick = () => this.toggle()
    this.#ui.saveTrack.onclick = () => acts.save(this.#ui.command.value)
    host.language.write(this.#ui.trackKeys)
  }

  toggle(opens = this.#ui.trackKeys.hidden) {
    const { trackKeys, closeTrackKeys } = this.#ui
    if (opens !== trackKeys.hidden) return
    trackKeys.hidden = !opens
    ;(opens ? closeTrackKeys : this.#host.ui.stage).focus({ focusVisible: false })
  }

  /** Shows the keys of a track, and the command of its film. The field of the key `index` gets the focus. */
  show(track, command, index = -1) {
    const { keyList } = this.#ui
    if (!track) return this.toggle(false)
    this.#ui.command.value = command
    keyList.replaceChildren(...track.keys.map((key, i) => this.#row(key, i)))
    keyList.querySelectorAll('input')[Math.min(index, track.keys.length - 1)]?.focus()
  }

  #row({ time }, i) {
    const name = (words) => this.#host.language.of(words, i + 1)
    const row = document.createElement('li')
    row.innerHTML = `${button(`show${i}`, name('Show key {0}'), EYE)}
      <input type="number" min="0" max="86400" step="any" value="${+time.toFixed(3)}"
        aria-label="${name('Time of key {0} in seconds')}"> s
      ${button(`remove${i}`, name('Remove key {0}'), REMOVE)}`
    const [show, remove] = row.querySelectorAll('button')
    const field = row.querySelector('input')
    show.onclick = () => this.#acts.seek(time)
    field.onchange = () => this.#acts.move(i, field.valueAsNumber)
    remove.onclick = () => this.#acts.remove(i)
    return row
  }
}
