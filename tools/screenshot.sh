#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes docs/live.png, the picture of the live page in README.md: a simulated wearer, kinemapd and Chromium.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh --tests
cmake --preset release >/dev/null
cmake --build --preset release --target kinemapd kinemap --parallel "${KINEMAP_JOBS:-2}"
node tests/web/screenshot.mjs docs/live.png
