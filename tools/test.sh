#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Sets up, builds and runs every test; in the release build also the package on a system of its own (tools/test-system.sh) and the fuzz targets
# (tools/fuzz.sh). KINEMAP_PRESET=asan, tsan or debug for another build than release; KINEMAP_JOBS compilers and tests at a time (default 2);
# KINEMAP_FUZZ_SECONDS for each fuzz target (default 60; 0 leaves them out).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${KINEMAP_PRESET:-release}
jobs=${KINEMAP_JOBS:-2}

tools/setup.sh --tests
cmake --preset "$preset"
cmake --build --preset "$preset" --parallel "$jobs"

# JUnit's file has the counts whatever ctest prints; skipped tests are those that GoogleTest skipped, case by case.
results=$PWD/build/$preset/test-results.xml
log=$PWD/build/$preset/test.log
code=0
ctest --preset "$preset" --parallel "$jobs" --timeout 600 --output-junit "$results" --output-log "$log" \
  --test-output-size-passed 10000000 --test-output-size-failed 10000000 || code=$?
# The scripts that print a line for each of their tests, and what they ended with.
scripts=()
run_script() {
  local name=$1 log=$PWD/build/$1.log ended=0
  shift
  "$@" 2>&1 | tee "$log" || ended=$?
  ((ended == 0 || ended == 77)) || code=1
  scripts+=("$name" "$ended" "$log")
}
if [[ $preset == release ]]; then
  run_script system-test tools/test-system.sh
  if ((${KINEMAP_FUZZ_SECONDS:=60} > 0)); then
    run_script fuzz tools/fuzz.sh "$KINEMAP_FUZZ_SECONDS"
  else
    run_script fuzz bash -c 'echo "SKIPPED: tools/fuzz.sh: KINEMAP_FUZZ_SECONDS is 0"; exit 77'
  fi
fi
python3 - "$results" "${scripts[@]}" <<'PYTHON'
import re
import sys
import xml.etree.ElementTree as ElementTree

passed = failed = skipped = 0
for case in ElementTree.parse(sys.argv[1]).getroot().iter("testcase"):
    output = case.findtext("system-out") or ""
    # A GoogleTest program counts as its cases; anything else, and a program that could not be run or died, as one test.
    cases = re.search(r"^\[=+\] (\d+) tests? from .* ran\.", output, re.MULTILINE)
    if not cases:
        left_out = case.find("skipped")
        said_so = left_out is not None and "SKIP_RETURN_CODE" in left_out.get("message", "")
        passed += case.get("status") == "run"
        skipped += case.get("status") == "disabled" or said_so
        failed += case.get("status") == "fail" or (case.get("status") == "notrun" and not said_so)
        if said_so:
            print(case.get("name"), output)
        continue
    bad = re.search(r"^ *(\d+) FAILED TESTS?$", output, re.MULTILINE)
    left_out = re.search(r"^\[  SKIPPED \] (\d+) tests?, listed below:", output, re.MULTILINE)
    n_bad = int(bad.group(1)) if bad else int(case.get("status") == "fail")
    n_skipped = int(left_out.group(1)) if left_out else 0
    for line in re.findall(r"^.*Skipped\n.*$", output, re.MULTILINE):
        print(line)
    passed += int(cases.group(1)) - n_bad - n_skipped
    failed += n_bad
    skipped += n_skipped
for name, ended, path in zip(*[iter(sys.argv[2:])] * 3):
    with open(path, encoding="utf-8") as log:
        text = log.read()
    if ended == "77":
        print(f"SKIPPED: {name}:", text.strip().rpartition("\n")[2].removeprefix("SKIPPED: "))
        skipped += 1
        continue
    steps = re.findall(r"^(ok|FAILED) ", text, re.MULTILINE)
    passed += steps.count("ok")
    failed += max(steps.count("FAILED"), int(ended != "0"))
print(f"{passed} passed, {failed} failed, {skipped} skipped")
PYTHON
exit "$code"
