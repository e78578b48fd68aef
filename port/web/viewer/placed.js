// Shared code of the three.js and PlayCanvas adapters. All Splats objects (scenes in an engine) that a camera sees are
// drawn as one picture. A matrix is 16 numbers in columns. The axes of an engine are x right, y up, z back.

import { load, pick, Scene, Screen } from 'fixsplat'

const ALIKE = 1e-4
const RAY = 1000

// ---- Cameras and rays -----------------------------------------------------------------------------------------

const plus = (a, b, times) => a.map((value, i) => value + times * b[i])
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
const lengthOf = (a) => Math.sqrt(dot(a, a))
const column = (matrix, i) => Array.from({ length: 3 }, (_, row) => matrix[4 * i + row])
const isOrthographic = (projection) => projection[15] === 1

function unit(a) {
  const length = lengthOf(a)
  return a.map((value) => value / length)
}

/** Converts the matrices of an engine's camera to a Pinhole camera of fixsplat. An orthographic camera is moved back,
    since its near plane may lie behind the camera. */
export function viewOf(world, projection, near, width, height) {
  const orthographic = isOrthographic(projection)
  const back = orthographic ? 1 - near : 0
  const [x, y, z] = [0, 1, 2].map((i) => unit(column(world, i)))
  return {
    rotation: [0, 1, 2].map((row) => [x[row], -y[row], -z[row]]),
    position: plus(column(world, 3), z, back),
    fx: (projection[0] * width) / 2,
    fy: (projection[5] * height) / 2,
    cx: (width / 2) * (1 + (orthographic ? projection[12] : -projection[8])),
    cy: (height / 2) * (1 + (orthographic ? -projection[13] : projection[9])),
    near: near + back,
    orthographic,
  }
}

export function planesOf({ near, far, reversedDepth }, view) {
  const planes = [view.near, far + view.near - near]
  return reversedDepth ? planes.reverse() : planes
}

function viewOfRay({ origin, direction }, near) {
  const z = unit(direction)
  const x = unit(cross(Math.abs(z[1]) > 0.9 ? [1, 0, 0] : [0, 1, 0], z))
  const y = cross(z, x)
  const rotation = [0, 1, 2].map((row) => [x[row], y[row], z[row]])
  return { rotation, position: origin, fx: RAY, cx: 0.5, cy: 0.5, near }
}

export function seesAlong(world, projection, { origin, direction }) {
  if (!isOrthographic(projection)) return lengthOf(plus(origin, column(world, 3), -1)) <= 1e-6 * (1 + lengthOf(origin))
  return dot(unit(column(world, 2)), direction) < -1 + 1e-6
}

function pixelOf({ rotation, position, fx, fy, cx, cy, orthographic }, point) {
  const [x, y, z] = [0, 1, 2].map((i) => dot(rotation.map((row) => row[i]), plus(point, position, -1)))
  const depth = orthographic ? 1 : z
  return [(fx * x) / depth + cx, (fy * y) / depth + cy].map(Math.floor)
}

export function hitOf(placed, ray, view, options, near, far) {
  const { width, height } = view ? options : { width: 1, height: 1 }
  const size = lengthOf(plus(placed.scene.high, placed.scene.low, -1)) * placed.scale
  const from = view ?? viewOfRay(ray, Math.max(near, size / 10000))
  const [x, y] = view ? pixelOf(view, plus(ray.origin, ray.direction, 1)) : [0, 0]
  if (!(x >= 0 && y >= 0 && x < width && y < height)) return null
  const found = pick(x, y, [placed], from, { ...options, width, height })
  if (!found) return null
  const distance = lengthOf(plus(found.position, ray.origin, -1))
  return distance < near || distance > far ? null : { distance, point: found.position, index: found.gaussian }
}

export function placedOf({ name, scene, opacity, tint, crops, time }, translation, [x, y, z, w], scale) {
  if (!(Math.min(...scale) > 0 && Math.max(...scale) <= Math.min(...scale) * (1 + ALIKE)))
    throw new Error(`${name}: Splats have one scale, above 0, for x, y and z`)
  return { scene, translation, rotation: [w, x, y, z], scale: scale[0], opacity, tint, crops, time }
}

