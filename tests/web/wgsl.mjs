// node tests/web/wgsl.mjs FOLDER MODULES: compiles every WebGPU shader (.wgsl) of FOLDER in headless Chromium, and
// makes a pipeline of each entry point.
import { readFileSync, readdirSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { resolve } from 'node:path'
import { WEBGPU } from './flags.mjs'

const [folder, modules] = process.argv.slice(2)
const puppeteer = createRequire(resolve(modules, 'of'))('puppeteer-core')
const names = readdirSync(folder).filter((name) => name.endsWith('.wgsl'))
const server = createServer((request, response) => response.end('<!doctype html>')).listen(0)
const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', ...WEBGPU],
})

async function compile(code, entries) {
  const adapter = await navigator.gpu?.requestAdapter()
  const device = await adapter?.requestDevice()
  if (!device) return 'no WebGPU'
  const module = device.createShaderModule({ code })
  const { messages } = await module.getCompilationInfo()
  const faults = messages.map(({ type, lineNum, message }) => `${type}, line ${lineNum}: ${message}`)
  for (const entryPoint of faults.length ? [] : entries)
    await device
      .createComputePipelineAsync({ layout: 'auto', compute: { module, entryPoint } })
      .catch(({ message }) => faults.push(`${entryPoint}: ${message}`))
  return faults.join('; ')
}

try {
  const page = await browser.newPage()
  await page.goto(`http://localhost:${server.address().port}/`)
  for (const name of names) {
    const text = readFileSync(`${folder}/${name}`, 'utf8')
    const entries = [...text.matchAll(/@compute[^]*?fn (\w+)\(/g)].map(([, entry]) => entry)
    const faults = await page.evaluate(compile, text, entries)
    if (faults) {
      console.log(`${name}: ${faults}`)
      process.exitCode = 1
    }
  }
} finally {
  await browser.close()
  server.close()
}
