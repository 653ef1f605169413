#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A magnetometer beside a motor's wires, calibrated and corrected on board by a C program. The apps
# must be on the PATH and the files go to the folder that it is run in.
set -euo pipefail
examples=$(dirname "$0")

sepcal-mag simulate -o turns.csv --hide "bias[current_a]=0.3" --seed 1
sepcal-mag fit turns.csv --field-strength 53.2016 --effect "bias[current_a]" -o mag.json
sepcal-mag export mag.json --to c -o magnetometer.h
cc -std=c99 -Wall -Wextra -Werror -I. "$examples/23_on_board.c" -o on_board -lm
printf '31.5 -12.25 44.0 8.5\nnan -12.25 44.0 8.5\n' | ./on_board
