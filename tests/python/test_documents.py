# SPDX-License-Identifier: BSD-3-Clause
"""The documents keep their word; test_documented_runs.py runs what they show.

Quoted code is the examples', links resolve, and options, verbs, effects, units and the JSON's keys
are those that there are, all of them.
"""

import ast
import builtins
import json
import re

import pytest

import sepcal
from documents import BLOCKS, DOCUMENTS, EXAMPLES, ROOT, TYPED, run
from sepcal.__main__ import make_parser
from studies.trust.unmeasured import LINE, fly_with

QUOTED = [block for block in BLOCKS if block["mark"].startswith("from ")]
WHOLE = [b for b in BLOCKS if b["language"] == "python" and "import sepcal" in b["text"]]
AIRCRAFT = (
    "check",
    "intervals",
    "fit",
    "two-step",
    "compare",
    "residuals",
    "diagnose",
    "add",
    "apply",
    "track",
    "response",
    "design",
    "simulate",
    "effects",
)  # its verbs
VERBS = (
    "check",
    "fit",
    "compare",
    "residuals",
    "track",
    "intervals",
    "diagnose",
    "add",
    "apply",
    "export",
    "simulate",
    "effects",
    "join",
)

# How many lines of an example a document promises at most.
PROMISES = {"07_own_model.py": 15, "08_own_effect.py": 6, "09_own_effect.cpp": 11}

SCREEN_AND_A_HALF = 900  # words that README has at most


def option_names(text):
    """Every --option in a text."""
    return set(re.findall(r"--[a-z][a-z-]*", text))


@pytest.fixture(scope="module")
def options_in_help():
    """What the verbs of the apps and of fleets take."""
    verbs = dict.fromkeys(("sepcal-pitot", "sepcal-mag"), VERBS) | {"sepcal-aircraft": AIRCRAFT}
    texts = [run(app, verb, "--help") for app in verbs for verb in verbs[app]]
    fleet = make_parser()[1].choices["fleet"]._subparsers._group_actions[0].choices
    texts += [verb.format_help() for verb in fleet.values()]
    return option_names("\n".join(texts))


def read(document):
    """The text of a page in docs/."""
    return (ROOT / "docs" / document).read_text()


@pytest.mark.parametrize("block", QUOTED, ids=[f"{b['document']} {b['mark']}" for b in QUOTED])
def test_quoted_code_stands_in_the_example(block):
    example = ROOT / block["mark"].removeprefix("from ")
    assert f"\n{block['text']}" in f"\n{example.read_text()}"


@pytest.mark.parametrize("block", WHOLE, ids=lambda block: block["document"])
def test_python_in_the_documents_defines_all_that_it_uses(block):
    known = set(dir(builtins)) | {"__name__"}
    used = set()
    for node in ast.walk(ast.parse(block["text"])):
        match node:
            case ast.Name(name, ast.Load()):
                used.add(name)
            case ast.Name(name) | ast.arg(name) | ast.FunctionDef(name):
                known.add(name)
            case ast.Import(names) | ast.ImportFrom(names=names):
                known |= {one.asname or one.name for one in names}
    assert used - known == set()


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda document: document.name)
def test_files_of_the_sources_that_a_document_names_are_there(document):
    ours = r"(?:apps|cpp|docs|examples|lab|python|scripts|tests)"
    named = set(re.findall(rf"`({ours}/[\w./-]+\.\w+)`", document.read_text()))
    assert {name for name in named if not (ROOT / name).exists()} == set()


def test_documents_quote_cpp_python_shell_and_a_whole_model():
    quoted = {block["mark"].removeprefix("from examples/") for block in QUOTED}
    assert {"01_own_model.cpp", "02_five_hole.cpp", "03_five_hole.py", "04_five_hole.sh"} <= quoted
    assert set(PROMISES) <= quoted


