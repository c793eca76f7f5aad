# SPDX-License-Identifier: BSD-2-Clause
"""Runs the built program as users do, for the tests of the command line. CTest hands in the program, mpiexec and
the source folder: python3 TEST.py GAITER MPIEXEC SOURCE [unittest's arguments]."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

GAITER, MPIEXEC, SOURCE = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
SCENES = sorted((SOURCE / "options" / "scenes").glob("*.yaml"))
AXISYM_SOLVERS = sorted((SOURCE / "options" / "solvers").glob("axisym_*.yaml"))
SOLVERS = sorted(set((SOURCE / "options" / "solvers").glob("*.yaml")) - set(AXISYM_SOLVERS))  # of slices
PAPER = str(SOURCE / "options" / "scenes" / "paper.yaml")
# What may differ between archives of the same study: when and on how many ranks it ran, how long, and the words.
OF_THE_RUN = {"wall_time", "created", "ranks", "command"}


def own_lines(text):
    """Without what MPI's hardware discovery says in containers that hide /sys."""
    return "".join(line for line in text.splitlines(keepends=True) if not line.startswith("[hwloc/"))


class Run:
    """One run in a folder: `code`, `out` and `err` as it ended."""

    def __init__(self, folder, *words, ranks=0):
        # mpiexec's own remark on an exit code that is not 0 is left out by -q.
        launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks else []
        done = subprocess.run([*launch, GAITER, *map(str, words)], cwd=folder, capture_output=True, text=True,
                              timeout=300, check=False, stdin=subprocess.DEVNULL)
        self.words, self.code, self.out = " ".join(map(str, words)), done.returncode, done.stdout
        self.err = own_lines(done.stderr)

    def __str__(self):
        return f"gaiter {self.words}\nexit code {self.code}\nstdout:\n{self.out}\nstderr:\n{self.err}"


class InFolder(unittest.TestCase):
    """A test in a fresh folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_gaiter(self, *words, ranks=0, code=0):
        run = Run(self.folder, *words, ranks=ranks)
        self.assertEqual(run.code, code, run)
        self.assertNotIn("PETSC ERROR", run.out + run.err)
        return run

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return name


def contents(path):
    """Everything in an archive that the run itself does not decide: name to bytes or value."""
    found = {}
    with h5py.File(path, "r") as file:
        for name, value in file.attrs.items():
            found["/" + name] = value
        for name, data in file.items():
            values = data.asstr()[:].tolist() if h5py.check_string_dtype(data.dtype) else data[()].tobytes()
            found[name] = (str(data.dtype), data.shape, values)
            for key, value in data.attrs.items():
                if key not in ("DIMENSION_LIST", "REFERENCE_LIST"):  # addresses in the file
                    found[f"{name}/{key}"] = value.tobytes() if isinstance(value, np.ndarray) else value
    return {key: value for key, value in found.items() if key.split("/")[0 if key[0] != "/" else 1] not in OF_THE_RUN}


def main():
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
