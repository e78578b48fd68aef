// Checks the class Splats of the package entry fixsplat-viewer/playcanvas, which draws splats in PlayCanvas. For
// webgl.mjs.
import assert from 'node:assert/strict'
import { checkWalls, example, EYE, hashOfPlaced, HEIGHT, keepPictures, PAGE, seen, WIDTH } from './engines.mjs'
import { frame, hashOf, runIn } from './screens.mjs'

const STAGE = `const pc = await import('playcanvas'), { Splats, viewOf } = await import('fixsplat-viewer/playcanvas')
  ${PAGE}
  async function appOf(how = {}) {
    const canvas = Object.assign(document.createElement('canvas'), { width, height })
    const graphicsDevice = await pc.createGraphicsDevice(canvas, { deviceTypes: [pc.DEVICETYPE_WEBGL2], ...how })
    document.body.append(canvas)
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
  /** What is in a target, from its top row down. */
  async function readOf({ colorBuffer }) {
    const rows = await colorBuffer.read(0, 0, width, height, { immediate: true })
    return rows.map((_, i) => rows[4 * width * (height - 1 - Math.floor(i / (4 * width))) + (i % (4 * width))])
  }
  /** The walls of walled, in an application, into the canvas or a target. */
  const wallsOf = (app, splats, camera, target) =>
    walled(splats, viewOf(camera.camera, width, height), async (distance, isShown) => {
      splats.enabled = isShown
      const mesh = wall(app, camera, distance), bytes = draw(app)
      mesh.destroy()
      return target ? readOf(target) : bytes
    })`

const TWO = `const second = splats.clone()
  second.setPosition(0.7, 0.4, 0.5)
  second.setEulerAngles(0, 40, 0)
  second.setLocalScale(0.6, 0.6, 0.6)
  second.opacity = 0.75
  second.tint = [1, 0.5, 2]
  second.time = 0.5
  app.root.addChild(second)`
const placedIn = 'JSON.parse(JSON.stringify([splats, second].map(({ placed: { scene, ...how } }) => how)))'

const ALL = process.env.FXS_PROCESSORS === 'all'

const tests = (browser) => ({
  async 'PlayCanvas: the bytes of the command; a mesh before, behind and amid; a ray; two objects'() {
    const { hashes, found, placed, pictures } = await runIn(browser, 'mesh', `${STAGE}
      const app = await appOf({ antialias: true }), camera = cameraOf(app), hashes = {}, states = []
      // What PlayCanvas does not know to be changed: the state before and after the picture is drawn.
      const gl = app.graphicsDevice.canvas.getContext('webgl2')
      const names = ['ACTIVE_TEXTURE', 'TEXTURE_BINDING_2D', 'SAMPLER_BINDING', 'CURRENT_PROGRAM',
        'VERTEX_ARRAY_BINDING', 'READ_FRAMEBUFFER_BINDING', 'DRAW_FRAMEBUFFER_BINDING', 'DEPTH_WRITEMASK', 'DEPTH_FUNC',
        'CULL_FACE', 'DEPTH_TEST', 'SCISSOR_TEST', 'STENCIL_TEST', 'ARRAY_BUFFER_BINDING', 'UNPACK_FLIP_Y_WEBGL']
      const note = (_, layer, isTransparent) => layer.id === pc.LAYERID_WORLD && isTransparent &&
        states.push(names.map((name) => gl.getParameter(gl[name])))
      app.scene.on('prerender:layer', note)
      const splats = await Splats.load(app, '/work/knot.fxs')
      app.scene.on('prerender:layer', (...of) => note(...of))
      app.root.addChild(splats)
      hashes.alone = hash(draw(app))
      await keep('playcanvas-alone', app.graphicsDevice.canvas)
      const found = await wallsOf(app, splats, camera), mesh = wall(app, camera, 4.03)
      draw(app)
      await keep('playcanvas-wall', app.graphicsDevice.canvas)
      mesh.destroy()
      const [x, y] = [60, 40], [from, to] = [0.1, 100].map((z) => camera.camera.screenToWorld(x + 0.5, y + 0.5, z))
      const hit = splats.raycast(new pc.Ray(from, to.sub(from).normalize()), camera.camera)
      const wanted = splats.scene.pick(x, y, { eye: [0, -1, -4], look: [0, 0, 0], near: 0.1 }, { width, height })
      hashes.ray = hit.index === wanted.gaussian
      ${TWO}
      hashes.two = hash(draw(app))
      await keep('playcanvas-two', app.graphicsDevice.canvas)
      const placed = ${placedIn}
      hashes.kept = states.length > 4 && states.every((one, i) =>
        i % 2 === 0 || one.every((value, k) => value === states[i - 1][k]))
      second.destroy()
      hashes['one again'] = hash(draw(app))
      hashes.error = gl.getError()
      app.destroy()
      hashes.freed = splats.scene.isFreed
      return { hashes, found, placed, pictures }`)
    keepPictures(pictures)
    checkWalls('the canvas', found)
    const whole = hashOf(seen)
    assert.deepEqual(hashes, { alone: whole, ray: true, two: hashOfPlaced(placed), kept: true, 'one again': whole,
                               error: 0, freed: true })
    const { opacity, tint, time, scale } = placed[1]
    assert.deepEqual([opacity, tint, time, scale.toFixed(6)], [0.75, [1, 0.5, 2], 0.5, '0.600000'])
  },
})

