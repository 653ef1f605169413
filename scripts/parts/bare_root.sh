# SPDX-License-Identifier: BSD-3-Clause
# Wheels tried where nothing is: roots of Debian and Ubuntu with their Python, no compiler, no library of
# sepcal's. Needs root, for chroot.
# shellcheck shell=bash

# Suite and its Python.
bare_roots=("bookworm 3.11" "trixie 3.13" "noble 3.12")

# try_wheels WHEEL...: each in the roots whose Python it is for.
try_wheels() {
  local line suite python wheel tried=0
  install_packages scripts/apt-packages-wheel.txt
  make_tools build-wheel/tools scripts/requirements-wheel.txt
  for line in "${bare_roots[@]}"; do
    read -r suite python <<<"$line"
    for wheel; do
      [[ $wheel == *-cp${python/./}-*_$(uname -m).whl ]] || continue
      make_bare_root "$suite"
      try_wheel "$suite" "$python" "$wheel"
      tried=$((tried + 1))
    done
  done
  ((tried > 0)) || die "none of these wheels is for Python 3.11, 3.12 or 3.13 on $(uname -m)"
}

# make_bare_root SUITE: build-wheel/bare/SUITE.tar, made once.
make_bare_root() {
  local tar=build-wheel/bare/$1.tar root
  if [[ -f $tar ]]; then return; fi
  say "making a bare $1"
  mkdir -p build-wheel/bare
  root=$(mktemp -d build-wheel/bare/XXXX)
  # Debian has no key of Ubuntu's: a root to try things in, never to build from.
  local options=(--force-check-gpg) recipe=()
  if [[ $1 == noble ]]; then # which is younger than Debian 12's debootstrap
    options=(--no-check-gpg "--components=main,universe") recipe=("" /usr/share/debootstrap/scripts/gutsy)
  fi
  quietly debootstrap debootstrap --variant=minbase --include=python3-venv "${options[@]}" "$1" "$root" \
    "${recipe[@]}"
  tar --create --file "$tar.part" --directory "$root" --exclude=./var/cache/apt --exclude=./var/lib/apt/lists .
  mv "$tar.part" "$tar"
  rm -rf "$root"
}

# try_wheel SUITE PYTHON WHEEL: from nothing to a calibration, a report and a log.
try_wheel() {
  local root
  root=$(mktemp -d "${TMPDIR:-/tmp}/bare.XXXX")
  tar --extract --file "build-wheel/bare/$1.tar" --directory "$root"
  mkdir "$root/wheels"
  cp "$3" "$root/wheels"
  quietly "pip download" build-wheel/tools/bin/python -m pip download --disable-pip-version-check --quiet \
    --only-binary :all: --python-version "$2" --dest "$root/wheels" numpy plotly pyulog
  say "$1, Python $2: $(basename "$3")"
  cp scripts/parts/bare_trial.sh "$root/trial.sh"
  mount -t proc proc "$root/proc" # by which the loader finds a program's folder
  local status=0
  chroot "$root" env -i PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin HOME=/root sh -e /trial.sh || status=$?
  umount "$root/proc"
  ((status == 0)) || die "the wheel failed in $1; its root is $root"
  rm -rf "$root"
}

# try_packages FOLDER: its packages of sepcal, installed in a bare Debian 12 with what its archive has.
try_packages() {
  local root
  make_bare_root bookworm
  root=$(mktemp -d "${TMPDIR:-/tmp}/bare.XXXX")
  tar --extract --file build-wheel/bare/bookworm.tar --directory "$root"
  cp "$1"/sepcal_*.deb "$1"/libsepcal-dev_*.deb "$root"
  cp /etc/resolv.conf "$root/etc"
  cp /etc/apt/apt.conf.d/*proxy* "$root/etc/apt/apt.conf.d" 2>/dev/null || true
  mkdir -p "$root/var/lib/apt/lists/partial" "$root/var/cache/apt/archives/partial"
  say "installing $(basename "$1"/sepcal_*.deb) in a bare bookworm"
  mount -t proc proc "$root/proc"
  local status=0
  chroot "$root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/root DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 sh -ec '
    apt-get -qq update
    apt-get -qq install --no-install-recommends --yes ./sepcal_*.deb ./libsepcal-dev_*.deb >/dev/null
    sepcal-pitot simulate -o flight.csv --rate 10 --seed 1
    sepcal-pitot fit flight.csv --k-alpha 4.5 --k-beta 4.5 --lever-arm 0.35,0,-0.02 -o tube.json >fit.txt
    grep -q converged fit.txt
    test -f /usr/include/sepcal/sepcal.hpp
    sepcal --version' || status=$?
  umount "$root/proc"
  ((status == 0)) || die "the packages failed in a bare bookworm; its root is $root"
  rm -rf "$root"
}
