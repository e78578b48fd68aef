// node webgpu.mjs PACKAGE WORK MODULES COMMAND: what tests/scripts/webgpu.sh asks of a Screen.
import assert from 'node:assert/strict'
import { WEBGPU } from './flags.mjs'
import { frame, FRAMES, hashOf, launch, near, open, runIn, runTests, shared } from './screens.mjs'

const browser = await launch(...WEBGPU)
const { run, page } = await open(browser, 'isolated')

const { 'in bands': bands, 'square cut-off': fog, 'larger again': large, ...most } = FRAMES
const frames = {
  ...most,
  'square cut-off': frame('few', 200, 150, ['--cutoff', 'square', '--bg', 'ffffff'],
                          { cutoff: 'square', background: 0xffffff }),
  'profile compact': frame('compact', 200, 150),
  'profile small': frame('small', 200, 150),
  'a detail': frame('levels', 200, 150, ['--detail', '2.5'], { detail: 2.5 }),
  'first again': FRAMES.framed,
}
const hashesOf = (some) => Object.fromEntries(Object.entries(some).map(([name, frame]) => [name, hashOf(frame)]))
const DRAWS = `const hashes = {}
  for (const [name, frame] of Object.entries(args[0])) hashes[name] = hash(await drawn(screen, frame))`

// What the page asks of WebGPU: counts calls, and the bytes that go to the device and back.
const COUNTS = `const counts = { submit: 0, getCurrentTexture: 0, bytes: 0, buffers: 0 }
  const wrapped = (prototype, name, note) => {
    const was = prototype[name]
    prototype[name] = function (...values) {
      const result = was.apply(this, values)
      note(result, ...values)
      return result
    }
    return () => (prototype[name] = was)
  }
  const undo = [
    wrapped(GPUQueue.prototype, 'submit', () => counts.submit++),
    wrapped(GPUCanvasContext.prototype, 'getCurrentTexture', () => counts.getCurrentTexture++),
    wrapped(GPUQueue.prototype, 'writeBuffer', (_, buffer, at, data) => (counts.bytes += data.byteLength)),
    wrapped(GPUBuffer.prototype, 'getMappedRange', (range) => (counts.bytes += range.byteLength)),
    wrapped(GPUDevice.prototype, 'createBuffer', () => counts.buffers++),
    wrapped(GPUBuffer.prototype, 'destroy', () => counts.buffers--),
  ]`

