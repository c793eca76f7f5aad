# SPDX-License-Identifier: BSD-2-Clause
"""What the benchmarks of sweeps share: a run under mpirun, what its summary says, and how loaded the machine is.
All of them take the program as their one argument, by default build/bin/gaiter."""
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parent.parent
GAITER = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else SOURCE / "build" / "bin" / "gaiter").resolve()
PAPER = SOURCE / "options" / "scenes" / "paper.yaml"
STRETCH_AND_VOLTAGE = ["-options_file", PAPER, "-comparison", "none", "-sweep_sampler", "sobol",
                       "-sweep_bandage_stretch", "uniform(1.3, 2.2)", "-sweep_voltage", "uniform(0 kV, 11.3 kV)"]
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMP_NUM_THREADS": "1"}
NUMBER = r"([-+.\de]+)"
SUMMARY = {  # name: its place in the summary of a sweep
    "designs": rf"{NUMBER} designs in ",
    "seconds": rf"designs in {NUMBER} s on",
    "equilibria_per_second": rf"{NUMBER} equilibria/s a rank",
    "imbalance": rf"imbalance {NUMBER}",
    "archive_percent": rf"archive {NUMBER} % of the time",
    "processor": rf"processor time {NUMBER} s",
    "equilibria_per_processor_second": rf"{NUMBER} equilibria/s of it",
    "archive_processor_percent": rf"archive {NUMBER} % of it",
    "messages": rf"{NUMBER} messages",
    "waiting": rf"and {NUMBER} s of waiting for them",
    "at_the_end": rf"at the end {NUMBER} s a rank",
    "merge": rf"{NUMBER} s for the merge",
}


class Sweep:
    """One sweep in a folder of its own: what its summary says is in `said`, by name; `peak` is the largest memory of
    each rank [bytes] where it is watched, which takes half a core; `wall` what the run took with start and end [s]."""

    def __init__(self, ranks, *words, keep=False, watch_memory=False):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="gaiter_benchmark_"))
        try:
            start = time.monotonic()
            command = ["mpirun", "-q", "-n", str(ranks), GAITER, "sweep", *words, "-output", "sweep.h5", "-progress", "log"]
            run = subprocess.Popen([str(word) for word in command], cwd=folder, env=ENVIRONMENT, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
            self.peak = {}
            while watch_memory and run.poll() is None:
                self.peak.update(peaks_of(run.pid))
                time.sleep(0.02)
            out, err = run.communicate()
            self.wall = time.monotonic() - start
            if run.returncode not in (0, 3):
                sys.exit(f"{' '.join(map(str, command))}\nended with {run.returncode}\n{out}{err}")
            self.said = {name: float(found[1]) for name, text in SUMMARY.items() if (found := re.search(text, out))}
            self.bytes = (folder / "sweep.h5").stat().st_size
            self.file = folder / "sweep.h5"
        finally:
            if not keep:
                shutil.rmtree(folder)


def peaks_of(session):
    """The largest memory so far of each rank [bytes], from /proc."""
    peaks = {}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "stat").read_text().rsplit(")", 1)
            if not words[0].endswith("(gaiter") or int(words[1].split()[3]) != session:
                continue
            found = re.search(r"VmHWM:\s+(\d+) kB", (folder / "status").read_text())
        except (OSError, IndexError):
            continue  # it has just ended
        if found:
            peaks[int(folder.name)] = 1024 * int(found[1])
    return peaks


def median(runs, name):
    return statistics.median(run.said[name] for run in runs)


def spread(values):
    """Median and, as a measure of the noise, half the range relative to it."""
    middle = statistics.median(values)
    return middle, (max(values) - min(values)) / (2 * middle)


def print_load(when):
    print(f"load {when}: {os.getloadavg()[0]:.1f} on {len(os.sched_getaffinity(0))} cores", flush=True)
