# SPDX-License-Identifier: BSD-3-Clause
# What a newcomer does with a wheel, on a machine without compiler or libraries (scripts/wheel --try).
# shellcheck shell=sh
cd /root || exit
export LC_ALL=C.UTF-8
! command -v gcc cc g++ || exit 1
seconds() { date +%s.%N; }
begin=$(seconds)
python3 -m venv venv
venv/bin/pip install --quiet --no-index --find-links /wheels sepcal
PATH=/root/venv/bin:$PATH
sepcal-pitot simulate -o flight.csv --rate 10 --seed 1
sepcal-pitot fit flight.csv --k-alpha 4.5 --k-beta 4.5 --lever-arm 0.35,0,-0.02 -o tube.json >fit.txt
end=$(seconds)
grep -q converged fit.txt
echo "$begin $end" | awk '{ printf "from nothing to a first calibration: %.1f s\n", $2 - $1 }'
sepcal pitot compare flight.csv tube.json >/dev/null
sepcal-mag simulate -o mag.csv && sepcal-mag fit mag.csv -o mag.json >/dev/null
sepcal mag fit mag.csv -o again.json >/dev/null
sepcal-aircraft simulate -o jet.csv && sepcal-aircraft fit jet.csv --model path -o jet.json >/dev/null
python - <<'PY'
import numpy as np
import sepcal
eta = np.linspace(1, 10, 100)
fit = sepcal.fit(sepcal.ScalarExample1(), {"eta": eta, "z": 2 * np.cos(eta + 0.1) + 1})
assert abs(fit.parameters["a"].value - 1) < 1e-9, fit
try:
    sepcal.read("missing.csv")
except sepcal.Error as error:
    assert "missing.csv" in str(error), error
else:
    raise SystemExit("a file that is not there was read")
PY
pip install --quiet --no-index --find-links /wheels plotly pyulog
sepcal report flight.csv tube.json -o page.html && grep -q plotly page.html
echo "programs, module, report: all work"
