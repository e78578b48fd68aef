// The page of the viewer. The address of the page chooses the scene (?scene=URL), other attributes of the element
// <fixsplat-viewer>, and the camera (#view=...).
import './viewer.js'

const NAMES = ['cameras', 'background', 'budget', 'detail', 'backend', 'threads', 'poster', 'turn', 'noui',
  'wheel', 'keep', 'settings', 'skybox', 'lang', 'ar']
const asked = new URLSearchParams(location.search)
const viewer = document.createElement('fixsplat-viewer')

/** The camera and the annotation of a link. */
function takeLink() {
  const link = new URLSearchParams(location.hash.slice(1))
  viewer.setAttribute('view', link.get('view') ?? '')
  if (link.has('annotation')) viewer.setAttribute('annotation', link.get('annotation'))
}

takeLink()
if (asked.has('scene')) viewer.setAttribute('src', asked.get('scene'))
for (const name of NAMES) if (asked.has(name)) viewer.setAttribute(name, asked.get(name))
addEventListener('hashchange', takeLink)
document.getElementById('local').remove()
document.body.append(viewer)
viewer.focus({ focusVisible: false })
