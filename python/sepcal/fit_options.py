# SPDX-License-Identifier: BSD-3-Clause
# Made by scripts/lint --fix from cpp/src/flight/schema/option_fields.hpp.
"""The keyword arguments of fit(), with their types."""

from collections.abc import Mapping, Sequence
from typing import Literal, TypedDict

from sepcal.own_effect import Effect


class FitOptions(TypedDict, total=False):
    """Every choice of a fit; None, like leaving it out, means the default, given in brackets.

    `effects` takes Effects of your own, too. Of a model that is no probe each linear parameter and
    each input is a port, and its component is called s: "k[temp_degc]" adds the parameter
    k[temp_degc].s. Options of a flight's columns and rows, and `free`, are for flights alone.

    Attributes:
        effects: Physical effects that join the model: port[driver], and those that `effects` lists
            [none].
        stage_one_segments: Maneuvers or times that stage one uses, e.g. wind_circle_1,510.9:530
            [all].
        stage_two_segments: The same for stage two [all].
        bounds: Bounds of parameters, in their units; either may be left open, of a nonlinear one
            with a start [the model's].
        start: Where stage two starts, by nonlinear parameter; then nothing is sampled, and those
            not named start from the middle of their bounds, or from zero without [sampling finds
            it].
        fix: Parameters held at a value and not estimated [none].
        free: Parameters freed that the probe holds by default [none].
        noise: Noise standard deviation of every output, which is then held [estimated, Eqs. 24-26].
        prior: A normal prior, mean and standard deviation: what is known of a parameter beforehand,
            which counts as one more measurement of it [none].
        search: How stage one looks for minima: among samples, or by NLopt's global search, which
            asks for the profile cost at most `samples` times ["sampling"].
        samples: Samples of the nonlinear parameters in stage one; 0: none [500].
        sampling: How samples are spread: independent draws, or a shifted Halton sequence
            ["uniform"].
        sampling_distribution: Mean and standard deviation of nonlinear parameters, whose samples
            are then normal, cut at the bounds; it has no part in the fit itself [uniform].
        screens: Evaluates Eqs. 17 and 18 at every sample, and uses only those with ratios of at
            most t_1 and t_2 within l_2, and, with convex, positive second derivatives: any of t_1,
            t_2, l_2, convex [not evaluated].
        seed: Of the samples; the same seed gives the same result, on any number of threads [0].
        descents: Stage one descends from at most so many samples to tell minima apart [8].
        second_stage: What stage two is over: all parameters, the nonlinear ones with the linear
            ones solved inside, or as stage one finds a unique minimum or not (Step 5); from a start
            the latter, and the former if it fails ["auto"].
        jacobian: Of a projected stage two: Kaufman's, or Golub and Pereyra's ["kaufman"].
        loss: What a whitened residual costs; huber and cauchy forgive outliers and make stage two
            joint ["squares"].
        loss_width: Where the loss begins to forgive, in standard deviations of the noise; 0: 1.345
            for huber, 2.385 for cauchy [0.0].
        noise_tolerance: R and the parameters alternate until every relative change of R is below
            this, Eq. 26; the paper's is 0.05 [1e-10].
        noise_iterations: At most so many alternations [100].
        iterations: At most so many of one nonlinear minimisation [200].
        coloured_errors: Standard errors allow for residuals that are not white; without, they equal
            the white ones [True].
        method: Of a model with a state: states are integrated; or noise drives them too, and its
            size is estimated ["output-error"].
        hessian: Of filter error's standard errors and last steps: the expected one, or the observed
            one where that is positive definite ["fisher"].
        process_noise: Of a model with a state: noise that drives it, by the names of its table
            `noise`, as roots of spectral densities in the table's unit (in discrete time: standard
            deviations a row); by output error it has no part in the fit, and standard errors allow
            for it; by filter error these are held [none; of a path the white noise of the inertial
            unit's readings; by filter error all are estimated].
        threads: Threads, the caller's included, on which the result does not depend; 0: one a core
            [0].
        drop_invalid: Drops rows with a cell that is no number instead of refusing the flight
            [False].
        drop_repeats: Drops the rows between the samples of slow columns that the log holds or
            interpolates, e.g. airspeed; of several the slowest counts [none].
        map: Reads the log's column under another header, e.g. airspeed_kt=TAS [none].
        ignore: As if these columns were not there [none].
        where: Takes only rows in which this holds, e.g. "airspeed > 20 and abs(roll_deg) < 45"
            [all].
        from_time: Takes only rows from this time on [s] [all].
        to_time: Takes only rows up to this time [s] [all].
        delimiter: What parts the file's columns, where it can be read in two ways: ',', ';', '|',
            tab or space [as the file shows].
        decimal: The file's decimal mark, where it can be read in two ways: '.' or ',' [as the file
            shows].
        join: Brings quantities that are logged at other times to the rows of the measured one:
            smooth, linear or held [they stand in one row].
        smooth_inputs: Takes the white noise out of the columns that the model reads as inputs,
            which biases the estimates; the outputs stay as logged [False].

    Example:
        >>> options: sepcal.FitOptions = {"fix": {"w_d": 0.0}, "samples": 100, "seed": 1}
        >>> base = sepcal.fit(sepcal.PitotStatic(), sepcal.datasets.load("pitot"), **options)
        >>> base["w_d"].fixed
        True
    """

    effects: Sequence[str | Effect] | None
    stage_one_segments: str | None
    stage_two_segments: str | None
    bounds: Mapping[str, tuple[float | None, float | None]] | None
    start: Mapping[str, float] | None
    fix: Mapping[str, float] | None
    free: Sequence[str] | None
    noise: Mapping[str, float] | None
    prior: Mapping[str, tuple[float, float]] | None
    search: Literal["sampling", "global"] | str | None
    samples: int | None
    sampling: Literal["uniform", "low_discrepancy"] | str | None
    sampling_distribution: Mapping[str, tuple[float, float]] | None
    screens: Mapping[str, float | bool] | None
    seed: int | None
    descents: int | None
    second_stage: Literal["auto", "joint", "projected"] | str | None
    jacobian: Literal["kaufman", "golub_pereyra"] | str | None
    loss: Literal["squares", "huber", "cauchy"] | str | None
    loss_width: float | None
    noise_tolerance: float | None
    noise_iterations: int | None
    iterations: int | None
    coloured_errors: bool | None
    method: Literal["output-error", "filter-error"] | str | None
    hessian: Literal["fisher", "observed"] | str | None
    process_noise: Mapping[str, float] | None
    threads: int | None
    drop_invalid: bool | None
    drop_repeats: Sequence[str] | None
    map: Mapping[str, str] | None
    ignore: Sequence[str] | None
    where: str | None
    from_time: float | None
    to_time: float | None
    delimiter: str | None
    decimal: str | None
    join: str | None
    smooth_inputs: bool | None