// ---- Stages: all Splats of a renderer -------------------------------------------------------------------------

/** A Stage draws all Splats objects (scenes) of a renderer. A subclass has changed(one, error), which is called when an
    object has changed. */
export class Stage {
  splats = new Set()
  users = 0
  width = 0
  height = 0
  takesParts = true

  constructor(renderer, options) {
    this.renderer = renderer
    this.options = options
  }

  draw(seen, view, width, height, into) {
    const options = { ...seen[0].options, width, height, alpha: true, into }
    this.screen.draw(seen.map((one) => one.placed), view, options)
    Object.assign(this, { width, height })
  }

  /** Adds a Splats object. `owners` counts the objects that share a scene, and the last removed object frees the scene.
      If `owners` is null, the caller frees the scene. */
  add(one, owners) {
    if (owners) owners.count++
    this.splats.add(one)
  }

  remove(one, owners) {
    this.splats.delete(one)
    leave(this)
    if (owners && !--owners.count) one.scene.free()
  }

  close() {
    this.screen?.free()
  }
}

const stages = new WeakMap()

async function enter(renderer, make) {
  if (!stages.has(renderer)) {
    const stage = make()
    stages.set(renderer, { stage, opened: stage.open() })
  }
  const { stage, opened } = stages.get(renderer)
  stage.users++
  await opened.catch((error) => {
    stages.delete(renderer)
    throw error
  })
  return stage
}

function leave(stage) {
  if (--stage.users) return
  stages.delete(stage.renderer)
  stage.close()
}

export async function loadFor(renderer, makeStage, source, options, objectOf) {
  const stage = await enter(renderer, makeStage)
  try {
    let splats
    const changed = (error) => {
      options.paging?.changed?.(error)
      if (splats) stage.changed(splats, error)
    }
    const paging = options.paging !== false && stage.takesParts && { ...options.paging, changed }
    const isGiven = source instanceof Scene
    const scene = isGiven ? source : await load(source, { ...options, paging })
    return (splats = objectOf(stage, scene, isGiven ? null : { count: 0 }))
  } catch (error) {
    leave(stage)
    throw error
  }
}

// ---- WebGL ----------------------------------------------------------------------------------------------------

const COVER = `#version 300 es
void main()
{
    gl_Position = vec4(float(gl_VertexID % 2) * 4.0 - 1.0, float(gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0);
}`
// The fragment shader that converts each depth of a depth buffer to near / distance. 0 means that no geometry is at the
// pixel.
const TURN = `#version 300 es
precision highp float;
uniform highp sampler2D depths;
uniform ivec2 corner;
uniform int kind;
uniform vec2 planes;            // distances for a depth of 0 and 1
uniform vec3 places;            // the near plane, the camera's far, and the depth where nothing is
void main()
{
    float depth = texelFetch(depths, ivec2(gl_FragCoord.xy) + corner, 0).x;
    float near_by_z = kind == 0 ? mix(places.x / planes.x, places.x / planes.y, depth)
                    : kind == 1 ? places.x / mix(planes.x, planes.y, depth)
                                : places.x / (pow(places.y + 1.0, depth) - 1.0);
    gl_FragDepth = depth == places.z ? 0.0 : min(near_by_z, 1.0);
}`
const [PERSPECTIVE, ORTHOGRAPHIC, LOGARITHMIC] = [0, 1, 2]
// A copy of a multisampled buffer or of a depth buffer must have the format of the original. WebGL does not report the
// formats of a canvas, so these formats are tried in turn.
const DEPTHS = ['DEPTH24_STENCIL8', 'DEPTH_COMPONENT24', 'DEPTH_COMPONENT32F', 'DEPTH_COMPONENT16', 'DEPTH32F_STENCIL8']
const COLOURS = ['RGBA16F', 'RGBA8', 'RGBA32F', 'SRGB8_ALPHA8', 'R11F_G11F_B10F', 'RGB10_A2']

