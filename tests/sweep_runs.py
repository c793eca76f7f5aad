# SPDX-License-Identifier: BSD-2-Clause
"""Sweeps as users run them: designs that are drawn, on any number of ranks, told about, stopped by signals and taken up
again; designs that cannot be solved; every file of options/sweeps."""
import os
import pathlib
import signal
import subprocess
import time

import h5py
import numpy as np

from runs import GAITER, MPIEXEC, PAPER, SOURCE, InFolder, contents, main, own_lines

SWEEPS = sorted((SOURCE / "options" / "sweeps").glob("*.yaml"))
BARE = ["sweep", "-options_file", PAPER, "-comparison", "none"]
DRAWN = ["-sweep_sampler", "sobol", "-sweep_bandage_thickness", "normal(1 mm, 0.5 mm)", "-sweep_voltage",
         "uniform(0 kV, 13 kV)", "-sweep_leg_radius_scale", "normal(1, 0.07)", "-sweep_leg_r6_compliance_a",
         "normal(0.0134, 0.001)", "-sweep_slice_count", "uniform(4, 9)"]
LONG = ["-sweep_sampler", "random", "-sweep_seed", "3", "-sweep_samples", "150000", "-sweep_bandage_stretch",
        "uniform(1.2, 2.2)", "-sweep_bandage_thickness", "normal(1 mm, 0.05 mm)"]


class Designs(InFolder):
    def same_on(self, ranks, words, code):
        for count in ranks:
            (self.folder / f"on{count}.h5").unlink(missing_ok=True)  # of another study
            self.run_gaiter(*words, "-output", f"on{count}.h5", ranks=count, code=code)
        one = contents(self.folder / "on1.h5")
        for count in ranks[1:]:
            other = contents(self.folder / f"on{count}.h5")
            self.assertEqual(one.keys(), other.keys())
            self.assertEqual([key for key in one if one[key] != other[key]], [], f"{count} ranks")

    def test_drawn_designs_are_the_same_on_1_2_3_ranks(self):
        self.same_on((1, 2, 3), [*BARE, *DRAWN, "-sweep_samples", "2000"], code=3)
        with h5py.File(self.folder / "on1.h5") as file:
            thickness, status, pressure = file["bandage_thickness"][:], file["status"][:], file["pressure_rest"][:]
            self.assertEqual(file["leg_r6_compliance_a"].attrs["units"], "1")
            self.assertEqual(file["bandage_thickness"].attrs["units"], "m")
        # The status of a thickness below 0 is `invalid`, and only of such.
        self.assertTrue(((status == 7).all(axis=1) == (thickness < 1e-10)).all())
        self.assertGreater((status == 7).sum(), 0)
        self.assertTrue((np.isnan(pressure) == (status >= 5)).all())

    def test_the_other_fidelities_are_the_same_on_1_2_ranks(self):
        for words in (["-fidelity", "sliding", "-sweep_bandage_stretch", "linspace(1.4,2,20)"],
                      ["-fidelity", "axisym", "-axisym_refine", "0", "-sweep_bandage_stretch", "1.3,1.4,1.5",
                       "-voltage", "0 V"]):
            with self.subTest(words[1]):
                self.same_on((1, 2), [*BARE, *words], code=0)

    def test_ranks_that_share_a_mesh_in_groups_of_different_sizes(self):
        words = [*BARE, "-fidelity", "axisym", "-axisym_refine", "0", "-voltage", "0 V", "-axisym_ranks_per_case", "2",
                 "-sweep_bandage_stretch", "1.3,1.4,1.5"]
        for ranks in (1, 3):
            self.run_gaiter(*words, "-output", f"on{ranks}.h5", ranks=ranks)
        with h5py.File(self.folder / "on1.h5") as one, h5py.File(self.folder / "on3.h5") as three:
            for name in ("pressure_rest", "volume_rest", "status"):  # MUMPS adds up in another order
                np.testing.assert_allclose(three[name][:], one[name][:], rtol=1e-10, err_msg=name)

    def test_a_case_of_a_sweep_is_that_scene_solved(self):
        self.run_gaiter(*BARE, *DRAWN, "-sweep_samples", "40", "-output", "sweep.h5")
        with h5py.File(self.folder / "sweep.h5") as sweep:
            for case in (0, 7, 39):
                values = {name: repr(float(sweep[name][case])) for name in
                          ("bandage_thickness", "voltage", "leg_radius_scale", "leg_r6_compliance_a")}
                compliance = f"{values.pop('leg_r6_compliance_a')}, 7.898e-5, -0.016, -0.001137"
                words = [word for name, text in values.items() for word in (f"-{name}", text)]
                self.run_gaiter("solve", *BARE[1:], *words, "-leg_r6_compliance", compliance, "-slice_count",
                                str(int(sweep["slice_count"][case])), "-output", "solve.h5")
                with h5py.File(self.folder / "solve.h5") as solve:
                    for name in ("pressure_rest", "pressure_actuated", "volume_change", "status"):
                        np.testing.assert_allclose(sweep[name][case], solve[name][0], rtol=1e-12, err_msg=name)

    def test_failed_designs_are_counted_explained_and_listed(self):
        run = self.run_gaiter(*BARE, *DRAWN, "-sweep_samples", "500", "-output", "out.h5", code=3)
        self.assertRegex(run.out, r"segments invalid: the values of the design make no possible scene")
        self.assertRegex(run.out, r"invalid, for example case \d+: -bandage_thickness '-.* m': must be at least")
        command = next(line for line in run.out.splitlines() if line.startswith("  /usr/bin/python3 -c"))
        listed = subprocess.run(command, shell=True, cwd=self.folder, capture_output=True, text=True,
                                check=True).stdout.splitlines()
        with h5py.File(self.folder / "out.h5") as file:
            failed = np.argwhere(file["status"][:] >= 5)
        self.assertEqual([line.split()[:2] for line in listed], [[str(c), str(s)] for c, s in failed])

    def test_only_the_wanted_results_are_kept(self):
        self.run_gaiter(*BARE, "-sweep_voltage", "0,5 kV", "-output_variables", "volume_change, pressure_rest",
                        "-output", "few.h5")
        with h5py.File(self.folder / "few.h5") as file:
            self.assertIn("volume_change", file)
            self.assertIn("status", file)
            self.assertNotIn("pressure_actuated", file)
        run = self.run_gaiter(*BARE, "-sweep_voltage", "0,5 kV", "-output_variables", "pressure_rst", code=2)
        self.assertIn("did you mean 'pressure_rest'?", run.err)

    def test_every_file_of_options_sweeps_runs(self):
        self.assertGreaterEqual(len(SWEEPS), 3)
        for path in SWEEPS:
            with self.subTest(path.stem):
                self.run_gaiter("sweep", "-options_file", PAPER, "-options_file", path, ranks=2)
                self.assertTrue((self.folder / f"{path.stem}.h5").exists())


