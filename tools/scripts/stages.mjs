// Assembles the compute shaders for WebGPU from kernels/compute/*.wgsl and src/include/fixsplat/internal/pixel.h.
// node tools/scripts/stages.mjs FILE writes the module stages.js of the npm package: the texts of all shader parts
// without comments and most line ends, and for each rendering stage the names of its parts.
import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

export const room = "kernels/compute/";
export const stages = ["locate", "gather", "prepare", "lists", "fill", "sort", "blend", "trace", "finish",
                       "ids"];

// Converts pixel.h from C to WGSL. These replacements suffice for its small subset of C.
function pixelHeader()
{
    return readFileSync("src/include/fixsplat/internal/pixel.h", "utf8")
        .replace(/\/\*[^]*?\*\//g, "")
        .replace(/[ \t]+$/gm, "")
        .replace(/^#define (\w+) (\d+)$/gm, "const $1: i32 = $2;")
        .replace(/^#.*\n/gm, "")
        .replace(/FXS_FN int (\w+)\(([^)]*)\)/g, (all, name, parameters) =>
            `fn ${name}(${parameters.replace(/int (\w+)/g, "$1: i32")}) -> i32`)
        .replace(/return ([^?;]*) \? ([^:;]*) : ([^;]*);/g, "return select($3, $2, $1);")
        .replace(/\bint (\w+) = /g, "var $1 = ");
}

const fileOf = (part) => readFileSync(`${room}${part}.wgsl`, "utf8");

// Part "x_functions": the functions of stage x, without its buffers and entry points.
const functionsOf = (part) => fileOf(part).replace(/^@group.*\n|^@compute[^]*?\n\}\n/gm, "");

const textOf = (part) => part === "pixel" ? pixelHeader()
                       : part.endsWith("_functions") ? functionsOf(part.slice(0, -"_functions".length)) : fileOf(part);
const partsOf = (stage) => [...textOf(stage).match(/^\/\/ Needs (.*)$/m)[1].split(" "), stage];

export const stageText = (stage) => partsOf(stage).map(textOf).join("\n");

const bare = (text) => text.replace(/\/\/.*/g, "").replace(/^\s+|[ \t]+$/gm, "").replace(/([;{},])\n/g, "$1")
    .replace(/ ?([,=+*&|]) /g, "$1");

function packageModule()
{
    const parts = Object.fromEntries(stages.map((stage) => [stage, partsOf(stage)]));
    const texts = Object.fromEntries(Object.values(parts).flat().map((part) => [part, bare(textOf(part))]));
    return `export const parts = ${JSON.stringify(parts)}\nexport const texts = ${JSON.stringify(texts)}\n`;
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? "").href)
    writeFileSync(process.argv[2], packageModule());
