// A thread of a module with shared memory: a worker that runs another instance of the module on the same memory, with
// its own stack (web_pool.c).

export function help({ module, memory, stack }) {
  // Threads never call imported functions.
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
