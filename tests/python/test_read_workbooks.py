# SPDX-License-Identifier: BSD-3-Clause
"""Excel's workbooks by python-calamine: to the same text as by openpyxl, and only where it may."""

import datetime
import random
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import sepcal
from sepcal.reading import excel, workbook_parts
from sepcal.reading.limits import Budget
from sepcal.reading.workbook_parts import copy_if_safe

openpyxl = pytest.importorskip("openpyxl")
pytest.importorskip("python_calamine")

START = datetime.datetime(2024, 5, 4, 10, 14, 30)
ROWS = 60


def fill(sheet) -> None:
    """Numbers, dates, times of day, true and false, labels, gaps."""
    sheet.append(["time_s", "UTC", "clock", "airspeed (kt)", "armed", "maneuver", "count", "gap"])
    draw = random.Random(4)
    for i in range(ROWS):
        now = START + datetime.timedelta(seconds=0.1 * i)
        gap = None if i % 3 else draw.gauss(0, 1)
        label = "turn" if i < 30 else 7
        sheet.append([0.1 * i, now, now.time(), draw.gauss(20, 3), i > 5, label, i, gap])


def save(folder: Path, change: Callable[[object], None] = fill) -> Path:
    book = openpyxl.Workbook()
    change(book.active)
    book.save(folder / "log.xlsx")
    return folder / "log.xlsx"


def texts_of(file: Path, folder: Path, *, fast: bool) -> list[str]:
    """What is written of each sheet, by python-calamine or openpyxl."""
    if fast:
        sheets = excel._read_fast(str(file), None, str(folder), Budget(str(file)))
        assert sheets is not None
    else:
        with open(file, "rb") as opened:
            book = openpyxl.load_workbook(opened, read_only=True, data_only=True)
            rows = excel._sheets_of(book)
            sheets = excel._write_sheets(str(file), rows, None, str(folder), Budget(str(file)))
    return [Path(sheet.text).read_text() for sheet in sheets]


def rewrite(file: Path, change: Callable[[str, bytes], bytes]) -> None:
    """Changes parts of a workbook."""
    with zipfile.ZipFile(file) as parts:
        contents = {name: parts.read(name) for name in parts.namelist()}
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as parts:
        for name, content in contents.items():
            parts.writestr(name, change(name, content))


def in_sheet(old: bytes, new: bytes) -> Callable[[str, bytes], bytes]:
    def change(name: str, content: bytes) -> bytes:
        if not name.startswith("xl/worksheets/"):
            return content
        assert old in content
        return content.replace(old, new, 1)

    return change


def with_formulas(sheet) -> None:
    fill(sheet)
    sheet["I1"] = "sum"
    for row in range(2, ROWS + 2):
        sheet.cell(row, 9, f"=A{row}+G{row}")


def far_from_the_corner(sheet) -> None:
    for row in range(ROWS):
        for column in range(4):
            sheet.cell(row + 9, column + 5, f"c{column}" if row == 0 else row * 0.5 + column)


FORMATS = [
    "[$-409]m/d/yy h:mm AM/PM;@",
    "[$-F400]h:mm:ss\\ AM/PM",
    "yyyy\\-mm\\-dd hh:mm:ss",
    'yyyy\\-mm\\-dd"T"hh:mm:ss.000',
    "[Red]0.0",
    "#,##0.00_);[Red]\\(#,##0.00\\)",
    '0.0" s"',
    '0.0 "m/s";-0.0 "m/s"',
    "[h]:mm:ss",
    "mm:ss.0",
    "d.m.yyyy;@",
    "0.00E+00",
    "0\\ h",
]


def in_all_formats(sheet) -> None:
    """Numbers, dates and spans of time as people show them."""
    sheet.append([f"c{i}" for i in range(len(FORMATS))])
    for row in range(2, 20):
        for column, form in enumerate(FORMATS, 1):
            cell = sheet.cell(row, column, 45416.4270833449 + row / 7)
            cell.number_format = form


def two_sheets(sheet) -> None:
    fill(sheet)
    other = sheet.parent.create_sheet("pilots")
    other.append(["name", "hours"])
    other.append(["Doe", 1200])
    sheet.parent.create_sheet("empty")


@pytest.mark.parametrize(
    "change", [fill, with_formulas, far_from_the_corner, in_all_formats, two_sheets]
)
def test_the_same_text(change, tmp_path):
    file = save(tmp_path, change)
    one, other = tmp_path / "one", tmp_path / "other"
    one.mkdir()
    other.mkdir()
    assert texts_of(file, one, fast=True) == texts_of(file, other, fast=False)


MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
RELATIONS = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
TYPES = "application/vnd.openxmlformats-officedocument.spreadsheetml"


