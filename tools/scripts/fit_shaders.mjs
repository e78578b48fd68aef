// node tools/scripts/fit_shaders.mjs FOLDER: makes FOLDER/SHADER.spv, the shaders of kernels/fit/vulkan in SPIR-V for
// Vulkan 1.1, with cc, glslangValidator and spirv-opt. The formulas come from the headers of src/fit/stages
// (stage_functions.mjs). The repository stores these files in kernels/fit/vulkan/generated.
//
// Each addition, subtraction, multiplication and negation of floats gets the decoration NoContraction: it is rounded by
// itself, as on the processor.
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { needed, stageFunctions } from "./stage_functions.mjs";

const room = "kernels/fit/vulkan", stages = "src/fit/stages";
const headers = ["fit_stage.h", "fit_lanes.h", "fit_gaussian.h", "fit_pixel.h", "span.h", "fit_project.h", "adam.h",
                 "noise.h", "smooth.h", "fit_surface.h", "loss.h", "exposure.h", "pose.h"].map((name) => `${stages}/${name}`)
    .concat("src/fit/quantise.h", `${room}/fit_order.h`);

const OP_NAME = 5, OP_FUNCTION = 54, OP_DECORATE = 71, NO_CONTRACTION = 42, DONT_INLINE = 2;
const FLOAT_OPERATIONS = new Set([127, 129, 131, 133, 136]);   // FNegate, FAdd, FSub, FMul, FDiv
const TYPE_OPERATIONS = new Set([19, 20, 21, 22]);             // the first instructions behind the decorations

// Calls visit(opcode, first word, number of words) for each instruction of a module.
function visit(words, seen)
{
    for (let at = 5; at < words.length; at += words[at] >>> 16)
        seen(words[at] & 0xffff, at);
}

// This shader divides in its innermost loop.
const INLINED = "backward_tiles.comp";

// True for the name (from word `at` on) of a function of which there is only one copy, as each takes a kilobyte.
function isWhole(words, at)
{
    const bytes = new Uint8Array(words.buffer, words.byteOffset + 4 * at, 12);
    return /^(?:divide\(f1;|sqrtf\()/.test(String.fromCharCode(...bytes));
}

function withoutContraction(words, isInlined)
{
    const added = [], whole = new Set();
    let end = 0;
    visit(words, (code, at) => {
        if (code === OP_NAME && !isInlined && isWhole(words, at + 2))
            whole.add(words[at + 1]);
        if (code === OP_FUNCTION && whole.has(words[at + 2]))
            words[at + 3] |= DONT_INLINE;
        if (FLOAT_OPERATIONS.has(code))
            added.push(3 << 16 | OP_DECORATE, words[at + 2], NO_CONTRACTION);
        end ||= TYPE_OPERATIONS.has(code) ? at : 0;
    });
    return Uint32Array.from([...words.subarray(0, end), ...added, ...words.subarray(end)]);
}

// The macros of the headers that are numbers, as GLSL.
function macros()
{
    const text = execFileSync(process.env.CC ?? "cc", ["-E", "-dM", "-xc", "-I.", "-Isrc/include", "-"],
                              { input: headers.map((header) => `#include "${header}"\n`).join(""), encoding: "utf8" });
    return text.split("\n").filter((line) => /^#define FXS_FIT_\w+ [\d(]/.test(line)).sort().join("\n") + "\n";
}

function included(file)
{
    return readFileSync(`${room}/${file}`, "utf8").replace(/^#include "(.*)"\n/gm, (_, name) => included(name));
}

function run(command, given)
{
    const done = spawnSync(command, given, { encoding: "utf8" });
    if (done.status)
        throw Error(done.stdout + done.stderr);
}

// How load and store reach the parameters, unless a shader defines it otherwise.
const access = { LOADED: "LOADED(at) parameters[at]", STORED: "STORED(at) masters[at]", QUALIFIER: "QUALIFIER" };

// The text of a shader: its definitions, those of the headers, and then the functions that it needs.
function shaderText(file)
{
    const shader = included(file), isDefined = (name) => RegExp(`^#define ${name}\\b`, "m").test(shader);
    const isType = /^(?:struct|const int) .*\n/gm, functions = needed(parts, shader);
    const own = /^#define (?:LOADED|STORED|QUALIFIER)\b.*\n/gm;
    return "#version 450\n#extension GL_KHR_shader_subgroup_ballot : require\n" + (shader.match(own) ?? []).join("") +
           Object.keys(access).filter((name) => !isDefined(name)).map((name) => `#define ${access[name]}\n`).join("") +
           macros() + functions.match(isType).join("") + included("numbers.glsl") + included("step.glsl") +
           functions.replace(isType, "") + shader.replace(own, "");
}

const folder = process.argv[2], parts = stageFunctions(headers);
const work = mkdtempSync(join(tmpdir(), "shaders-"));
try {
    for (const file of readdirSync(room).filter((name) => name.endsWith(".comp"))) {
        writeFileSync(`${work}/${file}`, shaderText(file));
        run("glslangValidator", ["-V", "--target-env", "vulkan1.1", "-o", `${work}/first`, `${work}/${file}`]);
        const bytes = readFileSync(`${work}/first`);
        const words = new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
        writeFileSync(`${work}/second`, withoutContraction(words, file === INLINED));
        run("spirv-opt", ["-O", "--strip-debug", "--compact-ids", `${work}/second`, "-o",
                          `${folder}/${file.replace(".comp", ".spv")}`]);
    }
} finally {
    rmSync(work, { recursive: true });
}
