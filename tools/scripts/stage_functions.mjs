// Translates the C functions of the fit's stages (src/fit/stages, one float instead of a vector) to GLSL, so that the
// shaders of kernels/fit/vulkan compute the same formulas from the same text. The C must keep to a subset:
//   - float *p is an index into the storage buffer of load and store; real x[n] is an array, and T *p a reference
//   - no other pointers, except `&x` as an argument and `*p` of a reference
// A function beyond the subset is left out; a shader that needs it does not compile.
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const types = new Map([["float", "float"], ["int", "int"], ["int32_t", "int"], ["uint32_t", "uint"], ["void", "void"],
                       ["size_t", "uint"], ["ptrdiff_t", "int"], ["unsigned", "uint"], ["uint8_t", "uint"]]);
const reserved = new Set(["active", "buffer", "common", "filter", "flat", "half", "in", "inout", "input", "length", "out",
                          "output", "patch", "precise", "sample", "shared", "smooth"]);
const named = (name) => reserved.has(name) ? `${name}_` : name;

// Functions that a shader defines itself: they copy bytes.
const ofShader = new Set(["load", "store", "bits_of", "real_of", "numbers_from"]);

class BeyondSubset extends Error {}

const pattern = /\s*(?:(0x[\da-fA-F.]+p[+-]?\d+f?|0x[\da-fA-F]+u?|(?:\d+\.\d*|\.\d+|\d+)(?:[eE][+-]?\d+)?[fu]*)|([A-Za-z_]\w*)|(->|\+\+|--|<<=|>>=|<<|>>|<=|>=|==|!=|&&|\|\||[-+*\/%&|^]=|[-+*\/%&|^~!<>=?:;,.(){}[\]]))/y;

function tokens(text)
{
    const found = [];
    for (pattern.lastIndex = 0; text.slice(pattern.lastIndex).trim();) {
        const at = pattern.lastIndex, match = pattern.exec(text);
        if (!match)
            throw new BeyondSubset(`not C of the subset: ${text.slice(at, at + 40)}`);
        found.push({ text: match[1] ?? match[2] ?? match[3], isNumber: match[1] !== undefined,
                     isName: match[2] !== undefined });
    }
    return found;
}

// A number in GLSL. A float is written with the digits of its exact value.
function numberText(text)
{
    const hexFloat = text.match(/^0x([\da-fA-F]+)\.?([\da-fA-F]*)p([+-]?\d+)f?$/);
    if (hexFloat) {
        const whole = parseInt(hexFloat[1] + hexFloat[2], 16);
        return floatText(whole * 2 ** (Number(hexFloat[3]) - 4 * hexFloat[2].length));
    }
    return /^0x|^\d+u?$/.test(text) ? text : floatText(Math.fround(Number(text.replace(/f$/, ""))));
}

function floatText(x)
{
    const digits = String(x);
    return /[.e]/.test(digits) ? digits : `${digits}.0`;
}

const levels = [["||"], ["&&"], ["|"], ["^"], ["&"], ["==", "!="], ["<", ">", "<=", ">="], ["<<", ">>"], ["+", "-"],
                ["*", "/", "%"]];
const truths = new Set(["||", "&&", "==", "!=", "<", ">", "<=", ">=", "!"]);
const assignments = new Set(["=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="]);

// An expression is {text, isTruth, value}: its GLSL, whether that is a bool, and the value of a constant float.
class Parser {
    constructor(list, structs)
    {
        this.list = list;
        this.at = 0;
        this.structs = structs;
    }

    peek(ahead = 0) { return this.list[this.at + ahead]?.text; }
    next() { return this.list[this.at++].text; }
    takes(text) { return this.peek() === text && (this.at++, true); }

    expect(text)
    {
        if (!this.takes(text))
            throw new BeyondSubset(`expected ${text}, found ${this.list.slice(this.at, this.at + 6).map((t) => t.text).join(" ")}`);
    }

    isType(ahead = 0)
    {
        const text = this.peek(ahead);
        return text === "const" || text === "static" || text === "struct" || types.has(text);
    }

