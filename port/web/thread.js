// One more thread of the module threads.wasm. It is a worker that runs another instance of the module, with the same
// memory and a stack of its own.

export function help({ module, memory, stack }) {
  // Nothing that a thread does calls a function of the page's.
  const imports = new Proxy({}, { get: (_, name) => (name === 'memory' ? memory : () => 0) })
  const { exports } = new WebAssembly.Instance(module, new Proxy({}, { get: () => imports }))
  exports.__stack_pointer.value = stack
  try {
    exports.help()
  } catch {
    exports.trapped()
  }
}

globalThis.onmessage = ({ data }) => {
  help(data)
  close()
}
