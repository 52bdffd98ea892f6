#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs every fuzz target (tests/fuzz) with libFuzzer for SECONDS, default 60, or the ones that are named: tools/fuzz.sh 60 http journal. KINEMAP_JOBS
# of them at a time (default 2). Needs clang and its runtime (tools/setup.sh --tests); 77: skipped, since they are missing. What is found is kept in
# build/fuzz/found.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
shift || true
if ! command -v clang++ >/dev/null || [[ ! -e $(clang++ -print-runtime-dir)/libclang_rt.fuzzer-$(uname -m).a ]]; then
  echo "SKIPPED: tools/fuzz.sh: clang++ or its libFuzzer is missing; tools/setup.sh --tests gets it" >&2
  exit 77
fi
jobs=${KINEMAP_JOBS:-2}
targets=("$@")
((${#targets[@]})) || targets=(datagrams pcap mvnx config http websocket journal)

tools/setup.sh >/dev/null
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --parallel "$jobs" --target fuzz_seeds_made "${targets[@]/#/fuzz_}"

built=$PWD/build/fuzz/tests/fuzz
found=$PWD/build/fuzz/found
mkdir -p "$found"

run_target() {
  local target=$1 folder grown=$PWD/build/fuzz/corpus/$1 log=$found/$1.log # the corpus goes on from run to run
  local folders=("$grown")
  mkdir -p "$grown"
  for folder in "tests/fuzz/corpus/$target" "$built/seeds/$target"; do
    [[ ! -d $folder ]] || folders+=("$folder")
  done
  if "$built/fuzz_$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -max_len=65536 -print_final_stats=1 \
    -artifact_prefix="$found/$target-" "${folders[@]}" >"$log" 2>&1; then
    echo "ok      fuzz $target: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs in $seconds s," \
      "$(grep -oE 'cov: [0-9]+' "$log" | tail -n 1 | cut -c 6-) branches"
  else
    echo "FAILED  fuzz $target: $(grep -m 1 -E 'ERROR|SUMMARY|runtime error' "$log" || tail -n 1 "$log"); see $log"
    return 1
  fi
}

failed=0
for target in "${targets[@]}"; do
  while (($(jobs -pr | wc -l) >= jobs)); do wait -n || failed=1; done
  run_target "$target" &
done
while [[ $(jobs -p) ]]; do wait -n || failed=1; done
exit "$failed"