    // Reads a type without its stars.
    type()
    {
        while (["const", "static", "inline", "struct"].includes(this.peek()))
            this.at++;
        const name = this.next();
        if (!types.has(name))
            throw new BeyondSubset(`unknown type ${name}`);
        while (this.takes("const"));
        return types.get(name);
    }

    stars()
    {
        let count = 0;
        for (; this.peek() === "*" || this.peek() === "const"; this.at++)
            count += this.peek() === "*";
        return count;
    }

    sizes()
    {
        let text = "";
        while (this.takes("[")) {
            if (this.peek() === "]")
                throw new BeyondSubset("an array without its size");
            text += `[${this.expression().text}]`;
            this.expect("]");
        }
        return text;
    }

    truth(e) { return e.isTruth ? e.text : `truth(${e.text})`; }

    expression()
    {
        let left = this.assignment();
        while (this.takes(","))
            left = { text: `${left.text}, ${this.assignment().text}` };
        return left;
    }

    assignment()
    {
        const left = this.ternary();
        if (!assignments.has(this.peek()))
            return left;
        const how = this.next(), right = this.assignment();
        return { text: how === "/=" ? `${left.text} = divide(${left.text}, ${right.text})`
                                    : `${left.text} ${how} ${right.isTruth && how === "=" ? `int(${right.text})` : right.text}` };
    }

    ternary()
    {
        const test = this.binary(0);
        if (!this.takes("?"))
            return test;
        const yes = this.assignment();
        this.expect(":");
        const no = this.ternary();
        return { text: `(${this.truth(test)} ? ${yes.text} : ${no.text})` };
    }

    binary(level)
    {
        if (level === levels.length)
            return this.unary();
        let left = this.binary(level + 1);
        while (levels[level].includes(this.peek())) {
            const how = this.next(), right = this.binary(level + 1);
            if (how === "&&" || how === "||")
                left = { text: `(${this.truth(left)} ${how} ${this.truth(right)})`, isTruth: true };
            else if (how === "/")
                left = this.quotient(left, right);
            else
                left = { text: `(${left.text} ${how} ${right.text})`, isTruth: truths.has(how) };
        }
        return left;
    }

    // A quotient of constant floats is computed here, rounded once.
    quotient(left, right)
    {
        if (left.value !== undefined && right.value !== undefined && (left.isFloat || right.isFloat)) {
            const value = Math.fround(left.value / right.value);
            return { text: floatText(value), value, isFloat: true };
        }
        return { text: `divide(${left.text}, ${right.text})` };
    }

    unary()
    {
        const how = this.peek();
        if (["-", "+", "~", "!", "&", "*"].includes(how)) {
            this.at++;
            const of = this.unary();
            return how === "&" || how === "*" ? of
                   : how === "!" ? { text: `!${this.truth(of)}`, isTruth: true }
                                 : { text: `(${how}${of.text})` };
        }
        if (how === "++" || how === "--")
            return { text: this.next() + this.unary().text };
        if (how === "(" && this.isType(1))
            return this.cast();
        return this.postfix();
    }

    cast()
    {
        this.expect("(");
        const type = this.type();
        let isArray = this.stars() > 0;
        for (let depth = 0; depth || this.peek() !== ")"; this.at++) {     // of an array: (const real(*)[3])
            depth += this.peek() === "(" ? 1 : this.peek() === ")" ? -1 : 0;
            isArray = true;
        }
        this.expect(")");
        const of = this.unary();
        return isArray ? of : { text: `${type}(${of.text})`, value: of.value, isFloat: type === "float" };
    }

    postfix()
    {
        let e = this.primary();
        for (;;) {
            if (this.takes("[")) {
                e = { text: `${e.text}[${this.expression().text}]` };
                this.expect("]");
            } else if (this.takes(".") || this.takes("->"))
                e = { text: `${e.text}.${named(this.next())}` };
            else if (this.peek() === "++" || this.peek() === "--")
                e = { text: e.text + this.next() };
            else
                return e;
        }
    }

