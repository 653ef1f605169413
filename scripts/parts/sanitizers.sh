# SPDX-License-Identifier: BSD-3-Clause
# How the sanitizers of build-sanitizers look and report. addr2line, of build-essential,
# names the functions in their reports; clang's own symbolizer would be a package more.
# shellcheck shell=bash

symbolizer=external_symbolizer_path=$(command -v addr2line || true)
export UBSAN_OPTIONS=$symbolizer:print_stacktrace=1
export ASAN_OPTIONS=$symbolizer:detect_leaks=1:strict_string_checks=1
