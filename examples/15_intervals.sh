#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# How far may the parameters of a short flight lie, where a bound stands in the way of one? The apps
# must be on the PATH and the files go to the folder that it is run in.
set -euo pipefail

sepcal-pitot simulate --probe pitot-static --rows 300 -o tube.csv
sepcal-pitot fit tube.csv --bounds c_va=-0.6,5 -o base.json
sepcal-pitot intervals tube.csv base.json
