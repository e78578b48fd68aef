// node serve.mjs PACKAGE SCENE: serves both and tests/web/page.html, and prints the address.
import { createReadStream, existsSync } from 'node:fs'
import { createServer } from 'node:http'
import { extname, join } from 'node:path'

const [folder, scene] = process.argv.slice(2)
const types = { '.js': 'text/javascript', '.html': 'text/html', '.wasm': 'application/wasm', '.css': 'text/css' }

const server = createServer((request, answer) => {
  const name = new URL(request.url, 'http://localhost').pathname.slice(1)
  const file = name === 'page.html' ? 'tests/web/page.html' : name === 'scene.fxs' ? scene : join(folder, name)
  answer.writeHead(existsSync(file) ? 200 : 404, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream' })
  if (existsSync(file)) createReadStream(file).pipe(answer)
  else answer.end()
}).listen(0, '127.0.0.1', () => console.log(`http://127.0.0.1:${server.address().port}`))
