// The geometry of cameras: functions that return a moved camera. Angles are in radians, lengths in scene units. `look`
// is the target of a camera.

const POLE = 0.02 // smallest angle in radians between the direction of view and the up direction

export const add = (a, b, times = 1) => a.map((x, i) => x + times * b[i])
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
export const unit = (a) => a.map((x) => x / Math.hypot(...a))
const mix = (a, b, t) => a.map((x, i) => x + t * (b[i] - x))

/** Rotates a vector about a unit axis (Rodrigues' formula). */
export function rotate(a, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)]
  const along = dot(axis, a) * (1 - c)
  const aside = cross(axis, a)
  return a.map((x, i) => x * c + aside[i] * s + axis[i] * along)
}

export const distance = ({ eye, look }) => Math.hypot(...add(look, eye, -1))
const slope = (fov) => Math.tan((fov * Math.PI) / 360)
const degrees = (slope) => (360 / Math.PI) * Math.atan(slope)

const heightAt = (camera) => 2 * distance(camera) * slope(camera.fov)

function axes({ eye, look, up }) {
  const forward = unit(add(look, eye, -1))
  const right = unit(cross(forward, up))
  return { forward, right, down: cross(forward, right) }
}

/** Turns the vector `from` and the camera's up vector by the angles `right` and `down`. Does not turn past the scene's
    up direction or its opposite. Returns both vectors. */
function turn(camera, from, up, right, down) {
  const view = axes(camera)
  const axis = unit(up)
  const angle = Math.acos(Math.max(-1, Math.min(1, dot(view.forward, axis))))
  const end = Math.min(Math.max(angle + down, Math.min(angle, POLE)), Math.max(angle, Math.PI - POLE))
  const both = (a) => rotate(rotate(a, view.right, angle - end), axis, -right)
  return [both(from), both(cross(view.right, view.forward))]
}

export function orbit(camera, sceneUp, right, down) {
  const [back, up] = turn(camera, add(camera.eye, camera.look, -1), sceneUp, right, down)
  return { ...camera, eye: add(camera.look, back), up }
}

export function isLevel(camera, sceneUp) {
  const { right, down } = axes(camera)
  const up = unit(sceneUp)
  return Math.abs(dot(right, up)) < 1e-3 && dot(down, up) < 1e-3
}

export function level(camera, sceneUp) {
  const up = unit(sceneUp)
  return Math.abs(dot(axes(camera).forward, up)) > 0.9998 ? camera : { ...camera, up }
}

export function lookAround(camera, sceneUp, right, down) {
  const [ahead, up] = turn(camera, add(camera.look, camera.eye, -1), sceneUp, right, down)
  return { ...camera, look: add(camera.eye, ahead), up }
}

export function fly(camera, right, down, forward) {
  const view = axes(camera)
  const move = (a) => add(add(add(a, view.right, right), view.down, down), view.forward, forward)
  return { ...camera, eye: move(camera.eye), look: move(camera.look) }
}

export function pan(camera, height, right, down) {
  const unitsAPixel = heightAt(camera) / height
  return fly(camera, -right * unitsAPixel, -down * unitsAPixel, 0)
}

/** Zooms a camera by a factor. Scales the distance to the target; for an orthographic camera, scales the visible
    area. */
export function zoom(camera, factor, nearest) {
  const least = Math.min(1, nearest / (camera.flat ? heightAt(camera) : distance(camera)))
  const times = Math.max(factor, least)
  if (camera.flat) return { ...camera, fov: degrees(times * slope(camera.fov)) }
  return { ...camera, eye: mix(camera.look, camera.eye, times) }
}

export function flatten(camera, flat, fov) {
  const times = slope(camera.fov) / slope(fov)
  return { ...camera, flat, fov, eye: mix(camera.look, camera.eye, times) }
}

export function between(a, b, t) {
  const part = t * t * (3 - 2 * t)
  const mixed = ['eye', 'look', 'up', 'shift'].map((k) => [k, mix(a[k], b[k], part)])
  return { ...b, fov: a.fov + part * (b.fov - a.fov), ...Object.fromEntries(mixed) }
}

