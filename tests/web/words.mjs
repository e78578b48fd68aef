// Runs the words (named test functions) of a test program.
import { readFileSync, writeFileSync } from 'node:fs'

// Runs one word and returns all that it prints. An error's stack counts as printed.
async function printed(words, [word, ...args]) {
  const parts = []
  const write = process.stdout.write
  process.stdout.write = (part) => parts.push(Buffer.from(part)) > 0
  let failed = 0
  try {
    await words[word](...args)
  } catch (error) {
    parts.push(Buffer.from(`${error.stack}\n`))
    failed = 1
  }
  process.stdout.write = write
  return [failed, Buffer.concat(parts)]
}

// The word `serve FOLDER` runs many words in one process. Each request is written to the named pipe FOLDER/ask, its
// arguments separated by the byte 31. The output goes to the file FOLDER/said, the exit status to the pipe
// FOLDER/status. Other words run once.
export async function run(words, word, args) {
  if (word !== 'serve') return words[word](...args)
  for (const folder = args[0]; ;) {
    const request = readFileSync(`${folder}/ask`, 'utf8').split('\x1f')
    const [failed, said] = await printed(words, request)
    writeFileSync(`${folder}/said`, said)
    writeFileSync(`${folder}/status`, `${failed}\n`)
  }
}
