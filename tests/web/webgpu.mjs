// node webgpu.mjs PACKAGE WORK MODULES COMMAND: checks the class Screen when it draws with WebGPU. Its pictures must
// equal the pictures of the command-line program COMMAND.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { readFileSync, writeFileSync } from 'node:fs'
import { WEBGPU } from './flags.mjs'
import {
  command, drawsOverBackdrop, frame, FRAMES, hash, hashOf, launch, near, open, runIn, runTests, shared, work,
} from './screens.mjs'
import { threeGpuTests } from './three.mjs'

const browser = await launch(...WEBGPU)
const { run, page } = await open(browser, 'isolated')

const { 'in bands': bands, 'square cut-off': fog, 'larger again': large, ...most } = FRAMES
const frames = {
  ...most,
  'square cut-off': frame('few', 200, 150, ['--cutoff', 'square', '--bg', 'ffffff'],
                          { cutoff: 'square', background: 0xffffff }),
  'a detail': frame('levels', 200, 150, ['--detail', '2.5'], { detail: 2.5 }),
  'a moving scene': frame('moving', 200, 150),
  'a moving scene beside a still one': frame('knot', 100, 75, ['--eye', '9,-2,-9'], {}, { eye: [9, -2, -9] },
                                             [{ scene: 'moving' }]),
  'first again': FRAMES.framed,
}

const golden = {}
for (const kind of ['knot', 'landscape', 'needles', 'fog', 'layers', 'cubes'])
  for (const profile of ['default', 'compact', 'small'])
    golden[`${kind} ${profile}`] = frame(`${kind}-${profile}`, 96, 64)

const random = ((state) => (low, high) => {
  state = (Math.imul(state, 1664525) + 1013904223) >>> 0
  return low + ((high - low) * state) / 2 ** 32
})(1)
const vector = (...range) => [random(...range), random(...range), random(...range)]
const one = (list) => list[Math.floor(random(0, list.length))]
// A moving scene: the Gaussians of the scene `few` with the columns of motion of SpacetimeGaussians.
function makeMoving() {
  const ply = readFileSync(`${work}/few.ply`)
  const rows = ply.indexOf('end_header') + 11
  const head = ply.toString('latin1', 0, rows)
  const bytes = (ply.length - rows) / head.match(/element vertex (\d+)/)[1]
  const names = [...Array(9).keys()].map((i) => `motion_${i}`).concat([0, 1, 2, 3].map((i) => `omega_${i}`))
  const columns = ['trbf_center', 'trbf_scale', ...names].map((name) => `property float ${name}\n`).join('')
  const parts = [Buffer.from(head.replace('end_header', `${columns}end_header`))]
  for (let at = rows; at < ply.length; at += bytes) {
    const motion = Float32Array.of(random(0, 0.5), random(-1, 0), ...names.map(() => random(-0.5, 0.5)))
    parts.push(ply.subarray(at, at + bytes), Buffer.from(motion.buffer))
  }
  writeFileSync(`${work}/moving.ply`, Buffer.concat(parts))
  execFileSync(command, ['convert', `${work}/moving.ply`, `${work}/moving.fxs`, '--quiet'])
}
makeMoving()

