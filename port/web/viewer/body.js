// The HTML inside <fixsplat-viewer>: the stage for the picture, the buttons and the panels.

const icon = (path) => `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${path}"/></svg>`
export const button = (id, name, path, more = '') =>
  `<button id="${id}" type="button" aria-label="${name}" title="${name}" ${more}>${icon(path)}</button>`

export const ICONS = {
  open: 'M3 18V6a1 1 0 0 1 1-1h5l2 3h8a1 1 0 0 1 1 1v2M3 18l3-7h15l-3 8H4a1 1 0 0 1-1-1z',
  before: 'M15 5l-7 7 7 7',
  after: 'M9 5l7 7-7 7',
  orbit: 'M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8zM5 19A9.9 3.8 -45 1 1 19 5 9.9 3.8 -45 1 1 5 19z',
  fly: 'M21 3L3 10.5l6.5 3L12.5 20 21 3zM9.5 13.5L21 3',
  walk: 'M13 3.5a1.6 1.6 0 1 0 0 3.2 1.6 1.6 0 0 0 0-3.2zM7 12l2.5-3 3-.8 2 3 3 1.3' +
    'M12.5 8.5L11 14l3 3 .8 4M11 14l-1 3.5L7 21',
  home: 'M4 11l8-7 8 7M6 10v9h4v-5h4v5h4v-9',
  share: 'M10 14a4 4 0 0 0 6 0l3-3a4 4 0 0 0-6-6l-1 1M14 10a4 4 0 0 0-6 0l-3 3a4 4 0 0 0 6 6l1-1',
  photo: 'M4 8h4l2-3h4l2 3h4v11H4zM12 10a3.2 3.2 0 1 0 0 6.4 3.2 3.2 0 0 0 0-6.4z',
  set: 'M4 8h8M17 8h3M4 16h3M12 16h8M14.5 5.5a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5z' +
    'M9.5 13.5a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5z',
  keys: 'M9 9a3 3 0 1 1 4.5 2.6c-1 .6-1.5 1.2-1.5 2.4M12 17.5v.5',
  full: 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5',
  headset: 'M5 7h14a2 2 0 0 1 2 2v6a2 2 0 0 1-2 2h-3.5l-2-3h-3l-2 3H5a2 2 0 0 1-2-2V9a2 2 0 0 1 2-2z',
  room: 'M12 7l5 2.8v5.4L12 18l-5-2.8V9.8zM7 9.8l5 2.8 5-2.8M12 12.6V18M3 7V3h4M17 3h4v4M21 17v4h-4M7 21H3v-4',
  close: 'M6 6l12 12M18 6L6 18',
}

const MODES = {
  orbit: [
    ['Drag', 'turn the scene'],
    ['Right drag', 'move it; or two fingers'],
    ['Wheel', 'nearer, farther; or pinch'],
    ['Double click', 'go to what is there'],
    ['← ↑ ↓ →', 'turn'],
    ['W A S D Q E', 'move through it'],
  ],
  fly: [
    ['Drag', 'look around'],
    ['Right drag', 'sideways; or two fingers'],
    ['Wheel', 'ahead, back; or pinch'],
    ['Double click', 'go to what is there'],
    ['W A S D', 'fly'],
    ['Q E', 'down, up'],
    ['Shift', 'four times as fast'],
    ['G', 'look by the mouse alone'],
  ],
  walk: [
    ['Drag', 'look around'],
    ['Wheel', 'ahead, back; or pinch'],
    ['Double click', 'go to what is there'],
    ['W A S D ← ↑ ↓ →', 'walk'],
    ['Q E', 'turn left, right'],
    ['Shift', 'four times as fast'],
    ['G', 'look by the mouse alone'],
  ],
}

const ALWAYS = [
  ['1 2 3', 'turn, fly, walk'],
  ['R', 'back to the start'],
  ['0', 'the whole scene'],
  ['N P', 'next, previous view'],
  ['T', 'turn by itself'],
  ['B V', 'fewer, more splats'],
  ['K', 'play the scene or the camera track'],
  [', .', 'previous, next frame or annotation'],
  ['[ ] Y', 'slower, faster; again and again'],
  ['M', 'sound on, off'],
  ['I', 'save a picture'],
  ['L', 'copy a link to this view'],
  ['F', 'full screen'],
  ['O', 'open a file'],
  ['H', 'this list'],
]

const caps = (keys) => (/^[^a-z]+$|^Shift$/.test(keys) ? keys.split(' ') : [keys])
const rows = (list) =>
  list.map(([keys, does]) => {
    const all = caps(keys).map((key) => `<kbd>${key}</kbd>`)
    return `<div><dt>${all.join('')}</dt><dd>${does}</dd></div>`
  })

export const listOf = (mode) => [MODES[mode], ALWAYS].map((list) => `<dl>${rows(list).join('')}</dl>`).join('')

