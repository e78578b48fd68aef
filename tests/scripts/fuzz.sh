#!/bin/sh
# Fuzzes each target for a moment.
exec sh tests/fuzz.sh "$([ "$FXS_PROCESSORS" = all ] && echo 5 || echo 1)"
