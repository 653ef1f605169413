# SPDX-License-Identifier: BSD-3-Clause
"""monte_carlo(): the same study on any executor, failures on record, statistics by hand."""

import io
import pickle
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from itertools import islice

import numpy as np
import pytest
from numpy.random import SeedSequence, default_rng
from numpy.testing import assert_array_equal
from scipy.stats import beta
from scipy.stats import t as student_t

import sepcal
from trial_functions import TRUTH, draw_record, fail_on_seventh, fit_scalar, give_what_stays

TRIALS = 24
TUBE = sepcal.SimulatedTrial(sepcal.PitotStatic(), simulation={"rows": 120}, samples=20)


def check_same(study, expected):
    """Bit for bit."""
    assert [record.index for record in study.trials] == [record.index for record in expected.trials]
    assert study.names == expected.names
    for mine, other in zip(study.fits, expected.fits, strict=True):
        assert_array_equal(mine.values, other.values)
        assert_array_equal(mine.standard_errors, other.standard_errors)
        assert (mine.status, mine.message) == (other.status, other.message)
    assert [record.failure and record.failure.message for record in study.trials] == [
        record.failure and record.failure.message for record in expected.trials
    ]


@pytest.fixture(scope="module")
def serial():
    return sepcal.monte_carlo(fit_scalar, TRIALS, seed=3, truth=TRUTH)


@pytest.mark.parametrize("workers", [1, 2, 3])
@pytest.mark.parametrize("make", [ThreadPoolExecutor, ProcessPoolExecutor])
@pytest.mark.parametrize("batch", [1, 5])
def test_the_executor_does_not_matter(serial, make, workers, batch):
    study = sepcal.monte_carlo(
        fit_scalar, TRIALS, seed=3, truth=TRUTH, executor=partial(make, workers), batch=batch
    )
    check_same(study, serial)
    assert str(study) == str(serial)


def test_trials_have_the_seeds_that_numpy_spawns(serial):
    for index, sequence in enumerate(SeedSequence(3).spawn(TRIALS)):
        expected = fit_scalar(default_rng(sequence))
        assert_array_equal(serial.estimates[index], expected.values)
        again = fit_scalar(serial.trials[index].rng)
        assert_array_equal(again.values, expected.values)


def test_a_study_can_go_on(serial):
    first = sepcal.monte_carlo(fit_scalar, 10, seed=3)
    rest = sepcal.monte_carlo(fit_scalar, range(10, TRIALS), seed=3)
    check_same(sepcal.MonteCarlo([*rest.trials, *first.trials], TRUTH), serial)
    with pytest.raises(sepcal.Error, match="two records have the same index"):
        sepcal.MonteCarlo([*rest.trials, *rest.trials])


@pytest.mark.parametrize("executor", [None, partial(ProcessPoolExecutor, 2)])
def test_a_failed_trial_is_on_record(executor):
    study = sepcal.monte_carlo(fail_on_seventh, 12, executor=executor)
    (failed,) = study.failed
    assert (failed.index, failed.value) == (7, None)
    assert (failed.failure.type, failed.failure.message) == (
        "ValueError",
        "seven is not for trying",
    )
    assert "in fail_on_seventh" in failed.failure.traceback
    with pytest.raises(ValueError, match="seven"):
        fail_on_seventh(failed.rng, failed.index)
    assert_array_equal(study["index"], [index for index in range(12) if index != 7])
    assert study["row"].shape == (11, 3)
    assert study.names == ("draw", "index")
    assert "12 trials: 1 failed" in str(study)
    assert "trial 7 failed: ValueError: seven is not for trying" in str(study)


def test_a_trial_may_exit():
    study = sepcal.monte_carlo(lambda rng: sys.exit(3), 2)
    assert [record.failure.type for record in study.failed] == ["SystemExit"] * 2
    assert str(study).startswith("all 2 trials failed; trial 0: SystemExit: 3")


