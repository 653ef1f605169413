# SPDX-License-Identifier: BSD-3-Clause
"""What is in sepcal's binaries and what they load, as SPDX 2.3 in JSON: versions and licences.

Usage: sbom.py [-o FILE] BINARY|WHEEL...

Shared libraries are those that readelf finds in a binary, and in these again; a wheel is unpacked,
and what it brings itself counts as its file. What is compiled in (headers, and Ceres where it is an
archive) is looked for where the compiler finds it; of a wheel it is what its licenses/linked/ has
copyright files of. Names, versions and licences are dpkg's: a licence is that of `Files: *` in a
package's copyright file, and those of single files stand in a comment. What dpkg doesn't know has
NOASSERTION. SOURCE_DATE_EPOCH, where it is set, is the time of making it.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.metadata
import json
import os
import re
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
UNKNOWN = "NOASSERTION"
NAMESPACE = "https://spdx.org/spdxdocs/sepcal"
# What is compiled in, by the names that CMakeLists.txt has for it: files of its Debian package.
COMPILED_IN = {
    "Eigen3": "/usr/include/eigen3/Eigen/Core",
    "Ceres": "/usr/lib/*/libceres.a",
    "SEPCAL_XSIMD_INCLUDE_DIR": "/usr/include/xsimd/xsimd.hpp",
    "nlohmann_json": "/usr/include/nlohmann/json.hpp",
    "CLI11": "/usr/include/CLI/CLI.hpp",
    "SEPCAL_TOML_INCLUDE_DIR": "/usr/include/toml++/toml.h",
}
# Debian's short names that SPDX spells otherwise.
SPDX_NAMES = {
    "apache-2.0": "Apache-2.0",
    "bsd-2-clause": "BSD-2-Clause",
    "bsd-3-clause": "BSD-3-Clause",
    "bsl-1.0": "BSL-1.0",
    "cc0-1.0": "CC0-1.0",
    "expat": "MIT",
    "gpl-2": "GPL-2.0-only",
    "gpl-2+": "GPL-2.0-or-later",
    "gpl-3": "GPL-3.0-only",
    "gpl-3+": "GPL-3.0-or-later",
    "isc": "ISC",
    "lgpl-2.1": "LGPL-2.1-only",
    "lgpl-2.1+": "LGPL-2.1-or-later",
    "lgpl-3": "LGPL-3.0-only",
    "lgpl-3+": "LGPL-3.0-or-later",
    "mit": "MIT",
    "mpl-2": "MPL-2.0",
    "mpl-2.0": "MPL-2.0",
    "zlib": "Zlib",
}
# Of source packages whose copyright files are prose.
PROSE = {
    "glibc": "LGPL-2.1-or-later",
    "gcc": "GPL-3.0-or-later WITH GCC-exception-3.1",
}

Json = dict[str, Any]


@dataclass(frozen=True)
class Package:
    """One that is linked or compiled in."""

    name: str
    version: str
    licence: str
    url: str = ""  # a package URL
    others: tuple[str, ...] = ()  # licences of single files, as the package names them

    @property
    def id(self) -> str:
        """Its name in the document."""
        return "SPDXRef-Package-" + re.sub(r"[^A-Za-z0-9.-]", "-", self.name)

    def to_json(self) -> Json:
        """Its entry."""
        entry: Json = {
            "SPDXID": self.id,
            "name": self.name,
            "versionInfo": self.version,
            "downloadLocation": UNKNOWN,
            "filesAnalyzed": False,
            "licenseConcluded": UNKNOWN,
            "licenseDeclared": self.licence,
            "copyrightText": UNKNOWN,
        }
        if self.others:
            entry["licenseComments"] = f"single files: {', '.join(self.others)}"
        if self.url:
            entry["externalRefs"] = [
                {
                    "referenceCategory": "PACKAGE-MANAGER",
                    "referenceType": "purl",
                    "referenceLocator": self.url,
                }
            ]
        return entry


@dataclass(frozen=True)
class Binary:
    """A file of sepcal."""

    name: str  # no other has it
    path: Path

    @property
    def id(self) -> str:
        """Its name in the document."""
        return "SPDXRef-File-" + re.sub(r"[^A-Za-z0-9.-]", "-", self.name)


@dataclass
class Bill:
    """What is found, binary by binary."""

    packages: dict[str, Package] = field(default_factory=dict)  # by name
    files: list[Binary] = field(default_factory=list)
    relations: set[tuple[str, str, str]] = field(default_factory=set)
    texts: dict[str, str] = field(default_factory=dict)  # of licences that SPDX doesn't list

    def add(self, package: Package) -> Package:
        """The package, once."""
        return self.packages.setdefault(package.name, package)

    def relate(self, one: str, kind: str, other: str) -> None:
        """One thing is so related to another."""
        if one != other:
            self.relations.add((one, kind, other))


def ask(*command: str) -> str:
    """What a program prints; nothing where it fails or isn't there."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return ""
    return done.stdout if done.returncode == 0 else ""


