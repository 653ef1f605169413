# SPDX-License-Identifier: BSD-3-Clause
# What the scripts say and how they stop: one line a step, the whole output only where it fails.
# shellcheck shell=bash

script=$(basename "$0")

say() { printf '%s: %s\n' "$script" "$*"; }

die() {
  printf '%s: %s\n' "$script" "$*" >&2
  exit 1
}

# quietly WHAT COMMAND...: runs the command; prints its output, and stops, only if it fails.
quietly() {
  local what=$1 output
  shift
  output=$(mktemp)
  if ! "$@" </dev/null >"$output" 2>&1; then
    cat "$output" >&2
    rm -f "$output"
    die "$what failed: $*"
  fi
  rm -f "$output"
}
