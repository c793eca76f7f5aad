# SPDX-License-Identifier: BSD-2-Clause
"""Wrong input of every kind: exit code 2, one line that names option, value and what is allowed, nothing written, and
no traceback of PETSc; on 2 ranks one line too, not two."""
import os

from runs import PAPER, SOURCE, InFolder, main

SCENE = ("-options_file", PAPER)
STOCKING = str(SOURCE / "options" / "scenes" / "stocking_single_segment.yaml")

# name: command line, and what the line must say besides
CASES = {
    # commands
    "no command": ([], ["a command is missing", "solve, sweep, tradeoff or report"]),
    "unknown command": (["sovle", *SCENE], ["'sovle'", "did you mean 'solve'", "solve, sweep, tradeoff and report"]),
    "word too many": (["solve", *SCENE, "twice"], ["'twice'", "no option"]),
    "value with blanks unquoted": (["solve", *SCENE, "-voltage", "5", "kV"], ["'kV'", "quotes"]),
    # names
    "misspelt option": (["solve", *SCENE, "-bandage_stretsh", "2"], ["-bandage_stretsh", "-bandage_stretch?"]),
    "misspelt option of a segment": (["solve", *SCENE, "-bandage_r6_lenght", "2"],
                                     ["-bandage_r6_lenght", "-bandage_r6_length?"]),
    "misspelt in YAML": (["solve", *SCENE, "-options_file", "misspelt.yaml"],
                         ["-bandage_thicknes", "-bandage_thickness?"]),
    "nonsense": (["solve", *SCENE, "-qqqqqqqqqqqq", "2"], ["-qqqqqqqqqqqq", "-help"]),
    "unknown segment": (["solve", *SCENE, "-bandage_r9_stretch", "2"], ["'r9'", "r6, r5, r4, r3, r2, r1"]),
    "misspelt sweep": (["sweep", *SCENE, "-sweep_bandage_strech", "2,3"], ["-sweep_bandage_stretch?"]),
    # values
    "wrong unit": (["solve", *SCENE, "-bandage_thickness", "1 kg"], ["-bandage_thickness", "'1 kg'", "at most 1 m"]),
    "unknown unit": (["solve", *SCENE, "-voltage", "3 kWolt"], ["-voltage", "'kWolt'", "at least 0 V"]),
    "unit without number": (["solve", *SCENE, "-voltage", "kV"], ["-voltage", "'kV'", "not a number"]),
    "unit where none belongs": (["solve", *SCENE, "-bandage_stretch", "2 mm"], ["-bandage_stretch", "'2 mm'"]),
    "unit of one value missing": (["solve", *SCENE, "-leg_r6_radius", "30 mm,0.04"], ["-leg_r6_radius", "30 mm,0.04"]),
    "value missing": (["solve", *SCENE, "-bandage_thickness"], ["-bandage_thickness", "missing"]),
    "no number": (["solve", *SCENE, "-bandage_stretch", "much"], ["-bandage_stretch", "'much'"]),
    "not a number": (["solve", *SCENE, "-voltage", "nan"], ["-voltage", "'nan'", "not a number"]),
    "infinite": (["solve", *SCENE, "-voltage", "inf"], ["-voltage", "'inf'", "at most"]),
    "too large for a number": (["solve", *SCENE, "-voltage", "1e999 V"], ["-voltage", "1e999"]),
    "negative thickness": (["solve", *SCENE, "-bandage_thickness", "-1 mm"],
                           ["-bandage_thickness", "'-1 mm'", "at least 1e-10 m"]),
    "stretch 0": (["solve", *SCENE, "-bandage_stretch", "0"], ["-bandage_stretch", "'0'", "at least 0.001"]),
    "list too long": (["solve", *SCENE, "-leg_r6_radius", "1 mm,2 mm,3 mm"], ["-leg_r6_radius", "3 values", "2 values"]),
    "list too short": (["solve", *SCENE, "-leg_r6_compliance", "0.01,1e-5"], ["-leg_r6_compliance", "4 values"]),
    "unequal lists": (["solve", *SCENE, "-bandage_ogden_mu", "20 kPa"], ["-bandage_ogden_mu", "-bandage_ogden_alpha"]),
    "fraction of a layer": (["solve", *SCENE, "-bandage_layers", "1.5"], ["-bandage_layers", "whole number"]),
    "nothing was planned": (["solve", *SCENE, "-output_variables", "pressure_rest,planned_cost"],
                            ["-output_variables 'planned_cost'", "-fidelity 'auto'"]),
    "unknown output": (["solve", *SCENE, "-outputs", "r6.volume"], ["-outputs 'r6.volume'", "volume_change"]),
    "output of an unknown segment": (["solve", *SCENE, "-outputs", "pressure_rest,r9.pressure_rest"],
                                     ["-outputs", "unknown segment 'r9'", "r6, r5, r4, r3, r2, r1"]),
    "unknown word": (["solve", *SCENE, "-slice_rule", "simpson"], ["-slice_rule", "'simpson'", "gauss or midpoint"]),
    "not yes or no": (["solve", *SCENE, "-dry_run", "perhaps"], ["-dry_run", "'perhaps'", "true or false"]),
    # values that do not go together
    "wall thicker than the tube": (["solve", *SCENE, "-bandage_thickness", "30 mm"], ["-bandage_thickness", "r6"]),
    "length and stretch": (["solve", *SCENE, "-bandage_r6_stretch", "2", "-bandage_r6_length", "11 cm"],
                           ["-bandage_r6_stretch", "-bandage_r6_length", "not both"]),
    "softer than nothing": (["solve", *SCENE, "-bandage_ogden_mu", "-1 kPa,1 Pa"], ["-bandage_ogden_mu", "shear modulus"]),
    "rigid leg of finite elements": (["solve", *SCENE, "-fidelity", "axisym", "-leg_model", "rigid"],
                                     ["-leg_model 'rigid'", "-fidelity axisym"]),
    "leg with a step": (["solve", *SCENE, "-fidelity", "axisym", "-axisym_scope", "leg", "-leg_r4_radius", "49 mm,56 mm"],
                        ["-leg_r4_radius", "-axisym_scope leg", "1 %", "0.04995 m", "r5"]),
    "soft in bulk": (["solve", *SCENE, "-fidelity", "axisym", "-bandage_bulk_modulus", "1 kPa"],
                     ["-bandage_bulk_modulus", "greater than"]),
    "misspelt option of the finite elements": (
        ["solve", *SCENE, "-fidelity", "axisym", "-axisym_snes_stoll", "1"], ["-axisym_snes_stoll"]),
    "fields of slices": (["solve", *SCENE, "-axisym_view", "view.hdf"], ["-axisym_view 'view.hdf'", "-fidelity 'axisym'"]),
    "fields of a sweep": (["sweep", *SCENE, "-fidelity", "axisym", "-sweep_voltage", "1,2", "-axisym_view", "view.hdf"],
                          ["-axisym_view 'view.hdf'", "the command solve"]),
    "fields in an archive": (["solve", *SCENE, "-fidelity", "axisym", "-axisym_view", "view.h5"],
                             ["-axisym_view 'view.h5'", ".hdf or .vtkhdf"]),
    "fields in a missing folder": (["solve", *SCENE, "-fidelity", "axisym", "-axisym_view", "nowhere/view.hdf"],
                                   ["-axisym_view nowhere/view_r6_rest.hdf", "the folder nowhere does not exist"]),
    "fields over a folder": (["solve", *SCENE, "-fidelity", "axisym", "-axisym_view", "view.hdf"],
                             ["-axisym_view view_r1_rest.hdf", "this is a folder"]),
    "fields without a name": (["solve", *SCENE, "-fidelity", "axisym", "-axisym_view"], ["-axisym_view", "missing"]),
    "comparison with another leg": (["solve", "-options_file", STOCKING, "-comparison", "paper"],
                                    ["-comparison 'paper'", "six segments"]),
    "no scene": (["solve"], ["-leg_segments is missing"]),
    "half a scene": (["solve", "-options_file", "half.yaml"], ["-leg_shin_height is missing"]),
    # sweeps
    "nothing to sweep": (["sweep", *SCENE], ["nothing to sweep", "-sweep_bandage_stretch"]),
    "sweep in solve": (["solve", *SCENE, "-sweep_bandage_stretch", "1,2"], ["-sweep_bandage_stretch", "sweep"]),
    "not to be swept": (["sweep", *SCENE, "-sweep_slice_rule", "gauss,midpoint"], ["-sweep_slice_rule", "cannot be swept"]),
    "one bad value of a sweep": (["sweep", *SCENE, "-sweep_bandage_stretch", "1.4,0"],
                                 ["-sweep_bandage_stretch", "1.4,0", "value 2", "at least 0.001"]),
    "one bad design of a sweep": (["sweep", *SCENE, "-sweep_bandage_thickness", "1 mm,30 mm"], ["-bandage_thickness"]),
    # files
    "options file missing": (["solve", "-options_file", "nowhere.yaml"], ["-options_file", "nowhere.yaml"]),
    "options file not named": (["solve", "-options_file"], ["-options_file", "YAML"]),
    "options file is a folder": (["solve", "-options_file", "folder"], ["-options_file", "folder"]),
    "broken YAML": (["solve", "-options_file", "broken.yaml"], ["broken.yaml", "not a YAML file of options"]),
    "empty YAML": (["solve", "-options_file", "empty.yaml"], ["empty.yaml", "empty"]),
    "YAML list of maps": (["solve", "-options_file", "maps.yaml"], ["maps.yaml", "not a YAML file of options"]),
    "options file in a file": (["solve", *SCENE, "-options_file", "nested.yaml"], ["-options_file", "on the command line"]),
    "output in a missing folder": (["solve", *SCENE, "-output", "nowhere/x.h5"], ["-output nowhere/x.h5", "does not exist"]),
    "output not .h5": (["solve", *SCENE, "-output", "x.nc"], ["-output x.nc", ".h5"]),
    "output is a folder": (["solve", *SCENE, "-output", "folder"], ["-output folder", "folder"]),
    "output is a folder named .h5": (["solve", *SCENE, "-output", "folder.h5"], ["-output folder.h5", "folder"]),
    # PETSc's options
    "misspelt PETSc option": (["solve", *SCENE, "-slice_snes_rtoll", "1e-3"], ["-slice_snes_rtoll", "-slice_snes_rtol?"]),
    "misspelt PETSc option of sliding": (["solve", *SCENE, "-fidelity", "sliding", "-sliding_snes_rtoll", "1e-3"],
                                         ["-sliding_snes_rtoll", "-sliding_snes_rtol?"]),
    "option of a solver not in use": (["solve", *SCENE, "-sliding_snes_rtol", "1e-3"],
                                      ["-sliding_snes_rtol '1e-3'", "no part"]),
    "misspelt view": (["solve", *SCENE, "-log_vieww"], ["-log_vieww", "-log_view?"]),
    "unknown type": (["solve", *SCENE, "-slice_snes_type", "foo"], ["-slice_snes_type 'foo'", "PETSc refuses"]),
    "unknown matrix": (["solve", *SCENE, "-slice_mat_type", "foo"], ["-slice_mat_type 'foo'", "PETSc refuses"]),
    "no number for PETSc": (["solve", *SCENE, "-slice_snes_rtol", "foo"], ["-slice_snes_rtol 'foo'", "PETSc refuses"]),
    "unused PETSc option": (["solve", *SCENE, "-slice_ksp_rtol", "1e-3"], ["-slice_ksp_rtol '1e-3'", "no part"]),
    "tolerance out of range": (["solve", *SCENE, "-slice_snes_rtol", "-1"], ["-slice_snes_rtol '-1'", "at least 0"]),
    "steps out of range": (["solve", *SCENE, "-slice_snes_max_it", "-1"], ["-slice_snes_max_it '-1'", "at least 0"]),
    "unknown viewer": (["solve", *SCENE, "-slice_snes_view", "foo"], ["-slice_snes_view 'foo'", "PETSc refuses"]),
    "monitor to a missing folder": (["solve", *SCENE, "-slice_snes_monitor", ":nowhere/x"],
                                    ["-slice_snes_monitor ':nowhere/x'", "PETSc refuses"]),
    "log to a missing folder": (["solve", *SCENE, "-log_view", ":nowhere/x"], ["-log_view", "nowhere/x"]),
    "value that PETSc cannot start with": (["solve", *SCENE, "-fp_trap", "foo"], ["-fp_trap 'foo'", "PETSc refuses"]),
    "PETSc's start in a file": (["solve", *SCENE, "-options_file", "log.yaml"], ["log.yaml", "-log_view", "command line"]),
}
# One of each place where a mistake is found; the other cases differ in words alone.
ON_TWO_RANKS = ["no command", "word too many", "misspelt option", "stretch 0", "options file missing", "broken YAML",
                "output in a missing folder", "fields in a missing folder", "unknown type", "tolerance out of range", "monitor to a missing folder", "log to a missing folder",
                "value that PETSc cannot start with", "PETSc's start in a file"]
