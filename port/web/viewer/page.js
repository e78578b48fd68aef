// The page: its address says what is shown. ?scene=URL &cameras=URL &background=%23rrggbb &noui; #view=...
import './viewer.js'

const asked = new URLSearchParams(location.search)
const viewer = document.createElement('fixsplat-viewer')
const viewOfLink = () => new URLSearchParams(location.hash.slice(1)).get('view') ?? ''

viewer.setAttribute('view', viewOfLink())
if (asked.has('scene')) viewer.setAttribute('src', asked.get('scene'))
for (const name of ['cameras', 'background', 'noui']) if (asked.has(name)) viewer.setAttribute(name, asked.get(name))
addEventListener('hashchange', () => viewer.setAttribute('view', viewOfLink()))
document.body.append(viewer)
viewer.focus({ focusVisible: false })
