// Functions for Node only: files, the number of processors, and threads.
import { readFile as read, realpath, stat } from 'node:fs/promises'
import os from 'node:os'
import { dirname, isAbsolute, relative, sep } from 'node:path'
import { fileURLToPath, pathToFileURL } from 'node:url'
import { Worker } from 'node:worker_threads'

export const readFile = read

/** Reads another file of a scene. The file must be in the folder of the file `first` or below, after links are
    resolved. */
export async function readWithin(first, url) {
  const paths = [dirname(fileURLToPath(first)), fileURLToPath(url)]
  const [folder, file] = await Promise.all(paths.map((path) => realpath(path)))
  const path = relative(folder, file)
  if (isAbsolute(path) || path.split(sep)[0] === '..') throw new Error(`${file}: leaves the folder ${folder}`)
  if (!(await stat(file)).isFile()) throw new Error(`${file}: not a regular file`)
  return read(file)
}

export const urlOfPath = pathToFileURL
export const processors = () => os.availableParallelism?.() ?? os.cpus().length

export function startThread(data) {
  const worker = new Worker(new URL('./thread_node.js', import.meta.url), { workerData: data })
  worker.on('error', () => {})
  worker.unref()
  return worker
}
