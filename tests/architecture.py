# SPDX-License-Identifier: BSD-2-Clause
"""The rules of the source that a compiler does not check: rooms include downwards only, namespaces are the rooms, files
stay short, README's tables are current, every test says how long and on how many cores it runs.
Usage: architecture.py GAITER SOURCE BUILD CTEST"""
import json
import pathlib
import re
import subprocess
import sys
import unittest

GAITER, SOURCE, BUILD, CTEST = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]), sys.argv[4]

# Room: the rooms it may include.
ROOMS = {
    "base": set(),
    "model": {"base"},
    "physics": {"model", "base"},
    "petsc": {"base"},
    "solvers": {"physics", "model", "petsc", "base"},
    "archive": {"model", "petsc", "base"},
    "studies": {"solvers", "archive", "physics", "model", "petsc", "base"},
}
# Outside libraries, by the beginning of a header's name: the rooms that may know of them.
LIBRARIES = {
    "petsc": {"petsc", "solvers", "studies", "archive"},
    "slepc": {"solvers"},
    "mpi": {"petsc", "solvers", "archive", "studies"},
    "hdf5": {"archive"},
    "H5": {"archive"},
    "udunits": {"base"},
    "spdlog": set(),
}
PRINTS = r"\b(?:fmt::print|printf|fprintf|puts|PetscPrintf|PetscSynchronizedPrintf)\s*\(|std::(?:cout|cerr|clog)\b"
READS_OPTIONS = r"\bPetscOptions\w+\s*\(|\bgetenv\s*\("
MOST_LINES = 400
LONGER = set()  # paths of files that are allowed to be longer, each with its reason


def sources():
    for pattern in ("src/**/*.[ch]pp", "include/**/*.[ch]pp"):
        yield from sorted(SOURCE.glob(pattern))


def room_of(path):
    parts = path.relative_to(SOURCE).parts
    room = parts[1] if parts[0] == "src" else parts[2]
    return room if len(parts) > 2 else None  # src/gaiter.cpp belongs to none


def code_of(path):
    """Without comments and strings, so that neither can be taken for code."""
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', '""', path.read_text(encoding="utf-8"), flags=re.DOTALL)


def includes(path):
    return re.findall(r'(?m)^#include [<"]([^>"]+)[>"]', path.read_text(encoding="utf-8"))


class Rooms(unittest.TestCase):
    def test_all_are_there(self):
        for base in (SOURCE / "src", SOURCE / "include" / "gaiter"):
            self.assertLessEqual({path.name for path in base.iterdir() if path.is_dir()}, set(ROOMS))
        self.assertGreater(len(list(sources())), 50)

    def test_includes_point_downwards(self):
        for path in sources():
            room = room_of(path)
            for header in includes(path):
                if room is None or not header.startswith("gaiter/"):
                    continue
                other = header.split("/")[1]
                self.assertTrue(other == room or other in ROOMS[room], f"{path}: {room} must not include {header}")

    def test_linked_rooms_are_the_included_ones(self):
        text = (SOURCE / "CMakeLists.txt").read_text(encoding="utf-8")
        declared = dict(re.findall(r"gaiter_room\((\w+)(?: USES ([^)]*))?\)", text))
        self.assertEqual(set(declared), set(ROOMS))
        for room, used in declared.items():
            self.assertLessEqual(set(used.split()) & set(ROOMS), ROOMS[room], room)

    def test_libraries_stay_in_their_rooms(self):
        for path in sources():
            room = room_of(path)
            for header in includes(path):
                for library, rooms in LIBRARIES.items():
                    if room and not header.startswith("gaiter/") and header.startswith(library):
                        self.assertIn(room, rooms, f"{path} includes {header}")

    def test_only_studies_prints(self):
        for path in sources():
            if room_of(path) not in (None, "studies"):
                self.assertIsNone(re.search(PRINTS, code_of(path)), path)

    def test_only_studies_petsc_and_solvers_read_options(self):
        for path in sources():
            found = re.findall(READS_OPTIONS, code_of(path))
            if room_of(path) == "solvers":  # those of a solver, by its prefix
                self.assertTrue(all(call.startswith("PetscOptionsGet") for call in found), f"{path}: {found}")
            elif room_of(path) not in ("studies", "petsc"):
                self.assertEqual(found, [], path)

    def test_nobody_sets_options_for_the_user(self):
        for path in sources():
            self.assertNotRegex(code_of(path), r"\bPetscOptionsSetValue\b", path)


