"""Finds and loads the shared library, calls its functions, and turns their errors into exceptions."""
from __future__ import annotations

import mmap
import operator
import os
import signal
import sys
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Callable, Iterator, Mapping, Optional, Tuple, Union

from cffi import FFI

from ._version import VERSION

PathLike = Union[str, "os.PathLike[str]"]
Struct = Any                                    # a pointer to a C struct, made by cffi


class Error(Exception):
    """An error of the library, with its message of one line.

    code: the constant FXS_ERR_* of fixsplat.h, a negative number.
    bytes_needed: the number of bytes of memory that would be enough, where memory was too small and the number is
    known; 0 otherwise.
    """

    def __init__(self, message: str, code: int, bytes_needed: int = 0):
        super().__init__(message)
        self.code = code
        self.bytes_needed = bytes_needed


# ---- Finding the C library -------------------------------------------------------------------------------------------

def _names(platform: str) -> "tuple[str, ...]":
    """Returns the names of the library's file on a platform (sys.platform), the one that programs look for first."""
    major = VERSION.partition(".")[0]
    if platform == "win32":
        return (f"libfixsplat-{major}.dll",)
    return f"libfixsplat.so.{major}", f"libfixsplat.so.{VERSION}", "libfixsplat.so"


def _found() -> Iterator[str]:
    """Yields the places where the library may be: beside this package, in the build folder of the checkout, and in the
    folders of the system."""
    package = Path(__file__).resolve().parent
    names = _names(sys.platform)
    folders = [package]
    if (package.parents[2] / "src" / "include" / "fixsplat" / "fixsplat.h").exists():
        folders += [package.parents[2] / "build", package.parents[2] / "build" / "windows"]
    for folder in folders:
        for name in names:
            if (folder / name).exists():
                yield str(folder / name)
    yield names[0]


def _load(path: str) -> Any:
    """Loads the library. It states the functions, structs and constants of the headers from which it was built. Raises
    an ImportError where there is no library at this path or its version does not fit."""
    ffi.cdef("int fxs_version(void); const char *fxs_declarations(void);")
    try:
        library: Any = ffi.dlopen(path)
    except OSError as error:
        raise ImportError(f"fixsplat: its library cannot be loaded: {error}; build it (make), install it (make "
                          "install) or name its file in FIXSPLAT_LIBRARY") from None
    try:
        number = library.fxs_version()
    except AttributeError:
        raise ImportError(f"fixsplat: {path} is not {_names(sys.platform)[-1]}") from None
    version = f"{number // 10000}.{number // 100 % 100}.{number % 100}"
    major, minor = (int(part) for part in VERSION.split(".")[:2])
    if number // 10000 != major or number // 100 % 100 < minor:
        raise ImportError(f"fixsplat: {path} is of version {version}, this package is for {VERSION}")
    try:
        ffi.cdef(string(library.fxs_declarations()), override=True)
    except AttributeError as error:
        raise ImportError(f"fixsplat: {path} is of version {version}, but not this package's: {error}") from None
    return library


def string(chars: Any) -> str:
    """Returns the text of a string of C, which ends with a 0."""
    return str(ffi.string(chars), "utf-8", "replace")


ffi: Any = FFI()
NULL = ffi.NULL
PATH = os.environ.get("FIXSPLAT_LIBRARY") or next(_found())
lib = _load(PATH)


# ---- Calling the C library -------------------------------------------------------------------------------------------

def new(kind: str, **fields: Any) -> Any:
    """Returns a pointer to a new struct that has these fields and 0 in the other fields, or to a null pointer. It does
    not keep the memory alive to which the fields point."""
    return ffi.new(f"{kind} *", fields or None)


def sized(kind: str, *arguments: Any, **fields: Any) -> Struct:
    """Returns a pointer to a new struct that begins with its size. It has these fields, and the library's defaults in
    the other fields. arguments: those of the init function of the struct between the struct and the size. It does not
    keep the memory alive to which the fields point."""
    struct = ffi.new(f"{kind} *")
    getattr(lib, f"{kind}_init", lib.fxs_struct_init)(struct, *arguments, ffi.sizeof(kind))
    for name, value in fields.items():
        setattr(struct, name, value)
    return struct


