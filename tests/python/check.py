"""check.py COMMAND FOLDER [CAPTURED]: what the package does against the command, in a folder with the scenes and
photographs of tests/scripts/python.sh. CAPTURED: a folder with train-1000.ply and its cameras.json. Prints "ok NAME",
"FAIL NAME: WHY" or "skip NAME: WHY" for each check, "end" last."""
import json
import math
import os
import re
import signal
import sys
import threading
import time
import types
import warnings

import fixsplat
import numpy as np
from checks import grows, hash_of, interrupted, ok, read, refuses, run, same

ALL = ("colour", "coverage", "mean_depth", "median_depth", "ids")
os.chdir(sys.argv[2])

# ---- Pictures of the command -----------------------------------------------------------------------------------------

def pictures(scene, path, cameras, count, label):
    views = fixsplat.load_cameras(cameras)
    for i in range(count):
        said = run("render", path, "--cameras", cameras, "--view", str(i), "--hash").strip()
        ok(f"{label}, view {i}: the command's hash", hash_of(scene.render(views[i])) == said, said)
    v = views[0]
    near = scene.render(v.K, v.world_to_camera, v.width, v.height).colour.astype(int)
    ok(f"{label}: by matrices, to the last bit of a few pixels",
       (np.abs(near - scene.render(v).colour).max() <= 1) and near.any())


scene = fixsplat.load("knot.ply")
pictures(scene, "knot.ply", "set/sparse/0", 3, "knot.ply")
for folder in sys.argv[3:]:
    with fixsplat.load(f"{folder}/train-1000.ply") as shared:
        pictures(shared, f"{folder}/train-1000.ply", f"{folder}/cameras.json", 2, "train-1000.ply")

camera = scene.frame(320, 200)
whole = scene.render(camera, targets=ALL)
ok("framed: the command's hash",
   hash_of(whole) == run("render", "knot.ply", "--size", "320x200", "--hash").strip())
with fixsplat.load("start.fxs") as started:
    said = run("render", "start.fxs", "--size", "320x200", "--hash").strip()
    ok("a start view: the command's hash", hash_of(started.render(started.frame(320, 200))) == said, said)
    ok("a start view: not with a field of view", hash_of(started.render(started.frame(320, 200, fov=50))) != said)
    ok("up: not known", started.up is None and scene.up is None)
fixsplat.convert("start.fxs", "leant.fxs", rotate=(0, 0, 30), up=(0, -2, 0))
run("convert", "start.fxs", "same.fxs", "--rotate", "0,0,30", "--up", "0,-2,0")
ok("up: as the command states it", read("leant.fxs") == read("same.fxs"))
with fixsplat.load("leant.fxs") as leant:
    said = run("render", "leant.fxs", "--size", "320x200", "--fov", "60", "--hash").strip()
    ok("up: turned as the scene is", np.allclose(leant.up, (0.5, -math.sqrt(0.75), 0), atol=2e-4), leant.up)
    ok("up: a view is upright by it", hash_of(leant.render(leant.frame(320, 200, fov=60))) == said, said)
with fixsplat.load("moving.fxs") as moving:
    ok("a scene that moves: duration, rate, loops", (moving.duration, moving.rate, moving.loops) == (1, 0, True))
    ok("a still scene: no duration", (scene.duration, scene.rate, scene.loops) == (0, 0, False))
    view = moving.frame(64, 48)
    for at in (0, 0.25, 0.75):
        said = run("render", "moving.fxs", "--size", "64x48", "--time", str(at), "--hash").strip()
        ok(f"time={at}: the command's hash", hash_of(moving.render(view, time=at)) == said, said)
    ok("time of an object", hash_of(fixsplat.render([fixsplat.Object(moving, time=0.5)], view, time=0.25)) == said)
    ok("convert: a scene that moves", fixsplat.convert("moving.splatv", "copy.fxs").written == moving.count and
       read("copy.fxs") == read("moving.fxs"))
    fixsplat.convert("moving.fxs", "moment.ply", time=0.25)
    run("convert", "moving.fxs", "said.ply", "--time", "0.25")
    ok("convert: a moment, as the command", read("moment.ply") == read("said.ply"))
    ok("load_gaussians: a moment", len(fixsplat.load_gaussians("moving.fxs", time=0.25)) ==
       len(fixsplat.load_gaussians("moment.ply")))
    refuses("save: a format without motion", ValueError, "holds no motion: give time", lambda: moving.save("whole.ply"))
    fixsplat.convert("moving.fxs", "part.fxs", prune=0.5, times=(0.25, 0.75), scale=2, crop=((0, -9, -9), (9, 9, 9)))
    run("convert", "moving.fxs", "said.fxs", "--prune", "0.5", "--times", "0.25..0.75", "--scale", "2", "--crop",
        "0,-9,-9,9,9,9")
    ok("convert: edits of a scene that moves: the command's bytes", read("part.fxs") == read("said.fxs"))
    fixsplat.convert("moving.fxs", "part.splat4d", translate=(1, 0, 0))
    run("convert", "moving.fxs", "said.splat4d", "--translate", "1,0,0")
    ok("convert: a scene that moves to a .splat4d", read("part.splat4d") == read("said.splat4d"))
    refuses("convert: decimate of a scene that moves", fixsplat.Error, "moving scenes are not decimated",
            lambda: fixsplat.convert("moving.fxs", "part.fxs", decimate=5))
    refuses("convert: times in the wrong order", fixsplat.Error, "times 2 to 1: expected",
            lambda: fixsplat.convert("moving.fxs", "part.fxs", times=(2, 1)))
    refuses("convert: times of a still scene", ValueError, "does not move",
            lambda: fixsplat.convert("knot.ply", "still.fxs", times=(0, 1)))
    refuses("convert: time of a still scene", ValueError, "does not move",
            lambda: fixsplat.convert("knot.ply", "still.ply", time=1))
