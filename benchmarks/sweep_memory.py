# SPDX-License-Identifier: BSD-2-Clause
"""Memory of each rank (VmHWM) of sweeps of ever more designs: flat. python3 sweep_memory.py [GAITER]"""
from sweep_runs import STRETCH_AND_VOLTAGE, Sweep, print_load

RANKS, DESIGNS = 2, (100_000, 1_000_000, 10_000_000)


def main():
    print_load("before")
    print(f"{'designs':>10} {'MB of each rank':>20} {'archive, GB':>12} {'s':>6}")
    for designs in DESIGNS:
        run = Sweep(RANKS, *STRETCH_AND_VOLTAGE, "-sweep_samples", designs, watch_memory=True)
        peaks = ", ".join(f"{peak / 1e6:.1f}" for _, peak in sorted(run.peak.items()))
        print(f"{designs:10} {peaks:>20} {run.bytes / 1e9:12.3f} {run.wall:6.1f}", flush=True)
    print_load("after")


if __name__ == "__main__":
    main()
