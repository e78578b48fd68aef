// Sets the function that starts the viewer's worker if a bundler has moved the worker's script.
import { folderInVite, setStart } from 'fixsplat/fixsplat_assets.js'

const folder = folderInVite(import.meta.url, 'fixsplat-viewer')
const whole = () => new Worker(new URL('./worker_whole.js', import.meta.url), { type: 'module' })
const inFolder = () => new Worker(`${folder}worker.js`, { type: 'module' })
setStart('viewer/worker.js', folder ? inFolder : whole)
