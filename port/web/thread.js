// A worker that runs a thread: a WebAssembly module on shared memory, with its own stack.

export function help({ module, memory, stack }) {
  // Threads never call imported functions, so stubs suffice.
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
