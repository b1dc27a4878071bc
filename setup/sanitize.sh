#!/usr/bin/env bash
# Every test but the slow ones under the sanitizers, then every fuzz target for PLLIT_FUZZ_SECONDS (30).
set -euo pipefail
project_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
bash "$project_root/setup/build.sh" asan all
ctest --test-dir "$project_root/build/asan" --output-on-failure --parallel 2 --label-exclude slow
bash "$project_root/setup/build.sh" fuzz fuzzers
for fuzzer in "$project_root"/build/fuzz/tests/fuzz/fuzz_*; do
  [ -x "$fuzzer" ] && [ -f "$fuzzer" ] || continue
  name=$(basename "$fuzzer")
  printf 'fuzzing %s\n' "$name"
  work=$(mktemp -d) && cd "$work" && mkdir corpus
  "$fuzzer" -max_total_time="${PLLIT_FUZZ_SECONDS:-30}" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
    corpus "$project_root/tests/fuzz/corpus/${name#fuzz_}" >"$work/log" 2>&1 || { tail -n 60 "$work/log"; exit 1; }
  grep -E 'stat::(number_of_executed_units|peak_rss_mb)' "$work/log"
  cd "$project_root" && rm -r "$work"
done
