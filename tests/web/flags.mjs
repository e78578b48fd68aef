// Chromium's flags for graphics by SwiftShader: WebGL alone, or WebGPU too.
export const WEBGL = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader']
export const WEBGPU = [...WEBGL, '--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader',
  '--enable-features=Vulkan', '--use-vulkan=swiftshader']
