# SPDX-License-Identifier: BSD-2-Clause
"""What the command line accepts and what it answers: exit codes, files of options/, help, sweeps, PETSc's options."""
import re

import h5py
import numpy as np
import xarray

from runs import PAPER, SCENES, SOLVERS, InFolder, main

CONTACT, SLACK, LIFTED, EXTRAPOLATED, PULLED_IN, NO_EQUILIBRIUM, DIVERGED = range(7)
# The paper's scene without its comparison, which takes most of the time.
BARE = ("-options_file", PAPER, "-comparison", "none")
# Ten times stiffer than the paper's elastomer: here its fixed point diverges.
STIFF = ("-bandage_ogden_mu", "211.93 kPa, 105.14 Pa")


class Files(InFolder):
    def test_every_scene_solves(self):
        self.assertGreaterEqual(len(SCENES), 3)
        for scene in SCENES:
            for ranks in (0, 2):
                with self.subTest(scene=scene.name, ranks=ranks):
                    run = self.run_gaiter("solve", "-options_file", scene, "-output", f"{scene.stem}.h5", ranks=ranks)
                    self.assertEqual(run.err, "")
                    with xarray.open_dataset(self.folder / f"{scene.stem}.h5", engine="h5netcdf") as data:
                        self.assertTrue((data["status"] < NO_EQUILIBRIUM).all())
                        self.assertTrue((data["pressure_rest"] > 100).all())
                        for name in data["segment"].values:
                            self.assertRegex(run.out, rf"(?m)^{name} ")

    def test_every_solver_gives_the_same_pressures(self):
        self.assertGreaterEqual(len(SOLVERS), 4)
        self.run_gaiter("solve", *BARE)
        with h5py.File(self.folder / "paper.h5") as file:
            pressures = file["pressure_actuated"][:]
        for solver in SOLVERS:
            # The paper's algorithm stops at 1e-4 of the radius, from which its pressures are a few 1e-4 off.
            tolerance = 1e-3 if "fixed_point" in solver.name else 1e-11
            with self.subTest(solver=solver.name):
                self.run_gaiter("solve", *BARE, "-options_file", solver, "-output", "other.h5")
                with h5py.File(self.folder / "other.h5") as file:
                    np.testing.assert_allclose(file["pressure_actuated"][:], pressures, rtol=tolerance)

    def test_the_solver_files_do_what_their_names_say(self):
        said = {
            "default": "status",
            "assembled_point_block_jacobi": "type: pbjacobi",
            "monitored": "1 SNES Function norm",
            "paper_fixed_point": "type: nrichardson",
        }
        for solver in SOLVERS:
            with self.subTest(solver=solver.name):
                run = self.run_gaiter("solve", *BARE, "-options_file", solver, "-slice_snes_view")
                self.assertIn(said[solver.stem], run.out)

    def test_the_default_spelt_out_is_the_default(self):
        self.run_gaiter("solve", *BARE, "-output", "plain.h5")
        solver, = (path for path in SOLVERS if path.stem == "default")
        self.run_gaiter("solve", *BARE, "-options_file", solver, "-output", "spelt.h5")
        with h5py.File(self.folder / "plain.h5") as plain, h5py.File(self.folder / "spelt.h5") as spelt:
            for name in ("pressure_rest", "pressure_actuated", "iterations", "error_estimate"):
                np.testing.assert_array_equal(plain[name][:], spelt[name][:], err_msg=name)


