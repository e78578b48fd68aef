// An object of three.js that stands in its scenes: Gaussians that meshes hide and that hide meshes, by a WebGLRenderer
// or a WebGPURenderer. three.d.ts describes it.

import {
  Box3, BufferAttribute, BufferGeometry, ColorManagement, DepthTexture, ExternalTexture, FloatType,
  LinearSRGBColorSpace, Mesh, NoBlending, Quaternion, RenderTarget, ShaderMaterial, Vector2, Vector3, Vector4,
} from 'three'
import { load, pick, Scene, Screen } from './fixsplat.js'

const ALIKE = 1e-4              // what scales of x, y and z may differ by, of themselves
const RAY = 1000                // pixels a radian of the picture of one pixel that a ray without a camera picks from
const EVEN = { transparent: true, depthTest: false, depthWrite: false, fog: false, toneMapped: false }

// ---- Cameras and objects --------------------------------------------------------------------------------------

const columns = (matrix) => {
  const axes = [new Vector3(), new Vector3(), new Vector3()]
  matrix.extractBasis(...axes)
  return axes.map((axis) => axis.normalize())
}

/** A camera of three.js as a Pinhole. Planes of an orthographic one may lie behind it, so that it is moved back until
    the near one is at 1. */
export function viewOf({ matrixWorld, projectionMatrix, near }, width, height) {
  const p = projectionMatrix.elements
  const orthographic = p[15] === 1
  const back = orthographic ? 1 - near : 0
  const [x, y, z] = columns(matrixWorld)
  const position = new Vector3().setFromMatrixPosition(matrixWorld).addScaledVector(z, back)
  return {
    rotation: ['x', 'y', 'z'].map((row) => [x[row], -y[row], -z[row]]),
    position: position.toArray(),
    fx: (p[0] * width) / 2,
    fy: (p[5] * height) / 2,
    cx: (width / 2) * (1 + (orthographic ? p[12] : -p[8])),
    cy: (height / 2) * (1 + (orthographic ? -p[13] : p[9])),
    near: near + back,
    orthographic,
  }
}

/** The distances that its depth buffer has for 0 and 1. */
function planesOf({ near, far, reversedDepth }, view) {
  const planes = [view.near, far + view.near - near]
  return reversedDepth ? planes.reverse() : planes
}

/** The same of a ray: a picture of one pixel. */
function viewOfRay({ origin, direction }, near) {
  const z = direction.clone().normalize()
  const x = new Vector3(Math.abs(z.y) > 0.9 ? 1 : 0, Math.abs(z.y) > 0.9 ? 0 : 1, 0).cross(z).normalize()
  const y = z.clone().cross(x)
  const rotation = ['x', 'y', 'z'].map((row) => [x[row], y[row], z[row]])
  return { rotation, position: origin.toArray(), fx: RAY, cx: 0.5, cy: 0.5, near }
}

/** Whether a camera sees along a ray, as one that Raycaster.setFromCamera made. */
function seesAlong({ matrixWorld, projectionMatrix }, { origin, direction }) {
  const position = new Vector3().setFromMatrixPosition(matrixWorld)
  if (projectionMatrix.elements[15] !== 1) return position.distanceTo(origin) <= 1e-6 * (1 + origin.length())
  return columns(matrixWorld)[2].dot(direction) < -1 + 1e-6
}

function rootOf(object) {
  while (object.parent) object = object.parent
  return object
}

/** Whether it and all that it lies in are visible. */
function isVisible(object) {
  while (object?.visible) object = object.parent
  return !object
}

// ---- Stages ---------------------------------------------------------------------------------------------------

/** The picture of all Splats of a renderer that a scene has, and the material by which three.js shows it. */
class Stage {
  splats = new Set()
  users = 0
  width = 0                     // of the last picture
  height = 0

  constructor(renderer, options) {
    this.renderer = renderer
    this.options = options
  }

  async open() {
    this.screen = await this.openScreen()
    this.material = await this.makeMaterial()
    return this
  }

  /** Those that a camera sees in the scene of one, in the order in which they were loaded. */
  seen(root, camera) {
    return [...this.splats].filter(
      (one) => rootOf(one) === root && isVisible(one) && camera.layers.test(one.layers))
  }

