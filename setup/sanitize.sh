#!/usr/bin/env bash
# One build under the address and undefined-behaviour sanitizers, in which ctest runs the tests of every part, but not those
# of whole sequences, which would take an hour (cmake -DPLLIT_WHOLE_RUNS=ON adds them), and each fuzz target for half a
# minute. A finding ends its process with a code that no test expects.
set -euo pipefail
project_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
export ASAN_OPTIONS=exitcode=99 LSAN_OPTIONS=exitcode=99 UBSAN_OPTIONS=exitcode=99:print_stacktrace=1
exec bash "$project_root/setup/build.sh" asan all -- \
  ctest --test-dir "$project_root/build/asan" --output-on-failure --parallel 2