class Told(InFolder):
    def test_progress_on_one_line_or_in_a_log_or_not_at_all(self):
        line = self.run_gaiter(*BARE, *LONG, "-progress", "line", "-output", "line.h5")
        # Read as text, a carriage return is a line's end.
        self.assertRegex(line.err, r"\n\d+ of 150000 designs, \S+/s, \d+ s left")
        self.assertRegex(line.out, r"150000 designs in .* designs/s a rank, .* equilibria/s a rank")
        self.assertRegex(line.out, r"busy .* imbalance .* archive .* % of the time")
        short = [*BARE, "-sweep_bandage_stretch", "1.4,1.6"]
        self.assertEqual(self.run_gaiter(*short, "-output", "auto.h5").err, "")
        off = self.run_gaiter(*short, "-progress", "off", "-output", "off.h5")
        self.assertEqual(off.err, "")
        self.assertNotIn("designs/s", off.out)


class Stopped(InFolder):
    """A run that a signal has ended is completed by the same command, to the archive of an undisturbed run."""

    def start(self, *words, ranks=0):
        launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks else []
        return subprocess.Popen([*launch, GAITER, *map(str, words)], cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)

    def wait_for_chunks(self, name):
        parts = self.folder / f"{name}.parts"
        for _ in range(600):
            if parts.is_dir() and len(list(parts.iterdir())) > 3:
                return
            time.sleep(0.05)
        self.fail("no chunk was stored")

    def test_by_either_signal(self):
        self.run_gaiter(*BARE, *LONG, "-output", "whole.h5")
        for number in (signal.SIGTERM, signal.SIGINT):
            with self.subTest(number.name):
                name = f"{number.name}.h5"
                running = self.start(*BARE, *LONG, "-output", name)
                self.wait_for_chunks(name)
                running.send_signal(number)
                out, err = running.communicate(timeout=60)
                self.assertEqual(running.returncode, 128 + number, out + err)
                self.assertRegex(out, rf"stopped by signal {int(number)}; \d+ of 150000 designs are stored")
                again = self.run_gaiter(*BARE, *LONG, "-output", name, ranks=2)
                self.assertRegex(again.out, r"\d+ designs were in SIG\w+.h5 from earlier runs")
                self.assertIn(f"wrote {name}", again.out)
                third = self.run_gaiter(*BARE, *LONG, "-output", name)
                self.assertIn(f"{name} is complete already; nothing was done", third.out)
                self.assertNotIn("wrote", third.out)
                whole, taken_up = contents(self.folder / "whole.h5"), contents(self.folder / name)
                self.assertEqual([key for key in whole if whole[key] != taken_up[key]], [])

    def test_one_rank_stops_all(self):
        running = self.start(*BARE, *LONG, "-output", "two.h5", ranks=2)
        self.wait_for_chunks("two.h5")
        ranks = [int(path.name) for path in pathlib.Path("/proc").iterdir() if path.name.isdigit()
                 and self.is_child(path, running.pid)]
        self.assertEqual(len(ranks), 2)
        os.kill(max(ranks), signal.SIGTERM)
        out, err = running.communicate(timeout=60)
        self.assertEqual(running.returncode, 143, out + own_lines(err))
        self.assertIn("stopped by signal 15", out)

    @staticmethod
    def is_child(path, parent):
        try:
            return int((path / "stat").read_text().rsplit(")", 1)[1].split()[1]) == parent
        except OSError:
            return False


if __name__ == "__main__":
    main()
