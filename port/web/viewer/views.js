// Reads views from cameras.json files, links and the page's address, and writes links. A camera is { eye, look, up,
// fov, flat, shift }. `look` is the target. `flat` means orthographic. `shift` is the offset of the camera's axis from
// the middle of the picture, right and down, in heights of the picture.
import { download } from 'fixsplat/read.js'

export const hasNumbers = (list, count) => Array.isArray(list) && list.length === count && list.every(Number.isFinite)
const isView = (v) =>
  v?.rotation?.length === 3 &&
  v.rotation.every((row) => hasNumbers(row, 3)) &&
  hasNumbers(v.position, 3) &&
  [v.cx, v.cy].every((c) => c === undefined || Number.isFinite(c)) &&
  v.fx > 0 &&
  v.height > 0

export function addressOf(url) {
  try {
    return new URL(url, document.baseURI).href
  } catch {
    throw new Error(`${url}: this is no address`)
  }
}

export function nameOf(url) {
  const name = url.split(/[?#]/)[0].split('/').pop()
  try {
    return decodeURIComponent(name) || 'scene'
  } catch {
    return name
  }
}

export function viewsOf(name, text) {
  let views
  try {
    views = JSON.parse(text)
  } catch {
    throw new Error(`${name}: this is no list of views: it is not JSON`)
  }
  if (!Array.isArray(views) || !views.length || !views.every(isView))
    throw new Error(`${name}: expected a list of views, each with rotation, position, fx and height`)
  return views
}

const MOST_TEXT = 64e6

export async function textAt(url, words) {
  const file = await download(new URL(addressOf(url)), { most: MOST_TEXT }).catch((error) => {
    throw error.isSlow || error.isLarge ? error : new Error(`${nameOf(url)}: ${words}`)
  })
  return new TextDecoder().decode(file.first(file.there))
}

export const fetchViews = async (url) => viewsOf(nameOf(url), await textAt(url, 'there are no views at this address'))

const PARAMETERS = ['cameras', 'background', 'budget', 'detail', 'backend', 'threads', 'poster', 'turn', 'noui', 'ui',
  'wheel', 'keep', 'settings', 'skybox', 'lang', 'label', 'eye-height', 'joystick',
  'ar', 'tone', 'exposure', 'vignette', 'time', 'playing', 'speed', 'loop', 'sound', 'muted', 'volume']

export function followAddress(viewer) {
  const asked = new URLSearchParams(location.search)
  for (const name of PARAMETERS) if (asked.has(name)) viewer.setAttribute(name, asked.get(name))
  const follow = () => {
    const link = new URLSearchParams(location.hash.slice(1))
    viewer.setAttribute('view', link.get('view') ?? '')
    if (link.has('annotation')) viewer.setAttribute('annotation', link.get('annotation'))
  }
  follow()
  addEventListener('hashchange', follow)
}

export function cameraOf(text) {
  const n = (text ?? '').split(',').map(Number)
  if (!hasNumbers(n, 10) && !hasNumbers(n, 13)) return null
  const [fov, flat = 0, ...shift] = n.slice(9)
  const place = { eye: n.slice(0, 3), look: n.slice(3, 6), up: n.slice(6, 9) }
  return { ...place, fov, flat: !!flat, shift: shift.length ? shift : [0, 0] }
}

export function textOf({ eye, look, up, fov, flat, shift }) {
  const more = flat || shift.some(Boolean) ? [flat ? 1 : 0, ...shift] : []
  return [...eye, ...look, ...up, fov, ...more].join()
}

export function checkedCamera(given, other = {}) {
  const camera = { up: [0, -1, 0], fov: 50, flat: false, shift: [0, 0], ...other }
  for (const [name, value] of Object.entries(given)) {
    const numbers = { eye: 3, look: 3, up: 3, shift: 2 }[name]
    if (numbers && !hasNumbers([...value], numbers)) throw new Error(`camera: ${name}: expected ${numbers} numbers`)
    camera[name] = numbers ? [...value] : value
  }
  if (!camera.eye || !camera.look) throw new Error('camera: expected eye and look')
  if (!(camera.fov >= 1 && camera.fov <= 170)) throw new Error(`camera: fov ${camera.fov}: expected 1 to 170 degrees`)
  const { eye, look, up, fov, flat, shift } = camera
  return { eye, look, up, fov, flat: !!flat, shift }
}
