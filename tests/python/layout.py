"""layout.py print: a C program that prints size, offsets and kinds of what _declarations.py has, and constants.
layout.py compare FILE: what that program printed, against ctypes."""
import ctypes
import sys

from fixsplat import _declarations as declarations

KINDS = {ctypes.c_float: "f4", ctypes.c_double: "f8", ctypes.c_char: "c1", ctypes.c_uint8: "u1", ctypes.c_int: "i4",
         ctypes.c_uint: "u4", ctypes.c_int32: "i4", ctypes.c_uint32: "u4", ctypes.c_int64: "i8", ctypes.c_uint64: "u8",
         ctypes.c_size_t: f"u{ctypes.sizeof(ctypes.c_size_t)}", ctypes.c_ssize_t: f"i{ctypes.sizeof(ctypes.c_size_t)}"}
HEADERS = ["fixsplat", "packed", "backend", "backends", "camera", "camera_file", "fit", "photos", "message", "image_file",
           "pack", "map", "pool", "fxs_file", "scene_decimate", "scene_file", "scene_filter", "scene_write", "world"]
PROGRAM = """#include <stdio.h>
#define KIND(x) _Generic((x), float: "f4", double: "f8", char: "c1", unsigned char: "u1", int: "i4", \\
                         unsigned: "u4", long: sizeof(long) == 8 ? "i8" : "i4", \\
                         unsigned long: sizeof(long) == 8 ? "u8" : "u4", long long: "i8", unsigned long long: "u8", \\
                         default: "other")
int main(void)
{
"""


def structs():
    """(name, class) of every struct, in the order of the file."""
    return [(name, value) for name, value in vars(declarations).items() if name.startswith("fxs_")
            and isinstance(value, type) and hasattr(value, "_fields_")]


def constants():
    return [(name, value) for name, value in vars(declarations).items() if name.startswith("FXS_")]


def kind_of(field):
    """The kind of a number, or of an array's numbers."""
    is_array = isinstance(field, type) and issubclass(field, ctypes.Array)
    return KINDS.get(field._type_ if is_array else field, "other"), is_array


def print_program():
    for header in HEADERS:
        print(f'#include <fixsplat/{header}.h>')
    print(PROGRAM)
    for name, value in structs():
        print(f'    printf("{name} %zu\\n", sizeof({name}));')
        for field, kind in value._fields_:
            member = f"(({name} *)0)->{field}"
            first = f"{member}[0]" if kind_of(kind)[1] else member
            print(f'    printf("{name}.{field} %zu %zu %s\\n", offsetof({name}, {field}), sizeof({member}), '
                  f"KIND({first}));")
    for name, _ in constants():
        print(f'    printf("{name} %lld\\n", (long long){name});')
    for name in declarations.FUNCTIONS:
        print(f"    (void)&{name};")
    print("    return 0;\n}")


def expected():
    for name, value in structs():
        yield f"{name} {ctypes.sizeof(value)}"
        for field, kind in value._fields_:
            place = getattr(value, field)
            yield f"{name}.{field} {place.offset} {place.size} {kind_of(kind)[0]}"
    for name, value in constants():
        yield f"{name} {value}"


if sys.argv[1] == "print":
    print_program()
else:
    with open(sys.argv[2]) as file:
        said = file.read().splitlines()
    wanted = list(expected())
    wrong = [f"C has {a}, Python {b}" for a, b in zip(said, wanted) if a != b]
    if wrong or len(said) != len(wanted):
        sys.exit("; ".join(wrong) or f"{len(said)} lines, {len(wanted)} expected")
