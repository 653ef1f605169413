# SPDX-License-Identifier: BSD-3-Clause
# Debian packages: asks dpkg what is missing and installs no more than that.
# shellcheck shell=bash

# Prints the names in FILEs (one a line, # comments) that dpkg does not know as installed.
missing_packages() {
  local name
  cat "$@" | while read -r name _; do
    case $name in '' | '#'*) continue ;; esac
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null) == installed ]] ||
      printf '%s\n' "$name"
  done
}

# install_packages FILE...: root, or someone whom sudo knows; else stops and says what to type.
install_packages() {
  local missing as_root=()
  if ! command -v dpkg-query >/dev/null; then
    say "not a Debian system: taking the packages in $* for granted"
    return
  fi
  mapfile -t missing < <(missing_packages "$@")
  if ((${#missing[@]} == 0)); then return; fi

  if ((EUID != 0)); then
    # Without a terminal nobody can type a password.
    if command -v sudo >/dev/null && { [[ -t 0 ]] || sudo -n true 2>/dev/null; }; then
      as_root=(sudo)
    else
      die "Debian packages are missing; as root: apt-get install --no-install-recommends" \
        "${missing[*]}"
    fi
  fi
  say "installing Debian packages: ${missing[*]}"
  quietly "apt-get update" "${as_root[@]}" apt-get update
  quietly "apt-get install" "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y --no-install-recommends "${missing[@]}"
}
