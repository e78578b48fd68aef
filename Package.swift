// swift-tools-version:5.9
// The library as a Swift package: `import fixsplat`, or #include <fixsplat/renderer.h>. docs/porting.md says what it has.
import PackageDescription

let package = Package(
    name: "fixsplat",
    platforms: [.macOS(.v11), .iOS(.v14), .visionOS(.v1)],
    products: [.library(name: "fixsplat", targets: ["fixsplat"])],
    targets: [
        .target(
            name: "fixsplat",
            path: ".",
            exclude: ["docs", "make", "port/posix/http", "tests", "tools"],
            sources: [
                "src/core", "src/base", "src/gaussian", "src/scene", "src/open", "src/pack", "src/camera", "src/image",
                "src/fit", "src/select", "src/surface", "kernels/kernels.c", "kernels/simd/arm",
                "kernels/fit/fit_neon.c", "port/backend", "port/xr",
                "port/board/panel.c", "port/board/strip.c", "port/board/turntable.c", "port/posix",
            ],
            publicHeadersPath: "src/include",
            cSettings: [
                .headerSearchPath("."),
                .define("_POSIX_C_SOURCE", to: "200809L"),
                .define("_DARWIN_C_SOURCE"),
                .define("st_mtim", to: "st_mtimespec"),
                .define("FXS_SAME_FLAGS"),
                .define("FXS_WITH_KERNELS"),
                .define("FXS_WITH_ZLIB"),
            ],
            linkerSettings: [.linkedLibrary("z")]),
    ],
    cLanguageStandard: .c99)
