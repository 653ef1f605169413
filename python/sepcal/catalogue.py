# SPDX-License-Identifier: BSD-3-Clause
"""The physical effects that sepcal knows, model by model."""

from sepcal import _core
from sepcal.aircraft import Aero, RigidAircraft
from sepcal.arguments import checked
from sepcal.own_state_model import AnyModel, as_model
from sepcal.trajectories import FlightPath

PROBES = tuple(name for name, _ in _core.shipped_probes())


@checked
def effects(model: AnyModel | str) -> list[_core.CataloguedEffect]:
    """The catalogue of a probe, of a probe's name, or of a model of your own.

    Raises:
        Error: A model that takes no flight; a name that is none of PROBES: of a probe that ships,
            as "magnetometer" (with attitude) and "magnetometer-norm" (its field's strength alone).

    Example:
        >>> [effect.name for effect in sepcal.effects("magnetometer") if "current" in effect.name]
        ['bias[current_a]', 'bias[delay(current_a)]', 'eddy_currents']
    """
    if isinstance(model, Aero | RigidAircraft | FlightPath) or model == "aircraft":
        raise _core.Error(
            "an aircraft's effects are regressors, Cm[alpha^2], and its sensors', imu_late: "
            "diagnose() tries them, and `sepcal-aircraft effects` lists them"
        )
    if not isinstance(model, str):
        return _core.effects_of(as_model(model)._core)
    if model not in PROBES:
        raise _core.Error(f"there is no probe '{model}'; known: {', '.join(PROBES)}")
    return _core.effects(model)
