// Listens to pointers and keys, and calls the functions of an object `act`. The functions drag, look and pan get
// distances in pixels, and zoom gets a factor. focus and click get a pixel, fly and arrows get seconds, and press gets
// a key.

const CLICK_PIXELS = 4 // pixels: a pointer that moves farther is a drag, not a click

function middle(pointers) {
  const [a, b = a] = [...pointers.values()]
  return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) }
}

export function listenToPointers(stage, act, holdsSpace) {
  const pointers = new Map()
  const motionOf = (event) => {
    if (holdsSpace()) return act.look
    return pointers.size > 1 || event.buttons & 6 || event.shiftKey ? act.pan : act.drag
  }
  let pressed = null
  const end = (event) => pointers.delete(event.pointerId)
  stage.addEventListener('pointerdown', (event) => {
    stage.setPointerCapture(event.pointerId)
    pressed = pointers.size || event.button ? null : event
    if (pointers.size < 2) pointers.set(event.pointerId, event)
  })
  stage.addEventListener('pointerup', (event) => {
    const far = pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY)
    if (pressed?.pointerId === event.pointerId && far <= CLICK_PIXELS) act.click(event.offsetX, event.offsetY)
    pressed = null
  })
  stage.addEventListener('pointermove', (event) => {
    if (stage.getRootNode().pointerLockElement === stage) return act.look(event.movementX, event.movementY)
    if (!pointers.has(event.pointerId)) return
    const before = middle(pointers)
    pointers.set(event.pointerId, event)
    const now = middle(pointers)
    motionOf(event)(now.x - before.x, now.y - before.y)
    if (pointers.size > 1 && now.apart > 0) act.zoom(before.apart / now.apart)
  })
  for (const name of ['pointerup', 'pointercancel', 'lostpointercapture']) stage.addEventListener(name, end)
  stage.addEventListener('contextmenu', (event) => event.preventDefault())
  stage.addEventListener('dblclick', (event) => act.focus(event.offsetX, event.offsetY))
  stage.addEventListener(
    'wheel',
    (event) => {
      if (!act.takesWheel(event)) return
      event.preventDefault()
      const pixels = event.deltaY * [1, 33, 400][event.deltaMode]
      act.zoom(1.1 ** (Math.max(-300, Math.min(300, pixels)) / 100))
    },
    { passive: false }
  )
}

const FLIGHT = {
  KeyD: [1, 0, 0],
  KeyA: [-1, 0, 0],
  KeyQ: [0, 1, 0],
  KeyE: [0, -1, 0],
  KeyW: [0, 0, 1],
  KeyS: [0, 0, -1],
}
const TURN = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }

function isForText(target) {
  return target.matches?.('input, select, textarea')
}

export function listenToKeys(element, act) {
  const held = new Set()
  let last = 0
  const sum = (table, count) =>
    Object.keys(table)
      .filter((code) => held.has(code))
      .reduce((total, code) => total.map((x, i) => x + table[code][i]), Array(count).fill(0))
  const step = (now) => {
    const [flight, turn] = [sum(FLIGHT, 3), sum(TURN, 2)]
    const seconds = last ? Math.min((now - last) / 1000, 0.1) : 0.016
    last = flight.some(Boolean) || turn.some(Boolean) ? now : 0
    if (!last) return
    act.fly(...flight.map((x) => x * seconds * (held.has('Shift') ? 4 : 1)))
    act.arrows(...turn.map((x) => x * seconds))
    requestAnimationFrame(step)
  }
  element.addEventListener('keydown', (event) => {
    const target = event.composedPath()[0]
    if (event.ctrlKey || event.metaKey || event.altKey || (isForText(target) && event.key !== 'Escape')) return
    if (event.key === 'Shift') held.add('Shift')
    else if (event.code in FLIGHT || event.code in TURN || (event.code === 'Space' && !target.matches('button'))) {
      held.add(event.code)
      event.preventDefault()
      if (!last) requestAnimationFrame(step)
    } else if (!event.repeat) act.press(event.key)
  })
  element.addEventListener('keyup', (event) => held.delete(event.key === 'Shift' ? 'Shift' : event.code))
  element.addEventListener('blur', () => held.clear())
  return held
}
