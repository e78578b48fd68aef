// What the viewer's element holds.

const icon = (path) => `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${path}"/></svg>`
const button = (id, name, path, more = '') =>
  `<button id="${id}" type="button" aria-label="${name}" title="${name}" ${more}>${icon(path)}</button>`

const ICONS = {
  open: 'M3 18V6a1 1 0 0 1 1-1h5l2 3h8a1 1 0 0 1 1 1v2M3 18l3-7h15l-3 8H4a1 1 0 0 1-1-1z',
  before: 'M15 5l-7 7 7 7',
  after: 'M9 5l7 7-7 7',
  home: 'M4 11l8-7 8 7M6 10v9h4v-5h4v5h4v-9',
  share: 'M10 14a4 4 0 0 0 6 0l3-3a4 4 0 0 0-6-6l-1 1M14 10a4 4 0 0 0-6 0l-3 3a4 4 0 0 0 6 6l1-1',
  photo: 'M4 8h4l2-3h4l2 3h4v11H4zM12 10a3.2 3.2 0 1 0 0 6.4 3.2 3.2 0 0 0 0-6.4z',
  set: 'M4 8h8M17 8h3M4 16h3M12 16h8M14.5 5.5a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5z' +
    'M9.5 13.5a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5z',
  keys: 'M9 9a3 3 0 1 1 4.5 2.6c-1 .6-1.5 1.2-1.5 2.4M12 17.5v.5',
  full: 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5',
  headset: 'M5 7h14a2 2 0 0 1 2 2v6a2 2 0 0 1-2 2h-3.5l-2-3h-3l-2 3H5a2 2 0 0 1-2-2V9a2 2 0 0 1 2-2z',
  close: 'M6 6l12 12M18 6L6 18',
}

export const keys = [
  ['Drag', 'turn the scene'],
  ['Right drag', 'move it; or two fingers'],
  ['Wheel', 'nearer, farther; or pinch'],
  ['Double click', 'go to what is there'],
  ['W A S D Q E', 'fly; faster with shift'],
  ['Arrows', 'turn'],
  ['Space + drag', 'look around'],
  ['+ −', 'nearer, farther'],
  ['N P', 'next, previous view'],
  ['R', 'back to the start'],
  ['I', 'save a picture'],
  ['L', 'copy a link to this view'],
  ['F', 'full screen'],
  ['O', 'open a file'],
  ['H', 'this list'],
]

const settings = `
<label>Background <input name="background" type="color" value="#0e1116"></label>
<label>Angle of view <input name="fov" type="range" min="20" max="100" value="50"></label>
<label>Speed of flight <input name="speed" type="range" min="0.1" max="2" step="0.1" value="0.5"></label>
<label>Picture <select name="sharpness">
  <option value="1">Sharp</option><option value="0.6667">Medium</option>
  <option value="0.5">Quick</option></select></label>
<label>Upright <select name="up">
  <option value="0,-1,0">As in the file</option><option value="0,1,0">Upside down</option>
  <option value="0,0,1">Tipped forward</option><option value="0,0,-1">Tipped back</option></select></label>
<label>Gloss and reflections <input name="colours" type="checkbox" checked></label>`

const panel = (id, name, close, inside) => `
<section id="${id}" class="panel" aria-label="${name}" hidden>
  <header><h2>${name}</h2>${button(close, 'Close', ICONS.close)}</header>${inside}
</section>`

export const body = `
<canvas id="canvas" tabindex="0" role="application"
  aria-label="The scene. Drag or use the arrow keys to turn it; H lists the keys."></canvas>
<div id="empty" class="ui">
  <h1>fixsplat</h1>
  <p>Drop a scene here: .ply, .splat, .ksplat, .spz or .fxs</p>
  <button id="choose" type="button" class="main">Open a file</button>
  <p class="fine">It stays on this machine: nothing is sent.</p>
</div>
<div class="ui top">
  <p class="title"><b id="name"></b> <span id="count"></span></p>
  ${button('headset', 'Look at it in the headset', ICONS.headset, 'hidden')}
  ${button('full', 'Full screen (F)', ICONS.full)}
</div>
<div id="loading" class="panel card" role="status" hidden>
  <p><span id="stage"></span> <span id="percent"></span></p>
  <progress id="bar" aria-label="Progress" max="1"></progress>
</div>
<div id="error" class="panel card" role="alert" hidden>
  <p id="words"></p>${button('closeError', 'Close this message', ICONS.close)}
</div>
<p id="note" class="ui" role="status"></p>
<nav class="ui bar" aria-label="Viewer">
  ${button('add', 'Open a file (O)', ICONS.open)}
  ${button('before', 'Previous view (P)', ICONS.before, 'hidden')}
  ${button('after', 'Next view (N)', ICONS.after, 'hidden')}
  ${button('home', 'Back to the start (R)', ICONS.home)}
  ${button('share', 'Copy a link to this view (L)', ICONS.share)}
  ${button('photo', 'Save a picture (I)', ICONS.photo)}
  ${button('set', 'Settings', ICONS.set, 'aria-expanded="false" aria-controls="options"')}
  ${button('keys', 'Keys (H)', ICONS.keys, 'aria-expanded="false" aria-controls="help"')}
</nav>
${panel('options', 'Settings', 'closeOptions', settings)}
${panel('help', 'Keys', 'closeHelp', '<dl id="list"></dl>')}
<input id="file" type="file" aria-label="A scene" multiple hidden>`
