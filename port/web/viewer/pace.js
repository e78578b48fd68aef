// Chooses the size of pictures while the camera moves, by the clock fxs_pace. A picture takes at most AIM_MS milliseconds,
// or WORTH times the time of the smallest picture.
const AIM_MS = 40
const WORTH = 1.3
const LEAST = 1 / 4 // smallest width of a moving picture, as a share of the full width
const LOAD = 0.85 // share of a frame that the clock fills: pace.h
const MOST_MS = 2000 // longest frame of the clock

export class Sizes {
  #clock
  #aim = AIM_MS
  #last = 0 // scale at the end of the last motion

  constructor(clock) {
    this.#clock = clock
  }

  /** Takes the time of a picture. Returns the width of the next moving picture as a share of the full width. The clock
      begins anew with each picture at rest, at the size that its time suggests or that the last motion had. */
  take(moves, milliseconds) {
    const clock = this.#clock
    const guess = Math.min(1, Math.max(LEAST, Math.sqrt((LOAD * AIM_MS) / milliseconds)))
    if (moves) {
      clock.step(milliseconds)
      this.#last = clock.scale
      if (clock.isTooSlow) this.#begin(Math.min(Math.max(this.#aim, (WORTH * milliseconds) / LOAD), MOST_MS), LEAST)
    } else this.#begin(guess === 1 ? AIM_MS : this.#aim, Math.max(guess, this.#last))
    return clock.scale
  }

  #begin(milliseconds, scale) {
    this.#aim = milliseconds
    this.#clock.begin({ milliseconds, least: LEAST, scale })
  }
}
