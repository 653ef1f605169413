# SPDX-License-Identifier: BSD-3-Clause
"""A flight in 300 forms of the world gives the plain answer, with a note of the form."""

from pathlib import Path

import pytest

import sepcal
from mutated_forms import TRUTH, Form, draw_form, fly, write

FORMS = 300


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return fit(write(tmp_path_factory.mktemp("plain"), Form()))


def fit(file: Path):
    return sepcal.fit(sepcal.PitotStatic(), sepcal.read_csv(file))


def test_the_plain_file_gives_the_truth_without_a_note(plain, tmp_path):
    assert sepcal.read_csv(write(tmp_path, Form())).notes == []
    for name, truth in TRUTH.items():
        assert abs(plain[name].value - truth) < 4 * plain[name].standard_error, name


@pytest.mark.parametrize("seed", range(FORMS))
def test_a_form_is_read_as_a_person_reads_it(seed, plain, tmp_path):
    form = draw_form(seed)
    file = write(tmp_path, form)
    flight = sepcal.read_csv(file)
    assert form.is_plain or flight.notes or form.head != "sepcal" or form.between == "", form
    result = sepcal.fit(sepcal.PitotStatic(), flight)
    lost = 1 if form.end == "cut" else 0
    assert flight.rows in (len(fly()["time_s"]) - lost, len(fly()["time_s"])), form
    for name in TRUTH:
        # A row less moves an answer by a few hundredths of its error; time in other digits by less.
        allowed = (0.3 if lost else 1e-6) * plain[name].standard_error
        assert abs(result[name].value - plain[name].value) <= allowed, (form, name)