ok("background", hash_of(scene.render(camera, background=(17, 19, 27), cutoff="square", sh_degree=1)) == run(
    "render", "knot.ply", "--size", "320x200", "--hash", "--bg", "11131b", "--cutoff", "square", "--sh-degree",
    "1").strip())
ok("alpha", hash_of(scene.render(camera, alpha=True)) == run("render", "knot.ply", "--size", "320x200", "--hash",
                                                             "--alpha").strip())
near = scene.render(camera, near=12.0)
ok("near", hash_of(near) == run("render", "knot.ply", "--size", "320x200", "--hash", "--near", "12").strip())
ok("near: it shows", not np.array_equal(near.colour, whole.colour))
view = fixsplat.load_cameras("set/sparse/0")[1]
ok("resized: the command's hash", hash_of(scene.render(view.resized(200, 100))) == run(
    "render", "knot.ply", "--cameras", "set/sparse/0", "--view", "1", "--size", "200x100", "--hash").strip())
eye = fixsplat.Camera.look_at((1, -2, -13), (0, 0.5, 0), 160, 120, fov=40)
ok("look_at: the command's camera", hash_of(scene.render(eye, near=0.2)) == run(
    "render", "knot.ply", "--eye", "1,-2,-13", "--look", "0,0.5,0", "--fov", "40", "--size", "160x120", "--near", "0.2",
    "--hash").strip())

# ---- Targets ---------------------------------------------------------------------------------------------------------

for name, shape, kind in (("colour", (200, 320, 4), "uint8"), ("coverage", (200, 320), "uint8"),
                          ("mean_depth", (200, 320), "float32"), ("median_depth", (200, 320), "float32"),
                          ("ids", (200, 320, 2), "uint32")):
    array = getattr(whole, name)
    ok(f"{name}: shape and type", array.shape == shape and array.dtype == kind, f"{array.shape} {array.dtype}")
    alone = scene.render(camera, targets=(name,))
    same(f"{name}: alone, the same", getattr(alone, name), array)
    ok(f"{name}: alone, no others", sum(getattr(alone, other) is not None for other in ALL) == 1)
for kind in ("mean", "median"):
    run("render", "knot.ply", "--size", "320x200", "--depth", f"{kind}.pfm", "--depth-kind", kind)
    header, size, _, pixels = read(f"{kind}.pfm").split(b"\n", 3)
    same(f"{kind}_depth: the command's .pfm", np.frombuffer(pixels, "<f4").reshape(200, 320)[::-1],
         getattr(whole, f"{kind}_depth"))
run("render", "knot.ply", "--size", "320x200", "--ids", "ids.raw")
same("ids: the command's .raw", np.frombuffer(read("ids.raw"), "<u4").reshape(200, 320, 2), whole.ids)
ok("coverage: that of alpha", np.array_equal(whole.coverage, scene.render(camera, alpha=True).colour[..., 3]))
ok("ids: nothing where nothing covers", (whole.ids[whole.coverage == 0] == fixsplat.NOTHING).all() and
   (whole.ids[whole.coverage > 8, 1] < scene.count).all())
whole.save("saved.raw")
ok("Picture.save", read("saved.raw") == whole.colour.tobytes())
refuses("Picture.save: no colours", ValueError, "no colours",
        lambda: scene.render(camera, targets=["ids"]).save("x.png"))

# ---- Objects ---------------------------------------------------------------------------------------------------------

cubes = fixsplat.load("cubes.ply")
quaternion = (0.6, 0, 0.8, 0)
matrix = [[-0.28, 0, 0.96], [0, 1, 0], [-0.96, 0, -0.28]]
far = fixsplat.Camera.look_at((0, -3, -16), (0, 0, 0), 320, 200)
objects = [fixsplat.Object(scene, id=7),
           fixsplat.Object(cubes, rotation=quaternion, translation=(3, 0.5, -1), scale=1.5, id=8)]
both = fixsplat.render(objects, far, targets=ALL, near=0.2)
ok("objects: the command's hash", hash_of(both) == run(
    "render", "knot.ply", "cubes.ply", "--place", "1:3,0.5,-1,0.6,0,0.8,0,1.5", "--eye", "0,-3,-16", "--look", "0,0,0",
    "--size", "320x200", "--near", "0.2", "--hash").strip())
ok("objects: both ids show", set(np.unique(both.ids[..., 0])) == {7, 8, fixsplat.NOTHING})
turned = fixsplat.render([fixsplat.Object(cubes, rotation=matrix)], far).colour.astype(int)
ok("objects: a matrix is its quaternion", np.abs(turned - fixsplat.render(
    [fixsplat.Object(cubes, rotation=quaternion)], far).colour).max() <= 1)
axes = np.eye(3)
for turn in ([1, 0, 0], [0, 1, 0], [0, 0, 1]):
    half = 2 * np.outer(turn, turn) - axes
    same(f"objects: half a turn about {turn}", fixsplat.render([fixsplat.Object(cubes, rotation=half)], far).colour,
         fixsplat.render([fixsplat.Object(cubes, rotation=[0, *turn])], far).colour)
