# SPDX-License-Identifier: BSD-3-Clause
"""The parts of scripts/docs that need no Sphinx: what they find is planted."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HEADER = """// SPDX-License-Identifier: BSD-3-Clause
// Planted: |r|^2 < 1.
#pragma once
namespace sepcal {
/// Is 5 % of `a<b>`, "x & y".
struct Planted {
  int a = 0;  // first,
              // and more
  int b = 0;
};
}  // namespace sepcal
"""
TAKEN = r"""/// \file
/// Planted: |r|^2 \< 1.
#pragma once
namespace sepcal {
/// Is 5 \% of `a<b>`, "x & y".
struct Planted {
  int a = 0;  ///< first,
  ///< and more
  int b = 0;
};
}  // namespace sepcal
"""
PAGES = {
    "index.html": '<a href="below/other.html#there">x</a><a href="https://example.org">y</a>',
    "below/other.html": '<p id="there"></p><a href="../index.html#nowhere">x</a><img src="no.png">'
    '<script src="https://example.org/a.js"></script>',
}


@pytest.fixture(autouse=True)
def parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder of the parts is where they look for each other."""
    if not (ROOT / "docs" / "site").is_dir():
        pytest.skip("the documents are not beside these tests")
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "site"))
    for name in ("doxygen_filter", "check_pages", "public_names"):
        monkeypatch.delitem(sys.modules, name, raising=False)


def test_comments_become_doxygens() -> None:
    from doxygen_filter import filter_lines

    assert filter_lines(HEADER.splitlines()) == TAKEN.splitlines()


def test_links_that_lead_nowhere_are_found(tmp_path: Path) -> None:
    from check_pages import find_faults

    for name, text in PAGES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    faults = sorted(fault.split(": ", 1)[1] for fault in find_faults(tmp_path))
    assert faults == [
        "../index.html#nowhere has no such anchor",
        "https://example.org/a.js is loaded from elsewhere",
        "no.png is not there",
    ]


def test_every_public_name_of_python_is_documented() -> None:
    from public_names import list_python, undocumented_python

    assert len(list_python()) > 150
    assert list(undocumented_python()) == []


def test_a_name_of_cpp_without_a_word_is_found(tmp_path: Path) -> None:
    from public_names import undocumented_cpp

    compound = '<compound refid="{0}" kind="struct"><name>sepcal::{0}</name></compound>'
    told = '<doxygen><compounddef prot="public">{}</compounddef></doxygen>'
    names = {"Told": "<briefdescription>Yes.</briefdescription>", "Untold": ""}
    listed = "".join(compound.format(name) for name in names)
    (tmp_path / "index.xml").write_text(f"<doxygenindex>{listed}</doxygenindex>")
    for name, words in names.items():
        (tmp_path / f"{name}.xml").write_text(told.format(words))
    overloads = "<memberdef kind='function'><name>f</name>{}</memberdef>" * 2
    told_once = overloads.format("", "<detaileddescription>It is.</detaileddescription>")
    alone = "<memberdef kind='enum'><name>E</name></memberdef>"
    (tmp_path / "namespacesepcal.xml").write_text(told.format(told_once + alone))
    assert list(undocumented_cpp(tmp_path)) == ["struct sepcal::Untold", "enum sepcal::E"]
