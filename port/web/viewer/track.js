// Camera tracks: interpolates cameras between keys by cubic Hermite curves. A track is { name, loop, duration,
// smoothness, step, longer, keys }. A key is { time, eye, look, up, fov }. Times and durations are in seconds.

export const LOOPS = ['none', 'repeat', 'pingpong']

const flat = ({ eye, look, up, fov }) => [...eye, ...look, ...up, fov]

/** Returns the keys of a repeated track with two more keys before and two behind, which close the path. If the track
    does not end after its last key, the next round begins a second after that key, as in supersplat-viewer. */
function closed(keys, duration) {
  if (keys.length < 2) return keys
  const last = keys.at(-1).time
  const length = duration > last ? duration : last + 1
  const later = (key, by) => ({ ...key, time: key.time + by })
  const [before, behind] = [keys.slice(-2), keys.slice(0, 2)]
  return [...before.map((key) => later(key, -length)), ...keys, ...behind.map((key) => later(key, length))]
}

function segmentAt(keys, time) {
  let [low, high] = [0, keys.length - 2]
  while (low < high) {
    const middle = (low + high + 1) >> 1
    if (keys[middle].time <= time) low = middle
    else high = middle - 1
  }
  return low
}

/** Returns the slope of a camera track at key i, for values p at times t: (p[i+1] - p[i-1]) / (t[i+1] - t[i-1]). */
function slopes(keys, i) {
  const [before, after] = [keys[Math.max(i - 1, 0)], keys[Math.min(i + 1, keys.length - 1)]]
  return after.values.map((x, k) => (x - before.values[k]) / (after.time - before.time))
}

function between(keys, i, t, smoothness) {
  const [a, b] = [keys[i], keys[i + 1]]
  const scale = smoothness * (b.time - a.time)
  const [out, into] = [slopes(keys, i), slopes(keys, i + 1)].map((slope) => slope.map((x) => scale * x))
  const [ss, tt] = [(1 - t) * (1 - t), t * t]
  const weights = [(1 + 2 * t) * ss, t * ss, (3 - 2 * t) * tt, (t - 1) * tt]
  return a.values.map((p, k) => weights[0] * p + weights[1] * out[k] + weights[2] * b.values[k] + weights[3] * into[k])
}

const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1))

export class Track {
  #keys

  constructor(track, up) {
    Object.assign(this, track)
    const keys = track.loop === 'repeat' ? closed(track.keys, track.duration) : track.keys
    this.#keys = keys.map((key) => ({ time: key.time, values: flat({ up, ...key }) }))
  }

  timeAt(seconds) {
    const { loop, duration } = this
    if (loop === 'repeat') return seconds % duration
    if (loop === 'none') return Math.min(seconds, duration)
    const there = seconds % (2 * duration)
    return there > duration ? 2 * duration - there : there
  }

  get ends() {
    return this.loop === 'none'
  }

  at(time) {
    const keys = this.#keys
    const i = keys.length > 1 ? segmentAt(keys, time) : 0
    const next = keys[i + 1]
    let { values } = keys[i]
    if (next && time >= next.time) values = next.values
    else if (next && time > keys[i].time && !this.step)
      values = between(keys, i, (time - keys[i].time) / (next.time - keys[i].time), this.smoothness)
    const [eye, look, up] = [0, 3, 6].map((at) => values.slice(at, at + 3))
    return { eye, look, up: unit(up), fov: values[9], longer: this.longer }
  }
}

export function upright({ longer, ...camera }, aspect) {
  const tan = Math.tan((camera.fov * Math.PI) / 360)
  return longer && aspect > 1 ? { ...camera, fov: (360 / Math.PI) * Math.atan(tan / aspect) } : camera
}
