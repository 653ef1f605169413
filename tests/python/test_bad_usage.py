# SPDX-License-Identifier: BSD-3-Clause
"""Wrong command lines: exit 2 and one line that names the option and the way out."""

import pytest

from apps import Bench, assert_one_line, assert_refused, read_folder

VERBS = ("check", "fit", "compare", "apply", "simulate", "effects", "diagnose", "add", "export")

# Options of fit that both apps refuse, with what the line has to say.
NONSENSE: list[tuple[tuple[str, ...], tuple[str, ...]]] = [
    (("--bounds", "eps_roll=0,1"), ("'eps_roll'", "odel has: lambda_")),
    (("--fix", "eps_roll=0"), ("'eps_roll'", "odel has: lambda_")),
    (("--free", "eps_roll"), ("--free eps_roll", "odel has: lambda_")),
    (("--bounds", "{last}"), ("--bounds {last}", "NAME=LO,HI")),
    (("--bounds", "{last}=1"), ("--bounds {last}=1", "NAME=LO,HI")),
    (("--bounds", "{last}=1,2,3"), ("--bounds {last}=1,2,3", "NAME=LO,HI")),
    (("--bounds", "=0,1"), ("--bounds =0,1", "NAME=LO,HI")),
    (("--bounds", "{last}=low,1"), ("--bounds {last}: 'low' is not a number",)),
    (("--bounds", "{last}=nan,1"), ("--bounds", "'nan' is not a number")),
    (("--bounds", "{last}=0.2,-0.2"), ("bounds of '{last}'", "lower must be below the upper")),
    (("--bounds", "{last}=0.1,0.1"), ("bounds of '{last}'", "fix it")),
    (("--fix", "{last}"), ("--fix {last}", "NAME=VALUE")),
    (("--fix", "{last}="), ("--fix", "'' is not a number")),
    (("--fix", "{last}=0x10"), ("--fix", "'0x10' is not a number")),
    (("--free", "{last}", "--fix", "{last}=0"), ("--free {last}", "--fix {last}", "keep one")),
    (("--fix", "{last}=0", "--bounds", "{last}=-1,1"), ("--fix {last}", "--bounds {last}")),
    (
        ("--stage-one-segments", "taxi"),
        (
            "flight.csv",
            "stage one (--stage-one-segments)",
            "'taxi'",
            "FROM:TO",
            "the labels are: {label}, ",
        ),
    ),
    (
        ("--stage-two-segments", "taxi"),
        (
            "flight.csv",
            "stage two (--stage-two-segments)",
            "'taxi'",
            "FROM:TO",
            "the labels are: {label}, ",
        ),
    ),
    (("--stage-one-segments", "{label},5000:6000"), ("'5000:6000'", "FROM:TO", "the labels are: ")),
    (("--stage-two-segments", "30:20"), ("'30:20'", "FROM:TO", "the labels are: ")),
    (("--second-stage", "both"), ("--second-stage 'both'", "'auto', 'joint', 'projected'")),
    (("--sampling", "grid"), ("--sampling 'grid'", "'uniform', 'low_discrepancy'")),
    (("--samples", "-1"), ("samples must not be negative",)),
    (("--samples", "many"), ("--samples", "many", "fit --help")),
    (("--samples", "1.5"), ("--samples", "1.5", "fit --help")),
    (("--threads", "-1"), ("--threads must not be negative",)),
    (("--threads", "some"), ("--threads", "some", "fit --help")),
    (("--threads", "1025"), ("--threads 1025", "at most 1024")),
    (("--threads", "100000000"), ("--threads", "at most 1024")),
    (("--seed", "-1"), ("--seed must not be negative", "fit --help")),
    (("--seed", "18446744073709551616"), ("--seed 18446744073709551616", "at most")),
    (("--seed", "once"), ("--seed", "once", "fit --help")),
    (("--noise", "airspeed=0.1"), ("'airspeed'", "the model has: {output}, ")),
    (("--noise", "{output}=0.1"), ("noise is given, but not for output", "every output")),
    (("--noise-tolerance", "-1"), ("--noise-tolerance", "positive")),
    (("--noise-tolerance", "tight"), ("--noise-tolerance", "tight", "fit --help")),
    (("--effect", "magic"), ("there is no effect 'magic'", "known: ")),
    (("--effect", "magic[time]"), ("there is no effect 'magic[time]'", "[driver]")),
    (("--effect", "{port}[flaps_deg]"), ("no channel 'flaps_deg'", "the record has: time, ")),
    (("--effect", "{port}[{output}]"), ("'{output}' is what is measured", "another channel")),
    (("--effect", "{port}[time^0]"), ("the power '0'", "from 1 to 9")),
    (("--effect", "{port}[spline(time,2)]"), ("spline(x,k)", "3 to 1000")),
    (("--effect", "{port}[time"), ("write port[driver]",)),
    (("--effect", "{port}[time]", "--effect", "{port}[time]"), ("'{port}[time].", "belongs to")),
    (("--effect", "time_offset", "--bounds", "time_offset.tau=-inf,1"), ("--bounds", "-inf")),
    (("--altitude", "3"), ("--altitude", "fit --help")),
    (("another.csv",), ("another.csv: no such file",)),
    (("another.txt",), ("another.txt", "fit --help")),
]
LAST = {"sepcal-pitot": "eps_phi", "sepcal-mag": "alpha_yz"}
LABEL = {"sepcal-pitot": "wind_circle_1", "sepcal-mag": "figure_eight"}
OUTPUT = {"sepcal-pitot": "vn", "sepcal-mag": "mx"}
PORT = {"sepcal-pitot": "wind", "sepcal-mag": "bias"}


