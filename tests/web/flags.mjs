// Flags of Chromium for WebGL and WebGPU by SwiftShader. FXS_WEBGPU_FLAGS replaces the WebGPU flags.
export const WEBGL = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader']
const SWIFTSHADER = [...WEBGL, '--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader',
  '--enable-features=Vulkan', '--use-vulkan=swiftshader']
export const WEBGPU = process.env.FXS_WEBGPU_FLAGS?.split(' ') ?? SWIFTSHADER
