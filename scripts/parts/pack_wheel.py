# SPDX-License-Identifier: BSD-3-Clause
"""Packs a wheel from what CMake installed, and shows what is in one.

Usage: pack_wheel.py pack STAGE ROOT PYTHON PROCESSOR FOLDER
       pack_wheel.py show WHEEL
STAGE has sepcal/ with modules, programs and the library; ROOT/linked the licences of what is linked
in, a file NAME_VERSION each; PYTHON is 3.11, say.
"""

from __future__ import annotations

import re
import sys
import tempfile
import zipfile
from importlib.metadata import distribution
from pathlib import Path

from sbom import ask, is_elf, needed

PACKAGE = Path(__file__).resolve().parents[2] / "python" / "sepcal"
# The lowest release of manylinux that scripts/wheel aims at.
OLDEST_GLIBC = (2, 28)


def binaries_in(folder: Path) -> list[Path]:
    """What the loader reads: modules, the library, programs."""
    return [file for file in sorted(folder.rglob("*")) if file.is_file() and is_elf(file)]


def newest_glibc(file: Path) -> tuple[int, ...]:
    """The newest version of glibc whose symbols it asks for."""
    versions = re.findall(
        r"Name: GLIBC_([0-9.]+)", ask("readelf", "--version-info", "--wide", str(file))
    )
    return max(
        (tuple(int(part) for part in version.split(".")) for version in versions), default=(0,)
    )


def metadata() -> dict[str, bytes]:
    """METADATA, entry points and the licence, as `pip wheel` has them."""
    from scikit_build_core.build import prepare_metadata_for_build_wheel

    with tempfile.TemporaryDirectory() as folder:
        info = Path(folder) / prepare_metadata_for_build_wheel(folder)
        return {
            f"{info.name}/{file.relative_to(info)}": file.read_bytes()
            for file in sorted(info.rglob("*"))
            if file.is_file() and file.name not in ("RECORD", "WHEEL")
        }


def pack(stage: Path, root: Path, python: str, processor: str, folder: Path) -> Path:
    """The wheel in `folder`, tagged by the glibc that its binaries ask for."""
    from wheel.wheelfile import WheelFile

    binaries = binaries_in(stage)
    newest = max([OLDEST_GLIBC, *map(newest_glibc, binaries)])
    python_tag = "cp" + python.replace(".", "")
    tag = f"{python_tag}-{python_tag}-manylinux_{newest[0]}_{newest[1]}_{processor}"
    files = metadata()
    info = next(iter(files)).split("/")[0]
    name, version = info.removesuffix(".dist-info").split("-")
    files[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: sepcal\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    )
    for licence in sorted((root / "linked").iterdir()):
        files[f"{info}/licenses/linked/{licence.name}"] = licence.read_bytes()
    for licence in sorted(
        Path(str(distribution("pybind11").locate_file(""))).glob("pybind11-*/licenses/*")
    ):
        linked = f"{info}/licenses/linked/pybind11_{distribution('pybind11').version}"
        files[linked] = licence.read_bytes()
    for file in sorted(PACKAGE.rglob("*")):
        if file.is_file() and "__pycache__" not in file.parts:
            files[f"sepcal/{file.relative_to(PACKAGE)}"] = file.read_bytes()
    folder.mkdir(parents=True, exist_ok=True)
    wheel = folder / f"{name}-{version}-{tag}.whl"
    with WheelFile(str(wheel), "w") as archive:
        for file in binaries:
            archive.write(str(file), str(file.relative_to(stage)))
        for path, content in files.items():
            archive.writestr(path, content)
    return wheel


def show(wheel: Path) -> None:
    """Prints size, libraries, licences."""
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
        packed = {info.filename: info.compress_size for info in archive.infolist()}
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.2f} MB")
        for file in binaries_in(Path(folder)):
            path = str(file.relative_to(folder))
            newest = ".".join(map(str, newest_glibc(file)))
            print(
                f"{path}: {file.stat().st_size / 1e6:.2f} MB, packed {packed[path] / 1e6:.2f} MB,"
            )
            print(f"  glibc {newest}, loads {', '.join(needed(file))}")
        for path in sorted(packed):
            if "/licenses/" in path:
                print(f"licence: {path}")


def main(arguments: list[str]) -> int:
    """Runs a command and returns its exit code."""
    match arguments:
        case ["pack", stage, root, python, processor, folder]:
            print(pack(Path(stage), Path(root), python, processor, Path(folder)))
        case ["show", wheel]:
            show(Path(wheel))
        case _:
            print(__doc__, file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
