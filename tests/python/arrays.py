"""arrays.py COMMAND FOLDER: Gaussians and photographs as arrays, converting, signals and interpreters, as check.py."""
import gc
import os
import signal
import subprocess
import sys
import threading
import time
import warnings
import weakref

import fixsplat
import numpy as np
from checks import grows, interrupted, ok, read, refuses, run, same

os.chdir(sys.argv[2])
FORMATS = ("fxs", "ply", "compressed.ply", "splat", "spz", "rad", "sog", "glb", "csv")


def fields(gaussians):
    return {name: getattr(gaussians, name) for name in ("positions", "scales", "rotations", "opacities", "sh")}


def same_gaussians(name, a, b):
    for field, array in fields(a).items():
        same(f"{name}: {field}", array, fields(b)[field])
    ok(f"{name}: anti-aliased", a.antialiased == b.antialiased)


# ---- Arrays of Gaussians ---------------------------------------------------------------------------------------------

header, body = read("knot.ply").split(b"end_header\n", 1)
columns = [line.split()[2].decode() for line in header.splitlines() if line.startswith(b"property float")]
table = np.frombuffer(body, "<f4").reshape(-1, len(columns))


def of_file(*names):
    return np.stack([table[:, columns.index(name)] for name in names], -1)


knot = fixsplat.load_gaussians("knot.ply")
same("load_gaussians: positions", knot.positions, of_file("x", "y", "z"))
same("load_gaussians: scales", knot.scales, of_file("scale_0", "scale_1", "scale_2"))
same("load_gaussians: rotations", knot.rotations, of_file("rot_0", "rot_1", "rot_2", "rot_3"))
same("load_gaussians: opacities", knot.opacities, of_file("opacity")[:, 0])
same("load_gaussians: SH degree 0", knot.sh[:, 0], of_file("f_dc_0", "f_dc_1", "f_dc_2"))
rest = of_file(*(f"f_rest_{i}" for i in range(45))).reshape(-1, 3, 15)
same("load_gaussians: SH of higher degrees", knot.sh[:, 1:], rest.transpose(0, 2, 1))
ok("load_gaussians: the rest", len(knot) == 3000 and knot.sh_degree == 3 and not knot.antialiased)
ok("load_gaussians: all are views of one block", len({array.__array_interface__["data"][0] - column * 4
   for array, column in zip(fields(knot).values(), (0, 3, 6, 10, 11))}) == 1)
done = []
fixsplat.load_gaussians("large.ply", progress=done.append)
ok("load_gaussians: progress", done[-1] == 1 and len(done) > 1, done)
same_gaussians("load_gaussians: of an .fxs file", fixsplat.load_gaussians("knot.fxs"),
               fixsplat.load("knot.ply").arrays())

scene = fixsplat.Scene.from_arrays(**fields(knot))
scene.save("from.fxs")
ok("from_arrays: the command's file", read("from.fxs") == read("knot.fxs"))
again = fixsplat.Gaussians(**fields(knot))
ok("Gaussians: keeps arrays of float32", all(array is fields(again)[name] for name, array in fields(knot).items()))
doubles = {name: np.asfortranarray(array.astype(np.float64)) for name, array in fields(knot).items()}
fixed = {name: array.copy() for name, array in fields(knot).items()}
for array in fixed.values():
    array.setflags(write=False)
for name, arrays in (("doubles", doubles), ("lists", {name: array.tolist() for name, array in doubles.items()}),
                     ("read-only", fixed)):
    fixsplat.Scene.from_arrays(**arrays, threads=3).save("from.fxs")
    ok(f"from_arrays: {name}", read("from.fxs") == read("knot.fxs"))
run("convert", "knot.ply", "less.fxs", "--profile", "small", "--sh-degree", "1")
fixsplat.Scene.from_arrays(**{**fields(knot), "sh": knot.sh[:, :4]}, profile="small").save("from.fxs")
ok("from_arrays: profile and SH degree", read("from.fxs") == read("less.fxs"))
ok("from_arrays: anti-aliased", fixsplat.Scene.from_arrays(**fields(knot), antialiased=True).antialiased)
broken = knot.positions.copy()
broken[7, 1], broken[8] = np.nan, 1e30
holes = fixsplat.Scene.from_arrays(**{**fields(knot), "positions": broken})
ok("from_arrays: what cannot be drawn", (holes.count, holes.left_out, holes.brought_in) == (2999, 1, 1), holes)
done = []
fixsplat.load_gaussians("large.ply").pack(progress=done.append)
ok("pack: progress", done and max(done) > 0.9, done[-3:])

