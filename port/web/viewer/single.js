// The script of a page of `fixsplat publish --single`, which contains all files. Makes a blob: address for each file,
// and changes imports and `new URL` to these addresses.

const carried = (id) => document.getElementById(id)

async function unpacked(base64) {
  const text = atob(base64)
  const bytes = new Uint8Array(text.length)
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i)
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))
  return new Uint8Array(await new Response(stream).arrayBuffer())
}

function addressAll(files) {
  const base = 'https://fixsplat.invalid/' // placeholder for the folder of the scripts; never requested
  const imports = /(\bfrom\s*|\bimport\s*\(?\s*)(["'])(\.\.?\/[^"'\s]+)\2/g
  const types = { js: 'text/javascript', wasm: 'application/wasm', css: 'text/css' }
  const addresses = {}
  const begun = new Set()

  function addressOf(name) {
    if (name in addresses) return addresses[name]
    if (begun.has(name)) throw new Error(`${name} imports itself by another`)
    begun.add(name)
    const type = types[name.split('.').pop()]
    const content = type === types.js ? scriptOf(name) : files[name]
    return (addresses[name] = URL.createObjectURL(new Blob([content], { type })))
  }

  function scriptOf(name) {
    const here = base + name
    const addressed = (all, before, quote, path) => {
      const other = new URL(path, here).href.slice(base.length)
      return other in files ? before + quote + addressOf(other) + quote : all
    }
    const text = new TextDecoder().decode(files[name])
    return text.replace(imports, addressed).replaceAll('import.meta.url', JSON.stringify(here))
  }

  for (const name of Object.keys(files)) addressOf(name)
  globalThis.URL = class extends URL {
    #isOwn = false

    constructor(...words) {
      super(...words)
      const own = this.href.startsWith(base) && addresses[this.href.slice(base.length)]
      if (!own) return
      this.href = own
      this.#isOwn = true
    }

    get origin() {
      return this.#isOwn ? location.origin : super.origin
    }
  }
  return addresses
}

// In a page opened by a file:// address, a worker cannot be a module and cannot use blob: addresses of the page. The
// page therefore sends the files, and the worker makes its own addresses. Messages that arrive before the worker is
// ready are kept.
function work(addressAll) {
  const kept = []
  const keep = (event) => kept.push(event.data)
  const begin = async ({ data: { files, name } }) => {
    removeEventListener('message', begin)
    addEventListener('message', keep)
    await import(addressAll(files)[name])
    removeEventListener('message', keep)
    for (const data of kept) dispatchEvent(new MessageEvent('message', { data }))
  }
  addEventListener('message', begin)
}

const files = {}
for (const [name, text] of Object.entries(JSON.parse(carried('files').textContent))) files[name] = await unpacked(text)
const addresses = addressAll(files)
const worker = URL.createObjectURL(new Blob([`(${work})(${addressAll})`], { type: 'text/javascript' }))
globalThis.Worker = class extends Worker {
  constructor(address) {
    super(worker)
    this.postMessage({ files, name: Object.keys(addresses).find((name) => addresses[name] === `${address}`) })
  }
}

await import(addresses['viewer/viewer.js'])
const scene = carried('scene')
const bytes = await unpacked(scene.textContent)
for (const element of [carried('files'), scene]) element.remove()
await document.querySelector('fixsplat-viewer').open(new File([bytes], scene.dataset.name))
