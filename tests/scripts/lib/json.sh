
# keys FILE KEY...: checks that the file is one JSON object that has these keys. KEY a.b means key b in object a.
keys() {
    file=$1
    shift
    if have python3; then
        python3 -c '
import json, sys
def refuse(name): raise ValueError(name)
for path in sys.argv[2:]:
    value = json.load(open(sys.argv[1]), parse_constant=refuse)
    for key in path.split("."): value = value[key]' "$file" "$@" 2>&1 | tail -n 1 | grep . && return 1
        return 0
    fi
    for key in "$@"; do
        grep -q "\"${key##*.}\":" "$file" || { echo "no $key"; return 1; }
    done
}