packed = fixsplat.load("knot.ply")
near = packed.arrays()
camera = packed.frame(320, 200)
seen = packed.render(camera, targets=("colour", "ids"))
run("make-scene", "meadow", "--count", "12000", "-o", "meadow.ply")
for name in ("knot", "meadow"):
    with fixsplat.load(f"{name}.ply") as other:
        view = other.frame(320, 200, up=(0, -1, 0))
        shown = other.render(view, targets=("ids", "median_depth"))
        ids = shown.ids[np.isfinite(shown.median_depth), 1]
        depth = shown.median_depth[np.isfinite(shown.median_depth)]
        centres = other.arrays().positions[np.searchsorted(other.numbers, ids)]
        of_centres = (centres - view.position) @ view.world_to_camera[2, :3]
        right = (np.abs(of_centres / depth - 1) < 1e-4).mean()
        ok(f"Scene.numbers: the target ids has them: {name}", len(ids) > 1000 and right > 0.5 and
           np.isin(ids, other.numbers).all(), right)
        ok(f"Scene.numbers: one a Gaussian, with holes in meadow: {name}", len(other.numbers) == other.count and
           (other.numbers[-1] >= other.count) == (name == "meadow"), other.numbers[-1])
ok("Scene.arrays: as far as the codes go", len(near) == 3000 and
   np.abs(np.sort(near.positions, 0) - np.sort(knot.positions, 0)).max() < 1e-3)
for name, other in (("mapped", fixsplat.load("knot.fxs")), ("bytes", fixsplat.load(read("knot.fxs")))):
    same_gaussians(f"Scene.arrays: {name}", other.arrays(), near)

# ---- Objects ---------------------------------------------------------------------------------------------------------

packed = fixsplat.load("knot.fxs")
front = fixsplat.Camera.look_at((1, -2, -7), (0, 0, 0), 320, 180)
printed = run("select", "knot.fxs", "--eye=1,-2,-7", "--look=0,0,0", "--up=0,-1,0", "--size", "320x180", "--around",
              "80,20,240,160", "--trim", "0", "--ids")
found = packed.find([(front, packed.mark(front, [(80, 20, 240, 160, 1)]))], threads=3)
ok("find: as the command", found.tolist() == [int(word) for word in printed.split()] and (found == 1).any())
half = np.zeros((180, 320), np.uint8)
half[:, 160:] = 1
sides = packed.find([(front, half)], alone=True)
ok("find: by a mask", 0 < (sides == 1).sum() < packed.count)
ok("find: a trim", (packed.find([(front, half)], trim=0.5) == 255).any())
refuses("find: marks of another shape", ValueError, "shape", lambda: packed.find([(front, half[1:])]))
refuses("find: nothing marked", fixsplat.Error, "no pixel of a picture", lambda: packed.find([(front, 0 * half)]))
refuses("mark: no click", ValueError, "hints", lambda: packed.mark(front, [(1, 2)]))
refuses("mark: outside", fixsplat.Error, "outside of the picture", lambda: packed.mark(front, [(320, 2, 1)]))

# ---- Masks -----------------------------------------------------------------------------------------------------------

left = knot.positions[:, 0] <= 0
run("convert", "knot.ply", "left.ply", "--crop", "-9,-9,-9,0,9,9")
half = knot.select(left)
half.save("half.ply")
ok("Gaussians.select: the command's crop", 0 < left.sum() < 3000 and read("half.ply") == read("left.ply"))
same_gaussians("Gaussians.select: numbers", knot.select(np.flatnonzero(left)), half)
same_gaussians("Gaussians.select: a list", knot.select(list(left)), half)
ok("Gaussians.select: a slice is a view", np.shares_memory(knot.select(slice(0, 3000, 2)).sh, knot.sh))
with packed.select(near.positions[:, 0] <= 0) as part:
    ok("Scene.select", part.profile == "default" and part.count == (near.positions[:, 0] <= 0).sum() and
       part.box[1][0] < 1e-3 and np.abs(part.render(camera).colour.astype(int) - fixsplat.render(
           [fixsplat.Object(packed, crops=[fixsplat.Crop((-9, -9, -9), (0, 9, 9))])], camera).colour).mean() < 0.5,
       part)

