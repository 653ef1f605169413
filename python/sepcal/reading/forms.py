# SPDX-License-Identifier: BSD-3-Clause
"""Tells a file's form by its first bytes, never by its name alone."""

from __future__ import annotations

import gzip
import re
import zipfile
import zlib

from sepcal import _core
from sepcal.logs.dataflash_binary import looks_like_binary
from sepcal.logs.dataflash_text import looks_like_text
from sepcal.logs.ulog_topics import MAGIC as ULOG
from sepcal.reading import arrow, hdf5, matlab, mcap_log, nmea
from sepcal.reading.excel import WORKBOOK

START = 8192
GZIP, ZSTD, ZIP, OLE = b"\x1f\x8b", b"\x28\xb5\x2f\xfd", b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
TABLE = "a table as text"
MAGICS = {
    arrow.PARQUET: "parquet",
    arrow.ARROW_FILE: "arrow",
    arrow.ARROW_STREAM: "arrow",
    hdf5.MAGIC: "hdf5",
    matlab.MAGIC: "matlab",
    matlab.MAGIC_73: "matlab",
    mcap_log.MAGIC: "mcap",
    ULOG: "autopilot",
}
HDF5_BLOCKS = (512, 1024, 2048)  # where HDF5 may begin behind a block of the user's
IGC = re.compile(rb"\A(?:\xef\xbb\xbf)?A[A-Z0-9]{3}.*?[\r\n](?:.*[\r\n])*?(?:HFDTE|B\d{6})", re.M)
CLASSIC = "netCDF of the classic form; write it as netCDF-4: nccopy -k netCDF-4 OLD.nc NEW.nc"
MATLAB_4 = "a .mat file of MATLAB 4; load it and save it anew: save('log.mat', '-v7')"
OTHERS = {
    OLE: "an old Excel file (.xls); save it as .xlsx or CSV",
    b"SQLite format 3": "an SQLite database; write the table as CSV or Parquet",
    b"FEA1": "Feather of version 1; write it anew, which makes version 2",
    b"Obj\x01": "Avro; write it as Parquet or CSV",
    b"ORC": "ORC; write it as Parquet or CSV",
    b"CDF\x01": CLASSIC,
    b"CDF\x02": CLASSIC,
    b"CDF\x05": CLASSIC,
    b"#ROSBAG V2.0": "a bag of ROS 1; write its topics as CSV",
    b"%PDF": "a PDF; give the table that it shows",
    b"\x89PNG": "a picture",
    b"\xff\xd8\xff": "a picture",
    b"Rar!": "an archive; unpack it",
    b"7z\xbc\xaf": "an archive; unpack it",
    b"BZh": "packed by bzip2; unpack it: bunzip2",
    b"\xfd7zXZ": "packed by xz; unpack it: unxz",
}


def find_form(file: str) -> str:
    """The form by which it is read: TABLE, "parquet", ..., "gzip" for another form inside.

    Raises:
        Error: No such file, or a form that is known and not read, with what to do.
    """
    start = _start_of(file)
    for magic, form in MAGICS.items():
        if start.startswith(magic):
            return form
    _refuse_others(file, start)
    if start.startswith(ZIP):
        return _of_zip(file)
    if start.startswith(GZIP):
        unpacked = _unpacked_start(file)
        _refuse_others(file, unpacked)
        inner = _form_of_text_or_magic(unpacked)
        return TABLE if inner in (TABLE, "") else "gzip"
    if any(start[at:].startswith(hdf5.MAGIC) for at in HDF5_BLOCKS):
        return "hdf5"
    return _form_of_text_or_magic(start) or TABLE


def _refuse_others(file: str, start: bytes) -> None:
    """Raises Error for a form that is known and not read."""
    for magic, what in OTHERS.items():
        if start.startswith(magic):
            raise _core.Error(f"{file}: {what}")
    if matlab.looks_like_version_4(start):
        raise _core.Error(f"{file}: {MATLAB_4}")


def _form_of_text_or_magic(start: bytes) -> str:
    for magic, form in MAGICS.items():
        if start.startswith(magic):
            return form
    if looks_like_binary(start) or looks_like_text(start):
        return "autopilot"
    if IGC.match(start):
        return "igc"
    return "nmea" if nmea.looks_like(start) else ""


def _start_of(file: str) -> bytes:
    try:
        with open(file, "rb") as opened:
            return opened.read(START)
    except OSError as error:
        raise _core.Error(f"{file}: can't be read: {error.strerror}") from error


def _unpacked_start(file: str) -> bytes:
    try:
        with gzip.open(file) as opened:
            return opened.read(START)
    except (OSError, EOFError, zlib.error):
        return b""  # who reads the table says what is wrong


def _of_zip(file: str) -> str:
    try:
        with zipfile.ZipFile(file) as parts:
            names = set(parts.namelist())
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        raise _core.Error(f"{file}: the archive is damaged or cut off: {error}") from error
    if WORKBOOK in names:
        return "excel"
    if "xl/workbook.bin" in names:
        raise _core.Error(f"{file}: a binary workbook (.xlsb); save it as .xlsx or CSV")
    if "content.xml" in names:
        raise _core.Error(f"{file}: an OpenDocument file; save the sheet as .xlsx or CSV")
    if any(name.endswith(".npy") for name in names):
        raise _core.Error(
            f"{file}: arrays of NumPy; in Python they are a table: "
            "sepcal.read(dict(numpy.load('log.npz')))"
        )
    raise _core.Error(f"{file}: an archive; unpack it and give the log that is in it")
