// The page of `fixsplat fit --preview`: shows the numbers, the curve and the newest scene of a running fit.
import './viewer.js'

const ASK_MS = 1000
const SILENT = 3
const STATES = {
  reads: 'Reading photographs and cameras',
  fits: 'Fitting',
  measures: 'Measuring the result',
  over: 'The fit is over',
  stopped: 'Stopped, and saved',
  failed: 'The fit has failed',
}
const TICKS = 4

const ui = {}
for (const element of document.querySelectorAll('[id]')) ui[element.id] = element
const pause = (ms) => new Promise((done) => setTimeout(done, ms))
const many = (n) => n.toLocaleString('en')

let viewer
let shown = 0

function newViewer(background) {
  const element = document.createElement('fixsplat-viewer')
  element.setAttribute('cameras', '../cameras.json')
  element.setAttribute('background', background)
  ui.wait.replaceWith(element)
  return element
}

async function open(address, background) {
  viewer ??= newViewer(background)
  if (viewer.hasAttribute('open')) return viewer.replace(address).catch(() => false)
  viewer.setAttribute('src', address)
  while (viewer.state === 'loading' && !viewer.hasAttribute('open')) await pause(100)
  return viewer.hasAttribute('open')
}

async function show({ version, background }) {
  if (await open(`../scene.fxs?${version}`, background)) shown = version
}

/** Shows the last scene of a fit before the next request to the server. The server ends after that request. */
async function showLast(facts) {
  for (let tries = 0; facts.version !== shown && tries < 20; tries++) {
    await show(facts)
    await pause(200)
  }
}

function durationOf(seconds) {
  const s = Math.floor(seconds)
  if (s < 60) return `${s} s`
  if (s < 3600) return `${Math.floor(s / 60)} min ${String(s % 60).padStart(2, '0')} s`
  return `${Math.floor(s / 3600)} h ${String(Math.floor(s / 60) % 60).padStart(2, '0')} min`
}

function write(facts) {
  const { scene, state, step, steps, gaussians, loss, seconds, left, held_out: held, photographs, result } = facts
  const name = scene.split('/').pop()
  const share = steps ? Math.min(step / steps, 1) : 0
  const percent = `${Math.floor(100 * share)} %`
  document.title = state === 'fits' ? `${percent} · ${name}` : `${STATES[state]} · ${name}`
  ui.name.textContent = name
  ui.state.textContent = STATES[state]
  ui.state.classList.toggle('lost', state === 'failed')
  if (!steps) return
  ui.bar.value = share
  ui.share.textContent = percent
  ui.left.textContent = state === 'fits' && step && left !== null ? `${durationOf(left)} left` : ''
  ui.step.textContent = many(step)
  ui.gaussians.textContent = many(gaussians)
  ui.loss.textContent = step && loss !== null ? loss.toFixed(4) : '–'
  ui.time.textContent = durationOf(seconds)
  const kind = held ? 'held out' : 'of the fit'
  ui.measured.textContent = `PSNR of ${photographs || 'all'} photographs ${kind}`
  ui.result.hidden = !result
  if (result)
    ui.result.textContent = `All ${result.photographs} photographs ${kind}: ${wordsOf(result.psnr, result.ssim)}`
}

const wordsOf = (psnr, ssim) => `${psnr === null ? 'equal' : `${psnr.toFixed(2)} dB`}, SSIM ${ssim.toFixed(4)}`

const draw = (name, attributes, text = '') => {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name)
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value)
  element.textContent = text
  return element
}

/** Returns the distance between two marks on an axis of the curve: 1, 2 or 5 times a power of ten, for at most TICKS
    parts. */
function stepOf(range) {
  const power = 10 ** Math.floor(Math.log10(range / TICKS))
  return power * [1, 2, 5, 10].find((times) => (times * power * TICKS) / range > 0.9999)
}

const short = (n) => (n >= 1000 && n % 100 === 0 ? `${n / 1000}k` : many(n))

function drawCurve({ points, ...facts }) {
  const steps = Math.max(facts.steps, facts.step)
  const { clientWidth: width, clientHeight: height } = ui.curve
  const there = points.filter(([, psnr]) => psnr !== null)
  const values = there.map(([, psnr]) => psnr)
  const rise = stepOf(Math.max(Math.max(...values) - Math.min(...values), 1))
  const [low, high] = [Math.floor(Math.min(...values) / rise) * rise, Math.ceil(Math.max(...values) / rise) * rise]
  const top = Math.max(high, low + 2 * rise)
  const x = (step) => 30 + (step / steps) * (width - 48)
  const y = (psnr) => height - 22 - ((psnr - low) / (top - low)) * (height - 36)
  const parts = []
  for (let value = low; value < top + rise / 2; value += rise)
    parts.push(
      draw('line', { class: 'grid', x1: 30, x2: width, y1: y(value), y2: y(value) }),
      draw('text', { x: 24, y: y(value) + 4, 'text-anchor': 'end' }, String(+value.toFixed(2)))
    )
  const run = stepOf(steps)
  for (let step = 0; step <= steps; step += run)
    parts.push(draw('text', { x: x(step), y: height - 4, 'text-anchor': 'middle' }, short(step)))
  const line = there.map(([step, psnr]) => `${x(step)},${y(psnr)}`).join(' ')
  parts.push(draw('polyline', { class: 'curve', points: line }))
  there.forEach(([step, psnr, ssim], i) => {
    const circle = draw('circle', { cx: x(step), cy: y(psnr), r: i === there.length - 1 ? 4.5 : 3 })
    circle.append(draw('title', {}, `Step ${many(step)}: ${wordsOf(psnr, ssim)}`))
    parts.push(circle)
  })
  const [step, psnr, ssim] = there.at(-1)
  const isRight = x(step) > width / 2
  const end = { class: 'end', x: x(step) + (isRight ? -2 : 9), y: y(psnr) + (y(psnr) > 26 ? -10 : 20) }
  parts.push(draw('text', { ...end, 'text-anchor': isRight ? 'end' : 'start' }, `${psnr.toFixed(2)} dB`))
  ui.curve.replaceChildren(...parts)
  ui.curve.setAttribute('aria-label', `PSNR by steps; after step ${many(step)}: ${wordsOf(psnr, ssim)}`)
  ui.ssim.textContent = `SSIM ${ssim.toFixed(3)}`
}

const drawAgain = (facts) => facts?.points.some(([, psnr]) => psnr !== null) && drawCurve(facts)

// ---- Polling the server ---------------------------------------------------------------------------------------------

const ask = () =>
  fetch('../fit.json', { cache: 'no-store' })
    .then((answer) => answer.json())
    .catch(() => null)

let last = null
let silent = 0
new ResizeObserver(() => drawAgain(last)).observe(ui.curve)

for (let isOver = false; !isOver; await pause(ASK_MS)) {
  const facts = await ask()
  silent = facts ? 0 : silent + 1
  if (silent >= SILENT && last?.state !== 'stopped') {
    ui.state.textContent = 'No answer: it has ended, or was stopped'
    ui.state.classList.add('lost')
  }
  if (!facts) continue
  last = facts
  write(facts)
  drawAgain(facts)
  isOver = facts.state === 'over' || facts.state === 'failed'
  if (isOver) await showLast(facts)
  else if (facts.version !== shown && !document.hidden) await show(facts)
}
await ask()
