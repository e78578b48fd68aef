# Draws `count` small changes of the C files named, by `seed`, the same ones every time. Prints for each a line:
# file, number of the line, its text as it is, and as it becomes, between tabs. A line of tools/ is drawn a quarter as
# often as another, and of the kinds of change that a line allows each as often as another.

# A line with blanks for its comments, strings and characters.
function code_of(line,    out, start, length_) {
    while (line != "") {
        if (inside) {
            start = index(line, "*/")
            length_ = start ? start + 1 : length(line)
            inside = !start
        } else if (match(line, /\/\*|\/\/.*|"([^"\\]|\\.)*"|'([^'\\]|\\.)*'/)) {
            out = out substr(line, 1, RSTART - 1)
            length_ = RLENGTH
            inside = substr(line, RSTART, 2) == "/*"
            line = substr(line, RSTART)
        } else {
            return out line
        }
        out = out sprintf("%*s", length_, "")
        line = substr(line, length_ + 1)
    }
    return out
}

# Another way for a line: `by` in the place of `size` characters at `at`.
function way(kind, at, size, by) {
    if (!(kind in ways))
        kinds[++kind_count] = kind
    changed[kind, ++ways[kind]] = substr(text, 1, at - 1) by substr(text, at + size)
}

function swap(kind, code, from, to,    at, i) {
    for (at = 1; (i = index(substr(code, at), from)) > 0; at += i)
        way(kind, at + i - 1, length(from), to)
}

function both(kind, code, a, b) {
    swap(kind, code, a, b)
    swap(kind, code, b, a)
}

# Where the bracket that opens at `at` closes; 0: on another line.
function closes(code, at,    depth) {
    for (; at <= length(code); at++) {
        depth += (substr(code, at, 1) == "(") - (substr(code, at, 1) == ")")
        if (!depth)
            return at
    }
    return 0
}

# Every way to change the text, whose code is given, and whether a statement starts in it.
function find_ways(code, starts,    at, end, number) {
    kind_count = 0
    split("", ways)
    both("relation", code, " < ", " <= ")
    both("relation", code, " > ", " >= ")
    both("equality", code, " == ", " != ")
    both("sum", code, " + ", " - ")
    both("sum", code, " += ", " -= ")
    both("logic", code, " && ", " || ")
    both("bits", code, " & ", " | ")
    for (at = 1; match(substr(code, at), /[^A-Za-z0-9_.][0-9]+[^A-Za-z0-9_.]/); at += RSTART + RLENGTH - 2) {
        number = substr(code, at + RSTART, RLENGTH - 2)
        if (number ~ /^0./ || number > 2147483646)
            continue
        way("constant", at + RSTART, RLENGTH - 2, number + 1)
        if (number > 0)
            way("constant", at + RSTART, RLENGTH - 2, number - 1)
    }
    at = match(code, /(^| )if \(/) ? RSTART + RLENGTH - 1 : 0
    end = at ? closes(code, at) : 0
    if (end)
        way("condition", at, end - at + 1, "(!" substr(text, at, end - at + 1) ")")
    at = match(code, /[^ ]/)
    if (starts && code ~ /^ +([^ ]+ ([-+*\/|&^]|<<|>>)?= |[a-z_0-9]+\(|[^ ]+(\+\+|--);)/ && code ~ /;$/ &&
        code !~ /^ +(return|if|for|while|else|do)[ (]/)
        way("statement", at, length(code) - at + 1, ";")
    if (match(code, /return [^;]+;/) && substr(code, RSTART, RLENGTH) != "return 0;")
        way("return", RSTART, RLENGTH, "return 0;")
}

# 0 to 1: the generator of Park and Miller, of 1988.
function random() {
    state = state * 16807 % 2147483647
    return state / 2147483647
}

FNR == 1 { inside = 0; starts = 1 }
{
    sub(/\r$/, "")
    text = $0
    code = code_of(text)
    if (code ~ /^#/ || code !~ /[^ ]/)
        next
    sub(/ +$/, "", code)
    find_ways(code, starts)
    if (kind_count) {
        total += FILENAME ~ /^tools\// ? 1 : 4
        lines++
        until[lines] = total
        place[lines] = FILENAME "\t" FNR
        texts[lines] = text
        codes[lines] = code
        is_start[lines] = starts
    }
    starts = code ~ /[;{})]$|^ *else$/
}
END {
    state = seed % 2147483646 + 1
    for (i = 0; i < 10; i++)
        random()
    for (tries = 0; drawn < count && tries < 20 * count; tries++) {
        want = random() * total
        low = 1
        for (high = lines; low < high;) {
            middle = int((low + high) / 2)
            if (until[middle] < want) low = middle + 1; else high = middle
        }
        text = texts[low]
        find_ways(codes[low], is_start[low])
        kind = kinds[int(random() * kind_count) + 1]
        new = changed[kind, int(random() * ways[kind]) + 1]
        if ((low, new) in seen)
            continue
        seen[low, new] = 1
        drawn++
        print place[low] "\t" text "\t" new
    }
}
