# SPDX-License-Identifier: BSD-3-Clause
# The source archive, and whether it is whole.
# shellcheck shell=bash

# make_sdist FOLDER: builds sepcal-VERSION.tar.gz into FOLDER, as `python -m build --sdist` would.
make_sdist() {
  quietly "the source archive" .venv/bin/python -c \
    'import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])' "$1"
}

# same_sdist FILE FOLDER: made again, in FOLDER, it is the same to the byte.
same_sdist() {
  (umask 077 && make_sdist "$2")
  cmp "$1" "$2/$(basename "$1")" || die "$(basename "$1") is another when it is made again"
}

# configure_sdist FILE FOLDER: unpacks it in FOLDER and configures all that there is, as someone without
# git and without this checkout; ninja's dry run then finds each file that a target is made of.
configure_sdist() {
  local python=$PWD/.venv/bin/python source pybind11
  pybind11=$("$python" -m pybind11 --cmakedir)
  mkdir -p "$2"
  tar -xzf "$1" -C "$2"
  source=$2/$(basename "$1" .tar.gz)
  quietly "the source archive's cmake" env GIT_DIR=/nonexistent \
    cmake -S "$source" -B "$2/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSEPCAL_BUILD_PYTHON=ON \
    -DSEPCAL_BUILD_TESTS=ON -DSEPCAL_BUILD_EXAMPLES=ON -DPython_EXECUTABLE="$python" -Dpybind11_DIR="$pybind11"
  quietly "the source archive's dry run" cmake --build "$2/build" -- -n
}
