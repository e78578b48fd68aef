// Chooses how large pictures are while the camera moves, from the time that pictures of each size have taken.

const AIM_MS = 40 // of a picture in motion
const WORTH = 1.3 // so many times as long as the smallest picture may others take: smaller ones would gain little
const MARGIN = 1.3 // between the time at which pictures become larger, and that at which they become smaller
const DIVISORS = [1, 1.5, 2, 3, 4] // of width and height
const KEPT = 7 // pictures, whose median counts
const PROBES = 5 // smallest pictures, when the camera moves for the first time
const PATIENCE = 12 // pictures until they become larger
const FORGOTTEN = 100 // pictures until what was measured at other sizes is out of date

const LAST = DIVISORS.length - 1
const STEPS = [...DIVISORS.keys()]
const share = (step) => 1 / DIVISORS[step] ** 2 // of the whole picture's pixels
const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1]

export class Pace {
  #step = 0 // of DIVISORS
  #times = STEPS.map(() => 0) // milliseconds of a picture at each step; 0 where that is not known
  #recent = [] // the last pictures at this step
  #count = 0 // and how many there were

  /** Of width and height, in motion. */
  get divisor() {
    return DIVISORS[this.#step]
  }

  /** A picture took so long. */
  take(divisor, milliseconds) {
    const step = DIVISORS.indexOf(divisor)
    if (step === this.#step) this.#measure(milliseconds)
    else if (step === 0) this.#times[0] = (this.#times[0] + milliseconds) / (this.#times[0] ? 2 : 1) // at rest
    this.#choose()
  }

  /** What changes at one size has changed for all: the machine is busier, or the scene nearer. The first pictures tell
      of the size itself. */
  #measure(milliseconds) {
    this.#recent = [...this.#recent, milliseconds].slice(-KEPT)
    const [time, before] = [median(this.#recent), this.#times[this.#step]]
    if (++this.#count > KEPT) this.#times = this.#times.map((other) => (other * time) / before)
    if (this.#count % FORGOTTEN === 0) this.#times = this.#times.map((other, i) => (i % LAST ? 0 : other))
    this.#times[this.#step] = time
  }

  /** What a picture at a step takes: measured, or on the line over pixels through the nearest that are. */
  #timeAt(step) {
    if (this.#times[step]) return this.#times[step]
    const finer = STEPS.findLast((one) => one < step && this.#times[one])
    const coarser = STEPS.find((one) => one > step && this.#times[one])
    const part = (share(step) - share(coarser)) / (share(finer) - share(coarser))
    return this.#times[coarser] + part * (this.#times[finer] - this.#times[coarser])
  }

  /** The largest that takes AIM_MS, or little longer than the smallest. */
  #wanted() {
    if (!this.#times[LAST]) return this.#times[0] <= AIM_MS ? 0 : LAST
    if (this.#step === LAST && this.#count < PROBES) return LAST
    const limit = Math.max(AIM_MS, WORTH * this.#times[LAST])
    const fits = (step) => this.#timeAt(step) <= (step < this.#step ? limit : limit * MARGIN)
    return STEPS.find((step) => step === LAST || fits(step))
  }

  #choose() {
    const step = this.#wanted()
    const isSoon = this.#count < (this.#step === LAST ? PROBES : PATIENCE)
    if (step === this.#step || (step < this.#step && isSoon)) return
    this.#step = step
    this.#recent = []
    this.#count = 0
  }
}
