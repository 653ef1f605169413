# SPDX-License-Identifier: BSD-3-Clause
# Other machines, as far as a process' environment makes them: narrower processors, another BLAS.
# shellcheck shell=bash

# list_instruction_sets FOLDER: what SEPCAL_ISA may be on this processor, the widest first, by what
# the refusal of an unknown one lists. Leaves a log in FOLDER.
list_instruction_sets() {
  local refusal
  quietly "simulate" build/apps/sepcal-mag simulate --rows 50 -o "$1/few.csv"
  refusal=$(SEPCAL_ISA=abacus build/apps/sepcal-mag fit "$1/few.csv" 2>&1) || true
  [[ $refusal == *"this processor takes "* ]] || die "no instruction sets in: $refusal"
  tr -d , <<<"${refusal##*this processor takes }"
}

# numpy_features PATTERN: the instruction sets that NumPy would choose between here and that match.
numpy_features() {
  .venv/bin/python - "$1" <<'PY'
import re, sys
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__
print(*(one for one in __cpu_dispatch__ if __cpu_features__[one] and re.search(sys.argv[1], one)))
PY
}

# on_processor SET COMMAND...: runs it as a processor would that takes no wider one: so do sepcal,
# the functions of the C library, NumPy, and the BLAS that NumPy and SciPy bring along.
on_processor() {
  local wide=-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ,-AVX512CD
  export SEPCAL_ISA=$1
  case $1 in
    avx2)
      export GLIBC_TUNABLES=glibc.cpu.hwcaps=$wide OPENBLAS_CORETYPE=Haswell
      NPY_DISABLE_CPU_FEATURES=$(numpy_features 'AVX512|X86_V4')
      ;;
    baseline)
      export GLIBC_TUNABLES=glibc.cpu.hwcaps=$wide,-AVX2,-AVX,-FMA OPENBLAS_CORETYPE=Nehalem
      NPY_DISABLE_CPU_FEATURES=$(numpy_features .)
      ;;
  esac
  export NPY_DISABLE_CPU_FEATURES
  "${@:2}"
}

# with_another_blas FOLDER COMMAND...: runs it with Debian's reference BLAS and LAPACK, or where this
# machine has those, with OpenBLAS: unpacked below FOLDER, not installed, as other programs of this
# machine would then take them too.
with_another_blas() {
  local folder=$1 own package packages=(libblas3 liblapack3)
  own=$(realpath "$(ldd build/apps/sepcal-mag | awk '$1 == "libblas.so.3" { print $3 }')")
  [[ $own != */blas/* ]] || packages=(libopenblas0-pthread)
  mkdir -p "$folder"
  (cd "$folder" && quietly "apt-get download" apt-get download "${packages[@]}")
  for package in "$folder"/*.deb; do dpkg-deb --extract "$package" "$folder/root"; done
  LD_LIBRARY_PATH=$(find "$folder/root" -name 'lib*.so.3' -printf '%h\n' | sort -u | paste -sd:)
  export LD_LIBRARY_PATH
  say "BLAS: $(ldd build/apps/sepcal-mag | awk '$1 == "libblas.so.3" { print $3 }')" \
    "instead of $own"
  "${@:2}"
}
