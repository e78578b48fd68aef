# awk -v plot=NAME -f tools/scripts/plot.awk docs/measured.md: draws a table of measurements as SVG. Plots: sizes (bytes
# per Gaussian against PSNR), growth (frame time against Gaussians), levels (frame time against PSNR), budgets and times
# (PSNR and frame time against the budget of Gaussians). The plot pace has a panel for each device that test_pace prints.
BEGIN {
    FS = " *[|] *"
    if (plot == "sizes") {
        part = "sizes"; columns = "scene form bytes a Gaussian"
        title = "What each profile keeps: a mark is a scene"
        label_x = "bytes a Gaussian"; label_y = "PSNR, dB, mean of four views"
        split("default|compact|small|.spz 4", names, "|")
    } else if (plot == "growth") {
        part = "tables"; columns = "Gaussians project"
        title = "Time of a frame, landscape at 1280x720"
        label_x = "Gaussians"; label_y = "milliseconds"
        log_x = log_y = with_lines = 1
    } else if (plot == "budgets" || plot == "times") {
        part = "budgets"; columns = "scene budget of all"
        title = plot == "times" ? "Time of a frame with a budget, one thread" : "Pictures with a budget, beside all Gaussians"
        label_x = "budget, Gaussians"; label_y = plot == "times" ? "milliseconds" : "PSNR, dB, mean of the views"
        log_x = with_lines = 1; log_y = plot == "times"
    } else if (plot == "levels") {
        part = "levels"; columns = "scene left Gaussians"
        title = "What convert --decimate saves and costs: a mark is what is left of a scene"
        label_x = "milliseconds a frame, 1280x720"; label_y = "PSNR, dB, against the whole, mean of 8 views"
        with_lines = 1
    } else if (plot == "pace") {
        FS = " "
        title = "What fxs_pace chooses on simulated devices, 72 frames a second"
        label_x = "seconds"; label_y = "percent of all Gaussians and of 1/72 s, at most 125"
        steps["x"] = 60; steps["y"] = 25
        split("budget|longest frame", names, "|")
    } else
        stop("no plot " plot ": expected sizes, growth, levels, budgets, times or pace")
}

function stop(why) {
    print "plot.awk: " why >"/dev/stderr"
    failed = 1
    exit 1
}

function add(name, x, y,    s) {
    for (s = 1; s in names && names[s] != name; s++) ;
    names[s] = name
    points++
    series[points] = s
    at_x[points] = scaled(x, log_x)
    at_y[points] = scaled(y, log_y)
}

function scaled(v, is_log) {
    if (is_log && !(v > 0))
        stop("no logarithm of " v)
    return is_log ? log(v) / log(10) : v
}

$0 ~ "^<!-- " part ": begin" { inside = 1 }
$0 ~ "^<!-- " part ": end" { inside = in_table = 0 }
inside && /^Measured / && measured == "" { measured = $0; sub(/;.*/, "", measured); sub(/[.,]*$/, "", measured) }
inside && /^landscape, 1280x720/ { setting = $0; sub(/.*: */, "", setting); split(setting, names_of, /; then |\./) }
!/^\|/ { in_table = 0 }
inside && /^\|/ && index($2 " " $3 " " $4, columns) == 1 { in_table = 1; next }
in_table && /^\|---/ { next }
in_table && plot == "sizes" && $4 != "" { add($3, $4 + 0, $5 + 0) }
in_table && plot == "levels" && $6 == "equal" { whole = $2 sprintf(", all: %.1f ms", $7) }
in_table && plot == "levels" && $6 != "equal" { add(whole, $7 + 0, $6 + 0); notes[points] = $3 }
in_table && plot == "budgets" && $7 != "equal" { add($2, $3 + 0, $7 + 0) }
in_table && plot == "times" { add($2, $3 + 0, $9 + 0) }
plot == "pace" && $1 != device { device = $1; first_of[++panels] = points + 1 }
plot == "pace" {
    add(names[1], $2 / 72, $4)
    add(names[2], $2 / 72, $5 < 125 ? $5 : 125)
    last_of[panels] = points
    captions[panels] = $1 ": " $3 " of " $2 " frames late"
}
in_table && plot == "growth" && $2 ~ /^[0-9]+(, C)?$/ { add(names_of[$2 ~ /C$/ ? 1 : 2], $2 + 0, $(NF - 1) + 0) }

function text(x, y, class, anchor, words) {
    gsub(/&/, "\\&amp;", words)
    gsub(/</, "\\&lt;", words)
    printf "<text x=\"%.1f\" y=\"%.1f\" class=\"%s\" text-anchor=\"%s\">%s</text>\n", x, y, class, anchor, words
}

function line(x1, y1, x2, y2, class) {
    printf "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" class=\"%s\"/>\n", x1, y1, x2, y2, class
}

function px(x) { return left + (x - low_x) / (high_x - low_x) * (right - left) }
function py(y) { return bottom - (y - low_y) / (high_y - low_y) * (bottom - top) }

function mark(x, y, s,    shape) {
    shape = s % 6
    if (shape == 1)
        printf "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"5.5\" class=\"s%d\"/>\n", x, y, s
    else
        printf "<path d=\"M%.1f %.1f%s\" class=\"s%d\"/>\n", x, y, shape == 2 ? "m-4-4h8v8h-8z" \
            : shape == 3 ? "m0-5.5l5 9h-10z" : shape == 4 ? "m0-5.8l5.2 5.8-5.2 5.8-5.2-5.8z" \
            : shape == 5 ? "m0 5.5l5-9h-10z" : "m-1.5-5h3v3.5h3.5v3h-3.5v3.5h-3v-3.5h-3.5v-3h3.5z", s
}

