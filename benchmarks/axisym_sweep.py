# SPDX-License-Identifier: BSD-2-Clause
"""100 mixed designs by finite elements on 1 and on 2 ranks: stretch, wall, taper and refinement are drawn, so that the
cost of designs varies many times over. python3 axisym_sweep.py [GAITER]"""
import shutil

import h5py
import numpy as np

from sweep_runs import PAPER, Sweep, median, print_load, spread

REPETITIONS = 3
SCENE = ["-options_file", PAPER.with_name("stocking_single_segment.yaml"), "-fidelity", "axisym",
         "-leg_ankle_radius", "35 mm, 41 mm", "-sweep_sampler", "random", "-sweep_samples", "100",
         "-sweep_bandage_stretch", "uniform(1.15, 1.6)", "-sweep_bandage_thickness", "uniform(0.3 mm, 1.5 mm)",
         "-sweep_leg_ankle_radius_lower", "uniform(35 mm, 41 mm)", "-sweep_axisym_refine", "uniform(0, 2)"]


def main():
    print_load("before")
    done = {1: [], 2: []}
    for _ in range(REPETITIONS):
        for ranks, runs in done.items():
            run = Sweep(ranks, *SCENE, keep=True)
            with h5py.File(run.file) as file:
                times, status = file["wall_time"][:], file["status"][:, 0]
            shutil.rmtree(run.file.parent)
            runs.append(run)
    print_load("after")
    one, two = done[1], done[2]
    print(f"statuses {np.unique(status, return_counts=True)}; a design takes {times.min():.2f} to {times.max():.2f} s")
    print(f"{'ranks':>5} {'seconds':>8} {'noise':>6} {'processor s':>12} {'noise':>6} {'imbalance':>9} {'waiting at the end':>18} "
          f"{'messages':>9} {'waiting a design':>16}")
    for ranks, runs in done.items():
        seconds, noise = spread([run.said["seconds"] for run in runs])
        processor, processor_noise = spread([run.said["processor"] for run in runs])
        print(f"{ranks:5} {seconds:8.2f} {noise:6.0%} {processor:12.2f} {processor_noise:6.0%} "
              f"{median(runs, 'imbalance'):9.3f} {median(runs, 'at_the_end'):17.2f}s {median(runs, 'messages'):9.2g} "
              f"{median(runs, 'waiting'):15.2g}s")
    clock, _ = spread([a.said["seconds"] / b.said["seconds"] / 2 for a, b in zip(one, two)])
    print(f"efficiency on 2 ranks by the clock: {clock:.2f}")
    cost, _ = spread([a.said["processor"] / b.said["processor"] for a, b in zip(one, two)])
    idle, _ = spread([(b.said["at_the_end"] + b.said["merge"]) / b.said["seconds"] for b in two])
    print(f"processor time of the designs on 1 rank over that on 2: {cost:.3f}; less what a rank is idle at the end: "
          f"{cost * (1 - idle):.2f}")


if __name__ == "__main__":
    main()
