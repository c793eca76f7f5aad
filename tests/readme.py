# SPDX-License-Identifier: BSD-2-Clause
"""What README.md shows works as shown: its commands run in order, its scene and its Python work, its tables are those of
the program."""
import re
import shlex
import subprocess
import sys

import h5py

from runs import GAITER, MPIEXEC, SOURCE, InFolder, main, own_lines

TEXT = (SOURCE / "README.md").read_text(encoding="utf-8")


def blocks(kind, text=TEXT):
    return re.findall(rf"(?m)^```{kind}\n(.*?)^```$", text, re.DOTALL)


def numbers(line):
    return [float(word) for word in re.findall(r"-?\d+\.?\d*(?:e[+-]?\d+)?", line)]


class Readme(InFolder):
    def setUp(self):
        super().setUp()
        (self.folder / "options").symlink_to(SOURCE / "options")
        scene, = blocks("yaml")
        self.write(re.match(r"# (\S+)\n", scene).group(1), scene)

    def run_line(self, line):
        words = shlex.split(line)
        if words[0] == "mpirun":
            words[0:1] = [MPIEXEC, "-q"]
        self.assertIn("build/bin/gaiter", words)
        words[words.index("build/bin/gaiter")] = GAITER
        done = subprocess.run(words, cwd=self.folder, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}\n{done.stderr}")
        self.assertEqual(own_lines(done.stderr), "", line)
        return done.stdout

    def test_commands_and_python_run_in_order(self):
        commands = [line for block in blocks("sh") for line in block.splitlines()]
        self.assertGreaterEqual(len(commands), 8)
        for line in commands:
            self.run_line(line)
        for name in ("paper.h5", "my_leg.h5", "thin.h5", "sweep.h5"):
            self.assertTrue((self.folder / name).exists(), name)
        programs = blocks("python")
        self.assertGreaterEqual(len(programs), 1)
        for program in programs:
            done = subprocess.run([sys.executable, "-c", program], cwd=self.folder, capture_output=True, text=True,
                                  timeout=60, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stdout.splitlines()[0], "Pa")
            self.assertEqual(len(done.stdout.splitlines()), 14)

    def test_the_printed_table_is_current(self):
        part, = re.findall(r"<!-- begin run -->\n(.*?)<!-- end run -->", TEXT, re.DOTALL)
        (command,), (shown,) = blocks("sh", part), blocks("text", part)
        printed = self.run_line(command).splitlines()
        for wanted, line in zip(shown.splitlines(), printed):
            self.assertEqual(re.sub(r"[-\d.]+", "#", wanted).split(), re.sub(r"[-\d.]+", "#", line).split())
            # The last digit may be rounded another way on another machine.
            for here, there in zip(numbers(wanted), numbers(line), strict=True):
                self.assertAlmostEqual(here, there, delta=1.5e-3 * max(1, abs(here)))

    def test_the_statuses_are_those_of_the_archive(self):
        part, = re.findall(r"<!-- begin statuses -->\n(.*?)<!-- end statuses -->", TEXT, re.DOTALL)
        self.run_line("build/bin/gaiter solve -options_file my_leg.yaml")
        with h5py.File(self.folder / "my_leg.h5") as file:
            words = file["status"].attrs["flag_meanings"].split()
            values = file["status"].attrs["flag_values"].tolist()
        listed = re.findall(r"(?m)^\| (\d+) \| `(\w+)` \|", part)
        self.assertEqual([(str(value), word) for value, word in zip(values, words)], listed)


if __name__ == "__main__":
    main()