export function keeping(gl, run) {
  const get = (name) => gl.getParameter(gl[name])
  const unit = get('ACTIVE_TEXTURE')
  const units = [gl.TEXTURE1, gl.TEXTURE0].map((name) => {
    gl.activeTexture(name)
    return [name, get('TEXTURE_BINDING_2D'), get('SAMPLER_BINDING')]
  })
  const names = ['CULL_FACE', 'DEPTH_TEST', 'SCISSOR_TEST', 'STENCIL_TEST']
  const enabled = names.map((name) => gl.isEnabled(gl[name]))
  const [program, vertices, read, drawn, viewport, mask, func] =
    ['CURRENT_PROGRAM', 'VERTEX_ARRAY_BINDING', 'READ_FRAMEBUFFER_BINDING', 'DRAW_FRAMEBUFFER_BINDING', 'VIEWPORT',
     'DEPTH_WRITEMASK', 'DEPTH_FUNC'].map(get)
  try {
    for (const name of names) gl.disable(gl[name])
    units.forEach((_, i) => gl.bindSampler(i, null))
    return run(drawn)
  } finally {
    names.forEach((name, i) => enabled[i] && gl.enable(gl[name]))
    if (!enabled[1]) gl.disable(gl.DEPTH_TEST)
    gl.depthMask(mask)
    gl.depthFunc(func)
    gl.viewport(...viewport)
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, read)
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, drawn)
    gl.bindVertexArray(vertices)
    gl.useProgram(program)
    for (const [name, texture, sampler] of units) {
      gl.activeTexture(name)
      gl.bindTexture(gl.TEXTURE_2D, texture)
      gl.bindSampler(name - gl.TEXTURE0, sampler)
    }
    gl.activeTexture(unit)
  }
}

export function programOf(gl, text, names) {
  const program = gl.createProgram()
  for (const [kind, source] of [[gl.VERTEX_SHADER, COVER], [gl.FRAGMENT_SHADER, text]]) {
    const shader = gl.createShader(kind)
    gl.shaderSource(shader, source)
    gl.compileShader(shader)
    gl.attachShader(program, shader)
    gl.deleteShader(shader)
  }
  gl.linkProgram(program)
  return { program, uniforms: Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(program, name)])) }
}

class Surface {
  width = 0
  height = 0

  constructor(gl) {
    this.gl = gl
  }

  reserve(format, width, height) {
    const { gl } = this
    if (format === this.format && width <= this.width && height <= this.height) return
    const isSame = format === this.format
    this.free()
    this.format = format
    this.width = Math.max(width, isSame ? this.width : 0)
    this.height = Math.max(height, isSame ? this.height : 0)
    this.texture = gl.createTexture()
    gl.bindTexture(gl.TEXTURE_2D, this.texture)
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl[format], this.width, this.height)
    for (const side of ['TEXTURE_MIN_FILTER', 'TEXTURE_MAG_FILTER'])
      gl.texParameteri(gl.TEXTURE_2D, gl[side], gl.NEAREST)
    this.framebuffer = gl.createFramebuffer()
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, this.framebuffer)
    const part = /STENCIL/.test(format) ? 'DEPTH_STENCIL' : /DEPTH/.test(format) ? 'DEPTH' : 'COLOR'
    const attachment = gl[`${part}_ATTACHMENT${part === 'COLOR' ? 0 : ''}`]
    gl.framebufferTexture2D(gl.DRAW_FRAMEBUFFER, attachment, gl.TEXTURE_2D, this.texture, 0)
  }

  free() {
    if (!this.texture) return
    this.gl.deleteTexture(this.texture)
    this.gl.deleteFramebuffer(this.framebuffer)
    this.texture = this.format = undefined
  }
}

/** A WebGLStage draws Gaussians after the opaque meshes in an engine's render, and copies the depths of the meshes. A
    subclass has the render target `target`; undefined: the canvas. */
export class WebGLStage extends Stage {
  #formats
  #depths
  #turned
  #turn
  #restored = () => this.#reopen()

  constructor(renderer, options, gl) {
    super(renderer, options)
    this.gl = gl
  }

