#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs every fuzz target (tests/fuzz) with libFuzzer for SECONDS, default 60, or the ones that are named: tools/fuzz.sh 60 http journal. Needs clang
# and its runtime (Debian: clang libclang-rt-14-dev); 77: skipped, since they are missing. What is found is kept in build/fuzz/found.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
shift || true
if ! command -v clang++ >/dev/null; then
  echo "SKIPPED: tools/fuzz.sh: clang++ is missing (apt-get install clang libclang-rt-14-dev)" >&2
  exit 77
fi
targets=("$@")
((${#targets[@]})) || targets=(datagrams pcap mvnx config http websocket journal)

tools/setup.sh >/dev/null
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --parallel "${KINEMAP_JOBS:-2}" --target fuzz_seeds_made "${targets[@]/#/fuzz_}"

built=$PWD/build/fuzz/tests/fuzz
found=$PWD/build/fuzz/found
mkdir -p "$found"
failed=0
for target in "${targets[@]}"; do
  grown=$PWD/build/fuzz/corpus/$target # goes on from run to run
  folders=("$grown")
  mkdir -p "$grown"
  for folder in "tests/fuzz/corpus/$target" "$built/seeds/$target"; do
    [[ -d $folder ]] && folders+=("$folder")
  done
  log=$found/$target.log
  if "$built/fuzz_$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -max_len=65536 -print_final_stats=1 \
    -artifact_prefix="$found/$target-" "${folders[@]}" >"$log" 2>&1; then
    echo "ok      $target: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs in $seconds s," \
      "$(grep -oE 'cov: [0-9]+' "$log" | tail -n 1 || true) branches"
  else
    echo "FAILED  $target: $(grep -m 1 -E 'ERROR|SUMMARY|runtime error' "$log" || tail -n 1 "$log"); see $log"
    failed=$((failed + 1))
  fi
done
exit $((failed > 0))
