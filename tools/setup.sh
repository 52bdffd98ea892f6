#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what Kinemap is built from, what is missing of it and nothing else: Debian 12 packages with apt-get, and the npm packages of the live
# page into daemon/web/node_modules. With --tests also what only the tests need: Chromium and their npm packages.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tests=no
case ${1-} in
  --tests) tests=yes ;;
  "") ;;
  *) echo "usage: tools/setup.sh [--tests]" >&2; exit 2 ;;
esac

packages=(
  g++ cmake ninja-build ccache git ca-certificates pkg-config # build
  libeigen3-dev libboost-dev libceres-dev libopenblas-dev     # mathematics, Asio, Beast, Lockfree
  libspdlog-dev nlohmann-json3-dev libcli11-dev libexpat1-dev zlib1g-dev # log, JSON, command line, XML, gzip
  libjemalloc-dev                                             # kinemapd's memory
  libsystemd-dev                                              # readiness, watchdog
  dpkg-dev file                                               # the Debian package
  libssl-dev libqrencode-dev                                  # TLS, pairing
  libgtest-dev libgmock-dev libbenchmark-dev                  # tests
  python3-jsonschema                                          # the map's schema is tested with it
)
# Any Node.js from 18 on will do, wherever it came from.
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)
if [[ $tests == yes ]]; then
  packages+=(
    chromium                                                # the live page is tested in it
    libsdformat-dev librsvg2-bin python3-pil python3-yaml   # exports are read with them
    groff-base                                              # the manual pages are
    clang libclang-rt-14-dev                                # libFuzzer
    mmdebstrap systemd-container lintian                    # the package is installed, booted and looked at
  )
  # promtool reads /metrics. Its package starts a server where systemd runs, which is not ours to do.
  [[ -d /run/systemd/system ]] || packages+=(prometheus)
fi

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "setup.sh: this is no Debian; install what stands for these packages: ${packages[*]}" >&2
  exit 1
fi

install_packages() {
  local missing=() package status
  for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [[ $status == installed ]] || missing+=("$package")
  done
  if ((${#missing[@]} == 0)); then
    echo "setup: all ${#packages[@]} packages are there"
    return
  fi
  local as_root=()
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "setup.sh: these packages are missing and there is no sudo; as root: apt-get install ${missing[*]}" >&2
      exit 1
    fi
    as_root=(sudo)
  fi
  echo "setup: installing ${missing[*]}"
  local install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends -qq "${missing[@]}")
  # Package lists may be missing (a bare system) or old: then fetch them, once.
  if ! "${install[@]}" >/dev/null 2>&1; then
    "${as_root[@]}" apt-get update -qq
    "${install[@]}" >/dev/null
  fi
}

# npm_packages FOLDER all|build: exactly what FOLDER/package-lock.json says, unless it is there already; `build` leaves out what only tests need.
npm_packages() {
  local folder=$1 what=$2 mark=$1/node_modules/.installed lock
  lock=$(sha256sum <"$folder/package-lock.json")
  if [[ -f $mark ]] && { [[ $(<"$mark") == "all $lock" ]] || [[ $(<"$mark") == "$what $lock" ]]; }; then
    return
  fi
  echo "setup: npm packages of $folder"
  local options=(--no-audit --no-fund --ignore-scripts --loglevel=error)
  [[ $what == all ]] || options+=(--omit=dev)
  if ! (cd "$folder" && npm ci "${options[@]}" >/dev/null); then
    echo "setup.sh: npm could not install what $folder/package-lock.json names; is the npm registry within reach?" >&2
    exit 1
  fi
  echo "$what $lock" >"$mark"
}

install_packages
if [[ $tests == yes ]]; then
  npm_packages daemon/web all
  npm_packages tests/web all
  npm_packages tests/export all
  npm_packages tests/foxglove all
else
  npm_packages daemon/web build
fi
echo "setup: done"
