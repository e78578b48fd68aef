# Sourced by tests of walls. Makes a scene to walk in.
. "${root:-.}/tests/scripts/lib/ply.sh"

# room FILE [LINE [HALF]]: a .ply of two rooms with a door between them, x -3 to 3, z -2 to 2, the floor at y = 0 and the
# ceiling at -2.5. LINE is one more Gaussian. HALF is half the width of the door, 0.5 by default.
room() {
    awk -v more="$2" -v half="${3:-0.5}" '
        function plane(axis, at, u0, u1, v0, v1, door,    u, v) {
            for (u = u0; u < u1 + 0.01; u += 0.1)
                for (v = v0; v < v1 + 0.01; v += 0.1) {
                    if (door && u > -2.1 && v > -half && v < half) continue
                    p = axis == 0 ? at " " u " " v : axis == 1 ? u " " at " " v : u " " v " " at
                    s = axis == 0 ? "-4.4 -2.8 -2.8" : axis == 1 ? "-2.8 -4.4 -2.8" : "-2.8 -2.8 -4.4"
                    print p " 0.1 0.2 0.3 2.2 " s " 1 0 0 0"
                }
        }
        BEGIN {
            plane(1, 0, -3, 3, -2, 2); plane(1, -2.5, -3, 3, -2, 2); plane(0, -3, -2.5, 0, -2, 2)
            plane(0, 3, -2.5, 0, -2, 2); plane(2, -2, -3, 3, -2.5, 0); plane(2, 2, -3, 3, -2.5, 0)
            plane(0, 0, -2.5, 0, -2, 2, 1)
            if (more) print more
        }' | ply "$1"
}
