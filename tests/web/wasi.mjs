// node wasi.mjs PROGRAM.wasm ARGUMENT...: runs a program of WASI.
import { readFileSync } from 'node:fs'
import { WASI } from 'node:wasi'

const args = process.argv.slice(2)
const wasi = new WASI({ version: 'preview1', args, returnOnExit: true })
const module = await WebAssembly.compile(readFileSync(args[0]))
process.exitCode = wasi.start(await WebAssembly.instantiate(module, wasi.getImportObject()))