@pytest.mark.parametrize("name", ["02_five_hole.cpp", "03_five_hole.py", "04_five_hole.sh"])
def test_a_fit_takes_five_lines_at_most(name):
    block = next(block for block in QUOTED if block["mark"] == f"from examples/{name}")
    assert len(block["text"].splitlines()) <= 5


@pytest.mark.parametrize("name", PROMISES)
def test_own_models_and_effects_are_as_short_as_promised(name):
    block = next(block for block in QUOTED if block["mark"] == f"from examples/{name}")
    assert len(block["text"].splitlines()) <= PROMISES[name]


def test_own_model_has_25_lines_at_most():
    assert len((EXAMPLES / "01_own_model.cpp").read_text().splitlines()) <= 25


def test_readme_is_a_screen_and_a_half():
    assert len((ROOT / "README.md").read_text().split()) <= SCREEN_AND_A_HALF


def test_every_limit_names_a_test_that_shows_it():
    """And what is said after -k is part of a test's name there."""
    limits = re.findall(r"^\*\*.*?(?:\n\n|\Z)", read("scope.md"), re.M | re.S)
    assert limits
    for limit in limits:
        tests = re.findall(r"\]\(\.\./(tests/[\w/.]+)\)(?:,\s+`-k\s+(\w+)`)?", limit)
        assert tests, limit
        for file, part in tests:
            assert not part or re.search(rf"def test_\w*{part}", (ROOT / file).read_text()), limit


def test_the_index_lists_every_page():
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} - {"README.md"}
    assert pages <= set(re.findall(r"\]\(([^)#]+)", read("README.md")))


def anchors(document):
    """What a link may name within a document, as GitHub makes it of the headings."""
    headings = re.findall(r"^#+ (.*)$", document.read_text(), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_resolve(document):
    for target, anchor in re.findall(r"\]\(([^)#]*)#?([^)]*)\)", document.read_text()):
        if target.startswith("https://"):
            continue
        file = (document.parent / target) if target else document
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), f"{target}#{anchor}"


@pytest.mark.parametrize("file", [*DOCUMENTS, *sorted(EXAMPLES.iterdir())], ids=lambda p: p.name)
def test_no_path_of_a_machine(file):
    assert not re.search(r"/(work|tmp|home|root|Users|mnt)/", file.read_text())


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_documents_are_plain_text_without_emojis(document):
    assert document.read_text().isascii()


def test_every_option_in_the_documents_is_in_the_help(options_in_help):
    """The changelog may also name options of before."""
    today = [document for document in DOCUMENTS if document.name != "CHANGELOG.md"]
    text = "\n".join(document.read_text() for document in today)
    said = set(re.findall(r"`(?:(?:fit|diagnose|intervals) )?(--[a-z][a-z-]*)", text))
    for block in TYPED:
        for line in block.splitlines():
            if line.startswith("sepcal-"):
                said |= option_names(line)
    assert said
    assert (
        said - options_in_help - {"--help"} == set()
    )  # which is in every help, but not in its list


def test_every_option_is_explained(options_in_help):
    pages = ("commands.md", "aircraft-reference.md", "fleets.md")
    explained = {name for page in pages for name in option_names(read(page))}
    assert options_in_help - {"--help", "--output"} <= explained


def test_every_verb_in_the_documents_is_in_the_help():
    apps = ("sepcal-pitot", "sepcal-mag", "sepcal-aircraft")
    help_text = {app: run(app, "--help") for app in apps}
    commands = re.findall(r"^(sepcal-\w+) ([a-z-]+)", "\n".join(TYPED), re.M)
    assert commands
    for app, verb in commands:
        assert re.search(rf"^  {verb} ", help_text[app], re.M), f"{app} {verb}"
    explained = set(re.findall(r"^\| `([a-z]+)", read("commands.md"), re.M))
    verbs = {app: text.split("Verbs (each with --help):")[1] for app, text in help_text.items()}
    listed = re.findall(r"^  ([a-z]+)  ", verbs["sepcal-pitot"], re.M)
    assert set(listed) == set(VERBS) <= explained
    listed = re.findall(r"^  ([a-z][a-z-]*)  ", verbs["sepcal-aircraft"], re.M)
    assert set(listed) == set(AIRCRAFT)
    assert set(AIRCRAFT) <= set(re.findall(r"^\| `([a-z-]+)", read("aircraft-reference.md"), re.M))