@pytest.mark.parametrize(
    ("options", "words"), NONSENSE, ids=[" ".join(options) for options, _ in NONSENSE]
)
def test_nonsense(bench: Bench, options: tuple[str, ...], words: tuple[str, ...]):
    names = {
        "last": LAST[bench.app],
        "label": LABEL[bench.app],
        "output": OUTPUT[bench.app],
        "port": PORT[bench.app],
    }
    options = tuple(text.format(**names) for text in options)
    words = tuple(text.format(**names) for text in words)
    assert_refused(bench, "fit", "flight.csv", *bench.options, *options, words=words)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), ("--k-alpha K", "--k-beta K", "1/rad")),
        (("--k-alpha", "4.5"), ("--k-alpha K", "--k-beta K")),
        (("--k-beta", "4.5"), ("--k-alpha K", "--k-beta K")),
        (("--k-alpha", "0", "--k-beta", "4.5"), ("--k-alpha is 0", "1/rad", "above zero")),
        (("--k-alpha", "4.5", "--k-beta", "-3"), ("--k-beta is -3", "1/rad", "above zero")),
        (("--k-alpha", "nan", "--k-beta", "4.5"), ("--k-alpha", "1/rad", "above zero")),
        (("--k-alpha", "high", "--k-beta", "4.5"), ("--k-alpha", "high", "fit --help")),
    ],
)
def test_sensitivities(pitot: Bench, options: tuple[str, ...], words: tuple[str, ...]):
    assert_refused(pitot, "fit", "flight.csv", *options, words=words)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--lever-arm", "0.35,0"), ("--lever-arm 0.35,0", "three numbers")),
        (("--lever-arm", "0.35,0,0,0"), ("--lever-arm 0.35,0,0,0", "three numbers")),
        (("--lever-arm", "0.35,0,long"), ("--lever-arm", "'long' is not a number")),
        (("--probe", "pitot-static"), ("--probe is pitot-static", "--k-alpha", "five-hole probe")),
        (("--probe", "venturi"), ("--probe venturi", "known: five-hole, vane-boom, pitot-static")),
    ],
)
def test_probe_options(pitot: Bench, options: tuple[str, ...], words: tuple[str, ...]):
    command = ("fit", "flight.csv", "--k-alpha", "4.5", "--k-beta", "4.5", *options)
    assert_refused(pitot, *command, words=words)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--field", "19.7,-1.4"), ("--field 19.7,-1.4", "three numbers", "north, east, down")),
        (("--field", "0,0,0"), ("field", "no strength")),
        (("--field", "19.7,-1.4,deep"), ("--field", "'deep' is not a number")),
        (("--field", "19.7, -1.4, deep"), ("--field", "'deep' is not a number")),
        (("--field", "19.7 -1.4 49.4"), ("--field 19.7 -1.4 49.4", "three numbers")),
        (("--field", "19.7", "1.4", "49.4"), ("not expected", "put commas and no blanks between")),
        (
            ("--field", "19.7,", "1.4,", "49.4"),
            ("not expected", "put commas and no blanks between"),
        ),
        (("--field", "1,2,3", "--field-strength", "48"), ("--field-strength", "keep --field")),
        (("--field-strength", "0"), ("--field-strength is 0", "in uT, above zero")),
        (("--field-strength", "-48"), ("--field-strength is -48", "above zero")),
        (("--field-strength", "strong"), ("--field-strength", "'strong' is not a number")),
        (("--field-strength", "0.53"), ("an ellipsoid of", "0.53 uT", "check the unit")),
        (("--field-strength", "53", "--fix", "eta_x=0"), ("'eta_x'", "odel has: lambda_x")),
    ],
)
def test_field_options(magnetometer: Bench, options: tuple[str, ...], words: tuple[str, ...]):
    assert_refused(magnetometer, "fit", "flight.csv", *options, words=words)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), ("--help",)),
        (
            ("calibrate",),
            (
                "'calibrate' is no verb",
                "fit, compare, residuals, intervals",
                "--help",
            ),
        ),
        (("fit",), ("FLIGHT is required", "fit --help")),
        (("compare", "flight.csv"), ("CALIBRATION is required", "compare --help")),
        (("diagnose",), ("FLIGHT is required", "diagnose --help")),
        (("diagnose", "flight.csv"), ("CALIBRATION is required", "diagnose --help")),
        (
            ("diagnose", "base.json", "flight.csv"),
            ("the flight stands before the calibration: diagnose flight.csv base.json",),
        ),
        (
            ("diagnose", "base.json", "my flight;.csv"),
            ("the flight stands before the calibration: diagnose 'my flight;.csv' base.json",),
        ),
        (("add", "flight.csv", "base.json"), ("E is required", "add --help")),
        (("apply", "flight.csv", "base.json"), ("--output is required", "apply --help")),
        (("simulate",), ("--output is required", "simulate --help")),
        (("effects", "wind_drift"), ("wind_drift", "effects --help")),
        (("simulate", "-o"), ("-o", "simulate --help")),
    ],
)
def test_incomplete_command_lines(bench: Bench, arguments: tuple[str, ...], words: tuple[str, ...]):
    before = read_folder(bench.folder)
    assert_one_line(bench, bench.run(*arguments), *words)
    assert read_folder(bench.folder) == before