def write_by_hand(file: Path, rows: str, texts: list[str]) -> None:
    """A workbook whose texts are shared, as Excel writes them (ECMA-376, part 1, clause 18)."""
    package = "http://schemas.openxmlformats.org/package/2006"
    office = f"{RELATIONS}/officeDocument"
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types">'
        '<Default Extension="rels" ContentType='
        '"application/vnd.openxmlformats-package.relationships+xml"/>'
        f'<Override PartName="/xl/workbook.xml" ContentType="{TYPES}.sheet.main+xml"/>'
        f'<Override PartName="/xl/worksheets/sheet1.xml" ContentType="{TYPES}.worksheet+xml"/>'
        f'<Override PartName="/xl/sharedStrings.xml" ContentType="{TYPES}.sharedStrings+xml"/>'
        "</Types>",
        "_rels/.rels": f'<Relationships xmlns="{package}/relationships">'
        f'<Relationship Id="rId1" Type="{office}" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{RELATIONS}"><sheets>'
        '<sheet name="log" sheetId="1" r:id="rId1"/></sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships">'
        f'<Relationship Id="rId1" Type="{RELATIONS}/worksheet" Target="worksheets/sheet1.xml"/>'
        f'<Relationship Id="rId2" Type="{RELATIONS}/sharedStrings" Target="sharedStrings.xml"/>'
        "</Relationships>",
        "xl/worksheets/sheet1.xml": f'<worksheet xmlns="{MAIN}"><sheetData>{rows}</sheetData>'
        "</worksheet>",
        "xl/sharedStrings.xml": f'<sst xmlns="{MAIN}">'
        + "".join(f"<si><t>{text}</t></si>" for text in texts)
        + "</sst>",
    }
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)


def shared_rows(texts: int) -> str:
    """Two names, and rows of a time, a shared text and a count."""
    rows = ['<row r="1"><c r="A1" t="s"><v>0</v></c><c r="B1" t="s"><v>1</v></c></row>']
    for row in range(2, texts + 2):
        rows.append(
            f'<row r="{row}"><c r="A{row}"><v>{row / 10}</v></c>'
            f'<c r="B{row}" t="s"><v>{2 + row % 2}</v></c><c r="C{row}"><v>{row}</v></c></row>'
        )
    return "".join(rows)


def test_shared_texts(tmp_path):
    """And a formula's value, true and false, an empty text, a text in its cell."""
    rows = (
        '<row r="1"><c r="A1" t="s"><v>0</v></c><c r="B1" t="s"><v>1</v></c>'
        '<c r="C1" t="inlineStr"><is><t>in cell</t></is></c></row>'
        '<row r="2"><c r="A2"><v>1</v></c><c r="B2" t="s"><v>2</v></c>'
        '<c r="C2"><f>A2+3</f><v>4.25</v></c></row>'
        '<row r="3"><c r="A3"><v>2.5</v></c><c r="B3"/><c r="C3" t="b"><v>1</v></c></row>'
        '<row r="4"><c r="A4"><v>1E-3</v></c><c r="C4" t="str"><f>B2</f><v>label</v></c></row>'
    )
    file = tmp_path / "log.xlsx"
    write_by_hand(file, rows, ["time_s", "maneuver", "turn &amp; climb"])
    one, other = tmp_path / "one", tmp_path / "other"
    one.mkdir()
    other.mkdir()
    (fast,) = texts_of(file, one, fast=True)
    (slow,) = texts_of(file, other, fast=False)
    assert fast == slow
    assert fast == ("time_s,maneuver,in cell\n1,turn & climb,4.25\n2.5,,1\n0.001,,label\n")


@pytest.mark.parametrize(("length", "is_read"), [(60, True), (30_000, False)])
def test_long_texts(length, is_read, tmp_path):
    """The longest stands once, and others in very many cells."""
    file = tmp_path / "log.xlsx"
    write_by_hand(file, shared_rows(5000), ["time_s", "remark", "a", "b", "x" * length])
    assert (copy_if_safe(str(file), str(tmp_path)) is not None) is is_read
    assert sepcal.read(file).rows == 5000


def test_the_flight_is_the_same_without_the_library(tmp_path, monkeypatch):
    file = save(tmp_path)
    fast = sepcal.read(file)
    monkeypatch.setattr(excel, "copy_if_safe", lambda *_: None)
    slow = sepcal.read(file)
    assert fast.columns == slow.columns
    for header in fast.columns:
        assert np.array_equal(fast[header], slow[header], equal_nan=True)
    assert fast.maneuvers == slow.maneuvers
    assert fast.notes == slow.notes


def far_out(sheet) -> None:
    fill(sheet)
    sheet["XFD1048576"] = 1


def with_error(sheet) -> None:
    fill(sheet)
    sheet["D9"] = "#N/A"
    sheet["D9"].data_type = "e"


def of_two_minds(sheet) -> None:
    """A date where it is negative, as one might think."""
    fill(sheet)
    sheet["A3"].number_format = "0.0;d"