same("objects: a scene stands for itself", fixsplat.render([scene], camera).colour, whole.colour)
same("objects: hidden", fixsplat.render([fixsplat.Object(scene), fixsplat.Object(cubes, visible=False)], camera).colour,
     whole.colour)
ok("objects: none", (fixsplat.render([], camera, background=(1, 2, 3)).colour == (1, 2, 3, 255)).all())
red = fixsplat.render([fixsplat.Object(scene, tint=(1, 0, 0), opacity=0.5)], camera, targets=("colour", "coverage"))
ok("objects: tint and opacity", not red.colour[..., 1:3].any() and red.colour[..., 0].any() and
   red.coverage.mean() < whole.coverage.mean())
halves = [fixsplat.render([fixsplat.Object(scene, crops=[fixsplat.Crop((-9, -9, -9), (0, 9, 9), outside)])], camera,
                          targets=("ids",)).ids[..., 1] for outside in (False, True)]
numbers = [set(np.unique(half)) - {fixsplat.NOTHING} for half in halves]
ok("objects: a crop and its rest", numbers[0] and numbers[1] and not numbers[0] & numbers[1])

# ---- Cameras ---------------------------------------------------------------------------------------------------------

v = fixsplat.load_cameras("set/sparse/0")[2]
ok("cameras: K", np.array_equal(v.K, [[60, 0, 32], [0, 60, 24], [0, 0, 1]]) and (v.width, v.height) == (64, 48))
ok("cameras: name", v.name == "02.png", v.name)
ok("cameras: world_to_camera", np.allclose(v.world_to_camera @ [*v.position, 1], [0, 0, 0, 1], atol=1e-12) and
   np.allclose(v.world_to_camera[:3, 3], (0, 0, 13)))
ok("cameras: camera_to_world", np.allclose(v.camera_to_world @ v.world_to_camera, np.eye(4), atol=1e-12))
pose = fixsplat.to_nerfstudio(v.world_to_camera)
ok("nerfstudio: its axes", np.allclose(pose[:3, 3], v.position) and
   np.allclose(pose[:3, 2], -v.world_to_camera[2, :3]) and np.allclose(pose[:3, 1], -v.world_to_camera[1, :3]))
ok("nerfstudio: back", np.allclose(fixsplat.from_nerfstudio(pose[:3]), v.world_to_camera, atol=1e-12))
with open("transforms.json", "w") as file:
    file.write('{"fl_x": 60, "fl_y": 60, "cx": 32, "cy": 24, "w": 64, "h": 48, "frames": [{"file_path": "2.png", '
               f'"transform_matrix": {pose.tolist()}}}]}}')
ok("nerfstudio: a file's camera", np.allclose(fixsplat.load_cameras("transforms.json")[0].world_to_camera,
                                              v.world_to_camera, atol=1e-9))
parallel = fixsplat.Camera([[20, 0, 160], [0, 20, 100], [0, 0, 1]], camera.world_to_camera, 320, 200,
                           orthographic=True, near=0.5)
ok("orthographic", parallel.orthographic and parallel.near == 0.5 and scene.render(parallel).colour[..., :3].any())

# ---- Scenes ----------------------------------------------------------------------------------------------------------

ok("scene: count, degree, size", (scene.count, len(scene), scene.sh_degree) == (3000, 3000, 3) and scene.profile ==
   "default" and scene.left_out == 0 and not scene.antialiased)
scene.save("saved.fxs")
ok("save: the command's file", read("saved.fxs") == read("knot.fxs") and scene.nbytes == len(read("knot.fxs")))
for name, source in (("mapped", "saved.fxs"), ("bytes of .fxs", read("saved.fxs")), ("bytes of .ply", read("knot.ply")),
                     ("bytearray", bytearray(read("knot.ply"))), ("memoryview", memoryview(read("saved.fxs"))),
                     (".splat", "knot.splat"), (".spz", "knot.spz")):
    with fixsplat.load(source) as other:
        if name.startswith("."):
            ok(f"load: {name}", np.abs(other.render(camera).colour.astype(int) - whole.colour).mean() < 8)
        else:
            same(f"load: {name}", other.render(camera).colour, whole.colour)
            ok(f"load: {name}: boxes", other.box == scene.box and other.inner_box == scene.inner_box)
done = []
fixsplat.load("knot.ply", progress=done.append, profile="small", threads=2).save("small.fxs")
ok("load: progress", done and all(0 <= x <= 1 for x in done) and max(done) > 0.9)
run("convert", "knot.ply", "other.fxs", "--profile", "small")
ok("load: the profile is the command's", read("small.fxs") == read("other.fxs"))
for ending, options, given in (
        *((ending, {}, []) for ending in ("fxs", "ply", "compressed.ply", "splat", "spz", "rad", "sog", "glb", "csv")),
        ("spz", {"spz_version": 3}, ["--spz-version", "3"]), ("spz", {"spz_fine": True}, ["--spz-fine"]),
        ("ply", {"sh_degree": 1, "prune": 0.5}, ["--sh-degree", "1", "--prune", "0.5"]),
        ("glb", {"sphere": (0, 0, 0, 3), "drop_floaters": True}, ["--sphere", "0,0,0,3", "--drop-floaters"]),
        ("fxs", {"decimate": 900}, ["--decimate", "900"]),
        ("fxs", {"crop": [[-2, -2, -2], [2, 2, 2]], "profile": "compact"},
         ["--crop", "-2,-2,-2,2,2,2", "--profile", "compact"])):
    report = fixsplat.convert("haze.ply", f"ours.{ending}", **options)
    run("convert", "haze.ply", f"theirs.{ending}", *given)
    fewer = {"prune", "crop", "sphere", "decimate"} & set(options)
    ok(f"convert: .{ending} {options}", read(f"ours.{ending}") == read(f"theirs.{ending}") and report.read == 3000 and
       (report.written < 3000) == bool(fewer), report)
