// node types.mjs FIXSPLAT.tgz VIEWER.tgz MODULES PAGE_MODULES [all]: compiles code with strict TypeScript, to check the
// npm packages' types. The code comes from docs/web.md, from the packages' README.md, from docs/examples and from
// bundlers/types.tsx. With `all`, compiles also with Node's module resolution, and with React 18.
import { execFileSync, spawnSync } from 'node:child_process'
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { basename, dirname, join, resolve } from 'node:path'

const [tarball, viewerTarball, modules, pageModules, all] = process.argv.slice(2)
const folder = mkdtempSync(join(dirname(resolve(modules)), 'types-'))
process.on('exit', () => rmSync(folder, { recursive: true, force: true }))

const LANGUAGES = /^(js|ts|tsx|html)$/
const CODE = /\bconst \w+ =|\bawait \w|^import /m
const HTML = /<script type="module">\n([^]*?)<\/script>/

function blocksOf(text) {
  const fenced = [...text.matchAll(/^```(\w+)\n([^]*?)^```$/gm)].map(([, language, code]) => ({ language, code }))
  const indented = text.replace(/^```[^]*?^```$/gm, '').match(/(^( {4}.*)?\n)*^ {4}.*\n/gm) ?? []
  const found = [...fenced, ...indented.map((code) => ({ language: 'js', code: code.replace(/^ {4}/gm, '') }))]
  return found
    .filter(({ language, code }) => LANGUAGES.test(language) && CODE.test(code))
    .map(({ language, code }) => ({
      ending: language === 'tsx' ? 'tsx' : 'ts',
      code: (language === 'html' ? code.match(HTML)[1] : code).replace(/https:.*fixsplat\.js/g, 'fixsplat'),
    }))
}

const names = []
for (const file of ['port/web/README.md', 'port/web/viewer/README.md', 'docs/web.md'])
  for (const { ending, code } of blocksOf(readFileSync(file, 'utf8'))) {
    const name = `${file.replace(/\W/g, '_')}_${names.length}.${ending}`
    writeFileSync(join(folder, name), `${code}\nexport {}\n`)
    names.push(name)
  }
for (const path of ['tests/web/bundlers/types.tsx', 'docs/examples/react.tsx', 'docs/examples/fiber.tsx'])
  cpSync(path, join(folder, basename(path)))
cpSync('tests/web/bundlers/names.d.ts', join(folder, 'names.d.ts'))
for (const [name, file] of Object.entries({ fixsplat: tarball, 'fixsplat-viewer': viewerTarball })) {
  const to = join(folder, 'node_modules', name)
  mkdirSync(to, { recursive: true })
  execFileSync('tar', ['xzf', resolve(file), '-C', to, '--strip-components=1'])
}
writeFileSync(join(folder, 'package.json'), '{ "private": true, "type": "module" }')

const { bin } = JSON.parse(readFileSync(join(modules, 'typescript/package.json'), 'utf8'))
const playcanvas = { playcanvas: [resolve(pageModules, 'playcanvas/build/playcanvas.d.ts')] }
const react18 = {
  ...playcanvas,
  react: [resolve(modules, '@types/react-18/index.d.ts')],
  'react/jsx-runtime': [resolve(modules, '@types/react-18/jsx-runtime.d.ts')],
}
const common = {
  strict: true,
  noEmit: true,
  skipLibCheck: false,
  target: 'esnext',
  lib: ['esnext', 'dom', 'dom.iterable'],
  jsx: 'react-jsx',
  types: ['node'],
  paths: playcanvas,
}
const ways = {
  'as bundlers, React 19': { module: 'esnext', moduleResolution: 'bundler' },
  'as Node, React 19': { module: 'nodenext', moduleResolution: 'nodenext' },
  'as bundlers, React 18': { module: 'esnext', moduleResolution: 'bundler', paths: react18 },
}
console.log(`${names.length} blocks`)
if (names.length < 10) throw new Error('blocks of code are missing')
for (const [name, way] of Object.entries(ways).slice(0, all ? 3 : 1)) {
  const file = join(folder, 'tsconfig.json')
  writeFileSync(file, JSON.stringify({ compilerOptions: { ...common, ...way }, include: ['*.ts', '*.tsx'] }))
  const words = [join(modules, 'typescript', bin.tsc), '-p', file]
  const { stdout, stderr, status } = spawnSync(process.execPath, words, { encoding: 'utf8' })
  console.log(status ? `FAIL types ${name}: ${stdout}${stderr}` : `ok types ${name}`)
  if (status) process.exitCode = 1
}
