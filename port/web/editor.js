// Editing a scene by hand: selects and deletes Gaussians. fixsplat.js loads this module with the first edited scene.

const SHAPES = ['box', 'sphere', 'lasso', 'brush', 'object']
const COUNTS = [6, 4, 0, 0, 0]
const MARK = 0xff3d7dff         // orange, as RGBA8 in little-endian order

/** Selects and deletes Gaussians of a scene. The scene then has no levels of detail. */
export class Editor {
  #begin
  #core
  #at
  #of
  #chosen = []                  // shapes of the selection
  #list = []

  /** `begin` is the function of fixsplat.js that begins a frame. */
  constructor(scene, begin) {
    const [core, at, pager] = scene.inside
    if (pager) throw new Error(`${scene.name}: only parts of it are here: load it with \`paging: false\``)
    if (scene.duration) throw new Error(`${scene.name}: it moves: only still scenes are edited by hand`)
    this.scene = scene
    this.#begin = begin
    this.#core = core
    this.#at = core.place(core.c.edit_open(at))
    const [gaussians, checksum] = core.get(0, 2)
    this.#of = { gaussians, checksum: checksum.toString(16).padStart(8, '0') }
  }

  get facts() {
    this.#core.c.edit_facts(this.#at)
    const [left, chosen, done, last] = this.#core.get(0, 4)
    return { left, chosen, done, last }
  }

  /** Selects by a shape { shape, numbers or points, front, subtract }, beside what is selected. A click or a box of an
      object joins those before of the same camera. */
  select(asked, camera = {}, options = {}) {
    const shape = { ...asked }
    const kind = SHAPES.indexOf(shape.shape)
    const { numbers = [] } = shape
    if (kind < 0 || numbers.length !== COUNTS[kind] || !numbers.every(Number.isFinite))
      throw new Error('expected a box of 6 numbers, a sphere of 4, a lasso, a brush or an object')
    const [core, width, height] = this.#begin([{ scene: this.scene }], camera, options)
    if (kind > 1) {
      core.c.edit_camera()
      const [fx, fy, cx, cy, ...rest] = core.get(0, 17)
      const [rotation, position, near] = [rest.slice(0, 9), rest.slice(9, 12), rest[12]]
      const orthographic = !!camera.orthographic
      shape.camera = { width, height, fx, fy, cx, cy, rotation, position, near, orthographic }
    }
    const joins = shape.shape === 'object' && this.#join(shape)
    const points = Int32Array.from(shape.points?.length ? shape.points : [0])
    const at = core.copy(new Uint8Array(points.buffer))
    try {
      core.put(...numbers)
      core.draw('edit_select', this.#at, kind, !!shape.subtract, !!shape.front, at, points.length, joins)
    } finally {
      core.c.release(at)
    }
    if (joins) this.#chosen.pop()
    this.#chosen.push(shape)
    return this.facts
  }

  /** Puts a click or a box behind those of the object that was selected last. Returns false if this one begins another
      shape. Where something else was meant, that shape takes the object out. */
  #join(shape) {
    const last = this.#chosen.at(-1)
    const isSame = last?.shape === 'object' && !last.subtract && JSON.stringify(last.camera) === JSON.stringify(shape.camera)
    if (isSame) shape.points = [...last.points, ...shape.points]
    else if (!shape.points[4]) Object.assign(shape, { subtract: true, points: [...shape.points.slice(0, 4), 1] })
    return isSame
  }

  clear() {
    this.#core.c.edit_clear(this.#at)
    this.#chosen = []
    return this.facts
  }

  /** Deletes what is selected ('delete') or everything else ('keep'). */
  act(act) {
    const { done } = this.facts
    this.#core.check(this.#core.c.edit_act(this.#at, act === 'keep'))
    this.#list.splice(done, Infinity, { act, select: this.#chosen })
    return this.clear()
  }

  /** Takes edits back or does them again, until the first `done` of them are done. */
  go(done) {
    this.#core.c.edit_go(this.#at, done)
    return this.clear()
  }

  /** The edits that are done, as the content of a file for `fixsplat convert --edits`. */
  get edits() {
    const edits = this.#list.slice(0, this.facts.done)
    return { format: 'fixsplat edits', version: 1, scene: this.#of, edits }
  }

  /** Returns a picture of dots at the centres of the selected Gaussians. */
  marks(camera, options) {
    const [core, width, height] = this.#begin([{ scene: this.scene }], camera, options)
    const bytes = 4 * width * height
    const at = core.copy(new Uint8Array(bytes))
    core.c.edit_mark(this.#at, at, MARK)
    const pixels = new Uint8ClampedArray(core.bytes(at, bytes))
    core.c.release(at)
    return { pixels, width, height }
  }

  /** Returns the edited scene as the bytes of an .fxs file. */
  write() {
    const core = this.#core
    const bytes = core.c.edit_bytes(this.#at) >>> 0
    const at = core.place(core.c.allocate(bytes))
    core.c.edit_write(this.#at, at)
    const written = core.bytes(at, bytes).slice()
    core.c.release(at)
    return written
  }

  free() {
    if (this.#at) this.#core.c.edit_close(this.#at)
    this.#at = 0
  }
}
