// Chooses the size of pictures while the camera moves. The largest size is taken that is drawn in AIM_MS milliseconds,
// or in WORTH times the time of the smallest size.

const AIM_MS = 40 // drawing time in milliseconds to aim at for a picture while the camera moves
const WORTH = 1.3 // largest accepted drawing time, as a multiple of the drawing time of the smallest picture
// hysteresis: ratio of the drawing time for shrinking pictures to the drawing time for growing pictures
const MARGIN = 1.3
const DIVISORS = [1, 1.5, 2, 3, 4]
const KEPT = 7 // number of recent pictures for the median of drawing times
const PROBES = 5
const PATIENCE = 12 // number of pictures of one size before the size may grow
const FORGOTTEN = 100

const LAST = DIVISORS.length - 1
const STEPS = [...DIVISORS.keys()]
const share = (step) => 1 / DIVISORS[step] ** 2
const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1]

export class Pace {
  #step = 0
  #times = STEPS.map(() => 0) // drawing time in milliseconds for each divisor of the picture size; 0: unknown
  #recent = []
  #count = 0

  get divisor() {
    return DIVISORS[this.#step]
  }

  take(divisor, milliseconds) {
    const step = DIVISORS.indexOf(divisor)
    if (step === this.#step) this.#measure(milliseconds)
    else if (step === 0) this.#times[0] = (this.#times[0] + milliseconds) / (this.#times[0] ? 2 : 1)
    this.#choose()
  }

  #measure(milliseconds) {
    this.#recent = [...this.#recent, milliseconds].slice(-KEPT)
    const [time, before] = [median(this.#recent), this.#times[this.#step]]
    if (++this.#count > KEPT) this.#times = this.#times.map((other) => (other * time) / before)
    if (this.#count % FORGOTTEN === 0) this.#times = this.#times.map((other, i) => (i % LAST ? 0 : other))
    this.#times[this.#step] = time
  }

  #timeAt(step) {
    if (this.#times[step]) return this.#times[step]
    const finer = STEPS.findLast((one) => one < step && this.#times[one])
    const coarser = STEPS.find((one) => one > step && this.#times[one])
    const part = (share(step) - share(coarser)) / (share(finer) - share(coarser))
    return this.#times[coarser] + part * (this.#times[finer] - this.#times[coarser])
  }

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