ok("convert: what a format cannot hold", fixsplat.convert("knot.ply", "ours.splat").lost_sh == 3)

# ---- Back ends and threads -------------------------------------------------------------------------------------------

found = {b.name: b for b in fixsplat.backends()}
ok("backends", found["cpu"].devices and found["cpu"].missing is None and found["cpu"].depths)
if found["cuda"].missing:
    ok("CUDA: why not, in words", re.search("nvcc|driver|device", found["cuda"].missing), found["cuda"].missing)
    refuses("CUDA: render says why not", fixsplat.Error, "^backend cuda: .*(nvcc|driver|device)",
            lambda: scene.render(camera, backend="cuda"))
    refuses("CUDA: fit says why not", fixsplat.Error, "nvcc|driver|device|CUDA",
            lambda: fixsplat.fit("set", steps=1, backend="cuda"))
else:
    same("CUDA: the same bytes", scene.render(camera, backend="cuda").colour, whole.colour)
for backend in ("gles", "osmesa"):
    if found[backend].missing:
        print(f"skip {backend}: {found[backend].missing}")
        continue
    same(f"{backend}: the same bytes", scene.render(camera, backend=backend).colour, whole.colour)
    with fixsplat.Renderer(backend) as renderer:
        thread = threading.Thread(target=refuses, args=(
            f"{backend}: another thread", RuntimeError, "thread that opened",
            lambda: scene.render(camera, backend=renderer)))
        thread.start()
        thread.join()
for options in ({"threads": 1}, {"threads": 5}, {"max_memory": 2000000, "threads": 1}):
    same(f"render: {options}", scene.render(camera, **options).colour, whole.colour)
refuses("too little memory", fixsplat.Error, "memory", lambda: scene.render(camera, threads=1, max_memory=20000))