const tests = {
  async 'the pixels of the command, one Screen'() {
    const hashes = await run(`const screen = await Screen.open(canvas(), 'webgpu')
      ${DRAWS}
      screen.free()
      return hashes`, frames)
    assert.deepEqual(hashes, hashesOf(frames))
  },

  async 'without threads, in parts of a device with small buffers'() {
    const some = { framed: frame('knot', 160, 100), 'a budget': FRAMES['a budget'] }
    const [hashes, parts] = await runIn(browser, '',
      `const device = await (await navigator.gpu.requestAdapter()).requestDevice()
      const { maxBufferSize, maxTextureDimension2D } = device.limits
      const limits = { maxStorageBufferBindingSize: 1000000, maxBufferSize, maxTextureDimension2D }
      Object.defineProperty(device, 'limits', { value: limits })
      const screen = await Screen.open(canvas(), 'webgpu', { device }), [core, at] = (await sceneOf('knot')).inside
      ${DRAWS}
      return [hashes, core.c.gpu_parts(core.c.gpu_open(1000000), at)]`,
      some
    )
    assert.deepEqual(hashes, hashesOf(some))
    assert.equal(parts, 2)
  },

  async 'nothing is shown before it is whole'() {
    const [first, second] = await run(`${COUNTS}
      const screen = await Screen.open(canvas(), 'webgpu'), placed = [{ scene: await sceneOf('knot') }], seen = []
      for (let i = 0; i < 2; i++) {
        Object.assign(counts, { submit: 0, getCurrentTexture: 0, bytes: 0 })
        screen.draw(placed, args[0].camera, args[0].options)
        await screen.finish()
        seen.push({ ...counts })
      }
      undo.forEach((one) => one())
      screen.free()
      return seen`, frame('knot', 640, 360, [], {}, near))
    assert.ok(first.submit >= 3, `${first.submit} submits: the first try fitted`)
    assert.equal(first.getCurrentTexture, 1)
    assert.deepEqual([second.submit, second.getCurrentTexture], [2, 1])
    assert.ok(second.bytes < 4096, `${second.bytes} bytes a frame`)
    console.log(`  ${second.bytes} bytes of a frame move between processor and device`)
  },

  async 'what the page shows'() {
    const [x, y] = await run(`const element = document.body.appendChild(document.createElement('canvas'))
      const screen = await Screen.open(element, 'webgpu')
      screen.draw([{ scene: await sceneOf('knot') }], args[0].camera, args[0].options)
      await screen.finish()
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))
      const { x, y } = element.getBoundingClientRect()
      return [x, y]`, FRAMES.framed)
    const { width, height } = FRAMES.framed.options
    const png = await page.screenshot({ clip: { x, y, width, height }, encoding: 'base64' })
    const shown = await run(`const image = await createImageBitmap(await (await fetch(args[0])).blob())
      const flat = new OffscreenCanvas(image.width, image.height).getContext('2d', { willReadFrequently: true })
      flat.drawImage(image, 0, 0)
      return hash(flat.getImageData(0, 0, image.width, image.height).data)`, `data:image/png;base64,${png}`)
    assert.equal(shown, hashOf(FRAMES.framed))
  },

  async 'the last of frames that wait'() {
    const [hashes, textures] = await run(`${COUNTS}
      const screen = await Screen.open(canvas(), 'webgpu'), scene = await sceneOf('knot')
      for (const { camera, options } of args) screen.draw([{ scene }], camera, options)
      const pixels = await screen.pixels()
      undo.forEach((one) => one())
      screen.free()
      return [hash(pixels), counts.getCurrentTexture]`,
      FRAMES.framed, FRAMES['one pixel'], FRAMES['a row of tiles'])
    assert.deepEqual([hashes, textures], [hashOf(FRAMES['a row of tiles']), 2])
  },

  async "the caller's textures: a corner, behind a mesh, over what is there"() {
    const [corner, edge, behind, wanted, apart, hides] = await run(
      `const screen = await Screen.open(null, 'webgpu'), { device } = screen, { width, height } = args[0].options
      const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC | GPUTextureUsage.TEXTURE_BINDING
      const size = [192, 128], made = (format) => device.createTexture({ size, format, usage })
      const texture = made('rgba8unorm'), depth = { texture: made('depth32float'), planes: [0.25, Infinity] }
      // A triangle at a depth of 4, and what is not covered as far as can be.
      const code = \`@vertex fn at(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32>
        { return vec4<f32>(f32(i % 2u) * 1.4 - 0.8, f32(i / 2u) * 1.3 - 0.7, 0.9375, 1.0); }
        @fragment fn red() -> @location(0) vec4<f32> { return vec4<f32>(1.0, 0.0, 0.0, 1.0); }\`
      const module = device.createShaderModule({ code })
      const pipeline = device.createRenderPipeline({ layout: 'auto', vertex: { module },
        fragment: { module, targets: [{ format: 'rgba8unorm' }] },
        depthStencil: { format: 'depth32float', depthWriteEnabled: true, depthCompare: 'less' } })
      function drawMesh() {
        const encoder = device.createCommandEncoder(), clearValue = [0, 0, 1, 1]
        const colour = { view: texture.createView(), loadOp: 'clear', storeOp: 'store', clearValue }
        const view = depth.texture.createView()
        const depths = { view, depthLoadOp: 'clear', depthStoreOp: 'store', depthClearValue: 1 }
        const pass = encoder.beginRenderPass({ colorAttachments: [colour], depthStencilAttachment: depths })
        pass.setPipeline(pipeline)
        pass.draw(3)
        pass.end()
        device.queue.submit([encoder.finish()])
      }
      async function read(texture) {
        const usage = GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST
        const buffer = device.createBuffer({ size: 4 * 192 * 128, usage })
        const encoder = device.createCommandEncoder()
        encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow: 4 * 192 }, size)
        device.queue.submit([encoder.finish()])
        await buffer.mapAsync(GPUMapMode.READ)
        return new Uint32Array(buffer.getMappedRange()).slice()
      }
      const cut = (words) => Uint32Array.from({ length: width * height },
        (_, i) => words[192 * (9 + Math.floor(i / width)) + 7 + (i % width)])
      const bytes = (words) => new Uint8ClampedArray(words.buffer)
      const placed = [{ scene: await sceneOf('knot') }]
      const draws = (options, into) => {
        screen.draw(placed, args[0].camera, { ...args[0].options, ...options, into: { texture, x: 7, y: 9, ...into } })
        return screen.finish()
      }
      drawMesh()
      await draws()
      const first = await read(texture), corner = hash(bytes(cut(first)))
      drawMesh()
      await draws({ alpha: true }, { depth })
      const behind = hash(bytes(cut(await read(texture))))
      const hidden = cut(await read(depth.texture)).map((word) => (word === 0x3f800000 ? 0xffffffff : 4 << 16))
      const targets = { colour: 'premultiplied', occluder: hidden }
      const { colour } = placed[0].scene.render(args[0].camera, { ...args[0].options, targets })
      drawMesh()
      const before = bytes(cut(await read(texture)))
      await draws({ alpha: true }, { depth, over: true })
      const over = bytes(cut(await read(texture)))
      const most = over.reduce((most, byte, i) =>
        Math.max(most, Math.abs(byte - Math.min(255, colour[i] + before[i] * (1 - colour[4 * (i >> 2) + 3] / 255)))), 0)
      const hides = new Set(hidden).size === 2 && hash(colour) !== hash(placed[0].scene.render(args[0].camera,
        { ...args[0].options, alpha: true }))
      return [corner, first[192 * 8 + 6] === 0xffff0000, behind, hash(colour), most, hides]`,
      frame('knot', 160, 100)
    )
    assert.equal(corner, hashOf(frame('knot', 160, 100)))
    assert.equal(edge, true)
    assert.equal(behind, wanted)
    assert.equal(hides, true)
    assert.ok(apart <= 1, `${apart} apart`)
  },

  async '20 Screens are given back'() {
    const [before, after, buffers] = await run(`${COUNTS}
      const shown = canvas(), [core] = (await sceneOf('knot')).inside, sizes = []
      for (let i = 0; i < 20; i++) {
        const screen = await Screen.open(shown, 'webgpu')
        screen.draw([{ scene: await sceneOf('knot') }], args[0].camera, args[0].options)
        if (i % 2) await screen.finish()
        screen.free()
        await new Promise((done) => setTimeout(done, 10))
        sizes.push(core.c.memory.buffer.byteLength)
      }
      undo.forEach((one) => one())
      return [sizes[3], sizes[19], counts.buffers]`, FRAMES['one pixel'])
    assert.equal(after, before)
    assert.equal(buffers, 0)
  },

  async 'errors in words'() {
    const said = await run(
      `const flat = canvas(), plain = await sceneOf('knot', { simd: false }), said = []
      flat.getContext('2d')
      const freed = await Screen.open(canvas(), 'webgpu'), screen = await Screen.open(canvas(), 'webgpu')
      freed.free()
      freed.free()
      const placed = [{ scene: await sceneOf('knot') }], { camera, options } = args[0]
      const note = async (act) => said.push(await wordsOf((async () => act())()))
      await note(() => Screen.open(flat, 'webgpu'))
      await note(() => Screen.open(canvas(), 'webgpu', { simd: false }))
      await note(() => drawn(freed, args[0]))
      await note(() => screen.draw([{ scene: plain }]))
      await note(() => screen.draw(placed, camera, { width: 16384, height: 16384 }))
      await note(() => screen.draw(placed, camera, { ...options, maxMemory: 100000 }) && screen.finish())
      await note(() => screen.draw(placed, camera, { ...options, into: { texture: {} } }))
      const { createBuffer } = GPUDevice.prototype
      GPUDevice.prototype.createBuffer = function (how) {
        return createBuffer.call(this, { ...how, size: how.size > 1000 && !how.mappedAtCreation ? 2 ** 41 : how.size })
      }
      await note(() => screen.draw(placed, camera, { width: 800, height: 600 }) && screen.finish())
      GPUDevice.prototype.createBuffer = createBuffer
      await note(() => drawn(screen, args[0]))
      return [...said, hash(await screen.pixels())]`,
      FRAMES['one pixel']
    )
    const wanted = [/another kind: take another canvas/, /without simd128/, /was freed/, /different modules/,
                    /16384 x 16384 pixels/, /too little memory/, /texture of one of rgba8unorm/, /memory|size/,
                    /nothing/]
    wanted.forEach((words, i) => assert.match(said[i], words))
    assert.equal(said.at(-1), hashOf(FRAMES['one pixel']))
  },

  async 'a shader that does not compile'() {
    const said = await run(`const { createShaderModule } = GPUDevice.prototype
      GPUDevice.prototype.createShaderModule = function ({ code }) {
        return createShaderModule.call(this, { code: code.replace('fn gather_chunks(', 'fn gather_chunks(what ') })
      }
      const device = await (await navigator.gpu.requestAdapter()).requestDevice()
      const words = await wordsOf(Screen.open(canvas(), 'webgpu', { device }))
      GPUDevice.prototype.createShaderModule = createShaderModule
      return words`)
    assert.match(said, /^[a-z_]+ does not compile: line \d+: /)
  },

  async 'a device that is lost in mid-frame'() {
    const [finish, lost, draws, again] = await run(
      `const screen = await Screen.open(canvas(), 'webgpu'), { camera, options } = args[0]
      screen.draw([{ scene: await sceneOf('knot') }], camera, options)
      screen.device.destroy()
      const said = [await wordsOf(screen.finish()), screen.lost, await wordsOf(drawn(screen, args[0]))]
      screen.free()
      const other = await Screen.open(canvas(), 'webgpu')
      return [...said, hash(await drawn(other, args[0]))]`, FRAMES.framed)
    assert.match(finish, /device was lost: open another Screen/)
    assert.equal(lost, true)
    assert.match(draws, /device was lost: open another Screen/)
    assert.equal(again, hashOf(FRAMES.framed))
  },
}

