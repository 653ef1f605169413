# SPDX-License-Identifier: BSD-3-Clause
# Other people's projects, against a sepcal that was installed to a prefix and nothing of this checkout.
# shellcheck shell=bash

# Where find_package finds nothing that the core can do without.
others=(Ceres glog NLopt Threads fmt nlohmann_json ZLIB zstd)
without_others=("${others[@]/#/-DCMAKE_DISABLE_FIND_PACKAGE_}")
without_others=("${without_others[@]/%/=ON}")

# consume PREFIX PROJECT FOLDER [CMAKE OPTION]...: builds the project in FOLDER.
consume() {
  quietly "the consumer's cmake" cmake -S "$2" -B "$3" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_PREFIX_PATH="$1" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "${@:4}"
  quietly "the consumer's build" cmake --build "$3"
}

# find_component PREFIX COMPONENT FOLDER [CMAKE OPTION]...
find_component() {
  cmake --fresh -S tests/consumer/component -B "$3" -G Ninja -DCMAKE_PREFIX_PATH="$1" \
    -DCOMPONENT="$2" "${@:4}"
}

# refuse WORDS PREFIX COMPONENT FOLDER [CMAKE OPTION]...: it can't be found, and CMake says these words.
refuse() {
  local words=$1 said
  shift
  if said=$(find_component "$@" 2>&1); then die "component '$2' must not be found: $words"; fi
  said=$(tr -s ' \n' ' ' <<<"$said")
  [[ $said == *"$words"* ]] || die "component '$2' must be refused with '$words', not with: $said"
}

# install_core PREFIX FOLDER: built in FOLDER, without the engine.
install_core() {
  quietly "the core's cmake" cmake -S . -B "$2" -G Ninja -DSEPCAL_BUILD_ENGINE=OFF "${without_others[@]}"
  quietly "the core's installation" cmake --install "$2" --prefix "$1"
}

# compile PREFIX PACKAGE FLAG...: by g++ with the flags that pkg-config has for the package.
compile() {
  local folder flags
  folder=$(dirname "$(find "$1/" -name "$2.pc")")
  flags=$(PKG_CONFIG_PATH=$folder pkg-config --cflags --libs "$2")
  # shellcheck disable=SC2086 # flags are words
  quietly "g++ with pkg-config's $2" g++ -std=c++20 "${@:3}" $flags
}

# consume_core PREFIX FOLDER: by CMake, where of all others nothing can be found, and by pkg-config.
consume_core() {
  consume "$1" tests/consumer/core "$2" "${without_others[@]}"
  quietly "the core's consumer" "$2/core_consumer"
  compile "$1" sepcal-core -fno-exceptions -fno-rtti tests/consumer/core/main.cpp -o "$2/by_pkg_config"
  quietly "the core's consumer by pkg-config" "$2/by_pkg_config"
}

# read_headers PREFIX FOLDER: what is installed of the core includes nothing but itself and Eigen.
read_headers() {
  (cd "$1/include" && find . -name '*.hpp' -printf '#include "%P"\n') >"$2/all.cpp"
  compile "$1" sepcal-core -fsyntax-only -fno-exceptions -fno-rtti -MD -MF "$2/all.d" "$2/all.cpp"
  if grep -E '/(ceres|glog|nlopt.hpp|fmt|nlohmann|xsimd)/' "$2/all.d"; then
    die "a header of the core includes what is not Eigen's"
  fi
}

# link_engine PREFIX FOLDER: all that the archive refers to is in what pkg-config names.
link_engine() {
  printf '#include <sepcal/fit.hpp>\nint main() {}\n' >"$2/engine.cpp"
  compile "$1" sepcal "$2/engine.cpp" -o "$2/engine" \
    -Wl,--whole-archive "$(find "$1/" -name libsepcal.a)" -Wl,--no-whole-archive
  quietly "the engine by pkg-config" "$2/engine"
}
