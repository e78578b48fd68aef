// Converts an error to a text for users of a page, and to a kind for programs.

const FORMATS = '@FORMATS@'
const size = (bytes) => (bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1e3))} KB` : `${(bytes / 1e6).toFixed(1)} MB`)

// Each row of this table of errors has a kind, a pattern of the message, and a function. The function writes the text
// with the translating function `say`. Without a function, the message is the text. The first matching row is used.
const TABLE = [
  ['browser', /^no WebAssembly$/, (say) =>
    say('This browser has no WebAssembly, or it is switched off: a newer one shows the scene')],
  ['policy', /unsafe-eval/, (say) =>
    say('The policy of this page does not allow WebAssembly: it needs {0} in script-src', "'wasm-unsafe-eval'")],
  ['format', /^no scene$/, (say) => say('None of these files is a scene. Scenes are {0}', FORMATS)],
  ['format', /^no files$/, (say) => say('There is no file in what was dropped')],
  ['format', /^(.*?): not a scene file of a known format/, (say, name) =>
    say('{0}: this is no scene. Scenes are {1}', name, FORMATS)],
  ['format', /^(.*?): not a scene file, but (.*)/, (say, ...words) => say('{0}: this is no scene, but {1}', ...words)],
  ['damaged', /^(.*?): the header asks for at least (\d+) bytes, the file has (\d+)/, (say, name, wanted, there) =>
    say('{0}: the file is cut off: {1} of {2} are there', name, size(there), size(wanted))],
  ['damaged', /^(.*?): (header line .*)/, (say, ...words) => say('{0}: the file is damaged ({1})', ...words)],
  ['damaged', /though its header asks for/],
  ['missing', /no such file/],
  ['network', /cannot be reached/, (say) => (navigator.onLine === false
    ? say('This machine is not connected to the network. The scene is loaded when it is') : undefined)],
  ['network', /broke off|: the server |on its server|no address/],
  ['memory', /out of memory|allocation failed|could not allocate|can be read$/i, (say) =>
    say('There is too little memory here for this scene. A smaller copy (fixsplat convert) or fewer pages may help')],
]

export function wordsOf({ message }, say) {
  for (const [kind, pattern, write] of TABLE) {
    const found = message.match(pattern)
    if (found) return { kind, words: write?.(say, ...found.slice(1)) ?? message }
  }
  return { kind: 'other', words: message }
}
