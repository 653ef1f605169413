# SPDX-License-Identifier: BSD-3-Clause
"""What libraries write beside plain numbers: packing, types and versions that a reader meets."""

import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest

import sepcal
from refusals import refuse

SECONDS = np.arange(0.0, 5.0, 0.1)
PRESSURE = 150.0 + np.sin(SECONDS)


@pytest.fixture
def pytables():
    pytest.importorskip("h5py")
    return pytest.importorskip("tables", reason="PyTables writes the file: pip install tables")


@pytest.mark.parametrize("packing", ["blosc", "blosc2", "bzip2"])
def test_hdf5_packed_by_what_h5py_does_not_bring(packing, pytables, tmp_path):
    """It is not called damaged, and what is advised makes a file that is read."""
    if pytables.which_lib_version(packing) is None:
        pytest.skip(f"PyTables was built without {packing}")
    packed, again = tmp_path / "packed.h5", tmp_path / "again.h5"
    with pytables.open_file(packed, "w", filters=pytables.Filters(5, packing)) as file:
        file.create_carray("/", "time_s", obj=SECONDS)
        file.create_carray("/", "dp_pa", obj=PRESSURE)
    refuse(lambda: sepcal.read(packed), "packed.h5: ", packing, "ptrepack --complib=zlib")
    repack = "import sys; from tables.scripts.ptrepack import main; main()"
    options = ["--complib=zlib", "--complevel=1"]
    told = subprocess.run([sys.executable, "-c", repack, *options, packed, again], check=False)
    assert told.returncode == 0
    assert np.array_equal(sepcal.read(again)["dp_pa"], PRESSURE)


def test_hdf5_with_times_of_its_own_type(pytables, tmp_path):
    """h5py has no such type: what else the file has is read, and the note says what is not."""
    file = tmp_path / "log.h5"
    with pytables.open_file(file, "w") as opened:
        opened.create_array("/", "time_s", obj=SECONDS)
        opened.create_array("/", "dp_pa", obj=PRESSURE)
        times = opened.create_earray("/", "stamp", pytables.Time64Atom(), (0,))
        times.append(SECONDS)
    flight = sepcal.read(file)
    assert np.array_equal(flight["dp_pa"], PRESSURE)
    assert any("can't read their type: /stamp" in note for note in flight.notes)


def test_hdf5_with_nothing_else(pytables, tmp_path):
    file = tmp_path / "log.h5"
    with pytables.open_file(file, "w") as opened:
        times = opened.create_earray("/", "stamp", pytables.Time64Atom(), (0,))
        times.append(SECONDS)
    refuse(lambda: sepcal.read(file), "log.h5: ", "/stamp", "float64")


def test_the_table_outside_of_all_groups_has_a_name(tmp_path):
    h5py = pytest.importorskip("h5py")
    file = tmp_path / "log.h5"
    with h5py.File(file, "w") as opened:
        opened["time_s"], opened["a"] = SECONDS, PRESSURE
        opened["more/time_s"], opened["more/b"] = SECONDS[:9], PRESSURE[:9]
    refuse(lambda: sepcal.read(file), "'/', 'more'", f"'{file}::/'")
    assert np.array_equal(sepcal.read(f"{file}::/")["a"], PRESSURE)
    assert sepcal.read(f"{file}::more").rows == 9


def test_matlab_4(tmp_path):
    """It has no magic number; written anew it is read."""
    io = pytest.importorskip("scipy.io")
    old, new = tmp_path / "old.mat", tmp_path / "new.mat"
    io.savemat(old, {"time_s": SECONDS, "dp_pa": PRESSURE}, format="4")
    refuse(lambda: sepcal.read(old), "old.mat: ", "MATLAB 4", "-v7")
    columns = {name: part for name, part in io.loadmat(old).items() if name[0] != "_"}
    io.savemat(new, columns)
    assert np.array_equal(sepcal.read(new)["dp_pa"], PRESSURE)


def test_matlab_4_of_the_other_order(tmp_path):
    """By the format's table: M = 1, big-endian; a name of seven characters and a NUL."""
    head = struct.pack(">5i", 1000, len(SECONDS), 1, 0, 8) + b"time__s\0"
    (tmp_path / "old.mat").write_bytes(head + SECONDS.astype(">f8").tobytes())
    refuse(lambda: sepcal.read(tmp_path / "old.mat"), "MATLAB 4")


def test_a_packed_variable_without_an_end(tmp_path):
    """All its values are there, and zlib's stream breaks off behind them."""
    io = pytest.importorskip("scipy.io")
    file = tmp_path / "log.mat"
    io.savemat(file, {"dp_pa": PRESSURE})
    plain = file.read_bytes()
    stream = zlib.compressobj()
    packed = stream.compress(plain[128:]) + stream.flush(zlib.Z_SYNC_FLUSH)
    file.write_bytes(plain[:128] + struct.pack("<2I", 15, len(packed)) + packed)
    refuse(lambda: sepcal.read(file), "log.mat: ", "damaged or cut off", "no end")
    whole = zlib.compress(plain[128:])
    file.write_bytes(plain[:128] + struct.pack("<2I", 15, len(whole)) + whole)
    assert np.array_equal(sepcal.read(file)["dp_pa"], PRESSURE)


def test_netcdf_of_the_classic_form(tmp_path):
    """Written anew as netCDF-4, here by h5py, it is read."""
    io = pytest.importorskip("scipy.io")
    file = tmp_path / "log.nc"
    with io.netcdf_file(file, "w") as opened:
        opened.createDimension("row", len(SECONDS))
        opened.createVariable("dp", "f8", ("row",))[:] = PRESSURE
    refuse(lambda: sepcal.read(file), "log.nc: netCDF of the classic form", "nccopy")


def test_arrays_of_numpy(tmp_path):
    """What the line advises makes the table."""
    file = tmp_path / "log.npz"
    np.savez(file, time_s=SECONDS, dp_pa=PRESSURE)
    refuse(lambda: sepcal.read(file), "log.npz: arrays of NumPy", "dict(numpy.load(")
    assert np.array_equal(sepcal.read(dict(np.load(file)))["dp_pa"], PRESSURE)
