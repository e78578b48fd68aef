// What a viewer says of an error to people who do not know how a scene is made, and the kind of it for programs.

const FORMATS = '@FORMATS@'
const size = (bytes) => (bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1e3))} KB` : `${(bytes / 1e6).toFixed(1)} MB`)

// Kind, what an Error's message has, and the words for that; without words the message says it. The first that fits.
const TABLE = [
  ['browser', /^no WebAssembly$/, () =>
    'This browser has no WebAssembly, or it is switched off: a newer one shows the scene'],
  ['policy', /unsafe-eval/, () =>
    "The policy of this page does not allow WebAssembly: " +
    "its Content-Security-Policy needs 'wasm-unsafe-eval' in script-src"],
  ['format', /^no scene$/, () => `None of these files is a scene. Scenes are ${FORMATS}`],
  ['format', /^no files$/, () => 'There is no file in what was dropped'],
  ['format', /^(.*?): not a scene file of a known format/, (name) =>
    `${name}: this is no scene. Scenes are ${FORMATS}`],
  ['format', /^(.*?): not a scene file, but (.*)/, (name, what) => `${name}: this is no scene, but ${what}`],
  ['damaged', /^(.*?): the header asks for at least (\d+) bytes, the file has (\d+)/, (name, wanted, there) =>
    `${name}: the file is cut off: ${size(there)} of ${size(wanted)} are there`],
  ['damaged', /^(.*?): (header line .*)/, (name, what) => `${name}: the file is damaged (${what})`],
  ['missing', /no such file/],
  ['network', /cannot be reached/, () =>
    navigator.onLine === false ? 'This machine is not connected to the network' : undefined],
  ['network', /broke off|the server answered|on its server|no address/],
  ['memory', /out of memory|allocation failed|could not allocate|can be read$/i, () =>
    'There is too little memory here for this scene. A smaller copy (fixsplat convert) or fewer open pages may help'],
]

/** The kind of an error and its words. */
export function wordsOf({ message }) {
  for (const [kind, pattern, write] of TABLE) {
    const found = message.match(pattern)
    if (found) return { kind, words: write?.(...found.slice(1)) ?? message }
  }
  return { kind: 'other', words: message }
}
