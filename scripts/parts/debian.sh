#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Debian's packages of this checkout, by packaging/debian, in a folder that is not there yet; then lintian.
#   scripts/parts/debian.sh FOLDER [--source] [--try] [ARCHIVE]
# --source makes the source package alone. --try installs the packages in a bare Debian, from its archive,
# and calibrates a flight there; in a FOLDER that has packages already it does only that. ARCHIVE is sepcal-VERSION.tar.gz as scripts/release makes it;
# else it is made here. What dpkg-buildpackage looks for in the environment (DEB_BUILD_OPTIONS,
# DEB_BUILD_PROFILES) holds; of ccache PATH and CCACHE_DIR.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD
source scripts/parts/terminal.sh
source scripts/parts/packages.sh
source scripts/parts/bare_root.sh
source scripts/parts/sdist.sh

folder="" archive="" build=(--build=full) try=false
for option in "$@"; do
  case $option in
    --source) build=(--build=source --no-check-builddeps) ;;
    --try) try=true ;;
    -*) die "unknown option $option; there are --source and --try" ;;
    *) if [[ -z $folder ]]; then folder=$option; else archive=$option; fi ;;
  esac
done
[[ -n $folder ]] || die "takes a folder for the packages"
if $try && compgen -G "$folder/sepcal_*.deb" >/dev/null; then
  try_packages "$folder"
  exit
fi
[[ ! -e $folder ]] || die "$folder is there already; remove it first"
for program in dpkg-buildpackage dh lintian; do
  command -v "$program" >/dev/null || die "$program is missing: apt-get install dpkg-dev debhelper lintian"
done
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
if [[ -z $archive ]]; then
  make_sdist "$folder"
  archive=$(find "$folder" -name 'sepcal-*.tar.gz')
fi
version=$(basename "$archive" .tar.gz)
version=${version#sepcal-}
cp "$archive" "$folder/sepcal_$version.orig.tar.gz"
tar -xzf "$archive" -C "$folder"
cp -r packaging/debian "$folder/sepcal-$version/debian"
cd "$folder/sepcal-$version"
say "building in $PWD"
dpkg-buildpackage "${build[@]}" --unsigned-source --unsigned-changes
cd ..
say "lintian"
lintian --allow-root --fail-on error,warning --info --display-info sepcal_*.changes
say "$folder has:"
find . -maxdepth 1 -name '*.deb' -o -maxdepth 1 -name '*.dsc' -o -maxdepth 1 -name '*.changes' | sort
if $try; then
  cd "$root"
  try_packages "$folder"
fi