# ---- Files -----------------------------------------------------------------------------------------------------------

for ending in FORMATS:
    run("convert", "knot.fxs", f"theirs.{ending}")
    for name, other in (("packed here", packed), ("mapped", fixsplat.load("knot.fxs"))):
        report = other.save(f"ours.{ending}")
        wanted = "knot.fxs" if ending == "fxs" else f"theirs.{ending}"
        ok(f"Scene.save: {name}, .{ending}", read(f"ours.{ending}") == read(wanted) and
           report.written == 3000 and report.lost_sh == (3 if ending == "splat" else 0), report)
    run("convert", "knot.ply", f"theirs.{ending}")
    knot.save(f"ours.{ending}")
    ok(f"Gaussians.save: .{ending}", read(f"ours.{ending}") == read(f"theirs.{ending}"))
for ending, options, given in (
        ("spz", {"spz_version": 3}, ["--spz-version", "3"]),
        ("ply", {"decimate": 0.1234}, ["--decimate", "12.34%"]),
        ("fxs", {"profile": "compact"}, ["--profile", "compact"]),
        ("ply", {"up": (0, 0, 1)}, ["--up", "0,0,1"]),
        ("ply", {"up": (0, 1, 0)}, ["--up", "0,1,0"]),
        ("csv", {"rotate": (10, 0, -725.5)}, ["--rotate", "10,0,-725.5"]),
        ("splat", {"scale": 0.25}, ["--scale", "0.25"]),
        ("fxs", {"translate": (1, -2, 1e6), "profile": "small"}, ["--translate", "1,-2,1e6", "--profile", "small"]),
        ("glb", {"translate": (1, 0, 0), "scale": 3, "rotate": (20, 30, 40), "up": (1, 2, 3),
                 "crop": [[-3, -9, -9], [9, 9, 9]], "decimate": 500, "sh_degree": 2},
         ["--translate", "1,0,0", "--scale", "3", "--rotate", "20,30,40", "--up", "1,2,3", "--crop", "-3,-9,-9,9,9,9",
          "--decimate", "500", "--sh-degree", "2"])):
    for name, source, path in (("a path", "knot.ply", "knot.ply"), ("arrays", knot, "knot.ply"),
                               ("a scene", packed, "knot.fxs")):
        run("convert", path, f"theirs.{ending}", *given)
        fixsplat.convert(source, f"ours.{ending}", **options)
        ok(f"convert: {name} to .{ending}, {options}", read(f"ours.{ending}") == read(f"theirs.{ending}"))
packed.save("ours.fxs", prune=0.5)
run("convert", "knot.fxs", "theirs.fxs", "--prune", "0.5")
ok("Scene.save: with options, packed again", read("ours.fxs") == read("theirs.fxs") != read("knot.fxs"))

# ---- Notebooks -------------------------------------------------------------------------------------------------------

seen.save("seen.png")
ok("Picture._repr_png_: the bytes of the file", seen._repr_png_() == read("seen.png"))
ok("Picture._repr_png_: without colours", packed.render(camera, targets=["ids"])._repr_png_() is None)
low = ", ".join(f"{x:.6g}" for x in packed.box[0])
ok("repr of a scene", "3000 Gaussians, SH degree 3, from (" + low + ") to (" in repr(packed), repr(packed))
ok("repr of Gaussians", repr(knot) == "<fixsplat.Gaussians, 3000, SH degree 3>", repr(knot))

# ---- Fits ------------------------------------------------------------------------------------------------------------

