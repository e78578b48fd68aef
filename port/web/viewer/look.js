// The look of the shown picture: tone curve, exposure and vignette, by an SVG filter and a gradient over the canvas.
// The pixels of the canvas, of saved pictures and of films stay as rendered.

const STEPS = 64 // intervals of the table that the filter interpolates
const hable = (x) => (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3
/** Tone curves for linear light, as in PlayCanvas. */
export const CURVES = {
  linear: (x) => x,
  filmic: (x) => hable(x) / hable(11.2),
  hejl(x) {
    const h = Math.max(x - 0.004, 0)
    return (h * (0.275 * h + 0.0375) + 0.0025) / (h * (0.22 * h + 0.3) + 0.06) - 0.0125 / 0.3
  },
  aces: (x) => (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14),
}

const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
const encoded = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055)

const SVG = `<svg id="look" aria-hidden="true"><filter id="tones" x="0" y="0" width="1" height="1"
  color-interpolation-filters="sRGB"><feComponentTransfer>
  ${['R', 'G', 'B'].map((c) => `<feFunc${c} type="table"/>`).join('')}</feComponentTransfer></filter></svg>`

const sheet = new CSSStyleSheet()
sheet.replaceSync(`
#look { position: absolute; width: 0; height: 0; }
#stage { isolation: isolate; }
#stage.toned > * { filter: url(#tones); }
#stage::before { content: ""; position: absolute; inset: 0; z-index: 1; opacity: var(--vignette); pointer-events: none;
  background: radial-gradient(closest-side, transparent 50%, #000); }`)

/** Sets the look. `exposure` is in stops, `vignette` the darkness of the corners, 0 to 1. */
export function look(root, { tone, exposure, vignette }) {
  const stage = root.getElementById('stage')
  if (!root.getElementById('look')) {
    stage.insertAdjacentHTML('afterend', SVG)
    root.adoptedStyleSheets = [...root.adoptedStyleSheets, sheet]
  }
  const curve = CURVES[tone] ?? CURVES.linear
  const out = (_, i) => encoded(Math.min(Math.max(curve(2 ** exposure * linear(i / STEPS)), 0), 1)).toFixed(4)
  const table = Array.from({ length: STEPS + 1 }, out).join(' ')
  for (const one of root.querySelectorAll('#tones [type]')) one.setAttribute('tableValues', table)
  stage.classList.toggle('toned', curve !== CURVES.linear || exposure !== 0)
  stage.style.setProperty('--vignette', vignette)
}