def test_scripts_and_files_in_typed_commands_exist():
    scripts = re.findall(r"^\./(\S+)", "\n".join(TYPED), re.M)
    assert scripts
    assert all((ROOT / script).is_file() for script in scripts)


def test_every_effect_of_the_catalogue_is_explained():
    rows = re.findall(r"^\| (`.*?`) \|", read("effects.md"), re.M)
    explained = {name.split("[")[0] for row in rows for name in re.findall(r"`(\w+[^`]*)`", row)}
    catalogue = {
        effect["name"].split("[")[0]
        for app in ("sepcal-pitot", "sepcal-mag")
        for effect in json.loads(run(app, "effects", "--json"))["effects"]
    }
    assert catalogue <= explained


def test_every_key_of_the_results_is_explained():
    flight = sepcal.simulate("five-hole", rows=200, hide={"wind[altitude_m]": 0.3})
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    base = sepcal.fit(probe, flight)
    calibration = base.add("wind[altitude_m]").to_dict()
    compared, found = base.compare().to_dict(), base.diagnose(inject={"upwash": 0.5}).to_dict()
    intervals = base.intervals(names=["b_va"]).to_dict()
    objects = [calibration, compared, found, intervals]
    objects += [calibration["options"], calibration["stage_one"], calibration["stage_two"]]
    objects += [calibration["parameters"]["b_va"], calibration["history"][0]]
    objects += [compared["where"][0], compared["channels"][0], compared["windows"][0]]
    objects += [found["effects"][0], found["residual"]["vn"], found["injected"]]
    objects += [found["unexplained"], intervals["parameters"]["b_va"]]
    swinging, _ = fly_with(LINE, "pitot-static", "white", 3, rows=300, sigmas=30.0)
    objects += [sepcal.fit(sepcal.PitotStatic(), swinging).diagnose().to_dict()["unmeasured"][0]]
    words = set(re.findall(r"\w+", read("results.md")))
    assert {key for one in objects for key in one} - words == set()


@pytest.mark.parametrize(
    ("quantity", "kind"),
    [
        ("time", "time"),
        ("yaw", "angle"),
        ("p", "body rate"),
        ("vn", "speed"),
        ("pt", "pressure"),
        ("temp", "temperature"),
        ("rho", "density"),
        ("mx", "magnetic field"),
    ],
)
def test_every_unit_is_listed(quantity, kind):
    """A flight with the quantity in an unknown unit is told the known ones."""
    units = re.search(rf"^\| {kind} \| (.*?) \|$", read("columns.md"), re.M).group(1)
    listed = re.findall(r"`(\w+)`", units)
    is_field = quantity == "mx"
    flown = sepcal.simulate("magnetometer" if is_field else "five-hole", rows=30)
    away = ("rho", "temp") if kind in ("temperature", "density") else (quantity,)
    columns = {name: flown[name] for name in flown if name.partition("_")[0] not in away}
    probe = (
        sepcal.Magnetometer(field=(20, 0, 40))
        if is_field
        else sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(1.0, 0.0, 0.0))
    )
    flight = sepcal.Flight({**columns, f"{quantity}_smoots": flown["time_s"]})
    with pytest.raises(sepcal.Error, match="has no known unit") as refusal:
        sepcal.fit(probe, flight)
    known = str(refusal.value).split("may be logged as: ")[1].split("; ")[0].split(", ")
    assert [f"{quantity}_{unit}" for unit in listed] == known
