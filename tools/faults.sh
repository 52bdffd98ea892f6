#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The fault campaign, whole: kinemapd is killed 500 times in the middle of sessions (half an hour). Builds first. Exits with 1 when anything was lost.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh
cmake --preset release
cmake --build --preset release --parallel "${KINEMAP_JOBS:-2}" --target kinemapd kinemap
exec /usr/bin/python3 tests/faults/kill9.py build/release/daemon/kinemapd build/release/tools/kinemap/kinemap --kills 500 --per-session 10