// What takes long, as each page and worker compiles the shaders anew.
const more = {
  async 'scenes of shared/scenes'() {
    const [width, height] = (process.env.SIZE ?? '200x150').split('x').map(Number)
    const some = Object.fromEntries(shared.map((scene) => [scene, frame(scene, width, height)]))
    assert.deepEqual(await run(`const screen = await Screen.open(canvas(), 'webgpu')
      ${DRAWS}
      screen.free()
      return hashes`, some), hashesOf(some))
  },

  async 'a mesh of three.js that stands in a scene: docs/examples/three.js'() {
    const [before, within, behind, apart] = await runIn(browser, 'mesh',
      `const { open } = await import('/examples/three.js')
      const [width, height] = [160, 100], element = Object.assign(document.createElement('canvas'), { width, height })
      const mesh = await open(element, '/work/knot.fxs'), orange = 0xff0080ff
      const read = () => mesh.renderer.readRenderTargetPixelsAsync(mesh.target, 0, 0, width, height)
      const drawAt = async (...at) => {
        mesh.mesh.position.set(...at)
        await mesh.draw([0, 1, 4], [0, 0, 0])
        return read()
      }
      const count = (bytes) => new Uint32Array(bytes.buffer, bytes.byteOffset, width * height)
        .reduce((sum, word) => sum + (word === orange ? 1 : 0), 0)
      const before = count(await drawAt(0, 0.5, 2)), within = count(await drawAt(0.5, 0, 0.3))
      const last = await drawAt(0, 0, -90), options = { width, height, alpha: true }
      const { scene, ...how } = mesh.placed[0], view = { eye: [0, 1, 4], look: [0, 0, 0], up: [0, 1, 0], near: 0.1 }
      const { render } = await import('/fixsplat.js'), wanted = render([{ scene, ...how }], view, options)
      const apart = last.reduce((most, byte, i) => {
        const colour = wanted[i] + [0x20, 0x30, 0x40, 255][i % 4] * (1 - wanted[4 * (i >> 2) + 3] / 255)
        return Math.max(most, Math.abs(byte - Math.min(255, colour)))
      }, 0)
      return [before, within, count(last), apart]`)
    assert.ok(before > 1.2 * within && within > 100, `${before} pixels of the mesh before the scene, ${within} within`)
    assert.equal(behind, 0)
    assert.ok(apart <= 1, `${apart} apart`)
  },

  async 'in a Worker'() {
    const some = [FRAMES.framed, FRAMES['two objects']]
    const hashes = await run(
      `const worker = new Worker('/worker.js', { type: 'module' })
      const given = document.body.appendChild(document.createElement('canvas')).transferControlToOffscreen()
      const said = new Promise((done) => (worker.onmessage = (event) => done(event.data)))
      worker.postMessage({ canvas: given, backend: 'webgpu', frames: args[0] }, [given])
      return said.finally(() => worker.terminate())`, some)
    assert.deepEqual(hashes, some.map(hashOf))
  },
}

await runTests(browser, process.env.FXS_PROCESSORS === 'all' ? { ...tests, ...more } : tests)