def needed(binary: Path) -> list[str]:
    """The shared libraries that a binary names."""
    return re.findall(r"\(NEEDED\).*\[(.+)\]", ask("readelf", "--dynamic", "--wide", str(binary)))


@cache
def loaded_from() -> dict[str, Path]:
    """Where the loader finds a library."""
    found: dict[str, Path] = {}
    for name, path in re.findall(r"^\s+(\S+) \(.*\) => (\S+)$", ask("ldconfig", "-p"), re.M):
        found.setdefault(name, Path(path))
    return found


@cache
def owner(file: Path) -> str:
    """The Debian package of a file, as name:architecture where it has one; or nothing.

    /lib is a link to /usr/lib, and dpkg knows a file by one of these names.
    """
    real = file.resolve()
    other = Path(str(real).removeprefix("/usr")) if str(real).startswith("/usr/lib") else real
    for path in dict.fromkeys((real, other, file)):
        if found := ask("dpkg-query", "--search", str(path)):
            return found.splitlines()[0].rpartition(": ")[0].partition(",")[0]
    return ""


def read_paragraphs(text: str) -> list[dict[str, str]]:
    """The fields of a file in Debian's form, by lower-case names."""
    paragraphs = []
    for block in re.split(r"\n\s*\n", text):
        fields = re.findall(r"^([A-Za-z-]+):[ \t]*((?:.*)(?:\n[ \t].*)*)", block, re.M)
        paragraphs.append({name.lower(): value for name, value in fields})
    return paragraphs


def short_name(licence: str) -> str:
    """The first line of a licence field."""
    return licence.partition("\n")[0].strip()


def find_others(paragraphs: list[dict[str, str]]) -> tuple[str, ...]:
    """The licences of single files, but those of the packaging."""
    files = [one for one in paragraphs if "files" in one and "license" in one]
    parts = [one for one in files if one["files"].split() not in (["*"], ["debian/*"])]
    return tuple(sorted({short_name(one["license"]) for one in parts} - {""}))


def find_licence(paragraphs: list[dict[str, str]], source: str, bill: Bill) -> str:
    """The licence of `Files: *` as SPDX says it; the text of one that SPDX doesn't list is kept."""
    told = next((one for one in paragraphs if one.get("files", "").split() == ["*"]), None)
    if "format" not in paragraphs[0] or told is None or "license" not in told:
        return next(
            (PROSE[name] for name in PROSE if re.match(rf"{name}(-\d+)?$", source)), UNKNOWN
        )
    texts = {
        short_name(one["license"]).lower(): one["license"].partition("\n")[2]
        for one in paragraphs
        if "license" in one and "\n" in one["license"]
    }
    words = re.split(r",? (or|and) ", short_name(told["license"]))
    for i, word in enumerate(words):
        if i % 2:
            words[i] = word.upper()
        elif (name := word.lower()) in SPDX_NAMES:
            words[i] = SPDX_NAMES[name]
        else:
            words[i] = "LicenseRef-" + re.sub(r"[^A-Za-z0-9.-]+", "-", word)
            bill.texts[words[i]] = re.sub(r"\s+", " ", texts.get(name, "")).strip() or word
    return " ".join(words)


