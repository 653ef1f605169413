#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# An aircraft whose pitching moment bends with alpha, which its model does not know: found by output error, compared,
# added. The error falls, and the truth comes back.
set -euo pipefail
sepcal-aircraft simulate -o flight.csv --geometry aircraft.json --hide "Cm[alpha^2]=-3" --seed 2
sepcal-aircraft fit flight.csv --model path -o path.json
sepcal-aircraft fit flight.csv --model longitudinal --geometry aircraft.json -o base.json
sepcal-aircraft compare flight.csv base.json
sepcal-aircraft add flight.csv base.json "Cm[alpha^2]" -o next.json
sepcal-aircraft two-step flight.csv --geometry aircraft.json -o two.json
sepcal-aircraft apply flight.csv path.json -o flown.csv
