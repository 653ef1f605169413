#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A magnetometer without attitude: only the field's strength is known. Here simulated; the apps must
# be on the PATH and the files go to the folder that it is run in.
set -euo pipefail

sepcal-mag simulate -o turns.csv --truth truth.json
sepcal-mag fit turns.csv --field-strength 53.2016 -o base.json
sepcal-mag apply turns.csv base.json -o corrected.csv
