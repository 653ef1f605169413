# SPDX-License-Identifier: BSD-3-Clause
"""Lays out what Sphinx reads: copies of the documents, and pages made of lists.

python docs/site/assemble.py FOLDER XML (what Doxygen wrote) makes FOLDER/index.md, whose table of
contents is docs/README.md; the pages of docs/ and of the root beside it; notebooks/; and api/, a
page for each public name of Python and for each public C++ header. Files of the sources that a
document names are found in FOLDER.
"""

from __future__ import annotations

import re
import shutil
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

from public_names import Name, list_python

SITE = Path(__file__).resolve().parent
ROOT = SITE.parents[1]
HEADERS = ROOT / "cpp" / "include"
PAGES = ("CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md")
NAMED = ("LICENSE", "apps", "cpp", "examples", "lab", "packaging", "python", "scripts", "tests")
VALUE = re.compile(r"<(initializer|defval)>(.*?)</\1>", re.DOTALL)
PLAIN = re.compile(r"(?:= *)?(?:[\w.:+*/() -]{1,60}|\{\})")
LONG = 120  # characters in a cell of a table
# Hundreds of names would swell the sidebar of every page, and take ten times as long.
UP = ":orphan:\n\n:doc:`{1} reference <{0}>`\n"
HOUSES = {  # of the headers, in the order in which people meet them
    "": "Fits, diagnosis, effects",
    "models": "Models that ship",
    "flight": "Logs, probes, calibrations",
    "aircraft": "Aircraft",
    "states": "States and filters",
    "frequency": "Frequencies",
    "simulation": "Simulators",
}


def write(file: Path, text: str) -> None:
    """A page; an old one of the same text keeps its time, so that Sphinx doesn't read it again."""
    file.parent.mkdir(parents=True, exist_ok=True)
    if not file.exists() or file.read_text(encoding="utf-8") != text:
        file.write_text(text, encoding="utf-8")


def toctree(caption: str, pages: list[str]) -> str:
    """A hidden list of pages, for the sidebar."""
    listed = "\n".join(pages)
    return f"```{{toctree}}\n:hidden:\n:caption: {caption}\n\n{listed}\n```\n"


def copy_documents(folder: Path) -> None:
    """Pages of docs/ beside those of the root, and all that they name; links follow."""
    for source in (ROOT / "docs").glob("*.md"):
        if source.name != "README.md":
            write(folder / source.name, lead_here(source.read_text(encoding="utf-8")))
    for name in PAGES:
        write(folder / name, lead_here((ROOT / name).read_text(encoding="utf-8")))
    packages = (ROOT / "packaging" / "README.md").read_text(encoding="utf-8")
    packages = packages.replace("](conan/", "](packaging/conan/").replace("](../docs/", "](")
    write(folder / "packages.md", lead_here(packages))
    for notebook in (ROOT / "examples").glob("*.ipynb"):
        text = notebook.read_text(encoding="utf-8").replace("](../docs/", "](../")
        text = re.sub(r"\]\((\w+\.py)\)", r"](../examples/\1)", text)
        write(folder / "notebooks" / notebook.name, text)
    pictures = [*(ROOT / "docs").glob("*.svg"), ROOT / "docs" / "figures"]
    for source in [*pictures, *(ROOT / name for name in NAMED)]:
        link = folder / source.name
        link.unlink(missing_ok=True)
        link.symlink_to(source)


def lead_here(text: str) -> str:
    """A document's text, its links as they are on the site."""
    text = re.sub(r"\]\((?:(?:\.\./)+|docs/)", "](", text)
    text = re.sub(r"\]\(examples/(\w+\.ipynb)", r"](notebooks/\1", text)
    text = text.replace("](packaging/README.md)", "](packages.md)")
    text = re.sub(r"\[([^\]]*)\]\(\w+/[\w/-]+\)", r"\1", text)  # a folder: no page shows it
    return re.sub(r"\]\(README\.md(?=[)#])", "](index.md", text)


def write_index(folder: Path) -> None:
    """The front page: front.md, the lists of docs/README.md, and these as the sidebar's."""
    lists = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    lists = lead_here(lists[lists.index("\n## ") :])
    contents, seen = [], set()
    for section in lists.split("\n## ")[1:]:
        rows = re.findall(r"^\| \[[^\]]*\]\(([^)#]+)\.md", section, re.M)  # in the first column
        pages = [row for row in rows if row not in seen]  # intervals.md is in two lists
        seen.update(pages)
        heading = section.splitlines()[0]
        if heading == "Tutorials":
            pages += sorted(f"notebooks/{at.stem}" for at in (ROOT / "examples").glob("*.ipynb"))
            pages.append("gallery")
        if heading == "Reference":
            pages += ["api/python", "api/cpp"]
        if heading.startswith("To work"):
            pages += ["packages", "CHANGELOG"]
        contents.append(toctree(heading, pages))
    lists = re.sub(r"\[[\w.-]+\]\(", "[](", lists)  # a page's title in place of its file
    front = lead_here((SITE / "front.md").read_text(encoding="utf-8"))
    write(folder / "index.md", front + lists + "\n" + "\n".join(contents))


