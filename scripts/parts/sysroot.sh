# SPDX-License-Identifier: BSD-3-Clause
# A root of another architecture in a folder of the checkout: Debian packages of that architecture,
# downloaded and unpacked, never installed. This machine's dpkg hears nothing of them.
# shellcheck shell=bash

# The Debian repositories of this machine, as lines of a sources.list.
debian_sources() {
  # shellcheck disable=SC2016 # the words are apt's to replace
  apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' \
    'Created-By: Packages' 'Origin: Debian' | sort -u |
    sed 's|^|deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] |'
}

# debian_suite KIND SUITE: a line of a sources.list for another release of Debian from this machine's mirror,
# of its packages (deb) or their sources (deb-src).
debian_suite() {
  debian_sources | awk -v kind="$1" -v suite="$2" \
    '$3 !~ /security/ { print kind, $2, $3, suite, "main"; found = 1; exit } END { exit !found }' ||
    die "apt knows no mirror of Debian; run apt-get update first"
}

# write_apt_conf FOLDER ARCHITECTURE [LINE]...: FOLDER/apt.conf makes an apt of its own, with FOLDER for
# all that it keeps and these lines for a sources.list, or this machine's. Its dpkg has no package yet, so
# that it downloads everything that is depended on.
write_apt_conf() {
  mkdir -p "$1"/{lists,cache/archives/partial,etc}
  if (($# > 2)); then printf '%s\n' "${@:3}"; else debian_sources; fi >"$1/sources.list"
  [[ -s $1/sources.list ]] || die "apt knows no Debian repository; run apt-get update first"
  : >"$1/status"
  cat >"$1/apt.conf" <<CONF
APT::Architecture "$2";
APT::Architectures "$2";
APT::Install-Recommends "false";
Acquire::Check-Valid-Until "false";
APT::Sandbox::User "$(id -un)";
Dir::Cache "$1/cache";
Dir::Etc::sourcelist "$1/sources.list";
Dir::Etc::sourceparts "/dev/null";
Dir::State "$1";
Dir::State::lists "$1/lists";
Dir::State::status "$1/status";
Debug::NoLocking "true";
CONF
}

# unpack ROOT PACKAGE...
unpack() {
  local package
  for package in "${@:2}"; do
    dpkg-deb --fsys-tarfile "$package" | tar --extract --keep-directory-symlink --directory "$1"
  done
}

# make_sysroot FOLDER ARCHITECTURE FILE: FOLDER/root with the packages that FILE names; nothing is
# done where that list has not changed since.
make_sysroot() {
  local folder=$1 root=$1/root names library
  mapfile -t names < <(grep -v '^#' "$3")
  if cmp -s "$3" "$folder/unpacked"; then return; fi
  rm -rf "$folder"
  write_apt_conf "$folder" "$2"
  say "downloading packages for $2"
  export APT_CONFIG=$folder/apt.conf
  quietly "apt-get update" apt-get update
  quietly "apt-get install" apt-get install --yes --download-only "${names[@]}"
  unset APT_CONFIG
  mkdir -p "$root"/usr/{bin,lib,sbin}
  ln -s usr/bin usr/lib usr/sbin "$root"
  unpack "$root" "$folder"/cache/archives/*.deb
  # What update-alternatives does where packages are installed.
  for folder in "$root"/usr/lib/*/{blas,lapack}; do
    for library in "$folder"/*.so*; do
      ln -sf "${folder##*/}/${library##*/}" "${folder%/*}/${library##*/}"
    done
  done
  # Ceres names libraries by paths that are right where it is installed.
  sed -i "s|;/usr/lib/|;$root/usr/lib/|g" "$root"/usr/lib/*/cmake/Ceres/CeresTargets.cmake
  cp "$3" "$1/unpacked"
}
