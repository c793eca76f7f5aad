# SPDX-License-Identifier: BSD-2-Clause
"""Throughput of a sweep of slices with its archive, the paper's leg at rest and under voltage: on one rank, on two with
as many designs, on two with twice as many; by the clock and by processor time, which other users of the machine
disturb less. At the end what the counters of the runs mean for 10,000 ranks. python3 sweep_throughput.py [GAITER]"""
from sweep_runs import STRETCH_AND_VOLTAGE, Sweep, median, print_load, spread

REPETITIONS, DESIGNS = 5, 200_000
RUNS = {"1 rank": (1, DESIGNS), "2 ranks": (2, DESIGNS), "2 ranks, weak": (2, 2 * DESIGNS)}


def main():
    print_load("before")
    Sweep(1, *STRETCH_AND_VOLTAGE, "-sweep_samples", "1000")  # fetches the program from the disk
    done = {name: [] for name in RUNS}
    for _ in range(REPETITIONS):
        for name, (ranks, designs) in RUNS.items():
            done[name].append(Sweep(ranks, *STRETCH_AND_VOLTAGE, "-sweep_samples", designs))
    print_load("after")
    print(f"medians of {REPETITIONS} runs; equilibria a second in millions\n"
          f"{'':14} {'clock':>8} {'noise':>6} {'a rank and s':>13} {'noise':>6} {'archive':>8} {'archive of':>11} "
          f"{'waiting':>8} {'merge':>6}\n"
          f"{'':14} {'':8} {'':6} {'of processor':>13} {'':6} {'of time':>8} {'processor':>11} {'at end':>8} {'':6}")
    clock, processor = {}, {}
    for name, (ranks, _) in RUNS.items():
        runs = done[name]
        clock[name], noise = spread([ranks * run.said["equilibria_per_second"] for run in runs])
        processor[name], processor_noise = spread([run.said["equilibria_per_processor_second"] for run in runs])
        print(f"{name:14} {clock[name] / 1e6:8.2f} {noise:6.0%} {processor[name] / 1e6:13.2f} {processor_noise:6.0%} "
              f"{median(runs, 'archive_percent'):7.1f}% {median(runs, 'archive_processor_percent'):10.1f}% "
              f"{median(runs, 'at_the_end'):7.2f}s {median(runs, 'merge'):5.2f}s")
    one = done["1 rank"]
    # If each rank had a processor to itself, and as if the merge, which waits for the disk, were not shared.
    merge = median(one, "merge") / median(one, "seconds")
    for name in ("2 ranks", "2 ranks, weak"):
        cost = processor["1 rank"] / processor[name]
        print(f"{name} against 1: {clock[name] / clock['1 rank']:.2f} times by the clock; a design takes {cost:.3f} times "
              f"the processor time, which gives {1 / ((1 - merge) * cost / 2 + merge):.2f} times with a processor each")

    weak = done["2 ranks, weak"]
    rate = median(one, "designs") / median(one, "processor")
    merged = median(weak, "designs") / median(weak, "merge")
    messages, waiting = median(weak, "messages"), median(weak, "waiting")
    print(f"\nfor 10,000 ranks: {rate:.3g} designs a second and rank; {messages:.2g} messages and {waiting:.2g} s of waiting "
          f"for them a design;\n2 ranks and this disk merge {merged:.3g} designs a second, as many as {merged / rate:.0f} ranks "
          f"solve meanwhile: 1e9 designs are solved in {1e9 / rate / 1e4:.1f} s and merged in {1e9 / merged:.0f} s by a "
          f"disk like this;\nall ranks merge, so a parallel file system takes as much less as it is faster")


if __name__ == "__main__":
    main()