    primary()
    {
        const token = this.list[this.at++];
        if (token.isNumber) {
            const text = numberText(token.text), isFloat = /[.e]/.test(text) && !text.startsWith("0x");
            return { text, value: Number(text.replace(/u$/, "")), isFloat };
        }
        if (token.text === "(") {
            const inner = this.expression();
            this.expect(")");
            return { ...inner, text: `(${inner.text})` };
        }
        if (!token.isName || token.text === "sizeof")
            throw new BeyondSubset(`not expected: ${token.text}`);
        return this.takes("(") ? this.call(token.text) : { text: named(token.text) };
    }

    call(name)
    {
        const given = [];
        while (!this.takes(")")) {
            given.push(name === "memcpy" && given.length === 2 ? this.skipped() : this.assignment());
            this.takes(",");
        }
        if (name === "memcpy")
            return { text: `${given[0].text} = ${given[1].text}` };
        return { text: `${named(name)}(${given.map((e) => e.isTruth ? `int(${e.text})` : e.text).join(", ")})` };
    }

    skipped()
    {
        while (this.peek() !== ")")
            this.at++;
        return { text: "" };
    }

    // The value of an initialiser, of the type with sizes like [2][3].
    initial(type, sizes)
    {
        if (this.peek() !== "{") {
            const e = this.assignment();
            return ["int", "uint", "float"].includes(type) && !sizes ? `${type}(${e.text})` : e.text;
        }
        this.expect("{");
        const inner = sizes.replace(/^\[.*?\]/, ""), parts = [];
        while (!this.takes("}")) {
            parts.push(sizes ? this.initial(type, inner) : this.assignment().text);
            this.takes(",");
        }
        const count = Number(sizes.match(/^\[(\d+)\]/)?.[1]);
        while (sizes && parts.length < count)
            parts.push(parts[0]);          // only of zeros
        return `${type}${sizes}(${parts.join(", ")})`;
    }

    // A pointer in a struct is left out, except a float *, which is an index.
    declaration(isMember)
    {
        const type = this.type();
        let text = "";
        do {
            const isIndex = this.stars() > 0, name = named(this.next()), sizes = this.sizes();
            const own = isIndex ? "uint" : type, first = this.takes("=") ? ` = ${this.initial(own, sizes)}` : "";
            if (isIndex && type !== "float" && !isMember)
                throw new BeyondSubset(`a pointer ${name}`);
            text += isIndex && type !== "float" ? "" : `${own} ${name}${sizes}${first}; `;
        } while (this.takes(","));
        this.expect(";");
        return text;
    }

    statement(returned)
    {
        if (this.takes("{")) {
            let text = "{\n";
            while (!this.takes("}"))
                text += this.statement(returned);
            return `${text}}\n`;
        }
        if (this.takes("if")) {
            this.expect("(");
            const test = this.truth(this.expression());
            this.expect(")");
            const yes = this.statement(returned);
            return `if (${test})\n${yes}${this.takes("else") ? `else\n${this.statement(returned)}` : ""}`;
        }
        if (this.takes("for")) {
            this.expect("(");
            const first = this.isType() ? this.declaration() : this.peek() === ";" ? this.next() : this.simple();
            const test = this.truth(this.expression());
            this.expect(";");
            const step = this.expression().text;
            this.expect(")");
            return `for (${first.trim()} ${test}; ${step})\n${this.statement(returned)}`;
        }
        if (this.takes("return")) {
            if (this.takes(";"))
                return "return;\n";
            const e = this.expression();
            this.expect(";");
            return `return ${["int", "uint", "float"].includes(returned) ? `${returned}(${e.text})` : e.text};\n`;
        }
        return `${this.isType() ? this.declaration() : this.simple()}\n`;
    }

    simple()
    {
        const e = this.expression();
        this.expect(";");
        return `${e.text};`;
    }

    parameter()
    {
        const isConst = this.peek() === "const", type = this.type(), stars = this.stars(), name = named(this.next());
        const sizes = this.sizes();
        if (stars && this.isMemory)
            return `uint ${name}`;
        return `${stars || sizes ? isConst ? "in" : "inout" : "in"} ${type} ${name}${sizes}`;
    }

