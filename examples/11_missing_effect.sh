#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A wind that grows with height, which the five-hole probe's model lacks: hidden in a simulated
# flight, seen by compare, named by diagnose, put right by add. The apps must be on the PATH.
set -euo pipefail

sepcal-pitot simulate -o flight.csv --truth truth.json --rate 10 --hide "wind[altitude_m]=0.03:0.01"
sepcal-pitot fit flight.csv --k-alpha 4.5 --k-beta 4.5 --lever-arm 0.35,0,-0.02 -o base.json
sepcal-pitot compare flight.csv base.json
sepcal-pitot diagnose flight.csv base.json || (($? == 3)) # an effect is missing
sepcal-pitot add flight.csv base.json "wind[altitude_m]" -o next.json
sepcal-pitot apply flight.csv next.json -o corrected.csv