def copy(struct: Struct) -> Struct:
    return ffi.new(ffi.typeof(struct), struct[0])


def release(block: Any) -> None:
    """Frees what a function of the library has allocated by malloc, which on Windows is not that of Python."""
    lib.fxs_release(NULL, block)


def check(result: int, message: Struct, prefix: str = "") -> int:
    """Returns the result of a function of C, or raises an Error with the message if the result is negative."""
    if result >= 0:
        return result
    text = prefix + string(message.text)
    if message.bytes_needed:
        text += f" ({message.bytes_needed} bytes would do)"
    raise Error(text, result, message.bytes_needed)


def call(name: str, *arguments: Any) -> int:
    """Calls a function of C whose last argument is the message. cffi releases the GIL during the call."""
    message = new("fxs_message")
    return check(getattr(lib, name)(*arguments, message), message)


def file_name(path: PathLike) -> bytes:
    """Returns a path as the bytes that C expects, with / between folders. Raises a ValueError for a path with a 0
    byte."""
    name = os.fsencode(os.fspath(path)).replace(os.sep.encode(), b"/")
    if b"\0" in name:
        raise ValueError(f"{name!r}: a path without 0 bytes is expected")
    return name


def choose(name: str, value: str, choices: "Mapping[str, int]") -> int:
    """Returns the number of a word, or raises a ValueError that lists all words."""
    if value not in choices:
        raise ValueError(f"{name}={value!r}: expected {' or '.join(map(repr, choices))}")
    return choices[value]