FILES = {
    "misspelt.yaml": "bandage:\n  thicknes: 1 mm\n",
    "half.yaml": "leg:\n  segments: shin\n  shin:\n    radius: [40 mm, 50 mm]\n",
    "broken.yaml": "leg: [r6, r5\nbandage: }\n",
    "empty.yaml": "",
    "maps.yaml": "leg:\n  - name: r6\n    height: 35 mm\n",
    "nested.yaml": "options_file: other.yaml\n",
    "log.yaml": "log_view:\n",
}


class WrongInput(InFolder):
    def setUp(self):
        super().setUp()
        for name, text in FILES.items():
            self.write(name, text)
        for name in ("folder", "folder.h5", "view_r1_rest.hdf"):
            (self.folder / name).mkdir()
        self.before = self.everything()

    def everything(self):
        return sorted(str(path) for path in self.folder.rglob("*"))

    def check(self, name, ranks):
        words, said = CASES[name]
        with self.subTest(name, ranks=ranks):
            run = self.run_gaiter(*words, ranks=ranks, code=2)
            self.assertEqual(run.out, "", run)
            self.assertRegex(run.err, r"\Agaiter: [^\n]+\n\Z", run)
            for words in said:
                self.assertIn(words, run.err)
            self.assertEqual(self.everything(), self.before, run)

    def test_alone(self):
        for name in CASES:
            self.check(name, 0)

    def test_on_two_ranks(self):
        for name in ON_TWO_RANKS:
            self.check(name, 2)

    def test_an_archive_of_before_stays(self):
        self.run_gaiter("solve", *SCENE, "-comparison", "none")
        before = (self.folder / "paper.h5").read_bytes()
        self.run_gaiter("solve", *SCENE, "-bandage_stretch", "0", code=2)
        self.run_gaiter("solve", *SCENE, "-slice_snes_type", "foo", code=2)
        self.assertEqual((self.folder / "paper.h5").read_bytes(), before)

    def test_folders_without_rights(self):
        closed = "closed"
        if os.geteuid() == 0:
            closed = "/proc"  # root may write to every ordinary folder, but no one can make a file here
        else:
            (self.folder / closed).mkdir(mode=0o500)
        run = self.run_gaiter("solve", *SCENE, "-output", f"{closed}/x.h5", code=2)
        self.assertRegex(run.err, rf"\Agaiter: -output {closed}/x.h5: [^\n]+\n\Z")


if __name__ == "__main__":
    main()
