// node serve.mjs PACKAGE SCENE: serves the files of a package, and a scene, to a browser. Paths under /isolated/ get
// the headers that allow threads; paths under /blocked/ also forbid workers. Prints everything that a page posts.
import { createReadStream, existsSync } from 'node:fs'
import { createServer } from 'node:http'
import { extname, join } from 'node:path'

const [folder, scene] = process.argv.slice(2)
const types = { '.js': 'text/javascript', '.html': 'text/html', '.wasm': 'application/wasm', '.css': 'text/css' }

const server = createServer((request, answer) => {
  if (request.method === 'POST') {
    request.on('data', (text) => console.log(`${text}`)).on('end', () => answer.end())
    return
  }
  const path = new URL(request.url, 'http://localhost').pathname
  const [, policy, name] = path.match(/^\/(?:(isolated|blocked)\/)?(.*)/)
  if (policy === 'blocked') answer.setHeader('Content-Security-Policy', "worker-src 'none'")
  if (policy) {
    answer.setHeader('Cross-Origin-Opener-Policy', 'same-origin')
    answer.setHeader('Cross-Origin-Embedder-Policy', 'require-corp')
  }
  const file = name === 'page.html' ? 'tests/web/page.html' : name === 'scene.fxs' ? scene : join(folder, name)
  answer.writeHead(existsSync(file) ? 200 : 404, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream' })
  if (existsSync(file)) createReadStream(file).pipe(answer)
  else answer.end()
}).listen(0, '127.0.0.1', () => console.log(`http://127.0.0.1:${server.address().port}`))
