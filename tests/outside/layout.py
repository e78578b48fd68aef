"""layout.py LIBRARY [DECLARATIONS]: what programs have of the headers in them, as the shared library declares it, or as a
file does, a line each: how many bytes a struct has; where in it a member is, and its type; the value of a constant; what
a function takes and returns."""
import sys

from cffi import FFI

ffi = FFI()
ffi.cdef("const char *fxs_declarations(void);")
library = ffi.dlopen(sys.argv[1])
if len(sys.argv) > 2:
    with open(sys.argv[2]) as file:
        text = file.read()
else:
    text = ffi.string(library.fxs_declarations()).decode()
ffi.cdef(text, override=True)


def lines():
    for name in ffi.list_types()[0]:
        pointer = ffi.typeof(f"{name} *")
        kind = pointer if pointer.kind == "function" else pointer.item
        if kind.kind == "function":
            yield f"{name} {kind.cname}"
        elif kind.kind == "struct" and kind.fields is not None:    # an opaque struct has no fields
            yield f"{name} {ffi.sizeof(kind)} bytes"
            for member, field in kind.fields:
                yield f"{name}.{member} {field.offset} {field.type.cname}"
    for name in dir(library):
        try:
            value = getattr(library, name)
        except NotImplementedError:                                # a library variable, whose struct is listed already
            continue
        if not name.startswith("FXS_VERSION"):
            yield f"{name} {value if isinstance(value, int) else ffi.typeof(value).cname}"


print(*lines(), sep="\n")
