#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes build/kinemap_VERSION_ARCH.deb and prints its name. The same sources give the same package: times are those of the last commit
# (SOURCE_DATE_EPOCH). With --check it is built twice from nothing, in two folders of different depth, and compared (10 min).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}

# package SOURCE TO [cpack's options]
package() {
  local source=$1 to=$2
  shift 2
  cmake -S "$source" -B "$source/build/release" -G Ninja -DCMAKE_BUILD_TYPE=Release "${configure[@]}" >/dev/null
  cmake --build "$source/build/release" --parallel "${KINEMAP_JOBS:-2}" --target kinemapd kinemap kinemap_pages kinemap_changelog >&2
  cpack --config "$source/build/release/CPackConfig.cmake" -B "$to" "$@" | tee /dev/stderr | sed -n 's/^CPack: - package: \(.*\) generated\.$/\1/p'
  rm -rf "$to/_CPack_Packages"
}

check() {
  local twice=()
  room=$(mktemp -d) # not local: the trap runs when the function is over
  trap 'rm -rf "$room"' EXIT
  export CCACHE_DISABLE=1
  for source in "$room/a" "$room/some/where/else"; do
    mkdir -p "$source"
    git ls-files -z --cached | xargs -0 cp --parents -t "$source"
    cp -r daemon/web/node_modules "$source/daemon/web/"
    twice+=("$(package "$source" "$source.packages")")
  done
  sha256sum "${twice[@]}"
  if ! cmp "${twice[@]}"; then
    echo "FAILED: two builds of the same sources gave different packages (diffoscope ${twice[*]} says where)" >&2
    trap - EXIT
    exit 1
  fi
  echo "reproducible: both builds gave the same package"
}

tools/setup.sh >&2
configure=()
case ${1-} in
  --check) configure=(-DBUILD_TESTING=OFF) && check ;;
  --release) package . build -D "CPACK_DEBIAN_PACKAGE_RELEASE=$2" ;;
  "") package . build ;;
  *) echo "usage: tools/package.sh [--check | --release N]" >&2; exit 2 ;;
esac
