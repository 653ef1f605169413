# SPDX-License-Identifier: BSD-3-Clause
"""scripts/parts/sbom.py: readelf and dpkg asked again, and a wheel that is made for it."""

from __future__ import annotations

import contextlib
import io
import json
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PARTS = ROOT / "scripts" / "parts"
sys.path.insert(0, str(PARTS))

import sbom  # noqa: E402

BUILT = [
    *(file for file in sorted((ROOT / "build" / "apps").glob("sepcal*")) if file.is_file()),
    *sorted((ROOT / "build" / "python" / "sepcal").glob("*.so")),
]
# Of CMakeLists.txt, what is no package of dpkg's or is in the C library.
NOT_LISTED = {"Threads"}
LIBRARIES = {  # by CMake's names, where the binary names a library
    "NLopt": "libnlopt",
    "fmt": "libfmt",
    "ZLIB": "libz.so",
    "zstd": "libzstd",
}

pytestmark = pytest.mark.skipif(
    not shutil.which("dpkg-query") or not shutil.which("readelf"), reason="no Debian"
)


def bill_of(*binaries: Path) -> dict:
    """The document of these. What dpkg was asked once is known to the next."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        assert sbom.main([str(binary) for binary in binaries]) == 0
    return json.loads(printed.getvalue())


@pytest.fixture(scope="module")
def document() -> dict:
    """Of what is built."""
    if len(BUILT) < 3:
        pytest.skip("build/ has no programs")
    return bill_of(*BUILT)


def test_it_has_what_spdx_asks_for(document: dict) -> None:
    assert document["spdxVersion"] == "SPDX-2.3"
    assert document["dataLicense"] == "CC0-1.0"
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", document["creationInfo"]["created"])
    assert document["creationInfo"]["creators"][0].startswith("Tool: ")
    things = [*document["packages"], *document["files"]]
    names = [thing["SPDXID"] for thing in things]
    assert len(names) == len(set(names))
    assert all(re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", name) for name in names)
    for package in document["packages"]:
        assert {"name", "downloadLocation", "licenseDeclared", "versionInfo"} <= package.keys()
    for file in document["files"]:
        assert "SHA1" in {one["algorithm"] for one in file["checksums"]}
    known = {"SPDXRef-DOCUMENT", *names}
    for relation in document["relationships"]:
        assert {relation["spdxElementId"], relation["relatedSpdxElement"]} <= known
    texts = {one["licenseId"] for one in document.get("hasExtractedLicensingInfos", [])}
    told = " ".join(package["licenseDeclared"] for package in document["packages"])
    assert set(re.findall(r"LicenseRef-[\w.-]+", told)) == texts


def test_every_library_that_a_binary_names_is_there(document: dict) -> None:
    """As readelf prints it, and dpkg owns it."""
    linked = {
        (relation["spdxElementId"], relation["relatedSpdxElement"])
        for relation in document["relationships"]
        if relation["relationshipType"] == "DYNAMIC_LINK"
    }
    versions = {package["name"]: package["versionInfo"] for package in document["packages"]}
    for binary in BUILT:
        loads = subprocess.run(["ldd", binary], capture_output=True, text=True, check=True).stdout
        paths = dict(re.findall(r"^\s+(\S+) => (/\S+)", loads, re.M))
        for name in sbom.needed(binary):
            if name not in paths:
                continue  # the loader itself
            owner = sbom.owner(Path(paths[name])).partition(":")[0]
            ids = sbom.Binary(binary.name, binary).id, sbom.Package(owner, "", "").id
            assert ids in linked
            asked = ["dpkg-query", "-W", "-f=${Version}\n", owner]
            told = subprocess.run(asked, capture_output=True, text=True, check=True).stdout
            assert versions[owner] in told.splitlines()


def test_what_cmake_looks_for_is_listed(document: dict) -> None:
    """Every find_package and find_path of the library and the programs."""
    text = "".join((ROOT / name / "CMakeLists.txt").read_text() for name in (".", "apps"))
    asked = set(re.findall(r"^\s*find_(?:package|path)\((\w+)", text, re.M)) - NOT_LISTED
    needed = " ".join(name for binary in BUILT for name in sbom.needed(binary))
    for name in asked:
        assert (name in sbom.COMPILED_IN) != (name in LIBRARIES), name
        assert LIBRARIES.get(name, "") in needed
    assert len(asked) >= 10
    compiled_in = [
        relation
        for relation in document["relationships"]
        if relation["relationshipType"] == "STATIC_LINK"
    ]
    assert len(compiled_in) == len(sbom.COMPILED_IN) + 1  # pybind11


def test_every_licence_is_known(document: dict) -> None:
    """But for what is no package of Debian's."""
    unknown = {p["name"] for p in document["packages"] if p["licenseDeclared"] == "NOASSERTION"}
    assert unknown <= {"numpy"}


