// The on-screen stick for touchscreens, which flies and walks like the keys W A S D.
const SIZE = 116
const REACH = SIZE / 3 // largest deflection of the stick in CSS pixels
const DEAD = 0.12 // dead zone of the stick as a share of REACH
const rules = `
#stick { position: absolute; left: calc(16px + var(--left, 0px)); bottom: calc(78px + var(--below, 0px));
  width: ${SIZE}px; height: ${SIZE}px; border-radius: 50%; touch-action: none; cursor: grab;
  background: radial-gradient(closest-side, transparent 60%, var(--panel)); border: 1px solid var(--line);
  opacity: 0.85; user-select: none; -webkit-user-select: none; }
#stick::after { content: ""; position: absolute; inset: 33%; border-radius: 50%; background: var(--panel);
  border: 2px solid var(--accent); box-shadow: 0 2px 10px #0006; transform: translate(var(--x, 0), var(--y, 0)); }
#stick:active { opacity: 1; cursor: grabbing; }
:host(:not([open])) #stick { display: none; }
#stick:has(~ #player:not([hidden])) { bottom: calc(132px + var(--below, 0px)); }
@media (max-height: 420px) { #stick { bottom: calc(66px + var(--below, 0px)); } }`

export function joystick(root, act) {
  const sheet = new CSSStyleSheet()
  sheet.replaceSync(rules)
  root.adoptedStyleSheets = [...root.adoptedStyleSheets, sheet]
  const stick = document.createElement('div')
  stick.id = 'stick'
  stick.ariaHidden = 'true' // the stick is hidden from screen readers, since keys do the same
  root.getElementById('stage').after(stick)
  let held = null
  let last = 0
  let at = [0, 0]

  function show(x, y) {
    at = [x, y]
    for (const [name, part] of [['--x', x], ['--y', y]]) stick.style.setProperty(name, `${part * REACH}px`)
  }

  function move({ clientX, clientY }) {
    const { left, top } = stick.getBoundingClientRect()
    const [x, y] = [clientX - left, clientY - top].map((n) => (n - SIZE / 2) / REACH)
    const far = Math.max(1, Math.hypot(x, y))
    show(x / far, y / far)
  }

  function step(now) {
    const seconds = Math.min((now - last) / 1000, 0.1)
    last = now
    const far = Math.hypot(...at)
    const part = far > DEAD ? ((far - DEAD) / (1 - DEAD) / far) * seconds : 0
    if (part) act.fly(at[0] * part, 0, -at[1] * part)
    if (held !== null && !stick.hidden) requestAnimationFrame(step)
  }

  const end = ({ pointerId }) => {
    if (pointerId !== held) return
    held = null
    show(0, 0)
  }
  stick.addEventListener('pointerdown', (event) => {
    if (held !== null) return
    held = event.pointerId
    stick.setPointerCapture(held)
    move(event)
    last = performance.now()
    requestAnimationFrame(step)
  })
  stick.addEventListener('pointermove', (event) => event.pointerId === held && move(event))
  for (const name of ['pointerup', 'pointercancel', 'lostpointercapture']) stick.addEventListener(name, end)
  stick.addEventListener('contextmenu', (event) => event.preventDefault())
  return stick
}
