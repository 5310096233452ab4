#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# usage: installed_test.sh BUILD/airtruth.deb
# Looks at the Debian package of a build folder (lintian, and the files of an installation), installs it, makes a demo and an
# example's sequence with the installed files, and removes the package.
# As root, and where airtruth is not installed already, this is done to the system; else to a folder in its place.
set -euo pipefail
[ $# = 1 ] || { echo "usage: installed_test.sh BUILD/airtruth.deb" >&2; exit 2; }
deb=$(realpath "$1")
place=$(mktemp -d)
installed=""

remove() {
  if [ -n "$installed" ]; then apt-get purge -q -y airtruth >"$place/purge.log" 2>&1; fi
  installed=""
}
trap 'remove; rm -rf "$place"' EXIT

fail() { echo "installed_test: $*" >&2; exit 1; }

cmake --install "$(dirname "$deb")" --prefix "$place/build/usr" >"$place/files.log" || { cat "$place/files.log"; fail "cmake --install"; }
dpkg-deb -x "$deb" "$place/packed"
for folder in build packed; do
  (cd "$place/$folder/usr" && find . \( -type f -o -type l \) | sort) >"$place/$folder.files"
done
diff "$place/build.files" "$place/packed.files" || fail "the package holds other files than an installation"
diff -r "$place/build/usr/share" "$place/packed/usr/share" || fail "a file of the package differs from an installation's"
looked="not looked at by lintian, which is not installed"
if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error,warning "$deb" 2>"$place/lintian.log" || fail "lintian has errors"
  looked="lintian finds neither error nor warning"
fi

if [ "$(id -u)" = 0 ] && ! dpkg -s airtruth >/dev/null 2>&1; then
  installed=yes
  DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "$deb" >"$place/install.log" 2>&1 ||
    { cat "$place/install.log"; fail "the package cannot be installed"; }
  prefix=/usr
else
  dpkg -x "$deb" "$place/root"
  prefix=$place/root/usr
  libraries=("$prefix"/lib/*-linux-gnu)
  export LD_LIBRARY_PATH=${libraries[0]}
fi
airtruth=$prefix/bin/airtruth
export XDG_CACHE_HOME=$place/cache

wanted=$(dpkg-deb -f "$deb" Version)
"$airtruth" --version | grep -qF "airtruth ${wanted%-*}" || fail "expected version ${wanted%-*}, found $("$airtruth" --version)"

"$airtruth" demo --out "$place/demo" --frames 12 >"$place/demo.log" 2>&1 || { cat "$place/demo.log"; fail "demo"; }
[ "$(wc -l <"$place/demo/demo/truth.jsonl")" -ge 12 ] || fail "demo: too few frames of truth"

"$airtruth" synth -o "$place/clip.mkv" --width 160 --height 120 --frames 6 --no-own-aircraft >/dev/null
cat >"$place/scene.toml" <<'SCENE'
name = "one"
[background]
video = "clip.mkv"
[lens]
vertical_fov_deg = 60
[camera]
position_ned_m = [0, 0, -150]
[motion]
model = "none"
[[intruder]]
aircraft = "c172/news"
waypoints_ned_m = [[60, -8, -150], [60, 8, -150]]
speed_mps = 40
SCENE
"$airtruth" render "$place/scene.toml" --out "$place" --no-cache >"$place/render.log" 2>&1 || { cat "$place/render.log"; fail "render"; }
[ -s "$place/one/one.mp4" ] || fail "render: no video"

printf 'v 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n' >"$place/a.obj"
"$airtruth" aircraft show "$place/a.obj" >"$place/shown" || fail "the installed program reads no model file"
grep -q '2 triangles' "$place/shown" || fail "the installed program reads a model file wrongly: $(cat "$place/shown")"

"$airtruth" detect "$place/one/one.mp4" -o "$place/found" >"$place/detect.log" 2>&1 || { cat "$place/detect.log"; fail "detect"; }
[ -s "$place/found/network/one.json" ] || fail "detect: the network that ships gave no results"

if [ -z "$installed" ] && ! /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
  echo "installed_test: the Python package was not tried, for want of python3-numpy"
else
  PYTHONPATH=$prefix/lib/python3/dist-packages PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c 'import sys, airtruth
assert airtruth.DataSet(sys.argv[1])["one"].frame(5).rgb.shape == (120, 160, 3)' "$place/one" || fail "import airtruth"
fi

for scene in "$prefix"/share/airtruth/examples/*.toml "$prefix"/share/airtruth/catalogues/*.toml; do
  [ -s "$scene" ] || fail "there is no $scene"
done

if [ -n "$installed" ]; then
  remove
  [ ! -e "$airtruth" ] || fail "$airtruth is left after the removal"
  left=$(find /usr/share/airtruth /usr/libexec/airtruth /usr/lib/cmake /usr/include/airtruth -path '*airtruth*' 2>/dev/null || true)
  [ -z "$left" ] || fail "left after the removal: $left"
fi
echo "installed_test: the package was installed, tried and removed; $looked"
