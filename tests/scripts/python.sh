#!/bin/sh
# Tests the Python package: results, finding the library, and installation. tests/python has the checks.
. tests/scripts/lib/check.sh
B=${B:-build}
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/photos.sh"
. "$root/tests/scripts/lib/splatv.sh"
library=$(cd "$root" && cd "$(dirname "$fixsplat")" && pwd)
version=$(sed -n 's/^#define FXS_VERSION "\(.*\)"/\1/p' "$root/src/include/fixsplat/fixsplat.h")
soname=libfixsplat.so.${version%%.*}

python=
for name in python3 /usr/bin/python3; do
    [ "$python" ] || ! "$name" -c 'import cffi, numpy' 2>/dev/null || python=$name
done
[ "$python" ] ||
    { skip "the Python package" "no python3 with numpy and cffi here (python3-numpy, python3-cffi)"; finish; exit; }
[ -e "$library/libfixsplat.so.$version" ] ||
    { skip "the Python package" "no shared library is built with this compiler"; finish; exit; }
PYTHONPATH=$root/port/python PYTHONDONTWRITEBYTECODE=1 FIXSPLAT_LIBRARY=$library/libfixsplat.so.$version
export PYTHONPATH PYTHONDONTWRITEBYTECODE FIXSPLAT_LIBRARY

# ---- Declarations ----------------------------------------------------------------------------------------------------