class Answers(InFolder):
    def test_success_is_0_and_writes_the_archive_alone(self):
        run = self.run_gaiter("solve", "-options_file", PAPER)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["paper.h5"])
        self.assertIn("wrote paper.h5", run.out)
        self.assertIn("Printed results of the paper", run.out)

    def test_statuses_with_numbers_are_a_success(self):
        designs = {
            SLACK: ("-bandage_stretch", "0.8"),
            LIFTED: ("-bandage_stretch", "1.2", "-voltage", "20 kV"),
            EXTRAPOLATED: ("-leg_compliance_data_limit", "100 Pa"),
            # Softens beyond its limit point: under this voltage it expands without end.
            PULLED_IN: ("-bandage_stretch", "1.2", "-bandage_ogden_mu", "40 kPa", "-bandage_ogden_alpha", "1.2",
                        "-voltage", "40 kV"),
        }
        for status, words in designs.items():
            with self.subTest(words=words):
                run = self.run_gaiter("solve", *BARE, *words)
                with h5py.File(self.folder / "paper.h5") as file:
                    word = file["status"].attrs["flag_meanings"].split()[status]
                    self.assertEqual(file["status"][:].tolist(), [[status] * 6], run)
                    self.assertTrue(np.isfinite(file["pressure_actuated"][:]).all())
                self.assertRegex(run.out, rf"(?m) {word}$")
                self.assertRegex(run.out, rf"(?m)^{word}: ")  # and what that means

    def test_a_design_that_fails_is_3_and_archived(self):
        for ranks in (0, 2):
            run = self.run_gaiter("sweep", *BARE, *STIFF, "-slice_solver", "fixed_point", "-sweep_bandage_stretch",
                                  "1.1,2.2", ranks=ranks, code=3)
            with h5py.File(self.folder / "paper.h5") as file:
                status = file["status"][:]
                self.assertEqual(status[1, 0], DIVERGED)
                self.assertLess(status[0, 0], NO_EQUILIBRIUM)
                failed = status == DIVERGED
                for name in ("pressure_rest", "pressure_actuated", "volume_change", "radius_actuated"):
                    self.assertTrue(np.isnan(file[name][:][failed]).all(), name)
                    self.assertTrue(np.isfinite(file[name][:][~failed]).all(), name)
            self.assertIn("diverged: the solver did not converge", run.out)
            self.assertIn(f"{failed.sum()} of 12 segments have no trustworthy result; list ", run.out)
            self.assertIn("h5py.File('paper.h5')", run.out)

    def test_newton_solves_what_the_fixed_point_cannot(self):
        self.run_gaiter("solve", *BARE, *STIFF)

    def test_more_ranks_than_segments(self):
        scene, = (path for path in SCENES if path.stem == "stocking_single_segment")
        self.run_gaiter("solve", "-options_file", scene, ranks=3)
        self.assertTrue((self.folder / "stocking.h5").exists())


class Options(InFolder):
    def resolved(self, *words, ranks=0):
        return self.run_gaiter(*words, "-dry_run", ranks=ranks).out

    def test_dry_run_writes_nothing_and_reads_back_the_same(self):
        commands = [("solve", "-options_file", scene) for scene in SCENES]
        commands += [("solve", "-options_file", PAPER, "-options_file", solver) for solver in SOLVERS]
        commands.append(("sweep", "-options_file", PAPER, "-sweep_voltage", "0 kV, 5 kV", "-sweep_bandage_r3_stretch",
                         "1.4,1.6,2", "-slice_snes_rtol", "1e-9"))
        for words in commands:
            with self.subTest(words=words):
                text = self.resolved(*words)
                self.assertEqual(list(self.folder.glob("*.h5")), [])
                self.assertEqual(text, self.resolved(words[0], "-options_file", self.write("again.yaml", text)))

    def test_dry_run_on_two_ranks_prints_once(self):
        self.assertEqual(self.resolved("solve", *BARE), self.resolved("solve", *BARE, ranks=2))

    def test_the_archive_holds_the_resolved_options(self):
        words = ("solve", *BARE, "-bandage_stretch", "1.7", "-slice_snes_rtol", "1e-9")
        self.run_gaiter(*words)
        with h5py.File(self.folder / "paper.h5") as file:
            options, command = file.attrs["options"], file.attrs["command"]
        self.assertIn("bandage_stretch: 1.7\n", options)
        self.assertIn("slice_snes_rtol: 1e-9\n", options)
        self.assertTrue(self.resolved(*words).startswith(options))
        self.assertTrue(command.startswith("gaiter solve -options_file "))

    def test_the_command_line_wins_wherever_it_stands(self):
        first = self.resolved("solve", "-bandage_thickness", "2 mm", "-options_file", PAPER)
        last = self.resolved("solve", "-options_file", PAPER, "-bandage_thickness", "2 mm")
        self.assertIn("bandage_thickness: 0.002 m\n", first)
        self.assertEqual(first, last)

    def test_a_later_file_wins_over_an_earlier_one(self):
        later = self.write("later.yaml", "bandage:\n  thickness: 0.5 mm\n")
        self.assertIn("bandage_thickness: 0.0005 m\n",
                      self.resolved("solve", "-options_file", PAPER, "-options_file", later))

    def test_units_are_converted(self):
        text = self.resolved("solve", "-options_file", PAPER, "-leg_compliance_data_limit", "50 mmHg", "-voltage",
                             "11300", "-leg_r6_height", "3.5 cm", "-bandage_breakdown_field", "80 kV/mm")
        values = dict(line.split(": ") for line in text.splitlines() if ": " in line)
        self.assertAlmostEqual(float(values["leg_compliance_data_limit"].removesuffix(" Pa")), 6666.119, places=2)
        self.assertEqual(values["voltage"], "11300 V")
        self.assertEqual(values["leg_r6_height"], "0.035 m")
        self.assertEqual(float(values["bandage_breakdown_field"].removesuffix(" V m-1")), 8e7)

    def test_help_lists_every_option_once(self):
        text, table = self.run_gaiter("-help").out, self.run_gaiter("-help", "markdown").out
        names = re.findall(r"(?m)^\| `-([^`]+)` \|", table)
        self.assertEqual(names, re.findall(r"(?m)^  -(\S+)", text))
        self.assertEqual(names, sorted(names))
        self.assertGreater(len(names), 25)
        # Whatever the program itself writes out has a place in the list.
        for line in self.resolved("solve", "-options_file", PAPER).splitlines():
            name = re.sub(r"_r[1-6]_", "_<s>_", line.split(":")[0])
            if not line.startswith("#"):
                self.assertIn(name, names)

    def test_help_needs_no_scene(self):
        for words in (["--help"], ["-h"], ["solve", "-help"]):
            self.assertEqual(self.run_gaiter(*words).out, self.run_gaiter("-help").out)


