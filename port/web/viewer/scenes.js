// The element <fixsplat-scene>, which adds a scene to a <fixsplat-viewer>, and the class Item, the state of a scene.

import { addressOf, nameOf } from './views.js'

const RADIANS = Math.PI / 360 // half a degree in radians, since quaternions have half angles

function numbersOf(element, name, ...counts) {
  const text = element.getAttribute(name)
  if (text === null) return undefined
  const list = text.trim().split(/[\s,]+/).map(Number)
  if (counts.includes(list.length) && list.every(Number.isFinite)) return list
  throw new Error(`${name}="${text}": expected ${counts.join(' or ')} ${counts[0] === 1 ? 'number' : 'numbers'}`)
}

const product = ([a, b, c, d], [e, f, g, h]) => [
  a * e - b * f - c * g - d * h,
  a * f + b * e + c * h - d * g,
  a * g - b * h + c * e + d * f,
  a * h + b * g - c * f + d * e,
]

/** Returns the quaternion of a rotation that turns by degrees about x, then y, then z. */
const quaternionOf = (degrees) =>
  degrees.map((angle, axis) => {
    const part = [Math.cos(angle * RADIANS), 0, 0, 0]
    part[axis + 1] = Math.sin(angle * RADIANS)
    return part
  }).reduce((before, next) => product(next, before))

function placeOf(element) {
  const rotation = numbersOf(element, 'rotation', 3, 4)
  const [scale] = numbersOf(element, 'scale', 1) ?? []
  const [opacity] = numbersOf(element, 'opacity', 1) ?? []
  if (scale <= 0) throw new Error(`scale="${scale}": expected a number above 0`)
  if (opacity < 0 || opacity > 1) throw new Error(`opacity="${opacity}": expected 0 to 1`)
  if (rotation && !rotation.some(Boolean) && rotation.length === 4) throw new Error('rotation: expected a quaternion')
  const place = {
    translation: numbersOf(element, 'position', 3),
    rotation: rotation?.length === 3 ? quaternionOf(rotation) : rotation,
    scale,
    opacity,
    tint: numbersOf(element, 'tint', 3),
    time: numbersOf(element, 'time', 1)?.[0],
    visible: element.hidden ? false : undefined,
  }
  return Object.fromEntries(Object.entries(place).filter(([, value]) => value !== undefined))
}

export const WATCHED = ['src', 'position', 'rotation', 'scale', 'opacity', 'tint', 'time', 'hidden']

const asText = (value) => (typeof value === 'object' ? [...value].join(' ') : `${value}`)

export class PlacedScene extends HTMLElement {
  source = null

  static {
    for (const name of WATCHED.filter((name) => name !== 'hidden'))
      Object.defineProperty(this.prototype, name, {
        get() {
          return this.getAttribute(name)
        },
        set(value) {
          if (value === null || value === undefined) this.removeAttribute(name)
          else this.setAttribute(name, asText(value))
        },
      })
  }
}

if (!customElements.get('fixsplat-scene')) customElements.define('fixsplat-scene', PlacedScene)

let keys = 0

function wholeOf(source) {
  try {
    return typeof source === 'string' ? addressOf(source) : source
  } catch {
    return source
  }
}

export class Item {
  key = ++keys
  engine = null
  facts = null
  bytes = null
  failed = false
  wrong = null // the Error in the attributes that place the scene, else null; the last valid placement is kept
  #place = {}
  #timer = 0

  constructor(source, element = null) {
    Object.assign(this, { source: wholeOf(source), element })
  }

  get name() {
    const { source } = this
    return typeof source === 'string' ? nameOf(source) : (source.name ?? source[0]?.name ?? 'scene')
  }

  get place() {
    this.wrong = null
    try {
      if (this.element) this.#place = placeOf(this.element)
    } catch (error) {
      this.wrong = error
    }
    return this.#place
  }

  get told() {
    const { name, count, low, high } = this.facts
    return { source: this.source, name, count, low, high, element: this.element }
  }

  let(seconds, call) {
    this.#timer ||= setTimeout(call, 1000 * seconds)
  }

  keep() {
    clearTimeout(this.#timer)
    this.#timer = 0
  }
}