const objectOf = (id) => ({
  scene: one(['knot', 'levels', 'needles-default', 'fog-small', 'cubes-compact']),
  translation: vector(-2, 2),
  rotation: [random(0.1, 1), ...vector(-1, 1)],
  scale: random(0.3, 1.2),
  opacity: random(0.3, 1),
  tint: vector(0, 2),
  visible: random(0, 1) < 0.9,
  id: 1000 * id,
  crops: random(0, 1) < 0.4 ? [{ low: vector(-4, -1), high: vector(1, 4), keep: one(['inside', 'outside']) }] : [],
})
const DEPTH_BITS = 26
function randomFrame(_, i) {
  const objects = Array.from({ length: 1 + i }, (_, id) => objectOf(id))
  const [[x, y], budget, file] = [vector(-3, 3), i % 2 ? 5000 : 0, `${work}/random-${i}.json`]
  const size = [Math.floor(random(1, 120)), Math.floor(random(1, 90))]
  const text = { objects: objects.map(({ scene, ...how }) => ({ file: `${scene}.fxs`, ...how })) }
  writeFileSync(file, JSON.stringify(text))
  return {
    objects,
    camera: { eye: [x, y, -18], look: [0, 0, 0], fov: 40, near: 0.5 },
    options: { width: size[0], height: size[1], alpha: i % 3 > 0, budget, depthBits: DEPTH_BITS },
    args: ['--scene', file, '--size', size.join('x'), '--eye', `${x},${y},-18`, '--look', '0,0,0', '--fov', '40',
           '--near', '0.5', ...(budget ? ['--budget', budget] : []), ...(i % 3 ? ['--alpha'] : [])],
  }
}

function filesOf({ args }) {
  const names = ['colour.raw', 'ids.raw', 'depth.pfm', 'meanDepth.pfm'].map((name) => `${work}/${name}`)
  for (const [kind, at] of [['median', 2], ['mean', 3]])
    execFileSync(command, ['render', ...args, '-o', names[0], '--ids', names[1], '--depth', names[at],
                           '--depth-kind', kind, '--quiet'])
  const [colour, ids, depth, meanDepth] = names.map((name) => hash(readFileSync(name)))
  return { colour, ids, depth, meanDepth }
}

