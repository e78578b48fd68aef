// Shows the pictures for the eyes of a headset. A picture is reprojected to the present pose of the head, as a plane at
// the distance of the scene.

export function cameraOf(view, place, { width, height, margin = 0 }, near) {
  const [p, m] = [view.projectionMatrix, view.transform.matrix]
  const axis = (i, sign) => place.turned([sign * m[4 * i], sign * m[4 * i + 1], sign * m[4 * i + 2]])
  const axes = [axis(0, 1), axis(1, -1), axis(2, -1)]
  return {
    width: width + 2 * margin,
    height: height + 2 * margin,
    fx: (p[0] * width) / 2,
    fy: (p[5] * height) / 2,
    cx: ((1 - p[8]) * width) / 2 + margin,
    cy: ((1 + p[9]) * height) / 2 + margin,
    rotation: [0, 1, 2].map((i) => axes.map((a) => a[i])),
    position: place.at([m[12], m[13], m[14]]),
    near,
  }
}

const flat = ({ width, height, fx, fy, cx, cy, rotation, position }) =>
  [width, height, fx, fy, cx, cy, ...rotation.flat(), ...position]

export const isSame = (a, b) => flat(a).join() === flat(b).join()

const [ROWS, COLUMNS] = [[0, 3, 6], [0, 1, 2]]
const sum = (a, r, b, c) => a[r] * b[c] + a[r + 1] * b[3 + c] + a[r + 2] * b[6 + c]
const product = (a, b) => ROWS.flatMap((r) => COLUMNS.map((c) => sum(a, r, b, c)))
const transposed = (a) => COLUMNS.flatMap((c) => ROWS.map((r) => a[r + c]))

/** Returns the homography between the pixels of two cameras for a plane at depth `far`: K' R'^T M K^-1. K, R and e
    are intrinsics, rotation and eye; primes mark the second camera. M is R with (e - e') / far added to its last
    column. */
export function turnBetween(from, to, far) {
  const rays = [1 / from.fx, 0, -from.cx / from.fx, 0, 1 / from.fy, -from.cy / from.fy, 0, 0, 1]
  const pixels = [to.fx, 0, to.cx, 0, to.fy, to.cy, 0, 0, 1]
  const seen = from.rotation.map(([x, y, z], i) => [x, y, z + (from.position[i] - to.position[i]) / far])
  return product(pixels, product(transposed(to.rotation.flat()), product(seen.flat(), rays)))
}

const VERTEX = `#version 300 es
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }`

// The shader counts pixels from the top left. The texture holds the pictures of both eyes side by side; `left` is the
// first column of the eye's picture.
const FRAGMENT = `#version 300 es
precision highp float;
uniform highp sampler2D picture;
uniform vec4 viewport;
uniform vec2 area;
uniform float left;
uniform mat3 turn;
uniform bool same;
uniform vec4 ground;
out vec4 colour;
void main() {
  vec2 pixel = vec2(gl_FragCoord.x - viewport.x, viewport.y + viewport.w - gl_FragCoord.y);
  if (same) {
    colour = texelFetch(picture, ivec2(pixel + vec2(left, 0.0)), 0);
    return;
  }
  vec3 p = turn * vec3(pixel, 1.0);
  vec2 at = p.xy / p.z;
  bool inside = p.z > 0.0 && all(greaterThanEqual(at, vec2(0.0))) && all(lessThanEqual(at, area));
  vec2 clamped = clamp(at, vec2(0.5), area - 0.5) + vec2(left, 0.0);
  colour = inside ? texture(picture, clamped / vec2(textureSize(picture, 0))) : ground;
}`

export function programOf(gl, vertex, fragment) {
  const program = gl.createProgram()
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind)
    gl.shaderSource(shader, text)
    gl.compileShader(shader)
    gl.attachShader(program, shader)
  }
  gl.linkProgram(program)
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error(`the headset's picture: ${gl.getProgramInfoLog(program)}`)
  return program
}

export class Eyes {
  #gl
  #program
  #at = {}

  constructor(gl) {
    this.#gl = gl
    const program = (this.#program = programOf(gl, VERTEX, FRAGMENT))
    gl.useProgram(program)
    for (const name of ['viewport', 'area', 'left', 'turn', 'same', 'ground'])
      this.#at[name] = gl.getUniformLocation(program, name)
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture())
    for (const name of ['MIN_FILTER', 'MAG_FILTER']) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.LINEAR)
    for (const name of ['WRAP_S', 'WRAP_T']) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.CLAMP_TO_EDGE)
  }

  take(cameras, { pictures, bitmap }) {
    const gl = this.#gl
    const [{ width, height }] = cameras
    this.cameras = cameras
    if (bitmap) {
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, bitmap)
      return bitmap.close()
    }
    const whole = pictures.length * width
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, whole, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null)
    pictures.forEach((pixels, i) => {
      const bytes = new Uint8Array(pixels.buffer)
      gl.texSubImage2D(gl.TEXTURE_2D, 0, i * width, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes)
    })
  }

  /** Draws the picture of an eye for a camera. If the camera is that of the picture, the bytes are copied; else the
      picture is reprojected. */
  draw(eye, camera, far, { x, y, width, height }) {
    const gl = this.#gl
    const index = Math.min(eye, this.cameras.length - 1)
    const own = this.cameras[index]
    gl.viewport(x, y, width, height)
    gl.uniform4f(this.#at.viewport, x, y, width, height)
    gl.uniform2f(this.#at.area, own.width, own.height)
    gl.uniform1f(this.#at.left, index * own.width)
    gl.uniform1i(this.#at.same, isSame(camera, own) ? 1 : 0)
    gl.uniformMatrix3fv(this.#at.turn, true, turnBetween(camera, own, far))
    gl.drawArrays(gl.TRIANGLES, 0, 3)
  }

  set ground(rgb) {
    const gl = this.#gl
    const parts = rgb === null ? [0, 0, 0, 0] : [...[16, 8, 0].map((shift) => ((rgb >> shift) & 255) / 255), 1]
    gl.useProgram(this.#program)
    gl.uniform4f(this.#at.ground, ...parts)
    gl.clearColor(...parts)
  }
}

const [LEAST, MOST] = [0.35, 1]
const STEP = 1.25
const MARGIN = 1 / 8
const PATIENCE = 4 // number of quickly drawn pictures in a row after which the picture size grows

/** Controls the size of pictures, so that drawing takes about `aim` milliseconds. Reduced pictures get a margin around
    the view, because the head turns while they are drawn. */
export class Scale {
  value = 0.5
  #aim
  #quick = 0
  #slow = 0

  constructor(aim) {
    this.#aim = aim
  }

  of({ width, height }) {
    const [w, h] = [width, height].map((n) => Math.max(1, Math.round(n * this.value)))
    return { width: w, height: h, margin: this.value < MOST ? Math.ceil(MARGIN * w) : 0 }
  }

  take(milliseconds) {
    this.#quick = milliseconds * STEP ** 2 < 0.8 * this.#aim ? this.#quick + 1 : 0
    this.#slow = milliseconds > 1.2 * this.#aim ? this.#slow + 1 : 0
    if (this.#slow >= 2) this.#set(this.value * Math.max(0.6, Math.sqrt(this.#aim / milliseconds)))
    if (this.#quick >= PATIENCE) this.#set(this.value * STEP)
  }

  #set(value) {
    this.value = Math.max(LEAST, Math.min(MOST, value))
    this.#quick = this.#slow = 0
  }
}