def whole(name: str, value: Any, low: int, high: int) -> int:
    """Returns a value as an int. It must be a whole number from low to high; otherwise a TypeError or ValueError with
    its name is raised."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: expected a whole number, not {type(value).__name__}") from None
    if not low <= number <= high:
        raise ValueError(f"{name}={number}: expected {low} to {high}")
    return number


def colour(name: str, values: Any) -> "tuple[int, int, int]":
    """Returns a colour as three whole numbers from 0 to 255: red, green, blue."""
    try:
        red, green, blue = values
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name}: expected red, green and blue, not {values!r}") from None
    return whole(name, red, 0, 255), whole(name, green, 0, 255), whole(name, blue, 0, 255)


PROFILES = {"default": lib.FXS_PROFILE_DEFAULT, "compact": lib.FXS_PROFILE_COMPACT, "small": lib.FXS_PROFILE_SMALL}
CUTOFFS = {"mahalanobis": lib.FXS_CUTOFF_MAHALANOBIS, "square": lib.FXS_CUTOFF_SQUARE}


class Calls:
    """Functions of Python that C calls, from any thread. An exception in one of them stops the call of the library, and
    is raised again when the call is over.

    The same holds for an exception of the handler of Ctrl-C. Without this class it would be lost in a function that C
    calls, and C calls such a function even where no `progress` is given.

    progress, stop: structs of C that hold the functions. left_out: a function of C. Each is valid as long as this
    object.
    """

    def __init__(self, progress: "Optional[Callable[[float], object]]" = None,
                 left_out: "Optional[Callable[[str], object]]" = None,
                 stop: "Optional[Callable[[], object]]" = None):
        self._raised: Optional[BaseException] = None
        self._handler: Any = None
        self.left_out = ffi.callback("fxs_left_out_fn *", lambda _, why: self._tell(left_out, string(why)))
        self._progress = ffi.callback("fxs_progress_fn *", lambda _, done: self._call(progress, done))
        self._stop = ffi.callback("fxs_stop_fn *", lambda _: self._ask(stop))
        self.progress, self.stop = new("fxs_progress", call=self._progress), new("fxs_stop", call=self._stop)

    def source(self, fill: "Callable[[int, Any, int], None]") -> Any:
        """Returns a function of C that gives n Gaussians from number `first` on: `fill(first, out, n)` writes them."""
        return ffi.callback("long(void *, uint64_t, fxs_gaussian *, size_t)", lambda _, first, out, n:
                            lib.FXS_ERR_STOPPED if self._call(fill, first, out, n) else n, lib.FXS_ERR_STOPPED)

    def _call(self, function: "Optional[Callable[..., object]]", *values: Any) -> int:
        try:
            if function is not None and self._raised is None:
                function(*values)
        except BaseException as raised:
            self._raised = raised
        return int(self._raised is not None)

    def _tell(self, function: "Optional[Callable[[str], object]]", what: str) -> None:
        self._call(function, what)

    def _ask(self, function: "Optional[Callable[[], object]]") -> int:
        answers: "list[object]" = []
        return self._call(lambda: answers.append(function and function())) or int(any(answers))

    def heard(self) -> None:
        """Raises the exception that a function raised in the meantime, if there is one."""
        raised, self._raised = self._raised, None
        if raised is not None:
            raise raised from None

    def __enter__(self) -> "Calls":
        handler: Any = signal.getsignal(signal.SIGINT)
        if callable(handler):
            try:
                signal.signal(signal.SIGINT, lambda number, frame: self._call(handler, number, frame))
                self._handler = handler
            except ValueError:
                pass                        # only the main thread of the main interpreter may handle signals
        return self

    def __exit__(self, *_: object) -> None:
        if self._handler is not None:
            signal.signal(signal.SIGINT, self._handler)
        self.heard()


_signals: "Optional[tuple[int, mmap.mmap]]" = None


def _signal_memory() -> "tuple[int, mmap.mmap]":
    """Returns memory that is a file too, with the descriptor of the file."""
    global _signals
    if _signals is None:
        file = os.memfd_create("fixsplat")
        os.truncate(file, mmap.PAGESIZE)
        os.set_blocking(file, False)
        _signals = file, mmap.mmap(file, mmap.PAGESIZE)
    return _signals


@contextmanager
def signals() -> "Iterator[Any]":
    """Yields a byte that is not 0 from the moment at which a signal arrives. Handlers of signals wait until the call of
    C is over, but the interpreter writes the numbers of signals to a file at once, without the GIL. Yields NULL on
    threads that get no signals, and on systems without memory that is a file."""
    if not hasattr(os, "memfd_create"):
        yield NULL
        return
    file, memory = _signal_memory()
    try:
        earlier = signal.set_wakeup_fd(file, warn_on_full_buffer=False)
    except ValueError:
        yield NULL
        return
    try:
        os.lseek(file, 0, os.SEEK_SET)
        memory[0] = 0
        yield ffi.from_buffer(memory)
    finally:
        signal.set_wakeup_fd(earlier)
        if memory[0] and earlier != -1:
            os.write(earlier, memory[:os.lseek(file, 0, os.SEEK_CUR)])


@contextmanager
def workers(threads: int) -> "Iterator[Struct]":
    """Makes a pool of threads, and yields it as an fxs_workers. 0 threads stand for one thread on each processor."""
    threads = whole("threads", threads, 0, 64) or lib.fxs_processors()
    made = lib.fxs_pool_create(threads)
    try:
        yield new("fxs_workers", run=lib.fxs_pool_run, pool=made, count=threads) if made else new("fxs_workers")
    finally:
        lib.fxs_pool_destroy(made)


@contextmanager
def context(threads: int) -> "Iterator[Tuple[Struct, Struct]]":
    """Yields an fxs_context with the fastest stages, and its fxs_workers of so many threads."""
    with workers(threads) as made:
        kernels, ready = new("fxs_kernels"), new("fxs_context")
        lib.fxs_kernels_choose(kernels, 2**32 - 1)
        check(lib.fxs_context_init(ready, sized("fxs_config", workers=made[0], kernels=kernels)), new("fxs_message"))
        yield ready, made