const hashesOf = (some) => Object.fromEntries(Object.entries(some).map(([name, frame]) => [name, hashOf(frame)]))
const DRAWS = `const hashes = {}
  for (const [name, frame] of Object.entries(args[0])) hashes[name] = hash(await drawn(screen, frame))`

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

  async 'the golden scenes in each profile'() {
    const hashes = await run(`const screen = await Screen.open(canvas(), 'webgpu')
      ${DRAWS}
      screen.free()
      return hashes`, golden)
    assert.deepEqual(hashes, hashesOf(golden))
  },

  async 'random objects: colours, ids and depths in buffers of the caller'() {
    const some = Array.from({ length: 6 }, randomFrame)
    const hashes = await run(`const screen = await Screen.open(null, 'webgpu'), seen = []
      const usage = GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST
      const filled = (codes, { width, height, depthBits }) => new Uint8Array([
        ...new TextEncoder().encode('Pf\\n' + width + ' ' + height + '\\n-1.0\\n'),
        ...new Uint8Array(Float32Array.from({ length: width * height }, (_, i) => {
          const code = codes[width * (height - 1 - Math.floor(i / width)) + (i % width)]
          return code === 0xffffffff ? Infinity : code / 2 ** depthBits
        }).buffer)])
      for (const frame of args[0]) {
        const { options } = frame, targets = {}, hashes = {}
        for (const [name, words] of Object.entries({ colour: 1, ids: 2, depth: 1, meanDepth: 1 }))
          targets[name] = screen.device.createBuffer({ size: 4 * words * options.width * options.height, usage })
        await drawn(screen, { ...frame, options: { ...options, targets } })
        for (const [name, buffer] of Object.entries(targets)) {
          await buffer.mapAsync(GPUMapMode.READ)
          const codes = new Uint32Array(buffer.getMappedRange())
          hashes[name] = hash(/epth/.test(name) ? filled(codes, options) : new Uint8Array(codes.buffer))
        }
        seen.push(hashes)
      }
      screen.free()
      return seen`, some)
    assert.deepEqual(hashes, some.map(filesOf))
  },

  async 'without threads, in parts of a device with small buffers'() {
    const devices = [[1000000, 'knot', { framed: frame('knot', 160, 100) }],
                     [500000, 'levels', { budget: frame('levels', 100, 75, ['--budget', '6000'], { budget: 6000 }) }]]
    const seen = await runIn(browser, '',
      `const device = await (await navigator.gpu.requestAdapter()).requestDevice(), seen = []
      const { maxBufferSize, maxTextureDimension2D } = device.limits
      const { createBuffer } = GPUDevice.prototype
      let largest
      GPUDevice.prototype.createBuffer = function (how) {
        if (how.usage & GPUBufferUsage.STORAGE) largest = Math.max(largest, how.size)
        return createBuffer.call(this, how)
      }
      for (const [most, name, frames] of args[0]) {
        largest = 0
        const limits = { maxStorageBufferBindingSize: most, maxBufferSize, maxTextureDimension2D }
        Object.defineProperty(device, 'limits', { value: limits, configurable: true })
        const screen = await Screen.open(canvas(), 'webgpu', { device }), [core, at] = (await sceneOf(name)).inside
        ${DRAWS.replace('args[0]', 'frames')}
        screen.free()
        seen.push([hashes, core.c.gpu_parts(core.c.gpu_open(most), at), largest <= most])
      }
      return seen`,
      devices
    )
    assert.deepEqual(seen, devices.map(([, , frames], i) => [hashesOf(frames), [2, 6][i], true]))
  },

  async 'a streamed scene: partly there, whole, from elsewhere, in a pool that evicts, and in one too small'() {
    const of = (eye) => frame('parts', 96, 64, ['--budget', '12000', '--eye', `${eye}`], { budget: 12000 }, { eye })
    const views = [of([2, -1, -4]), of([-3, 2, 3])], wanted = views.map(hashOf)
    const [first, half, seen, told, moves, small, left] = await run(`${COUNTS}
      const { load, render } = await import('/fixsplat.js')
      let told = 0
      const changed = (error) => (told += !error)
      const scene = await load('/work/parts.fxs?ranges', { paging: { changed, cache: 0 } }), placed = [{ scene }]
      // draws until the device has all chunks in memory that the picture needs; compares with the processor
      async function settled(screen, { camera, options }) {
        const still = { ...options, fetch: false }
        const { missing, colour } = render(placed, camera, { ...still, targets: { colour: true } })
        for (let i = 1; i < 100; i++) {
          const facts = screen.draw(placed, camera, still)
          const now = hash(await screen.pixels())
          if (facts.missing === missing) return { missing, now, wanted: hash(colour), draws: i }
        }
        throw new Error('the device never has what is in memory')
      }
      const screen = await Screen.open(canvas(), 'webgpu'), [{ camera, options }] = args
      const first = await settled(screen, args[0])
      await scene.complete(camera, { ...options, budget: 8000 })
      const half = await settled(screen, args[0]), seen = []
      for (const view of args) {
        const facts = screen.draw(placed, view.camera, view.options)
        await scene.complete(view.camera, view.options)
        seen.push([facts.missing, await settled(screen, view)])
      }
      screen.free()
      const few = await Screen.open(canvas(), 'webgpu', { pool: 60 * scene.bytes / 469 }), moves = []
      for (const view of [...args, ...args]) {
        await scene.complete(view.camera, view.options)
        const { bytes } = counts
        const { now } = await settled(few, view)
        moves.push([now, counts.bytes - bytes])
      }
      few.free()
      const none = await Screen.open(canvas(), 'webgpu', { pool: 15 * scene.bytes / 469 })
      const small = await wordsOf((async () => none.draw(placed, camera, options))())
      none.free()
      undo.forEach((one) => one())
      scene.free()
      return [first, half, seen, told, moves, small, counts.buffers]`, ...views)
    for (const { missing, now, wanted } of [first, half]) assert.ok(missing > 0 && now === wanted, `${missing}, ${now}`)
    assert.equal(new Set([first.now, half.now, ...wanted]).size, 4)
    seen.forEach(([before, { missing, now }], i) => assert.deepEqual([before > 0, missing, now], [true, 0, wanted[i]]))
    assert.ok(told > 0)
    for (const [i, [now, bytes]] of moves.entries())
      assert.ok(now === wanted[i % 2] && bytes > 50000, `${i}: ${now}, ${bytes} bytes`)
    assert.match(small, /the device's pool has no room for 16 chunks/)
    assert.equal(left, 0)
  },

  async 'nothing is shown before it is whole'() {
    const [first, second, third] = await run(`${COUNTS}
      const screen = await Screen.open(canvas(), 'webgpu'), placed = [{ scene: await sceneOf('knot') }], seen = []
      for (let i = 0; i < 3; i++) {
        Object.assign(counts, { submit: 0, getCurrentTexture: 0, bytes: 0 })
        screen.draw(placed, args[0].camera, args[0].options)
        await screen.finish()
        seen.push({ ...counts })
      }
      undo.forEach((one) => one())
      screen.free()
      return seen`, frame('knot', 640, 360, [], {}, near))
    for (const each of [first, second, third]) assert.deepEqual([each.submit, each.getCurrentTexture], [1, 1])
    // the first frame does not fit, so the second has new buffers, with a table of opacities
    assert.ok(second.bytes > third.bytes && third.bytes < 4096, `${second.bytes}, ${third.bytes} bytes a frame`)
    console.log(`  ${third.bytes} bytes of a frame move between processor and device`)
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

  'a backdrop: the bytes that are rendered over it': () => drawsOverBackdrop(run, 'webgpu'),

  async 'two eyes on one canvas'() {
    const some = [frame('few', 40, 30), frame('few', 40, 30, ['--eye', '2,-1,-4'], {}, { eye: [2, -1, -4] })]
    const [hashes, beyond] = await run(`const shown = new OffscreenCanvas(80, 30)
      const screen = await Screen.open(shown, 'webgpu'), placed = [{ scene: await sceneOf('few') }]
      const flat = new OffscreenCanvas(80, 30).getContext('2d')
      for (const [i, { camera, options }] of args[0].entries()) {
        screen.draw(placed, camera, { ...options, into: { x: 40 * i } })
        await screen.finish()
      }
      flat.drawImage(shown.transferToImageBitmap(), 0, 0)
      const hashes = [0, 40].map((x) => hash(flat.getImageData(x, 0, 40, 30).data))
      const beyond = await wordsOf((async () => screen.draw(placed, {}, { width: 41, height: 30, into: { x: 40 } }))())
      screen.free()
      return [hashes, beyond]`, some)
    assert.deepEqual(hashes, some.map(hashOf))
    assert.match(beyond, /41 x 30 pixels from 40, 0 on do not lie/)
  },

  async 'two eyes in one submission: side by side, in two textures, in two layers'() {
    const [width, height] = [72, 50]
    const cameras = [-0.25, 0.25].map((x) => ({ eye: [x, -2, -9], look: [x, -2, 0], near: 0.5 }))
    for (const budget of [0, 6000]) {
      execFileSync(command, ['render', `${work}/levels.fxs`, '--size', `${width}x${height}`, '--eye', '0,-2,-9',
                             '--look', '0,-2,0', '--near', '0.5', '--stereo', '0.5', '--quiet', '-o',
                             `${work}/pair.raw`, ...(budget ? ['--budget', budget] : [])])
      const [pair, row] = [readFileSync(`${work}/pair.raw`), 4 * width]
      const rowOf = (at) => pair.subarray(row * at, row * (at + 1))
      const rows = (eye) => Array.from({ length: height }, (_, y) => rowOf(2 * y + eye))
      const wanted = [0, 1].map((eye) => hash(Buffer.concat(rows(eye))))
      const [hashes, submits, size, said] = await run(`${COUNTS}
        const { cameras, options } = args[0], { width, height } = options
        const shown = new OffscreenCanvas(1, 1), screen = await Screen.open(shown, 'webgpu'), { device } = screen
        const placed = [{ scene: await sceneOf('levels') }], hashes = []
        const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC
        const made = (layers) => device.createTexture({ size: [192, 64, layers], format: 'rgba8unorm', usage })
        async function hashAt({ texture, x = 0, y = 0, layer = 0 }) {
          const usage = GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST, bytesPerRow = 4 * 192
          const buffer = device.createBuffer({ size: bytesPerRow * 64, usage }), encoder = device.createCommandEncoder()
          encoder.copyTextureToBuffer({ texture, origin: [x, y, layer] }, { buffer, bytesPerRow }, [width, height])
          device.queue.submit([encoder.finish()])
          await buffer.mapAsync(GPUMapMode.READ)
          const bytes = new Uint8Array(buffer.getMappedRange()), row = 4 * width
          const pixels = new Uint8Array(row * height)
          for (let i = 0; i < height; i++) pixels.set(bytes.subarray(i * bytesPerRow, i * bytesPerRow + row), i * row)
          return hash(pixels)
        }
        const draws = async (into) => {
          screen.draw(placed, cameras, { ...options, into })
          await screen.finish()
        }
        await draws()
        counts.submit = 0
        await draws()
        const submits = counts.submit, size = [shown.width, shown.height]
        const flat = new OffscreenCanvas(...size).getContext('2d')
        flat.drawImage(shown.transferToImageBitmap(), 0, 0)
        hashes.push([0, width].map((x) => hash(flat.getImageData(x, 0, width, height).data)))
        const one = made(1), layers = made(2)
        for (const into of [[{ texture: made(1) }, { texture: made(1), x: 5, y: 9 }],
                            [{ texture: layers }, { texture: layers, layer: 1 }],
                            [{ texture: one, x: 7 }, { texture: one, x: 7 + width }]]) {
          await draws(into)
          hashes.push([await hashAt(into[0]), await hashAt(into[1])])
        }
        await draws({ texture: one, x: 3, y: 2 })
        hashes.push([await hashAt({ texture: one, x: 3, y: 2 }), await hashAt({ texture: one, x: 3 + width, y: 2 })])
        screen.draw(placed, cameras[1], { ...options, into: { texture: one } })
        await screen.finish()
        if (!options.budget) hashes.push([hashes[0][0], await hashAt({ texture: one })])   // one eye has its own cut
        const said = [await wordsOf(draws({ texture: one, x: 60 })), await wordsOf(draws([{ texture: one }]))]
        undo.forEach((one) => one())
        screen.free()
        const plain = await Screen.open(canvas(), 'wasm')
        said.push(await wordsOf((async () => plain.draw(placed, cameras, options))()))
        plain.free()
        return [hashes, submits, size, said]`, { cameras, options: { width, height, budget } })
      assert.deepEqual([hashes, submits, size], [Array(budget ? 5 : 6).fill(wanted), 1, [2 * width, height]])
      const words = [/72 x 50 pixels from 132, 0 on do not lie/, /expected one target for each eye/,
                     /only WebGPU draws two eyes/]
      words.forEach((one, i) => assert.match(said[i], one))
    }
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
    const amid = frame('knot', 160, 100, ['--eye', '0,-1,-8', '--near', '0.5'], {}, { eye: [0, -1, -8], near: 0.5 })
    const [corner, edge, behind, wanted, apart, hides] = await run(
      `const screen = await Screen.open(null, 'webgpu'), { device } = screen, { width, height } = args[0].options
      const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC | GPUTextureUsage.TEXTURE_BINDING
      const size = [192, 128], made = (format) => device.createTexture({ size, format, usage })
      const texture = made('rgba8unorm'), depth = { texture: made('depth32float'), planes: [0.25, Infinity] }
      // A triangle at a depth of 8, amid the knot, and what is not covered as far as can be.
      const code = \`@vertex fn at(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32>
        { return vec4<f32>(f32(i % 2u) * 1.4 - 0.8, f32(i / 2u) * 1.3 - 0.7, 0.96875, 1.0); }
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
      await draws({ alpha: true, depthBits: 20 }, { depth })
      const behind = hash(bytes(cut(await read(texture))))
      const hidden = cut(await read(depth.texture)).map((word) => (word === 0x3f800000 ? 0xffffffff : 8 << 20))
      const targets = { colour: 'premultiplied', occluder: hidden }
      const { colour } = placed[0].scene.render(args[0].camera, { ...args[0].options, depthBits: 20, targets })
      drawMesh()
      const before = bytes(cut(await read(texture)))
      await draws({ alpha: true }, { depth, over: true })
      const over = bytes(cut(await read(texture)))
      const most = over.reduce((most, byte, i) =>
        Math.max(most, Math.abs(byte - Math.min(255, colour[i] + before[i] * (1 - colour[4 * (i >> 2) + 3] / 255)))), 0)
      const hides = new Set(hidden).size === 2 && hash(colour) !== hash(placed[0].scene.render(args[0].camera,
        { ...args[0].options, alpha: true }))
      return [corner, first[192 * 8 + 6] === 0xffff0000, behind, hash(colour), most, hides]`,
      amid
    )
    assert.equal(corner, hashOf(amid))
    assert.equal(edge, true)
    assert.equal(behind, wanted)
    assert.equal(hides, true)
    assert.ok(apart <= 1, `${apart} apart`)
  },

  async 'the time of a picture, where the device tells it'() {
    const [has, milliseconds, took] = await run(`const screen = await Screen.open(canvas(), 'webgpu')
      const start = performance.now()
      await drawn(screen, args[0])
      const seen = [screen.device.features.has('timestamp-query'), screen.milliseconds, performance.now() - start]
      screen.free()
      return seen`, FRAMES.framed)
    console.log(`  timestamp-query: ${has}, ${milliseconds} of ${took} ms`)
    if (has) assert.ok(milliseconds > 0 && milliseconds < took)
    else assert.equal(milliseconds ?? null, null)
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
      await note(() => screen.draw(placed, camera, { width: 0, height: 0 }))
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
                    /16384 x 16384 pixels/, /too little memory/, /0 x 0 pixels/, /memory|size/, /nothing/]
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

  async 'a canvas of no size'() {
    const hashes = await run(`const empty = new OffscreenCanvas(0, 0), screen = await Screen.open(empty, 'webgpu')
      const hashes = [hash(await drawn(screen, args[0]))]
      Object.assign(empty, { width: 0, height: 0 })
      hashes.push(hash(await drawn(screen, args[0])), empty.width)
      screen.free()
      return hashes`, FRAMES['one pixel'])
    assert.deepEqual(hashes, [hashOf(FRAMES['one pixel']), hashOf(FRAMES['one pixel']), 1])
  },

  async 'textures and buffers that cannot be drawn into: one line, and nothing is drawn'() {
    const [said, kept, again] = await run(
      `const screen = await Screen.open(null, 'webgpu'), { device } = screen, said = []
      const other = await (await navigator.gpu.requestAdapter()).requestDevice()
      const { RENDER_ATTACHMENT, TEXTURE_BINDING, COPY_SRC } = GPUTextureUsage, { COPY_DST, MAP_READ } = GPUBufferUsage
      const usage = RENDER_ATTACHMENT | TEXTURE_BINDING | COPY_SRC
      const made = (how, of = device) => of.createTexture({ size: [8, 8], format: 'rgba8unorm', usage, ...how })
      const depthOf = (how, of) => ({ texture: made({ format: 'depth32float', ...how }, of), planes: [1, 9] })
      const bufferOf = (how, of = device) => of.createBuffer({ size: 8, usage: COPY_DST, ...how })
      const texture = made(), gone = made(), placed = [{ scene: await sceneOf('knot') }]
      gone.destroy()
      const draws = async (into, options) => {
        screen.draw(placed, args[0].camera, { ...args[0].options, into, ...options })
        await screen.finish()
      }
      for (const [into, options] of [
        [], [{}], [{ texture: made({ format: 'r8unorm' }) }], [{ texture: made({ usage: COPY_SRC }) }],
        [{ texture, x: 8 }], [{ texture: made({ sampleCount: 4, usage: RENDER_ATTACHMENT | TEXTURE_BINDING }) }],
        [{ texture: made({}, other) }], [{ texture: gone }], [{ texture, depth: { planes: [1, 9] } }],
        [{ texture, depth: depthOf({ format: 'stencil8' }) }], [{ texture, depth: depthOf({ usage: COPY_SRC }) }],
        [{ texture, x: 1, depth: depthOf({ size: [1, 8] }) }], [{ texture, depth: depthOf({}, other) }],
        [{ texture, depth: { ...depthOf(), planes: [1, 0] } }],
        [{ texture, depth: { ...depthOf(), planes: [1, Infinity], linear: true } }], [{ texture, over: true }],
        [{ texture }, { targets: { grey: bufferOf() } }], [{ texture }, { targets: { ids: bufferOf({ size: 4 }) } }],
        [{ texture }, { targets: { ids: bufferOf({ usage: GPUBufferUsage.STORAGE }) } }],
        [{ texture }, { targets: { depth: bufferOf({}, other) } }],
        [{ texture }, { depthBits: 29 }],
      ]) said.push(await wordsOf(draws(into, options)))
      const usual = { size: 2048, usage: COPY_DST | MAP_READ }, buffer = device.createBuffer(usual)
      const encoder = device.createCommandEncoder()
      encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow: 256 }, [8, 8])
      device.queue.submit([encoder.finish()])
      await buffer.mapAsync(GPUMapMode.READ)
      const kept = new Uint32Array(buffer.getMappedRange()).every((word) => !word)
      await draws({ texture })
      const again = hash(await screen.pixels())
      screen.free()
      return [said, kept, again]`,
      FRAMES['one pixel']
    )
    const wanted = [/without a canvas/, /texture of one of rgba8unorm/, /texture of one of rgba8unorm/,
                    /`into` needs a texture with the usage RENDER_ATTACHMENT/, /from 8, 0 on do not lie/,
                    /do not lie/, /cannot be used with/, /[Dd]estroyed texture/, /a texture of depths/,
                    /a texture of depths/, /`into.depth` needs a texture with the usage TEXTURE_BINDING/,
                    /do not lie in the texture of `into.depth`/, /cannot be used with/, /two planes/, /finite planes/,
                    /needs `alpha`/, /grey: expected one of colour/, /ids needs a buffer of 8 bytes/,
                    /with the usage COPY_DST/, /cannot be used with/, /depthBits 29/]
    wanted.forEach((words, i) => assert.match(said[i], words))
    assert.equal(said.length, wanted.length)
    assert.ok(said.every((words) => !words.includes('\n')), said.join('; '))
    assert.equal(kept, true)
    assert.equal(again, hashOf(FRAMES['one pixel']))
  },

  async 'a device that is lost: before a frame, between two, in one, and while a Screen opens; or not to be had'() {
    const [said, shown, lost, again] = await run(
      `const said = [], { camera, options } = args[0], placed = [{ scene: await sceneOf('knot') }]
      const note = async (act) => said.push(await wordsOf((async () => act())()))
      const [before, between, within] = await Promise.all([1, 2, 3].map(() => Screen.open(canvas(), 'webgpu')))
      await drawn(between, args[0])
      ${COUNTS}
      const { submit } = GPUQueue.prototype
      GPUQueue.prototype.submit = function (list) {
        submit.call(this, list)
        within.device.destroy()
      }
      within.draw(placed, camera, options)
      await note(() => within.finish())
      GPUQueue.prototype.submit = submit
      await note(() => between.pixels())
      for (const screen of [before, between, within]) await note(() => drawn(screen, args[0]))
      undo.forEach((one) => one())
      const lost = [before, between, within].map((screen) => screen.lost), { device } = before
      for (const screen of [before, between, within]) screen.free()
      await note(() => Screen.open(canvas(), 'webgpu', { device }))
      const { requestAdapter } = GPU.prototype, { requestDevice } = GPUAdapter.prototype
      GPU.prototype.requestAdapter = async () => null
      await note(() => Screen.open(canvas(), 'webgpu'))
      GPU.prototype.requestAdapter = requestAdapter
      GPUAdapter.prototype.requestDevice = function () {
        return requestDevice.call(this, { requiredLimits: { maxBufferSize: 2 ** 50 } })
      }
      await note(() => Screen.open(canvas(), 'webgpu'))
      GPUAdapter.prototype.requestDevice = async function (how) {
        const made = await requestDevice.call(this, how)
        made.destroy()
        return made
      }
      await note(() => Screen.open(canvas(), 'webgpu'))
      GPUAdapter.prototype.requestDevice = requestDevice
      const other = await Screen.open(canvas(), 'webgpu')
      return [said, counts.getCurrentTexture, lost, hash(await drawn(other, args[0]))]`, FRAMES.framed)
    const wanted = [...Array(6).fill(/^the WebGPU device was lost: open another Screen$/), /^there is no WebGPU here$/,
                    /^there is no WebGPU device: [^\n]*limit[^\n]*$/, /device was lost/]
    wanted.forEach((words, i) => assert.match(said[i], words))
    // the frame whose submission lost the device had taken the canvas's texture
    assert.deepEqual([shown, lost, again], [1, [true, true, true], hashOf(FRAMES.framed)])
  },
}

const more = {
  async 'scenes of shared/scenes'() {
    const [width, height] = (process.env.SIZE ?? '200x150').split('x').map(Number)
    const some = Object.fromEntries(shared.map((scene) => [scene, frame(scene, width, height)]))
    assert.deepEqual(await run(`const screen = await Screen.open(canvas(), 'webgpu')
      ${DRAWS}
      screen.free()
      return hashes`, some), hashesOf(some))
  },

  async 'a mesh that stands in a scene: docs/examples/playcanvas.js'() {
    const [before, within, behind, apart] = await runIn(browser, 'mesh',
      `const { open } = await import('/examples/playcanvas.js')
      const [width, height] = [160, 100], element = Object.assign(document.createElement('canvas'), { width, height })
      const mesh = await open(element, '/work/knot.fxs'), orange = 0xff0080ff
      const flat = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })
      const shownAt = async (...at) => {
        mesh.mesh.setPosition(...at)
        await mesh.draw([0, 1, 4], [0, 0, 0])
        flat.drawImage(element, 0, 0)
        return flat.getImageData(0, 0, width, height).data
      }
      const count = (bytes) => new Uint32Array(bytes.buffer).reduce((sum, word) => sum + (word === orange ? 1 : 0), 0)
      const before = count(await shownAt(0, 0.5, 2)), within = count(await shownAt(0.5, 0, 0.3))
      const last = await shownAt(0, 0, -90), options = { width, height, alpha: true }
      const { scene, ...how } = mesh.placed[0], view = { eye: [0, 1, 4], look: [0, 0, 0], up: [0, 1, 0], near: 0.1 }
      const { render } = await import('/fixsplat.js'), wanted = render([{ scene, ...how }], view, options)
      const apart = last.reduce((most, byte, i) => {
        const colour = wanted[i] + [0x20, 0x30, 0x40, 255][i % 4] * (1 - wanted[4 * (i >> 2) + 3] / 255)
        return Math.max(most, Math.abs(byte - Math.min(255, colour)))
      }, 0)
      return [before, within, count(last), apart]`)
    console.log(`  ${before} pixels of the mesh before the scene, ${within} within`)
    assert.ok(before > 1.2 * within && within > 100, 'nothing of the mesh is hidden, or all')
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

await runTests(browser, process.env.FXS_PROCESSORS === 'all' ? { ...tests, ...more, ...threeGpuTests(browser) } : tests)
