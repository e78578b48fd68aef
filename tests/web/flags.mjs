// Flags of Chromium for WebGL and WebGPU on the CPU, by SwiftShader. The environment variable FXS_WEBGPU_FLAGS replaces
// the flags for WebGPU.
export const WEBGL = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader']
const SWIFTSHADER = [...WEBGL, '--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader',
  '--enable-features=Vulkan', '--use-vulkan=swiftshader']
export const WEBGPU = process.env.FXS_WEBGPU_FLAGS?.split(' ') ?? SWIFTSHADER