  /** Whether bytes are decoded to light for three.js, which encodes them again. */
  get decodes() {
    return ColorManagement.enabled || this.renderer.outputColorSpace !== LinearSRGBColorSpace
  }

  draw(seen, view, width, height, into) {
    const options = { ...seen[0].options, width, height, alpha: true, into }
    this.screen.draw(seen.map((one) => one.placed), view, options)
    Object.assign(this, { width, height })
  }

  close() {
    this.screen?.free()
    this.material.dispose()
  }
}

const stages = new WeakMap()

/** The stage of a renderer; `leave` closes it when nobody needs it. */
async function enter(renderer, options) {
  if (!renderer?.isWebGLRenderer && !renderer?.isWebGPURenderer)
    throw new Error('expected a WebGLRenderer or a WebGPURenderer of three.js')
  if (!stages.has(renderer)) {
    const stage = new (renderer.isWebGLRenderer ? WebGL : WebGPU)(renderer, options)
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

// ---- WebGL ----------------------------------------------------------------------------------------------------

const COVER = 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }'

// three.js encodes what comes out, and blends it as premultiplied colours. Into a target of light goes what makes that
// the sum of colours as they are shown.
const SHOW = `
uniform highp sampler2D picture;
uniform highp sampler2D behind;
uniform ivec2 corner;
uniform bool decodes;
uniform bool lights;
void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 colour = texelFetch(picture, at - corner, 0);
    if (lights) {
        vec3 rest = (1.0 - colour.a) * texelFetch(behind, at, 0).rgb;
        vec4 under = sRGBTransferOETF(vec4(max(texelFetch(behind, at, 0).rgb, 0.0), 1.0));
        vec4 shown = vec4(colour.rgb + (1.0 - colour.a) * under.rgb, 1.0);
        gl_FragColor = vec4(sRGBTransferEOTF(shown).rgb - rest, colour.a);
        return;
    }
    float coverage = max(colour.a, 1.0 / 255.0);
    gl_FragColor = vec4(colour.rgb / coverage, 1.0);
    if (decodes)
        gl_FragColor = sRGBTransferEOTF(gl_FragColor);
    #include <colorspace_fragment>
    gl_FragColor = vec4(gl_FragColor.rgb * coverage, colour.a);
}`

// A depth buffer of three.js as near / distance, and 0 where there is nothing.
const TURN_VERTEX = `#version 300 es
void main()
{
    gl_Position = vec4(float(gl_VertexID % 2) * 4.0 - 1.0, float(gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0);
}`
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
// A multisampled buffer, and one of depths, is copied to one of its own format, which a canvas does not say.
const DEPTHS = ['DEPTH24_STENCIL8', 'DEPTH_COMPONENT24', 'DEPTH_COMPONENT32F', 'DEPTH_COMPONENT16', 'DEPTH32F_STENCIL8']
const COLOURS = ['RGBA16F', 'RGBA8', 'RGBA32F', 'SRGB8_ALPHA8', 'R11F_G11F_B10F', 'RGB10_A2']

/** Runs with the state of a context that three.js does not know to be changed. */
function keeping(gl, run) {
  const get = (name) => gl.getParameter(gl[name])
  const unit = get('ACTIVE_TEXTURE')
  gl.activeTexture(gl.TEXTURE0)
  const names = ['CULL_FACE', 'DEPTH_TEST', 'SCISSOR_TEST', 'STENCIL_TEST']
  const enabled = names.map((name) => gl.isEnabled(gl[name]))
  const [texture, sampler, program, vertices, read, drawn, viewport, mask, func] =
    ['TEXTURE_BINDING_2D', 'SAMPLER_BINDING', 'CURRENT_PROGRAM', 'VERTEX_ARRAY_BINDING', 'READ_FRAMEBUFFER_BINDING',
     'DRAW_FRAMEBUFFER_BINDING', 'VIEWPORT', 'DEPTH_WRITEMASK', 'DEPTH_FUNC'].map(get)
  try {
    for (const name of names) gl.disable(gl[name])
    gl.bindSampler(0, null)
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
    gl.bindSampler(0, sampler)
    gl.bindTexture(gl.TEXTURE_2D, texture)
    gl.activeTexture(unit)
  }
}

/** A texture of a format that grows, and its framebuffer. */
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

/** Draws within a render of three.js, when the opaque meshes are there, whose depths it copies. */
class WebGL extends Stage {
  #gl
  #formats                      // of buffers that were copied, by their bits and framebuffers
  #picture
  #behind                       // copies of what three.js has drawn,
  #depths
  #turned                       // and its depths as near / distance
  #program
  #uniforms
  #textures = { picture: new ExternalTexture(), behind: new ExternalTexture() }
  #restored = () => this.#reopen()

  async openScreen() {
    this.#gl = this.renderer.getContext()
    const screen = await this.#take()
    this.#gl.canvas.addEventListener('webglcontextrestored', this.#restored)
    return screen
  }

  async #take() {
    const gl = this.#gl
    const screen = await Screen.open(gl.canvas, 'webgl2', this.options)
    ;[this.#picture, this.#behind, this.#depths, this.#turned] = Array.from({ length: 4 }, () => new Surface(gl))
    this.#formats = { [gl.COLOR_BUFFER_BIT]: new WeakMap(), [gl.DEPTH_BUFFER_BIT]: new WeakMap() }
    this.#makeProgram()
    return screen
  }

  /** After the context was lost: nothing that was in it is there. */
  async #reopen() {
    const { screen } = this
    this.screen = undefined
    screen?.free()
    const taken = await this.#take().catch(() => undefined)    // where it is lost again, until the next time
    if (this.users) this.screen = taken
    else taken?.free()
    for (const one of this.splats) one.dispatchEvent({ type: 'change' })
  }

  #makeProgram() {
    const gl = this.#gl
    this.#program = gl.createProgram()
    for (const [kind, text] of [[gl.VERTEX_SHADER, TURN_VERTEX], [gl.FRAGMENT_SHADER, TURN]]) {
      const shader = gl.createShader(kind)
      gl.shaderSource(shader, text)
      gl.compileShader(shader)
      gl.attachShader(this.#program, shader)
      gl.deleteShader(shader)
    }
    gl.linkProgram(this.#program)
    const names = ['corner', 'kind', 'planes', 'places']
    this.#uniforms = Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(this.#program, name)]))
  }

  makeMaterial() {
    const values = { ...this.#textures, corner: new Vector2(), decodes: true, lights: false }
    const uniforms = Object.fromEntries(Object.entries(values).map(([name, value]) => [name, { value }]))
    const shaders = { vertexShader: COVER, fragmentShader: SHOW }
    return new ShaderMaterial({ uniforms, ...shaders, ...EVEN, premultipliedAlpha: true })
  }

  /** Called by each Splats where three.js draws it. The first one draws the picture of all. */
  show(one, scene, camera, material) {
    if (material !== this.material || !this.screen) return false
    const seen = this.seen(rootOf(one), camera)
    if (seen[0] !== one) return false
    const [x, y, width, height] = this.#gl.getParameter(this.#gl.VIEWPORT)
    if (!(width > 0 && height > 0)) return false
    const view = viewOf(camera, width, height)
    const lights = this.decodes && this.#isLight
    const depth = keeping(this.#gl, (framebuffer) => {
      this.#gl.bindFramebuffer(this.#gl.READ_FRAMEBUFFER, framebuffer)
      this.#picture.reserve('RGBA8', width, height)
      if (lights) this.#copy(framebuffer, this.#behind, COLOURS, this.#gl.COLOR_BUFFER_BIT)
      return this.#takeDepths(framebuffer, [x, y, width, height], camera, view)
    })
    this.draw(seen, view, width, height, { framebuffer: this.#picture.framebuffer, depth })
    this.#textures.picture.sourceTexture = this.#picture.texture
    this.#textures.behind.sourceTexture = this.#behind.texture
    material.uniforms.corner.value.set(x, y)
    material.uniforms.decodes.value = this.decodes
    material.uniforms.lights.value = lights
    material.uniformsNeedUpdate = true
    return true
  }

  /** Whether three.js draws light now, which it encodes later. */
  get #isLight() {
    const target = this.renderer.getRenderTarget()
    return target ? !target.isXRRenderTarget : this.renderer.outputColorSpace === LinearSRGBColorSpace
  }

  #takeDepths(framebuffer, [x, y, width, height], camera, view) {
    const gl = this.#gl
    if (!this.#hasDepths(framebuffer)) return undefined
    this.#copy(framebuffer, this.#depths, DEPTHS, gl.DEPTH_BUFFER_BIT)
    this.#turned.reserve('DEPTH_COMPONENT32F', width, height)
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, this.#turned.framebuffer)
    gl.viewport(0, 0, width, height)
    gl.enable(gl.DEPTH_TEST)
    gl.depthFunc(gl.ALWAYS)
    gl.depthMask(true)
    gl.useProgram(this.#program)
    gl.bindVertexArray(null)
    gl.bindTexture(gl.TEXTURE_2D, this.#depths.texture)
    const { logarithmicDepthBuffer } = this.renderer.capabilities
    const kind = view.orthographic ? ORTHOGRAPHIC : logarithmicDepthBuffer ? LOGARITHMIC : PERSPECTIVE
    gl.uniform2i(this.#uniforms.corner, x, y)
    gl.uniform1i(this.#uniforms.kind, kind)
    gl.uniform2f(this.#uniforms.planes, ...planesOf(camera, view))
    gl.uniform3f(this.#uniforms.places, view.near, camera.far, camera.reversedDepth ? 0 : 1)
    gl.drawArrays(gl.TRIANGLES, 0, 3)
    return { texture: this.#turned.texture, planes: [Infinity, view.near] }
  }

  #hasDepths(framebuffer) {
    const gl = this.#gl
    if (!framebuffer) return gl.getContextAttributes().depth
    const [target, kind] = [gl.READ_FRAMEBUFFER, gl.FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE]
    return gl.getFramebufferAttachmentParameter(target, gl.DEPTH_ATTACHMENT, kind) !== gl.NONE
  }

  /** Copies a buffer of the framebuffer that is read. Multisampled ones are copied whole. */
  #copy(framebuffer, surface, formats, bit) {
    const gl = this.#gl
    const { width, height } =
      this.renderer.getRenderTarget() ?? { width: gl.drawingBufferWidth, height: gl.drawingBufferHeight }
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
    if (!found) throw new Error('what is drawn already cannot be copied here: render into a WebGLRenderTarget')
    known.set(key, found)
  }

  async update() {}

  close() {
    super.close()
    this.#gl.canvas.removeEventListener('webglcontextrestored', this.#restored)
    for (const surface of [this.#picture, this.#behind, this.#depths, this.#turned]) surface.free()
    this.#gl.deleteProgram(this.#program)
  }
}

// ---- WebGPU ---------------------------------------------------------------------------------------------------

/** Draws before a render of three.js, behind depths of its own, as a frame is whole only when the device says so. */
class WebGPU extends Stage {
  #depths
  #texture
  #nodes
  #turn = Promise.resolve()     // the update that is under way

  async openScreen() {
    if (!this.renderer.backend.device) await this.renderer.init()
    const { device } = this.renderer.backend
    if (!device) throw new Error('the WebGPURenderer has no WebGPU here: a WebGLRenderer can draw Splats')
    return Screen.open(null, 'webgpu', { ...this.options, device })
  }

  /** What is behind is read, so that it is blended as the scene is: as it is shown, not as light. */
  async makeMaterial() {
    const { NodeMaterial } = await import('three/webgpu')
    const { ivec2, positionGeometry, screenCoordinate, select, sRGBTransferEOTF, sRGBTransferOETF, textureLoad, uniform,
            vec4, viewportTexture } = await import('three/tsl')
    this.#texture = this.#makeTexture(1, 1)
    const corner = uniform(new Vector2())
    const decodes = uniform(1, 'uint')
    const picture = textureLoad(this.#texture, ivec2(screenCoordinate.sub(corner)))
    const behind = viewportTexture()
    const isLight = decodes.notEqual(0)
    const shown = select(isLight, sRGBTransferOETF(behind.rgb), behind.rgb)
    const colour = picture.rgb.add(shown.mul(picture.a.oneMinus()))
    const coverage = picture.a.add(behind.a.mul(picture.a.oneMinus()))
    const material = Object.assign(new NodeMaterial(), { ...EVEN, blending: NoBlending, lights: false })
    material.vertexNode = vec4(positionGeometry.xy, 0, 1)
    material.fragmentNode = vec4(select(isLight, sRGBTransferEOTF(colour), colour), coverage)
    this.#nodes = { corner, decodes, picture, behind }
    return material
  }

  #makeTexture(width, height) {
    const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING
    const how = { size: [width, height], format: 'rgba8unorm', usage }
    return Object.assign(new ExternalTexture(this.renderer.backend.device.createTexture(how)), {
      generateMipmaps: false,
    })
  }

  show(one, scene, camera, material) {
    return material === this.material && !scene.overrideMaterial && this.width > 0 &&
           this.seen(rootOf(one), camera)[0] === one
  }

  /** One after the other: textures are used until a frame is finished. */
  update(one, camera) {
    const turn = this.#turn.catch(() => {}).then(() => this.#update(rootOf(one), camera))
    this.#turn = turn
    return turn
  }

  async #update(root, camera) {
    if (!this.users) return
    if (root.matrixWorldAutoUpdate) root.updateMatrixWorld()
    if (!camera.parent && camera.matrixWorldAutoUpdate) camera.updateMatrixWorld()
    const seen = this.seen(root, camera)
    const [x, y, width, height] = this.#viewport()
    if (!seen.length || !(width > 0 && height > 0)) return
    const depth = this.#drawDepths(root, camera, width, height)
    const view = viewOf(camera, width, height)
    depth.planes = planesOf(camera, view)
    depth.linear = view.orthographic
    const isKept = this.#texture.sourceTexture.width === width && this.#texture.sourceTexture.height === height
    const texture = isKept ? this.#texture : this.#makeTexture(width, height)
    try {
      this.draw(seen, view, width, height, { texture: texture.sourceTexture, depth })
      await this.screen.finish()
    } catch (error) {
      if (!isKept) texture.sourceTexture.destroy()
      if (this.users) throw error
      return
    }
    if (!isKept) this.#drop(texture)
    this.#nodes.corner.value.set(x, y)
    this.#nodes.decodes.value = this.decodes ? 1 : 0
  }

  /** Another texture in the place of the one that is shown. */
  #drop(texture) {
    this.#texture.sourceTexture.destroy()
    this.#texture.dispose()
    this.#texture = this.#nodes.picture.value = texture
  }

  #viewport() {
    const { renderer } = this
    const target = renderer.getRenderTarget()
    const of = target ? target.viewport : renderer.getViewport(new Vector4()).multiplyScalar(renderer.getPixelRatio())
    return of.toArray().map(Math.floor)
  }

  /** The meshes alone, for their depths. */
  #drawDepths(root, camera, width, height) {
    const { renderer } = this
    if (renderer.logarithmicDepthBuffer)
      throw new Error('Splats with WebGPU need a depth buffer that is not logarithmic')
    this.#depths ??= new RenderTarget(width, height, { depthTexture: new DepthTexture(width, height, FloatType) })
    this.#depths.setSize(width, height)
    const [target, face, level] =
      [renderer.getRenderTarget(), renderer.getActiveCubeFace(), renderer.getActiveMipmapLevel()]
    const { transparent, autoClear } = renderer
    const outputs = renderer.getMRT()
    try {
      Object.assign(renderer, { transparent: false, autoClear: true })
      renderer.setMRT(null)
      renderer.setRenderTarget(this.#depths)
      renderer.render(root, camera)
    } finally {
      Object.assign(renderer, { transparent, autoClear })
      renderer.setMRT(outputs)
      renderer.setRenderTarget(target, face, level)
    }
    return { texture: renderer.backend.get(this.#depths.depthTexture).texture }
  }

  close() {
    super.close()
    this.#depths?.dispose()
    this.#nodes.behind.value.dispose()
    this.#texture.sourceTexture.destroy()
    this.#texture.dispose()
  }
}

// ---- Splats ---------------------------------------------------------------------------------------------------

/** A triangle that covers the picture. */
function cover() {
  const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0])
  return new BufferGeometry().setAttribute('position', new BufferAttribute(corners, 3))
}

export class Splats extends Mesh {
  #stage
  #owners                       // of its scene, with its clones: { count }; none where that is the caller's
  isSplats = true
  opacity = 1
  tint = [1, 1, 1]
  crops = []
  options = {}
  turn = new Quaternion(1, 0, 0, 0)

  constructor(stage, scene, owners) {
    super(cover(), stage.material)
    this.type = 'Splats'
    this.frustumCulled = false
    this.scene = scene
    this.name = scene.name
    this.#stage = stage
    this.#owners = owners
    if (owners) owners.count++
    stage.splats.add(this)
  }

  static async load(renderer, source, options = {}) {
    const stage = await enter(renderer, options)
    try {
      let splats
      const changed = (error) => {
        options.paging?.changed?.(error)
        splats?.dispatchEvent({ type: 'change', error })
      }
      const paging = options.paging !== false && renderer.isWebGLRenderer && { ...options.paging, changed }
      const isGiven = source instanceof Scene
      const scene = isGiven ? source : await load(source, { ...options, paging })
      return (splats = new Splats(stage, scene, isGiven ? null : { count: 0 }))
    } catch (error) {
      leave(stage)
      throw error
    }
  }

  get boundingBox() {
    const { low, high } = this.scene
    const corners = [low, high].flatMap(([x]) => [low, high].flatMap(([, y]) => [low, high].map(([, , z]) =>
      new Vector3(x, y, z).applyQuaternion(this.turn))))
    return new Box3().setFromPoints(corners)
  }

  /** What fixsplat draws, where three.js has put it. */
  get placed() {
    const [translation, rotation, scale] = [new Vector3(), new Quaternion(), new Vector3()]
    this.matrixWorld.decompose(translation, rotation, scale)
    const { x, y, z } = scale
    if (!(Math.min(x, y, z) > 0 && Math.max(x, y, z) <= Math.min(x, y, z) * (1 + ALIKE)))
      throw new Error(`${this.name}: Splats have one scale, above 0, for x, y and z`)
    const q = rotation.multiply(this.turn)
    const { opacity, tint, crops } = this
    const where = { translation: translation.toArray(), rotation: [q.w, q.x, q.y, q.z], scale: x }
    return { scene: this.scene, ...where, opacity, tint, crops }
  }

  onBeforeRender(renderer, scene, camera, geometry, material) {
    if (renderer !== this.#stage?.renderer) throw new Error(`${this.name}: these Splats are of another renderer`)
    this.geometry.setDrawRange(0, this.#stage.show(this, scene, camera, material) ? 3 : 0)
  }

  async update(camera) {
    await this.#stage?.update(this, camera)
  }

  raycast({ ray, camera, near, far }, intersects) {
    if (!this.#stage) return
    const found = this.#pick(ray, camera, near)
    if (!found) return
    const point = new Vector3(...found.position)
    const distance = ray.origin.distanceTo(point)
    if (distance < near || distance > far) return
    intersects.push({ distance, point, object: this, index: found.gaussian })
  }

  #pick(ray, camera, near) {
    const { renderer } = this.#stage
    const { x: width, y: height } = this.#stage.width
      ? new Vector2(this.#stage.width, this.#stage.height)
      : renderer.getDrawingBufferSize(new Vector2())
    if (camera && seesAlong(camera, ray)) {
      const { x, y } = ray.at(1, new Vector3()).project(camera)
      const [column, row] = [Math.floor(((x + 1) / 2) * width), Math.floor(((1 - y) / 2) * height)]
      if (!(column >= 0 && row >= 0 && column < width && row < height)) return null
      return pick(column, row, [this.placed], viewOf(camera, width, height), { ...this.options, width, height })
    }
    const size = this.boundingBox.getSize(new Vector3()).length() * this.placed.scale
    const view = viewOfRay(ray, Math.max(near, size / 10000))
    return pick(0, 0, [this.placed], view, { ...this.options, width: 1, height: 1 })
  }

  copy(source, recursive) {
    const { geometry, material } = this
    super.copy(source, recursive)
    Object.assign(this, { geometry, material, opacity: source.opacity, tint: source.tint, crops: source.crops })
    this.options = { ...source.options }
    this.turn.copy(source.turn)
    return this
  }

  clone(recursive) {
    if (!this.#stage) throw new Error(`${this.name}: was disposed of`)
    this.#stage.users++
    return new Splats(this.#stage, this.scene, this.#owners).copy(this, recursive)
  }

  dispose() {
    if (!this.#stage) return
    this.removeFromParent()
    this.#stage.splats.delete(this)
    leave(this.#stage)
    this.#stage = undefined
    this.geometry.dispose()
    if (this.#owners && !--this.#owners.count) this.scene.free()
  }
}
