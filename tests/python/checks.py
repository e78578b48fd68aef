"""What the checks of the Python package share. The command is the first argument of the program."""
import gc
import os
import re
import signal
import subprocess
import sys
import threading

import numpy as np

signal.signal(signal.SIGINT, signal.default_int_handler)    # a shell's background jobs start with SIGINT ignored


def ok(name, condition, why=""):
    print(f"ok {name}" if condition else f"FAIL {name}: {str(why) or 'not so'}", flush=True)


def same(name, a, b):
    ok(name, a.dtype == b.dtype and a.shape == b.shape and np.array_equal(a, b),
       f"{a.dtype} {a.shape}, {b.dtype} {b.shape}, {(a != b).sum() if a.shape == b.shape else 'all'} differ")


def refuses(name, kind, words, call):
    """The exception, of that very class, with these words (a regular expression) in one line."""
    try:
        result = call()
    except BaseException as error:
        ok(name, type(error) is kind and re.search(words, str(error)) and "\n" not in str(error),
           f"{type(error).__name__}: {error}")
    else:
        ok(name, False, f"gave {result}")


def run(*arguments):
    done = subprocess.run([sys.argv[1], *arguments], capture_output=True, text=True)
    if done.returncode:
        print(f"FAIL fixsplat {' '.join(arguments)}: {done.stderr}")
    return done.stdout


def hash_of(picture):
    """FNV-1a 64, as the command prints it."""
    value = 0xcbf29ce484222325
    for byte in picture.colour.tobytes():
        value = (value ^ byte) * 0x100000001b3 & 2**64 - 1
    return f"{value:016x}"


def read(path):
    with open(path, "rb") as file:
        return file.read()


def interrupted(call):
    """Called, and Ctrl-C after a tenth of a second."""
    timer = threading.Timer(0.1, lambda: signal.pthread_kill(threading.main_thread().ident, signal.SIGINT))
    timer.start()
    try:
        call()
    finally:
        timer.cancel()


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def grows(label, count, what):
    """Less than a tenth of what it would be if each call left its picture or scene behind."""
    for _ in range(10):
        what()
    gc.collect()
    first = resident()
    for _ in range(count):
        what()
    gc.collect()
    more = resident() - first
    ok(f"{label}: no memory is left", more < 2000000, f"{more} bytes")
