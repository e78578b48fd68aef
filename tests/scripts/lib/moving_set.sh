
# Makes ground.ply, ball.ply and crate.ply: a patterned square, a patterned ball and a patterned cube of small discs,
# each about the origin. The ground is 4.8 units wide, the others 2.
make_moving_scenes() {
    awk 'function put(file, x, y, z, w, i, j, k, flat, wide, red, green, blue) {
        printf "%.5f %.5f %.5f %.4f %.4f %.4f 4 %.5f %.5f %.5f %.5f %.5f %.5f %.5f\n", x, y, z, (red - 0.5) / 0.28209,
            (green - 0.5) / 0.28209, (blue - 0.5) / 0.28209, log(wide), log(wide), log(flat), w, i, j, k >>file
    }
    function head(file, count) {
        printf "ply\nformat ascii 1.0\nelement vertex %d\n", count >file
        n = split("x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3", names, " ")
        for (p = 1; p <= n; p++)
            printf "property float %s\n", names[p] >>file
        print "end_header" >>file
    }
    # Turns of the disc, whose normal is z, to the normals x, y and z.
    function face(file, side, u, v, depth, wide, red, green, blue) {
        h = 0.70710678
        if (side == 0) put(file, depth, u, v, h, 0, h, 0, 0.004, wide, red, green, blue)
        if (side == 1) put(file, u, depth, v, h, h, 0, 0, 0.004, wide, red, green, blue)
        if (side == 2) put(file, u, v, depth, 1, 0, 0, 0, 0.004, wide, red, green, blue)
    }
    function noise() {
        state = (state * 16807 + 11) % 2147483647
        return state / 2147483647
    }
    BEGIN {
        head("ground.ply", 80 * 80)
        for (i = 0; i < 80; i++)
            for (j = 0; j < 80; j++) {
                c = 0.35 + 0.2 * ((int(i / 8) + int(j / 8)) % 2) + 0.15 * noise()
                face("ground.ply", 2, i * 0.06 - 2.37, j * 0.06 - 2.37, 0, 0.036, c, c * (0.8 + 0.2 * sin(i / 6)),
                     c * (0.7 + 0.2 * cos(j / 9)))
            }
        head("ball.ply", 1600)
        for (i = 0; i < 1600; i++) {
            z = 1 - (2 * i + 1) / 1600
            r = sqrt(1 - z * z); a = i * 2.39996323
            x = r * cos(a); y = r * sin(a)
            length3 = sqrt(2 + 2 * z)
            stripe = sin(6 * a) * sin(9 * z) > 0
            put("ball.ply", x, y, z, length3 / 2, -y / length3, x / length3, 0, 0.01, 0.045, 0.85, 0.15 + 0.6 * stripe,
                0.1 + 0.15 * noise())
        }
        head("crate.ply", 6 * 400)
        for (side = 0; side < 6; side++)
            for (i = 0; i < 20; i++)
                for (j = 0; j < 20; j++) {
                    edge = i < 2 || j < 2 || i > 17 || j > 17
                    face("crate.ply", side % 3, i * 0.1 - 0.95, j * 0.1 - 0.95, side < 3 ? 1 : -1, 0.06,
                         0.1 + 0.1 * side * !edge, 0.3 + 0.4 * edge, 0.75 - 0.3 * edge + 0.1 * noise())
                }
    }'
}

