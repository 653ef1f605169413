# SPDX-License-Identifier: BSD-3-Clause
# What wheels are built with: the root of an older Debian with Debian 12's compiler and headers, and in it
# the libraries that sepcal needs, compiled from Debian's sources without what a wheel can do without:
# Ceres without SuiteSparse, CXSparse, LAPACK and glog, NLopt without Luksan's solvers (LGPL).
# shellcheck shell=bash

sources=(ceres-solver nlopt libzstd zlib fmtlib)
headers=(libeigen3-dev libxsimd-dev nlohmann-json3-dev libcli11-dev libtomlplusplus-dev)

debian_name() { [[ $1 == aarch64 ]] && echo arm64 || echo amd64; }

# make_portable_root FOLDER PROCESSOR: FOLDER/root has glibc 2.31 of Debian 11 and the headers of libraries
# that are nothing else.
make_portable_root() {
  local folder=$1 root=$1/root triplet=$2-linux-gnu link package
  if [[ -f $folder/root-is-made ]]; then return; fi
  say "making the root of an older Debian for $2"
  rm -rf "$folder"
  write_apt_conf "$folder/older" "$(debian_name "$2")" "$(debian_suite deb bullseye)"
  APT_CONFIG=$folder/older/apt.conf quietly "apt-get update" apt-get update
  APT_CONFIG=$folder/older/apt.conf quietly "apt-get install" \
    apt-get install --yes --download-only libc6-dev
  write_apt_conf "$folder/here" "$(debian_name "$2")" "$(debian_suite deb bookworm)"
  APT_CONFIG=$folder/here/apt.conf quietly "apt-get update" apt-get update
  (cd "$folder/here/cache/archives" &&
    APT_CONFIG=$folder/here/apt.conf quietly "apt-get download" apt-get download "${headers[@]}")
  mkdir -p "$root"/usr/{bin,lib,sbin}
  ln -s usr/bin usr/lib usr/sbin "$root"
  unpack "$root" "$folder"/{older,here}/cache/archives/*.deb
  # Links are the root's own, as in a machine of that Debian.
  find "$root" -type l -lname '/*' | while read -r link; do
    ln -sfn "$root$(readlink "$link")" "$link"
  done
  mkdir -p "$root"/usr/include/{,"$triplet"/}c++ "$root/lib64"
  if [[ $2 == "$(uname -m)" ]]; then
    cp -r /usr/include/c++/12 "$root/usr/include/c++"
    cp -r "/usr/include/$triplet/c++/12" "$root/usr/include/$triplet/c++"
    ln -sfn ../usr/lib/x86_64-linux-gnu/ld-linux-x86-64.so.2 "$root/lib64" # libc.so asks for it there
  else
    cp -r "/usr/$triplet/include/c++/12" "$root/usr/include/c++"
  fi
  for package in "$folder"/here/cache/archives/*.deb; do
    tell_linked "$root" "$(dpkg-deb --field "$package" Package)" "$(dpkg-deb --field "$package" Version)"
  done
  # Its standard library is linked in.
  tell_linked "$root" gcc-12 "$("$triplet-gcc-12" -dumpfullversion)" /usr/share/doc/gcc-12-base/copyright
  quietly "older_glibc.c" "$triplet-gcc-12" --sysroot="$root" -O2 -fPIC -fvisibility=hidden -Wall -Wextra \
    -c scripts/parts/older_glibc.c -o "$folder/older_glibc.o"
  touch "$folder/root-is-made"
}

# tell_linked ROOT NAME VERSION [FILE]: what is linked in, with its licence, in ROOT/linked/NAME_VERSION.
tell_linked() {
  install -D --mode=644 "${4:-$1/usr/share/doc/$2/copyright}" "$1/linked/$2_${3#*:}"
}

# portable_cmake FOLDER PROCESSOR SOURCE BUILD [OPTION]...: configures with the root's compiler.
portable_cmake() {
  quietly "cmake of ${4##*/}" cmake -S "$3" -B "$4" -G Ninja --toolchain "$PWD/scripts/parts/older_glibc.cmake" \
    -DSEPCAL_ROOT="$1/root" -DSEPCAL_PROCESSOR="$2" -DSEPCAL_OLDER_GLIBC="$1/older_glibc.o" \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_C_COMPILER_LAUNCHER=ccache \
    -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "${@:5}"
}

