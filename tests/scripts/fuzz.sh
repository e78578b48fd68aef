#!/bin/sh
# Runs each fuzz target for one second, or for five seconds with FXS_PROCESSORS=all.
exec sh tests/fuzz.sh "$([ "$FXS_PROCESSORS" = all ] && echo 5 || echo 1)"
