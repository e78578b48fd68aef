#!/usr/bin/env python3
"""tsog.py IN.sog OUT.tsog SECONDS [AUDIO [NAME=FILE]]: makes a moving scene of a .sog of version 2. Centre times are the
Gaussians' x, deviations their y. AUDIO is the JSON of the member audio; FILE becomes the entry NAME.
tsog.py OUT.wav SECONDS: makes a sound of 8000 samples a second, a tone of 440 Hz."""
import json
import math
import struct
import sys
import wave
import zipfile


def make_tone(path, seconds):
    with wave.open(path, "wb") as out:
        out.setparams((1, 2, 8000, 0, "NONE", ""))
        samples = (int(8000 * math.sin(2 * math.pi * 440 * i / 8000)) for i in range(int(8000 * seconds)))
        out.writeframes(b"".join(struct.pack("<h", sample) for sample in samples))


def make_scene(source, path, seconds, audio=None, entry=None):
    with zipfile.ZipFile(source) as sog:
        files = {name: sog.read(name) for name in sog.namelist()}
    meta = json.loads(files["meta.json"])
    low, high = meta["means"]["files"]
    files["times_l.webp"], files["times_u.webp"] = files[low], files[high]
    meta.update(version=4, profile={"id": "org.opsiclear.tsog-playback", "version": 1},
                timeline={"type": 1, "mins": [0, 0.2], "maxs": [1, 0.6], "files": ["times_l.webp", "times_u.webp"]},
                playback={"duration": float(seconds)})
    if audio:
        meta["audio"] = json.loads(audio)
    if entry:
        name, sound = entry.split("=")
        with open(sound, "rb") as file:
            files[name] = file.read()
    files["meta.json"] = json.dumps(meta).encode()
    with zipfile.ZipFile(path, "w") as tsog:
        for name, data in files.items():
            tsog.writestr(name, data)


if sys.argv[1].endswith(".wav"):
    make_tone(sys.argv[1], float(sys.argv[2]))
else:
    make_scene(*sys.argv[1:])
