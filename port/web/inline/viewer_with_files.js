// The element with its files inside.
import './files.js'
import './worker.js'
export * from '../viewer/viewer.js'
