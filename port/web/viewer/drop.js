// Finds the scenes among dropped or chosen files and folders.

const FORMATS = '@FORMATS@'.split(', ')
// formats of index files: scene files that name other files
const INDEX = FORMATS.filter((name) => !name.startsWith('.') || /\.(gltf|lcc)$/.test(name))
const MOST = 10000 // largest number of files in dropped folders

const lastOf = (file) => file.name.split('/').pop().toLowerCase()
const isOf = (names) => (file) =>
  names.some((name) => lastOf(file) === name || (name[0] === '.' && lastOf(file).endsWith(name)))
const isIndex = isOf(INDEX)
const folderOf = (file) => (file.webkitRelativePath || file.name).replace(/[^/]*$/, '')

/** Returns all files that the user has dropped. The name of a file in a folder is its path. */
export async function filesOf(entries, dropped) {
  if (!entries.some((entry) => entry.isDirectory)) return dropped
  const files = []
  for (const entry of entries) await take(entry, files)
  return files
}

async function take(entry, files) {
  if (entry.isFile) {
    const file = await new Promise((done, failed) => entry.file(done, failed))
    files.push(new File([file], entry.fullPath.slice(1), { type: file.type }))
    return
  }
  const reader = entry.createReader()
  // readEntries returns only some of the entries of a folder in each call
  const next = () => new Promise((done, failed) => reader.readEntries(done, failed))
  for (let some = await next(); some.length; some = await next())
    for (const one of some) {
      if (files.length >= MOST) throw new Error(`${entry.name}: this folder has more than ${MOST} files`)
      await take(one, files)
    }
}

// Finds scenes among files, and one file of views or settings. An index file, which names other files, becomes a scene
// with all files of its folder and below. A single file without a known ending is tried as a scene.
export function scenesIn(files) {
  const isViews = (file) => /\.json$/i.test(file.name) && !isIndex(file)
  const rest = new Set([...files].sort((a, b) => (a.name < b.name ? -1 : 1)))
  const views = [...rest].find(isViews)
  const indexes = [...rest].filter(isIndex).sort((a, b) => folderOf(a).length - folderOf(b).length)
  const scenes = []
  for (const index of indexes.filter((file) => rest.has(file))) {
    const own = [index, ...[...rest].filter((file) => file !== index && folderOf(file).startsWith(folderOf(index)))]
    if (!rest.has(index)) continue
    for (const file of own) rest.delete(file)
    scenes.push(own.length > 1 ? own : index)
  }
  const others = [...rest].filter((file) => file !== views)
  const known = others.filter(isOf(FORMATS))
  return { scenes: [...scenes, ...(known.length || scenes.length || others.length > 1 ? known : others)], views }
}
