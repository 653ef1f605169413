# SPDX-License-Identifier: BSD-3-Clause
"""Bombs, cut and damaged files, links out of a file, missing libraries: one line each."""

import gzip
import os
import resource
import signal
import struct
import subprocess
import sys
import zipfile
import zlib

import numpy as np
import pytest

import sepcal
from form_writers import WRITERS
from refusals import refuse
from sepcal.reading import limits

h5py = pytest.importorskip("h5py")
pa = pytest.importorskip("pyarrow")
pandas = pytest.importorskip("pandas")

GIB = 2**30
COLUMNS = {
    "time_s": np.arange(200) * 0.1,
    "airspeed_mps": 20 + np.sin(np.arange(200) / 9.0),
    "vn_mps": 20 + np.cos(np.arange(200) / 9.0),
}


def refuse_small(file, *words):
    """One line, in a process that takes less than 1.5 GiB and 60 s."""
    code = f"import sepcal\ntry: sepcal.read({str(file)!r})\nexcept sepcal.Error as e: print(e)"
    limit = (3 * GIB // 2, 3 * GIB // 2)
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_DATA, limit),
    )
    assert done.stderr == ""
    assert done.stdout.count("\n") == 1
    for word in (str(file), *words):
        assert word in done.stdout


def test_hdf5_that_declares_more_than_it_has(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as opened:
        opened.create_dataset("airspeed_mps", (10**12,), "f8", chunks=(1000,))
    refuse_small(tmp_path / "a.h5", "airspeed_mps", "unpacks to 7 TiB")


def test_parquet_that_unpacks_to_very_much(tmp_path):
    import pyarrow.parquet as pq

    schema = pa.schema([("airspeed_mps", pa.float64())])
    ones = pa.record_batch([pa.array(np.ones(2**20))], schema=schema)
    with pq.ParquetWriter(tmp_path / "a.parquet", schema) as writer:
        for _ in range(100):
            writer.write_batch(ones)
    assert (tmp_path / "a.parquet").stat().st_size < 2**20
    refuse_small(tmp_path / "a.parquet", "unpacks to 800 MiB", "512 MiB")


def test_arrow_whose_buffer_says_more_than_it_has(tmp_path):
    """The size in front of a compressed buffer, which pyarrow believes, is made a TiB."""
    pandas.DataFrame({"airspeed_mps": np.ones(50_000)}).to_feather(
        tmp_path / "a.feather", compression="zstd"
    )
    data = (tmp_path / "a.feather").read_bytes()
    size = struct.pack("<q", 400_000)
    assert data.count(size) == 1
    (tmp_path / "a.feather").write_bytes(data.replace(size, struct.pack("<q", 2**40)))
    refuse_small(tmp_path / "a.feather", "unpacks to 1 TiB")


def test_arrow_that_unpacks_to_very_much(tmp_path):
    schema = pa.schema([("airspeed_mps", pa.float64())])
    batch = pa.record_batch([pa.array(np.ones(2**23))], schema=schema)
    options = pa.ipc.IpcWriteOptions(compression="zstd")
    with pa.ipc.new_stream(str(tmp_path / "a"), schema, options=options) as stream:
        for _ in range(12):
            stream.write_batch(batch)
    refuse_small(tmp_path / "a", "a column unpacks to")


def test_matlab_that_unpacks_to_very_much(tmp_path):
    packer = zlib.compressobj(9)
    packed = b"".join(packer.compress(bytes(2**24)) for _ in range(64)) + packer.flush()
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM"
    (tmp_path / "a.mat").write_bytes(head + struct.pack("<II", 15, len(packed)) + packed)
    refuse_small(tmp_path / "a.mat", "a variable unpacks to")


def test_a_workbook_that_unpacks_to_very_much(tmp_path):
    import openpyxl

    book = openpyxl.Workbook()
    book.active.append(["time_s", "airspeed_mps"])
    book.save(tmp_path / "a.xlsx")
    with zipfile.ZipFile(tmp_path / "a.xlsx") as parts:
        files = {name: parts.read(name) for name in parts.namelist()}
    with zipfile.ZipFile(tmp_path / "b.xlsx", "w", zipfile.ZIP_DEFLATED) as parts:
        for name, data in files.items():
            parts.writestr(name, data)
        with parts.open("xl/media/big.xml", "w", force_zip64=True) as part:
            for _ in range(64):
                part.write(bytes(2**24))
    refuse_small(tmp_path / "b.xlsx", "the workbook unpacks to 1 GiB")


def test_a_workbook_with_a_cell_far_out(tmp_path):
    """In the last row and column there is."""
    import openpyxl

    book = openpyxl.Workbook()
    book.active.append(["time_s", "airspeed_mps"])
    for row in range(20):
        book.active.append([row * 0.1, 20.0 + row])
    book.active["XFD1048576"] = 1
    book.save(tmp_path / "a.xlsx")
    flight = sepcal.read(tmp_path / "a.xlsx")
    assert flight["airspeed_mps"][:20].tolist() == [20.0 + row for row in range(20)]


def test_a_packed_log_that_unpacks_to_very_much(tmp_path):
    """An IGC file inside, so that it is unpacked at all."""
    with gzip.open(tmp_path / "a.igc.gz", "wb") as packed:
        packed.write(b"AXXX001\r\nHFDTE010326\r\n")
        for _ in range(64):
            packed.write(b"L" * 2**24)
    refuse_small(tmp_path / "a.igc.gz", "it unpacks to")


def test_mcap_whose_chunk_says_much(tmp_path):
    WRITERS["a.mcap"](COLUMNS, tmp_path / "a.mcap")
    data = bytearray((tmp_path / "a.mcap").read_bytes())
    at = data.index(b"\x06", 8 + 9 + struct.unpack_from("<Q", data, 9)[0])
    struct.pack_into("<Q", data, at + 9 + 16, 2**42)
    (tmp_path / "a.mcap").write_bytes(data)
    refuse_small(tmp_path / "a.mcap", "a chunk unpacks to 4 TiB")


def test_what_lies_outside_of_a_file_is_not_read(tmp_path):
    np.arange(100.0).tofile(tmp_path / "secret.bin")
    with h5py.File(tmp_path / "other.h5", "w") as opened:
        opened["secret_pa"] = np.arange(100.0)
    with h5py.File(tmp_path / "a.h5", "w") as opened:
        opened["time_s"] = np.arange(100.0)
        opened["airspeed_mps"] = np.arange(100.0)
        opened["by_link"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "secret_pa")
        opened["soft"] = h5py.SoftLink("/")
        opened.create_dataset(
            "raw", (100,), "f8", external=[(str(tmp_path / "secret.bin"), 0, 800)]
        )
        layout = h5py.VirtualLayout((100,), "f8")
        layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "secret_pa", (100,))
        opened.create_virtual_dataset("virtual", layout)
    assert set(sepcal.read(tmp_path / "a.h5")) == {"time_s", "airspeed_mps"}


