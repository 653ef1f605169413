# SPDX-License-Identifier: BSD-3-Clause
# Configures and builds the presets of CMakePresets.json with the tools of .venv.
# shellcheck shell=bash

# An object is the same in any build folder and checkout.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1

# configure PRESET FOLDER [CMAKE OPTION]...: FOLDER is the preset's build folder. A checkout that
# was moved or copied has a cache that speaks of another place: it starts afresh.
configure() {
  local preset=$1 folder=$2 fresh=()
  shift 2
  if [[ -f $folder/CMakeCache.txt ]] &&
    ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$(pwd -P)" "$folder/CMakeCache.txt"; then
    fresh=(--fresh)
  fi
  say "building $folder ($preset)"
  quietly "cmake" cmake --preset "$preset" -B "$folder" "${fresh[@]}" "$@"
}

# configure_with_python PRESET FOLDER: for .venv's Python and the pybind11 there.
configure_with_python() {
  configure "$@" -DPython_EXECUTABLE="$PWD/.venv/bin/python" \
    -Dpybind11_DIR="$(.venv/bin/python -m pybind11 --cmakedir)"
}

# build FOLDER [TARGET]...: these targets, or everything.
build() {
  local folder=$1 targets=() quiet=()
  shift
  if (($# > 0)); then targets=(--target "$@"); fi
  if [[ ! -t 1 ]]; then quiet=(-- --quiet); fi # a progress line only where it can be overwritten
  cmake --build "$folder" "${targets[@]}" "${quiet[@]}" || die "the build in $folder failed"
}

build_dev() {
  configure_with_python dev build
  build build
}

# The apps and the Python module alone. A build folder that has the tests keeps them for later.
build_demo() {
  configure_with_python demo build
  build build sepcal-pitot sepcal-mag _core
}