@pytest.mark.parametrize("change", [far_out, with_error, of_two_minds])
def test_what_is_left_to_openpyxl(change, tmp_path):
    file = save(tmp_path, change)
    assert copy_if_safe(str(file), str(tmp_path)) is None
    flight = sepcal.read(file)
    assert "time_s" in flight.columns
    if change is with_error:
        assert np.isnan(flight["airspeed (kt)"][7])


def test_a_chain_of_formulas_is_no_sheet(tmp_path):
    """Excel's list of the cells that have one: a few of a far column."""
    file = save(tmp_path)
    chain = b"".join(b'<c r="ZZ%d" i="1"/>' % row for row in range(1, 400))
    with zipfile.ZipFile(file, "a") as parts:
        parts.writestr("xl/calcChain.xml", b"<calcChain>" + chain + b"</calcChain>")
    assert copy_if_safe(str(file), str(tmp_path)) is not None


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (rb'<c r="A9"', rb'<c r="a9"'),
        (rb'<c r="A9"', rb"<c r='A9'"),
        (rb'<c r="A9"', rb'<c  r="A9"'),
        (rb'<c r="A9"', rb"<c"),
        (rb'<c r="A9"', rb'<c q="1>2" r="A9"'),
    ],
)
def test_tags_of_another_form(old, new, tmp_path):
    """A reference that the look might miss."""
    file = save(tmp_path)
    assert copy_if_safe(str(file), str(tmp_path)) is not None
    rewrite(file, in_sheet(old, new))
    assert copy_if_safe(str(file), str(tmp_path)) is None


def test_dates_of_the_other_epoch(tmp_path):
    file = save(tmp_path)
    rewrite(
        file,
        lambda name, content: (
            re.sub(rb"<workbookPr[^>]*/>", b'<workbookPr date1904="1"/>', content)
            if name == "xl/workbook.xml"
            else content
        ),
    )
    assert copy_if_safe(str(file), str(tmp_path)) is None


def test_pieces_are_cut_anywhere(tmp_path, monkeypatch):
    file = save(tmp_path)
    whole = copy_if_safe(str(file), str(tmp_path))
    assert whole is not None
    monkeypatch.setattr("sepcal.reading.workbook_parts.CHUNK", 997)
    one = tmp_path / "one"
    one.mkdir()
    cut = copy_if_safe(str(file), str(one))
    assert cut is not None
    with zipfile.ZipFile(whole) as first, zipfile.ZipFile(cut) as second:
        for name in first.namelist():
            assert first.read(name) == second.read(name)


def test_an_archive_that_hides_what_is_in_it(tmp_path):
    """More is packed than the part's declared size: what is behind it is in no copy."""
    file = save(tmp_path)
    with zipfile.ZipFile(file) as parts:
        part = parts.getinfo("xl/worksheets/sheet1.xml")
        size = part.file_size
    packed = file.read_bytes()
    real = size.to_bytes(4, "little")
    file.write_bytes(packed.replace(real, (size // 2).to_bytes(4, "little")))
    copy = copy_if_safe(str(file), str(tmp_path))
    assert copy is None


TAG = re.compile(rb'<c r="([A-Z]{1,3})([0-9]{1,7})"(?: [a-z]+="[^"<>&]*")*\s?/?>')
ANY_TAG = re.compile(rb"<(?:[^\s<>/]*:)?c(?=[\s/>])")
PARTS = [
    b"<c r=",
    b'"',
    b"A",
    b"AZB",
    b"ABCD",
    b"12",
    b"1234567",
    b"12345678",
    b' t="n"',
    b' s="1"',
]
PARTS += [b"/>", b">", b" ", b"<c>", b"<v>1</v>", b"</c>", b"<cols>", b"<x:c ", b"<", b"&", b"q"]


def test_cells_are_found_as_an_expression_finds_them():
    draw = random.Random(2)
    accepted = 0
    for _ in range(4000):
        rests = draw.choices([b"", b' s="1"', b"/"], k=draw.randint(0, 5))
        names = ((draw.randint(65, 90), draw.randint(1, 9999), rest) for rest in rests)
        tags = b"".join(b'<c r="%c%d"%s>' % name for name in names)
        other = b"".join(draw.choices(PARTS, k=draw.randint(0, 4)))
        piece = tags + other if draw.random() < 0.5 else other + tags
        expected = TAG.findall(piece)
        found = workbook_parts._cells_in(piece)
        if len(expected) != len(ANY_TAG.findall(piece)):
            assert found is None, piece
            continue
        accepted += 1
        assert found is not None, piece
        columns = [openpyxl.utils.column_index_from_string(c.decode()) for c, _ in expected]
        assert (found[0].tolist(), found[1].tolist()) == (columns, [int(r) for _, r in expected])
    assert accepted > 1000