const check = (name, words, more = '') => `<label>${words} <input name="${name}" type="checkbox" ${more}></label>`

const settings = `
<label>Background <input name="background" type="color" value="#0e1116"></label>
<label>Angle of view <output id="angle"></output>
  <input name="fov" type="range" min="20" max="100" value="50" aria-label="Angle of view"></label>
<label>Speed <input name="speed" type="range" min="0.1" max="2" step="0.1" value="0.5"></label>
<label id="tall" hidden>Height of the eye <input name="eyeHeight" type="range" min="-2" max="2" step="0.1"></label>
<label>Picture <select name="sharpness">
  <option value="1">Sharp</option><option value="0.6667">Medium</option>
  <option value="0.5">Quick</option></select></label>
<label>Saved picture <select name="enlarge">
  <option value="1">As shown</option>
  ${[2, 4, 8].map((n) => `<option value="${n}">× ${n}</option>`).join('')}</select></label>
<label id="levels" hidden>Splats <output id="budget"></output>
  <input name="budget" type="range" min="0" max="11" aria-label="Splats of a picture at most"></label>
<label>Upright <select name="up">
  <option value="">As it looks</option><option value="0,-1,0">As in the file</option><option value="0,1,0">Upside down</option>
  <option value="0,0,1">Tipped forward</option><option value="0,0,-1">Tipped back</option></select></label>
<label>Drawn by <select name="backend">
  <option value="">What is faster</option><option value="wasm">Processor</option>
  <option value="webgpu">Graphics card</option>
  <option value="webgl2">Graphics card and processor</option></select></label>
<p class="fine" id="draws"></p>
<label id="arSize" hidden>In your room <select name="ar">
  <option value="table">On the table</option><option value="true">True size</option></select></label>
<label>Tone curve <select name="tone"><option value="linear">None</option><option value="filmic">Filmic</option>
  <option value="hejl">Hejl</option><option value="aces">ACES</option></select></label>
<label>Exposure <input name="exposure" type="range" min="-4" max="4" step="0.1"></label>
<label>Vignette <input name="vignette" type="range" min="0" max="1" step="0.05"></label>
${check('colours', 'Gloss and reflections', 'checked')}
${check('flat', 'Without perspective')}
${check('turn', 'Turns by itself')}
${check('readout', 'Show pictures a second')}
<p class="making"><button id="mark" type="button">Mark a place</button>
<button id="addKey" type="button">Add this view to the track</button>
<button id="save" type="button">Save settings</button>
<button id="edit" type="button" hidden>Edit by hand</button></p>`

export const panel = (id, name, close, inside) => `
<section id="${id}" class="panel" aria-label="${name}" hidden>
  <header><h2>${name}</h2>${button(close, 'Close', ICONS.close)}</header>${inside}
</section>`

export const body = `
<div id="stage" tabindex="0" role="application"
  aria-label="The scene. Drag or use the arrow keys to turn it; H lists the keys."></div>
<div id="empty" class="ui">
  <h1>fixsplat</h1>
  <p>Drop a scene here:</p><p>@FORMATS@</p>
  <button id="choose" type="button" class="main">Open a file</button>
  <p class="fine">It stays on this machine: nothing is sent.</p>
</div>
<div class="ui top">
  <p class="title"><b id="name" translate="no"></b> <span id="count"></span></p>
  ${button('headset', 'Look at it in the headset', ICONS.headset, 'hidden')}
  ${button('room', 'See it in your room', ICONS.room, 'hidden')}
  ${button('full', 'Full screen (F)', ICONS.full)}
</div>
<p id="readout" class="ui" hidden></p>
<div id="loading" class="panel card" hidden>
  <p><span id="stageOf" role="status"></span> <span id="percent"></span></p>
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
  <span id="modes" role="group" aria-label="Mode">
    ${button('orbit', 'Turn the scene (1)', ICONS.orbit, 'aria-pressed="true"')}
    ${button('fly', 'Fly (2)', ICONS.fly, 'aria-pressed="false"')}
    ${button('walk', 'Walk (3)', ICONS.walk, 'aria-pressed="false"')}
  </span>
  ${button('home', 'Back to the start (R)', ICONS.home)}
  ${button('share', 'Copy a link to this view (L)', ICONS.share)}
  ${button('photo', 'Save a picture (I)', ICONS.photo)}
  ${button('set', 'Settings', ICONS.set, 'aria-expanded="false" aria-controls="options"')}
  ${button('keys', 'Keys (H)', ICONS.keys, 'aria-expanded="false" aria-controls="help"')}
</nav>
${panel('options', 'Settings', 'closeOptions', settings)}
${panel('help', 'Keys', 'closeHelp', '<div id="list"></div>')}
<input id="file" type="file" aria-label="A scene" multiple hidden>`
