// Checks the class Splats of the package entry fixsplat-viewer/three, which draws splats in three.js. For webgl.mjs and
// webgpu.mjs.
import assert from 'node:assert/strict'
import {
  checkWalls, example, EYE, hashOfPlaced, HEIGHT, keepPictures, PAGE, seen, WIDTH,
} from './engines.mjs'
import { frame, hashOf, runIn } from './screens.mjs'

const STAGE = `const THREE = await import('three'), { Splats, viewOf } = await import('fixsplat-viewer/three')
  ${PAGE}
  function cameraOf(kind = 'perspective') {
    const camera = kind === 'perspective' ? new THREE.PerspectiveCamera(50, width / height, 0.1, 100)
      : new THREE.OrthographicCamera(-3.2, 3.2, 2, -2, -10, 60)
    camera.position.set(0, 1, 4)
    camera.lookAt(0, 0, 0)
    camera.updateMatrixWorld()
    return camera
  }
  function stageOf(...objects) {
    const scene = new THREE.Scene()
    scene.background = new THREE.Color(0)
    return scene.add(...objects)
  }
  /** An orange wall that faces the camera, so that all of it has one depth. */
  function wall(camera, distance) {
    const side = camera.isOrthographicCamera ? 1.6 : 0.4 * distance
    const mesh = new THREE.Mesh(new THREE.PlaneGeometry(side, side), new THREE.MeshBasicMaterial({ color: 0xff8040 }))
    mesh.quaternion.copy(camera.quaternion)
    mesh.position.copy(camera.position).addScaledVector(camera.getWorldDirection(new THREE.Vector3()), distance)
    return mesh
  }
  /** The walls of walled; drawMesh gives the bytes with a mesh. */
  const wallsOf = (splats, camera, drawMesh) => walled(splats, viewOf(camera, width, height), (distance, isShown) => {
    splats.visible = isShown
    return drawMesh(wall(camera, distance))
  })`

const TWO = `const second = splats.clone()
  second.position.set(0.7, 0.4, 0.5)
  second.rotation.y = 0.7
  second.scale.setScalar(0.6)
  second.opacity = 0.75
  second.tint = [1, 0.5, 2]
  second.time = 0.5
  scene.add(second)`
const placedIn = 'JSON.parse(JSON.stringify([splats, second].map(({ placed: { scene, ...how } }) => how)))'

const ALL = process.env.FXS_PROCESSORS === 'all'

