#!/bin/sh
# declarations.sh [-c] HEADER...: prints the declarations of public headers for cffi (Python's interface to C):
# preprocessed, without inline functions, and with an enum for each integer #define. -c: prints a C source file that
# contains the declarations as text. Each #define is read from an appended line "NAME" = NAME; in which the preprocessor
# replaces the unquoted name by its value.
as_c=
[ "$1" != -c ] || { as_c=yes; shift; }
text=$({
    printf '#include "%s"\n' "$@"
    sed -n 's/^#define \(FXS_[A-Z0-9_]*\) .*/"\1" = \1;/p' "$@"
} | ${CC:-cc} -E -std=c99 -DFXS_API= '-DFXS_DEPRECATED(instead)=' -Isrc/include -x c -) || exit 1

declarations() { printf '%s\n' "$text" | awk '
    { sub(/\r$/, "") }                       # removes the carriage return of Windows compilers
    /^#/ { of_headers = $3 ~ /include\/fixsplat\//; of_values = $3 == "\"<stdin>\""; next }
    of_values { values = values $0; next }
    !of_headers || NF == 0 { next }
    /^static inline/ { body = 1 }
    /^typedef char .*\[sizeof/ { size = 1 }    # skips assertions at compile time
    !body && !size { gsub(/__attribute__\(\(format\([^()]*\)\)\)/, ""); print }
    body && (/^}/ || /^static inline.*}/) { body = 0 }   # an inline function of FXS_INIT is one line
    size && /;/ { size = 0 }
    END {
        count = split(values, value, ";")
        for (i = 1; i <= count; i++) {
            $0 = value[i]
            $1 = $1
            if (/^"[A-Z0-9_]*" = [-+*<|() 0-9a-fA-FxuUlL]*$/) {
                gsub(/"/, "")
                print "enum { " $0 " };"
            }
        }
    }'
}

[ "$as_c" ] || { declarations; exit; }
echo '#include <fixsplat/internal/declarations.h>'
echo 'static const char text[] = {'
declarations | od -An -v -tu1 | sed 's/[0-9][0-9]*/&,/g'
echo '0};'
echo 'const char *fxs_declarations(void) { return text; }'
