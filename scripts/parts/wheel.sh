# SPDX-License-Identifier: BSD-3-Clause
# The wheel, and an environment that it is installed into.
# shellcheck shell=bash

# make_wheel FOLDER: builds the wheel into FOLDER with .venv's tools. Compiler and -Werror are those
# of build/, so that the compiler cache has every object already.
make_wheel() {
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_GENERATOR=Ninja CXX=c++
  quietly "pip wheel" .venv/bin/python -m pip wheel --disable-pip-version-check --no-deps \
    --no-build-isolation --check-build-dependencies --wheel-dir "$1" \
    --config-settings=build-dir=build-pip --config-settings=cmake.define.SEPCAL_WERROR=ON \
    --config-settings=cmake.define.SEPCAL_UNITY=ON .
}

# install_wheel FOLDER ENVIRONMENT: a new environment with the wheel, and of all else NumPy alone.
install_wheel() {
  .venv/bin/python -m venv "$2"
  quietly "pip install" "$2/bin/python" -m pip install --disable-pip-version-check \
    --constraint scripts/requirements.txt "$1"/sepcal-*.whl
}

# add_tools ENVIRONMENT: what .venv has, found after what the environment has itself.
add_tools() {
  local packages
  packages=$(.venv/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
  echo "$packages" >"$("$1/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/tools.pth"
}
