// What a viewer says of an error to people who do not know how it is made.

// The first that fits an Error's message; where none does, the message is its own best words.
const WORDS = [
  [/^no WebAssembly/, () => 'This browser has no WebAssembly, or it is switched off: another browser, or a newer one, shows the scene'],
  [/^no scene$/, () => 'None of these files is a scene'],
  [/^no files$/, () => 'Nothing was dropped that can be opened: drop a file or a folder from this machine'],
  [/^(.*?): (out of memory|.*memory.*)$/i, (words, name) => `${name}: there is too little memory for this scene on this machine (${words})`],
]

export function wordsOf({ message }) {
  for (const [pattern, write] of WORDS) {
    const found = message.match(pattern)
    if (found) return write(found[2], found[1])
  }
  return message
}