class Files(unittest.TestCase):
    def test_namespace_is_the_room(self):
        for path in sources():
            opened = re.findall(r"(?m)^(?:inline )?namespace (gaiter[\w:]*) \{", code_of(path))
            room = room_of(path)
            self.assertEqual(len(opened), 0 if room is None else 1, path)
            for name in opened:  # a room may have closets
                self.assertEqual(name.split("::")[:2], ["gaiter", room], path)

    def test_licence_is_on_top(self):
        patterns = ["**/*.cpp", "**/*.hpp", "**/*.hpp.in", "**/CMakeLists.txt", "**/*.cmake", "**/*.py", "*.sh"]
        checked = 0
        for pattern in patterns:
            for path in SOURCE.glob(pattern):
                if any(part.startswith("build") for part in path.relative_to(SOURCE).parts[:-1]):
                    continue
                top = path.read_text(encoding="utf-8").split("\n")[:2]
                self.assertTrue(any("SPDX-License-Identifier: BSD-2-Clause" in line for line in top), path)
                checked += 1
        self.assertGreater(checked, 80)

    def test_headers_are_included_once(self):
        for path in sources():
            if path.suffix == ".hpp":
                self.assertIn("#pragma once\n", path.read_text(encoding="utf-8"), path)

    def test_files_are_short(self):
        everything = [*sources(), *SOURCE.glob("tests/*"), *SOURCE.glob("benchmarks/*")]
        for path in everything:
            if path.is_file() and str(path.relative_to(SOURCE)) not in LONGER:
                lines = path.read_text(encoding="utf-8").count("\n")
                self.assertLessEqual(lines, MOST_LINES, path)
        for name in LONGER:
            self.assertTrue((SOURCE / name).exists(), name)


class Readme(unittest.TestCase):
    def setUp(self):
        self.text = (SOURCE / "README.md").read_text(encoding="utf-8")

    def block(self, name):
        found = re.findall(rf"<!-- begin {name} -->\n(.*?)<!-- end {name} -->", self.text, re.DOTALL)
        self.assertEqual(len(found), 1, name)
        return found[0]

    def test_option_table_is_that_of_the_program(self):
        printed = subprocess.run([GAITER, "-help", "markdown"], capture_output=True, text=True, check=True).stdout
        self.assertIn("| `-bandage_stretch` |", printed)
        self.assertEqual(self.block("options"), printed, "renew it with: gaiter -help markdown")

    def test_rooms_table_names_all_rooms(self):
        named = re.findall(r"(?m)^\| `(\w+)` \|[^|]*\| ([^|]*) \|$", self.block("rooms"))
        self.assertEqual({room for room, _ in named}, set(ROOMS))
        for room, uses in named:
            self.assertEqual(set(re.findall(r"`(\w+)`", uses)), ROOMS[room], room)

    def test_names_only_files_that_exist(self):
        folders = "src|include|options|tests|benchmarks|cmake|\\.ci"
        named = set(re.findall(rf"(?<![\w/.-])(?:\./)?((?:{folders})/[\w./*-]*[\w*/]|quickstart\.sh|LICENSE)", self.text))
        self.assertGreater(len(named), 5)
        for name in named:
            self.assertTrue(list(SOURCE.glob(name)), f"README.md names {name}")


class Tests(unittest.TestCase):
    def test_each_has_label_cores_and_time_limit(self):
        shown = subprocess.run([CTEST, "--test-dir", BUILD, "--show-only=json-v1"], capture_output=True, text=True,
                               check=True).stdout
        tests = json.loads(shown)["tests"]
        self.assertGreater(len(tests), 10)
        for test in tests:
            properties = {item["name"]: item["value"] for item in test["properties"]}
            for needed in ("LABELS", "TIMEOUT"):
                self.assertIn(needed, properties, test["name"])
            self.assertLessEqual(properties["TIMEOUT"], 600)
            # CTest leaves out a PROCESSORS of 1.
            words = test.get("command", [])
            if words and "mpi" in pathlib.Path(words[0]).name:
                self.assertEqual(properties.get("PROCESSORS", 1), int(words[2]), test["name"])

    def test_each_source_file_is_built(self):
        text = "".join(path.read_text(encoding="utf-8") for path in SOURCE.glob("tests/*.cmake"))
        for path in [*SOURCE.glob("tests/*.cpp"), *SOURCE.glob("tests/*.py")]:
            if path.stem != "runs":
                self.assertRegex(text, rf"\b{path.stem}\b", f"{path} is in no test")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[5:]])
