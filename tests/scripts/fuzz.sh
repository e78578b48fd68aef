#!/bin/sh
# Fuzzes each target for one second; FXS_PROCESSORS=all: five.
exec sh tests/fuzz.sh "$([ "$FXS_PROCESSORS" = all ] && echo 5 || echo 1)"