  async open() {
    this.screen = await this.#take()
    this.gl.canvas.addEventListener('webglcontextrestored', this.#restored)
    return this
  }

  async #take() {
    const { gl } = this
    const screen = await Screen.open(gl.canvas, 'webgl2', this.options)
    ;[this.picture, this.behind, this.#depths, this.#turned] = Array.from({ length: 4 }, () => new Surface(gl))
    this.#formats = { [gl.COLOR_BUFFER_BIT]: new WeakMap(), [gl.DEPTH_BUFFER_BIT]: new WeakMap() }
    this.#turn = programOf(gl, TURN, ['corner', 'kind', 'planes', 'places'])
    this.makePrograms?.()
    return screen
  }

  async #reopen() {
    const { screen } = this
    this.screen = undefined
    screen?.free()
    const taken = await this.#take().catch(() => undefined)
    if (this.users) this.screen = taken
    else taken?.free()
    for (const one of this.splats) this.changed(one)
  }

  /** Draws the Gaussians in a rectangle of the current render target to `picture`. Gaussians behind the depths of the
      render target are hidden. With isLight, also copies the render target's colours to `behind`. */
  drawWithin(seen, view, camera, [x, y, width, height], isLight) {
    const depth = keeping(this.gl, (framebuffer) => {
      this.gl.bindFramebuffer(this.gl.READ_FRAMEBUFFER, framebuffer)
      this.picture.reserve('RGBA8', width, height)
      if (isLight) this.#copy(framebuffer, this.behind, COLOURS, this.gl.COLOR_BUFFER_BIT)
      return this.#takeDepths(framebuffer, [x, y, width, height], camera, view)
    })
    this.draw(seen, view, width, height, { framebuffer: this.picture.framebuffer, depth })
  }

  #takeDepths(framebuffer, [x, y, width, height], camera, view) {
    const { gl } = this
    if (!this.#hasDepths(framebuffer)) return undefined
    this.#copy(framebuffer, this.#depths, DEPTHS, gl.DEPTH_BUFFER_BIT)
    this.#turned.reserve('DEPTH_COMPONENT32F', width, height)
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, this.#turned.framebuffer)
    gl.viewport(0, 0, width, height)
    gl.enable(gl.DEPTH_TEST)
    gl.depthFunc(gl.ALWAYS)
    gl.depthMask(true)
    gl.useProgram(this.#turn.program)
    gl.bindVertexArray(null)
    gl.bindTexture(gl.TEXTURE_2D, this.#depths.texture)
    const { uniforms } = this.#turn
    const kind = view.orthographic ? ORTHOGRAPHIC : camera.isLogarithmic ? LOGARITHMIC : PERSPECTIVE
    gl.uniform2i(uniforms.corner, x, y)
    gl.uniform1i(uniforms.kind, kind)
    gl.uniform2f(uniforms.planes, ...planesOf(camera, view))
    gl.uniform3f(uniforms.places, view.near, camera.far, camera.reversedDepth ? 0 : 1)
    gl.drawArrays(gl.TRIANGLES, 0, 3)
    return { texture: this.#turned.texture, planes: [Infinity, view.near] }
  }

  #hasDepths(framebuffer) {
    const { gl } = this
    if (!framebuffer) return gl.getContextAttributes().depth
    const [target, kind] = [gl.READ_FRAMEBUFFER, gl.FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE]
    return gl.getFramebufferAttachmentParameter(target, gl.DEPTH_ATTACHMENT, kind) !== gl.NONE
  }

  #copy(framebuffer, surface, formats, bit) {
    const { gl } = this
    const { width, height } = this.target ?? { width: gl.drawingBufferWidth, height: gl.drawingBufferHeight }
    const known = this.#formats[bit]
    const key = framebuffer ?? gl
    const copyAs = (format) => {
      surface.reserve(format, width, height)
      gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, surface.framebuffer)
      gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, bit, gl.NEAREST)
    }
    if (known.has(key)) return copyAs(known.get(key))
    while (gl.getError() && !gl.isContextLost());
    const found = formats.find((format) => {
      copyAs(format)
      return gl.getError() === gl.NO_ERROR
    })
    if (!found) throw new Error('what is drawn already cannot be copied here: render into a render target')
    known.set(key, found)
  }

  close() {
    super.close()
    const { gl } = this
    gl.canvas.removeEventListener('webglcontextrestored', this.#restored)
    for (const surface of [this.picture, this.behind, this.#depths, this.#turned]) surface.free()
    gl.deleteProgram(this.#turn.program)
  }
}
