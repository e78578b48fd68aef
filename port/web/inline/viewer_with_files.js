// The element with its files embedded.
import './files.js'
import './worker.js'
export * from '../viewer/viewer.js'