check "the version is the library's" equal "$("$python" -c 'import fixsplat; print(fixsplat.__version__)')" "$version"
# without vulkan.h, as make/build.mk has them
(cd "$root" && sh tools/scripts/declarations.sh $(ls src/include/fixsplat/*.h | grep -v /vulkan.h) \
    src/include/fixsplat/internal/*.h) \
    >headers.txt
"$python" -c 'from fixsplat._library import lib, string; print(string(lib.fxs_declarations()), end="")' >declared.txt
check "the library's declarations are those of the headers" cmp headers.txt declared.txt
cat >undeclared.py <<'END'
import re, sys
from fixsplat._library import ffi, lib
types = {name for names in ffi.list_types() for name in names}
used = set(re.findall(r'(?:\blib\.|")(fxs_\w+|FXS_\w+)', sys.stdin.read()))
print(len(used) > 80, *(name for name in used if name not in types and not hasattr(lib, name)))
END
check "all that the package uses is declared, and there" equal \
    "$(cat "$root"/port/python/fixsplat/*.py | "$python" undeclared.py)" True
if have mypy; then
    check "types: mypy --strict" sh -c "cd '$root/port/python' && mypy --strict --cache-dir '$work/mypy' fixsplat"
else
    skip "types: mypy --strict" "no mypy here"
fi

# ---- Behaviour -------------------------------------------------------------------------------------------------------

make_photographs 9
splatv moving.splatv 256
"$fixsplat" convert moving.splatv moving.fxs
"$fixsplat" make-scene cubes -o cubes.ply
"$fixsplat" make-scene haze --count 3000 -o haze.ply
"$fixsplat" make-scene knot --count 200000 -o large.ply
"$fixsplat" convert knot.ply knot.fxs
"$fixsplat" convert knot.ply start.fxs --start-view 1,-2,-7,0.1,0.2,0,40
cp knot.fxs changed.fxs
"$fixsplat" convert knot.ply knot.splat 2>logs/err
"$fixsplat" convert knot.ply knot.spz 2>logs/err
given=
if [ -e "$scenes/train-1000/train-1000.ply" ]; then
    given=$scenes/train-1000
else
    skip "a captured scene" "no train-1000 in FXS_SCENES"
fi
for part in arrays check; do
    "$python" "$root/tests/python/$part.py" "$fixsplat" "$work" ${given:+"$given"} >logs/checks 2>logs/err
    grep -v '^end$' logs/checks
    passed=$((passed + $(grep -c '^ok ' logs/checks))) failed=$((failed + $(grep -c '^FAIL ' logs/checks)))
    skipped=$((skipped + $(grep -c '^skip ' logs/checks)))
    check "$part.py: all checks were made" equal "$(tail -n 1 logs/checks)" end
    check "$part.py: not a word on stderr" equal "$(cat logs/err)" ""
done

mkdir example
cp knot.ply example/scene.ply
cp -r set example/garden
sed -n '/^```python$/,/^```$/p' "$root/docs/python.md" | sed '/^```/d' >example/example.py
check "docs/python.md: the example runs" sh -c 'cd example && "$0" example.py >said' "$python"
check "docs/python.md: as it says" grep -qx '(360, 640, 4) uint8' example/said
"$fixsplat" fit set --quiet --steps 50 -o fifty.fxs >logs/out
check "docs/python.md: the command's file" cmp fifty.fxs example/garden.fxs

example=$root/docs/examples/measure.py
mkdir -p model/point_cloud/iteration_7000 model/point_cloud/iteration_30000
cp knot.ply model/point_cloud/iteration_7000/point_cloud.ply
cp haze.ply model/point_cloud/iteration_30000/point_cloud.ply
"$fixsplat" fit set --quiet --steps 1 --hold-out 0 -o one.fxs --write-cameras model/cameras.json >logs/out
"$python" "$example" model set/images --hold-out 4 >inria.txt 2>logs/err
check "measure.py: without torch a line" equal "$(cat logs/err)" \
    "no LPIPS: it needs torch and lpips (pip install torch lpips)"
figures() { sed -n '1d; s/^\([a-z0-9]*\)[.png]* *\([0-9.]*\) \([0-9.]*\) .*/\1 \2 \3/p' "$1"; }
"$fixsplat" fit set --measure haze.ply --hold-out 4 --json --quiet |
    "$python" -c 'import json, sys
found = json.load(sys.stdin)["photographs"]
for m in found["views"] + [dict(found, name="mean.png")]:
    print(m["name"][:-4], "%.4f %.6f" % (m["psnr"], m["ssim"]))' >command.txt
check "measure.py: the last iteration, with the command's figures" equal "$(figures inria.txt)" "$(cat command.txt)"
"$python" "$example" haze.ply set --hold-out 4 >ply.txt 2>logs/err
check "measure.py: of a .ply and a COLMAP folder" cmp ply.txt inria.txt
: >none.pt
"$python" "$example" none.pt set 2>logs/err
check "measure.py: a checkpoint without torch" equal "$? $(cat logs/err)" \
    "1 none.pt: a checkpoint of gsplat needs torch: pip install torch, or export a .ply"
mkdir modules
cat >modules/torch.py <<'END'             # the few functions of torch that reading a checkpoint needs
import numpy
class Tensor:
    def __init__(self, array): self.array = array
    def detach(self): return self
    def numpy(self): return self.array
def load(path, **_): return {"splats": {name: Tensor(array) for name, array in numpy.load(path).items()}}
def cat(tensors, axis): return Tensor(numpy.concatenate([t.array for t in tensors], axis))
END
"$python" -c 'import fixsplat, numpy
g = fixsplat.load_gaussians("haze.ply")
with open("haze.pt", "wb") as file:
    numpy.savez(file, means=g.positions, scales=g.scales, quats=g.rotations, opacities=g.opacities, sh0=g.sh[:, :1],
                shN=g.sh[:, 1:])'
PYTHONPATH=$PYTHONPATH:$work/modules "$python" "$example" haze.pt set --hold-out 4 >gsplat.txt 2>logs/err
check "measure.py: a checkpoint of gsplat" cmp gsplat.txt inria.txt
"$python" "$example" set set 2>logs/err
check "measure.py: no folder of Inria's" equal "$? $(cat logs/err)" \
    "1 set: expected point_cloud/iteration_N/point_cloud.ply and cameras.json"

# ---- Finding the library ---------------------------------------------------------------------------------------------

imports() {
    said=$(unset FIXSPLAT_LIBRARY; cd / && "$python" -c 'import fixsplat; print(fixsplat._library.PATH)' 2>&1)
    case $said in *"$2") ok "$1" ;; *) fail "$1" "$said" ;; esac
}

