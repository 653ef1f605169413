# SPDX-License-Identifier: BSD-3-Clause
# The virtual environment .venv: Python and the packages of scripts/requirements*.txt. The stamp inside
# it tells whose it is and what it was made for.
# shellcheck shell=bash

stamp=.venv/made-by-sepcal-setup

# True where a Python is 3.11 or newer and has venv, pip and Python.h.
python_will_do() {
  "$1" - 2>/dev/null <<'PY'
import ensurepip, pathlib, sys, sysconfig, venv
header = pathlib.Path(sysconfig.get_path("include"), "Python.h")
sys.exit(not (sys.version_info >= (3, 11) and header.is_file()))
PY
}

# Prints the first Python that will do: $SEPCAL_PYTHON if set, else the system's before all others.
choose_python() {
  local candidate
  if [[ -n ${SEPCAL_PYTHON:-} ]]; then
    python_will_do "$SEPCAL_PYTHON" ||
      die "SEPCAL_PYTHON=$SEPCAL_PYTHON is not a Python >= 3.11 with venv, pip and Python.h"
    printf '%s\n' "$SEPCAL_PYTHON"
    return
  fi
  for candidate in /usr/bin/python3 python3.{14,13,12,11} python3; do
    if python_will_do "$candidate"; then
      command -v "$candidate"
      return
    fi
  done
  die "no Python >= 3.11 with venv, pip and Python.h (Debian: python3-venv, python3-dev);" \
    "SEPCAL_PYTHON=/path/to/python3 names one"
}

# venv_for PYTHON FILE...: what the stamp says of a .venv for these requirements, here.
venv_for() {
  local python=$1
  shift
  { cat "$@" && "$python" -VV && pwd -P; } | sha256sum
}

# True where .venv is there and its stamp is $1.
venv_is() { [[ -x .venv/bin/python && -f $stamp && $(<"$stamp") == "$1" ]]; }

# make_tools FOLDER FILE: a virtual environment of its own with the requirements in FILE, made once.
make_tools() {
  if cmp -s "$2" "$1/made"; then return; fi
  say "making $1 (packages of $2)"
  rm -rf "$1"
  quietly "python -m venv" "$(choose_python)" -m venv "$1"
  quietly "pip install" "$1/bin/python" -m pip install --quiet --disable-pip-version-check --requirement "$2"
  cp "$2" "$1/made"
}

# What the demo needs; a .venv that has the tests' packages too will do.
make_small_venv() {
  local python
  python=$(choose_python)
  if venv_is "$(venv_for "$python" scripts/requirements{,-test}.txt)"; then return; fi
  make_venv scripts/requirements.txt
}

# make_venv FILE...: makes .venv with the requirements in these files, or makes it anew where they,
# the Python or the checkout's place changed.
make_venv() {
  local python wanted file requirements=()
  python=$(choose_python)
  wanted=$(venv_for "$python" "$@")
  if venv_is "$wanted"; then return; fi
  for file; do requirements+=(--requirement "$file"); done

  if [[ -d .venv && ! -f $stamp ]]; then
    die "$PWD/.venv is there and not ours; move it away and run this again"
  fi
  say "making .venv with $python (packages of $*)"
  rm -rf .venv
  mkdir .venv
  echo unfinished >"$stamp"
  quietly "python -m venv" "$python" -m venv .venv
  quietly "pip install" .venv/bin/python -m pip install --no-compile --quiet --disable-pip-version-check \
    "${requirements[@]}"
  printf '%s\n' "$wanted" >"$stamp"
}
