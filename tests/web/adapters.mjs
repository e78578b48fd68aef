// node adapters.mjs MODULES: prints which WebGPU adapter (GPU) Chromium offers with each of several sets of flags.
// MODULES is a node_modules folder.
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { resolve } from 'node:path'

const puppeteer = createRequire(resolve(process.argv[2], 'of'))('puppeteer-core')
const COMMON = '--enable-unsafe-webgpu --ignore-gpu-blocklist'
const asked = process.env.FXS_WEBGPU_FLAGS
const SETS = asked ? [asked] : [
  `${COMMON} --enable-features=Vulkan --use-angle=vulkan --use-vulkan=native --disable-vulkan-surface`,
  `${COMMON} --enable-features=Vulkan,VulkanFromANGLE,DefaultANGLEVulkan --use-angle=vulkan --disable-vulkan-surface`,
  `${COMMON} --enable-features=Vulkan --use-gl=angle --use-angle=gl-egl --use-vulkan=native`,
  `${COMMON} --enable-features=Vulkan --use-angle=swiftshader --enable-unsafe-swiftshader --use-vulkan=native`,
]
const LIMIT = 15000

const server = createServer((_, answer) => answer.setHeader('content-type', 'text/html').end('<!doctype html>'))
  .listen(0, '127.0.0.1')
await new Promise((done) => server.once('listening', done))

const ASK = `(async () => {
  if (!navigator.gpu) return 'no navigator.gpu'
  const adapter = await navigator.gpu.requestAdapter({ powerPreference: 'high-performance' })
  if (!adapter) return 'no adapter'
  const { vendor, architecture, device, description, isFallbackAdapter } = adapter.info
  await adapter.requestDevice()
  return { vendor, architecture, device, description, isFallbackAdapter }
})()`

async function find(flags) {
  let browser, late, said = ''
  try {
    browser = await puppeteer.launch({
      executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
      args: ['--no-sandbox', '--enable-logging=stderr', ...flags.split(' ')],
      timeout: LIMIT,
    })
    browser.process().stderr.on('data', (text) => (said += text))
    const page = await browser.newPage()
    await page.goto(`http://127.0.0.1:${server.address().port}/`)
    const limit = new Promise((_, fail) => (late = setTimeout(() => fail(new Error('no answer')), LIMIT)))
    const found = await Promise.race([page.evaluate(ASK), limit])
    if (found.vendor !== undefined) return found
    throw new Error(found)
  } catch (error) {
    const lines = said.split('\n').map((line) => line.replace(/^(\[[^\]]*\]|ERR:) ?/, '').slice(0, 160))
    return [error.message, ...[...new Set(lines)].slice(-14)].join('\n    ')
  } finally {
    clearTimeout(late)
    browser?.process().kill('SIGKILL')
  }
}

let card
for (const flags of SETS) {
  const found = await find(flags)
  console.error(`${flags}\n    ${typeof found === 'string' ? found : JSON.stringify(found)}`)
  const software = found.isFallbackAdapter || /swiftshader|llvmpipe/i.test(Object.values(found).join())
  if (typeof found !== 'string' && (asked || !software)) {
    card = flags
    break
  }
}
server.close()
if (card) console.log(card)
process.exit(card ? 0 : 1)
