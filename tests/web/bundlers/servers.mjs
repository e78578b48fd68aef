// Servers for bundlers.mjs: one serves the files of a folder; the other is a proxy in front of another server program.
import { spawn } from 'node:child_process'
import { existsSync, readFileSync, statSync } from 'node:fs'
import { createServer, request as ask } from 'node:http'
import { connect } from 'node:net'
import { join } from 'node:path'

const HOST = '127.0.0.1'
const TYPES = { js: 'text/javascript', html: 'text/html', css: 'text/css', wasm: 'application/wasm' }
export const ISOLATED = {
  'cross-origin-opener-policy': 'same-origin',
  'cross-origin-embedder-policy': 'require-corp',
}
export const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds))

function listening(server) {
  server.sockets = new Set()
  server.on('connection', (socket) => {
    server.sockets.add(socket)
    socket.on('close', () => server.sockets.delete(socket))
  })
  return new Promise((done) => server.listen(0, HOST, () => done(server.address().port)))
}

function closed(server) {
  for (const socket of server.sockets) socket.destroy()
  return new Promise((done) => server.close(done))
}

export async function serveFiles(folder, others, headers = ISOLATED) {
  const fileOf = (path) => {
    const [start] = Object.keys(others).filter((one) => path.startsWith(one))
    return start ? join(others[start], path.slice(start.length)) : join(folder, path)
  }
  const server = createServer((request, response) => {
    const file = fileOf(decodeURIComponent(new URL(request.url, 'http://x').pathname).replace(/\/$/, '/index.html'))
    for (const [name, value] of Object.entries(headers)) response.setHeader(name, value)
    if (!existsSync(file) || !statSync(file).isFile()) return response.writeHead(404).end()
    response.setHeader('content-type', TYPES[file.split('.').pop()] ?? 'application/octet-stream')
    response.end(readFileSync(file))
  })
  const port = await listening(server)
  return { address: `http://${HOST}:${port}/`, end: () => closed(server) }
}

async function freePort() {
  const probe = createServer()
  const port = await listening(probe)
  await closed(probe)
  return port
}

const answers = (port) =>
  new Promise((done) => {
    const asked = ask({ host: HOST, port, path: '/' }, (answer) => (answer.resume(), done(true)))
    asked.on('error', () => done(false)).end()
  })

async function serveBefore(port, files) {
  const host = `${HOST}:${port}`
  const server = createServer((request, response) => {
    const { url: path, method, headers } = request
    if (files[path]) return response.writeHead(200, ISOLATED).end(readFileSync(files[path]))
    const asked = ask({ host: HOST, port, path, method, headers: { ...headers, host } }, (answer) => {
      response.writeHead(answer.statusCode, { ...answer.headers, ...ISOLATED })
      answer.pipe(response)
    })
    asked.on('error', () => response.destroy())
    request.pipe(asked)
  })
  server.on('upgrade', (request, socket, head) => {
    const other = connect(port, HOST, () => {
      const headers = Object.entries({ ...request.headers, host, origin: `http://${host}` })
      other.write(`GET ${request.url} HTTP/1.1\r\n${headers.map((pair) => `${pair.join(': ')}\r\n`).join('')}\r\n`)
      other.write(head)
      socket.pipe(other).pipe(socket)
    })
    for (const one of [socket, other]) one.on('error', () => (socket.destroy(), other.destroy()))
  })
  return { address: `http://${HOST}:${await listening(server)}/`, end: () => closed(server) }
}

export async function serveProgram(folder, words, env, files) {
  const port = await freePort()
  const child = spawn(process.execPath, words.map((word) => word.replace('PORT', port)),
    { cwd: folder, env, detached: true, stdio: ['ignore', 'pipe', 'pipe'] })
  const over = new Promise((done) => child.on('exit', done))
  let said = ''
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (text) => (said += text))
  for (let i = 0; i < 1200 && child.exitCode === null && !(await answers(port)); i++) await pause(100)
  if (child.exitCode !== null) throw new Error(`${words.join(' ')}: ${said}`)
  const { address, end } = await serveBefore(port, files)
  const endAll = async () => {
    if (child.exitCode === null) process.kill(-child.pid, 'SIGKILL')
    await Promise.all([over, end()])
  }
  return { address, said: () => said, end: endAll }
}
