// Draws a PlayCanvas mesh among Gaussians with one WebGPU device. The page needs an import map for `playcanvas` and
// `fixsplat`, and a <canvas>.
import * as pc from 'playcanvas'
import { load, Screen } from 'fixsplat'

const FOV = 50
const [NEAR, FAR] = [0.1, 100]

function targetOf(graphicsDevice, width, height) {
  const textureOf = (format) => new pc.Texture(graphicsDevice, { width, height, format, mipmaps: false })
  const [colorBuffer, depthBuffer] = [graphicsDevice.backBufferFormat, pc.PIXELFORMAT_DEPTH].map(textureOf)
  return new pc.RenderTarget({ colorBuffer, depthBuffer })
}

/** Opens a scene on a canvas. `draw` shows one picture. */
export async function open(canvas, address) {
  const { width, height } = canvas
  const how = { deviceTypes: [pc.DEVICETYPE_WEBGPU], antialias: false }
  const graphicsDevice = await pc.createGraphicsDevice(canvas, how)
  const app = new pc.AppBase(canvas)
  app.init(Object.assign(new pc.AppOptions(), {
    graphicsDevice,
    componentSystems: [pc.CameraComponentSystem, pc.RenderComponentSystem],
  }))
  app.autoRender = false
  const target = targetOf(graphicsDevice, width, height)

  const material = new pc.StandardMaterial()
  Object.assign(material, { useLighting: false, emissive: new pc.Color(1, 0.5, 0) })
  material.update()
  const mesh = new pc.Entity()
  mesh.addComponent('render', { type: 'box', material })
  app.root.addChild(mesh)
  const camera = new pc.Entity()
  const clearColor = new pc.Color(0x20 / 255, 0x30 / 255, 0x40 / 255)
  camera.addComponent('camera', { fov: FOV, nearClip: NEAR, farClip: FAR, clearColor, renderTarget: target })
  app.root.addChild(camera)

  const screen = await Screen.open(null, 'webgpu', { device: graphicsDevice.wgpu })
  const scene = await load(address)
  const placed = [{ scene, rotation: [0, 1, 0, 0] }]         // flips y: a scene's y points down, PlayCanvas's y up
  const textureOf = (texture) => texture.impl.gpuTexture     // the WebGPU texture behind a PlayCanvas texture

  async function draw(eye, look) {
    camera.setPosition(...eye)
    camera.lookAt(...look)
    app.renderNextFrame = true
    app.tick()
    const depth = { texture: textureOf(target.depthBuffer), planes: [NEAR, FAR] }
    const into = { texture: textureOf(target.colorBuffer), depth, over: true }
    const view = { eye, look, up: [0, 1, 0], fov: FOV, near: NEAR }
    screen.draw(placed, view, { width, height, alpha: true, into })
    await screen.finish()
    graphicsDevice.frameStart()
    graphicsDevice.copyRenderTarget(target, null, true, false)
    graphicsDevice.frameEnd()
  }

  return { draw, mesh, app, target, screen, placed }
}
