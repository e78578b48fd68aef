// Finds the other files of the package (.wasm and .js). Bundlers recognise the literal `new URL('./...',
// import.meta.url)` below and move the files. For other bundlers, `setAssets` sets the folder, or inline/files.js
// contains the files.

export const inNode = typeof process === 'object' && !!process.versions?.node

let system
export const setSystem = (functions) => (system = functions)
/** Returns the functions of system.js, which only Node needs. Bundlers do not follow this import; in a bundle, node.js
    sets the functions. */
export const ofSystem = async () => (system ??= await import(/* webpackIgnore: true */ /* @vite-ignore */ SYSTEM))
const SYSTEM = './system.js'

// The folder .vite/deps of the bundler vite. The development server of vite copies only the scripts of a package there.
const VITE = /\/\.vite\/deps[^/]*\/.*/

export function folderInVite(at, name) {
  return !inNode && /^https?:/.test(at) && VITE.test(at) ? new URL(at.replace(VITE, `/${name}/`)) : undefined
}

/** Returns the folder of a script, or undefined if a bundler has moved or renamed the script. `at` is the
    import.meta.url of the script. */
export function folderOf(at, script) {
  const isThere = !inNode && /^https?:/.test(at) && at.replace(/\?.*/, '').endsWith(`/${script}`)
  return isThere ? new URL('./', at) : undefined
}

const own = folderOf(import.meta.url, 'fixsplat_assets.js') ?? folderInVite(import.meta.url, 'fixsplat')
let folder = null // the folder that the caller has set by setAssets
let files = null
const starts = own ? {} : {
  'thread.js': () => new Worker(new URL('./thread.js', import.meta.url), { type: 'module' }),
}
const modules = {
  core: () => new URL('./core.wasm', import.meta.url),
  simd: () => new URL('./simd.wasm', import.meta.url),
  threads: () => new URL('./threads.wasm', import.meta.url),
  import: () => new URL('./import.wasm', import.meta.url),
  import_threads: () => new URL('./import_threads.wasm', import.meta.url),
  import_sog: () => new URL('./import_sog.wasm', import.meta.url),
  import_core: () => new URL('./import_core.wasm', import.meta.url),
}

export function setAssets(given) {
  if (typeof given === 'string' || given instanceof URL) {
    folder = new URL(`${given}`.replace(/\/?$/, '/'), globalThis.document?.baseURI ?? globalThis.location?.href)
    files = null
  } else files = { ...files, ...given }
}

export const assets = () => files

export const hasModule = (name) => !files || `${name}.wasm` in files

/** Returns the address of a file in the folder that setAssets has set, else in the folder `home`. */
export function addressIn(name, home) {
  if (folder) return new URL(name, folder)
  return home ? new URL(name.replace(/.*\//, ''), home) : null
}

export const hasStart = (name) => name in starts

export const setStart = (name, start) => (starts[name] = start)

export async function moduleOf(name) {
  if (files) return inflated(name)
  const url = addressIn(`${name}.wasm`, own) ?? modules[name]()
  if (inNode && url.protocol === 'file:') return new Response(await (await ofSystem()).readFile(url))
  const answer = await fetch(url).catch((cause) => {
    throw new Error(`${url}: cannot be reached. ${WHERE}`, { cause })
  })
  if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}. ${WHERE}`)
  if (/^text\/html/.test(answer.headers.get('content-type'))) throw new Error(`${url}: is a page. ${WHERE}`)
  return answer
}

const WHERE = 'It is a file of fixsplat, whose README has what bundlers need (Bundlers)'

function inflated(name) {
  const text = files[`${name}.wasm`]
  if (!text) throw new Error(`${name}.wasm: is no part of fixsplat/inline, which needs a browser with simd128`)
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt())
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip')))
}

const MODULE = { type: 'module' }

/** Starts a worker. Its script is the first of: the embedded script, the start function for bundlers, the script in the
    folder of setAssets, the script in the folder `home`. */
export function startWorker(name, home = own) {
  if (files) return new Worker(scriptOf(files[name]), MODULE)
  if (folder || !starts[name]) return new Worker(reachable(addressIn(name, home)), MODULE)
  // Bundlers recognise only a literal `new Worker(new URL(...))`. Here this literal calls another function.
  const Own = globalThis.Worker
  globalThis.Worker = function (url, how) {
    return new Own(reachable(new URL(url, location.href), how), how)
  }
  try {
    return starts[name]()
  } finally {
    globalThis.Worker = Own
  }
}

/** Browsers refuse a worker script of another origin, but a script of the page's own origin may import such a script.
    Some bundlers make classic scripts for workers. */
function reachable(url, { type } = MODULE) {
  if ([location.origin, 'null'].includes(url.origin)) return url
  const address = JSON.stringify(url.href)
  return scriptOf(type === 'module' ? `import ${address}` : `importScripts(${address})`)
}

const scriptOf = (text) => URL.createObjectURL(new Blob([text], { type: 'text/javascript' }))

export async function startThread(data) {
  if (inNode) return (await ofSystem()).startThread(data)
  const worker = startWorker('thread.js')
  worker.onerror = (event) => event.preventDefault()
  worker.postMessage(data)
  return worker
}
