// What webgl.mjs asks of fixsplat/playcanvas.
import assert from 'node:assert/strict'
import { checkWalls, EYE, HEIGHT, keepPictures, PAGE, seen, WIDTH } from './engines.mjs'
import { frame, hashOf, runIn } from './screens.mjs'

/** What pages with an application need. */
const STAGE = `const pc = await import('playcanvas'), { Splats, viewOf } = await import('fixsplat/playcanvas')
  ${PAGE}
  async function appOf(how = {}) {
    const canvas = Object.assign(document.createElement('canvas'), { width, height })
    const graphicsDevice = await pc.createGraphicsDevice(canvas, { deviceTypes: [pc.DEVICETYPE_WEBGL2], ...how })
    const app = new pc.AppBase(canvas)
    app.init(Object.assign(new pc.AppOptions(), {
      graphicsDevice,
      componentSystems: [pc.CameraComponentSystem, pc.RenderComponentSystem],
    }))
    app.autoRender = false
    return app
  }
  function cameraOf(app, how = {}) {
    const camera = new pc.Entity('camera', app)
    camera.addComponent('camera', { fov: 50, nearClip: 0.1, farClip: 100, clearColor: new pc.Color(0, 0, 0), ...how })
    app.root.addChild(camera)
    camera.setPosition(0, 1, 4)
    camera.lookAt(0, 0, 0)
    return camera
  }
  function draw(app) {
    app.renderNextFrame = true
    app.tick()
    return bytesOf(app.graphicsDevice.canvas)
  }
  /** An orange wall that faces the camera, so that all of it has one depth. */
  function wall(app, camera, distance, how = {}) {
    const material = new pc.StandardMaterial()
    Object.assign(material, { useLighting: false, emissive: new pc.Color(1, 0.5, 0.25), ...how })
    material.update()
    const mesh = new pc.Entity('wall', app), side = camera.camera.projection ? 1.6 : 0.4 * distance
    mesh.addComponent('render', { type: 'plane', material })
    app.root.addChild(mesh)
    mesh.setPosition(camera.getPosition().add(camera.forward.clone().mulScalar(distance)))
    mesh.setRotation(camera.getRotation().clone().mul(new pc.Quat().setFromEulerAngles(90, 0, 0)))
    mesh.setLocalScale(side, 1, side)
    return mesh
  }
  const rendered = (all, camera) => hash(render(all.map(({ placed }) => placed), viewOf(camera.camera, width, height), { width, height }))`

export const playcanvasTests = (browser) => ({
  async 'PlayCanvas: try'() {
    const { hashes, pictures, most } = await runIn(browser, 'mesh', `${STAGE}
      const hashes = {}
      const app = await appOf(), camera = cameraOf(app), splats = await Splats.load(app, '/work/knot.fxs')
      app.root.addChild(splats)
      const bytes = draw(app)
      hashes.alone = hash(bytes)
      await keep('pc-alone', app.graphicsDevice.canvas)
      hashes.rendered = rendered([splats], camera)
      const wanted = render([splats.placed], viewOf(camera.camera, width, height), { width, height })
      const most = apart(bytes, wanted)
      const w = wall(app, camera, 4.03)
      draw(app)
      await keep('pc-wall', app.graphicsDevice.canvas)
      return { hashes, pictures, most }`)
    keepPictures(pictures)
    console.log(hashes, hashOf(seen), most)
  },
})