function floor_of(v) { return v < int(v) ? int(v) - 1 : int(v) }

# Rounds the ends of an axis to its step. A linear axis starts at 0 if the values come near 0.
function ends(values, axis, is_log,    i, low, high, step) {
    low = high = values[1]
    for (i = 2; i <= points; i++) {
        if (values[i] < low) low = values[i]
        if (values[i] > high) high = values[i]
    }
    step = axis in steps ? steps[axis] : is_log ? 1 : high - low > 12 ? 10 : 2
    if (!is_log && low < high / 3)
        low = 0
    steps[axis] = step
    lows[axis] = floor_of(low / step) * step
    highs[axis] = -floor_of(-high / step) * step
    if (highs[axis] == lows[axis])
        highs[axis] += step
}

function tick(v, is_log,    n, out) {
    if (!is_log)
        return v
    for (n = sprintf("%d", 10 ^ v + 0.5); length(n) > 3; n = substr(n, 1, length(n) - 3))
        out = "," substr(n, length(n) - 2) out
    return n out
}

function style() {
    print "<style>"
    print "text { font: 13px system-ui, sans-serif; fill: #666 } .title { font-size: 16px; font-weight: 600 }"
    print ".small { font-size: 11px } .grid { stroke: #808080; stroke-opacity: 0.3 } .axis { stroke: #808080 }"
    print ".path { fill: none; stroke-width: 2 }"
    print ".s1 { fill: #2a78d6 } .s2 { fill: #d9541e } .s3 { fill: #128a5f } .s4 { fill: #7a4fc9 } .s5 { fill: #b8860b } .s6 { fill: #c23b80 }"
    print ".l1 { stroke: #2a78d6 } .l2 { stroke: #d9541e } .l3 { stroke: #128a5f } .l4 { stroke: #7a4fc9 } .l5 { stroke: #b8860b } .l6 { stroke: #c23b80 }"
    print "@media (prefers-color-scheme: dark) {"
    print "text { fill: #d0d0d0 }"
    print ".s1 { fill: #5aa0f0 } .s2 { fill: #f07848 } .s3 { fill: #35c08c } .s4 { fill: #a98cf0 } .s5 { fill: #e0b040 } .s6 { fill: #f07ab8 }"
    print ".l1 { stroke: #5aa0f0 } .l2 { stroke: #f07848 } .l3 { stroke: #35c08c } .l4 { stroke: #a98cf0 } .l5 { stroke: #e0b040 } .l6 { stroke: #f07ab8 } }"
    print "</style>"
}

function grid(    v) {
    for (v = low_x; v <= high_x; v += steps["x"]) {
        line(px(v), top, px(v), bottom, "grid")
        text(px(v), bottom + 18, "tick", "middle", tick(v, log_x))
    }
    for (v = low_y; v <= high_y; v += steps["y"]) {
        line(left, py(v), right, py(v), "grid")
        text(left - 8, py(v) + 4, "tick", "end", tick(v, log_y))
    }
    line(left, bottom, right, bottom, "axis")
    line(left, top, left, bottom, "axis")
}

function panel(p,    s) {
    top = 84 + 120 * (p - 1); bottom = top + 76
    text(left, top - 8, "label", "start", captions[p])
    grid()
    for (s = 1; s in names; s++)
        path_of(s, first_of[p], last_of[p])
}

function path_of(s, first, last,    i, d) {
    for (i = first; i <= last; i++)
        if (series[i] == s)
            d = d sprintf("%s%.1f %.1f", d == "" ? "M" : "L", px(at_x[i]), py(at_y[i]))
    printf "<path d=\"%s\" class=\"path l%d\"/>\n", d, s
}

END {
    if (failed)
        exit 1
    if (!points)
        stop("no table for " plot)
    left = 70; right = 700; top = 70; bottom = 400
    ends(at_x, "x", log_x)
    ends(at_y, "y", log_y)
    low_x = lows["x"]; high_x = highs["x"]; low_y = lows["y"]; high_y = highs["y"]
    print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 900 470\" width=\"900\" height=\"470\" role=\"img\">"
    print "<title>" title "</title>"
    style()
    text(left - 44, 28, "title", "start", title)
    for (p = 1; p <= panels; p++)
        panel(p)
    top = 70; bottom = 400
    if (!panels)
        grid()
    text((left + right) / 2, bottom + 38, "label", "middle", label_x)
    text(left - 44, 52, "label", "start", label_y)
    for (s = 1; s in names; s++) {
        if (with_lines)
            path_of(s, 1, points)
        mark(right + 24, top + 24 * s - 14, s)
        text(right + 36, top + 24 * s - 9, "legend", "start", names[s])
    }
    for (i = 1; i <= points && !panels; i++) {
        mark(px(at_x[i]), py(at_y[i]), series[i])
        if (i in notes)
            text(px(at_x[i]) + 9, py(at_y[i]) + 14, "small", "start", notes[i])
    }
    text(left - 44, bottom + 60, "small", "start", measured)
    print "</svg>"
}