# make_portable_libraries FOLDER PROCESSOR: compiled into FOLDER/root, with their licences.
make_portable_libraries() {
  local folder=$1 package source
  if [[ -f $folder/libraries-are-made ]]; then return; fi
  say "compiling Ceres, NLopt, fmt, zlib and Zstandard for $2"
  write_apt_conf "$folder/sources" "$(debian_name "$2")" "$(debian_suite deb-src bookworm)"
  APT_CONFIG=$folder/sources/apt.conf quietly "apt-get update" apt-get update
  for package in "${sources[@]}"; do
    source=$folder/sources/$package
    rm -rf "$source" && mkdir "$source"
    (cd "$source" && APT_CONFIG=$folder/sources/apt.conf quietly "apt-get source" \
      apt-get source --download-only "$package")
    tar --extract --directory "$source" --strip-components 1 --file "$(find "$source" -name '*.orig.tar.*' ! -name '*.asc')"
    tar --extract --directory "$source" --file "$(ls "$source"/*.debian.tar.*)" debian/copyright
    tell_linked "$folder/root" "$package" "$(sed -n 's/^Version: //p' "$source"/*.dsc)" "$source/debian/copyright"
  done
  leave_luksan_out "$folder/sources/nlopt"
  install -D /dev/null "$folder/sources/zlib/win32/zlib1.rc" # named for all systems, not in Debian's source
  build_portable "$@" zlib zlib -DBUILD_SHARED_LIBS=OFF
  rm -f "$folder"/root/usr/lib/libz.so* # who is linked takes the archive
  build_portable "$@" libzstd libzstd/build/cmake -DZSTD_BUILD_SHARED=OFF -DZSTD_BUILD_PROGRAMS=OFF
  build_portable "$@" fmtlib fmtlib -DFMT_TEST=OFF -DFMT_DOC=OFF
  build_portable "$@" nlopt nlopt -DBUILD_SHARED_LIBS=OFF -DNLOPT_PYTHON=OFF -DNLOPT_OCTAVE=OFF \
    -DNLOPT_MATLAB=OFF -DNLOPT_GUILE=OFF -DNLOPT_SWIG=OFF
  # Of its small log only what ends the program is written.
  build_portable "$@" ceres-solver ceres-solver -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF -DBUILD_EXAMPLES=OFF \
    -DBUILD_BENCHMARKS=OFF -DSUITESPARSE=OFF -DCXSPARSE=OFF -DLAPACK=OFF -DEIGENSPARSE=OFF -DGFLAGS=OFF \
    -DMINIGLOG=ON -DMINIGLOG_MAX_LOG_LEVEL=-3 -DSCHUR_SPECIALIZATIONS=OFF
  touch "$folder/libraries-are-made"
}

# build_portable FOLDER PROCESSOR NAME SOURCE [OPTION]...
build_portable() {
  portable_cmake "$1" "$2" "$1/sources/$4" "$1/build-$3" -DCMAKE_INSTALL_PREFIX="$1/root/usr" \
    -DCMAKE_INSTALL_LIBDIR=lib "${@:5}"
  build "$1/build-$3"
  quietly "installing $3" cmake --install "$1/build-$3"
}

# NLopt before 2.8 has no option that does so. Its other solvers are under MIT's licence and the like.
leave_luksan_out() {
  sed -i '/src\/algs\/luksan/d' "$1/CMakeLists.txt"
  sed -i -e '/#include "luksan.h"/d' -e 's/luksan_p[a-z]*(.*)/NLOPT_INVALID_ARGS/' "$1/src/api/optimize.c"
  rm -r "$1/src/algs/luksan"
}

# get_python_headers FOLDER PROCESSOR VERSION: Python.h of a Python that need not be here, into
# FOLDER/python-VERSION.
get_python_headers() {
  local target=$1/python-$3 suite
  case $3 in
    3.11) suite=bookworm ;;
    3.12) suite=noble ;;
    3.13) suite=trixie ;;
    3.14) suite=sid ;;
    *) die "no headers are known of Python $3; --python takes 3.11, 3.12, 3.13 and 3.14" ;;
  esac
  if [[ -d $target ]]; then return; fi
  mkdir -p "$1/headers-$3/cache/archives"
  if [[ $suite == noble ]]; then # Debian never released 3.12
    get_noble_headers "$1/headers-$3/cache/archives"
  else
    write_apt_conf "$1/headers-$3" "$(debian_name "$2")" "$(debian_suite deb "$suite")"
    APT_CONFIG=$1/headers-$3/apt.conf quietly "apt-get update" apt-get update
    (cd "$1/headers-$3/cache/archives" &&
      APT_CONFIG=$1/headers-$3/apt.conf quietly "apt-get download" apt-get download "libpython$3-dev")
  fi
  mkdir "$target.unpacked"
  unpack "$target.unpacked" "$1/headers-$3"/cache/archives/*.deb
  if [[ ! -d $target.unpacked/usr/include/$2-linux-gnu ]]; then
    ln -s x86_64-linux-gnu "$target.unpacked/usr/include/$2-linux-gnu"
  fi
  mv "$target.unpacked" "$target"
}

# get_noble_headers FOLDER: Ubuntu 24.04's first package, which stays as long as that release. Debian has
# no key of Ubuntu's, so the package is known by its hash. What pyconfig.h says is the same for both processors.
get_noble_headers() {
  local file=libpython3.12-dev_3.12.3-1_amd64.deb root
  root=$(mktemp -d)
  quietly "downloading $file" debootstrap --download-only --variant=minbase --no-check-gpg \
    --include=libpython3.12-dev noble "$root" '' /usr/share/debootstrap/scripts/gutsy
  mv "$root/var/cache/apt/archives/$file" "$1"
  rm -rf "$root"
  echo "f5924a06298ae0689128498276d3a555e02615a4ecfa8f4417d679a097586f35  $1/$file" | sha256sum --check --quiet ||
    die "$file isn't the one that is known"
}

# configure_portable FOLDER PROCESSOR VERSION: sepcal for one Python.
configure_portable() {
  portable_cmake "$1" "$2" . "$1/build" -DSEPCAL_SHARED=ON -DSEPCAL_UNITY=ON -DSEPCAL_BUILD_PYTHON=ON \
    -DSEPCAL_PYTHON_HEADERS="$1/python-$3/usr/include/python$3;$1/python-$3/usr/include" \
    -DSEPCAL_PYTHON_ABI="cpython-${3/./}-$2-linux-gnu" \
    -Dpybind11_DIR="$(build-wheel/tools/bin/python -m pybind11 --cmakedir)" -DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=BOTH
}