refuses() {
    said=$(FIXSPLAT_LIBRARY=$3 "$python" -c 'import fixsplat' 2>&1 | tail -n 1)
    if printf '%s\n' "$said" | grep -Eq "^ImportError: fixsplat: .*$2"; then ok "$1"; else fail "$1" "$said"; fi
}
refuses "FIXSPLAT_LIBRARY: no such file" "cannot be loaded: .*none.so.*FIXSPLAT_LIBRARY" "$work/none.so"
echo 'int fxs_version(void) { return 507; }' >other.c
${CC:-cc} -shared -fPIC -o other.so other.c
refuses "another version" "other.so is of version 0.5.7, this package is for $version" "$work/other.so"
number=$(echo "$version" | awk -F'[.-]' '{ print $1 * 10000 + $2 * 100 + $3 }')
echo "int fxs_version(void) { return $number; }" >other.c
${CC:-cc} -shared -fPIC -o other.so other.c
refuses "a library without its functions" "not this package's: .*undefined symbol" "$work/other.so"
echo 'int other;' >other.c
${CC:-cc} -shared -fPIC -o other.so other.c
refuses "another library" "is not libfixsplat.so" "$work/other.so"

cp -r "$root/port/python" source && chmod -R u+w source
mkdir -p checkout/port checkout/src/include/fixsplat checkout/build system
cp -r source checkout/port/python
cp "$root/src/include/fixsplat/fixsplat.h" checkout/src/include/fixsplat
cp "$FIXSPLAT_LIBRARY" checkout/build
PYTHONPATH=$work/checkout/port/python imports "found in the build folder of a checkout" \
    "checkout/build/libfixsplat.so.$version"
cp "$FIXSPLAT_LIBRARY" system/$soname
PYTHONPATH=$work/source LD_LIBRARY_PATH=$work/system imports "found by the system" "$soname"

# ---- pip -------------------------------------------------------------------------------------------------------------

pip_() {
    "$python" -m pip "$@" --quiet --no-index --no-build-isolation --no-deps --disable-pip-version-check
}
if "$python" -c 'import setuptools, pip, wheel, venv' 2>/dev/null; then
    said=$(unset FIXSPLAT_LIBRARY; pip_ wheel ./source 2>&1)
    case $said in *"libfixsplat.so.$version: no such file; build it (make)"*) ok "pip: no wheel without a library" ;;
        *) fail "pip: no wheel without a library" "$said" ;; esac
    check "pip install" pip_ install --root-user-action ignore --target prefix ./source
    check "pip: what is installed" equal "$(cd prefix/fixsplat && ls | grep -v __pycache__ | tr '\n' ' ')" \
        "$( (cd source/fixsplat && ls; echo $soname) | grep -v __pycache__ | LC_ALL=C sort | tr '\n' ' ')"
    check "pip: its version" ls "prefix/fixsplat-$(echo "$version" | tr -d -).dist-info/METADATA"
    PYTHONPATH=$work/prefix imports "found beside the package" "prefix/fixsplat/$soname"

    check "make wheel" make -s --no-print-directory -C "$root" B="$B" PYTHON="$python" wheel
    wheel=$(ls "$library"/wheel/*.whl)
    platform=$("$python" -c 'import sysconfig; print(sysconfig.get_platform().replace("-", "_"))')
    check "make wheel: for any Python 3 on this platform" equal "${wheel##*/}" \
        "fixsplat-$(echo "$version" | tr -d -)-py3-none-$platform.whl"
    "$python" -m venv --system-site-packages --without-pip fresh
    python=$work/fresh/bin/python
    unset PYTHONPATH
    check "a fresh venv: pip install of the wheel" pip_ install "$wheel"
    imports "a fresh venv: the wheel's own library" "/site-packages/fixsplat/$soname"
    check "a fresh venv: it renders" env -u FIXSPLAT_LIBRARY "$python" -c \
        'import fixsplat; s = fixsplat.load("knot.ply"); assert s.render(s.frame(64, 48)).colour.any()'
else
    skip "pip install" "no pip, setuptools and wheel here (python3-pip)"
fi
check "the source tree is as it was" equal "$(ls "$root/port/python" | tr '\n' ' ')" "fixsplat pyproject.toml setup.py "
finish
