// The entry module of the package in Node.
import { setSystem } from './fixsplat_assets.js'
import * as system from './system.js'

setSystem(system)
export * from './fixsplat.js'
