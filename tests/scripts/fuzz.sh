#!/bin/sh
# Each target, fuzzed for a moment.
exec sh tests/fuzz.sh 3
