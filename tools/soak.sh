#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The soak: four hours of stream at 20 times real time (12 minutes) into kinemapd. Builds first. Options go to tests/faults/soak.py.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh
cmake --preset release
cmake --build --preset release --parallel "${KINEMAP_JOBS:-2}" --target kinemapd kinemap
exec /usr/bin/python3 tests/faults/soak.py build/release/daemon/kinemapd build/release/tools/kinemap/kinemap "$@"
