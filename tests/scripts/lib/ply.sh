# Sourced by tests that make scenes by awk.

# ply FILE: writes a .ply of the Gaussians on standard input, a line of 14 numbers for each: position, colour, opacity,
# scales, rotation.
ply() {
    awk '
        { line[n++] = $0 }
        END {
            print "ply\nformat ascii 1.0\nelement vertex " n
            split("x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3", names)
            for (i = 1; i <= 14; i++) print "property float " names[i]
            print "end_header"
            for (i = 0; i < n; i++) print line[i]
        }' >"$1"
}