views = fixsplat.load_cameras("set/sparse/0")
photos = [packed.render(view).colour[..., :3] for view in views]
kept = [i for i in range(len(views)) if i % 8]
text = np.loadtxt("set/sparse/0/points3D.txt", usecols=range(7))
points, colours = text[:, 1:4], text[:, 4:7].astype(np.uint8)
run("fit", "set", "--steps", "40", "-o", "command.fxs")
fixsplat.fit([photos[i] for i in kept], [views[i] for i in kept], points=points, colours=colours,
             steps=40).save("fitted.fxs")
ok("fit: pictures and cameras: the command's file", read("fitted.fxs") == read("command.fxs"))
os.rename("set/sparse/0/points3D.txt", "points")
run("fit", "set", "--steps", "3", "--hold-out", "0", "--seed", "5", "-o", "command.fxs")
os.rename("points", "set/sparse/0/points3D.txt")
fixsplat.fit(np.stack(photos), views, steps=3, seed=5).save("fitted.fxs")
ok("fit: random points: the command's file", read("fitted.fxs") == read("command.fxs"))
Ks, poses = np.stack([view.K for view in views]), np.stack([view.world_to_camera for view in views])
fixsplat.fit(photos, [fixsplat.Camera(K, pose, 64, 48) for K, pose in zip(Ks, poses)], points=points,
             steps=3).save("command.fxs")
for name, K, pose in (("[R | t]", Ks, poses[:, :3]), ("one K, 4 x 4", Ks[0], poses)):
    fixsplat.fit(photos, K, pose, points=points, colours=np.full(points.shape, 128, np.uint8),
                 steps=3).save("fitted.fxs")
    ok(f"fit: {name}", read("fitted.fxs") == read("command.fxs"))

# ---- Signals ---------------------------------------------------------------------------------------------------------

huge, wide = packed.frame(8000, 6000), packed.frame(4000, 3000)
faint = [fixsplat.Object(packed, opacity=0.02)] * 100          # 100 objects take long on any machine
seconds = [time.monotonic()]
refuses("render: Ctrl-C", KeyboardInterrupt, "^$", lambda: interrupted(lambda: fixsplat.render(faint, huge, threads=1)))
seconds.append(time.monotonic())
fixsplat.render(faint, huge, threads=1)
seconds = np.diff(seconds + [time.monotonic()])
ok("render: Ctrl-C: before the picture is complete", seconds[0] < 0.6 * seconds[1], seconds)
undisturbed = fixsplat.render(faint, wide, threads=1).colour
ok("render: Ctrl-C: no wake-up is left", signal.set_wakeup_fd(-1) == -1)
refuses("render: Ctrl-C with a stop function", KeyboardInterrupt, "^$",
        lambda: interrupted(lambda: fixsplat.render(faint, huge, threads=1, stop=lambda: False)))
noticed = []
signal.signal(signal.SIGUSR1, lambda *_: noticed.append(1))
reader, writer = os.pipe()
os.set_blocking(writer, False)
signal.set_wakeup_fd(writer)
threading.Timer(0.05, lambda: signal.pthread_kill(threading.main_thread().ident, signal.SIGUSR1)).start()
same("render: another signal: the same picture", fixsplat.render(faint, wide, threads=1).colour, undisturbed)
ok("render: another signal: handled", noticed == [1])
ok("render: another signal: told to who waited for it", signal.set_wakeup_fd(-1) == writer and
   os.read(reader, 9) == bytes([signal.SIGUSR1]))
large = fixsplat.load_gaussians("large.ply")
refuses("pack: Ctrl-C", KeyboardInterrupt, "^$", lambda: interrupted(lambda: large.pack(profile="small", threads=1)))
refuses("Gaussians.save: Ctrl-C", KeyboardInterrupt, "^$", lambda: interrupted(lambda: large.save("x.sog")))
ok("Ctrl-C: its handler is as it was", signal.getsignal(signal.SIGINT) is signal.default_int_handler)
ok("Ctrl-C: no file is left", not [name for name in os.listdir(".") if name.startswith("x.") or ".tmp" in name])

# ---- References, threads and interpreters ----------------------------------------------------------------------------

alone = fixsplat.load("knot.ply")
view, gone = alone.arrays().positions[:5], weakref.ref(alone.memory)
alone.close()
gc.collect()
ok("views outlive their scene", gone() is None and np.array_equal(view, near.positions[:5]))
made = {}


