#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A five-hole probe calibrated from a log, here a simulated one; the apps must be on the PATH and
# the files go to the folder that it is run in.
set -euo pipefail

sepcal-pitot simulate -o flight.csv --truth truth.json
sepcal-pitot fit flight.csv --k-alpha 4.5 --k-beta 4.5 --lever-arm 0.35,0,-0.02 -o base.json
sepcal-pitot compare flight.csv base.json
sepcal-pitot apply flight.csv base.json -o corrected.csv