def test_a_pickle_in_a_file_runs_nothing(tmp_path):
    pytest.importorskip("tables")
    pandas.DataFrame(COLUMNS).to_hdf(tmp_path / "a.h5", key="log", format="table")
    with h5py.File(tmp_path / "a.h5", "r+") as opened:
        attributes = opened["log/table"].attrs
        attributes["values_block_0_kind"] = np.bytes_(
            f"cos\nsystem\n(Vtouch {tmp_path}/made\ntR.".encode()
        )
    sepcal.read(tmp_path / "a.h5")
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize("name", list(WRITERS))
def test_cut_and_damaged_files(name, tmp_path):
    """Each form cut at 25 places and damaged at 40: a flight or one line, and nothing worse."""
    WRITERS[name](COLUMNS, tmp_path / "whole")
    data = (tmp_path / "whole").read_bytes()
    draw = np.random.default_rng(11)
    spoilt = [data[: int(at)] for at in draw.integers(0, len(data), 25)]
    for _ in range(40):
        changed = bytearray(data)
        for at in draw.integers(0, len(data), draw.integers(1, 20)):
            changed[at] = draw.integers(256)
        spoilt.append(bytes(changed))
    child = os.fork()
    if child == 0:  # a library may crash, which must not take the tests with it
        code = 0
        try:
            signal.alarm(240)
            for number, one in enumerate(spoilt):
                (tmp_path / "log").write_bytes(one)
                try:
                    sepcal.read(tmp_path / "log")
                except sepcal.Error as error:
                    if "\n" in str(error) or "log" not in str(error):
                        code = 1
                        (tmp_path / "why").write_text(f"{number}: {error}")
        except BaseException as error:
            code = 1
            (tmp_path / "why").write_text(repr(error))
        os._exit(code)
    _, status = os.waitpid(child, 0)
    why = tmp_path / "why"
    assert status == 0, why.read_text() if why.exists() else f"status {status}"


@pytest.mark.parametrize(
    ("name", "module", "library"),
    [
        ("a.parquet", "pyarrow", "pyarrow"),
        ("a.feather", "pyarrow", "pyarrow"),
        ("a.h5", "h5py", "h5py"),
        ("new.mat", "h5py", "h5py"),
        ("a.xlsx", "openpyxl", "openpyxl"),
        ("a.mcap", "mcap", "mcap"),
    ],
)
def test_a_missing_library_is_named_with_its_extra(name, module, library, tmp_path, monkeypatch):
    file = tmp_path / name
    WRITERS[name](COLUMNS, file)
    for loaded in [one for one in sys.modules if one.partition(".")[0] == module]:
        monkeypatch.delitem(sys.modules, loaded)
    monkeypatch.setitem(sys.modules, module, None)
    refuse(lambda: sepcal.read(file), str(file), library, "pip install sepcal[files]")


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), ".xlsx"),
        (b"SQLite format 3\0" + bytes(100), "SQLite"),
        (b"%PDF-1.7\n", "a PDF"),
        (b"PK\x03\x04 no archive", "damaged or cut off"),
        (b"#ROSBAG V2.0\n" + bytes(100), "ROS 1"),
        (b"", "empty"),
        (bytes(4000), "NUL"),
    ],
)
def test_forms_that_are_not_read(data, words, tmp_path):
    (tmp_path / "a.dat").write_bytes(data)
    with pytest.raises(sepcal.Error) as caught:
        sepcal.read(tmp_path / "a.dat")
    assert "\n" not in str(caught.value)
    assert "a.dat" in str(caught.value)


def test_what_a_file_may_unpack_to(tmp_path):
    (tmp_path / "a").write_bytes(bytes(100))
    budget = limits.Budget(str(tmp_path / "a"))
    budget.take(limits.LEAST, "it")
    refuse(lambda: budget.take(1, "it"), "a: it unpacks to 1 bytes or more", "100 bytes")
