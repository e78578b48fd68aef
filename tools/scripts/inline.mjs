// Prints JavaScript modules made of files of the npm packages.
// inline.mjs style STYLE.css: a module with the text of a style sheet.
// inline.mjs files ASSETS NAME=FILE...: a module that passes files to the function setAssets of the module ASSETS,
// scripts as text and WebAssembly as gzip in base64.
import { readFileSync } from 'node:fs'
import { gzipSync } from 'node:zlib'

const [kind, ...rest] = process.argv.slice(2)

const textOf = (file) =>
  file.endsWith('.wasm')
    ? gzipSync(readFileSync(file), { level: 9 }).toString('base64')
    : readFileSync(file, 'utf8')

function styleOf(file) {
  const text = readFileSync(file, 'utf8').replace(/\/\*[^]*?\*\//g, '').replace(/\s*\n\s*/g, '\n').trim()
  return `export const style = ${JSON.stringify(text)}\n`
}

function filesOf([assets, ...pairs]) {
  const files = Object.fromEntries(pairs.map((pair) => pair.split('=')).map(([name, file]) => [name, textOf(file)]))
  return `import { setAssets } from '${assets}'\nsetAssets(${JSON.stringify(files)})\n`
}

process.stdout.write(kind === 'style' ? styleOf(rest[0]) : filesOf(rest))
