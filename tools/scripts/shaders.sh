#!/bin/sh
# shaders.sh FILE...: prints the text of shaders as C character arrays, without comments, indentation and spaces around
# operators. Shaders of kernels/gles are built around src/include/fixsplat/internal/pixel.h.
for file; do
    echo "static const char $(basename "$file" | tr . _)[] = {"
    sed -e ':more' -e '/\/\*/{/\*\//!{N' -e 'b more' -e '}' -e 's|/\*.*\*/||' -e '}' -e 's|//.*||' \
        -e 's/^ *//' -e 's/ *$//' -e '/^$/d' -e '/^#/!s/ \{0,1\}\([,=+*&|?:<>]\) /\1/g' "$file" |
        od -An -v -tu1 | sed 's/[0-9][0-9]*/&,/g'
    echo '0};'
done
