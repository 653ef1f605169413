# SPDX-License-Identifier: BSD-3-Clause
"""What `pip install .` must give a user who has nothing but NumPy: a module that fits.

Scalar example 1 (Eq. 21) without noise, whose parameters must come back.
"""

import importlib.util
import sys

import numpy as np

import sepcal

TRUTH = {"a": 1.0, "b": 0.1, "c": 1.0}

eta = np.linspace(1.0, 10.0, 100)
z = (1.0 + TRUTH["a"]) * np.cos(eta + TRUTH["b"]) + TRUTH["c"]
fit = sepcal.fit(sepcal.ScalarExample1(), {"eta": eta, "z": z})
for name, true in TRUTH.items():
    if not abs(fit.parameters[name].value - true) < 1e-6:
        sys.exit(f"{name} = {fit.parameters[name].value}, expected {true}")
if importlib.util.find_spec("scipy"):
    sys.exit("scipy is installed: this no longer shows that NumPy is enough")
print(f"sepcal {sepcal.__version__} in {sepcal.__path__[0]}: scalar example 1 fitted")
