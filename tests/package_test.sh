#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs airtruth into an empty folder and uses it as a stranger would: compiles every header by itself, looks at what the
# libraries export and need, builds the examples against them and compares what they print with the program's own files, asks every
# command for help, renders every manual page, completes words. installed_test.sh has the Debian package.
set -euo pipefail
build=$1
source=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

fail() { echo "package_test: $*" >&2; exit 1; }

check_examples() { # check_examples PREFIX: built against the package, they print what the program's own files hold
  cmake -S "$source/examples/cpp" -B "$place/build" -G Ninja -DCMAKE_PREFIX_PATH="$1" \
    -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Werror" >"$place/configure.log" || { cat "$place/configure.log"; exit 1; }
  cmake --build "$place/build" >"$place/build.log" || { cat "$place/build.log"; exit 1; }
  env -u AIRTRUTH_MODEL_READER XDG_CACHE_HOME="$place/cache" \
    python3 "$source/tests/library_examples_test.py" "$1/bin/airtruth" "$place/build" || fail "the examples are wrong"
}

check_documented_build() { # check_documented_build PREFIX: the lines of docs/library.md build a program
  rm -rf "$place/mine"
  mkdir "$place/mine"
  awk '/^## Build/ { on = 1 } on && /^    / { sub(/^    /, ""); print; seen = 1 } seen && /^$/ { exit }' \
    "$source/docs/library.md" >"$place/mine/CMakeLists.txt"
  cat >"$place/mine/mine.cpp" <<'END'
#include <airtruth/metrics.h>
int main() { return airtruth::evaluation::overlap({100, 100, 20, 10}, {105, 100, 20, 10}) == 0.6 ? 0 : 1; }
END
  { cmake -S "$place/mine" -B "$place/mine/build" -G Ninja -DCMAKE_PREFIX_PATH="$1" && cmake --build "$place/mine/build"; } \
    >"$place/mine.log" 2>&1 || { cat "$place/mine.log"; fail "the lines of docs/library.md do not build"; }
  "$place/mine/build/mine" || fail "the program of docs/library.md gives a wrong overlap"
}

# find_package(airtruth) with these words finds exactly these targets; "fails" where it must not find the package.
expect_targets() { # expect_targets PREFIX WORDS TARGETS
  rm -rf "$place/find"
  mkdir "$place/find"
  cat >"$place/find/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.25)
project(find LANGUAGES CXX)
find_package(airtruth $2)
foreach(target IN ITEMS evaluation airtruth)
  if(TARGET airtruth::\${target})
    message(STATUS "target \${target}")
  endif()
endforeach()
END
  local got
  got=$(cmake -S "$place/find" -B "$place/find/build" -G Ninja -DCMAKE_PREFIX_PATH="$1" 2>/dev/null || echo "target fails")
  got=$(sed -n 's/.*target //p' <<<"$got" | paste -sd' ')
  [ "$got" = "$3" ] || fail "find_package(airtruth $2) gives '$got'; expected '$3'"
}

check_components() { # check_components PREFIX
  expect_targets "$1" "REQUIRED" "evaluation airtruth"
  expect_targets "$1" "REQUIRED COMPONENTS evaluation" "evaluation"
  expect_targets "$1" "REQUIRED COMPONENTS airtruth" "airtruth"
  expect_targets "$1" "REQUIRED COMPONENTS no_such" "fails"
  expect_targets "$1" "$version REQUIRED COMPONENTS evaluation" "evaluation"
  # Before 1.0 another minor version may differ in everything.
  expect_targets "$1" "99.0 REQUIRED" "fails"
  expect_targets "$1" "${version%%.*}.0.1 REQUIRED" "fails"
}

