# Makes a file of a scene that moves.

# splatv FILE COUNT: a .splatv of Gaussians that cross the picture one after the other, each seen for a part of a second.
splatv() {
    bytes=$(awk -v count="$2" '
        function put(word, size) { for (; size > 0; size--) { printf "\\%03o", word % 256; word = int(word / 256) } }
        function number(x, bits, bias,    sign, e, m) {
            if (x == 0) return 0
            sign = x < 0; x = sign ? -x : x
            e = 0
            while (x >= 2) { x /= 2; e++ }
            while (x < 1) { x *= 2; e-- }
            m = int((x - 1) * 2 ^ bits + 0.5)
            return (sign * 2 * (bias + 1) + e + bias) * 2 ^ bits + m
        }
        function half(x) { put(number(x, 10, 15), 2) }
        function single(x) { put(number(x, 23, 127), 4) }
        BEGIN {
            json = "[{\"type\": \"splat\", \"size\": " 64 * count "}]"
            put(26443, 4); put(length(json), 4)
            printf "%s", json
            for (i = 0; i < count; i++) {
                part = i / count
                single(i % 8 / 4 - 0.875); single(int(i / 8) % 8 / 4 - 0.875); single(part)
                half(1); half(0); half(0); half(0)
                half(0.1); half(0.05); half(0.1); half(0)
                put(55 + 3 * (i % 67), 1); put(100, 1); put(250 - 3 * (i % 67), 1); put(230, 1)
                half(1); half(0); half(0); for (k = 3; k < 10; k++) half(0)
                half(0); half(0); half(0); half(1)
                half(part); half(0.125)
            }
        }')
    printf "$bytes" >"$1"
}
