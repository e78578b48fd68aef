// Gamepads with the standard mapping (w3.org/TR/gamepad). A gamepad controls the viewer with the focus, else the viewer
// with the largest visible share.
const DEAD = 0.15 // dead zone of a stick as a share of its range
const FAST = 4 // factor for the speed of the camera while a trigger is pressed

const BINDINGS = {
  fly: [0, 1], // axes of the left stick
  turn: [2, 3], // axes of the right stick
  down: [4], // left shoulder button
  up: [5], // right shoulder button
  fast: [6, 7], // trigger buttons
  pressed: {
    0: (mode) => (mode === 'walk' ? '2' : '3'), // button A: walk or fly
    1: () => '1', // button B: orbit the scene
    2: () => '0', // button X: show the whole scene
    3: () => 'r', // button Y: the start view
    9: () => 'h', // button Start: the list of keys
    12: () => 'p', // D-pad up and down: the previous or next view
    13: () => 'n',
    14: () => ',', // D-pad left and right: the previous or next annotation
    15: () => '.',
  },
}

const viewers = new Map()
const watch = new IntersectionObserver((list) => list.forEach(seen), { threshold: [0, 0.25, 0.5, 0.75, 1] })
let last = 0
let before = []

export function join(viewer, act) {
  viewers.set(viewer, { act, share: 0 })
  watch.unobserve(viewer)
  watch.observe(viewer)
}

function seen({ target, isIntersecting, intersectionRatio }) {
  const viewer = viewers.get(target)
  if (viewer) viewer.share = isIntersecting ? Math.max(intersectionRatio, 1e-3) : 0
  if (last || !viewer?.share) return
  last = performance.now()
  requestAnimationFrame(look)
}

function meant() {
  for (const viewer of viewers.keys()) if (!viewer.isConnected) watch.unobserve(viewer), viewers.delete(viewer)
  const value = (viewer) => viewers.get(viewer).share + (viewer.matches(':focus-within') ? 1 : 0)
  const there = [...viewers.keys()].filter((viewer) => viewers.get(viewer).share)
  return there.sort((a, b) => value(b) - value(a))[0]
}

/** Returns the position of a stick. The deflection beyond the dead zone is squared, for fine control near the
    middle. */
function placeOf(pad, axes) {
  const place = axes.map((i) => pad.axes[i] ?? 0)
  const far = Math.hypot(...place)
  const part = Math.max(0, Math.min(far, 1) - DEAD) / (1 - DEAD)
  return place.map((x) => (part ? (x / far) * part * part : 0))
}

function look(now) {
  const pads = navigator.getGamepads().filter((pad) => pad?.connected && pad.mapping === 'standard')
  const viewer = meant()
  const seconds = Math.min((now - last) / 1000, 0.1)
  last = pads.length && viewer ? now : 0
  if (!last) return
  requestAnimationFrame(look)
  if (!viewer.hasAttribute('headset')) drive(viewer, pads[0], seconds)
}

function drive(viewer, pad, seconds) {
  const { act } = viewers.get(viewer)
  const { mode } = viewer.settings
  const held = pad.buttons.map(({ value }) => value)
  const most = (buttons) => Math.max(0, ...buttons.map((i) => held[i] ?? 0))
  const { fly, turn, down, up, fast, pressed } = BINDINGS
  for (const [i, key] of Object.entries(pressed)) if (held[i] > 0.5 && !(before[i] > 0.5)) act.press(key(mode))
  before = held
  const [right, back] = placeOf(pad, fly)
  const sinks = mode === 'walk' ? 0 : most(down) - most(up)
  const step = seconds * (1 + (FAST - 1) * most(fast))
  act.fly(right * step, sinks * step, -back * step)
  act.turn(...placeOf(pad, turn).map((x) => x * seconds))
}