def test_an_output_without_a_name(bench: Bench):
    """An empty shell variable after -o is a mistake, not a wish for no output."""
    assert_one_line(bench, bench.run("fit", "flight.csv", *bench.options, "-o", ""), "-o")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--rows", "-5"), ("--rows must not be negative", "-5")),
        (("--rows", "100000000"), ("100000000", "at most 10000000")),
        (("--rows", "few"), ("--rows", "few", "simulate --help")),
        (("--rate", "0"), ("rate", "above 0")),
        (("--rate", "nan"), ("rate", "above 0")),
        (("--rate", "1e9"), ("rate", "at most 10000")),
        (("--seed", "-1"), ("--seed",)),
        (("--truth", "flight.csv"), ("flight.csv is not a truth file", '{"parameters"')),
        (("--truth", "base.json"), ("base.json", "is unknown; known: model, parameters")),
        (("--truth", "nowhere/truth.json"), ("folder 'nowhere' isn't there", "make it first")),
        (("--hide", "gusts=1"), ("simulate: 'gusts' is no effect", "DRIVER")),
        (("--hide", "time_offset"), ("--hide time_offset", "E=SIZE")),
        (("--hide", "time_offset=late"), ("'late' is not a number",)),
        (("--hide", "time_offset=0.1:0.2"), ("2 sizes", "time_offset.tau")),
        (("--excitation", "lively"), ("'lively'", "rich, poor, third")),
        (("--noise", "brown"), ("'brown'", "white, ar, pink, bursty")),
        (("--decoys", "-1"), ("--decoys must not be negative",)),
        (("--decoys", "2000"), ("2000", "at most 1000")),
    ],
)
def test_simulate_options(bench: Bench, options: tuple[str, ...], words: tuple[str, ...]):
    assert_refused(bench, "simulate", *options, words=words)


@pytest.mark.parametrize("verb", [(), *((verb,) for verb in VERBS)])
def test_help(bench: Bench, verb: tuple[str, ...]):
    """Help is no error and goes to standard output."""
    shown = bench.run(*verb, "--help")
    assert shown.code == 0
    assert "Usage: " + " ".join((bench.app, *verb)) in shown.out
    assert shown.err == ""


def test_help_names_every_verb_and_exit_code(bench: Bench):
    shown = bench.run("--help").out
    for verb in VERBS:
        assert f"\n  {verb} " in shown
    for code in ("0 done", "2 bad input", "4 not identifiable", "5 did not converge"):
        assert code in shown


def test_version(bench: Bench):
    shown = bench.run("--version")
    assert (shown.code, shown.err) == (0, "")
    assert shown.out.startswith("sepcal 0.")