def debian_package(file: Path, bill: Bill) -> Package | None:
    """What dpkg knows of a file."""
    if not (name := owner(file)):
        return None
    wanted = "${Package}\t${Version}\t${Architecture}\t${source:Package}"
    plain, version, architecture, source = ask("dpkg-query", "-W", f"-f={wanted}", name).split("\t")
    if plain in bill.packages:
        return bill.packages[plain]
    copyright_file = Path("/usr/share/doc") / plain / "copyright"
    text = copyright_file.read_text(errors="replace") if copyright_file.exists() else ""
    paragraphs = read_paragraphs(text)
    system = dict(re.findall(r'^(\w+)="?([^"\n]*)', Path("/etc/os-release").read_text(), re.M))
    url = f"pkg:deb/{system.get('ID', 'debian')}/{plain}@{version}?arch={architecture}"
    licence = find_licence(paragraphs, source, bill)
    return bill.add(Package(plain, version, licence, url, find_others(paragraphs)))


def add_loaded(one: str, binary: Path, brought: dict[str, str], bill: Bill) -> None:
    """What a file or package with this id loads, and what that loads; `brought` are ids by name."""
    for name in needed(binary):
        if name in brought:
            bill.relate(one, "DYNAMIC_LINK", brought[name])
            continue
        path = loaded_from().get(name)
        known = path and debian_package(path, bill)
        package = known or bill.add(Package(name, UNKNOWN, UNKNOWN))
        relation = (one, "DYNAMIC_LINK", package.id)
        if path is not None and relation not in bill.relations and one != package.id:
            bill.relations.add(relation)
            add_loaded(package.id, path, brought, bill)
        bill.relate(*relation)


def add_compiled_in(bill: Bill) -> None:
    """What leaves no name in a binary."""
    for name, pattern in COMPILED_IN.items():
        file = next(iter(sorted(Path("/").glob(pattern.removeprefix("/")))), None)
        known = file and debian_package(file, bill)
        package = known or bill.add(Package(name, UNKNOWN, UNKNOWN))
        bill.relate("SPDXRef-Package-sepcal", "STATIC_LINK", package.id)


def add_linked(folder: Path, bill: Bill) -> bool:
    """What an unpacked wheel says that it was linked with; False where it says nothing."""
    linked = sorted(folder.glob("*.dist-info/licenses/linked/*"))
    for file in linked:
        paragraphs = read_paragraphs(file.read_text(errors="replace"))
        name, _, version = file.name.partition("_")
        licence = find_licence(paragraphs, name, bill)
        package = Package(name, version or UNKNOWN, licence, others=find_others(paragraphs))
        bill.relate("SPDXRef-Package-sepcal", "STATIC_LINK", bill.add(package).id)
    return bool(linked)


def add_python(bill: Bill, project: Json) -> None:
    """What the modules are compiled with, and what the package needs."""
    try:
        told = importlib.metadata.metadata("pybind11")
        version, licence = told["Version"], str(told.json.get("license_expression", UNKNOWN))
    except importlib.metadata.PackageNotFoundError:
        version, licence = UNKNOWN, UNKNOWN
    url = "pkg:pypi/pybind11" + (f"@{version}" if version != UNKNOWN else "")
    bill.relate(
        "SPDXRef-Package-sepcal",
        "STATIC_LINK",
        bill.add(Package("pybind11", version, licence, url)).id,
    )
    for wanted in project["dependencies"]:
        name = re.match(r"[\w.-]+", wanted)[0]  # type: ignore[index]
        package = Package(name, wanted.removeprefix(name) or UNKNOWN, UNKNOWN, f"pkg:pypi/{name}")
        bill.relate("SPDXRef-Package-sepcal", "DEPENDS_ON", bill.add(package).id)


def add_binaries(binaries: Sequence[Binary], bill: Bill) -> None:
    """Files of sepcal that are installed together, and what they load."""
    brought = {binary.path.name: binary.id for binary in binaries}
    for binary in binaries:
        bill.files.append(binary)
        bill.relate("SPDXRef-Package-sepcal", "CONTAINS", binary.id)
        add_loaded(binary.id, binary.path, brought, bill)


