// How the element starts its worker in what a bundler has made.
import { setStart } from '../fixsplat_assets.js'

setStart('viewer/worker.js', () => new Worker(new URL('./worker_whole.js', import.meta.url), { type: 'module' }))
