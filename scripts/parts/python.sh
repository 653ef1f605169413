# SPDX-License-Identifier: BSD-3-Clause
# The virtual environment .venv: Python and the tools of scripts/requirements.txt, for the tests, the
# pictures and the linters. The stamp inside it tells whose it is and what it was made for.
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

# Makes .venv, or makes it anew where the requirements, the Python or the checkout's place changed.
make_venv() {
  local python wanted requirements=$1
  python=$(choose_python)
  wanted=$({ cat "$requirements" && "$python" -VV && pwd -P; } | sha256sum)
  if [[ -x .venv/bin/python && -f $stamp && $(<"$stamp") == "$wanted" ]]; then return; fi

  if [[ -d .venv && ! -f $stamp ]]; then
    die "$PWD/.venv is there and not ours; move it away and run this again"
  fi
  say "making .venv with $python (packages of $requirements)"
  rm -rf .venv
  mkdir .venv
  echo unfinished >"$stamp"
  quietly "python -m venv" "$python" -m venv .venv
  quietly "pip install" .venv/bin/python -m pip install --quiet --disable-pip-version-check \
    --requirement "$requirements"
  printf '%s\n' "$wanted" >"$stamp"
}
