# SPDX-License-Identifier: BSD-3-Clause
"""The two-stage batch estimator in one call."""

from typing import Unpack, overload

from sepcal import _core
from sepcal.calibration import Calibration
from sepcal.columns import Columns, take_columns, to_labels
from sepcal.flight import Flight
from sepcal.models import Model
from sepcal.options import FitOptions, to_core
from sepcal.results import Fit, to_fields


@overload
def fit(model: Model, data: Flight, **options: Unpack[FitOptions]) -> Calibration: ...


@overload
def fit(model: Model, data: Columns, **options: Unpack[FitOptions]) -> Fit: ...


def fit(model: Model, data: Flight | Columns, **options: Unpack[FitOptions]) -> Fit:
    """Fits a model: samples xi2 and solves xi1 linearly, then maximum likelihood within bounds.

    Sun & Gebre-Egziabher, Steps 2-5. It runs without the GIL, on as many threads as asked for.

    Args:
        model: One of FiveHoleProbe, Magnetometer, ScalarExample1, ScalarExample2.
        data: A Flight (columns with units in their headers; for the probes), or the model's own
            inputs and outputs by name in the units of its tables, each of shape (N,): a dict or a
            DataFrame. There "time" [s] and "maneuver" (labels) are optional and cut the record at
            gaps and changes of label; other columns are ignored. C-contiguous float64 arrays are
            not copied.
        **options: bounds, fixed, noise, priors, stage_one, stage_two, samples, sampling, seed,
            second_stage, noise_tolerance, noise_iterations, iterations, descents, threads, free,
            drop_invalid; FitOptions says what each is.

    Returns:
        A Calibration for a Flight, else a Fit. Non-convergence and what the data do not determine
        are its `status` and `message`.

    Raises:
        Error: Bad input or misuse: one line that names the culprit and the way out.
        TypeError: An option that there isn't, or of the wrong kind.
    """
    if not isinstance(model, Model):
        raise _core.Error(
            f"{type(model).__name__} is no sepcal model; models written in Python are not there "
            "yet: write it in C++, or use one of sepcal's own"
        )
    core_options = to_core(options)
    if isinstance(data, Flight):
        return Calibration._of(_core.calibrate(model._core, data._core, core_options), data)
    if options.get("free") or options.get("drop_invalid"):
        raise _core.Error("free and drop_invalid are for flights; give the data as a sepcal.Flight")
    there = set(data)
    names = [*model.inputs, *model.outputs, *({"time"} & there)]
    columns = take_columns(type(model).__name__, data, dict.fromkeys(names))
    labels = to_labels(data["maneuver"]) if "maneuver" in there else []  # type: ignore[arg-type]
    return Fit(**to_fields(_core.fit(model._core, columns, labels, core_options)))
