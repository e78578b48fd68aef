// What only Node has: files, processors, and threads of its own kind.
import { readFile as read } from 'node:fs/promises'
import os from 'node:os'
import { pathToFileURL } from 'node:url'
import { Worker } from 'node:worker_threads'

export const readFile = read
export const urlOfPath = pathToFileURL
export const processors = () => os.availableParallelism?.() ?? os.cpus().length

export function startThread(data) {
  const worker = new Worker(new URL('./thread_node.js', import.meta.url), { workerData: data })
  worker.on('error', () => {})
  worker.unref()
  return worker
}
