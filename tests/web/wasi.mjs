// node wasi.mjs PROGRAM.wasm ARGUMENT...: runs a WebAssembly program for WASI. If the environment variable RELAXED is
// set, its SIMD products are replaced by relaxed ones.
import { readFileSync } from 'node:fs'
import { WASI } from 'node:wasi'

const args = process.argv.slice(2)
const wasi = new WASI({ version: 'preview1', args, returnOnExit: true })
const relaxed = (code) => Buffer.from(code.toString('latin1').replaceAll('\xfd\x82\x01', '\xfd\x91\x02'), 'latin1')
const code = readFileSync(args[0])
const module = await WebAssembly.compile(process.env.RELAXED ? relaxed(code) : code)
process.exitCode = wasi.start(await WebAssembly.instantiate(module, wasi.getImportObject()))
