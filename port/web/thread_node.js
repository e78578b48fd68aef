// The same as thread.js, in Node.
import { workerData } from 'node:worker_threads'
import { help } from './thread.js'

help(workerData)
