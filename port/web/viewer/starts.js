// Sets how to start the viewer's worker after a bundler has moved its script.
import { setStart } from '../fixsplat_assets.js'

setStart('viewer/worker.js', () => new Worker(new URL('./worker_whole.js', import.meta.url), { type: 'module' }))
