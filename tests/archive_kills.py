# SPDX-License-Identifier: BSD-2-Clause
"""A sweep's archive against kill -9 on any process at any instant, a full disk, folders that may not be written, a
second run, and another program that reads while it is written. Usage: archive_kills.py ARCHIVE_RUN MPIEXEC"""
import os
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import h5py
import numpy as np
import xarray

PROGRAM, MPIEXEC = os.path.abspath(sys.argv[1]), sys.argv[2]
CASES, CHUNK = 200, 7
NOBODY = 65534


class Run:
    """The program on some ranks (0: without mpiexec), in a folder."""

    def __init__(self, folder, name="sweep.h5", ranks=0, cases=CASES, chunk=CHUNK, pause=0, options=None, **more):
        self.ranks = ranks
        launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks else []
        words = [PROGRAM, name, str(cases), str(chunk), str(pause)] + ([options] if options else [])
        self.process = subprocess.Popen([*launch, *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        text=True, stdin=subprocess.DEVNULL, start_new_session=True, **more)

    def victims(self):
        """The process; under mpiexec also its children, the ranks."""
        if not self.ranks:
            return [self.process.pid]
        return [self.process.pid, *sorted(processes_of(1, self.process.pid))]

    def kill_one(self, dice):
        victim = dice.choice(self.victims())
        try:
            os.kill(victim, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def end(self):
        """Waits for the end of all its processes. Returns the exit code; `out` and `err` are what it has said."""
        deadline = time.monotonic() + 60
        try:
            while True:
                try:
                    self.out, self.err = self.process.communicate(timeout=5)
                    break
                except subprocess.TimeoutExpired:
                    if self.ranks and set(processes_of(3, self.process.pid)) <= {self.process.pid}:
                        # When a rank dies while it starts, Open MPI's mpiexec can wait for ever for a lock of its own.
                        self.process.kill()
                    elif time.monotonic() > deadline:
                        raise
        finally:
            self.kill_all()  # ranks that have lost their mpiexec
        return self.process.returncode

    def kill_all(self):
        """Every process of the run, and waits until they are gone. Ranks have process groups of their own."""
        def living():
            for pid in processes_of(3, self.process.pid):
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
                yield pid
        wait_for(lambda: not list(living()))


def processes_of(field, number):
    """Those that have not ended, chosen by a field of /proc/PID/stat counted from the state: 1 parent, 3 session."""
    for status in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = status.read_text(encoding="utf-8").rsplit(")", 1)[1].split()
        except (OSError, IndexError):
            continue  # it has just ended
        if int(fields[field]) == number and fields[0] not in "ZX":
            yield int(status.parent.name)


def wait_for(condition):
    deadline = time.monotonic() + 30
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError("what the test waits for does not happen")
        time.sleep(0.005)


def stored(text):
    return {int(number) for number in re.findall(r"(?m)^stored (\d+)$", text)}


class Kills(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.file = self.folder / "sweep.h5"
        self.parts = self.folder / "sweep.h5.parts"

    def finish(self, **how):
        run = Run(self.folder, **how)
        code = run.end()
        self.assertEqual(code, 0, run.out + run.err)
        return run

    def undisturbed(self, **how):
        with tempfile.TemporaryDirectory() as folder:
            run = Run(folder, **how)
            self.assertEqual(run.end(), 0, run.err)
            return (pathlib.Path(folder) / "sweep.h5").read_bytes()

    def kill_until_done(self, ranks, dice, moment, most_kills, cases=CASES, chunk=CHUNK):
        """Starts and kills until a run gets through; `moment(run)` waits for the instant. Returns the kills."""
        done, kills, merged_before, self.torn_merges = set(), 0, False, 0
        while True:
            run = Run(self.folder, ranks=ranks, cases=cases, chunk=chunk, pause=2)
            if kills < most_kills and moment(run):
                run.kill_one(dice)
                kills += 1
            code = run.end()
            self.torn_merges += len(list(self.parts.glob("merged*")))
            found = re.search(r"found (\d+) of", run.out)
            if found and not merged_before:
                # A chunk may be stored whose line was not printed any more, never the reverse.
                self.assertGreaterEqual(int(found[1]), len(done), run.out)
                self.assertFalse(done & stored(run.out), "computed again what was stored")
            done |= stored(run.out)
            if self.file.exists():
                with h5py.File(self.file) as file:
                    status = file["status"][:]
                    merged_before = "incomplete" not in file.attrs
                rows = np.arange(status.size).reshape(status.shape) % 7
                self.assertTrue(((status == rows) | (status == -1)).all())
                for number in done:
                    there = slice(chunk * number, chunk * (number + 1))
                    self.assertTrue((status[there] == rows[there]).all(), f"chunk {number} is lost")
            if code == 0:
                return kills

    def test_killed_at_any_instant(self):
        expected = self.undisturbed()
        for seed, ranks in enumerate([0, 2, 3]):
            dice = random.Random(seed)

            def after_a_while(run, dice=dice):
                deadline = time.monotonic() + dice.uniform(0, 0.6)
                while time.monotonic() < deadline and run.process.poll() is None:
                    time.sleep(0.001)
                return run.process.poll() is None

            with self.subTest(ranks=ranks, seed=seed):
                kills = self.kill_until_done(ranks, dice, after_a_while, 6)
                self.assertGreater(kills, 2)
                self.assertTrue(self.file.read_bytes() == expected)
                self.assertEqual([path.name for path in self.folder.iterdir()], ["sweep.h5"])
                self.file.unlink()

    def test_killed_while_merging(self):
        size = {"cases": 12000, "chunk": 50}
        expected = self.undisturbed(**size)
        for seed, ranks in enumerate([0, 2]):
            dice = random.Random(seed)

            def while_merging(run, dice=dice):
                while run.process.poll() is None:
                    if self.parts.is_dir() and any(self.parts.glob("merged*")):
                        time.sleep(dice.uniform(0, 0.03))
                        return True
                    time.sleep(0.0005)
                return False

            with self.subTest(ranks=ranks):
                self.assertGreater(self.kill_until_done(ranks, dice, while_merging, 12, **size), 1)
                self.assertGreater(self.torn_merges, 0)
                self.assertTrue(self.file.read_bytes() == expected)
                self.assertEqual([path.name for path in self.folder.iterdir()], ["sweep.h5"])
                self.file.unlink()

    def test_second_run_is_refused_and_a_dead_one_holds_nothing(self):
        first = Run(self.folder, ranks=2, pause=500)
        wait_for(self.file.exists)
        for ranks in (0, 2):
            second = Run(self.folder, ranks=ranks)
            self.assertEqual(second.end(), 2, second.err)
            self.assertIn("-output sweep.h5: another run is writing this archive", second.err)
        first.kill_all()
        first.end()
        self.finish()
        self.assertTrue(self.file.read_bytes() == self.undisturbed())

    def test_other_options_are_refused(self):
        run = Run(self.folder, pause=5)
        wait_for(lambda: any(self.parts.glob("chunk-*.h5")))
        run.process.kill()
        run.end()
        for ranks in (0, 2):
            other = Run(self.folder, ranks=ranks, options="voltage: 12 kV\n")
            self.assertEqual(other.end(), 2)
            self.assertIn("-output sweep.h5: an unfinished archive is there, of a sweep with other options: "
                          "-voltage 11.3 kV (now 12 kV)", other.err)
        self.finish()

    def test_full_disk(self):
        # Room for the last and small chunk only, or for all but not for the whole.
        for limit, chunk, ranks, what in ((100_000, 2400, 0, "cannot be stored"), (100_000, 2400, 3, "cannot be stored"),
                                          (140_000, 1000, 0, "cannot make room for"),
                                          (140_000, 1000, 2, "cannot make room for")):
            with self.subTest(limit=limit, ranks=ranks):
                run = Run(self.folder, ranks=ranks, cases=5000, chunk=chunk,
                          env={**os.environ, "ARCHIVE_RUN_LIMIT": str(limit)})
                self.assertNotEqual(run.end(), 0)
                self.assertRegex(run.err, f"-output sweep.h5: .*{what}.*File too large; the chunks stored before "
                                          "are kept, and the same command continues the run")
                with h5py.File(self.file) as file:
                    self.assertIn("incomplete", file.attrs)
                again = self.finish(cases=5000, chunk=chunk)
                self.assertIn(f"found {len(stored(run.out))} of", again.out)
                self.assertTrue(self.file.read_bytes() == self.undisturbed(cases=5000, chunk=chunk))
                self.file.unlink()

    @unittest.skipUnless(os.geteuid() == 0, "root alone can make a small disk")
    def test_full_file_system(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=400k", "tmpfs", disk], check=False).returncode != 0:
            self.skipTest("no file system can be mounted here")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        for ranks, chunk in ((0, 7), (2, 7), (2, 100)):
            with self.subTest(ranks=ranks, chunk=chunk):
                run = Run(disk, ranks=ranks, cases=700, chunk=chunk)
                self.assertNotEqual(run.end(), 0)
                self.assertRegex(run.err, "-output sweep.h5: .*No space left on device; the chunks stored before are "
                                          "kept, and the same command continues the run")
                subprocess.run(["mount", "-o", "remount,size=100m", disk], check=True)
                again = Run(disk, cases=700, chunk=chunk)
                self.assertEqual(again.end(), 0, again.err)
                self.assertIn(f"found {len(stored(run.out))} of", again.out)
                self.assertTrue((disk / "sweep.h5").read_bytes() == self.undisturbed(cases=700, chunk=chunk))
                (disk / "sweep.h5").unlink()
                subprocess.run(["mount", "-o", "remount,size=400k", disk], check=True)

    @unittest.skipUnless(os.geteuid() == 0, "root alone can become a user that may not write here")
    def test_what_may_not_be_written(self):
        def as_nobody():
            os.setgid(NOBODY)
            os.setuid(NOBODY)

        os.chmod(self.folder, 0o755)  # of root
        run = Run(self.folder, preexec_fn=as_nobody)
        self.assertEqual(run.end(), 2)
        self.assertIn("-output sweep.h5: the folder sweep.h5.parts cannot be made: Permission denied", run.err)
        self.assertEqual(list(self.folder.iterdir()), [])

        os.chmod(self.folder, 0o777)
        started = Run(self.folder, pause=20, preexec_fn=as_nobody)
        wait_for(lambda: any(self.parts.glob("chunk-*.h5")))
        os.chmod(self.parts, 0o555)
        os.chown(self.parts, 0, 0)
        self.assertNotEqual(started.end(), 0)
        self.assertRegex(started.err, "-output sweep.h5: chunk [0-9]+ cannot be stored: cannot make .*Permission denied")
        before = stored(started.out)
        run = Run(self.folder, preexec_fn=as_nobody)
        self.assertEqual(run.end(), 2)
        self.assertIn("-output sweep.h5: ", run.err)
        os.chmod(self.parts, 0o777)

        os.chmod(self.file, 0o444)
        run = Run(self.folder, preexec_fn=as_nobody)
        self.assertEqual(run.end(), 2)
        self.assertIn("-output sweep.h5: this file is read-only", run.err)
        os.chmod(self.file, 0o644)
        again = self.finish(preexec_fn=as_nobody)
        self.assertGreaterEqual(int(re.search(r"found (\d+) of", again.out)[1]), len(before))
        self.assertTrue(self.file.read_bytes() == self.undisturbed())

        os.chmod(self.file, 0o444)  # complete: nothing to write
        self.finish(preexec_fn=as_nobody)

    def test_xarray_opens_it_unfinished_and_finished(self):
        run = Run(self.folder, ranks=2, pause=500)
        wait_for(lambda: len(list(self.parts.glob("chunk-*.h5"))) >= 5)
        with xarray.open_dataset(self.file, engine="h5netcdf") as data:
            self.assertEqual(dict(data.sizes), {"case": CASES, "segment": 3})
            self.assertEqual(data["case"].values.tolist(), list(range(CASES)))
            self.assertEqual(data["status"].attrs["flag_meanings"].split()[0], "pending")
            self.assertEqual(data["status"].attrs["flag_values"][0], -1)
            pending = data["status"].values == -1
            self.assertTrue(0 < pending.sum() < pending.size)
            # The run goes on meanwhile: what was there is there, and more may be.
            late = np.isnan(data["volume_rest"].values)
            self.assertFalse((late & ~pending).any())
            np.testing.assert_array_equal(data["volume_rest"].values[~late],
                                          (12000.25 + np.arange(3 * CASES).reshape(CASES, 3))[~late])
        part = sorted(self.parts.glob("chunk-*.h5"))[0]
        with xarray.open_dataset(part, engine="h5netcdf") as data:
            number = int(part.stem.split("-")[1])
            self.assertEqual(data["case"].values.tolist(), list(range(CHUNK * number, CHUNK * (number + 1))))
        self.assertEqual(run.end(), 0, run.err)
        with xarray.open_dataset(self.file, engine="h5netcdf") as data:
            np.testing.assert_array_equal(data["status"].values, np.arange(3 * CASES).reshape(CASES, 3) % 7)
            self.assertNotIn("incomplete", data.attrs)
            self.assertNotIn("pending", data["status"].attrs["flag_meanings"])

    def test_memory_does_not_grow_with_the_cases(self):
        def peak(cases):
            program = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, "
                       "stdout=subprocess.DEVNULL); print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)")
            out = subprocess.run([sys.executable, "-c", program, PROGRAM, f"{cases}.h5", str(cases), "2000"],
                                 cwd=self.folder, check=True, capture_output=True, text=True)
            return int(out.stdout) * 1024

        few, many = peak(4000), peak(400_000)
        # The results of 400000 cases take 200 MB; the windows onto their 200 chunks 20 MB.
        self.assertLess(many - few, 40e6)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
