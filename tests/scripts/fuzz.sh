#!/bin/sh
# The readers, fuzzed for a moment.
exec sh tests/fuzz.sh 5
