// The Node version of thread.js.
import { workerData } from 'node:worker_threads'
import { help } from './thread.js'

help(workerData)