def pack(i):
    made[i] = fixsplat.Scene.from_arrays(**fields(knot)).arrays().positions


workers = [threading.Thread(target=pack, args=(i,)) for i in range(4)]
for worker in workers:
    worker.start()
for worker in workers:
    worker.join()
ok("four threads pack arrays", all(np.array_equal(made[i], near.positions) for i in range(4)))


def in_interpreters(*texts):
    """What is said where each text is run in a subinterpreter of its own, of one process; None: no such module here."""
    program = "try:\n import _xxsubinterpreters as i\nexcept ImportError:\n raise SystemExit('none')\n"
    for text in texts:
        program += f"try:\n i.run_string(i.create(), {text!r})\nexcept i.RunFailedError as e:\n print(e)\n"
    program += "import os\nprint(end='', flush=True)\nos._exit(0)"
    said = subprocess.run([sys.executable, "-W", "ignore", "-c", program], capture_output=True, text=True)
    return None if said.stderr == "none\n" else said.stdout + said.stderr


text = ("import fixsplat\ns = fixsplat.load('knot.ply', progress=lambda done: None)\n"
        "print(s.render(s.frame(64, 48)).colour.shape, len(s.select(slice(9))), flush=True)")
said = in_interpreters(text)
if said is None:
    print("skip a subinterpreter: this Python has none by that name")
else:
    ok("a subinterpreter renders", said == "(48, 64, 4) 9\n", said)
    said = in_interpreters(text, text)
    ok("a second one renders, or NumPy says why not", said in ("(48, 64, 4) 9\n" * 2,) or
       said.startswith("(48, 64, 4) 9\n<class 'ImportError'>: "), said)

if os.path.exists("/proc/self/statm"):
    grows("1000 scenes, opened and closed", 1000, lambda: fixsplat.load("knot.fxs").close())
    grows("1000 scenes, opened", 1000, lambda: fixsplat.load("knot.fxs"))
    grows("100 scenes of arrays", 100, lambda: fixsplat.Scene.from_arrays(**fields(knot)).arrays())
    grows("100 conversions of arrays", 100, lambda: half.save("x.ply", up=(0, 0, 1)))
    grows("100 fits of arrays", 100, lambda: fixsplat.fit(photos, views, points=points, steps=1, threads=2))
    grows("100 pictures of a notebook", 100, seen._repr_png_)
    files = len(os.listdir("/proc/self/fd"))
    packed.render(camera)
    ok("a picture leaves no file open", len(os.listdir("/proc/self/fd")) == files)
else:
    print("skip memory that is left: no /proc here")
os.remove("x.ply")

# ---- Errors ----------------------------------------------------------------------------------------------------------


def with_arrays(**other):
    return lambda: fixsplat.Scene.from_arrays(**{**fields(knot), **other})


def fit_with(pictures=photos, K=views, pose=None, **options):
    return lambda: fixsplat.fit(pictures, K, pose, steps=1, **options)


