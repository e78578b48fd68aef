// The viewer element with its files embedded, for bundlers that copy only scripts.
import './files.js'
import './worker.js'
export * from '../viewer/viewer.js'