    // float *p is memory, but real *p is a reference: the difference lies in the word before the stars.
    parameters()
    {
        const all = [];
        this.expect("(");
        while (!this.takes(")")) {
            const word = this.list.slice(this.at).find((t) => t.text !== "const").text;
            this.isMemory = word === "float";
            all.push(this.parameter());
            this.takes(",");
        }
        return all.join(", ");
    }
}

// Splits C text into its declarations at the outermost level.
function declarations(list)
{
    const found = [];
    let first = 0, depth = 0;
    list.forEach((token, i) => {
        depth += "({[".includes(token.text) ? 1 : ")}]".includes(token.text) ? -1 : 0;
        const isFunction = token.text === "}" && list[first].text === "static" &&
                           list.slice(first, i).some((t) => t.text === "(") && list[i + 1]?.text !== ";";
        if (!depth && (token.text === ";" || isFunction)) {
            found.push(list.slice(first, i + 1));
            first = i + 1;
        }
    });
    return found;
}

function enumText(p)
{
    let text = "", last = -1;
    p.expect("enum");
    if (p.peek() !== "{")
        p.at++;
    p.expect("{");
    while (!p.takes("}")) {
        const name = p.next();
        const value = p.takes("=") ? p.ternary().text : String(++last);
        last = /^\d+$/.test(value) ? Number(value) : last;
        text += `const int ${name} = ${value};\n`;
        p.takes(",");
    }
    return text;
}

function structText(p)
{
    p.expect("typedef");
    p.expect("struct");
    const name = p.peek() === "{" ? "" : p.next();
    let text = "";
    p.expect("{");
    while (!p.takes("}"))
        text += p.declaration(true);
    const given = p.next();
    types.set(given, given);
    return `struct ${name || given} { ${text}};\n`;
}

function functionText(p)
{
    const type = p.type(), isIndex = p.stars() > 0, name = named(p.next());
    if (ofShader.has(name) || isIndex)
        return { text: "" };
    return { name, text: `${type} ${name}(${p.parameters()})\n${p.statement(type)}` };
}

function translated(list)
{
    const p = new Parser(list), first = list[0].text;
    try {
        if (first === "enum")
            return { text: enumText(p) };
        if (first === "typedef" && list[1].text === "struct")
            return { text: structText(p) };
        if (first === "static")
            return functionText(p);
        p.at = 1;
        const of = first === "typedef" && p.type();
        do
            types.set(p.next(), of);
        while (of && p.takes(","));
    } catch (error) {
        if (!(error instanceof BeyondSubset))
            throw error;
    }
    return { text: "" };
}

// Returns the parts of the headers in GLSL: {text}, and for a function its name.
export function stageFunctions(headers)
{
    const empty = mkdtempSync(join(tmpdir(), "stages-"));
    try {
        mkdirSync(join(empty, "fixsplat"));
        for (const name of ["stddef.h", "stdint.h", "string.h", "math.h", "fixsplat/fixsplat.h"])
            writeFileSync(join(empty, name), "");
        const text = execFileSync(process.env.CC ?? "cc",
                                  ["-E", "-P", "-nostdinc", "-xc", `-I${empty}`, "-I.", "-Isrc/include", "-"],
                                  { input: headers.map((header) => `#include "${header}"\n`).join(""),
                                    encoding: "utf8" });
        return declarations(tokens(text)).map(translated);
    } finally {
        rmSync(empty, { recursive: true });
    }
}

// Returns the text of the parts that a shader needs: all that are no functions, and the functions that it calls, or that
// these call.
export function needed(parts, shader)
{
    const kept = new Set();
    for (let texts = [shader]; texts.length;) {
        const words = new Set(texts.join("\n").match(/[A-Za-z_]\w*/g));
        const found = parts.filter((part) => part.name && words.has(part.name) && !kept.has(part));
        found.forEach((part) => kept.add(part));
        texts = found.map((part) => part.text);
    }
    return parts.filter((part) => !part.name || kept.has(part)).map((part) => part.text).join("");
}
