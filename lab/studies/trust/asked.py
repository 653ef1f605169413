# SPDX-License-Identifier: BSD-3-Clause
"""A flight of the simulator is fitted and diagnosed: what is kept of what is said."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Any

from sepcal import Error
from sepcal.calibration import Calibration
from sepcal.diagnosis import Diagnosis
from sepcal.fitting import fit
from sepcal.flight import Flight
from sepcal.models import FiveHoleProbe, Magnetometer, PitotStatic
from studies.trust.part import Row
from studies.trust.simulator.causes import Cause
from studies.trust.simulator.five_hole import LEVER_ARM, SENSITIVITY
from studies.trust.simulator.flights import Flown

MODELS = {
    "five-hole": FiveHoleProbe(k_alpha=SENSITIVITY, k_beta=SENSITIVITY, lever_arm=LEVER_ARM),
    "pitot-static": PitotStatic(),
    "magnetometer": Magnetometer(),
}
KEPT = 12  # of the candidates, the best first
OVER_THE_FLOOR = 1.5  # from here on no page says that nothing is missing
NOTHING_MISSING = "nothing is missing"
REFUSED = "refused"  # in the verdict's place, where a fit or a diagnosis is refused
LAGS = ("time_offset", "pneumatic_lag", "sensor_lag")


def ask(probe: str, flown: Flown) -> tuple[Row, Calibration | None]:
    """What is said of the flight, enough to judge it anew by other limits; and the fit.

    The probe without effects, on one thread: the study runs flights side by side.
    """
    begun = time.process_time()
    try:
        base = fit(MODELS[probe], Flight(flown.columns), threads=1)
        fitted = time.process_time()
        diagnosis = base.diagnose()
    except Error as error:
        said: Row = {"verdict": REFUSED, "sentence": str(error), "rmse": None, "floor": None}
        said |= {"nothing_missing": False, "ranked": [], "set": []}
        return said | {"hidden": _tell(flown)}, None
    answer = diagnosis.to_dict()
    kept = [
        effect
        for rank, effect in enumerate(answer["effects"])
        if rank < KEPT or any(h.cause.is_named_by(effect["name"]) for h in flown.hidden)
    ]
    return {
        "fit_seconds": fitted - begun,
        "diagnose_seconds": time.process_time() - fitted,
        "status": base.status,
        "verdict": diagnosis.verdict,
        "sentence": diagnosis.sentence,
        "nothing_missing": NOTHING_MISSING in diagnosis.text.lower(),
        "rmse": diagnosis.rmse,
        "floor": diagnosis.noise_floor,
        "ranked": [_short(effect) for effect in kept],
        "set": list_indistinguishable(answer, diagnosis),
        "pairs": diagnosis.pairs,
        "advice": diagnosis.advice.effect,
        "withheld": diagnosis.advice.withheld,
        "unmeasured": [cause.kind for cause in diagnosis.unmeasured],
        "hidden": _tell(flown),
    }, base


def _tell(flown: Flown) -> list[Row]:
    return [
        {
            "cause": hidden.cause.label,
            "loudness": hidden.loudness,
            "visibility": hidden.visibility,
            "wander": hidden.wander,
        }
        for hidden in flown.hidden
    ]


def list_indistinguishable(answer: dict[str, Any], diagnosis: Diagnosis) -> list[str]:
    """The first and what the page calls indistinguishable from it; none where nothing was found."""
    if "indistinguishable" in answer:
        return [str(name) for name in answer["indistinguishable"]]
    return diagnosis.explanations


def _short(effect: dict[str, Any]) -> dict[str, Any]:
    told = ("name", "status", "beside", "log10_p", "p_adjusted", "held_out_gain", "predicted_drop")
    return {name: effect[name] for name in told}


def share_of(base: Calibration, effect: str) -> float | None:
    """What a real fit with the effect takes of the RMSE on rows held out, as `add` has it."""
    entry = base.add(effect).history[-1]
    share = 1.0 - entry.held_out_after / entry.held_out_before
    return None if math.isnan(share) else share


def is_lag(effect: str) -> bool:
    """Whether the name says that a reading is late."""
    return effect in LAGS or "delay(" in effect


def first_of(row: Row) -> str:
    """The name that the page puts first, found or not."""
    return str(row["ranked"][0]["name"]) if row["ranked"] else ""


def names(row: Row, cause: Cause) -> bool:
    """Whether the cause is first, or in the set, or, beside a lag that is first, counts too."""
    if row["verdict"] in ("adequate", REFUSED):
        return False
    said = [first_of(row), *row["set"]]
    if is_lag(first_of(row)):
        said += [effect["name"] for effect in row["ranked"] if effect["beside"] == "counts"]
    return any(cause.is_named_by(name) for name in said)


def why_missed(row: Row, causes: Sequence[Cause]) -> str:
    """What became of a cause that is not named, in words that flights can be counted by."""
    if row["verdict"] == "effect_missing":
        return f"named {first_of(row)}"
    candidates = [
        effect for effect in row["ranked"] if any(c.is_named_by(effect["name"]) for c in causes)
    ]
    if not candidates:
        return f"{row['verdict']}, and no candidate says it"
    return f"{row['verdict']}, its candidate {candidates[0]['status']}"
