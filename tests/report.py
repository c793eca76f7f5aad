# SPDX-License-Identifier: BSD-2-Clause
"""gaiter report: a page for every kind of archive, with the archive's own numbers in it."""
import base64
import html
import re

import h5py

from runs import PAPER, InFolder, main

SCENE = ("-options_file", PAPER, "-comparison", "none")


class Report(InFolder):
    def page(self, name):
        run = self.run_gaiter("report", "-archive", f"{name}.h5")
        self.assertIn(f"wrote {name}.html", run.out)
        text = (self.folder / f"{name}.html").read_text(encoding="utf-8")
        for image in re.findall(r'src="data:image/png;base64,([^"]+)"', text):
            self.assertTrue(base64.b64decode(image).startswith(b"\x89PNG"))
        return text

    def test_a_scene(self):
        self.run_gaiter("solve", *SCENE, "-output", "one.h5")
        text = self.page("one")
        self.assertEqual(text.count("<img"), 1)
        with h5py.File(self.folder / "one.h5") as file:
            for value in file["pressure_rest"][0]:
                self.assertIn(f"{value / 1000:.4f}", text)
            self.assertIn(html.escape(file.attrs["command"]), text)

    def test_a_plan(self):
        self.run_gaiter("solve", *SCENE, "-fidelity", "auto", "-auto_up_to", "slice", "-output", "one.h5")
        text = self.page("one")
        self.assertIn("<th>expected error of discretisation</th>", text)
        with h5py.File(self.folder / "one.h5") as file:
            for value in file["planned_discretisation_error"][0]:
                self.assertIn(f"<td>{value:.1e}</td>", text)

    def test_sweeps(self):
        sweep = ("sweep", *SCENE, "-progress", "off", "-sweep_bandage_stretch")
        self.run_gaiter(*sweep, "linspace(1.4,2,4)", "-sweep_voltage", "linspace(0 V,10 kV,3)", "-output", "grid.h5")
        self.run_gaiter(*sweep, "uniform(1.4,2)", "-sweep_sampler", "random", "-sweep_samples", "25000", "-output", "many.h5")
        self.run_gaiter(*sweep, "1.4,1.6", "-output_variables", "pressure_rest", "-output", "few.h5")
        self.assertEqual(self.page("grid").count("<img"), 5)  # four maps and how often each value occurs
        text = self.page("many")
        self.assertIn("25000 designs of 6 segments; figures show every 2th design", text)
        self.assertEqual(text.count("<img"), 5)
        text = self.page("few")
        self.assertEqual(text.count("<img"), 2)
        self.assertNotIn("volume", text.split("<pre>")[0])

    def test_designs_without_result(self):
        # Some of these walls leave no hole in the tube.
        self.run_gaiter("sweep", *SCENE, "-sweep_sampler", "random", "-sweep_samples", "8", "-sweep_bandage_thickness",
                        "normal(20 mm, 5 mm)", "-output", "bad.h5", code=3)
        text = self.page("bad")
        self.assertRegex(text, "<td>invalid</td><td>[0-9]+</td>")
        self.assertIn("<td>nan", text)

    def test_wrong_input(self):
        self.write("text.h5", "no archive")
        self.run_gaiter("solve", *SCENE, "-output", "one.h5")
        for words, message in ((["-archive", "none.h5"], "-archive 'none.h5': must be a file that gaiter wrote"),
                               (["-archive", "text.h5"], "-archive 'text.h5': must be a file that gaiter wrote"),
                               ([], "-archive is missing"),
                               (["-archive", "one.h5", "-voltage", "1 kV"], "-voltage '1 kV': report takes -archive"),
                               (["-archive", "one.h5", "-output", "page.txt"], "-output page.txt: the name must end in")):
            for ranks in (0, 2):
                self.assertIn(message, self.run_gaiter("report", *words, ranks=ranks, code=2).err)
        run = self.run_gaiter("solve", *SCENE, "-archive", "one.h5", code=2)
        self.assertIn("-archive 'one.h5': belongs to the command report", run.err)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["one.h5", "text.h5"])


if __name__ == "__main__":
    main()