export const threeTests = (browser) => ({
  async 'three.js: the bytes of the command; sizes, corners, what is not seen; two objects'() {
    const { hashes, placed, pictures } = await runIn(browser, 'mesh', `${STAGE}
      const renderer = new THREE.WebGLRenderer({ antialias: true }), shown = renderer.domElement, hashes = {}
      renderer.setSize(width, height)
      const splats = await Splats.load(renderer, '/work/knot.fxs'), scene = stageOf(splats), camera = cameraOf()
      const draw = () => (renderer.render(scene, camera), bytesOf(shown))
      const take = (name) => (hashes[name] = hash(draw()))
      take('alone')
      await keep('alone', shown)
      renderer.toneMapping = THREE.ACESFilmicToneMapping
      take('tones')
      renderer.toneMapping = THREE.NoToneMapping
      renderer.setPixelRatio(2)
      renderer.setSize(width / 2, height / 2)
      take('pixel ratio')
      renderer.setPixelRatio(1)
      renderer.setSize(80, 50)
      take('smaller')
      // A state of the context that three.js does not have, which stays as it is.
      const gl = renderer.getContext(), textures = [gl.createTexture(), gl.createTexture()]
      const parameters = ['ACTIVE_TEXTURE', 'TEXTURE_BINDING_2D', 'SAMPLER_BINDING', 'CURRENT_PROGRAM', 'VIEWPORT',
        'VERTEX_ARRAY_BINDING', 'READ_FRAMEBUFFER_BINDING', 'DRAW_FRAMEBUFFER_BINDING', 'DEPTH_WRITEMASK', 'DEPTH_FUNC',
        'CULL_FACE', 'DEPTH_TEST', 'SCISSOR_TEST', 'STENCIL_TEST', 'BLEND', 'SCISSOR_BOX', 'COLOR_WRITEMASK']
      const stateOf = () => parameters.map((name) => gl.getParameter(gl[name])).map((value) => value?.join?.() ?? value)
      const reading = gl.createFramebuffer(), switches = ['CULL_FACE', 'SCISSOR_TEST', 'STENCIL_TEST']
      const amid = wall(camera, 4.03)
      scene.add(amid)
      const usual = hash(draw())
      scene.remove(amid)
      draw()
      scene.add(amid)
      splats.onBeforeRender = function (...given) {
        const was = stateOf()
        for (const name of switches) gl.enable(gl[name])
        gl.disable(gl.DEPTH_TEST)
        gl.depthMask(false)
        gl.depthFunc(gl.GREATER)
        gl.scissor(1, 2, 3, 4)
        textures.forEach((texture, unit) => {
          gl.activeTexture(gl.TEXTURE1 - unit)
          gl.bindTexture(gl.TEXTURE_2D, texture)
        })
        gl.activeTexture(gl.TEXTURE1)
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, reading)
        const odd = stateOf()
        Splats.prototype.onBeforeRender.apply(this, given)
        const then = stateOf()
        gl.activeTexture(gl.TEXTURE0)
        hashes.kept = then.every((value, i) => value === odd[i]) &&
          gl.getParameter(gl.TEXTURE_BINDING_2D) === textures[1] && was.some((value, i) => value !== odd[i])
        for (const name of switches) gl.disable(gl[name])
        gl.enable(gl.DEPTH_TEST)
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, was[parameters.indexOf('READ_FRAMEBUFFER_BINDING')])
        renderer.state.reset()
      }
      hashes.odd = hash(draw()) === usual
      delete splats.onBeforeRender
      scene.remove(amid)
      // A part of a picture's bytes, 80 x 50 pixels.
      const cut = (bytes, left, top) => Uint8ClampedArray.from({ length: 4 * 80 * 50 },
        (_, i) => bytes[4 * (160 * (top + Math.floor(i / 320)) + left) + (i % 320)])
      for (const kind of ['perspective', 'orthographic']) {
        const other = cameraOf(kind)
        renderer.setSize(width, height)
        renderer.render(scene, other)
        const wanted = cut(bytesOf(shown), 33, 21)
        renderer.setSize(80, 50)
        other.setViewOffset(width, height, 33, 21, 80, 50)
        renderer.render(scene, other)
        hashes['a part, ' + kind] = apart(bytesOf(shown), wanted) <= 1
      }
      renderer.setSize(width, height)
      renderer.setViewport(20, 30, 80, 50)
      hashes.corner = hash(cut(draw(), 20, 20))
      renderer.setViewport(0, 0, width, height)
      const black = () => !draw().some((byte, i) => i % 4 < 3 && byte)
      splats.visible = false
      hashes.hidden = black()
      splats.visible = true
      const group = new THREE.Group().add(splats)
      group.visible = false
      scene.add(group)
      hashes['hidden by its parent'] = black()
      scene.add(splats)
      splats.layers.set(3)
      hashes['on another layer'] = black()
      splats.layers.set(0)
      scene.overrideMaterial = new THREE.MeshBasicMaterial({ color: 0xffffff })
      hashes['another material'] = black()
      scene.overrideMaterial = null
      THREE.ColorManagement.enabled = false
      renderer.outputColorSpace = THREE.LinearSRGBColorSpace
      take('colours unmanaged')
      THREE.ColorManagement.enabled = true
      renderer.outputColorSpace = THREE.SRGBColorSpace
      const veil = wall(camera, 4.03), bare = draw()
      Object.assign(veil.material, { transparent: true, opacity: 0.5 })
      scene.add(veil)
      // In the middle of the picture, where splats are opaque: wholly over them, and wholly under.
      hashes.veiled = [1, -1].map((order) => {
        veil.renderOrder = order
        const bytes = draw(), pixel = 160 * 40 + 60
        return [255, 128, 64].every((part, c) =>
          Math.abs(bytes[4 * pixel + c] - (order > 0 ? (part + bare[4 * pixel + c]) / 2 : bare[4 * pixel + c])) <= 1)
      }).join()
      scene.remove(veil)
      ${TWO}
      take('two')
      await keep('two', shown)
      group.add(second)
      take('one of two in what is hidden')
      scene.add(second)
      second.layers.set(3)
      take('one of two on another layer')
      second.layers.set(0)
      new THREE.Scene().add(second)
      take('one of two elsewhere')
      scene.add(second)
      second.updateMatrixWorld()
      hashes.error = renderer.getContext().getError()
      return { hashes, placed: ${placedIn}, pictures }`)
    keepPictures(pictures)
    const [whole, half] = [hashOf(seen), hashOf(frame('knot', 80, 50, EYE))]
    assert.deepEqual(hashes, {
      alone: whole, odd: true, kept: true, tones: whole, 'pixel ratio': whole, smaller: half, corner: half, 'a part, perspective': true,
      'a part, orthographic': true, hidden: true,
      'hidden by its parent': true, 'on another layer': true, 'another material': true, 'colours unmanaged': whole,
      veiled: 'true,true', two: hashOfPlaced(placed),
      'one of two in what is hidden': whole, 'one of two on another layer': whole, 'one of two elsewhere': whole, error: 0,
    })
    const { opacity, tint, time, scale } = placed[1]
    assert.deepEqual([opacity, tint, time, scale.toFixed(9)], [0.75, [1, 0.5, 2], 0.5, '0.600000000'])
    assert.notEqual(hashes.two, whole)
  },

  async 'three.js: a mesh before, behind and amid splats'() {
    const [found, pictures] = await runIn(browser, 'mesh', `${STAGE}
      const target = (how) => new THREE.WebGLRenderTarget(width, height, { type: THREE.HalfFloatType, ...how })
      const depthTexture = new THREE.DepthTexture(width, height, THREE.FloatType)
      const into = { 'the canvas': null, 'of samples': target({ samples: 4 }), stencil: target({ stencilBuffer: true }),
                     depths: target({ depthTexture }) }
      const ways = [['multisampled', { antialias: true }], ...(args[0] ? [['plain', {}],
        ['logarithmic', { logarithmicDepthBuffer: true }], ['reversed', { reversedDepthBuffer: true }]] : [])]
      const found = {}
      for (const [name, how] of ways) {
        const renderer = new THREE.WebGLRenderer(how)
        renderer.setSize(width, height)
        const splats = await Splats.load(renderer, '/work/knot.fxs'), scene = stageOf(splats)
        if (how.reversedDepthBuffer) found.reversible = renderer.capabilities.reversedDepthBuffer
        for (const kind of ['perspective', 'orthographic'])
          for (const [place, target] of Object.entries(kind === 'perspective' ? into : { 'the canvas': null })) {
            const camera = cameraOf(kind)
            const shows = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), new THREE.MeshBasicMaterial())
            shows.material.map = target?.texture ?? null
            function draw(mesh) {
              scene.add(mesh)
              renderer.setRenderTarget(target)
              renderer.render(scene, camera)
              renderer.setRenderTarget(null)
              if (target) renderer.render(shows, new THREE.OrthographicCamera(-1, 1, 1, -1, -1, 1))
              scene.remove(mesh)
              return bytesOf(renderer.domElement)
            }
            found[name + ', ' + kind + ', ' + place] = await wallsOf(splats, camera, draw)
            draw(wall(camera, 4.03))
            await keep(name + '-' + kind + '-' + place, renderer.domElement)
          }
        splats.dispose()
        renderer.dispose()
      }
      return [found, pictures]`, ALL)
    keepPictures(pictures)
    const { reversible, ...walls } = found
    assert.equal(Object.keys(walls).length, ALL ? 20 : 5)
    for (const [name, all] of Object.entries(walls)) checkWalls(name, all)
    if (ALL) console.log(`  the depth buffer ${reversible ? 'was' : 'cannot be'} reversed`)
  },

  async 'three.js: a ray finds what pick finds'() {
    const { same, hits, misses, free, moved } = await runIn(browser, 'mesh', `${STAGE}
      const renderer = new THREE.WebGLRenderer()
      renderer.setSize(width, height)
      const splats = await Splats.load(renderer, '/work/knot.fxs'), camera = cameraOf()
      const raycaster = new THREE.Raycaster()
      splats.updateMatrixWorld()
      const inScene = { eye: [0, -1, -4], look: [0, 0, 0], near: 0.1 }
      const said = { same: true, hits: 0, misses: 0, free: 0 }
      const shoot = (x, y) => {
        raycaster.setFromCamera(new THREE.Vector2((2 * x + 1) / width - 1, 1 - (2 * y + 1) / height), camera)
        return raycaster.intersectObject(splats)
      }
      for (let i = 0; i < 12; i++) {
        const [x, y] = [13 * i + 1, (37 * i) % height], [hit] = shoot(x, y)
        const wanted = splats.scene.pick(x, y, inScene, { width, height })
        hit ? said.hits++ : said.misses++
        if (!hit || !wanted) {
          said.same &&= !hit && !wanted
          continue
        }
        const [a, b, c] = wanted.position
        said.same &&= hit.index === wanted.gaussian && hit.object === splats &&
          hit.point.distanceTo(new THREE.Vector3(a, -b, -c)) < 1e-4 &&
          Math.abs(hit.distance - camera.position.distanceTo(hit.point)) < 1e-9
        const [alone] = new THREE.Raycaster(raycaster.ray.origin, raycaster.ray.direction).intersectObject(splats)
        said.free = Math.max(said.free, Math.abs((alone?.distance ?? 99) - hit.distance))
      }
      // Where all is moved, turned and scaled, rays find the same.
      const [first] = shoot(60, 40), world = new THREE.Group().add(splats, camera)
      world.position.set(5, -3, 2)
      world.rotation.set(0.3, 1, -0.5)
      world.scale.setScalar(1.5)
      world.updateMatrixWorld()
      raycaster.setFromCamera(new THREE.Vector2(121 / width - 1, 1 - 81 / height), camera)
      const [then] = raycaster.intersectObject(splats)
      said.moved = then.index === first.index && then.point.distanceTo(world.localToWorld(first.point)) < 1e-3
      raycaster.far = then.distance - 0.1
      said.moved &&= !raycaster.intersectObject(splats).length
      raycaster.far = Infinity
      raycaster.near = then.distance + 0.1
      said.moved &&= !raycaster.intersectObject(splats).length
      const box = new THREE.Box3().setFromObject(world), { low, high } = splats.scene
      said.moved &&= !box.isEmpty() && box.distanceToPoint(then.point) < 0.1
      return said`)
    assert.deepEqual([same, moved], [true, true])
    assert.ok(hits >= 4 && misses >= 2, `${hits} hits, ${misses} misses`)
    assert.ok(free < 0.2, `without a camera ${free} apart`)
  },

  async 'three.js: given back; a context that is lost and restored; in parts; errors in words'() {
    const { hashes, objects, freed, said, paged } = await runIn(browser, 'mesh', `${STAGE}
      const KINDS = ['Buffer', 'Framebuffer', 'Program', 'Renderbuffer', 'Shader', 'Texture', 'VertexArray']
      const renderer = new THREE.WebGLRenderer(), gl = renderer.getContext(), camera = cameraOf(), hashes = []
      renderer.setSize(width, height)
      let objects = 0
      for (const kind of KINDS)
        for (const [verb, step] of [['create', 1], ['delete', -1]]) {
          const was = gl[verb + kind]
          gl[verb + kind] = function (...values) {
            objects += step
            return was.apply(this, values)
          }
        }
      const scene = stageOf()
      function draw() {
        renderer.render(scene, camera)
        hashes.push(hash(bytesOf(renderer.domElement)))
      }
      const counts = [], ends = []
      for (let i = 0; i < 3; i++) {
        const one = await Splats.load(renderer, '/work/knot.fxs'), other = await Splats.load(renderer, one.scene)
        other.position.x = 100
        scene.add(one, other)
        draw()
        other.dispose()
        draw()
        const clone = one.clone()
        one.dispose()
        one.dispose()
        ends.push(!one.scene.isFreed && !scene.children.length)
        clone.dispose()
        ends.push(one.scene.isFreed)
        counts.push(objects)
      }
      const splats = await Splats.load(renderer, '/work/knot.fxs'), said = []
      scene.add(splats)
      const ending = gl.getExtension('WEBGL_lose_context')
      const lost = new Promise((done) => renderer.domElement.addEventListener('webglcontextlost', done))
      ending.loseContext()
      await lost
      renderer.render(scene, camera)
      await new Promise((done) => setTimeout(done, 50))
      const back = new Promise((done) => splats.addEventListener('change', done))
      ending.restoreContext()
      await back
      draw()
      const note = async (act) => said.push(await wordsOf((async () => act())()))
      splats.scale.set(1, 2, 1)
      await note(() => renderer.render(scene, camera))
      splats.scale.setScalar(1)
      await note(() => Splats.load({}, '/work/knot.fxs'))
      await note(() => Splats.load(renderer, '/work/none.fxs'))
      const other = new THREE.WebGLRenderer()
      await note(() => other.render(scene, camera))
      draw()
      splats.dispose()

      let news = 0
      const paging = { changed: () => news++, cache: 0 }
      const paged = await Splats.load(renderer, '/work/levels.fxs?ranges', { paging })
      scene.add(paged)
      let events = 0
      paged.addEventListener('change', () => events++)
      renderer.render(scene, camera)
      await paged.scene.complete({ eye: [0, -1, -4], look: [0, 0, 0], near: 0.1 }, { width, height })
      await new Promise((done) => setTimeout(done, 100))
      const all = await Splats.load(renderer, '/work/levels.fxs', { paging: false })
      draw()
      scene.remove(paged)
      scene.add(all)
      draw()
      const parts = [paged.scene.paged, events > 0, events === news]
      return { hashes, objects: counts, freed: ends, said, paged: parts }`)
    const whole = hashOf(seen), levels = hashOf(frame('levels', WIDTH, HEIGHT, EYE))
    assert.deepEqual(hashes, [...Array(8).fill(whole), levels, levels])
    assert.equal(new Set(objects.slice(1)).size, 1, `objects of WebGL: ${objects}`)
    assert.deepEqual(freed, Array(6).fill(true))
    const wanted = [/one scale, above 0, for x, y and z/, /expected a WebGLRenderer or a WebGPURenderer/,
                    /none.fxs.*404/, /knot.fxs: these Splats are of another renderer/]
    wanted.forEach((words, i) => assert.match(said[i], words))
    assert.deepEqual(paged, [true, true, true])
  },

  ...(ALL && { 'three.js: docs/examples/three-webgl.html': () => example(browser, 'three-webgl.html') }),
})

