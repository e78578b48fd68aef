// Parts that webgpu_peers.mjs and dawn.mjs share: viewers that draw with WebGPU, and cameras for timing them.

export const VIEWS = {
  guitar: { eye: [5.5, 3.2, -0.2], look: [0.09, 2.1, -0.2], fov: 50 },
  snowmiku: { eye: [-2.02394, -1.50942, 3.17181], look: [-1.26934, -1.0593, -0.73049], fov: 48.73 },
}

// JavaScript source code that starts each viewer. It returns a function that draws a picture from an eye position and
// waits for the GPU.
export const VIEWERS = {
  fixsplat: `const { load, Screen } = await bring('fixsplat')
    const screen = await Screen.open(canvas, 'webgpu'), placed = [{ scene: await load(url), rotation: [0, 1, 0, 0] }]
    return async (eye) => {
      screen.draw(placed, { eye, look, up: [0, 1, 0], fov }, { width, height })
      await screen.finish()
      await screen.device.queue.onSubmittedWorkDone()
    }`,
  PlayCanvas: `const pc = await bring('playcanvas')
    const device = await pc.createGraphicsDevice(canvas, { deviceTypes: ['webgpu'], antialias: false })
    if (!device.isWebGPU) throw new Error('no WebGPU')
    const options = new pc.AppOptions()
    options.graphicsDevice = device
    options.componentSystems = [pc.RenderComponentSystem, pc.CameraComponentSystem, pc.LightComponentSystem,
      pc.GSplatComponentSystem]
    options.resourceHandlers = [pc.TextureHandler, pc.ContainerHandler, pc.GSplatHandler]
    const app = new pc.AppBase(canvas)
    app.init(options)
    app.setCanvasFillMode(pc.FILLMODE_NONE, width, height)
    app.setCanvasResolution(pc.RESOLUTION_FIXED, width, height)
    const asset = new pc.Asset('splats', 'gsplat', { url })
    await new Promise((done, fail) => {
      asset.ready(done)
      asset.on('error', fail)
      app.assets.add(asset)
      app.assets.load(asset)
    })
    const splats = new pc.Entity(), camera = new pc.Entity()
    splats.addComponent('gsplat', { asset })
    splats.setLocalEulerAngles(180, 0, 0)
    camera.addComponent('camera', { fov, nearClip: 0.1, clearColor: new pc.Color(0, 0, 0) })
    app.root.addChild(splats)
    app.root.addChild(camera)
    app.requestAnimationFrame = () => {} // a frame is drawn where it is asked for, not at the screen's rate
    app.start()
    return async (eye) => {
      camera.setPosition(...eye)
      camera.lookAt(...look)
      app.tick(performance.now())
      await device.wgpu.queue.onSubmittedWorkDone()
    }`,
  'three.js': `const THREE = await bring('three/webgpu')
    const { GaussianSplat } = await bring('three/addons/objects/GaussianSplat.js')
    const { GaussianSplatPLYLoader } = await bring('three/addons/loaders/GaussianSplatPLYLoader.js')
    const renderer = new THREE.WebGPURenderer({ canvas })
    await renderer.init()
    if (!renderer.backend.device) throw new Error('no WebGPU')
    renderer.setSize(width, height, false)
    const world = new THREE.Scene(), camera = new THREE.PerspectiveCamera(fov, width / height, 0.1, 1000)
    const splats = new GaussianSplat(await new GaussianSplatPLYLoader().loadAsync(url))
    splats.rotation.x = Math.PI
    world.add(splats)
    return async (eye) => {
      camera.position.set(...eye)
      camera.lookAt(...look)
      renderer.render(world, camera)
      await renderer.backend.device.queue.onSubmittedWorkDone()
    }`,
}

export const measureText = (name, scene) => `
  const { eye, look, fov } = ${JSON.stringify(VIEWS[scene])}
  const [x, y, z] = eye.map((e, i) => e - look[i])
  const draw = await (async () => { ${VIEWERS[name]} })()
  const times = []
  for (let i = 0; i < frames + 2; i++) {
    const [s, c] = [Math.sin(0.035 * i), Math.cos(0.035 * i)], start = performance.now()
    await draw([look[0] + c * x + s * z, look[1] + y, look[2] - s * x + c * z])
    times.push(performance.now() - start)
  }
  return times.slice(2)`

export const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1]

export async function inTurns(names, rounds, what, measure) {
  const found = Object.fromEntries(names.map((name) => [name, []]))
  for (let round = 0; round < rounds; round++) for (const name of names) found[name].push(await measure(name))
  const shown = (ms) => ms.toFixed(ms < 100 ? 2 : 0)
  for (const name of rounds ? names : []) {
    const [own, first] = [median(found[name]), median(found[names[0]])]
    console.log(`${what}, ${name}: ${shown(own)} ms a frame, ${(own / first).toFixed(2)} times ` +
      `${names[0]}'s; rounds ${found[name].map(shown).join(', ')}`)
  }
}
