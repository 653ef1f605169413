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

# The jobs that the processors and the memory take, with 2.5 GB for each.
count_jobs() {
  local kilobytes jobs
  kilobytes=$(awk '$1 == "MemAvailable:" { print $2 }' /proc/meminfo)
  jobs=$((kilobytes / 2500000))
  echo $((jobs < 1 ? 1 : jobs < $(nproc) ? jobs : $(nproc)))
}

# Ninja's output with a line for each tenth of the steps in place of a line a step.
say_tenths() {
  local line percent tenths=0
  while IFS= read -r line; do
    if [[ $line =~ ^step\ +([0-9]+)% ]]; then
      percent=${BASH_REMATCH[1]}
      if ((percent / 10 > tenths)); then
        tenths=$((percent / 10))
        say "$1: $((tenths * 10)) %"
      fi
    else
      printf '%s\n' "$line"
    fi
  done
}

# build FOLDER [TARGET]...: these targets, or everything.
build() {
  local folder=$1 command=(cmake --build "$1" --parallel "$(count_jobs)")
  shift
  if (($# > 0)); then command+=(--target "$@"); fi
  if [[ -t 1 ]]; then
    "${command[@]}" || die "the build in $folder failed"
  else # no progress line where it can't be overwritten
    NINJA_STATUS='step %p ' "${command[@]}" | say_tenths "$folder" || die "the build in $folder failed"
  fi
}

# build_dev WHICH: everything, with all C++ tests, the short or the long ones, or none.
build_dev() {
  configure_with_python dev build -DSEPCAL_TESTS="$1"
  build build
}

# The apps and the Python module alone. A build folder that has the tests keeps them for later.
build_demo() {
  configure_with_python demo build
  if [[ ! -f build/apps/sepcal ]]; then # 23 minutes of a processor were measured
    say "compiling takes about $((24 / $(count_jobs))) minutes with $(count_jobs) jobs, less where the compiler cache knows files"
  fi
  build build sepcal_program sepcal-pitot sepcal-mag _core
}