def test_the_same_binaries_give_the_same_bill(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    program = Path(shutil.which("readelf") or "")
    first = bill_of(program)
    assert first == bill_of(program)
    assert first["creationInfo"]["created"] == "2023-11-14T22:13:20Z"


def test_what_a_wheel_brings_is_its_file_and_no_package(tmp_path: Path) -> None:
    """A program, and under its library's name another."""
    program = Path(shutil.which("readelf") or "")
    library = next(name for name in sbom.needed(program) if name.startswith("libz."))
    wheel = tmp_path / "sepcal-0.1.0-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as opened:
        opened.write(program, "sepcal/bin/sepcal")
        opened.write(sbom.loaded_from()[library], f"sepcal.libs/{library}")
        opened.writestr("sepcal/__init__.py", "")
    document = bill_of(wheel)
    files = {file["fileName"]: file["SPDXID"] for file in document["files"]}
    assert set(files) == {
        f"./{wheel.stem}/sepcal/bin/sepcal",
        f"./{wheel.stem}/sepcal.libs/{library}",
    }
    assert "zlib1g" not in {package["name"] for package in document["packages"]}
    pairs = {(one["spdxElementId"], one["relatedSpdxElement"]) for one in document["relationships"]}
    assert tuple(files.values()) in pairs or tuple(files.values())[::-1] in pairs


def test_what_a_wheel_says_it_was_linked_with_is_in_place_of_what_a_compiler_finds(
    tmp_path: Path,
) -> None:
    """Its copyright files."""
    wheel = tmp_path / "sepcal-0.1.0-py3-none-any.whl"
    text = "Format: https://www.debian.org/\n\nFiles: *\nCopyright: 2020 someone\nLicense: MIT\n"
    with zipfile.ZipFile(wheel, "w") as opened:
        opened.write(shutil.which("readelf") or "", "sepcal/bin/sepcal")
        opened.writestr("sepcal-0.1.0.dist-info/licenses/linked/nlopt_2.7.1-5", text)
    document = bill_of(wheel)
    licences = {package["name"]: package["licenseDeclared"] for package in document["packages"]}
    assert licences["nlopt"] == "MIT"
    versions = {package["name"]: package["versionInfo"] for package in document["packages"]}
    assert versions["nlopt"] == "2.7.1-5"
    assert "libeigen3-dev" not in licences


def test_licences_are_told_as_spdx_tells_them() -> None:
    """The licence of all files; others in a comment; one that SPDX doesn't list with its text."""
    text = (
        "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n\n"
        "Files: *\nCopyright: 2020 someone\nLicense: BSD-3-clause or House-rules\n\n"
        "Files: a.c\nCopyright: 2021 someone\nLicense: LGPL-2.1+\n\n"
        "Files: debian/*\nCopyright: 2022 someone\nLicense: GPL-2+\n\n"
        "License: House-rules\n No shoes.\n .\n No smoking.\n"
    )
    bill = sbom.Bill()
    paragraphs = sbom.read_paragraphs(text)
    licence = sbom.find_licence(paragraphs, "house", bill)
    assert licence == "BSD-3-Clause OR LicenseRef-House-rules"
    assert sbom.find_others(paragraphs) == ("LGPL-2.1+",)
    assert bill.texts == {"LicenseRef-House-rules": "No shoes. . No smoking."}
    assert sbom.find_licence(sbom.read_paragraphs("Prose."), "gcc-12", bill).startswith("GPL-3.0")
    assert sbom.find_licence(sbom.read_paragraphs("Prose."), "house", bill) == "NOASSERTION"


def test_what_is_no_binary_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("text")
    for file, words in ((tmp_path / "a.txt", "neither"), (tmp_path / "b", "no file")):
        done = subprocess.run(
            [sys.executable, PARTS / "sbom.py", file], capture_output=True, text=True, check=False
        )
        assert done.returncode == 2
        assert words in done.stderr
