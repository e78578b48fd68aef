// The three.js adapter: a Splats object is a scene of Gaussians as an object of three.js. With a WebGLRenderer, the
// picture of the Gaussians is drawn during the render. With a WebGPURenderer, `update` draws the picture before the
// render.

import {
  Box3, BufferAttribute, BufferGeometry, ColorManagement, DepthTexture, ExternalTexture, FloatType,
  LinearSRGBColorSpace, Mesh, NoBlending, Quaternion, RenderTarget, ShaderMaterial, Vector2, Vector3, Vector4,
} from 'three'
import { Screen } from 'fixsplat'
import * as placed from './placed.js'

const EVEN = { transparent: true, depthTest: false, depthWrite: false, fog: false, toneMapped: false }

export const viewOf = ({ matrixWorld, projectionMatrix, near }, width, height) =>
  placed.viewOf(matrixWorld.elements, projectionMatrix.elements, near, width, height)

function rootOf(object) {
  while (object.parent) object = object.parent
  return object
}

function isVisible(object) {
  while (object?.visible) object = object.parent
  return !object
}

const seenOf = (stage, root, camera) =>
  [...stage.splats].filter((one) => rootOf(one) === root && isVisible(one) && camera.layers.test(one.layers))

const isDecoded = ({ outputColorSpace }) => ColorManagement.enabled || outputColorSpace !== LinearSRGBColorSpace

const changed = (one, error) => one.dispatchEvent({ type: 'change', error })

// ---- WebGL ----------------------------------------------------------------------------------------------------

const COVER = 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }'

// The picture of the Gaussians must be blended in sRGB, but a linear render target blends linear light. The shader
// therefore reads the colours behind the picture and writes the difference.
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

class WebGL extends placed.WebGLStage {
  changed = changed
  #textures = { picture: new ExternalTexture(), behind: new ExternalTexture() }

  constructor(renderer, options) {
    super(renderer, options, renderer.getContext())
    const values = { ...this.#textures, corner: new Vector2(), decodes: true, lights: false }
    const uniforms = Object.fromEntries(Object.entries(values).map(([name, value]) => [name, { value }]))
    const shaders = { vertexShader: COVER, fragmentShader: SHOW }
    this.material = new ShaderMaterial({ uniforms, ...shaders, ...EVEN, premultipliedAlpha: true })
  }

  get target() {
    return this.renderer.getRenderTarget()
  }

  show(one, scene, camera, material) {
    if (material !== this.material || !this.screen) return false
    const seen = seenOf(this, rootOf(one), camera)
    if (seen[0] !== one) return false
    const [x, y, width, height] = this.gl.getParameter(this.gl.VIEWPORT)
    if (!(width > 0 && height > 0)) return false
    const { near, far, reversedDepth } = camera
    const how = { near, far, reversedDepth, isLogarithmic: this.renderer.capabilities.logarithmicDepthBuffer }
    const lights = isDecoded(this.renderer) && this.#isLight
    this.drawWithin(seen, viewOf(camera, width, height), how, [x, y, width, height], lights)
    this.#textures.picture.sourceTexture = this.picture.texture
    this.#textures.behind.sourceTexture = this.behind.texture
    material.uniforms.corner.value.set(x, y)
    material.uniforms.decodes.value = isDecoded(this.renderer)
    material.uniforms.lights.value = lights
    material.uniformsNeedUpdate = true
    return true
  }

  get #isLight() {
    const { target } = this
    return target ? !target.isXRRenderTarget : this.renderer.outputColorSpace === LinearSRGBColorSpace
  }

  async update() {}

  close() {
    super.close()
    this.material.dispose()
  }
}

// ---- WebGPU ---------------------------------------------------------------------------------------------------

/** Draws the picture of the Gaussians before a WebGPURenderer's render, since WebGPU reports only later that a frame is
    complete. */
class WebGPU extends placed.Stage {
  changed = changed
  takesParts = false
  #depths
  #texture
  #nodes
  #turn = Promise.resolve()