export const threeGpuTests = (browser) => ({
  async 'three.js by WebGPU: the bytes of the command, walls, sizes, two objects, given back, errors in words'() {
    const { hashes, walls, placed, counts, said, pictures } = await runIn(browser, 'mesh-gpu', `${STAGE}
      const camera = cameraOf(), hashes = {}, walls = {}, said = [], counts = []
      let device
      async function rendererOf(how) {
        const renderer = new THREE.WebGPURenderer({ device, ...how })
        await renderer.init()
        renderer.setSize(width, height)
        device ??= renderer.backend.device
        return renderer
      }
      const renderer = await rendererOf(), scene = stageOf(), wrap = (object, name, step) => {
        const was = object[name]
        object[name] = function (...values) {
          counts.now += step
          return was.apply(this, values)
        }
      }
      counts.now = 0
      for (const [kind, prototype] of [['Buffer', GPUBuffer.prototype], ['Texture', GPUTexture.prototype]]) {
        wrap(device, 'create' + kind, 1)
        wrap(prototype, 'destroy', -1)
      }
      const draw = async (splats) => {
        await splats.update(camera)
        renderer.render(scene, camera)
        return bytesOf(renderer.domElement)
      }
      for (let i = 0; i < 3; i++) {
        const splats = await Splats.load(renderer, '/work/knot.fxs')
        scene.add(splats)
        hashes['again ' + i] = hash(await draw(splats))
        splats.dispose()
        counts.push(counts.now)
      }
      const splats = await Splats.load(renderer, '/work/knot.fxs')
      scene.add(splats)
      renderer.setPixelRatio(2)
      renderer.setSize(width / 2, height / 2)
      hashes['pixel ratio'] = hash(await draw(splats))
      renderer.setPixelRatio(1)
      renderer.setSize(80, 50)
      hashes.smaller = hash(await draw(splats))
      renderer.setSize(width, height)
      ${TWO}
      hashes.two = hash(await draw(splats))
      await keep('gpu-two', renderer.domElement)
      const placed = ${placedIn}
      const note = async (act) => said.push(await wordsOf((async () => act())()))
      second.scale.set(1, 1, 2)
      await note(() => splats.update(camera))
      second.scale.setScalar(0.6)
      renderer.logarithmicDepthBuffer = true
      await note(() => splats.update(camera))
      renderer.logarithmicDepthBuffer = false
      hashes['two again'] = hash(await draw(splats))
      const late = splats.update(camera)
      second.dispose()
      splats.dispose()
      await note(() => late)
      await note(() => splats.update(camera))
      const without = new THREE.WebGPURenderer({ forceWebGL: true })
      await note(() => Splats.load(without, '/work/knot.fxs'))

      // A reversed depth buffer comes last: three.js draws nothing by a renderer without one after it.
      const target = new THREE.RenderTarget(width, height, { type: THREE.HalfFloatType })
      const ways = { plain: [{}], 'a target': [{}, 'perspective', target], multisampled: [{ antialias: true }],
        orthographic: [{}, 'orthographic'], reversed: [{ reversedDepthBuffer: true }],
        'reversed and orthographic': [{ reversedDepthBuffer: true }, 'orthographic'] }
      for (const [name, [how, kind, into = null]] of Object.entries(ways)) {
        const renderer = await rendererOf(how), splats = await Splats.load(renderer, '/work/knot.fxs')
        const scene = stageOf(splats), camera = cameraOf(kind)
        const shows = new THREE.QuadMesh(new THREE.MeshBasicMaterial({ map: into?.texture }))
        async function draw(...meshes) {
          scene.add(...meshes)
          renderer.setRenderTarget(into)
          await splats.update(camera)
          renderer.render(scene, camera)
          renderer.setRenderTarget(null)
          if (into) shows.render(renderer)
          scene.remove(...meshes)
          return bytesOf(renderer.domElement)
        }
        walls[name] = await wallsOf(splats, camera, draw)
        if (kind !== 'orthographic') hashes[name] = hash(await draw(new THREE.Group()))
        await draw(wall(camera, 4.03))
        await keep('gpu-' + name, renderer.domElement)
        splats.dispose()
      }
      return { hashes, walls, placed, counts, said, pictures }`)
    keepPictures(pictures)
    for (const [name, all] of Object.entries(walls)) checkWalls(name, all)
    const [whole, half, two] = [hashOf(seen), hashOf(frame('knot', 80, 50, EYE)), hashOfPlaced(placed)]
    assert.deepEqual(hashes, {
      plain: whole, 'a target': whole, multisampled: whole, reversed: whole, 'again 0': whole, 'again 1': whole,
      'again 2': whole, 'pixel ratio': whole, smaller: half, two, 'two again': two,
    })
    assert.equal(new Set(counts.slice(1)).size, 1, `buffers and textures: ${counts}`)
    const wanted = [/one scale/, /not logarithmic/, /^nothing$/, /^nothing$/, /no WebGPU here/]
    wanted.forEach((words, i) => assert.match(said[i], words))
  },

  'three.js by WebGPU: docs/examples/three-webgpu.html': () => example(browser, 'three-webgpu.html'),
})
