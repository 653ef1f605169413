#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds this commit twice, without a compiler cache, and compares what came of it to the byte. Folder,
# time zone, locale, umask and number of jobs differ; compiler and libraries are the same.
#   scripts/parts/twice.sh              libraries, programs, manual pages and completions
#   scripts/parts/twice.sh TARGET...    of CMake's targets these alone
# SEPCAL_JOBS is how many files are compiled at once in the first build, by default what the machine takes.
set -euo pipefail
cd "$(dirname "$0")/../.."
source scripts/parts/terminal.sh
source scripts/parts/build.sh

targets=(all)
if (($# > 0)); then targets=("$@"); fi
[[ -z $(git status --porcelain --untracked-files=no) ]] ||
  say "what differs from the commit is not built"
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH CCACHE_DISABLE=1
jobs=${SEPCAL_JOBS:-$(count_jobs)}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# build_in FOLDER JOBS UMASK VARIABLE=VALUE...: the commit's sources and their build in FOLDER.
build_in() {
  mkdir -p "$1"
  (
    umask "$3"
    git archive HEAD | tar -x -C "$1"
    quietly "cmake" env "${@:4}" \
      cmake -S "$1" -B "$1/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSEPCAL_UNITY=ON
    quietly "the build" env "${@:4}" cmake --build "$1/build" --parallel "$2" --target "${targets[@]}"
  )
}

# sums FOLDER FILE: a line a product of its build, by name.
sums() {
  (
    cd "$1/build"
    find . -path '*/CMakeFiles/*' -prune -o -type f \
      \( -name '*.a' -o -name '*.so*' -o -path './apps/pages/*' -o -perm -u+x \) -print0 |
      LC_ALL=C sort -z | xargs -0 -r sha256sum
  ) >"$2"
}

say "the first build"
build_in "$scratch/one" "$jobs" 022 TZ=UTC LC_ALL=C.UTF-8
say "the second build"
other="$scratch/a longer way/to the/other"
build_in "$other" $((jobs + 1)) 077 TZ=Asia/Kathmandu LC_ALL=C
sums "$scratch/one" "$scratch/first"
sums "$other" "$scratch/second"
count=$(wc -l <"$scratch/first")
((count > 0)) || die "nothing was built that could be compared"
diff "$scratch/first" "$scratch/second" || die "these differ between two builds"
say "$count files are the same in two builds:"
cat "$scratch/first"
