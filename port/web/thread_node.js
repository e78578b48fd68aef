// The Node version of thread.js: a worker that runs a thread of a WebAssembly module.
import { workerData } from 'node:worker_threads'
import { help } from './thread.js'

help(workerData)
