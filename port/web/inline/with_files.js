// The package with its .wasm and .js files embedded, for bundlers that copy only scripts.
import './files.js'
export * from '../fixsplat.js'
