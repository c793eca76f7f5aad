#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Gaiter beside CalculiX on the comparison cone, on one core each, in turns, in one invocation.

Needs CalculiX's ccx (Debian: calculix-ccx) and h5py. Usage: cone.py [--gaiter build/bin/gaiter] [--repeat 3] [--bulk-modulus 37]

Errors of both are told against Gaiter's mesh refined three times; beside it the value that CalculiX gave when it
was run with other meshes and another path. Times: wall clock and processor time of the whole process, least of the
repetitions, and of the solution alone, as each program tells (its wall clock).
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import cone_model
import h5py

EARLIER = {37.0: 1.2196, 370.0: 1.2208}  # CalculiX 2.20, three meshes agreeing to 0.005 % [kPa]
COARSEST, FINEST = 0, 3  # refinements of Gaiter's mesh
MESHES = [cone_model.Mesh(10, 1, 4), cone_model.Mesh(20, 2, 8)]


def measured(command, folder, log):
    """Wall clock and processor time of a process [s]."""
    before, start = os.times(), time.perf_counter()
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    with open(log, "w") as file:
        result = subprocess.run(command, cwd=folder, env=environment, stdout=file, stderr=subprocess.STDOUT)
    wall, after = time.perf_counter() - start, os.times()
    if result.returncode:
        raise RuntimeError(f"{pathlib.Path(command[0]).name}: exit code {result.returncode}")
    return wall, after.children_user + after.children_system - before.children_user - before.children_system


def gaiter(program, folder, bulk_modulus, refine):
    archive = folder / "cone.h5"
    mu, alpha = zip(*cone_model.OGDEN)
    options = {
        "leg_segments": "cone", "leg_cone_height": f"{cone_model.HEIGHT} mm",
        "leg_cone_radius": f"{cone_model.LOWER_RADIUS},{cone_model.UPPER_RADIUS} mm",
        "leg_material": "neo_hookean", "leg_young": f"{cone_model.YOUNG} MPa",
        "leg_poisson": str(cone_model.POISSON), "bandage_thickness": f"{cone_model.WALL} mm",
        "bandage_ogden_mu": ",".join(f"{1e6 * m:.10g}" for m in mu),
        "bandage_ogden_alpha": ",".join(map(str, alpha)), "bandage_stretch": str(cone_model.STRETCH),
        "bandage_bulk_modulus": f"{bulk_modulus} MPa", "fidelity": "axisym", "axisym_refine": str(refine),
        "output": str(archive)}
    command = [program, "solve"]
    for name, value in options.items():
        command += ["-" + name, value]
    wall, processor = measured(command, folder, folder / "gaiter.log")
    with h5py.File(archive) as file:
        return float(file["pressure_rest_area_mean"][0, 0]) / 1e3, wall, processor, float(file["wall_time"][0])


def calculix(folder, bulk_modulus, mesh):
    cone_model.write_input(folder / "cone.inp", mesh, bulk_modulus)
    wall, processor = measured(["ccx", "cone"], folder, folder / "ccx.log")
    log = (folder / "ccx.log").read_text()
    alone = float(re.findall(r"Total CalculiX Time: *([0-9.]+)", log)[-1])
    return 1e3 * cone_model.evaluate(folder / "cone.dat", mesh), wall, processor, alone


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    build = pathlib.Path(__file__).resolve().parents[2] / "build" / "bin" / "gaiter"
    parser.add_argument("--gaiter", default=str(build))
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--bulk-modulus", type=float, choices=EARLIER, action="append", help="of the tube [MPa]")
    arguments = parser.parse_args()
    if not shutil.which("ccx"):
        sys.exit("ccx is not installed; on Debian: apt-get install calculix-ccx")
    program = str(pathlib.Path(arguments.gaiter).resolve())
    print("mean pressure [kPa], seconds of the whole process (wall, processor) and of the solution alone")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for bulk_modulus in arguments.bulk_modulus or EARLIER:
            earlier = EARLIER[bulk_modulus]
            exact = gaiter(program, folder, bulk_modulus, FINEST)[0]
            print(f"\nK_tube {bulk_modulus:.0f} MPa: Gaiter's finest {exact:.5f}, CalculiX earlier {earlier}")
            ways = {f"Gaiter, refine {COARSEST}": lambda: gaiter(program, folder, bulk_modulus, COARSEST)}
            for mesh in MESHES:
                label = f"CalculiX, {mesh.axial} x ({mesh.wall} + {mesh.radial})"
                ways[label] = lambda mesh=mesh: calculix(folder, bulk_modulus, mesh)
            runs = {label: [] for label in ways}
            for _ in range(arguments.repeat):
                for label, run in list(ways.items()):
                    try:
                        runs[label].append(run())
                    except RuntimeError as failure:  # CalculiX does not get through on every mesh
                        print(f"{label:26s} {failure}")
                        del ways[label], runs[label]
            ours = None
            for label, values in runs.items():
                pressure = values[0][0]
                least = [min(value[k] for value in values) for k in (1, 2, 3)]
                ours = ours or least
                ratios = ", ".join(f"{theirs / mine:.0f}" for theirs, mine in zip(least, ours))
                print(f"{label:26s} {pressure:.5f} error {pressure / exact - 1:+.1e}   "
                      + " ".join(f"{seconds:8.3f}" for seconds in least) + f"   times Gaiter's: {ratios}")


if __name__ == "__main__":
    main()
