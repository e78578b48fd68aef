// The worker for bundlers, which drop unused code. This script imports and uses all modules that are loaded on demand
// elsewhere.
import { openPaged } from 'fixsplat/paged.js'
import { Functions } from 'fixsplat/webgl.js'
import { Computed } from 'fixsplat/webgpu.js'
import { backdropOf } from './sky.js'
import './worker.js'

globalThis.whole = [openPaged, Functions, Computed, backdropOf]
