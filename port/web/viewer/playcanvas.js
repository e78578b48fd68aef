// The PlayCanvas adapter: a Splats object is a scene of Gaussians as an entity in PlayCanvas, on a device of WebGL 2.
// The class WebGLStage of placed.js draws the Gaussians during the render of each layer.

import {
  BLENDEQUATION_ADD, BLENDMODE_ONE, BLENDMODE_ONE_MINUS_SRC_ALPHA, BlendState, BoundingBox, Entity, GAMMA_NONE,
  LAYERID_WORLD, Mat4, Quat, Vec3,
} from 'playcanvas'
import * as placed from './placed.js'

const OVER = new BlendState(true, BLENDEQUATION_ADD, BLENDMODE_ONE, BLENDMODE_ONE_MINUS_SRC_ALPHA)
const xyz = ({ x, y, z }) => [x, y, z]

export const viewOf = ({ entity, projectionMatrix, nearClip }, width, height) =>
  placed.viewOf(entity.getWorldTransform().data, projectionMatrix.data, nearClip, width, height)

const boxOf = ({ x, y, z, w }, { width, height }) => [x * width, y * height, z * width, w * height].map(Math.floor)

// The picture of the Gaussians must be blended in display colours (with gamma), but a linear render target blends
// linear light. The shader therefore reads the colours behind the picture and writes the difference. PlayCanvas uses a
// gamma of 2.2.
const SHOW = `#version 300 es
precision highp float;
uniform highp sampler2D picture;
uniform highp sampler2D behind;
uniform ivec2 corner;
uniform bool lights;
out vec4 colour;
void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    colour = texelFetch(picture, at - corner, 0);
    if (lights) {
        vec3 under = max(texelFetch(behind, at, 0).rgb, 0.0);
        float rest = 1.0 - colour.a;
        colour.rgb = pow(colour.rgb + rest * pow(under, vec3(1.0 / 2.2)), vec3(2.2)) - rest * under;
    }
}`

class Stage extends placed.WebGLStage {
  #show
  #drawn = (camera, layer, isTransparent) => isTransparent && this.#draw(camera, layer)

  constructor(app, options) {
    super(app, options, app.graphicsDevice.canvas.getContext('webgl2'))
  }

  async open() {
    await super.open()
    this.renderer.scene.on('prerender:layer', this.#drawn)
    return this
  }

  makePrograms() {
    this.#show = placed.programOf(this.gl, SHOW, ['picture', 'behind', 'corner', 'lights'])
  }

  changed(one, error) {
    one.fire('change', error)
  }

  get target() {
    return this.renderer.graphicsDevice.getRenderTarget()
  }

  #draw(camera, layer) {
    const { renderer: { graphicsDevice: device, root, xr }, target } = this
    const seen = [...this.splats].filter((one) => one.enabled && one.root === root && one.layers.includes(layer.id))
    if (!seen.length || !this.screen || this.screen.lost || (xr?.active && xr.camera === camera.entity)) return
    if (target.flipY || target.colorBuffer?.srgb)
      throw new Error('Splats are not drawn into a render target with flipY or of sRGB colours')
    const box = boxOf(camera.rect, target)
    const [x, y, width, height] = box
    if (!(width > 0 && height > 0)) return
    const isLight = camera.gammaCorrection === GAMMA_NONE
    const planes = { near: camera.nearClip, far: camera.farClip }
    this.drawWithin(seen, viewOf(camera, width, height), planes, box, isLight)
    device.setViewport(...box)
    device.setScissor(...boxOf(camera.scissorRect, target))
    device.setBlendState(OVER)
    placed.keeping(this.gl, () => this.#cover(x, y, isLight))
  }

  #cover(x, y, isLight) {
    const { gl, picture, behind } = this
    const { program, uniforms } = this.#show
    const buffers = Array.from({ length: 8 }, (_, i) => gl.getParameter(gl.DRAW_BUFFER0 + i))
    const isOne = !(buffers[1] > gl.NONE)
    gl.enable(gl.SCISSOR_TEST)
    gl.useProgram(program)
    gl.bindVertexArray(null)
    gl.bindTexture(gl.TEXTURE_2D, picture.texture)
    gl.activeTexture(gl.TEXTURE1)
    gl.bindTexture(gl.TEXTURE_2D, isLight ? behind.texture : picture.texture)
    gl.uniform1i(uniforms.picture, 0)
    gl.uniform1i(uniforms.behind, 1)
    gl.uniform2i(uniforms.corner, x, y)
    gl.uniform1i(uniforms.lights, isLight)
    if (!isOne) gl.drawBuffers(buffers.slice(0, 1))
    gl.drawArrays(gl.TRIANGLES, 0, 3)
    if (!isOne) gl.drawBuffers(buffers)
  }

  close() {
    super.close()
    this.renderer.scene?.off('prerender:layer', this.#drawn)
    this.gl.deleteProgram(this.#show.program)
  }
}

export class Splats extends Entity {
  #stage
  // { count }: the number of entities that share the scene; null: the caller owns the scene
  #owners
  isSplats = true
  opacity = 1
  tint = [1, 1, 1]
  crops = []
  time = 0
  options = {}
  layers = [LAYERID_WORLD]
  turn = new Quat(1, 0, 0, 0)

  static async load(app, source, options = {}) {
    if (!app?.graphicsDevice?.isWebGL2) throw new Error('expected an application of PlayCanvas with WebGL 2')
    const make = () => new Stage(app, options)
    return placed.loadFor(app, make, source, options, (...of) => new Splats(of[1].name, app).#enter(...of))
  }

  #enter(stage, scene, owners) {
    this.scene = scene
    this.#stage = stage
    this.#owners = owners
    stage.add(this, owners)
    return this
  }

  get aabb() {
    const box = new BoundingBox()
    box.setMinMax(...[this.scene.low, this.scene.high].map((corner) => new Vec3(...corner)))
    const turned = new Mat4().setTRS(Vec3.ZERO, this.turn, Vec3.ONE)
    box.setFromTransformedAabb(box.clone(), turned.mul2(this.getWorldTransform(), turned))
    return box
  }

  get placed() {
    const world = this.getWorldTransform()
    const { x, y, z, w } = new Quat().setFromMat4(world).mul(this.turn)
    const scale = world.getScale().mulScalar(world.scaleSign)
    return placed.placedOf(this, xyz(world.getTranslation()), [x, y, z, w], xyz(scale))
  }

  raycast({ origin, direction }, camera) {
    if (!this.#stage) return null
    const { graphicsDevice } = this.#stage.renderer
    const [, , width, height] = camera ? boxOf(camera.rect, camera.renderTarget ?? graphicsDevice) : []
    const view = camera && viewOf(camera, width, height)
    const along = { origin: xyz(origin), direction: xyz(direction) }
    const hit = placed.hitOf(this.placed, along, view, { ...this.options, width, height }, 0, Infinity)
    return hit && { ...hit, point: new Vec3(...hit.point) }
  }

  _cloneRecursively(ids) {
    if (!this.#stage) throw new Error(`${this.name}: was destroyed`)
    const { opacity, tint, crops, time, options, layers } = this
    const clone = super._cloneRecursively(ids)
    Object.assign(clone, { opacity, tint, crops, time, options: { ...options }, layers })
    clone.turn.copy(this.turn)
    this.#stage.users++
    return clone.#enter(this.#stage, this.scene, this.#owners)
  }

  destroy() {
    const stage = this.#stage
    this.#stage = undefined
    super.destroy()
    stage?.remove(this, this.#owners)
  }
}