class Sweeps(InFolder):
    def test_the_grid_has_every_design_in_order(self):
        run = self.run_gaiter("sweep", *BARE, "-sweep_bandage_stretch", "1.4,1.8,2.2", "-sweep_voltage", "0 kV,11.3 kV")
        self.assertIn("6 designs in ", run.out)
        with xarray.open_dataset(self.folder / "paper.h5", engine="h5netcdf") as data:
            self.assertEqual(dict(data.sizes), {"case": 6, "segment": 6})
            np.testing.assert_array_equal(data["bandage_stretch"], np.repeat([1.4, 1.8, 2.2], 2))
            np.testing.assert_array_equal(data["voltage"], np.tile([0, 11300], 3))
            self.assertEqual(data["voltage"].attrs["units"], "V")
            passive, active = data.sel(case=data["voltage"] == 0), data.sel(case=data["voltage"] > 0)
            np.testing.assert_array_equal(passive["pressure_actuated"], passive["pressure_rest"])
            np.testing.assert_array_equal(active["pressure_rest"], passive["pressure_rest"])
            self.assertTrue((active["actuation_drop"] > 0).all())

    def test_each_case_is_what_solve_gives(self):
        self.run_gaiter("sweep", *BARE, "-sweep_bandage_stretch", "1.4,1.8", "-output", "sweep.h5")
        for case, stretch in enumerate(("1.4", "1.8")):
            self.run_gaiter("solve", *BARE, "-bandage_stretch", stretch, "-output", "solve.h5")
            with h5py.File(self.folder / "sweep.h5") as sweep, h5py.File(self.folder / "solve.h5") as solve:
                # Designs of a sweep share the number of wall points, so the last bits differ.
                for name in ("pressure_rest", "pressure_actuated", "volume_change", "electric_field_max"):
                    np.testing.assert_allclose(sweep[name][case], solve[name][0], rtol=1e-11, err_msg=name)

    def test_a_value_of_its_own_stays(self):
        self.run_gaiter("sweep", *BARE, "-bandage_r6_stretch", "1.5", "-sweep_bandage_stretch", "1.4,2")
        with h5py.File(self.folder / "paper.h5") as file:
            pressure = file["pressure_rest"][:]
        self.assertEqual(pressure[0, 0], pressure[1, 0])
        self.assertTrue((pressure[0, 1:] < pressure[1, 1:]).all())


PLANNED = ("planned_discretisation_error", "planned_model_error", "planned_cost")


