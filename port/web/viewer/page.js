// The page of the viewer. Its address sets the scene (?scene=URL), other attributes of <fixsplat-viewer>, and the
// camera (#view=...).
import './viewer.js'
import { followAddress } from './views.js'

const scene = new URLSearchParams(location.search).get('scene')
const viewer = document.createElement('fixsplat-viewer')
viewer.toggleAttribute('edit', true)
if (scene !== null) viewer.setAttribute('src', scene)
followAddress(viewer)
document.getElementById('local').remove()
document.body.append(viewer)
viewer.focus({ focusVisible: false })
