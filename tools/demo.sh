#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A first map without a suit: sets up, builds, starts kinemapd, lets a simulated wearer walk round over real UDP and shows what was found.
#   tools/demo.sh [--seed N] [--speed X] [--drift good|default|bad] [--keep]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
  cat <<'TEXT'
tools/demo.sh [--seed N] [--speed X] [--drift good|default|bad] [--keep]

  --seed N    which building and wearer (default 7)
  --speed X   times real time (default 8: a five-minute session takes 40 s; 1 is as it would be)
  --drift D   how bad the suit is (default: default)
  --keep      leave the daemon running when done, so that you can look at the map in a browser; Ctrl-C ends it
TEXT
}

seed=7 speed=8 drift=default keep=no
while (($#)); do
  case $1 in
    --seed | --speed | --drift)
      (($# > 1)) || { echo "demo.sh: $1 needs a value" >&2; exit 2; }
      declare "${1#--}=$2"
      shift 2
      ;;
    --keep) keep=yes; shift ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
done

tools/setup.sh
echo "demo: building (the first time takes some minutes)"
cmake --preset release >/dev/null
cmake --build --preset release --target kinemapd kinemap --parallel "${KINEMAP_JOBS:-2}"
kinemap=build/release/tools/kinemap/kinemap
kinemapd=build/release/daemon/kinemapd

# The usual ports when they are free, others when not.
read -r suit_port api_port < <(python3 - <<'PYTHON'
import socket

def port(kind, address, wanted):
    for candidate in (wanted, 0):
        with socket.socket(socket.AF_INET, kind) as probe:
            try:
                probe.bind((address, candidate))
                return probe.getsockname()[1]
            except OSError:
                continue
    raise SystemExit("demo.sh: no free port")

print(port(socket.SOCK_DGRAM, "127.0.0.1", 9763), port(socket.SOCK_STREAM, "127.0.0.1", 8765))
PYTHON
)
api=127.0.0.1:$api_port

work=$(mktemp -d)
daemon=
cleanup() {
  trap - EXIT INT TERM
  if [[ -n $daemon ]] && kill -0 "$daemon" 2>/dev/null; then
    kill "$daemon" 2>/dev/null || true
    wait "$daemon" 2>/dev/null || true
  fi
  rm -rf "$work"
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

cat >"$work/config.json" <<JSON
{"suit": {"address": "127.0.0.1", "port": $suit_port}, "api": {"port": $api_port}}
JSON
"$kinemapd" --config "$work/config.json" >"$work/log" 2>&1 &
daemon=$!
for ((i = 0; i < 100; i++)); do
  "$kinemap" status --url "http://$api" >/dev/null 2>&1 && break
  if ! kill -0 "$daemon" 2>/dev/null || ((i == 99)); then
    echo "demo.sh: kinemapd did not start:" >&2
    cat "$work/log" >&2
    exit 1
  fi
  sleep 0.1
done
echo "demo: kinemapd listens to the suit on UDP port $suit_port; the map is at http://$api/"

echo "demo: a simulated wearer walks round, $speed times real time"
"$kinemap" sim --seed "$seed" --drift "$drift" --udp "127.0.0.1:$suit_port" --speed "$speed"

# The last gestures may still be on their way through the solver: wait until the map has been still for a second.
revision() { "$kinemap" map --url "http://$api" --json 2>/dev/null | python3 -c 'import json, sys; print(json.load(sys.stdin)["revision"])'; }
before=none
for ((i = 0; i < 30; i++)); do
  now=$(revision)
  [[ $now == "$before" ]] && break
  before=$now
  sleep 1
done

echo
"$kinemap" map --url "http://$api"
echo
if [[ $keep == yes ]]; then
  echo "The map: http://$api/    kinemap status --url http://$api    Ctrl-C ends the daemon"
  wait "$daemon"
else
  echo "The map was at http://$api/ (with --keep the daemon goes on and you can look at it)"
fi