export function rendered(camera, width, height, near) {
  const { eye, flat, shift, fov } = camera
  if (!flat && !shift.some(Boolean)) return camera
  const { right, down, forward } = axes(camera)
  const rotation = [0, 1, 2].map((i) => [right[i], down[i], forward[i]])
  const [cx, cy] = [width / 2 + shift[0] * height, height / 2 + shift[1] * height]
  const fx = height / (flat ? heightAt(camera) : 2 * slope(fov))
  return { rotation, position: eye, fx, cx, cy, near, orthographic: flat, width, height }
}

export function project(camera, point, width, height) {
  const { right, down, forward } = axes(camera)
  const to = add(point, camera.eye, -1)
  const depth = dot(forward, to)
  const scale = height / (camera.flat ? heightAt(camera) : 2 * slope(camera.fov) * depth)
  const [x, y] = [dot(right, to), dot(down, to)]
  return { x: width / 2 + camera.shift[0] * height + scale * x, y: height / 2 + camera.shift[1] * height + scale * y, depth }
}

const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1, (i >> 1) & 1, i >> 2])

function frontOf(up) {
  const start = Math.abs(up[2]) > 0.9 ? [0, -1, 0] : [0, 0, -1]
  const back = unit(add(start, up, -dot(start, up)))
  return add(
    back.map((x) => 0.95 * x),
    up,
    0.31
  )
}

/** Returns a camera that sees all corners of a scene's box, from 1.1 times the smallest distance that shows them. */
export function seeAll(scene, sceneUp, fov, aspect, first) {
  const { low, high } = first ?? scene
  const up = unit(sceneUp)
  const from = unit(first?.from ?? frontOf(up))
  const look = mix(low, high, 0.5)
  if (first?.part === 0) {
    const ahead = add(look, from, -Math.max(Math.hypot(...add(high, low, -1)) / 2, 1e-3))
    return { eye: look, look: ahead, up, fov, flat: false, shift: [0, 0] }
  }
  const { forward, right, down } = axes({ eye: add(look, from), look, up })
  const needs = corners.map((corner) => {
    const c = add(
      corner.map((end, i) => (end ? high : low)[i]),
      look,
      -1
    )
    return Math.max(Math.abs(dot(right, c)) / aspect, Math.abs(dot(down, c))) / slope(fov) - dot(forward, c)
  })
  return { eye: add(look, from, 1.1 * (first?.part ?? 1) * Math.max(...needs, 1e-3)), look, up, fov, flat: false, shift: [0, 0] }
}

/** Converts a camera of a cameras.json file. Its target becomes the point of the camera's axis that is nearest to the
    middle of the scene's box. A picture higher than wide (aspect: width / height) shows view.reach to both sides, as
    fxs_view_of_start does. */
export function ofView(view, { low, high }, aspect = 1) {
  const column = (i) => view.rotation.map((row) => row[i])
  const forward = unit(column(2))
  const radius = Math.hypot(...add(high, low, -1)) / 2
  const ahead = dot(add(mix(low, high, 0.5), view.position, -1), forward)
  const look = add(view.position, forward, ahead > 0.01 * radius ? ahead : radius)
  const { width, height, fx, fy = fx, cx = width / 2, cy = height / 2, orthographic: flat = false } = view
  const shift = [(cx - width / 2 || 0) / height, (cy - height / 2) / height]
  const far = flat ? Math.hypot(...add(look, view.position, -1)) : 1
  const tangent = height / 2 / fy / far
  const tall = aspect < 1 ? Math.min(view.reach ?? 0, tangent / aspect) / aspect : 0
  const fov = degrees(Math.max(tangent, Math.min(tall, 12)))
  return { eye: [...view.position], look, up: column(1).map((x) => -x), fov, flat, shift }
}

export function upOf(views, otherwise) {
  const mean = [0, 1, 2].map((i) => views.reduce((sum, view) => sum - view.rotation[i][1] / views.length, 0))
  return Math.hypot(...mean) > 0.1 ? mean : otherwise
}