# make_moving_set FOLDER CAMERAS MOMENTS SIZE: a set of photographs of the ground, over which the ball rolls along an
# arc and the crate slides and turns, at MOMENTS times, 1/23 apart. It makes FOLDER/transforms.json with times,
# points.ply with every fourth centre of the first moment, and the pictures, rendered by `fixsplat render`.
make_moving_set() {
    mkdir -p "$1"
    awk -v folder="$1" -v cameras="$2" -v moments="$3" -v size="$4" 'BEGIN {
        out = folder "/transforms.json"
        printf "{\"w\": %d, \"h\": %d, \"fl_x\": %.3f, \"fl_y\": %.3f, ", size, size, size * 0.85, size * 0.85 >out
        printf "\"ply_file_path\": \"points.ply\", \"frames\": [" >out
        for (t = 0; t < moments; t++)
            for (c = 0; c < cameras; c++) {
                a = c * 2.39996323; high = 1.6 + 2.2 * ((c * 7) % cameras) / cameras; wide = sqrt(25 - high * high)
                x = wide * cos(a); y = wide * sin(a); n = sqrt(x * x + y * y)
                # The axes of the camera: right, up, back.
                bx = x / 5; by = y / 5; bz = high / 5
                rx = -y / n; ry = x / n
                ux = by * 0 - bz * ry; uy = bz * rx - bx * 0; uz = bx * ry - by * rx
                printf "%s\n{\"file_path\": \"t%03d/c%02d.png\", \"time\": %.6f, \"transform_matrix\": " \
                    "[[%.9f, %.9f, %.9f, %.9f], [%.9f, %.9f, %.9f, %.9f], [0, %.9f, %.9f, %.9f], [0, 0, 0, 1]]}",
                    t + c ? "," : "", t, c, t / 23, rx, ux, bx, x, ry, uy, by, y, uz, bz, high >out
            }
        print "\n]}" >out
    }'
    moment=0
    while [ "$moment" -lt "$3" ]; do
        set -- "$1" "$2" "$3" "$4" $(awk -v t="$moment" 'BEGIN {
            t /= 23
            a = 1.4 * t
            printf "%.6f,%.6f,%.6f,%.7f,0,%.7f,0,0.55 ", 1.3 * cos(a), 1.3 * sin(a) - 0.3, 0.62, cos(a), sin(a)
            printf "%.6f,%.6f,%.6f,%.7f,0,0,%.7f,0.4", -1.1 + 0.6 * t, 1.0 - 1.3 * t, 0.45, cos(0.4 * t), sin(0.4 * t)
        }')
        folder=$(printf "%s/t%03d" "$1" "$moment")
        mkdir -p "$folder"
        "$fixsplat" render ground.ply ball.ply crate.ply --place "ball.ply:$5" --place "crate.ply:$6" \
            --cameras "$1/transforms.json" --view "$((moment * $2))..$((moment * $2 + $2 - 1))" --size "$4x$4" \
            -o "$folder/raw%04d.png" || exit 1
        number=0
        for picture in "$folder"/raw*.png; do
            mv "$picture" "$folder/$(printf "c%02d.png" "$number")"
            number=$((number + 1))
        done
        [ "$moment" != 0 ] || points_of_moment "$1/points.ply" "$5" "$6"
        moment=$((moment + 1))
    done
}

# points_of_moment OUT BALL CRATE: every fourth centre, placed by X,Y,Z,W,I,J,K,SCALE.
points_of_moment() {
    { awk '/^end_header/ { on = 1; next } on && ++n % 4 == 0 { print "0,0,0,1,0,0,0,1 " $0 }' ground.ply
      awk -v p="$2" '/^end_header/ { on = 1; next } on && ++n % 4 == 0 { print p, $0 }' ball.ply
      awk -v p="$3" '/^end_header/ { on = 1; next } on && ++n % 4 == 0 { print p, $0 }' crate.ply
    } | awk '{
        split($1, p, ",")
        w = p[4]; i = p[5]; j = p[6]; k = p[7]; x = $2; y = $3; z = $4
        tx = 2 * (j * z - k * y); ty = 2 * (k * x - i * z); tz = 2 * (i * y - j * x)
        lines[NR] = sprintf("%.4f %.4f %.4f %d %d %d", p[1] + p[8] * (x + w * tx + j * tz - k * ty),
            p[2] + p[8] * (y + w * ty + k * tx - i * tz), p[3] + p[8] * (z + w * tz + i * ty - j * tx),
            255 * ($5 * 0.28209 + 0.5), 255 * ($6 * 0.28209 + 0.5), 255 * ($7 * 0.28209 + 0.5))
    }
    END {
        printf "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n", NR
        print "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header"
        for (n = 1; n <= NR; n++)
            print lines[n]
    }' >"$1"
}
