// node webgl.mjs PACKAGE WORK MODULES COMMAND [1]: checks the class Screen when it draws with WebGL 2. Its pictures
// must equal the pictures of the command-line program COMMAND. With the argument 1, also times it.
import assert from 'node:assert/strict'
import { readFileSync } from 'node:fs'
import { WEBGL } from './flags.mjs'
import { playcanvasTests } from './playcanvas.mjs'
import { drawsOverBackdrop, frame, FRAMES, hashOf, launch, open, runIn, runTests, shared, work } from './screens.mjs'
import { threeTests } from './three.mjs'

const browser = await launch(...WEBGL)
const { run } = await open(browser, 'isolated')

const tests = {
  async 'the pixels of the command: webgl2, one Screen'() {
    const wanted = Object.fromEntries(Object.entries(FRAMES).map(([name, frame]) => [name, hashOf(frame)]))
    for (const address of ['isolated', '']) {
      const [hashes, kind] = await runIn(browser, address,
        `const screen = await Screen.open(canvas(), 'webgl2'), hashes = {}
        for (const [name, frame] of Object.entries(args[0])) {
          hashes[name] = hash(await drawn(screen, frame))
          await screen.finish()
          if (screen.gl.getError()) hashes[name] += ' and an error of WebGL'
        }
        screen.free()
        const [core] = (await sceneOf('knot')).inside
        return [hashes, core.c.memory.buffer.constructor.name]`,
        FRAMES
      )
      assert.deepEqual(hashes, wanted)
      assert.equal(kind, address ? 'SharedArrayBuffer' : 'ArrayBuffer')
    }
  },

  async 'a browser whose WebGL takes no shared memory'() {
    const got = await runIn(browser, 'isolated',
      `const prototype = WebGL2RenderingContext.prototype
      for (const name of ['readPixels', 'texSubImage2D']) {
        const was = prototype[name]
        prototype[name] = function (...values) {
          if (values.some((value) => value?.buffer instanceof SharedArrayBuffer)) throw new TypeError('shared')
          return was.apply(this, values)
        }
      }
      return hash(await drawn(await Screen.open(canvas(), 'webgl2'), args[0]))`,
      FRAMES.framed
    )
    assert.equal(got, hashOf(FRAMES.framed))
  },

  async 'the same by wasm'() {
    const frames = [FRAMES.framed, FRAMES['coverage, SH degree 1']]
    const hashes = await run(
      `const screen = await Screen.open(canvas(), 'wasm')
      return [hash(await drawn(screen, args[0])), hash(await drawn(screen, args[1])), screen.lost, screen.backend]`,
      ...frames
    )
    assert.deepEqual(hashes, [...frames.map(hashOf), false, 'wasm'])
  },

  async 'scenes of shared/scenes'() {
    for (const scene of shared) {
      const one = frame(scene, 200, 150)
      const got = await runIn(
        browser,
        'isolated',
        `return hash(await drawn(await Screen.open(canvas(), 'webgl2'), args[0]))`,
        one
      )
      assert.equal(got, hashOf(one), scene)
    }
  },

  async 'what the page shows'() {
    const shown = await run(
      `const seen = []
      for (const backend of ['wasm', 'webgl2']) {
        const element = document.body.appendChild(document.createElement('canvas'))
        const screen = await Screen.open(element, backend)
        await drawn(screen, args[0])
        await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))
        const flat = new OffscreenCanvas(element.width, element.height).getContext('2d', { willReadFrequently: true })
        flat.drawImage(element, 0, 0)
        seen.push(hash(flat.getImageData(0, 0, element.width, element.height).data), hash(screen.pixels()))
      }
      return seen`,
      FRAMES.framed
    )
    assert.deepEqual(shown, Array(4).fill(hashOf(FRAMES.framed)))
  },

  async 'coverage over a page'() {
    const rest = await run(
      `const flats = []
      for (const backend of ['wasm', 'webgl2']) {
        const shown = canvas(), screen = await Screen.open(shown, backend)
        await drawn(screen, args[0])
        const { width, height } = shown
        const flat = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })
        flat.fillStyle = '#fff'
        flat.fillRect(0, 0, width, height)
        flat.drawImage(shown, 0, 0)
        flats.push(flat.getImageData(0, 0, width, height).data)
      }
      return flats[0].reduce((most, byte, i) => Math.max(most, Math.abs(byte - flats[1][i])), 0)`,
      FRAMES['coverage, SH degree 1']
    )
    assert.ok(rest <= 2, `wasm and webgl2 are ${rest} apart`)
  },

  'a backdrop: the bytes that are rendered over it': () => drawsOverBackdrop(run, 'webgl2', 'wasm'),

  async 'a corner of a framebuffer'() {
    const [got, around, kept] = await run(
      `const screen = await Screen.open(canvas(), 'webgl2'), { gl } = screen
      const { width, height } = args[0].options
      const rows = new Uint8Array(4 * width * height), edge = new Uint8Array(4)
      gl.bindTexture(gl.TEXTURE_2D, gl.createTexture())
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width + 9, height + 5)
      const framebuffer = gl.createFramebuffer()
      gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer)
      const texture = gl.getParameter(gl.TEXTURE_BINDING_2D)
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0)
      gl.clearBufferfv(gl.COLOR, 0, [1, 0, 1, 1])
      const scene = await sceneOf('knot')
      gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, true)
      gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, true)
      screen.draw([{ scene }], args[0].camera, { ...args[0].options, into: { framebuffer, x: 7, y: 3 } })
      const kept = gl.getParameter(gl.UNPACK_FLIP_Y_WEBGL) && gl.getParameter(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL)
      gl.readPixels(7, 3, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rows)
      gl.readPixels(6, 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, edge)
      const row = 4 * width
      const upright = rows.map((_, i) => rows[row * (height - 1 - Math.floor(i / row)) + (i % row)])
      return [hash(upright), [...edge].join(), kept]`,
      FRAMES.framed
    )
    assert.deepEqual([got, around, kept], [hashOf(FRAMES.framed), '255,0,255,255', true])
  },

  async 'Screens in turn'() {
    const hashes = await run(
      `const a = await Screen.open(canvas(), 'webgl2'), b = await Screen.open(canvas(), 'webgl2'), got = []
      for (let i = 0; i < 2; i++) got.push(hash(await drawn(a, args[0])), hash(await drawn(b, args[1])))
      a.free()
      got.push(hash(await drawn(b, args[0])))
      b.free()
      return got`,
      FRAMES.framed,
      FRAMES['one pixel']
    )
    const [first, second] = [hashOf(FRAMES.framed), hashOf(FRAMES['one pixel'])]
    assert.deepEqual(hashes, [first, second, first, second, first])
  },

  async 'in a Worker'() {
    const frames = [FRAMES.framed, FRAMES['two objects']]
    for (const backend of ['wasm', 'webgl2']) {
      const hashes = await run(
        `const worker = new Worker('/worker.js', { type: 'module' })
        const element = document.body.appendChild(document.createElement('canvas'))
        const given = element.transferControlToOffscreen()
        const said = new Promise((done) => (worker.onmessage = (event) => done(event.data)))
        worker.postMessage({ canvas: given, backend: args[0], frames: args[1] }, [given])
        return said.finally(() => worker.terminate())`,
        backend,
        frames
      )
      assert.deepEqual(hashes, frames.map(hashOf), backend)
    }
  },

  async 'a lost context'() {
    const [lost, draws, opens, still, stays, again] = await run(
      `const element = canvas(), screen = await Screen.open(element, 'webgl2')
      await drawn(screen, args[0])
      screen.gl.getExtension('WEBGL_lose_context').loseContext()
      const said = [screen.lost, await wordsOf(drawn(screen, args[0])), await wordsOf(Screen.open(element, 'webgl2'))]
      screen.free()
      const given = canvas(), back = await Screen.open(given, 'webgl2')
      given.addEventListener('webglcontextlost', (event) => event.preventDefault())
      const lose = back.gl.getExtension('WEBGL_lose_context'), 
        restored = new Promise((done) => given.addEventListener('webglcontextrestored', done))
      lose.loseContext()
      await new Promise((done) => setTimeout(done, 50))
      lose.restoreContext()
      await restored
      said.push(back.lost, await wordsOf(drawn(back, args[0])))
      const other = await Screen.open(canvas(), 'webgl2')
      return [...said, hash(await drawn(other, args[0]))]`,
      FRAMES.framed
    )
    assert.equal(lost, true)
    assert.match(draws, /context was lost: open another Screen/)
    assert.match(opens, /context is lost: take another canvas/)
    assert.equal(still, true)
    assert.match(stays, /context was lost: open another Screen/)
    assert.equal(again, hashOf(FRAMES.framed))
  },

  async '50 Screens are given back'() {
    const [before, after, objects] = await run(
      `const KINDS = ['Buffer', 'Framebuffer', 'Program', 'Renderbuffer', 'Shader', 'Texture', 'VertexArray']
      const prototype = WebGL2RenderingContext.prototype
      let objects = 0, most = 0
      for (const kind of KINDS)
        for (const [verb, step] of [['create', 1], ['delete', -1]]) {
          const was = prototype[verb + kind]
          prototype[verb + kind] = function (...values) {
            objects += step
            most = Math.max(most, objects)
            return was.apply(this, values)
          }
        }
      const shown = canvas(), [core] = (await sceneOf('knot')).inside, sizes = []
      for (let i = 0; i < 50; i++) {
        const screen = await Screen.open(shown, 'webgl2')
        await drawn(screen, args[0])
        screen.free()
        sizes.push(core.c.memory.buffer.byteLength)
      }
      return [sizes[3], sizes[49], most && objects]`,
      FRAMES.framed
    )
    assert.equal(after, before)
    assert.equal(objects, 0)
  },

  async 'errors in words'() {
    const said = await run(
      `const flat = canvas(), plain = await sceneOf('knot', { simd: false })
      flat.getContext('2d')
      const freed = await Screen.open(canvas(), 'webgl2')
      freed.free()
      freed.free()
      const screen = await Screen.open(canvas(), 'webgl2')
      const full = await Screen.open(canvas(), 'webgl2'), { c } = (await sceneOf('knot')).inside[0], { allocate } = c
      c.allocate = () => 0
      const words = await wordsOf(drawn(full, args[0]))
      c.allocate = allocate
      return [words, await wordsOf(drawn(full, args[0])), await wordsOf(Screen.open(flat, 'webgl2')),
        await wordsOf(Screen.open(screen.gl.canvas, 'wasm')),
        await wordsOf(Screen.open(canvas(), 'webgl')), await wordsOf(Screen.open(canvas(), 'webgl2', { simd: false })),
        await wordsOf(drawn(freed, args[0])), await wordsOf((async () => screen.draw([{ scene: plain }]))()),
        await wordsOf(drawn(screen, { ...args[0], options: { width: 16384, height: 16384 } })),
        await wordsOf(drawn(screen, { ...args[0], options: { into: { depth: { planes: [1, 0] } } } })),
        hash(await drawn(screen, args[0]))]`,
      FRAMES.framed
    )
    const wanted = [/^too little memory/, /nothing/, /no WebGL 2 here, or/, /another kind/,
                    /webgl: expected one of wasm, webgl2, webgpu/, /without simd128/,
                    /was freed/, /different modules/, /16384 x 16384 pixels|memory/, /two planes/]
    wanted.forEach((words, i) => assert.match(said[i], words))
    assert.equal(said.at(-1), hashOf(FRAMES.framed))
  },

  async 'without WebGL and WebGPU'() {
    const other = await launch('--disable-gpu', '--disable-software-rasterizer')
    try {
      const said = await runIn(other, '',
        `const screen = await Screen.open(canvas(), 'wasm')
        return [await wordsOf(Screen.open(canvas(), 'webgl2')), await wordsOf(Screen.open(canvas(), 'webgpu')),
          hash(await drawn(screen, args[0]))]`,
        FRAMES.framed
      )
      assert.match(said[0], /no WebGL 2 here/)
      assert.match(said[1], /no WebGPU here/)
      assert.equal(said[2], hashOf(FRAMES.framed))
    } finally {
      await other.close()
    }
  },
}

async function measure() {
  const [camera] = JSON.parse(readFileSync(`${work}/cameras.json`))
  for (const [scene, view] of [['shared-snowmiku', camera], ['shared-guitar', {}]])
    for (const backend of ['wasm', 'webgl2']) {
      const [all, draws] = await runIn(browser, 'isolated',
        `const screen = await Screen.open(canvas(), args[1]), scene = await sceneOf(args[0]), all = [], draws = []
        const median = (times) => times.sort((a, b) => a - b)[times.length >> 1]
        for (let i = -2; i < 5; i++) {
          const start = performance.now()
          screen.draw([{ scene }], args[2], { width: 1280, height: 720 })
          const drawn = performance.now()
          await screen.finish()
          if (i >= 0) draws.push(drawn - start), all.push(performance.now() - start)
        }
        return [median(all), median(draws)]`,
        scene,
        backend,
        view
      )
      console.log(`  ${scene.slice(7)} ${backend}: ${all.toFixed(0)} ms, ${draws.toFixed(0)} until draw returns`)
    }
}

await runTests(browser, { ...tests, ...threeTests(browser), ...playcanvasTests(browser) }, measure)
