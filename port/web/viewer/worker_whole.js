// The worker for bundlers, with all modules that are otherwise loaded on demand. Bundlers drop unused code, so the
// modules are imported and used here.
import { openPaged } from '../paged.js'
import { Functions } from '../webgl.js'
import { Computed } from '../webgpu.js'
import { backdropOf } from './sky.js'
import './worker.js'

globalThis.whole = [openPaged, Functions, Computed, backdropOf]
