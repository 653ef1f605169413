# SPDX-License-Identifier: BSD-3-Clause
# Configures and builds a preset of CMakePresets.json with the tools of .venv.
# shellcheck shell=bash

# build_preset PRESET FOLDER [CMAKE OPTION]...: FOLDER is the preset's build folder. A checkout that
# was moved or copied has a cache that speaks of another place: it starts afresh.
build_preset() {
  local preset=$1 folder=$2 fresh=() quiet=()
  shift 2
  if [[ -f $folder/CMakeCache.txt ]] &&
    ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$(pwd -P)" "$folder/CMakeCache.txt"; then
    fresh=(--fresh)
  fi
  say "building $folder ($preset)"
  quietly "cmake" cmake --preset "$preset" "${fresh[@]}" "$@"
  if [[ ! -t 1 ]]; then quiet=(-- --quiet); fi # a progress line only where it can be overwritten
  cmake --build "$folder" "${quiet[@]}" || die "the build in $folder failed"
}

build_dev() {
  build_preset dev build -DPython_EXECUTABLE="$PWD/.venv/bin/python" \
    -Dpybind11_DIR="$(.venv/bin/python -m pybind11 --cmakedir)"
}