def is_elf(file: Path) -> bool:
    """Whether it is a program or a library."""
    with file.open("rb") as opened:
        return opened.read(4) == b"\x7fELF"


def unpack(wheel: Path, folder: Path) -> list[Binary]:
    """The binaries of a wheel."""
    with zipfile.ZipFile(wheel) as opened:
        opened.extractall(folder / wheel.stem)
    inside = sorted(one for one in (folder / wheel.stem).rglob("*") if one.is_file())
    return [Binary(str(one.relative_to(folder)), one) for one in inside if is_elf(one)]


def find_version() -> str:
    """That of CMakeLists.txt."""
    text = (ROOT / "CMakeLists.txt").read_text()
    return re.search(r"project\(\s*sepcal\s+VERSION\s+([0-9.]+)", text)[1]  # type: ignore[index]


def digest(kind: str, file: Path) -> str:
    """Of a file's bytes."""
    return hashlib.new(kind, file.read_bytes()).hexdigest()


def to_document(bill: Bill) -> Json:
    """The whole, in an order that depends on nothing but its contents."""
    version = find_version()
    made = int(os.environ.get("SOURCE_DATE_EPOCH", datetime.now(UTC).timestamp()))
    own = Package("sepcal", version, "BSD-3-Clause", f"pkg:pypi/sepcal@{version}")
    files = [
        {
            "SPDXID": binary.id,
            "fileName": f"./{binary.name}",
            "checksums": [
                {
                    "algorithm": kind,
                    "checksumValue": digest(kind, binary.path),
                }
                for kind in ("SHA1", "SHA256")
            ],
            "licenseConcluded": UNKNOWN,
            "licenseInfoInFiles": [UNKNOWN],
            "copyrightText": UNKNOWN,
        }
        for binary in sorted(bill.files, key=lambda binary: binary.name)
    ]
    packages = [own.to_json(), *(bill.packages[name].to_json() for name in sorted(bill.packages))]
    relations = [("SPDXRef-DOCUMENT", "DESCRIBES", own.id), *sorted(bill.relations)]
    document: Json = {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"sepcal-{version}",
        "creationInfo": {
            "created": datetime.fromtimestamp(made, UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
            "creators": ["Tool: sepcal-scripts-parts-sbom.py"],
        },
        "packages": packages,
        "files": files,
        "relationships": [
            {"spdxElementId": one, "relationshipType": kind, "relatedSpdxElement": other}
            for one, kind, other in relations
        ],
    }
    if bill.texts:
        document["hasExtractedLicensingInfos"] = [
            {"licenseId": name, "extractedText": text} for name, text in sorted(bill.texts.items())
        ]
    contents = hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()
    return document | {"documentNamespace": f"{NAMESPACE}-{version}-{contents[:32]}"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes the document."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("binaries", metavar="BINARY|WHEEL", nargs="+", type=Path)
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help="instead of printing it")
    chosen = parser.parse_args(arguments)
    for file in chosen.binaries:
        if not file.is_file():
            parser.error(f"there is no file {file}")
        if file.suffix != ".whl" and not is_elf(file):
            parser.error(f"{file} is neither a program nor a library nor a wheel")
    bill = Bill()
    with tempfile.TemporaryDirectory() as folder:
        wheels = [file for file in chosen.binaries if file.suffix == ".whl"]
        bare = [Binary(file.name, file) for file in chosen.binaries if file not in wheels]
        add_binaries(bare, bill)
        told = []
        for wheel in wheels:
            add_binaries(unpack(wheel, Path(folder)), bill)
            told.append(add_linked(Path(folder) / wheel.stem, bill))
        if bare or not all(told):
            add_compiled_in(bill)
        if any(binary.path.name.startswith(("_core.", "_states.")) for binary in bill.files):
            project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
            add_python(bill, project)
        text = json.dumps(to_document(bill), indent=1) + "\n"
    if chosen.output is None:
        print(text, end="")
    else:
        chosen.output.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
