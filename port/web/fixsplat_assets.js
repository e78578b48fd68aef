// Where the package finds its other files: modules of WebAssembly, and the scripts of workers. As they are published,
// they lie beside this one. A bundler puts them elsewhere, and finds them by the literal addresses; where it does not
// know these, `setAssets` says where they are. What only Node has is in system.js.

export const inNode = typeof process === 'object' && !!process.versions?.node

let system
export const setSystem = (functions) => (system = functions)
/** The functions of system.js, which bundlers do not find here: node.js, their entry in Node, has set them. */
export const ofSystem = async () => (system ??= await import(/* webpackIgnore: true */ /* @vite-ignore */ SYSTEM))
const SYSTEM = './system.js'

// Vite's server makes scripts of packages anew in a folder of its own, where their other files are not.
const VITE = /\/\.vite\/deps[^/]*\/.*/

/** The folder of the published files; undefined in Node, and where a bundler has taken this file to another. */
function published() {
  const at = import.meta.url ?? ''
  if (inNode || !/^https?:/.test(at)) return undefined
  if (/\/fixsplat_assets\.js(\?.*)?$/.test(at)) return new URL('./', at)
  return VITE.test(at) ? new URL(at.replace(VITE, '/fixsplat/')) : undefined
}

let folder = published()
let files = null                // the files themselves, by their names: inline/files.js
const starts = {
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

/** The files that `setAssets` was given, which a worker is to be given too. */
export const assets = () => files

/** Whether there is a module: what has all files inside has no others. */
export const hasModule = (name) => !files || `${name}.wasm` in files

/** The address of a published file; null where only a bundler knows it. */
export const addressIn = (name) => (folder ? new URL(name, folder) : null)

/** How a worker is started where a bundler has taken its script to another place. */
export const setStart = (name, start) => (starts[name] = start)

/** A module of WebAssembly, as an answer of a server. */
export async function moduleOf(name) {
  if (files) return inflated(name)
  const url = folder ? new URL(`${name}.wasm`, folder) : modules[name]()
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

/** A worker by the name of its script. */
export function startWorker(name) {
  if (files) return startText(files[name])
  if (!folder) return starts[name]()
  const url = new URL(name, folder)
  // Browsers start no script of another server, but one of the page's own that imports it.
  if (url.origin !== location.origin) return startText(`import ${JSON.stringify(url.href)}`)
  return new Worker(url, { type: 'module' })
}

function startText(text) {
  const url = URL.createObjectURL(new Blob([text], { type: 'text/javascript' }))
  return new Worker(url, { type: 'module' })
}

/** A worker that is a thread of the renderer's. */
export async function startThread(data) {
  if (inNode) return (await ofSystem()).startThread(data)
  const worker = startWorker('thread.js')
  worker.onerror = (event) => event.preventDefault()
  worker.postMessage(data)
  return worker
}
