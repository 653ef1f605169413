# SPDX-License-Identifier: BSD-3-Clause
# Builds and installs the library where scripts/matrix put it, and runs the consumer test against it.
# shellcheck shell=sh
cd /sepcal || exit
export CCACHE_DIR=/ccache LC_ALL=C.UTF-8
option=$1
# Checked is what compiles and computes, not how fast: -O1 takes less time.
set -- -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache
cmake -S . -B /build "$@" -DSEPCAL_BUILD_APPS=OFF -DSEPCAL_BUILD_FLIGHT=ON -DSEPCAL_UNITY=ON ${option:+"$option"}
cmake --build /build --parallel "$(nproc)"
cmake --install /build --prefix /prefix
cmake -S tests/consumer -B /consumer "$@" -DCMAKE_PREFIX_PATH=/prefix ${option:+"$option"}
cmake --build /consumer
/consumer/consumer
compiler=$(sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' /build/CMakeCache.txt)
dpkg-query -W -f '${Package} ${Version}, ' libeigen3-dev libceres-dev libnlopt-dev libfmt-dev cmake
echo "$("$compiler" --version | head -n 1): built, installed, used"