class Plan(InFolder):
    def test_the_archive_has_what_was_planned(self):
        auto = (*BARE, "-fidelity", "auto", "-auto_up_to", "slice", "-accuracy", "1e-3")
        shown = self.run_gaiter("solve", *auto, "-plan").out.splitlines()[2:]
        solved = self.run_gaiter("solve", *auto).out
        self.run_gaiter("sweep", *auto, "-sweep_bandage_stretch", "1.4,2.2", "-output", "sweep.h5")
        with h5py.File(self.folder / "paper.h5") as file, h5py.File(self.folder / "sweep.h5") as sweep:
            words = file["fidelity"].attrs["flag_meanings"].split()
            for i, line in enumerate(shown):
                _, model, *_, discretisation, beyond, cost = line.split()
                self.assertEqual(words[file["fidelity"][0, i]], model)
                for name, text, unit in zip(PLANNED, (discretisation, beyond, cost), (1, 1, 1e-6)):
                    # Printed to two or three digits, stored to eight binary ones and no less.
                    value = file[name][0, i]
                    np.testing.assert_allclose(value, float(text) * unit, rtol=0.06, err_msg=name)
                    self.assertEqual(value, sweep[name][1, i], name)
                    self.assertEqual(np.frexp(value)[0] * 512 % 1, 0, name)
                self.assertLess(file["planned_discretisation_error"][0, i] + file["planned_model_error"][0, i], 1e-3)
            self.assertIn(f"{file['planned_model_error'][0, 0]:.1e}", solved.split("taken")[1])
            self.assertTrue(set(PLANNED) <= set(sweep))

    def test_nothing_is_planned_otherwise(self):
        self.run_gaiter("solve", *BARE)
        self.run_gaiter("sweep", *BARE, "-sweep_bandage_stretch", "1.4,2.2", "-output", "sweep.h5")
        for name in ("paper.h5", "sweep.h5"):
            with h5py.File(self.folder / name) as file:
                self.assertFalse(set(PLANNED) & set(file))
                self.assertIn("unknowns", file)


    def test_segments_without_wanted_output_are_left_out(self):
        auto = (*BARE, "-fidelity", "auto", "-auto_up_to", "slice")
        some = (*auto, "-outputs", "r5.pressure_rest,r2.actuation_drop")
        plan = self.run_gaiter("solve", *some, "-plan").out.splitlines()[2:]
        self.assertEqual([line.split()[0] for line in plan], ["r5", "r2"])
        run = self.run_gaiter("solve", *some, "-output", "some.h5")
        self.assertIn("not_wanted: no output of the segment is among -outputs", run.out)
        run = self.run_gaiter("sweep", *some, "-sweep_bandage_stretch", "2.2,2", "-output", "sweep.h5")
        self.assertNotIn("no trustworthy result", run.out)
        self.run_gaiter("solve", *auto, "-outputs", "actuation_drop", "-output", "all.h5")
        with h5py.File(self.folder / "some.h5") as some, h5py.File(self.folder / "sweep.h5") as sweep, \
                h5py.File(self.folder / "all.h5") as everything:
            words = some["status"].attrs["flag_meanings"].split()
            self.assertEqual([words[i] == "not_wanted" for i in some["status"][0]],
                             [True, False, True, True, False, True])
            for name in ("pressure_rest", "actuation_drop", "error_estimate", "planned_cost", "volume_initial"):
                self.assertTrue(np.isnan(some[name][0, [0, 2, 3, 5]]).all(), name)
                np.testing.assert_array_equal(some[name][0], sweep[name][0], name)
            self.assertTrue(np.isfinite(some["pressure_rest"][0, [1, 4]]).all())
            self.assertTrue(np.isnan(some["actuation_drop"][0, 1]))
            self.assertEqual(some["actuation_drop"][0, 4], everything["actuation_drop"][0, 4])


class Petsc(InFolder):
    def test_its_options_are_accepted_and_work(self):
        said = {
            "-slice_snes_monitor": "1 SNES Function norm",
            "-slice_snes_converged_reason": "Nonlinear slice_ solve converged",
            "-slice_snes_view": "SNES Object: (slice_)",
            "-slice_ksp_view": "KSP Object: (slice_)",
            "-slice_snes_linesearch_type bt -slice_snes_view": "type: bt",
            "-slice_mat_type baij -slice_snes_test_jacobian": "Testing hand-coded Jacobian",
            "-slice_mat_type baij -slice_ksp_type gmres -slice_ksp_monitor": "KSP Residual norm",
            "-fidelity sliding -sliding_snes_rtol 1e-9 -sliding_snes_converged_reason":
                "Nonlinear sliding_ solve converged",
            "-log_view": "SNESSolve",
            "-options_left": "There are no unused options",
            "-options_view": "-slice_snes_rtol 1e-9",
            "-objects_dump": "wrote paper.h5",
            "-malloc_debug -malloc_dump": "wrote paper.h5",
        }
        for words, answer in said.items():
            with self.subTest(words=words):
                run = self.run_gaiter("solve", *BARE, "-slice_snes_rtol", "1e-9", *words.split())
                self.assertIn(answer, run.out + run.err)
        run = self.run_gaiter("solve", *BARE, "-log_view", "-options_left", "-slice_snes_monitor", ranks=2)
        self.assertIn("SNESSolve", run.out)
        self.assertIn("There are no unused options", run.out)

    def test_views_go_to_files(self):
        self.run_gaiter("solve", *BARE, "-log_view", ":log.txt", "-slice_snes_view", ":snes.txt")
        self.assertIn("SNESSolve", (self.folder / "log.txt").read_text())
        self.assertIn("SNES Object", (self.folder / "snes.txt").read_text())

    def test_its_tolerances_decide(self):
        run = self.run_gaiter("solve", *BARE, "-slice_snes_max_it", "0", code=3)
        self.assertIn("diverged", run.out)

    def test_the_hand_coded_jacobian_is_right(self):
        run = self.run_gaiter("solve", *BARE, "-slice_mat_type", "baij", "-slice_snes_test_jacobian")
        ratios = re.findall(r"\|\|J - Jfd\|\|_F/\|\|J\|\|_F = ([0-9.e+-]+)", run.out)
        self.assertGreaterEqual(len(ratios), 2)
        for ratio in ratios:
            self.assertLess(float(ratio), 1e-6)


if __name__ == "__main__":
    main()
