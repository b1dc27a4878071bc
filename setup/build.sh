#!/usr/bin/env bash
# build.sh PRESET TARGET [-- COMMAND ARG...]   configures and builds one preset inside the environment, then runs COMMAND.
# TARGET all: with the tests and benchmarks, whose packages any other target does without.
set -euo pipefail
project_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
preset=$1 target=$2
shift 2
[ "${1:-}" = -- ] && shift

build() (
  build_dir=$project_root/build/$preset
  cd "$project_root"
  mkdir -p build
  exec {lock}>"build/$preset.lock"
  flock "$lock" # two calls at once must not build in the same folder
  local tests=OFF
  [ "$target" = all ] && tests=ON
  if [ ! -f "$build_dir/build.ninja" ] || { [ $tests = ON ] && ! grep -q '^PLLIT_TESTS:BOOL=ON' "$build_dir/CMakeCache.txt"; }; then
    printf 'pllit: configuring and building preset %s (the first time takes minutes)\n' "$preset" >&2
    cmake --preset "$preset" -D PLLIT_TESTS=$tests >&2
  fi
  # Ninja says nothing when there is nothing to do; its own progress line shows when there is.
  if [ -t 2 ]; then ninja -C "$build_dir" "$target" >&2; else ninja -C "$build_dir" --quiet "$target" >&2; fi
)
build || { printf 'pllit: the build failed; the compiler messages are above.\n' >&2; exit 1; }
[ $# -eq 0 ] || exec "$@"
