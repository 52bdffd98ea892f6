#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The fault campaign, whole (an hour; docs/reliability.md has its table). Builds first. Exits with 1 when anything was lost, wrong or left out.
# tools/faults.sh kill9 damage …: only these.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

kinemapd=build/release/daemon/kinemapd
kinemap=build/release/tools/kinemap/kinemap

kill9() { /usr/bin/python3 tests/faults/kill9.py "$kinemapd" "$kinemap" --kills 500 --per-session 10; }
damage() { build/release/tests/faults/journal_damage; }
full_disk() { /usr/bin/python3 tests/faults/full_disk.py "$kinemapd" "$kinemap" --times 40; } # needs root, for a tmpfs
suit() { /usr/bin/python3 tests/faults/suit.py "$kinemap" --seeds 3 4; }
clients() { /usr/bin/python3 tests/faults/stuck_clients.py "$kinemapd" "$kinemap" --seconds 600; }
rebuild() { /usr/bin/python3 tests/faults/rebuild.py "$kinemapd" "$kinemap"; }

tools/setup.sh
cmake --preset release
cmake --build --preset release --parallel "${KINEMAP_JOBS:-2}" --target kinemapd kinemap journal_damage
failed=
for campaign in "${@:-kill9 damage full_disk rebuild clients suit}"; do
  for one in $campaign; do
    echo "== $one"
    "$one" || failed+=" $one"
  done
done
[[ -z $failed ]] || { echo "failed:$failed"; exit 1; }
