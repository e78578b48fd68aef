// A worker that runs one thread of the library: an instance of the WebAssembly module on shared memory, with its own
// stack.

export function help({ module, memory, stack }) {
  // Threads never call functions that the module imports, so stubs suffice.
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
