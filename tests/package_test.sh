#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs airtruth into an empty folder and builds the example against it, as a user of the library would.
set -euo pipefail
build=$1
source=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cmake --install "$build" --prefix "$place/usr" >"$place/install.log"
cmake -S "$source/examples/cpp" -B "$place/build" -G Ninja -DCMAKE_PREFIX_PATH="$place/usr" >"$place/configure.log" ||
  { cat "$place/configure.log"; exit 1; }
cmake --build "$place/build" >"$place/build.log" || { cat "$place/build.log"; exit 1; }
"$place/build/range" | grep -q ' m  .* px for 11 m'
LD_LIBRARY_PATH="$place/usr/lib" "$place/usr/bin/airtruth" --version | grep -q '^airtruth '
echo "installed, found by find_package, built, run"
