
# make_photographs COUNT: renders a procedural scene, a knot, from COUNT views around it. The pictures of 64x48 pixels
# and the cameras form a COLMAP folder `set`.
make_photographs() {
    "$fixsplat" make-scene knot --count 3000 -o knot.ply || exit 1
    mkdir -p set/sparse/0 set/images
    awk -v n="$1" 'BEGIN {
        folder = "set/sparse/0/"
        print "1 PINHOLE 64 48 60 60 32 24" >(folder "cameras.txt")
        for (i = 0; i < n; i++)
            printf "%d %.9f 0 %.9f 0 0 0 13 1 %02d.png\n\n", i + 1, cos(i * 3.14159265 / n), sin(i * 3.14159265 / n), i \
                >(folder "images.txt")
        for (i = 0; i < 400; i++) {
            for (k = 0; k < 3; k++) {
                state = (state * 16807 + 11) % 2147483647
                at[k] = (state / 1073741823.5 - 1) * (k == 1 ? 2.6 : 4.5)
            }
            print i, at[0], at[1], at[2], 120, 120, 120, 0 >(folder "points3D.txt")
        }
    }'
    "$fixsplat" render knot.ply --cameras set/sparse/0 --view all -o set/images/%02d.png || exit 1
}
