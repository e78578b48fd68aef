// The skybox: makes the backdrop of a frame from an equirectangular picture. The middle column of the picture is ahead,
// along z, or along -y if z is up. Only exactly rounded operations are used, so all browsers give the same bytes.
import { download } from 'fixsplat/read.js'
import { add, cross, dot, unit } from './motion.js'

const MOST_BYTES = 256e6
const MOST_WIDTH = 4096
const SPAN = 8 // distance in pixels between two exactly computed directions of view
const TURN = 2 * Math.PI
const skies = new Map()

async function pixelsOf(url) {
  const file = await download(new URL(url), { most: MOST_BYTES }).catch((error) => {
    throw error.isSlow || error.isLarge ? error : new Error(`${url}: there is no picture at this address`)
  })
  const blob = new Blob([file.first(file.there)])
  const plain = { colorSpaceConversion: 'none', premultiplyAlpha: 'none' }
  const whole = await createImageBitmap(blob, plain).catch(() => {
    throw new Error(`${url}: this browser does not read it as a picture`)
  })
  const width = Math.min(whole.width, MOST_WIDTH)
  const height = Math.max(1, Math.round((whole.height * width) / whole.width))
  const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })
  context.drawImage(whole, 0, 0, width, height)
  whole.close()
  return { width, height, pixels: context.getImageData(0, 0, width, height).data }
}

/** Returns atan(x) / 2 pi for x of 0 to 1, with an error of at most 4e-9 (Abramowitz and Stegun 4.4.49). */
function turnsOfPart(x) {
  const s = x * x
  const even = ((((0.0028662257 * s - 0.0161657367) * s + 0.0429096138) * s - 0.075289640) * s + 0.1065626393) * s
  return (x * ((((even - 0.1420889944) * s + 0.1999355085) * s - 0.3333314528) * s + 1)) / TURN
}

function turnsOf(y, x) {
  const a = Math.abs(y)
  const b = Math.abs(x)
  const eighth = a > b ? 0.25 - turnsOfPart(b / a) : a || b ? turnsOfPart(a / b) : 0
  const half = x < 0 ? 0.5 - eighth : eighth
  return y < 0 ? -half : half
}

function raysOf(camera, width, height) {
  if (camera.rotation) {
    const [right, down, forward] = [0, 1, 2].map((i) => camera.rotation.map((row) => row[i]))
    const scale = camera.width ? width / camera.width : 1
    const [cx, cy] = [camera.cx ?? width / 2 / scale, camera.cy ?? height / 2 / scale]
    const step = camera.orthographic ? 0 : 1 / (scale * camera.fx)
    const middle = (camera.height ?? height / scale) / 2
    return { right, down, forward, step, cx: scale * cx, cy: height / 2 + scale * (cy - middle) }
  }
  const forward = unit(add(camera.look, camera.eye, -1))
  const right = unit(cross(forward, camera.up))
  const step = (2 * Math.tan((camera.fov * Math.PI) / 360)) / height
  return { right, down: cross(forward, right), forward, step, cx: width / 2, cy: height / 2 }
}

function axesOf(up) {
  const above = unit(up)
  const start = Math.abs(above[2]) > 0.9 ? [0, -1, 0] : [0, 0, 1]
  const ahead = unit(add(start, above, -dot(start, above)))
  return [cross(ahead, above), above, ahead]
}

function sample({ width, height, pixels }, u, v, out, at) {
  const x = (u - Math.floor(u)) * width - 0.5
  const y = Math.min(Math.max(v * height - 0.5, 0), height - 1)
  const left = Math.floor(x)
  const above = Math.floor(y)
  const fx = x - left
  const fy = y - above
  const x0 = left < 0 ? width - 1 : left
  const x1 = left + 1 < width ? left + 1 : 0
  const y0 = above * width
  const y1 = Math.min(above + 1, height - 1) * width
  for (let k = 0; k < 3; k++) {
    const a = pixels[4 * (y0 + x0) + k]
    const c = pixels[4 * (y1 + x0) + k]
    const top = a + fx * (pixels[4 * (y0 + x1) + k] - a)
    out[at + k] = top + fy * (c + fx * (pixels[4 * (y1 + x1) + k] - c) - top) + 0.5
  }
  out[at + 3] = 255
}

// Draws the skybox as a camera sees it. Every SPAN-th pixel of a row has an exact direction of view, and the pixels
// between are interpolated linearly. Near the poles, and where the left and right edges of the sky picture meet, all
// pixels are exact.
function seen(sky, camera, up, width, height) {
  const { right, down, forward, step, cx, cy } = raysOf(camera, width, height)
  const axes = axesOf(up)
  const [r, d, f] = [right, down, forward].map((a) => axes.map((axis) => dot(axis, a)))
  const out = new Uint8Array(4 * width * height)
  const place = new Float64Array(2)
  const look = (x, y) => {
    const s = (x + 0.5 - cx) * step
    const t = (y + 0.5 - cy) * step
    const east = f[0] + t * d[0] + s * r[0]
    const north = f[2] + t * d[2] + s * r[2]
    place[0] = 0.5 + turnsOf(east, north)
    place[1] = 0.5 - 2 * turnsOf(f[1] + t * d[1] + s * r[1], Math.sqrt(east * east + north * north))
  }
  for (let y = 0, at = 0; y < height; y++) {
    look(0, y)
    for (let x = 0; x < width; x += SPAN) {
      const [u, v] = place
      look(x + SPAN, y)
      const du = (place[0] - u) / SPAN
      const dv = (place[1] - v) / SPAN
      const isLinear = Math.abs(du) < 0.001 && Math.min(v, 1 - v) > 0.15
      for (let i = 0; i < SPAN && x + i < width; i++, at += 4) {
        if (isLinear) sample(sky, u + i * du, v + i * dv, out, at)
        else {
          look(x + i, y)
          sample(sky, place[0], place[1], out, at)
        }
      }
      if (!isLinear) look(x + SPAN, y)
    }
  }
  return out
}

export async function backdropOf({ url, up }, camera, { width, height }) {
  if (!skies.has(url)) skies.clear(), skies.set(url, pixelsOf(url))
  return seen(await skies.get(url), camera, up, width, height)
}
