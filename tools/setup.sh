#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs with apt-get the Debian 12 packages that Kinemap is built from and tested with, those that are missing, and nothing else.
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache git ca-certificates pkg-config # build
  libeigen3-dev libboost-dev libceres-dev libopenblas-dev     # mathematics, Asio, Beast, Lockfree
  libspdlog-dev nlohmann-json3-dev libcli11-dev libexpat1-dev # log, JSON, command line, XML
  libsystemd-dev                                              # readiness, watchdog
  libgtest-dev libgmock-dev libbenchmark-dev                  # tests
  python3-jsonschema                                          # the map's schema is tested with it
)

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "setup.sh: this is no Debian; install what stands for these packages: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "setup: all ${#packages[@]} packages are there"
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "setup.sh: these packages are missing and there is no sudo; as root: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "setup: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends -qq "${missing[@]}")
# Package lists may be missing (a bare system) or old: then fetch them, once.
if ! "${install[@]}" >/dev/null 2>&1; then
  "${as_root[@]}" apt-get update -qq
  "${install[@]}" >/dev/null
fi
echo "setup: done"