  async open() {
    if (!this.renderer.backend.device) await this.renderer.init()
    const { device } = this.renderer.backend
    if (!device) throw new Error('the WebGPURenderer has no WebGPU here: a WebGLRenderer can draw Splats')
    this.screen = await Screen.open(null, 'webgpu', { ...this.options, device })
    this.material = await this.#makeMaterial()
  }

  async #makeMaterial() {
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
           seenOf(this, rootOf(one), camera)[0] === one
  }

  /** Draws the picture of the Gaussians for a camera. Calls of `update` run one after the other, since a frame uses the
      textures until it is finished. */
  update(one, camera) {
    const turn = this.#turn.catch(() => {}).then(() => this.#update(rootOf(one), camera))
    this.#turn = turn
    return turn
  }

  async #update(root, camera) {
    if (!this.users) return
    if (root.matrixWorldAutoUpdate) root.updateMatrixWorld()
    if (!camera.parent && camera.matrixWorldAutoUpdate) camera.updateMatrixWorld()
    const seen = seenOf(this, root, camera)
    const [x, y, width, height] = this.#viewport()
    if (!seen.length || !(width > 0 && height > 0)) return
    const depth = this.#drawDepths(root, camera, width, height)
    const view = viewOf(camera, width, height)
    depth.planes = placed.planesOf(camera, view)
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
    this.#nodes.decodes.value = isDecoded(this.renderer) ? 1 : 0
  }

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
    this.material.dispose()
    this.#depths?.dispose()
    this.#nodes.behind.value.dispose()
    this.#texture.sourceTexture.destroy()
    this.#texture.dispose()
  }
}

// ---- Splats ---------------------------------------------------------------------------------------------------

function cover() {
  const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0])
  return new BufferGeometry().setAttribute('position', new BufferAttribute(corners, 3))
}

export class Splats extends Mesh {
  #stage
  #owners
  isSplats = true
  opacity = 1
  tint = [1, 1, 1]
  crops = []
  time = 0
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
    stage.add(this, owners)
  }

  static async load(renderer, source, options = {}) {
    if (!renderer?.isWebGLRenderer && !renderer?.isWebGPURenderer)
      throw new Error('expected a WebGLRenderer or a WebGPURenderer of three.js')
    const make = () => new (renderer.isWebGLRenderer ? WebGL : WebGPU)(renderer, options)
    return placed.loadFor(renderer, make, source, options, (...of) => new Splats(...of))
  }

  get boundingBox() {
    const { low, high } = this.scene
    const corners = [low, high].flatMap(([x]) => [low, high].flatMap(([, y]) => [low, high].map(([, , z]) =>
      new Vector3(x, y, z).applyQuaternion(this.turn))))
    return new Box3().setFromPoints(corners)
  }

  get placed() {
    const [translation, rotation, scale] = [new Vector3(), new Quaternion(), new Vector3()]
    this.matrixWorld.decompose(translation, rotation, scale)
    return placed.placedOf(this, translation.toArray(), rotation.multiply(this.turn).toArray(), scale.toArray())
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
    const { width, height } = this.#stage.width ? this.#stage : this.#stage.renderer.getDrawingBufferSize(new Vector2())
    const along = { origin: ray.origin.toArray(), direction: ray.direction.toArray() }
    const isSeen = camera && placed.seesAlong(camera.matrixWorld.elements, camera.projectionMatrix.elements, along)
    const view = isSeen ? viewOf(camera, width, height) : undefined
    const hit = placed.hitOf(this.placed, along, view, { ...this.options, width, height }, near, far)
    if (hit) intersects.push({ ...hit, point: new Vector3(...hit.point), object: this })
  }

  copy(source, recursive) {
    const { geometry, material } = this
    super.copy(source, recursive)
    const { opacity, tint, crops, time } = source
    Object.assign(this, { geometry, material, opacity, tint, crops, time })
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
    this.#stage.remove(this, this.#owners)
    this.#stage = undefined
    this.geometry.dispose()
  }
}
