# SPDX-License-Identifier: BSD-2-Clause
"""Opens samples written by tests/archive.cpp on 1, 2, 3 ranks with h5py and xarray, as users do, and checks
names, dimensions, units, flags and values. Usage: archive_opens.py SAMPLE.h5 ..."""
import sys

import h5py
import numpy as np
import xarray

CASES = 5
SEGMENTS = ["r6", "r5", "mollet_été"]
SHAPE = (CASES, len(SEGMENTS))
ROW = np.arange(CASES * len(SEGMENTS)).reshape(SHAPE)

# In the order in which archive.cpp counts its values: 1000.25, 2000.25, ... and the unit of each.
REALS = {
    "pressure_rest": "Pa", "pressure_actuated": "Pa", "pressure_rest_rigid": "Pa",
    "pressure_actuated_rigid": "Pa", "pressure_rest_area_mean": "Pa", "pressure_actuated_area_mean": "Pa",
    "pressure_rest_change": "1", "pressure_actuated_change": "1", "actuation_drop": "Pa", "actuation_pressure": "Pa", "volume_initial": "m3", "volume_rest": "m3",
    "volume_actuated": "m3", "volume_change": "1", "radius_actuated": "m", "stretch_actual": "1", "slip_max": "m",
    "electric_field_max": "V m-1", "voltage_stable": "V", "error_estimate": "1", "discretisation_error": "1", "model_error": "1",
    "planned_discretisation_error": "1", "planned_model_error": "1", "planned_cost": "s",
}
FLAGS = {
    "status": "contact slack lifted extrapolated pulled_in no_equilibrium diverged invalid not_wanted",
    "fidelity": "rigid slice sliding axisym first_order",
}
PER_CASE = {
    "bandage_stretch": ("1", 1.5 + 0.125 * np.arange(CASES)),
    "voltage": ("V", 1000.0 * np.arange(CASES)),
    "wall_time": ("s", 0.5 + np.arange(CASES)),
}
FILE_ATTRIBUTES = {
    "schema_version": 1, "gaiter_version": "0.1.0", "petsc_version": "3.18.5", "options": "voltage: 11.3 kV\n",
    "command": "gaiter sweep -voltage '11.3 kV'", "created": "2026-01-02T03:04:05Z", "ranks": 2,
}


def real_values(position):
    values = 1000.0 * (position + 1) + ROW + 0.25
    if position == 0:
        values[ROW % 7 == 6] = np.nan  # the rows that have diverged
    return values


def check_with_h5py(path):
    with h5py.File(path, "r") as file:
        names = {"case", "segment", "iterations", "slices_used", "wall_points_used", "unknowns", *REALS, *FLAGS, *PER_CASE}
        assert set(file) == names, set(file) ^ names
        for name in file:
            assert isinstance(file[name], h5py.Dataset), name
            assert isinstance(file[name].attrs["long_name"], str), name
        for name in [*REALS, *FLAGS, "iterations"]:
            assert [d.keys()[0] for d in file[name].dims] == ["case", "segment"], name
        for name in PER_CASE:
            assert [d.keys()[0] for d in file[name].dims] == ["case"], name
        assert dict(file.attrs) == FILE_ATTRIBUTES, dict(file.attrs)
        for name, meanings in FLAGS.items():
            assert file[name].dtype == np.int8, name
            assert file[name].attrs["flag_values"].dtype == np.int8, name
            assert file[name].attrs["flag_values"].tolist() == list(range(len(meanings.split()))), name
            assert file[name].attrs["flag_meanings"] == meanings, name
        assert file["iterations"].dtype == np.int32
        assert file["case"].dtype == np.int64


def check_with_xarray(path):
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert dict(data.sizes) == {"case": CASES, "segment": len(SEGMENTS)}, data.sizes
        assert set(data.coords) == {"case", "segment"}
        assert data["case"].values.tolist() == list(range(CASES))
        assert data["segment"].values.tolist() == SEGMENTS, data["segment"].values
        assert all(isinstance(name, str) for name in data["segment"].values.tolist())
        for position, (name, unit) in enumerate(REALS.items()):
            assert data[name].dims == ("case", "segment"), name
            assert data[name].dtype == np.float64, name
            assert data[name].attrs["units"] == unit, name
            np.testing.assert_array_equal(data[name].values, real_values(position), err_msg=name)
        assert data["status"].dtype == np.int8 and data["fidelity"].dtype == np.int8
        np.testing.assert_array_equal(data["status"].values, ROW % 7)
        np.testing.assert_array_equal(data["fidelity"].values, ROW % 2)
        np.testing.assert_array_equal(data["iterations"].values, 100000 + ROW)
        np.testing.assert_array_equal(data["slices_used"].values, 200000 + ROW)
        np.testing.assert_array_equal(data["wall_points_used"].values, 300000 + ROW)
        np.testing.assert_array_equal(data["unknowns"].values, 400000 + ROW)
        for name, (unit, values) in PER_CASE.items():
            assert data[name].dims == ("case",), name
            assert data[name].dtype == np.float64, name
            assert data[name].attrs["units"] == unit, name
            np.testing.assert_array_equal(data[name].values, values, err_msg=name)
        # What a user does with it: choose by name.
        assert float(data["pressure_actuated"].sel(segment="r5", case=3)) == 2010.25
        assert data["pressure_rest"].attrs["long_name"].endswith("mean over the height of the segment")
        assert "at rest" in data["stretch_actual"].attrs["long_name"]


def check_same_bytes(path, other):
    with h5py.File(path, "r") as one, h5py.File(other, "r") as two:
        assert set(one) == set(two)
        for name in one:
            if name == "segment":
                assert one[name].asstr()[:].tolist() == two[name].asstr()[:].tolist()
            else:
                assert one[name][:].tobytes() == two[name][:].tobytes(), (name, path, other)


if __name__ == "__main__":
    samples = sys.argv[1:]
    assert samples, __doc__
    for sample in samples:
        check_with_h5py(sample)
        check_with_xarray(sample)
        check_same_bytes(sample, samples[0])