def test_statistics_by_hand(serial):
    estimates = np.array([fit.values for fit in serial.fits])
    stated = np.array([fit.standard_errors for fit in serial.fits])
    truth = np.array([TRUTH[name] for name in serial.names])
    errors = estimates - truth
    half = student_t.ppf(0.95, 60 - 3) * stated
    hits = np.count_nonzero(np.abs(errors) <= half, axis=0)
    assert serial.names == ("a", "c", "b")
    assert_array_equal(serial.truth, np.tile(truth, (TRIALS, 1)))
    for i, one in enumerate(serial.summary(level=0.9).values()):
        assert one.bias == pytest.approx(errors[:, i].mean(), rel=1e-12)
        assert one.scatter == pytest.approx(errors[:, i].std(ddof=1), rel=1e-12)
        assert one.bias_error == pytest.approx(errors[:, i].std(ddof=1) / TRIALS**0.5, rel=1e-12)
        assert one.rms_error == pytest.approx(np.sqrt((errors[:, i] ** 2).mean()), rel=1e-12)
        assert one.standard_error == pytest.approx(np.sqrt((stated[:, i] ** 2).mean()), rel=1e-12)
        assert one.coverage == hits[i] / TRIALS
        low = beta.ppf(0.025, hits[i], TRIALS - hits[i] + 1)
        assert one.coverage_limits[0] == pytest.approx(low, rel=1e-7)
        assert one.truth == pytest.approx(truth[i], rel=1e-15)
        assert one.trials == TRIALS
    assert serial.statuses == ["converged"] * TRIALS


def test_without_a_truth_there_is_no_bias():
    study = sepcal.monte_carlo(fit_scalar, 5, seed=3)
    one = study.summary()["a"]
    assert np.isnan([one.truth, one.bias, one.bias_error, one.rms_error, one.coverage]).all()
    assert one.scatter == pytest.approx(study["a"].std(ddof=1), rel=1e-12)
    assert "5 trials: 5 converged" in str(study)


def test_a_truth_that_differs_from_trial_to_trial():
    def trial(rng):
        truth = {"a": rng.uniform(0.5, 1.5)}
        record = draw_record(rng)
        record["z"] += (truth["a"] - TRUTH["a"]) * np.cos(record["eta"] + TRUTH["b"])
        return sepcal.fit(sepcal.ScalarExample1(), record, samples=20, threads=1), truth

    study = sepcal.monte_carlo(trial, 30)
    column = study.names.index("a")
    assert len(set(study.truth[:, column])) == 30
    errors = study["a"] - study.truth[:, column]
    assert study.summary()["a"].bias == pytest.approx(errors.mean(), rel=1e-12)
    assert np.isnan(study.truth[:, study.names.index("c")]).all()


def test_a_fixed_parameter_has_no_standard_error():
    def trial(rng):
        model, record = sepcal.ScalarExample1(), draw_record(rng)
        return sepcal.fit(model, record, fix={"b": 0.1}, samples=20, threads=1)

    study = sepcal.monte_carlo(trial, 4, truth=TRUTH)
    one = study.summary()["b"]
    assert (one.trials, one.bias, one.scatter) == (4, 0.0, 0.0)
    assert np.isnan([one.standard_error, one.coverage]).all()
    assert [fit.degrees_of_freedom for fit in study.fits] == [58] * 4


def test_a_probe_is_flown_and_fitted():
    study = sepcal.monte_carlo(TUBE, 40, executor=partial(ProcessPoolExecutor, 2))
    check_same(study, sepcal.monte_carlo(TUBE, 40))
    truth = TUBE.fly(default_rng(0)).truth
    assert dict(zip(study.names, study.truth[0], strict=True)) == truth
    summary = study.summary()
    # An interval covers 95 +- 3.4 % (one sigma of 40 trials): below 75 % has a probability of 2e-5.
    assert all(one.coverage > 0.75 for one in summary.values() if one.name != "w_d")
    # w_d is held: no standard error, and no error.
    assert (summary["w_d"].rms_error, summary["w_d"].trials) == (0.0, 40)


def test_whole_fits_on_request():
    study = sepcal.monte_carlo(TUBE, 2, keep_fits=True)
    calibration, truth = study.values[0]
    assert isinstance(calibration, sepcal.Calibration)
    assert truth == TUBE.fly(study.trials[0].rng).truth
    check_same(study, sepcal.monte_carlo(TUBE, 2))


def test_records_are_small():
    study = sepcal.monte_carlo(TUBE, 1)
    assert len(pickle.dumps(study.trials[0])) < 1500  # the calibration: 14,000


