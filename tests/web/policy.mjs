// The Content-Security-Policy header that docs/web.md recommends, as a server sends it.
import { readFileSync } from 'node:fs'

const text = readFileSync('docs/web.md', 'utf8').match(/Content-Security-Policy: ([^`]*?)\n\n/)[1]
export const POLICY = text.replace(/\s+/g, ' ').trim()