for name, kind, words, call in (
        ("positions: shape", ValueError, r"^positions: expected the shape \(N, 3\), not \(3,\)$",
         with_arrays(positions=np.zeros(3))),
        ("positions: text", TypeError, "^positions: expected real numbers", with_arrays(positions=[["a"] * 3])),
        ("scales: too few", ValueError, r"^scales: expected the shape \(3000, 3\), not \(2999, 3\)$",
         with_arrays(scales=knot.scales[1:])),
        ("opacities: a column", ValueError, r"^opacities: expected the shape \(3000,\), not \(3000, 1\)$",
         with_arrays(opacities=knot.opacities[:, None])),
        ("rotations: complex", TypeError, "^rotations: expected real numbers",
         with_arrays(rotations=knot.rotations * 1j)),
        ("sh: shape", ValueError, r"^sh: expected the shape \(3000, N, 3\)", with_arrays(sh=knot.sh[:, 0])),
        ("sh: coefficients", ValueError, "^sh: 5 coefficients, expected 1, 4, 9 or 16$",
         with_arrays(sh=knot.sh[:, :5])),
        ("from_arrays: nothing can be drawn", fixsplat.Error, "^arrays: ",
         with_arrays(positions=knot.positions * np.nan)),
        ("from_arrays: profile", ValueError, "expected 'default' or", with_arrays(profile="tiny")),
        ("select: too few bools", ValueError,
         r"^mask: expected 3000 bools, or numbers of Gaussians, not bool of shape \(9,\)$",
         lambda: knot.select(np.ones(9, bool))),
        ("select: floats", ValueError, "^mask: expected 3000 bools", lambda: knot.select(knot.opacities)),
        ("select: too large", IndexError, "3000", lambda: knot.select([3000])),
        ("select: none", fixsplat.Error, "^arrays: ", lambda: packed.select(np.zeros(3000, bool))),
        ("load_gaussians: no file", fixsplat.Error, "^none.ply: No such file",
         lambda: fixsplat.load_gaussians("none.ply")),
        ("load_gaussians: max_gaussians", fixsplat.Error, "3000",
         lambda: fixsplat.load_gaussians("knot.ply", max_gaussians=2999)),
        ("convert: a number", TypeError, "expected a path, Gaussians or a Scene", lambda: fixsplat.convert(3, "x.ply")),
        ("convert: level of arrays", ValueError, "are for files", lambda: knot.save("x.ply", level=1)),
        ("convert: up", ValueError, "^up: expected a direction", lambda: knot.save("x.ply", up=(0, 0, 0))),
        ("convert: rotate", ValueError, r"^rotate: expected the shape \(3,\)", lambda: knot.save("x.ply", rotate=90)),
        ("convert: decimate, a share", ValueError, "^decimate=1.5", lambda: knot.save("x.ply", decimate=1.5)),
        ("convert: scale", ValueError, "^scale=0", lambda: knot.save("x.ply", scale=0)),
        ("convert: translate", fixsplat.Error, "2\\^28", lambda: knot.save("x.ply", translate=(1e9, 0, 0))),
        ("convert: a closed scene", ValueError, "the scene is closed", lambda: alone.save("x.ply")),
        ("fit: floats", ValueError, r"^photos\[1\]: expected uint8", fit_with([photos[0], photos[1] / 255])),
        ("fit: with alpha", ValueError, r"^photos\[0\]: expected uint8 of the shape \(H, W, 3\)",
         fit_with([seen.colour], views[:1])),
        ("fit: no pictures", ValueError, "at least one", fit_with([], [])),
        ("fit: too few cameras", ValueError, "^8 cameras for 9", fit_with(K=views[1:])),
        ("fit: cameras of another size", ValueError, r"^photos\[0\]: has 64 x 48 pixels, its camera has 32 x 24",
         fit_with(K=[view.resized(32, 24) for view in views])),
        ("fit: too few matrices", ValueError, r"^K: expected the shape \(3, 3\) or \(9, 3, 3\)",
         fit_with(K=Ks[1:], pose=poses)),
        ("fit: no poses", TypeError, "K and world_to_camera", fit_with(K=Ks)),
        ("fit: a Camera has its own", TypeError, "its own", fit_with(pose=poses)),
        ("fit: points, shape", ValueError, r"^points: expected the shape \(N, 3\), not \(3,\)$",
         fit_with(points=np.ones(3))),
        ("fit: points, NaN", ValueError, "^points: .*finite", fit_with(points=points * np.nan)),
        ("fit: points, too far", ValueError, "2\\^27", fit_with(points=points * 1e9)),
        ("fit: no points", ValueError, "at least one", fit_with(points=points[:0])),
        ("fit: points behind all cameras", fixsplat.Error, "behind all cameras", fit_with(
            pictures=photos[:1], K=views[:1], points=[views[0].position - views[0].world_to_camera[2, :3]])),
        ("fit: colours", ValueError, "^colours: expected uint8", fit_with(points=points, colours=colours[1:])),
        ("fit: colours alone", TypeError, "are for points", fit_with(colours=colours)),
        ("fit: hold_out of arrays", TypeError, "are for files", fit_with(hold_out=8)),
        ("fit: cameras of files", TypeError, "are for arrays", lambda: fixsplat.fit("set", views))):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        refuses(name, kind, words, call)
ok("bad input: nothing is left", not [name for name in os.listdir(".") if name.startswith("x.")], os.listdir("."))
print("end")
