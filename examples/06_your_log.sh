#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A log with headers of its own, mylog.csv in the folder that it is run in: only the first line has
# to change. K_alpha, K_beta and the lever arm are the probe's. The apps must be on the PATH.
set -euo pipefail

header=time_s,roll_deg,pitch_deg,yaw_deg,p_degps,q_degps,r_degps,vn_kt,ve_kt,vd_kt
header=$header,pt_hpa,ps_hpa,dpa_hpa,dpb_hpa,temp_degc
sed "1s/.*/$header/" mylog.csv >flight.csv
sepcal-pitot fit flight.csv --k-alpha 4.5 --k-beta 4.5 --lever-arm 0.35,0,-0.02 -o base.json
sepcal-pitot apply flight.csv base.json -o corrected.csv
