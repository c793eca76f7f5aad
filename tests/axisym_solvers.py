# SPDX-License-Identifier: BSD-2-Clause
"""The set-ups of the finite elements' linear solver, options/solvers/axisym_*.yaml."""
import h5py
import numpy as np

from runs import AXISYM_SOLVERS, InFolder, main

# The cone that the project compares with CalculiX.
CONE = """
leg:
  segments: cone
  material: neo_hookean
  young: 80 kPa
  poisson: 0.4
  cone:
    height: 35 mm
    radius: [36.1 mm, 43.1 mm]
bandage:
  stretch: 1.4
  thickness: 1 mm
  ogden_mu: [21.193 kPa, 10.514 Pa]
  ogden_alpha: [3.507, 12.147]
fidelity: axisym
output: cone.h5
"""
RESULTS = ("pressure_rest", "pressure_rest_area_mean", "volume_rest", "slip_max", "status", "iterations")
REFUSED = {
    "misspelt option of a field": (["axisym_fieldsplit"], "-axisym_fieldsplit_displacement_ksp_rtoll", "1e-3",
                                   "-axisym_fieldsplit_displacement_ksp_rtol?"),
    "misspelt field": (["axisym_fieldsplit"], "-axisym_fieldsplit_displacment_ksp_rtol", "1e-3",
                       "-axisym_fieldsplit_displacement_ksp_rtol?"),
    "option of a field without fields": ([], "-axisym_fieldsplit_displacement_ksp_rtol", "1e-3", "no part"),
    "misspelt option of MUMPS": ([], "-axisym_mat_mumps_icntl_144", "100", "-axisym_mat_mumps_icntl_14?"),
    "no such package": ([], "-axisym_pc_factor_mat_solver_type", "foo", "does not factorise"),
    "no such ordering": (["axisym_petsc_lu"], "-axisym_pc_factor_mat_ordering_type", "foo", "PETSc refuses"),
}


class Setups(InFolder):
    def setUp(self):
        super().setUp()
        self.scene = self.write("cone.yaml", CONE)
        self.files = {path.stem: path for path in AXISYM_SOLVERS}
        self.assertLessEqual({"axisym_mumps", "axisym_petsc_lu", "axisym_fieldsplit"}, set(self.files))

    def solve(self, *words, solver=None, ranks=0, **expected):
        chosen = ["-options_file", self.files[solver]] if solver else []
        return self.run_gaiter("solve", "-options_file", self.scene, *chosen, *words, "-axisym_ranks_per_case",
                               max(ranks, 1), ranks=ranks, **expected)

    def results(self):
        with h5py.File(self.folder / "cone.h5") as file:
            return {name: file[name][:] for name in RESULTS}

    def test_all_give_the_same_answer(self):
        self.solve()
        default = self.results()
        self.assertEqual(default["status"], 0)
        for ranks in (0, 2):
            for solver in self.files:
                if ranks > 0 and solver == "axisym_petsc_lu":
                    continue
                with self.subTest(solver=solver, ranks=ranks):
                    self.solve("-output", "cone.h5", solver=solver, ranks=ranks)
                    for name, value in self.results().items():
                        np.testing.assert_allclose(value, default[name], rtol=1e-9, err_msg=name)

    def test_petsc_lu_says_that_it_is_for_one_rank(self):
        run = self.solve(solver="axisym_petsc_lu", ranks=2, code=2)
        for word in ("-axisym_pc_factor_mat_solver_type 'petsc'", "2 ranks", "'mumps'"):
            self.assertIn(word, run.err)
        self.assertFalse((self.folder / "cone.h5").exists())

    def test_the_fields_of_a_block_triangular_preconditioner(self):
        run = self.solve("-axisym_pc_fieldsplit_type", "multiplicative", "-axisym_fieldsplit_pressure_pc_type", "none",
                         "-axisym_fieldsplit_multiplier_pc_type", "none", "-axisym_pc_type", "fieldsplit",
                         "-axisym_ksp_type", "gmres", "-axisym_ksp_max_it", "3", "-axisym_snes_view", "-axisym_snes_max_it",
                         "1", code=3)
        for field in ("displacement", "pressure", "multiplier"):
            self.assertIn(f"(axisym_fieldsplit_{field}_)", run.out)

    def test_wrong_options_are_errors(self):
        for case, (solver, option, value, said) in REFUSED.items():
            with self.subTest(case):
                run = self.solve(option, value, solver=solver[0] if solver else None, code=2)
                self.assertIn(option, run.err)
                self.assertIn(said, run.err)

    def test_stability_is_known_without_counted_pivots(self):
        # A front factorised by several ranks is not counted by MUMPS.
        self.solve("-axisym_mat_mumps_icntl_13", "0", ranks=2)
        self.assertEqual(self.results()["status"], 0)

    def test_the_log_shows_the_shares(self):
        run = self.solve("-log_view")
        for event in ("AxisymCells", "AxisymContact"):
            self.assertIn(event, run.out)


if __name__ == "__main__":
    main()
