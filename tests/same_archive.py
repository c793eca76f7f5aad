# SPDX-License-Identifier: BSD-2-Clause
"""The archive of a study is the same, bit for bit, on 1, 2 and 3 ranks, apart from what belongs to the run: when, how
long, on how many ranks."""
import h5py

from runs import PAPER, SCENES, InFolder, contents, main

STUDIES = {
    "paper's sweep": ["sweep", "-options_file", PAPER, "-comparison", "none", "-sweep_bandage_stretch",
                      "1.4,1.6,1.8,2.0,2.2", "-sweep_voltage", "0 kV,11.3 kV"],
    # Some designs lift off, some are slack, some are beyond the data.
    "every status": ["sweep", "-options_file", PAPER, "-comparison", "none", "-sweep_bandage_stretch",
                     "0.9,1.05,1.2,2.6", "-sweep_voltage", "0 kV,12 kV,25 kV"],
    "fixed point": ["sweep", "-options_file", PAPER, "-comparison", "none", "-slice_solver", "fixed_point",
                    "-sweep_bandage_stretch", "1.4,2.2"],
    "auto": ["sweep", "-options_file", PAPER, "-comparison", "none", "-fidelity", "auto", "-auto_up_to", "slice",
             "-accuracy", "1e-4", "-sweep_bandage_stretch", "1.1,1.4,2.2", "-sweep_voltage", "0 kV,11.3 kV"],
    "some segments": ["solve", "-options_file", PAPER, "-comparison", "none", "-fidelity", "auto", "-auto_up_to", "slice",
                      "-outputs", "r5.pressure_rest,r2.actuation_drop,r1.volume_change"],
    "single precision": ["sweep", "-options_file", PAPER, "-comparison", "none", "-slice_precision", "single",
                         "-sweep_bandage_stretch", "1.05,1.4,2.2", "-sweep_voltage", "0 kV,11.3 kV"],
    "sliding": ["sweep", "-options_file", PAPER, "-comparison", "none", "-fidelity", "sliding",
                "-sweep_bandage_stretch", "1.4,2.2"],
    # Legs that are solved as a whole stay on one rank.
    "legs": ["sweep", "-options_file", PAPER, "-comparison", "none", "-fidelity", "axisym", "-axisym_scope", "leg",
             "-axisym_refine", "0", "-voltage", "0", "-leg_compliance_variant", "anchored",
             "-sweep_bandage_stretch", "1.3,1.4"],
    # Thick and thin walls: the number of wall points must not depend on who shares a rank.
    "walls": ["sweep", "-options_file", PAPER, "-comparison", "none", "-sweep_bandage_thickness",
              "0.01 mm,1 mm,5 mm,9 mm"],
}
STUDIES.update({scene.stem: ["solve", "-options_file", scene] for scene in SCENES})


class SameArchive(InFolder):
    def test_on_1_2_3_ranks(self):
        for name, words in STUDIES.items():
            for ranks in (1, 2, 3):
                (self.folder / f"on{ranks}.h5").unlink(missing_ok=True)  # a sweep does not write over another one
                self.run_gaiter(*words, "-output", f"on{ranks}.h5", ranks=ranks)
            with h5py.File(self.folder / "on3.h5") as file:
                self.assertEqual(file.attrs["ranks"], 3)
            one = contents(self.folder / "on1.h5")
            for name_in_file in ("pressure_rest", "status", "pressure_rest/units", "/options", "segment"):
                self.assertIn(name_in_file, one)
            for ranks in (2, 3):
                with self.subTest(name, ranks=ranks):
                    other = contents(self.folder / f"on{ranks}.h5")
                    self.assertEqual(one.keys(), other.keys())
                    different = [key for key in one if one[key] != other[key]]
                    self.assertEqual(different, [])

    def test_a_difference_is_seen(self):
        for voltage in ("11.3", "11.301"):
            self.run_gaiter("solve", "-options_file", PAPER, "-comparison", "none", "-voltage", f"{voltage} kV",
                            "-output", f"{voltage}.h5")
        one, other = contents(self.folder / "11.3.h5"), contents(self.folder / "11.301.h5")
        self.assertEqual(one["pressure_rest"], other["pressure_rest"])
        self.assertNotEqual(one["pressure_actuated"], other["pressure_actuated"])
        self.assertNotEqual(one["/options"], other["/options"])


if __name__ == "__main__":
    main()
