// The worker for bundlers, which drop unused code: imports and uses all modules that are loaded on demand elsewhere.
import { openPaged } from '../paged.js'
import { Functions } from '../webgl.js'
import { Computed } from '../webgpu.js'
import { backdropOf } from './sky.js'
import './worker.js'

globalThis.whole = [openPaged, Functions, Computed, backdropOf]
