# SPDX-License-Identifier: BSD-3-Clause
"""Causes that no channel of the log follows; `scripts/study trust --part unmeasured` has rates."""

import pytest

from sepcal.fitting import fit
from sepcal.flight import Flight
from studies.hidden_effects.cases import calibrate
from studies.trust.asked import MODELS
from studies.trust.by_key import fly_key
from studies.trust.unmeasured import BURST, LINE, NOTHING, fly_with, names


@pytest.mark.parametrize(
    ("cause", "probe", "kind"),
    [
        (BURST, "five-hole", "common_cause"),
        (BURST, "magnetometer", "common_cause"),
        (LINE, "pitot-static", "spectral_line"),
        (LINE, "magnetometer", "spectral_line"),
    ],
)
def test_what_swings_without_a_channel_is_told(cause: str, probe: str, kind: str):
    """Larger than what the study asks for: each is to be found, not four of five."""
    flight, hidden = fly_with(cause, probe, "white", 3, rows=300, sigmas=30.0)
    diagnosis = calibrate(probe, flight).diagnose()
    assert diagnosis.verdict == "unexplained"
    assert kind in [told.kind for told in diagnosis.unmeasured]
    assert names(diagnosis, hidden)
    for told in diagnosis.unmeasured:
        assert told.p_adjusted < 0.01
        assert told.sentence in str(diagnosis)
        assert "not logged: in " in told.sentence
        assert " Hz" in told.sentence
    offsets = diagnosis.unexplained
    assert offsets.significant or "no channel of the log follows it" in diagnosis.sentence


@pytest.mark.parametrize("noise", ["bursty", "resonance 0.3 Hz"])
@pytest.mark.parametrize("probe", ["five-hole", "magnetometer"])
def test_noise_is_no_cause(noise: str, probe: str):
    """Bursts in each output alone, and a resonance: neither a common cause nor a line."""
    flight, _ = fly_with(NOTHING, probe, noise, 5, rows=300)
    assert calibrate(probe, flight).diagnose().unmeasured == []


@pytest.mark.slow
@pytest.mark.parametrize("probe", ["five-hole", "magnetometer"])
def test_noise_of_what_enters_the_model_is_no_cause(probe: str):
    """Of a probe's pressures, of attitudes: it comes into several outputs by the heading."""
    verdicts = []
    for seed in range(871000, 871010):
        _, flown = fly_key(("nothing", probe, "noise of inputs", 0.0, 0, seed))
        diagnosis = fit(MODELS[probe], Flight(flown.columns)).diagnose()
        assert [told.kind for told in diagnosis.unmeasured] == []
        verdicts.append(diagnosis.verdict)
    assert verdicts.count("adequate") >= 8