# The component evaluation alone: its library is found and its examples' headers are there, and nothing of the rest.
check_evaluation_alone() {
  local light=$place/light
  cmake --install "$build" --component evaluation --prefix "$light" >"$place/light.log"
  expect_targets "$light" "REQUIRED" "evaluation"
  expect_targets "$light" "REQUIRED COMPONENTS evaluation" "evaluation"
  expect_targets "$light" "REQUIRED COMPONENTS airtruth" "fails"
  if [ -e "$light/bin" ] || [ -e "$light/include/airtruth/renderer.h" ]; then fail "the component evaluation installs more"; fi
  # check_headers compiles them; here each one that they include has to be there.
  local header
  while read -r header; do
    [ -f "$light/include/airtruth/$header" ] || fail "a header of the component evaluation includes $header of the other one"
  done < <(sed -nE 's/^#include <airtruth\/([a-z_]+\.h)>.*/\1/p' "$light"/include/airtruth/*.h | sort -u)
}

# The public headers and nothing else are installed, and each compiles by itself with the standard library alone.
check_headers() { # check_headers PREFIX
  (cd "$1/include" && find . -type f | sort) >"$place/headers"
  { (cd "$source/include" && find . -name '*.h'); echo ./airtruth/version.h; } | sort >"$place/wanted"
  diff "$place/wanted" "$place/headers" || fail "include/ holds other files than the public headers"
  local header
  while read -r header; do
    echo "#include <${header#./}>" | g++ -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I "$1/include" -x c++ - ||
      fail "$header does not compile by itself"
  done <"$place/headers"
  grep -rhE '^ *# *include' "$1/include" | grep -vE '<(airtruth/)?[a-z_]+(\.h)?>$' && fail "a public header includes something private"
  grep -q "kVersion = \"$version\"" "$1/include/airtruth/version.h" || fail "version.h has another version"
}

# Every exported function is declared in a public header, and so is every class whose functions are.
check_exports() { # check_exports LIBRARY
  nm -DC --defined-only "$1" | sed 's/^[0-9a-f]* . //' >"$place/exports"
  [ "$(wc -l <"$place/exports")" -gt 20 ] || fail "$1 exports next to nothing"
  local name
  while read -r name; do
    grep -rqwF -e "$name" "$place/usr/include" || fail "$1 exports $name, which no public header declares"
  done < <(sed -E 's/^(typeinfo|vtable|typeinfo name) for //; s/\[abi:[^]]*\]//g; s/\(.*//; s/.*:://; s/^~//' "$place/exports" | sort -u)
  grep -vE '^((typeinfo|vtable|typeinfo name) for )?airtruth::' "$place/exports" && fail "$1 exports names of others"
  return 0
}

check_libraries() { # check_libraries PREFIX
  local library folder needed
  local -r soversion=$(sed -E 's/^0\.([0-9]+).*/0.\1/; t; s/\..*//' <<<"$version")
  folder=$(dirname "$(find "$1" -name libairtruth.so)")
  for library in "$folder/libairtruth.so" "$folder/libairtruth-evaluation.so"; do
    check_exports "$library"
    readelf -d "$library" | grep -q "SONAME.*\[$(basename "$library").$soversion\]" || fail "$library has another SONAME than $soversion"
  done
  needed=$(ldd "$folder/libairtruth-evaluation.so" | grep -iE 'osg|openthreads|embree|opencv|libav|libsw|png|jpeg|libE?GL|tbb|assimp' || true)
  [ -z "$needed" ] || fail "libairtruth-evaluation.so needs $needed"
}

commands_below() { # commands_below PROGRAM [GROUP]: the names that its help lists
  "$@" --help | sed -n '/^Subcommands:$/,$s/^  \([a-z][a-z-]*\)  .*/\1/p'
}

check_help_and_pages() { # check_help_and_pages PREFIX
  local program=$1/bin/airtruth pages=$1/share/man/man1 count=0 command below page complaint
  "$program" --version | grep -q '^airtruth ' || fail "--version"
  local -a paths=("")
  for command in $(commands_below "$program"); do
    paths+=("$command")
    for below in $(commands_below "$program" "$command"); do paths+=("$command $below"); done
  done
  [ ${#paths[@]} -gt 20 ] || fail "--help lists ${#paths[@]} commands"
  for command in "${paths[@]}"; do
    # shellcheck disable=SC2086 # a path is words
    "$program" $command --help >"$place/help" 2>"$place/complaint" || fail "$command --help fails"
    if [ ! -s "$place/help" ] || [ -s "$place/complaint" ]; then fail "$command --help: $(cat "$place/complaint")"; fi
    page=$pages/airtruth${command:+-${command// /-}}.1.gz
    [ -f "$page" ] || fail "there is no $page"
    count=$((count + 1))
    # Every option of the help is on the page.
    grep -oE '^  (-[a-zA-Z],)?--[a-z0-9-]+' "$place/help" | grep -oE -- '--[a-z0-9-]+' | sort -u >"$place/options"
    zcat "$page" | sed 's/\\-/-/g' | grep -oE -- '--[a-z0-9-]+' | sort -u >"$place/on_page"
    complaint=$(comm -23 "$place/options" "$place/on_page")
    [ -z "$complaint" ] || fail "$page lacks $complaint"
    if command -v man >/dev/null; then
      complaint=$(MANWIDTH=80 LC_ALL=C.UTF-8 man --warnings -l "$page" 2>&1 >"$place/shown")
      [ -z "$complaint" ] || fail "$page: $complaint"
      grep -q 'SYNOPSIS' "$place/shown" || fail "$page shows nothing"
    fi
    if command -v mandoc >/dev/null; then
      complaint=$(zcat "$page" | mandoc -T lint -W error || true)
      [ -z "$complaint" ] || fail "$page: $complaint"
    fi
  done
  [ "$(find "$pages" -name 'airtruth*' | wc -l)" = "$count" ] || fail "there are pages of no command"
}

# completed PREFIX WORD...: what the last word can become
completed() {
  bash -c 'set -eu
    . "$1/share/bash-completion/completions/airtruth"
    shift
    COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=()
    _airtruth
    printf "%s\n" "${COMPREPLY[@]}"' bash "$@"
}

expect_completion() { # expect_completion WANTED PREFIX WORD...
  local wanted=$1 got
  shift
  got=$(completed "$@" | sort | paste -sd' ')
  [ "$got" = "$wanted" ] || fail "completing '${*:2}': '$got'; expected '$wanted'"
}

check_completion() { # check_completion PREFIX
  expect_completion "render" "$1" airtruth ren
  expect_completion "build" "$1" airtruth dataset bu
  expect_completion "build" "$1" airtruth --quiet dataset bu
  expect_completion "estimate" "$1" airtruth lens e
  expect_completion "--zoom" "$1" airtruth inspect --z
  expect_completion "--array-size" "$1" airtruth dataset submit --arr
  expect_completion "auto homography rotation" "$1" airtruth motion clip.mp4 --model ''
  expect_completion "--json-log" "$1" airtruth evaluate --js
  touch "$place/scene one.toml"
  expect_completion "$place/scene one.toml" "$1" airtruth render "$place/sce"
  # All that the help lists, no more.
  expect_completion "$(commands_below "$1/bin/airtruth" | sort | paste -sd' ')" "$1" airtruth ''
}

check_files() { # check_files PREFIX
  local file
  for file in doc/airtruth/copyright doc/airtruth/changelog.gz doc/airtruth/changelog.Debian.gz doc/airtruth/README.md \
    doc/airtruth/CITATION.cff doc/airtruth/docs/formats/scene.md airtruth/catalogues/quickstart.toml airtruth/examples/render.toml \
    airtruth/clients/airtruth_trax.py airtruth/clients/airtruth_detector.py airtruth/data/real-aircraft/README.md bash-completion/completions/airtruth; do
    [ -s "$1/share/$file" ] || fail "share/$file is not installed"
  done
  for file in "$source"/docs/formats/*.schema.json; do
    cmp -s "$file" "$1/share/airtruth/schemas/$(basename "$file")" || fail "$(basename "$file") is not installed"
  done
  zcat "$1/share/doc/airtruth/changelog.Debian.gz" | head -1 | grep -q "^airtruth ($version-1) " || fail "the changelog's version"
}

check_model_reader() { # check_model_reader PREFIX: a model file is read by the helper that stands beside the program
  [ -x "$1/libexec/airtruth/airtruth-model-reader" ] || fail "airtruth-model-reader is not installed"
  printf 'v 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n' >"$place/a.obj"
  env -u AIRTRUTH_MODEL_READER XDG_CACHE_HOME="$1/../cache" "$1/bin/airtruth" aircraft show "$place/a.obj" >"$place/shown" ||
    fail "the installed program reads no model file"
  grep -q '2 triangles' "$place/shown" || fail "the installed program reads a model file wrongly: $(cat "$place/shown")"
}

check_network_runner() { # check_network_runner PREFIX: a network is given to the helper, which refuses this one
  printf 'no network' >"$place/a.onnx"
  printf '%s' '{"format": "airtruth detector model 1", "input": {"layout": "grey", "fit": "frame"}, "classes": ["aircraft"],
    "output": {"kind": "yolov5", "boxes": "output"}}' >"$place/a.json"
  env -u AIRTRUTH_NETWORK_RUNNER "$1/bin/airtruth" detect "$place" --detector "onnx:$place/a.onnx" -o "$place/found" 2>"$place/said" &&
    fail "the installed program takes a text for a network"
  grep -q 'cannot be loaded as an ONNX network: it is no ONNX file' "$place/said" || fail "the installed program runs no network: $(cat "$place/said")"
}

check_late_libraries() { # check_late_libraries PREFIX: the program starts without what only some commands need, and finds it then
  local needed
  needed=$(readelf -d "$1/bin/airtruth" | grep NEEDED | grep -E 'osg|libE?GL|opencv_(calib3d|dnn|ml|tracking|video)' || true)
  [ -z "$needed" ] || fail "the program needs at its start: $needed"
  "$1/bin/airtruth" synth -o "$place/clip.mkv" --width 160 --height 120 --frames 6 --no-own-aircraft >/dev/null
  printf '%s\n' 'name = "late"' '[background]' 'video = "clip.mkv"' '[lens]' 'vertical_fov_deg = 60' '[camera]' \
    'position_ned_m = [0, 0, -150]' '[[intruder]]' 'aircraft = "c172/news"' 'waypoints_ned_m = [[60, -8, -150], [60, 8, -150]]' \
    'speed_mps = 40' '[composite]' 'method = "chroma-key"' >"$place/late.toml"
  env -u AIRTRUTH_LATE_OPENCV -u AIRTRUTH_LATE_BACKDROP "$1/bin/airtruth" render "$place/late.toml" --out "$place" --no-cache --gpu none \
    >"$place/late.log" 2>&1 || fail "the installed program measures no motion or draws no backdrop: $(cat "$place/late.log")"
}

check_python() { # check_python PREFIX, after check_late_libraries: the package is imported and reads a set, and finds its libraries by itself
  local packages=$1/lib/python3/dist-packages
  local -r set=$(mktemp -d -p "$place")
  if [ ! -d "$packages/airtruth" ]; then
    grep -q '^AIRTRUTH_PYTHON:BOOL=ON' "$build/CMakeCache.txt" && /usr/bin/python3 -c 'import sysconfig, os; exit(not os.path.exists(
      sysconfig.get_path("include") + "/Python.h"))' && [ -d /usr/include/pybind11 ] && fail "the Python package is not installed"
    echo "package_test: no Python package, for want of pybind11-dev or python3-dev"
    return 0
  fi
  sed '/composite/,$d' "$place/late.toml" >"$place/python.toml"
  "$1/bin/airtruth" render "$place/python.toml" --out "$set" --no-cache >"$place/python.log" 2>&1 || fail "the set for Python"
  env -u LD_LIBRARY_PATH -u AIRTRUTH_MODEL_READER PYTHONPATH="$packages" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c 'import sys, airtruth
folder, scene, packages = sys.argv[1:]
assert airtruth.__file__.startswith(packages), airtruth.__file__
read = airtruth.DataSet(folder)["late"].frame(3)
made = [frame for frame in airtruth.render(scene, cache=False) if frame.index == 3]
assert (read.intruders[0].covered_box == made[0].intruders[0].covered_box).all() and read.rgb.shape == (120, 160, 3)
' "$set" "$place/python.toml" "$packages" || fail "the installed Python package does not read the set"
}

version=$(sed -n 's/^project(airtruth VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")
cmake --install "$build" --prefix "$place/usr" >"$place/install.log"
check_headers "$place/usr"
check_libraries "$place/usr"
check_components "$place/usr"
check_documented_build "$place/usr"
check_evaluation_alone
check_examples "$place/usr"
check_model_reader "$place/usr"
check_network_runner "$place/usr"
check_late_libraries "$place/usr"
check_python "$place/usr"
check_help_and_pages "$place/usr"
check_completion "$place/usr"
check_files "$place/usr"

# The same program writes the same pages.
"$place/usr/bin/airtruth" describe "$place/again"
gzip -9n "$place/again/man1"/*
diff -r "$place/again/man1" "$place/usr/share/man/man1" >/dev/null || fail "the pages differ from run to run"

echo "installed, found by find_package, examples built and checked"