const more = (browser) => ({
  async 'PlayCanvas: sizes, corners, several cameras, what is not seen, transparent meshes'() {
    const { hashes, pictures } = await runIn(browser, 'mesh', `${STAGE}
      const app = await appOf(), camera = cameraOf(app), hashes = {}, device = app.graphicsDevice
      const splats = await Splats.load(app, '/work/knot.fxs')
      app.root.addChild(splats)
      const take = (name) => (hashes[name] = hash(draw(app)))
      device.setResolution(80, 50)
      take('smaller')
      device.setResolution(width, height)
      // A part of a picture's bytes, 80 x 50 pixels.
      const cut = (bytes, left, top) => Uint8ClampedArray.from({ length: 4 * 80 * 50 },
        (_, i) => bytes[4 * (160 * (top + Math.floor(i / 320)) + left) + (i % 320)])
      camera.camera.rect = new pc.Vec4(0.125, 0.3, 0.5, 0.5)
      hashes.corner = hash(cut(draw(app), 20, 20))
      camera.camera.requestSceneDepthMap(true)
      hashes['in a pass of its own'] = hash(cut(draw(app), 20, 20))
      camera.camera.requestSceneDepthMap(false)
      const other = cameraOf(app, { rect: new pc.Vec4(0.5, 0, 0.5, 0.5), priority: 1 })
      camera.camera.rect = new pc.Vec4(0, 0.5, 0.5, 0.5)
      const both = draw(app)
      await keep('playcanvas-cameras', device.canvas)
      hashes['one camera'] = hash(cut(both, 0, 0))
      hashes['another camera'] = hash(cut(both, 80, 50))
      other.destroy()
      camera.camera.rect = new pc.Vec4(0, 0, 1, 1)
      const whole = draw(app)
      camera.camera.scissorRect = new pc.Vec4(0.25, 0, 0.5, 1)
      const within = draw(app)
      hashes.scissor = within.every((byte, i) => {
        const x = (i >> 2) % width
        return byte === (x >= 40 && x < 120 ? whole[i] : i % 4 < 3 ? 0 : byte)
      })
      camera.camera.scissorRect = new pc.Vec4(0, 0, 1, 1)
      const black = () => !draw(app).some((byte, i) => i % 4 < 3 && byte)
      splats.enabled = false
      hashes.disabled = black()
      splats.enabled = true
      const group = new pc.Entity('group', app)
      app.root.addChild(group)
      group.addChild(splats)
      take('in a group')
      group.enabled = false
      hashes['in what is disabled'] = black()
      group.enabled = true
      app.xr = { active: true, camera }
      hashes['in a headset'] = black()
      app.xr = null
      splats.remove()
      hashes['nowhere'] = black()
      app.root.addChild(splats)
      const layer = new pc.Layer({ name: 'another' })
      app.scene.layers.push(layer)
      splats.layers = [layer.id]
      hashes['on another layer'] = black()
      camera.camera.layers = [...camera.camera.layers, layer.id]
      take('on a layer of the camera')
      splats.layers = [pc.LAYERID_WORLD]
      // In the middle of the picture, where splats are opaque.
      const veil = wall(app, camera, 3, { opacity: 0.5, blendType: pc.BLEND_NORMAL }), pixel = 4 * (160 * 40 + 60)
      const veiled = draw(app)
      await keep('playcanvas-veil', device.canvas)
      hashes.veiled = [255, 128, 64].every(
        (part, c) => Math.abs(veiled[pixel + c] - (part + whole[pixel + c]) / 2) <= 1)
      veil.destroy()
      ${TWO}
      second.enabled = false
      take('one of two')
      const clone = app.root.clone()
      hashes.clones = clone.children.filter((one) => one instanceof Splats && one !== splats).length
      clone.destroy()
      take('after clones')
      splats.turn.set(0, 0, 0, 1)
      hashes['turned clone'] = splats.clone().placed.rotation.join()
      return { hashes, pictures }`)
    keepPictures(pictures)
    const [whole, half] = [hashOf(seen), hashOf(frame('knot', 80, 50, EYE))]
    assert.deepEqual(hashes, {
      smaller: half, corner: half, 'in a pass of its own': half, 'one camera': half, 'another camera': half,
      scissor: true, disabled: true, 'in a group': whole, 'in what is disabled': true, 'in a headset': true, nowhere: true, 'on another layer': true,
      'on a layer of the camera': whole, veiled: true, 'one of two': whole, clones: 2, 'after clones': whole,
      'turned clone': '1,0,0,0',
    })
  },

  async 'PlayCanvas: walls in targets, in light, of samples, orthographic'() {
    const [found, errors, buffers, pictures] = await runIn(browser, 'mesh', `${STAGE}
      const found = {}, errors = {}, buffers = {}
      const ways = { plain: {}, multisampled: { antialias: true } }
      const ortho = { projection: pc.PROJECTION_ORTHOGRAPHIC, orthoHeight: 2, nearClip: -10, farClip: 60 }
      const targetOf = (app, how) => new pc.RenderTarget({ ...how, colorBuffer: new pc.Texture(app.graphicsDevice,
        { width, height, format: pc.PIXELFORMAT_RGBA8, mipmaps: false }) })
      const frames = { light: { samples: 1 }, 'light of samples': { samples: 4 }, 'light and depths': { samples: 1 } }
      for (const [name, how] of Object.entries(ways)) {
        const app = await appOf(how), splats = await Splats.load(app, '/work/knot.fxs')
        app.root.addChild(splats)
        const into = { 'the canvas': {}, orthographic: ortho,
          'a target': { target: targetOf(app, { depth: true }) },
          'of samples': { target: targetOf(app, { depth: true, samples: 4 }) },
          stencil: { target: targetOf(app, { depth: true, stencil: true }) },
          depths: { target: targetOf(app, { depthBuffer: new pc.Texture(app.graphicsDevice,
            { width, height, format: pc.PIXELFORMAT_DEPTH, mipmaps: false }) }) } }
        for (const [place, { target, ...kind }] of Object.entries({ ...into, ...(name === 'plain' && frames) })) {
          const isFrame = frames[place], camera = cameraOf(app, isFrame ? {} : { ...kind, renderTarget: target })
          const frame = isFrame && new pc.CameraFrame(app, camera.camera)
          if (frame) {
            Object.assign(frame.rendering, { renderFormats: [pc.PIXELFORMAT_RGBA16F], ...isFrame })
            if (place === 'light and depths') Object.assign(frame.ssao, { type: pc.SSAOTYPE_COMBINE, intensity: 0 })
            frame.update()
          }
          const gl = app.graphicsDevice.canvas.getContext('webgl2')
          const look = (_, layer, isTransparent) => {
            if (layer.id === pc.LAYERID_WORLD && isTransparent)
              buffers[place] = gl.getParameter(gl.DRAW_BUFFER1) > gl.NONE
          }
          app.scene.on('prerender:layer', look)
          found[name + ', ' + place] = await wallsOf(app, splats, camera, target)
          const mesh = wall(app, camera, 4.03)
          draw(app)
          if (!target) await keep('playcanvas-' + name + '-' + place, app.graphicsDevice.canvas)
          app.scene.off('prerender:layer', look)
          mesh.destroy()
          frame?.destroy()
          camera.destroy()
          errors[name + ', ' + place] = gl.getError()
        }
        app.destroy()
      }
      return [found, errors, buffers, pictures]`)
    keepPictures(pictures)
    assert.equal(Object.keys(found).length, 15)
    for (const [name, all] of Object.entries(found)) checkWalls(name, all)
    assert.deepEqual(Object.entries(errors).filter(([, error]) => error), [])
    assert.deepEqual(Object.keys(buffers).filter((place) => buffers[place]), ['light and depths'])
  },

  async 'PlayCanvas: a ray finds what pick finds'() {
    const { same, hits, misses, free, moved } = await runIn(browser, 'mesh', `${STAGE}
      const app = await appOf(), camera = cameraOf(app), splats = await Splats.load(app, '/work/knot.fxs')
      app.root.addChild(splats)
      draw(app)
      const inScene = { eye: [0, -1, -4], look: [0, 0, 0], near: 0.1 }
      const said = { same: true, hits: 0, misses: 0, free: 0 }
      function rayOf(x, y) {
        const [from, to] = [0.1, 100].map((z) => camera.camera.screenToWorld(x + 0.5, y + 0.5, z))
        return new pc.Ray(from, to.sub(from).normalize())
      }
      for (let i = 0; i < 12; i++) {
        const [x, y] = [13 * i + 1, (37 * i) % height], ray = rayOf(x, y), hit = splats.raycast(ray, camera.camera)
        const wanted = splats.scene.pick(x, y, inScene, { width, height })
        hit ? said.hits++ : said.misses++
        if (!hit || !wanted) {
          said.same &&= !hit && !wanted
          continue
        }
        const [a, b, c] = wanted.position
        said.same &&= hit.index === wanted.gaussian && hit.point.distance(new pc.Vec3(a, -b, -c)) < 1e-4 &&
          Math.abs(hit.distance - ray.origin.distance(hit.point)) < 1e-6
        said.free = Math.max(said.free, Math.abs((splats.raycast(ray)?.distance ?? 99) - hit.distance))
      }
      // Where all is moved, turned and scaled, rays find the same.
      const first = splats.raycast(rayOf(60, 40), camera.camera), world = new pc.Entity('world', app)
      app.root.addChild(world)
      world.addChild(splats)
      world.addChild(camera)
      world.setPosition(5, -3, 2)
      world.setEulerAngles(20, 60, -30)
      world.setLocalScale(1.5, 1.5, 1.5)
      draw(app)
      const then = splats.raycast(rayOf(60, 40), camera.camera)
      const wanted = world.getWorldTransform().transformPoint(first.point)
      const { aabb } = splats, margin = new pc.BoundingBox(aabb.center, aabb.halfExtents.clone().addScalar(0.1))
      said.moved = [then.index === first.index, then.point.distance(wanted) < 1e-3, margin.containsPoint(then.point),
        aabb.halfExtents.length() < 1.5 * 1.8 * new pc.Vec3(...splats.scene.high).length()]
      // A camera that sees but half of the picture.
      world.setPosition(0, 0, 0)
      world.setEulerAngles(0, 0, 0)
      world.setLocalScale(1, 1, 1)
      camera.camera.rect = new pc.Vec4(0, 0.5, 0.5, 0.5)
      draw(app)
      const half = splats.scene.pick(30, 20, inScene, { width: 80, height: 50 })
      said.moved.push(splats.raycast(rayOf(30, 20), camera.camera)?.index === half.gaussian)
      return said`)
    assert.deepEqual([same, ...moved], Array(6).fill(true))
    assert.ok(hits >= 4 && misses >= 2, `${hits} hits, ${misses} misses`)
    assert.ok(free < 0.2, `without a camera ${free} apart`)
  },

  async 'PlayCanvas: given back; a context that is lost and restored; in parts; errors in words'() {
    const { hashes, objects, freed, said, paged } = await runIn(browser, 'mesh', `${STAGE}
      const KINDS = ['Buffer', 'Framebuffer', 'Program', 'Renderbuffer', 'Shader', 'Texture', 'VertexArray']
      const app = await appOf(), shown = app.graphicsDevice.canvas, gl = shown.getContext('webgl2'), hashes = []
      const camera = cameraOf(app)
      let objects = 0
      for (const kind of KINDS)
        for (const [verb, step] of [['create', 1], ['delete', -1]]) {
          const was = gl[verb + kind]
          gl[verb + kind] = function (...values) {
            objects += step
            return was.apply(this, values)
          }
        }
      const take = () => hashes.push(hash(draw(app)))
      const counts = [], freed = []
      for (let i = 0; i < 3; i++) {
        const one = await Splats.load(app, '/work/knot.fxs'), other = await Splats.load(app, one.scene)
        other.setPosition(100, 0, 0)
        app.root.addChild(one)
        app.root.addChild(other)
        take()
        other.destroy()
        take()
        const clone = one.clone()
        one.destroy()
        one.destroy()
        freed.push(!one.scene.isFreed && one.raycast(new pc.Ray()) === null)
        clone.destroy()
        freed.push(one.scene.isFreed && !app.scene.hasEvent('prerender:layer'))
        counts.push(objects)
      }
      const splats = await Splats.load(app, '/work/knot.fxs'), said = []
      app.root.addChild(splats)
      take()
      const ending = gl.getExtension('WEBGL_lose_context')
      const lost = new Promise((done) => shown.addEventListener('webglcontextlost', done))
      ending.loseContext()
      draw(app)
      await lost
      draw(app)
      await new Promise((done) => setTimeout(done, 50))
      const back = new Promise((done) => splats.once('change', done))
      ending.restoreContext()
      await back
      take()
      const note = async (act) => said.push(await wordsOf((async () => act())()))
      splats.setLocalScale(1, 2, 1)
      await note(() => draw(app))
      splats.setLocalScale(1, 1, -1)
      await note(() => draw(app))
      splats.setLocalScale(1, 1, 1)
      await note(() => Splats.load({}, '/work/knot.fxs'))
      await note(() => Splats.load(app, '/work/none.fxs'))
      const textureOf = (format) =>
        new pc.Texture(app.graphicsDevice, { width, height, format, mipmaps: false })
      for (const how of [{ flipY: true, colorBuffer: textureOf(pc.PIXELFORMAT_RGBA8) },
                         { colorBuffer: textureOf(pc.PIXELFORMAT_SRGBA8) }]) {
        camera.camera.renderTarget = new pc.RenderTarget({ depth: true, ...how })
        await note(() => draw(app))
      }
      camera.camera.renderTarget = null
      take()
      splats.destroy()
      await note(() => splats.clone())

      let news = 0
      const paging = { changed: () => news++, cache: 0 }
      const paged = await Splats.load(app, '/work/levels.fxs?ranges', { paging })
      app.root.addChild(paged)
      let events = 0
      paged.on('change', () => events++)
      draw(app)
      await paged.scene.complete({ eye: [0, -1, -4], look: [0, 0, 0], near: 0.1 }, { width, height })
      await new Promise((done) => setTimeout(done, 100))
      const all = await Splats.load(app, '/work/levels.fxs', { paging: false })
      take()
      paged.remove()
      app.root.addChild(all)
      take()
      const parts = [paged.scene.paged, events > 0, events === news]
      return { hashes, objects: counts, freed, said, paged: parts }`)
    const whole = hashOf(seen), levels = hashOf(frame('levels', WIDTH, HEIGHT, EYE))
    assert.deepEqual(hashes, [...Array(9).fill(whole), levels, levels])
    assert.equal(new Set(objects.slice(1)).size, 1, `objects of WebGL: ${objects}`)
    assert.deepEqual(freed, Array(6).fill(true))
    const wanted = [/one scale, above 0, for x, y and z/, /one scale/, /expected an application of PlayCanvas with We/,
                    /none.fxs.*404/, /flipY or of sRGB/, /flipY or of sRGB/, /knot.fxs: was destroyed/]
    wanted.forEach((words, i) => assert.match(said[i], words))
    assert.deepEqual(paged, [true, true, true])
  },

  'PlayCanvas: docs/examples/playcanvas-webgl.html': () => example(browser, 'playcanvas-webgl.html'),
})

export const playcanvasTests = (browser) => ({ ...tests(browser), ...(ALL && more(browser)) })