def title(words: object) -> str:
    """Of a page in Sphinx's own form."""
    return f"{words}\n{'=' * len(str(words))}\n"


def directive(name: Name) -> str:
    """What documents a name of Python."""
    lines = [
        UP.format("../python", "Python"),
        title(name.dotted),
        f".. auto{name.kind}:: {name.dotted}",
    ]
    if name.kind == "class":
        lines += ["   :members:", "   :inherited-members: dict, tuple, object, pybind11_object"]
    if name.kind == "module":
        lines += ["   :no-members:", ""]
        lines += [f"* :py:obj:`{name.dotted}.{at}`" for at in name.members]
    return "\n".join(lines) + "\n"


def write_python(folder: Path) -> None:
    """api/python.md, a table by module, and a page a name."""
    names = list_python()
    text = ["# Python reference\n", "Everything that `import sepcal` offers, made from the code.\n"]
    modules = list(dict.fromkeys(name.module for name in names))
    for module in modules:
        text += [f"## {module}\n", "| name | what it is |", "|---|---|"]
        for name in (at for at in names if at.module == module):
            text.append(f"| [{name.name}](python/{name.dotted}.rst) | {name.sentence} |")
            write(folder / "python" / f"{name.dotted}.rst", directive(name))
        text.append("")
    write(folder / "python.md", "\n".join(text))


def first_sentence(header: Path) -> str:
    """Of the comment that opens a header; of a long one what stands before its colon."""
    text = re.split(r"^#", header.read_text(encoding="utf-8"), maxsplit=1, flags=re.M)[0]
    said = " ".join(line[3:] for line in text.splitlines()[1:] if line.startswith(("// ", " * ")))
    sentence = re.split(r"(?<!\bEq)(?<!\bEqs)\.\s", said)[0].rstrip(".")
    if len(sentence) > LONG:
        sentence = re.split(r"[:;]\s", sentence)[0]
    return sentence.replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")


def write_cpp(folder: Path) -> None:
    """api/cpp.md, a table by folder, and a page a header."""
    headers = sorted(
        header.relative_to(HEADERS)
        for header in (HEADERS / "sepcal").rglob("*.h*")
        if "detail" not in header.relative_to(HEADERS).parts
    )
    text = [
        "# C++ reference\n",
        "The public headers, made from their comments. [cpp.md](../cpp.md) shows how to use them;"
        " `sepcal/sepcal.hpp` includes the engine's in reading order.\n",
    ]
    for house, heading in HOUSES.items():
        text += [f"## {heading}\n", "| header | what it holds |", "|---|---|"]
        for header in headers:
            if (header.parts[1] if len(header.parts) > 2 else "") != house:
                continue
            page = "/".join(header.parts[1:])
            text.append(f"| [{header.name}](cpp/{page}.rst) | {first_sentence(HEADERS / header)} |")
            up = UP.format("../" * page.count("/") + "../cpp", "C++")
            body = f"{up}\n{title(header)}\n.. doxygenfile:: {header}\n"
            write(folder / "cpp" / f"{page}.rst", body)
        text.append("")
    write(folder / "cpp.md", "\n".join(text))


def adapt_xml(xml: Path) -> None:
    """Headers get the name that people include them by; values that Sphinx can't parse go."""
    for file in xml.glob("*.xml"):
        text = file.read_text(encoding="utf-8")
        plain = VALUE.sub(lambda value: value[0] if PLAIN.fullmatch(value[2]) else "", text)
        plain = re.sub(r" *= *\{\.[^}]*\}", "", plain)
        write(file, plain)
    index = (xml / "index.xml").read_text(encoding="utf-8")
    for refid, name in re.findall(r'refid="(\w+)" kind="file"><name>([^<]*)<', index):
        told = ET.parse(xml / f"{refid}.xml").getroot()[0].find("location")
        if told is not None:
            told_name = f'refid="{refid}" kind="file"><name>'
            index = index.replace(f"{told_name}{name}<", f"{told_name}{told.get('file')}<")
    (xml / "index.xml").write_text(index, encoding="utf-8")


def main(folder: Path, xml: Path) -> None:
    """Everything but the pictures."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(folder / "api", ignore_errors=True)
    copy_documents(folder)
    write_index(folder)
    write_python(folder / "api")
    write_cpp(folder / "api")
    adapt_xml(xml)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
