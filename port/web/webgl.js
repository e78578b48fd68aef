// The functions of OpenGL ES 3.0 that kernels/gles calls, on a WebGL2RenderingContext. #objects maps the numbers of
// OpenGL objects to WebGL objects. Buffers for uploads lie in the memory of the WebAssembly module to save a copy.

const COMPONENTS = { 0x8d99: 4, 0x8228: 2 } // 32-bit words a pixel of the uploaded layouts RGBA_INTEGER and RG_INTEGER
const NUM_EXTENSIONS = 0x821d // glGet parameter of OpenGL that WebGL lacks: the number of extensions

const SAME = [
  'ActiveTexture',
  'BlendEquationSeparate',
  'BlendFuncSeparate',
  'CheckFramebufferStatus',
  'ColorMask',
  'Disable',
  'DrawArrays',
  'Enable',
  'IsEnabled',
  'PixelStorei',
  'Scissor',
  'TexParameteri',
  'Viewport',
]

export class Functions {
  #gl
  #core
  #objects = [null]
  #free = []
  #guests = []
  #locations = []
  #unpack = 0
  #staging = { at: 0, bytes: 0 }
  #copies = false
  #isFull = false

  constructor(gl, core) {
    this.#gl = gl
    this.#core = core
    this.#copies = !this.#takes(core.c.memory.buffer)
    for (const name of SAME) this[name] = gl[name[0].toLowerCase() + name.slice(1)].bind(gl)
    for (const kind of ['Buffer', 'Framebuffer', 'Renderbuffer', 'Texture', 'VertexArray']) {
      this[`Gen${kind}s`] = (count, at) => this.#words(at, count).forEach((_, i, names) => {
        names[i] = this.#add(gl[`create${kind}`]())
      })
      this[`Delete${kind}s`] = (count, at) =>
        this.#words(at, count).forEach((name) => this.#drop(`delete${kind}`, name))
    }
    for (const kind of ['Program', 'Shader'])
      this[`Delete${kind}`] = (name) => this.#drop(`delete${kind}`, name)
    for (const [kind, count] of [['1i', 1], ['2f', 2], ['4i', 4]])
      this[`Uniform${kind}`] = (location, ...values) => gl[`uniform${kind}`](this.#locations[location], ...values)
  }

  #takes(memory) {
    try {
      this.#gl.readPixels(0, 0, 0, 0, this.#gl.RGBA, this.#gl.UNSIGNED_BYTE, new Uint8Array(memory, 0, 4))
      return true
    } catch {
      return false
    }
  }

  #words(at, count) {
    return new Int32Array(this.#core.c.memory.buffer, at >>> 0, count)
  }

  // ---- Objects ------------------------------------------------------------------------------------------------

  #add(object) {
    if (!object) return 0
    const name = this.#free.pop() ?? this.#objects.length
    this.#objects[name] = object
    return name
  }

  nameOf(object) {
    const known = this.#objects.indexOf(object ?? null)
    if (known >= 0) return known
    this.#guests.push(this.#add(object))
    return this.#guests.at(-1)
  }

  #forget(name) {
    this.#objects[name] = undefined
    this.#free.push(name)
  }

  #drop(method, name) {
    if (!this.#objects[name]) return
    this.#gl[method](this.#objects[name])
    this.#forget(name)
  }

  /** Calls a function of the module while WebGL's flags for flipped and premultiplied uploads are off, since OpenGL
      lacks these flags. */
  call(run) {
    const gl = this.#gl
    const switches = [gl.UNPACK_FLIP_Y_WEBGL, gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL]
    const before = switches.map((name) => gl.getParameter(name))
    for (const name of switches) gl.pixelStorei(name, false)
    try {
      return run(this)
    } finally {
      switches.forEach((name, i) => gl.pixelStorei(name, before[i]))
      this.#guests.splice(0).forEach((name) => this.#forget(name))
    }
  }

  close() {
    this.#core.c.release(this.#staging.at)
  }

  BindFramebuffer(target, name) {
    this.#gl.bindFramebuffer(target, this.#objects[name])
  }

  BindSampler(unit, name) {
    this.#gl.bindSampler(unit, this.#objects[name])
  }

  BindTexture(target, name) {
    this.#gl.bindTexture(target, this.#objects[name])
  }

  BindVertexArray(name) {
    this.#gl.bindVertexArray(this.#objects[name])
  }

  FramebufferTexture2D(target, attachment, kind, name, level) {
    this.#gl.framebufferTexture2D(target, attachment, kind, this.#objects[name], level)
  }

  DrawBuffers(count, at) {
    this.#gl.drawBuffers([...this.#words(at, count)])
  }

  // ---- Shader programs ----------------------------------------------------------------------------------------

  CreateProgram() {
    return this.#add(this.#gl.createProgram())
  }

  CreateShader(kind) {
    return this.#add(this.#gl.createShader(kind))
  }

  ShaderSource(name, count, at) {
    const parts = Array.from(this.#words(at, count), (part) => this.#core.text(part))
    this.#gl.shaderSource(this.#objects[name], parts.join(''))
  }

  CompileShader(name) {
    this.#gl.compileShader(this.#objects[name])
  }

  GetShaderiv(name, what, at) {
    this.#words(at, 1)[0] = Number(this.#gl.getShaderParameter(this.#objects[name], what))
  }

  GetShaderInfoLog(name, room, length, at) {
    this.#log(this.#gl.getShaderInfoLog(this.#objects[name]), room, at)
  }

  GetProgramInfoLog(name, room, length, at) {
    this.#log(this.#gl.getProgramInfoLog(this.#objects[name]), room, at)
  }

  #log(text, room, at) {
    const end = this.#core.write(text ?? 'the context is lost', at, room - 1)
    this.#core.bytes(at + end, 1)[0] = 0
  }

  AttachShader(program, shader) {
    this.#gl.attachShader(this.#objects[program], this.#objects[shader])
  }

  LinkProgram(name) {
    this.#gl.linkProgram(this.#objects[name])
  }

  GetProgramiv(name, what, at) {
    this.#words(at, 1)[0] = Number(this.#gl.getProgramParameter(this.#objects[name], what))
  }

  UseProgram(name) {
    this.#gl.useProgram(this.#objects[name])
  }

  GetUniformLocation(program, name) {
    const location = this.#gl.getUniformLocation(this.#objects[program], this.#core.text(name))
    return location ? this.#locations.push(location) - 1 : -1
  }

  // ---- Context state ------------------------------------------------------------------------------------------

  #parameter(what) {
    if (what === this.#gl.PIXEL_UNPACK_BUFFER_BINDING) return this.#unpack
    if (what === NUM_EXTENSIONS) return 0
    const value = this.#gl.getParameter(what)
    return value instanceof Object && value.length === undefined ? this.nameOf(value) : value
  }

  GetIntegerv(what, at) {
    const values = [this.#parameter(what)].flatMap((value) => (value instanceof Object ? [...value] : Number(value)))
    this.#words(at, values.length).set(values)
  }

  GetBooleanv(what, at) {
    const values = this.#gl.getParameter(what) ?? []
    this.#core.bytes(at, values.length).set(values)
  }

  GetError() {
    const error = this.#isFull ? this.#gl.OUT_OF_MEMORY : this.#gl.getError()
    this.#isFull = false
    return error
  }

  // ---- Buffers ------------------------------------------------------------------------------------------------

  BindBuffer(target, name) {
    this.#unpack = name
  }

  BufferData() {}

  MapBufferRange(target, offset, bytes) {
    if (this.#staging.bytes < bytes) {
      this.#core.c.release(this.#staging.at)
      this.#staging = { at: this.#core.c.allocate(bytes) >>> 0, bytes }
      if (!this.#staging.at) {
        this.#staging.bytes = 0
        this.#isFull = true
      }
    }
    return this.#staging.at
  }

  UnmapBuffer() {
    return 1
  }

  TexImage2D(target, level, format, width, height, border, layout, type) {
    this.#gl.texImage2D(target, level, format, width, height, border, layout, type, null)
  }

  TexSubImage2D(target, level, x, y, width, height, layout, type, at) {
    const start = this.#unpack ? this.#staging.at + at : at
    const data = new Uint32Array(this.#core.c.memory.buffer, start >>> 0, width * height * COMPONENTS[layout])
    this.#gl.texSubImage2D(target, level, x, y, width, height, layout, type, this.#copies ? data.slice() : data)
  }
}
