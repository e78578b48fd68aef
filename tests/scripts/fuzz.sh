#!/bin/sh
# Each target, fuzzed for a moment.
exec sh tests/fuzz.sh "$([ "$FXS_PROCESSORS" = all ] && echo 5 || echo 1)"
