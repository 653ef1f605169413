#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A plain Pitot-static tube against the ground velocity, here simulated; the apps must be on the
# PATH and the files go to the folder that it is run in.
set -euo pipefail

sepcal-pitot simulate --probe pitot-static -o tube.csv --truth truth.json
sepcal-pitot fit tube.csv -o base.json
sepcal-pitot apply tube.csv base.json -o corrected.csv
