# SPDX-License-Identifier: BSD-2-Clause
"""60 times kill -9 at random instants of a sweep on 2 ranks, on one of the ranks or on mpirun: no chunk that was there is
lost or solved again, and each archive that is completed at last equals that of an undisturbed run, bit for bit.
python3 sweep_kills.py [GAITER] [KILLS]"""
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

import h5py

from sweep_runs import ENVIRONMENT, GAITER, STRETCH_AND_VOLTAGE, print_load

KILLS = int(sys.argv[2]) if len(sys.argv) > 2 else 60
WORDS = [*STRETCH_AND_VOLTAGE, "-sweep_samples", "60000", "-progress", "off", "-output", "sweep.h5"]


def start(folder):
    command = ["mpirun", "-q", "-n", "2", GAITER, "sweep", *WORDS]
    return subprocess.Popen([str(word) for word in command], cwd=folder, env=ENVIRONMENT, start_new_session=True,
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def processes_of(session):
    """mpirun and its ranks, as far as they live."""
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except (OSError, IndexError):
            continue  # it has just ended
        if int(fields[3]) == session and fields[0] not in "ZX":
            yield int(stat.parent.name)


def kill(pid):
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def end(run):
    """Waits for mpirun, then for ranks that outlive it; both must happen by themselves or are helped after a while."""
    try:
        run.wait(20)
    except subprocess.TimeoutExpired:
        kill(run.pid)
    while ranks := list(processes_of(run.pid)):
        for pid in ranks:
            kill(pid)
        time.sleep(0.01)


def chunks(folder):
    """The chunks that are stored, with the time of their writing."""
    return {path.name: path.stat().st_mtime_ns for path in (folder / "sweep.h5.parts").glob("chunk-*.h5")
            if not path.name.endswith(".tmp")}


def complete(path):
    if not path.exists():
        return False
    with h5py.File(path) as file:
        return "incomplete" not in file.attrs


def contents(path):
    with h5py.File(path) as file:
        return {name: data[()].tobytes() for name, data in file.items() if name not in ("wall_time", "segment")}


def main():
    dice = random.Random(2015)
    kills, archives, victims, most = 0, 0, {"mpirun": 0, "a rank": 0}, 0
    print_load("before")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        begin = time.monotonic()
        if start(folder).wait() != 0:
            raise SystemExit("the undisturbed run does not succeed")
        duration = time.monotonic() - begin
        expected = contents(folder / "sweep.h5")
        (folder / "sweep.h5").unlink()
        while kills < KILLS or (folder / "sweep.h5.parts").exists():
            before, run = chunks(folder), start(folder)
            if kills < KILLS:
                try:
                    run.wait(dice.uniform(0, 1.1 * duration))
                except subprocess.TimeoutExpired:
                    victim = dice.choice(list(processes_of(run.pid)))
                    kill(victim)
                    kills += 1
                    victims["mpirun" if victim == run.pid else "a rank"] += 1
            end(run)
            after = chunks(folder)
            lost = [chunk for chunk in before if after.get(chunk) != before[chunk]]
            if lost and not complete(folder / "sweep.h5"):  # else they are in there
                raise SystemExit(f"lost or solved again after {kills} kills: {lost}")
            most = max(most, len(after))
            if run.returncode == 0:
                if not complete(folder / "sweep.h5") or contents(folder / "sweep.h5") != expected:
                    raise SystemExit(f"after {kills} kills the archive is another one than that of an undisturbed run")
                archives += 1
                (folder / "sweep.h5").unlink()
    print_load("after")
    print(f"{kills} kills ({victims['mpirun']} of mpirun, {victims['a rank']} of a rank), up to {most} chunks taken up, "
          f"{archives} archives completed, all equal to the undisturbed one; nothing was lost or solved again")


if __name__ == "__main__":
    main()
