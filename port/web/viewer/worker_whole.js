// The worker for bundlers: with all that it else loads when it is wanted. Some make one file of a worker's scripts, and
// all leave out what is not used.
import { openPaged } from '../paged.js'
import { Functions } from '../webgl.js'
import { Computed } from '../webgpu.js'
import { backdropOf } from './sky.js'
import './worker.js'

globalThis.whole = [openPaged, Functions, Computed, backdropOf]