def test_records_come_as_trials_complete():
    with ThreadPoolExecutor(2) as pool:
        streamed = sepcal.stream_trials(fit_scalar, TRIALS, seed=3, executor=pool)
        some = list(islice(streamed, 6))
        streamed.close()
    study = sepcal.MonteCarlo(some, TRUTH)
    assert len(study) == 6
    whole = sepcal.monte_carlo(fit_scalar, TRIALS, seed=3)
    for record in study.trials:
        assert_array_equal(record.value.values, whole.fits[record.index].values)


def test_an_interrupt_cancels_what_is_pending():
    ran = []

    def trial(rng, index):
        ran.append(index)
        return float(index)

    def interrupt(done, total):
        assert total == 5000
        if done == 3:
            raise KeyboardInterrupt

    with ThreadPoolExecutor(2) as pool:
        with pytest.raises(KeyboardInterrupt):
            sepcal.monte_carlo(trial, 5000, executor=pool, progress=interrupt)
        assert pool.submit(len, "left open").result() == 9
    assert len(ran) < 1000


def test_progress(monkeypatch, capsys):
    seen = []
    sepcal.monte_carlo(
        lambda rng: 1.0, 3, progress=lambda done, total: seen.append(f"{done} of {total}")
    )
    assert seen == ["1 of 3", "2 of 3", "3 of 3"]
    sepcal.monte_carlo(lambda rng: 1.0, 4)
    sepcal.monte_carlo(lambda rng: 1.0, 4, progress=False)
    assert capsys.readouterr().err == ""
    sepcal.monte_carlo(lambda rng: 1.0, 4, progress=True)
    shown = capsys.readouterr().err
    assert "\r[##########..............................]  25 %" in shown
    assert shown.endswith("[########################################] 100 %\n")
    terminal = io.StringIO()
    terminal.isatty = lambda: True
    monkeypatch.setattr(sys, "stderr", terminal)
    sepcal.monte_carlo(lambda rng: 1.0, 2)
    assert "50 %" in terminal.getvalue()


def test_numbers_and_anything_else():
    study = sepcal.monte_carlo(lambda rng: rng.uniform(), 50, truth={"value": 0.5})
    assert_array_equal(study["value"], study.values)
    assert study.summary()["value"].bias == pytest.approx(np.mean(study.values) - 0.5, abs=1e-15)
    assert np.isnan(study.summary()["value"].coverage)
    words = sepcal.monte_carlo(lambda rng: "done", 2)
    assert words.values == ["done"] * 2
    assert "a trial gave str, no estimates" in str(words)
    with pytest.raises(sepcal.Error, match="a trial gave str"):
        words.summary()


def test_a_result_that_cannot_be_pickled_is_on_record():
    study = sepcal.monte_carlo(give_what_stays, 6, executor=partial(ProcessPoolExecutor, 2))
    assert [record.index for record in study.failed] == [2, 4]
    stays, gone = (record.failure for record in study.failed)
    assert (stays.type, stays.message) == (
        "RuntimeError",
        "the result can't be pickled: RuntimeError: this one stays",
    )
    assert "in __reduce__" in stays.traceback
    assert gone.type == "ValueError"
    assert gone.message.startswith("the result can't be unpickled: ValueError: invalid literal")
    here = sepcal.monte_carlo(give_what_stays, 6, executor=partial(ThreadPoolExecutor, 2))
    assert here.failed == []
    assert study.values == [here.values[index] for index in (0, 1, 3, 5)]


def test_defaults_are_no_index():
    def trial(rng, rows=10, *, noise=0.3):
        return {"rows": rows, "noise": noise}

    assert set(sepcal.monte_carlo(trial, 3)["rows"]) == {10}
    assert sepcal.monte_carlo(partial(fail_on_seventh, index=2), 3)["index"].tolist() == [2] * 3


def test_the_fields_strength_without_a_rotation():
    still = {"parameters": {"eta_x": 0, "eta_y": 0, "eta_z": 0}, "rows": 300}
    trial = sepcal.SimulatedTrial(sepcal.Magnetometer(field_strength=50), simulation=still)
    study = sepcal.monte_carlo(trial, 3)
    assert study.statuses == ["converged"] * 3
    # Nine parameters of three flights: beyond five standard errors in one of 65,000 runs.
    assert np.all(np.abs(study.estimates - study.truth) < 5 * study.standard_errors)


def test_threads_are_one_to_a_worker():
    assert TUBE.options["threads"] == 1
    assert sepcal.SimulatedTrial(sepcal.PitotStatic(), threads=2).options["threads"] == 2
