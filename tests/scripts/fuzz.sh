#!/bin/sh
# Fuzzes each target for one second, or five with FXS_PROCESSORS=all.
exec sh tests/fuzz.sh "$([ "$FXS_PROCESSORS" = all ] && echo 5 || echo 1)"
