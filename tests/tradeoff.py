# SPDX-License-Identifier: BSD-2-Clause
"""gaiter tradeoff: every rung of a scene against the finest, in a table, an archive and a page."""
import re

import h5py
import numpy as np

from runs import SOURCE, InFolder, contents, main

SCENE = ("-options_file", str(SOURCE / "options" / "scenes" / "graded_four_modules.yaml"))
STOCKING = ("-options_file", str(SOURCE / "options" / "scenes" / "stocking_single_segment.yaml"))
WANTED = ("pressure_rest", "pressure_actuated")


class Tradeoff(InFolder):
    def rungs(self, *words, ranks=0):
        run = self.run_gaiter("tradeoff", *words, "-output", "rungs.h5", ranks=ranks)
        with h5py.File(self.folder / "rungs.h5") as file:
            names = file["rung"].attrs["flag_meanings"].split()
            self.assertEqual(file["rung"][:].tolist(), list(range(len(names))))
            found = {name: data[()] for name, data in file.items() if name != "segment"}
        return dict(zip(names, range(len(names)))), found, run.out

    def check_errors(self, names, found):
        worst = np.zeros(len(names))
        for name in WANTED:
            exact = found[name][-1]
            worst = np.maximum(worst, np.abs(found[name] / exact - 1).max(axis=1))
        np.testing.assert_allclose(found["true_error"], worst, rtol=1e-12, atol=1e-15)
        self.assertEqual(found["true_error"][-1], 0)
        self.assertTrue((found["segment_time"] > 0).all())
        for name, case in names.items():
            if name.startswith("auto_"):
                self.assertLessEqual(found["true_error"][case], float(name[5:]), name)

    def test_up_to_slices(self):
        names, found, out = self.rungs(*SCENE, "-auto_up_to", "slice")
        self.check_errors(names, found)
        error = {name: found["true_error"][case] for name, case in names.items()}
        self.assertGreater(error["rigid"], 10 * error["first_order"])
        self.assertGreater(error["first_order"], 100 * error["slices_3"])
        self.assertGreater(error["midpoints_4"], 10 * error["midpoints_16"])
        self.assertGreater(error["slices_6_wall_1"], 10 * error["slices_6_wall_2"])
        self.assertGreater(error["slices_6_fixed_point"], 100 * error["slices_6"])
        self.check_less_solved(names, found, error)
        self.assertEqual((found["unknowns"][names["rigid"]] + found["iterations"][names["rigid"]]).max(), 0)
        self.assertEqual(found["unknowns"][names["slices_6"]].tolist(), 4 * [12])
        # What no cheaper rung surpasses is marked.
        for line in re.findall(r"(?m)^(?:[a-z]+\S*) .*$", out)[1:]:
            name = line.split()[0]
            if name not in names:
                continue
            case = names[name]
            cheaper = found["segment_time"] < found["segment_time"][case]
            self.assertEqual("*" in line, not (found["true_error"][cheaper] <= found["true_error"][case]).any(), line)

    def check_less_solved(self, names, found, error):
        """What single precision, an early end and the fixed point lose is known beforehand."""
        self.assertGreater(error["slices_6_single"], 10 * error["slices_6"])
        self.assertLess(error["slices_6_single"], 1e-5)
        self.assertGreater(error["slices_6_newton_1e-01"], 100 * error["slices_6"])
        self.assertLessEqual(error["slices_6_newton_1e-06"], error["slices_6_newton_1e-01"])
        steps = {name: found["iterations"][case].max() for name, case in names.items()}
        self.assertLess(steps["slices_6_newton_1e-01"], steps["slices_6"])
        for name in ("slices_2_single", "slices_6_single", "slices_6_newton_1e-01", "slices_6_newton_1e-03",
                     "slices_6_newton_1e-06", "slices_6_fixed_point"):
            self.assertLessEqual(error[name], found["discretisation_error"][names[name]].max(), name)
            self.assertEqual(found["fidelity"][names[name]].tolist(), found["fidelity"][names["slices_6"]].tolist())

    def test_a_tolerance_that_is_given_holds_for_all(self):
        names, _, _ = self.rungs(*SCENE, "-auto_up_to", "slice", "-slice_snes_rtol", "1e-1")
        self.assertFalse([name for name in names if "newton" in name])

    def test_what_auto_took_is_marked(self):
        names, found, out = self.rungs(*SCENE, "-auto_up_to", "slice", "-accuracy", "0.025", "-outputs",
                                       "pressure_rest,pressure_actuated")
        self.assertIn("auto_0.025", names)
        words = dict(enumerate(("rigid", "slice", "sliding", "axisym", "first_order")))
        lines = {line.split()[0]: line for line in out.splitlines() if line.strip()}
        marked = 0
        for name, case in names.items():
            if not name.startswith("auto_"):
                continue
            for model, slices, points in zip(*(found[what][case] for what in
                                               ("fidelity", "slices_used", "wall_points_used"))):
                self.assertIn(f"{words[model]} {slices} x {points}", lines[name])
                rung = f"slices_{slices}" if words[model] == "slice" else words[model]
                if rung in lines:
                    self.assertIn(name, lines[rung].split("<")[1])
                    marked += 1
        self.assertGreater(marked, 5)
        self.run_gaiter("report", "-archive", "rungs.h5")
        text = (self.folder / "rungs.html").read_text(encoding="utf-8")
        self.assertIn("<th>taken by auto</th>", text)
        self.assertRegex(text, r"<td>auto_1e-01</td>.*?<td>(rigid|first_order|slice) [0-9]+ x [0-9]+")

    def test_page(self):
        self.rungs(*SCENE, "-auto_up_to", "slice")
        self.run_gaiter("report", "-archive", "rungs.h5")
        text = (self.folder / "rungs.html").read_text(encoding="utf-8")
        self.assertEqual(text.count("<img"), 1)
        self.assertIn("<td>midpoints_64</td>", text)

    def test_up_to_finite_elements(self):
        names, found, _ = self.rungs(*STOCKING, "-sliding_count", "6", ranks=2)
        self.check_errors(names, found)
        case = names["axisym_0"]
        self.assertLess(found["true_error"][case], 1e-4)
        self.assertGreater(found["unknowns"][case, 0], 500)
        self.assertNotIn("axisym_radial_1", names)  # there is no voltage

    def test_a_rigid_leg(self):
        names, found, _ = self.rungs(*STOCKING, "-leg_model", "rigid")
        self.check_errors(names, found)
        self.assertNotIn("first_order", names)
        self.assertNotIn("axisym_0", names)

    def test_same_numbers_on_two_ranks(self):
        self.rungs(*SCENE, "-auto_up_to", "slice")
        one = contents(self.folder / "rungs.h5")
        self.rungs(*SCENE, "-auto_up_to", "slice", ranks=2)
        two = contents(self.folder / "rungs.h5")
        for part in (one, two):
            del part["segment_time"]
        self.assertEqual(one, two)


if __name__ == "__main__":
    main()