views = [scene.frame(320, 200 + 10 * i) for i in range(12)]
alone = [scene.render(v).colour for v in views]
for label, backend in (("of their own", "auto"), ("of all", fixsplat.Renderer(threads=2))):
    drawn = {}

    def draw(first):
        for i in range(first, len(views), 4):
            drawn[i] = scene.render(views[i], backend=backend).colour

    workers = [threading.Thread(target=draw, args=(i,)) for i in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    ok(f"four threads, a renderer {label}", all(np.array_equal(drawn[i], alone[i]) for i in range(len(views))))
backend.close()
refuses("a renderer that is closed", ValueError, "closed", lambda: scene.render(camera, backend=backend))

def lets_others_run(name, call):
    """Another thread runs in the middle of the call, though the interpreter takes the GIL from nobody."""
    ticks, over, interval = [], threading.Event(), sys.getswitchinterval()

    def tick():
        while not over.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    sys.setswitchinterval(1000)
    ticker = threading.Thread(target=tick)
    ticker.start()
    start = time.perf_counter()
    call()
    took = time.perf_counter() - start
    over.set()
    ticker.join()
    sys.setswitchinterval(interval)
    inside = sum(start + 0.25 * took < t < start + 0.75 * took for t in ticks)
    ok(f"{name} lets go of the GIL", inside > 3, f"{inside} ticks in {took:.3f} s")


large = scene.frame(2400, 1600)
scene.render(large, threads=1)
lets_others_run("render", lambda: [scene.render(large, threads=1) for _ in range(15)])
lets_others_run("fit", lambda: fixsplat.fit("set", steps=200, threads=1).close())

closing, pictures_of = fixsplat.load("knot.ply"), []
thread = threading.Thread(target=lambda: pictures_of.append(closing.render(large, threads=1).colour))
thread.start()
time.sleep(0.02)
closing.close()
thread.join()
ok("closed while it is drawn: the picture is whole, or the scene was closed before", not pictures_of or np.array_equal(
    pictures_of[0], scene.render(large).colour))
closing.close()
refuses("a scene that is closed", ValueError, "the scene is closed", lambda: closing.render(camera))
refuses("a scene that is closed: count", ValueError, "the scene is closed", lambda: closing.count)
with fixsplat.load("knot.ply") as short:
    pass
refuses("behind a with", ValueError, "the scene is closed", lambda: short.box)

with fixsplat.Renderer() as renderer, fixsplat.load("knot.ply") as first:
    table, calls = renderer._table, []
    renderer._table = types.SimpleNamespace(
        render=lambda *request: calls.append("render") or table.render(*request), close=table.close,
        forget=lambda _, kept: calls.append(kept))
    closed = first.memory.scene
    first.render(camera, backend=renderer)
    first.render(camera, backend=renderer)
    first.close()
    scene.render(camera, backend=renderer)
    scene.render(camera, backend=renderer)
    wanted = ["render", "render", closed, "render", "render"]
    ok("a device drops what it keeps of a closed scene, once", calls == wanted, calls)


# A stop function is called during rendering. If it returns true or raises an exception, rendering ends. Otherwise the
# picture is unchanged.
asked = []
whole_picture = scene.render(large, threads=2).colour
same_picture = scene.render(large, threads=2, stop=lambda: asked.append(0)).colour
ok("render: asked to stop", len(asked) > 70 and np.array_equal(whole_picture, same_picture))
refuses("render: stopped", fixsplat.Error, "stopped", lambda: scene.render(large, threads=2, stop=lambda: True))
refuses("render: stop raises", ZeroDivisionError, "", lambda: scene.render(large, threads=2, stop=lambda: 1 / 0))

for what, call in (("load", lambda: fixsplat.load("large.ply", profile="small", threads=1)),
                   ("convert", lambda: fixsplat.convert("large.ply", "x.spz")),
                   ("fit", lambda: fixsplat.fit("set", steps=10**6))):
    refuses(f"{what}: Ctrl-C", KeyboardInterrupt, "^$", lambda: interrupted(call))
    ok(f"{what}: Ctrl-C: its handler is as it was", signal.getsignal(signal.SIGINT) is signal.default_int_handler)

child = os.fork()
if child == 0:
    os._exit(0 if np.array_equal(scene.render(camera).colour, whole.colour) else 1)
deadline = time.monotonic() + 60
while (status := os.waitpid(child, os.WNOHANG)) == (0, 0) and time.monotonic() < deadline:
    time.sleep(0.05)
if status == (0, 0):
    os.kill(child, 9)
ok("behind a fork: the same picture", status == (child, 0), status)

# ---- Leaked files and memory -----------------------------------------------------------------------------------------

def load_and_drop():
    fixsplat.load("knot.ply", threads=2).render(camera)


def refuse_and_drop():
    for options in ({"axes": "rdf"}, {"crop": [[90, 90, 90], [91, 91, 91]]}):
        try:
            fixsplat.convert("knot.ply", "x.fxs", **options)
        except fixsplat.Error:
            pass


def map_and_drop():
    fixsplat.load("saved.fxs").render(camera)


if os.path.exists("/proc/self/statm"):
    grows("100 renders", 100, lambda: scene.render(camera, targets=ALL))
    grows("100 scenes, loaded and drawn", 100, load_and_drop)
    grows("100 scenes, mapped and drawn", 100, map_and_drop)
    grows("200 conversions that are refused", 100, refuse_and_drop)
    grows("100 fits", 100, lambda: fixsplat.fit("set", steps=1, threads=2))
    grows("100 renderers", 100, lambda: fixsplat.Renderer(threads=2).close())
    grows("100 renderers, not closed", 100, lambda: scene.render(camera, backend=fixsplat.Renderer(threads=2)))
    grows("8000 camera files", 8000, lambda: fixsplat.load_cameras("set/sparse/0"))
    ok("threads that ended have no renderers left", threading.active_count() == 1 and
       len(os.listdir("/proc/self/task")) < 40, len(os.listdir("/proc/self/task")))
else:
    print("skip memory that is left: no /proc here")

# ---- Imitated Windows ------------------------------------------------------------------------------------------------

ok("Windows: the library's name", fixsplat._library._names("win32") == ("libfixsplat-1.dll",))
stroke, os.sep = os.sep, "\\"
ok("Windows: paths for C have / between folders", fixsplat._library.file_name("C:\\a\\b/c.ply") == b"C:/a/b/c.ply")
os.sep = stroke
ok("but here \\ is a character of names", fixsplat._library.file_name("a\\b/c.ply") == b"a\\b/c.ply")

# ---- Errors ----------------------------------------------------------------------------------------------------------

K, pose = camera.K, camera.world_to_camera


def changed(array, place, value):
    array = np.array(array, dtype=complex if isinstance(value, complex) else float)
    array[place] = value
    return array


def drawn_with(K=K, pose=pose, width=320, height=200, **options):
    return lambda: scene.render(K, pose, width, height, **options)


for name, kind, words, call in (
        ("K: shape", ValueError, r"^K: expected the shape \(3, 3\), not \(1, 3, 3\)$", drawn_with(K=K[None])),
        ("K: NaN", ValueError, "^K: .*finite", drawn_with(K=changed(K, (0, 0), np.nan))),
        ("K: skew", ValueError, "^K: .*skew", drawn_with(K=changed(K, (0, 1), 1))),
        ("K: text", TypeError, "^K: expected real numbers", drawn_with(K=[["a"] * 3] * 3)),
        ("K: complex", TypeError, "^K: expected real numbers", drawn_with(K=changed(K, (0, 0), 1j))),
        ("K: focal length 0", fixsplat.Error, "focal length", drawn_with(K=changed(K, (0, 0), 0))),
        ("pose: shape", ValueError, r"world_to_camera: expected the shape \(4, 4\), not \(3, 4\)",
         drawn_with(pose=pose[:3])),
        ("pose: infinity", ValueError, "world_to_camera: .*finite", drawn_with(pose=changed(pose, (0, 3), np.inf))),
        ("pose: no rotation", ValueError, "is not a rotation", drawn_with(pose=2 * pose - np.diag([0, 0, 0, 1]))),
        ("pose: mirrored", ValueError, "right-handed", drawn_with(pose=np.diag([-1, 1, 1, 1]) @ pose)),
        ("pose: transposed", ValueError, "last row", drawn_with(pose=pose.T)),
        ("pose: too far", fixsplat.Error, "2\\^27", drawn_with(pose=changed(pose, (0, 3), 1e9))),
        ("width: 0", ValueError, "^width=0: expected 1 to 16384$", drawn_with(width=0)),
        ("width: a float", TypeError, "^width: expected a whole number, not float$", drawn_with(width=320.0)),
        ("height: too large", ValueError, "^height=16385", drawn_with(height=16385)),
        ("no size", TypeError, "expected a Camera, or K", lambda: scene.render(K, pose)),
        ("a Camera and a size", TypeError, "has its own", lambda: scene.render(camera, width=3)),
        ("background: a float", TypeError, "^background: expected a whole number", drawn_with(background=(0.5, 0, 0))),
        ("background: 256", ValueError, "^background=256", drawn_with(background=(0, 0, 256))),
        ("background: two", ValueError, "^background: expected red", drawn_with(background=(0, 0))),
        ("background and alpha", ValueError, "there is none", drawn_with(background=(1, 0, 0), alpha=True)),
        ("cutoff", ValueError, "expected 'mahalanobis' or 'square'", drawn_with(cutoff="round")),
        ("sh_degree", ValueError, "^sh_degree=4", drawn_with(sh_degree=4)),
        ("near", ValueError, "^near=0.0", drawn_with(near=0)),
        ("near: NaN", ValueError, "^near: .*finite", drawn_with(near=float("nan"))),
        ("targets: a word", TypeError, "a sequence of names", drawn_with(targets="colour")),
        ("targets: unknown", ValueError, "expected some of colour", drawn_with(targets=("colour", "color"))),
        ("targets: none", ValueError, "expected some of", drawn_with(targets=())),
        ("backend: unknown", ValueError, "expected one of auto, cpu, gles", drawn_with(backend="metal")),
        ("backend: a number", TypeError, "^backend: expected a name", drawn_with(backend=3)),
        ("device: none such", fixsplat.Error, "there is no device 9", drawn_with(device=9)),
        ("threads: 65", ValueError, "^threads=65", drawn_with(threads=65)),
        ("objects: a scene", TypeError, "a sequence", lambda: fixsplat.render(scene, camera)),
        ("objects: a path", TypeError, "not str", lambda: fixsplat.render(["knot.ply"], camera)),
        ("K: rows of two lengths", ValueError, r"^K: expected the shape \(3, 3\)", drawn_with(K=[[1, 2], [3]])),
        ("background: a number", TypeError, "^background: expected red", drawn_with(background=7)),
        ("object: rotation 0", fixsplat.Error, "rotation",
         lambda: fixsplat.render([fixsplat.Object(scene, rotation=(0, 0, 0, 0))], camera)),
        ("object: rotation, shape", ValueError, r"\(4,\) or \(3, 3\)",
         lambda: fixsplat.render([fixsplat.Object(scene, rotation=(0, 0, 0))], camera)),
        ("object: scale", ValueError, "^scale=0", lambda: fixsplat.render([fixsplat.Object(scene, scale=0)], camera)),
        ("object: tint", fixsplat.Error, "tint",
         lambda: fixsplat.render([fixsplat.Object(scene, tint=(9, 1, 1))], camera)),
        ("object: opacity NaN", ValueError, "^opacity: .*finite",
         lambda: fixsplat.render([fixsplat.Object(scene, opacity=float("nan"))], camera)),
        ("object: nine crops", ValueError, "9 boxes, at most 8", lambda: fixsplat.render(
            [fixsplat.Object(scene, crops=[fixsplat.Crop((0, 0, 0), (1, 1, 1))] * 9)], camera)),
        ("object: a crop turned over", fixsplat.Error, "crop", lambda: fixsplat.render(
            [fixsplat.Object(scene, crops=[fixsplat.Crop((1, 0, 0), (0, 1, 1))])], camera)),
        ("load: no file", fixsplat.Error, "^none.ply: No such file", lambda: fixsplat.load("none.ply")),
        ("load: a number", TypeError, "a path or bytes, not int", lambda: fixsplat.load(3)),
        ("load: a path with a 0", ValueError, "without 0 bytes", lambda: fixsplat.load("a\0b.ply")),
        ("load: no scene", fixsplat.Error, "^bytes: ", lambda: fixsplat.load(b"not a scene at all")),
        ("load: no bytes", fixsplat.Error, "^bytes: ", lambda: fixsplat.load(b"")),
        ("load: cut short", fixsplat.Error, "^bytes: ", lambda: fixsplat.load(read("knot.ply")[:-1])),
        ("load: .fxs cut short", fixsplat.Error, "^bytes: ", lambda: fixsplat.load(read("saved.fxs")[:-1])),
        ("load: .fxs damaged", fixsplat.Error, "^bytes: ",
         lambda: fixsplat.load(read("saved.fxs")[:-1] + bytes([read("saved.fxs")[-1] ^ 1]))),
        ("load: profile", ValueError, "expected 'default' or", lambda: fixsplat.load("knot.ply", profile="tiny")),
        ("load: max_gaussians", fixsplat.Error, "knot.ply: .*3000",
         lambda: fixsplat.load("knot.ply", max_gaussians=2999)),
        ("load: axes", fixsplat.Error, r"axes \(--axes\) are for .spz", lambda: fixsplat.load("knot.ply", axes="rdf")),
        ("load: axes of .fxs", fixsplat.Error, r"axes \(--axes\) are for .spz", lambda: fixsplat.load("saved.fxs", axes="rdf")),
        ("save: ending", ValueError, "ending in one of .fxs, ", lambda: scene.save("x.obj")),
        ("save: no folder", fixsplat.Error, "^none/x.fxs: ", lambda: scene.save("none/x.fxs")),
        ("convert: ending", ValueError, "ending in one of .fxs, ", lambda: fixsplat.convert("knot.ply", "x.obj")),
        ("convert: crop", ValueError, r"crop: expected the shape \(2, 3\)",
         lambda: fixsplat.convert("knot.ply", "x.ply", crop=(1, 2, 3))),
        ("convert: into itself", fixsplat.Error, "knot.ply: is read",
         lambda: fixsplat.convert("knot.ply", "./knot.ply")),
        ("convert: decimate", ValueError, "^decimate=0", lambda: fixsplat.convert("knot.ply", "x.ply", decimate=0)),
        ("convert: sphere", ValueError, "radius", lambda: fixsplat.convert("knot.ply", "x.ply", sphere=(0, 0, 0, -1))),
        ("convert: nothing left", fixsplat.Error, "^knot.ply: none of the 3000",
         lambda: fixsplat.convert("knot.ply", "x.ply", crop=[[90, 90, 90], [91, 91, 91]])),
        ("convert: profile of .ply", ValueError, "is for .fxs",
         lambda: fixsplat.convert("knot.ply", "x.ply", profile="small")),
        ("cameras: no file", fixsplat.Error, "none.json", lambda: fixsplat.load_cameras("none.json")),
        ("from_nerfstudio: shape", ValueError, r"\(3, 4\) or \(4, 4\), not \(3, 3\)",
         lambda: fixsplat.from_nerfstudio(np.eye(3))),
        ("fit: no folder", fixsplat.Error, "none", lambda: fixsplat.fit("none")),
        ("fit: recipe", ValueError, "expected 'reference' or", lambda: fixsplat.fit("set", recipe="best")),
        ("fit: steps", ValueError, "^steps=0", lambda: fixsplat.fit("set", steps=0))):
    refuses(name, kind, words, call)
ok("bad input: nothing is left", not [name for name in os.listdir(".") if name.startswith("x.") or
                                           name.endswith(".tmp")])

for ending in ("ply", "splat", "spz", "sog", "glb", "fxs"):
    with open(f"kept.{ending}", "wb") as file:
        file.write(b"before")

    passes = [0.0]

    def stop(done):
        """In the second of the passes, that which writes."""
        if done < passes[-1]:
            passes.append(done)
        passes[-1] = done
        if len(passes) > 1 and done > 0.3:
            raise KeyboardInterrupt("enough")

    refuses(f"convert to .{ending}: stopped", KeyboardInterrupt, "enough",
            lambda: fixsplat.convert("large.ply", f"kept.{ending}", progress=stop))
    ok(f"convert to .{ending}: stopped: the earlier file", read(f"kept.{ending}") == b"before")
ok("stopped: nothing beside", not [name for name in os.listdir(".") if name.endswith(".tmp")], os.listdir("."))

with fixsplat.load("changed.fxs") as other:
    other.render(camera)
    with open("changed.fxs", "r+b") as file:
        file.seek(4096)
        file.write(b"another")
    refuses("an .fxs file that is written to while it is drawn", fixsplat.Error, "changed.fxs",
            lambda: other.render(camera))

# ---- Fit -------------------------------------------------------------------------------------------------------------

steps = []
with fixsplat.fit("set", steps=60, threads=2, progress=steps.append) as fitted:
    fitted.save("fitted.fxs")
    fitted_count = len(fitted)
run("fit", "set", "--steps", "60", "-o", "command.fxs", "--threads", "1")
ok("fit: the command's file", read("fitted.fxs") == read("command.fxs"))
ok("fit: progress", [p.step for p in steps] == list(range(1, 61)) and steps[-1].steps == 60 and
   steps[-1].gaussians == fitted_count > 400 and np.mean([p.loss for p in steps[-6:]]) < np.mean([p.loss for p in steps[:6]]),
   steps[-1])
options = {"recipe": "mcmc", "steps": 12, "exposure": "gain", "refine_poses": True, "antialiased": True, "sky": 500, "surfaces": True,
           "sh_degree": 1, "max_gaussians": 300, "background": (16, 32, 48), "cutoff": "square", "profile": "small",
           "hold_out": 0, "seed": 3, "resolution": 32, "batch": 2}
fixsplat.fit("set", **options).save("fitted.fxs")
run("fit", "set", "--recipe", "mcmc", "--exposure", "gain", "--refine-poses", "--antialiased", "--sky=500", "--surfaces",
    "--steps", "12", "--sh-degree", "1", "--max-gaussians", "300", "--background", "102030", "--cutoff", "square", "--profile",
    "small", "--hold-out", "0", "--seed", "3", "--resolution", "32", "--batch", "2", "-o", "command.fxs")
ok("fit: all options: the command's file", read("fitted.fxs") == read("command.fxs"))


def enough(progress):
    if progress.step == 3:
        raise StopIteration("three")


# ---- Meshes ----------------------------------------------------------------------------------------------------------

with open("box.obj", "w") as file:
    file.write("v 0 0 0\nv 0 0 2\nv 0 2 0\nv 0 2 2\nv 2 0 0\nv 2 0 2\nv 2 2 0\nv 2 2 2\n"
               "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n")
mesh = fixsplat.Mesh("box.obj")
ok("mesh: arrays", mesh.vertices.shape == (8, 3) and mesh.triangles.shape == (12, 3) and
   mesh.vertices.max() == 2 and mesh.triangles.max() == 7)
ok("mesh: measures", mesh.measure() == fixsplat.MeshMeasures(1, 0, 0, (0, 0, 0), (2, 2, 2), 24, 8))
route = mesh.route((0, 0, 0), (2, 2, 2))
ok("mesh: a way around a box", abs(route.along - 20 ** 0.5) < 1e-9 and abs(route.straight - 12 ** 0.5) < 1e-9 and
   route.points.shape == (3, 3), route)
for name, kind, words, call in (
        ("no mesh", fixsplat.Error, "not a mesh", lambda: fixsplat.Mesh("knot.ply")),
        ("too little memory", fixsplat.Error, "beyond the limit of 64", lambda: fixsplat.Mesh("box.obj", max_memory=64)),
        ("a point", ValueError, "^start: expected three", lambda: mesh.route((0, math.nan, 0), (1, 1, 1)))):
    refuses(f"mesh: {name}", kind, words, call)

# ---- Metrics ---------------------------------------------------------------------------------------------------------

run("render", "knot.ply", "--size", "320x200", "-o", "a.png")
run("render", "knot.ply", "--size", "320x200", "--sh-degree", "0", "-o", "b.png")
said = json.loads(run("compare", "a.png", "b.png", "--json"))
found = fixsplat.compare("a.png", "b.png")
rounded = {"psnr": round(found.psnr, 4), "ssim": round(found.ssim, 6), "largest": found.largest}
ok("compare: the command's figures", said == rounded, (said, rounded))
ok("compare: of pictures and arrays", fixsplat.compare(scene.render(camera), scene.render(
    camera, sh_degree=0).colour[..., :3]) == found)
ok("compare: equal", fixsplat.compare("a.png", "a.png") == fixsplat.Metrics(math.inf, 1, 0, math.inf))
mask = np.arange(200)[:, None] < np.full(320, 100)
ok("compare: a mask ignores the rest", fixsplat.compare(
    "a.png", whole.colour * mask[..., None].astype(np.uint8), mask=mask).psnr == math.inf)
for name, kind, words, call in (
        ("sizes", ValueError, "^a is 320 x 200 pixels, b is 64 x 48$", lambda: fixsplat.compare(
            "a.png", "set/images/00.png")),
        ("no picture", fixsplat.Error, "none.png", lambda: fixsplat.compare("none.png", "a.png")),
        ("floats", ValueError, "^b: expected a file or uint8", lambda: fixsplat.compare("a.png", np.zeros((2, 2, 3)))),
        ("a mask", ValueError, "^mask: expected the shape", lambda: fixsplat.compare("a.png", "b.png", mask=[1])),
        ("an option", TypeError, "hole", lambda: fixsplat.measure(scene, "set", hole=1))):
    refuses(f"compare: {name}", kind, words, call)
os.makedirs("set/masks", exist_ok=True)
fixsplat.Picture(np.where(np.arange(48 * 64).reshape(48, 64, 1) % 1900 > 9, 255, (0, 0, 0, 255)).astype(
    np.uint8)).save("set/masks/00.png")
for label, arguments, given in (("", (), {}), (
        ": options", ("--hold-out", "0", "--background", "102030", "--cutoff", "square", "--resolution", "32"),
        {"hold_out": 0, "background": (16, 32, 48), "cutoff": "square", "resolution": 32})):
    said = json.loads(run("fit", "set", "--measure", "fitted.fxs", "--json", "--quiet", *arguments))["photographs"]
    seen = []
    found = fixsplat.measure("fitted.fxs", "set", each=lambda m, drawn, photograph: seen.append(
        m.affine_psnr == fixsplat.compare(drawn, photograph).affine_psnr or m.name == "00.png"), **given)
    ok(f"measure: each has picture and photograph{label}", seen and all(seen) and len(seen) == len(found.views), seen)
    figures = [(m["name"], m["psnr"], m["affine_psnr"], m["ssim"], m["largest"]) for m in said["views"]]
    ok(f"measure: the command's figures{label}", figures == [(
        m.name, round(m.psnr, 4), round(m.affine_psnr, 4), round(m.ssim, 6), m.largest) for m in found.views], figures)
    means = tuple(said[figure] for figure in ("psnr", "affine_psnr", "ssim"))
    ok(f"measure: the command's means{label}", means == (
        round(found.psnr, 4), round(found.affine_psnr, 4), round(found.ssim, 6)), (means, found))
os.remove("set/masks/00.png")
os.rmdir("set/masks")

refuses("fit: stopped", StopIteration, "three", lambda: fixsplat.fit("set", steps=60, progress=enough))
os.rename("set/images/01.png", "set/images/hidden")
refuses("fit: a photograph is missing", fixsplat.Error, "01.png", lambda: fixsplat.fit("set", steps=1))
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    fixsplat.fit("set", steps=1, skip_bad=True).close()
ok("fit: skip_bad says what is left out", len(said) == 1 and re.search("^left out: .*01.png", str(said[0].message)),
   [str(w.message) for w in said])
os.rename("set/images/hidden", "set/images/01.png")
os.rename("set/sparse/0/points3D.txt", "points")
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    fixsplat.fit("set", steps=1, resolution=16).close()
ok("fit: without points says so", len(said) == 1 and "random" in str(said[0].message), [str(w.message) for w in said])
os.rename("points", "set/sparse/0/points3D.txt")
print("end")
