// The scenes of a viewer: the element <fixsplat-scene>, which puts one more scene into a <fixsplat-viewer>, and what is
// known of each.

import { addressOf, nameOf } from './views.js'

const RADIANS = Math.PI / 360 // half of a degree

/** Numbers of an attribute, between spaces or commas; undefined without it. */
function numbersOf(element, name, ...counts) {
  const text = element.getAttribute(name)
  if (text === null) return undefined
  const list = text.trim().split(/[\s,]+/).map(Number)
  if (counts.includes(list.length) && list.every(Number.isFinite)) return list
  throw new Error(`${name}="${text}": expected ${counts.join(' or ')} ${counts[0] === 1 ? 'number' : 'numbers'}`)
}

/** The product of two quaternions w, x, y, z. */
const product = ([a, b, c, d], [e, f, g, h]) => [
  a * e - b * f - c * g - d * h,
  a * f + b * e + c * h - d * g,
  a * g - b * h + c * e + d * f,
  a * h + b * g - c * f + d * e,
]

/** By degrees about x, then y, then z, as `fixsplat convert --rotate`; as a quaternion. */
const quaternionOf = (degrees) =>
  degrees.map((angle, axis) => {
    const part = [Math.cos(angle * RADIANS), 0, 0, 0]
    part[axis + 1] = Math.sin(angle * RADIANS)
    return part
  }).reduce((before, next) => product(next, before))

/** Where a scene lies, as `render` takes objects; nothing of it where it lies as in its file. */
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
    visible: element.hidden ? false : undefined,
  }
  return Object.fromEntries(Object.entries(place).filter(([, value]) => value !== undefined))
}

/** Attributes that tell of a scene; the viewer watches them. */
export const WATCHED = ['src', 'position', 'rotation', 'scale', 'opacity', 'tint', 'hidden']

const asText = (value) => (typeof value === 'object' ? [...value].join(' ') : `${value}`)

export class PlacedScene extends HTMLElement {
  /** A file, or the files of a scene, in place of the address `src`; to be set before it is put into a viewer. */
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

/** An address as a whole; one that is none stays as it is. */
function wholeOf(source) {
  try {
    return typeof source === 'string' ? addressOf(source) : source
  } catch {
    return source
  }
}

/** A scene that is asked for. */
export class Item {
  key = ++keys
  engine = null // the worker that has it
  facts = null // what that has said of it
  bytes = null // the packed scene, on its way from one worker to another
  failed = false
  wrong = null // an Error of its place, which stays as it was
  #place = {}
  #timer = 0

  /** The element is null for the scene of the viewer's own `src`. */
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

  /** What a page is told of it. */
  get told() {
    const { name, count, low, high } = this.facts
    return { source: this.source, name, count, low, high, element: this.element }
  }

  /** Calls in so many seconds, unless it is kept meanwhile. */
  let(seconds, call) {
    this.#timer ||= setTimeout(call, 1000 * seconds)
  }

  keep() {
    clearTimeout(this.#timer)
    this.#timer = 0
  }
}
