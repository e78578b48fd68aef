# Prints C code without comments, strings and character constants, each line as file:line:rest.
FNR == 1 { inside = 0 }
{
    rest = $0
    out = ""
    while (rest != "") {
        if (inside) {
            end = index(rest, "*/")
            inside = !end
            rest = end ? substr(rest, end + 2) : ""
        } else if (match(rest, /\/\*|\/\/|"([^"\\]|\\.)*"|'([^'\\]|\\.)*'/)) {
            start = substr(rest, RSTART, 2)
            out = out substr(rest, 1, RSTART - 1) " "
            inside = start == "/*"
            rest = start == "//" ? "" : substr(rest, RSTART + (inside ? 2 : RLENGTH))
        } else {
            out = out rest
            rest = ""
        }
    }
    print FILENAME ":" FNR ":" out
}
