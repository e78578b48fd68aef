// Flags of Chromium for WebGL and WebGPU on the CPU, by SwiftShader. The environment variable FXS_WEBGPU_FLAGS replaces
// the flags for WebGPU.
const GL = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader']
// Chromium itself draws pages without SwiftShader, which would take most of a test's time.
export const WEBGL = [...GL, '--disable-gpu-rasterization', '--disable-gpu-compositing']
const SWIFTSHADER = [...GL, '--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader',
  '--enable-features=Vulkan', '--use-vulkan=swiftshader']
export const WEBGPU = process.env.FXS_WEBGPU_FLAGS?.split(' ') ?? SWIFTSHADER
