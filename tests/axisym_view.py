# SPDX-License-Identifier: BSD-2-Clause
"""-axisym_view: VTK's own reader takes the files, and the fields in them are those of the solution: geometry, contact,
equilibrium at the surfaces, and the closed form of a thick-walled tube, under voltage too."""
import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOHDF import vtkHDFReader

from runs import InFolder, main

OGDEN = ((21.193e3, 3.507), (10.514, 12.147))  # [Pa, 1]
PERMITTIVITY = 7.41 * 8.8541878128e-12  # [F/m]
HEIGHT, WALL = 35e-3, 1e-3  # [m]
SCENE = """
leg:
  segments: calf
  calf: {height: 35 mm, radius: [39.6 mm, 39.6 mm]}
  material: neo_hookean
bandage: {thickness: 1 mm, permittivity: 7.41, stretch: 1.8,
          ogden_mu: [21.193 kPa, 10.514 Pa], ogden_alpha: [3.507, 12.147]}
fidelity: axisym
"""
CONE = ["-leg_calf_radius", "36.1 mm,43.1 mm"]
BANDAGE, LEG = 0, 1
FIELDS = {"displacement", "pressure", "stress_rr", "stress_zz", "stress_rz", "stress_tt", "contact_pressure"}


class Grid:
    """What vtkHDFReader makes of a file: arrays of the points and cells by name, points of each cell in VTK's order."""

    def __init__(self, path):
        reader = vtkHDFReader()
        if not reader.CanReadFile(str(path)):
            raise AssertionError(f"VTK does not take {path}")
        reader.SetFileName(str(path))
        reader.Update()
        self.vtk = reader.GetOutput()
        self.point = vtk_to_numpy(self.vtk.GetPoints().GetData())
        self.of_point, self.of_cell = ({data.GetArrayName(k): vtk_to_numpy(data.GetArray(k))
                                        for k in range(data.GetNumberOfArrays())}
                                       for data in (self.vtk.GetPointData(), self.vtk.GetCellData()))
        cells = self.vtk.GetCells()
        self.cells = vtk_to_numpy(cells.GetConnectivityArray()).reshape(cells.GetNumberOfCells(), -1)
        self.order = round(self.cells.shape[1] ** 0.5) - 1
        self.r, self.z = self.point[:, 0], self.point[:, 1]
        self.reference = self.point[:, :2] - self.of_point["displacement"][:, :2]

    def points_of(self, body):
        return np.unique(self.cells[self.of_cell["body"] == body])

    def contact_edges(self, body):
        """Points of the edges on a body's contact surface, each from its lower end up, equispaced."""
        # VTK: corners 0 to 3, then inside the sides 0-1, 1-2, 3-2, 0-3.
        inside = 4 + np.arange(self.order - 1)
        side = ([0, *(inside + 3 * (self.order - 1)), 3] if body == BANDAGE else [1, *(inside + self.order - 1), 2])
        edges = self.cells[self.of_cell["body"] == body][:, side]
        # The reference surface is straight from the bottom to the top.
        Z, facing = self.reference[:, 1], self.reference[:, 0] * (1 if body == LEG else -1)
        own = self.points_of(body)
        ends = [Z[own].min(), Z[own].max()]
        surface = np.interp(Z, ends, [facing[own][np.abs(Z[own] - end) < 1e-9].max() for end in ends])
        return edges[(np.abs(facing - surface) < 1e-9)[edges].all(axis=1)]

    def on_edges(self, edges, values, place):
        """Values at places in (0, 1) of each edge, by the polynomial through its points: [edge, place]."""
        nodes = np.linspace(0, 1, self.order + 1)
        return values[edges] @ np.linalg.solve(np.vander(nodes).T, np.vander(place, self.order + 1).T)

    def mean_pressure(self, body):
        """Contact pressure averaged over the height, exactly."""
        x, w = np.polynomial.legendre.leggauss(self.order + 1)
        x, w, step = 0.5 * (x + 1), 0.5 * w, 1e-6
        edges = self.contact_edges(body)
        slope = (self.on_edges(edges, self.z, x + step) - self.on_edges(edges, self.z, x - step)) / (2 * step)
        return (self.on_edges(edges, self.of_point["contact_pressure"], x) * slope @ w).sum() / HEIGHT


def thick_wall(rho, pressure, inner, reference, voltage):
    """Total radial and hoop stress of an incompressible Ogden tube pressed from inside, at deformed radii rho; with a
    voltage between its faces the field V / (rho ln(b/a)) adds +- permittivity E^2 / 2."""
    outer = rho.max()

    def difference(q):
        stretch = q / np.sqrt(q * q - inner**2 + reference**2)
        field = voltage / (q * np.log(outer / inner))
        return sum(mu * (stretch**a - stretch**-a) for mu, a in OGDEN) - PERMITTIVITY * field**2

    x, w = np.polynomial.legendre.leggauss(20)
    at = inner + np.multiply.outer(rho - inner, 0.5 * (x + 1))
    radial = -pressure + 0.5 * (rho - inner) * ((difference(at) / at) @ w)
    return radial, radial + difference(rho)


class View(InFolder):
    def setUp(self):
        super().setUp()
        self.write("scene.yaml", SCENE)
        self.write("plain.yaml", "\n".join(line for line in SCENE.splitlines() if "calf" not in line))

    def solve(self, *words, ranks=0, view="view.hdf", **kept):
        return self.run_gaiter("solve", "-options_file", "scene.yaml", "-axisym_view", view, *words, ranks=ranks, **kept)

    def grid(self, name):
        grid = Grid(self.folder / name)
        self.assertEqual(set(grid.of_point), FIELDS)
        self.assertEqual(set(grid.of_cell), {"body", "segment"})
        for values in (grid.point, *grid.of_point.values()):
            self.assertTrue(np.isfinite(values).all())
        return grid

    def archive(self, variable):
        with h5py.File(self.folder / "gaiter.h5") as file:
            return file[variable][0]

    def test_a_cylinder_is_the_thick_walled_tube(self):
        # order: refinements, cells and points that gives, and relative error of the stresses allowed
        cases = {2: (1, 248, 1106, 3e-4), 3: (0, 62, 644, 1e-4), 4: (0, 62, 1106, 1e-5)}
        for order, (refine, cells, points, error) in cases.items():
            self.solve("-voltage", "5 kV", "-axisym_order", order, "-axisym_refine", refine)
            for state, voltage in (("rest", 0), ("actuated", 5e3)):
                with self.subTest(order=order, state=state):
                    grid = self.grid(f"view_{state}.hdf")
                    self.assertEqual((len(grid.cells), len(grid.point), grid.order), (cells, points, order))
                    pressure = self.archive(f"pressure_{state}")[0]
                    tube = grid.points_of(BANDAGE)
                    inner, A = grid.r[tube].min(), 39.6e-3 / 1.8 - WALL
                    self.assertAlmostEqual(grid.reference[tube, 0].min(), A, delta=1e-12)
                    radial, hoop = thick_wall(grid.r[tube], pressure, inner, A, voltage)
                    scale = np.abs(hoop).max()
                    stress = {name: grid.of_point[f"stress_{name}"] for name in ("rr", "zz", "rz", "tt")}
                    for name, exact in (("rr", radial), ("tt", hoop), ("rz", 0)):
                        self.assertLess(np.abs(stress[name][tube] - exact).max(), error * scale, name)
                    leg = grid.points_of(LEG)
                    self.assertFalse(set(leg) & set(tube))
                    for name, exact in (("rr", -pressure), ("tt", -pressure), ("rz", 0)):
                        self.assertLess(np.abs(stress[name][leg] - exact).max(), 1e-4 * pressure, name)
                    mean = -(stress["rr"] + stress["zz"] + stress["tt"]) / 3
                    self.assertLess(np.abs(grid.of_point["pressure"] - mean).max(), 1e-9 * scale)
                    # VTK sees the cells that are meant: their areas by its own rules, for all edges are straight.
                    sizes = vtkCellSizeFilter()
                    sizes.SetInputData(grid.vtk)
                    sizes.Update()
                    area = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Area"))
                    outer = grid.r[tube].max()
                    for body, width in ((BANDAGE, outer - inner), (LEG, inner)):
                        self.assertAlmostEqual(area[grid.of_cell["body"] == body].sum() / (width * HEIGHT), 1, delta=1e-6)

    def test_a_cone_touches_where_it_presses(self):
        for side in ("tube", "leg"):
            self.solve(*CONE, "-axisym_multipliers", side, "-bandage_stretch", "1.4")
            grid = self.grid("view_rest.hdf")
            bodies = {body: grid.contact_edges(body) for body in (BANDAGE, LEG)}
            self.assertEqual([len(edges) for edges in bodies.values()], [24, 20])
            pressure = self.archive("pressure_rest")[0]
            carrier, other = (BANDAGE, LEG) if side == "tube" else (LEG, BANDAGE)
            self.assertAlmostEqual(grid.mean_pressure(carrier) / pressure, 1, delta=1e-8)
            # The other surface shows the pressure at its own points, the peak at the end less sharply.
            self.assertAlmostEqual(grid.mean_pressure(other) / pressure, 1, delta=0.02)
            # Nothing away from the surfaces.
            elsewhere = np.setdiff1d(np.arange(len(grid.point)), np.concatenate([e.ravel() for e in bodies.values()]))
            self.assertEqual(np.abs(grid.of_point["contact_pressure"][elsewhere]).max(), 0)
            # Gap between the surfaces as curves, where the tube is pressed and where it has lifted off.
            place = np.linspace(0, 1, 21)
            edges = bodies[BANDAGE]
            r, z = (grid.on_edges(edges, values, place) for values in (grid.r, grid.z))
            skin = [grid.on_edges(bodies[LEG], values, place).ravel() for values in (grid.z, grid.r)]
            gap = r - np.interp(z, *skin)
            pressed = (grid.of_point["contact_pressure"][edges] > 0).all(axis=1)
            self.assertGreater(pressed.sum(), 18)
            # They meet as well as quadratic edges can; where an edge is pressed only in part, its other part is open.
            self.assertLess(np.abs(gap[pressed]).max(), 2e-5)
            inside = np.abs(z - 0.5 * HEIGHT).max(axis=1) < 0.4 * HEIGHT
            self.assertGreater(inside.sum(), 8)
            self.assertTrue(pressed[inside].all())
            self.assertLess(np.abs(gap[inside]).max(), 1e-6)
            self.assertGreater(gap.max(), 1e-4)  # the narrow end stands off
            # In between the ends each surface's normal stress balances the pressure, and there is no shear.
            for body, points in ((body, np.unique(edges)) for body, edges in bodies.items()):
                middle = points[np.abs(grid.z[points] - 0.5 * HEIGHT) < 0.3 * HEIGHT]
                slope = np.gradient(grid.r[middle], grid.z[middle])[1:-1]
                middle = middle[1:-1]
                rr, zz, rz = (grid.of_point[f"stress_{name}"][middle] for name in ("rr", "zz", "rz"))
                normal = (rr - 2 * slope * rz + slope**2 * zz) / (1 + slope**2)
                self.assertLess(np.abs(normal + grid.of_point["contact_pressure"][middle]).max(), 0.05 * pressure, body)

    def test_two_ranks_give_the_same_fields(self):
        for ranks in (1, 2):
            self.solve(*CONE, "-axisym_ranks_per_case", ranks, ranks=ranks, view=f"on{ranks}.hdf")
        one, two = self.grid("on1_rest.hdf"), self.grid("on2_rest.hdf")
        np.testing.assert_array_equal(one.cells, two.cells)
        for name, values in (("points", one.point), *one.of_point.items()):
            other = two.point if name == "points" else two.of_point[name]
            self.assertLess(np.abs(values - other).max(), 1e-9 * np.abs(values).max(), name)
        self.assertEqual(sorted(path.name for path in self.folder.glob("*.hdf*")), ["on1_rest.hdf", "on2_rest.hdf"])

    def test_a_mesh_a_segment_a_file(self):
        self.write("two.yaml", "leg:\n  segments: [low, high]\n  low: {height: 35 mm, radius: [38 mm, 40 mm]}\n"
                               "  high: {height: 35 mm, radius: [40 mm, 44 mm]}\n")
        (self.folder / "out").mkdir()
        for ranks in (1, 2):
            run = self.run_gaiter("solve", "-options_file", "plain.yaml", "-options_file", "two.yaml", "-axisym_view",
                                  f"out/{ranks}.vtkhdf", "-bandage_high_voltage", "3 kV", ranks=ranks)
            names = [f"{ranks}_{name}.vtkhdf" for name in ("low_rest", "high_rest", "high_actuated")]
            self.assertEqual(run.out.splitlines()[-4:-1], [f"wrote out/{name}" for name in names])
            for name in names:
                grid = self.grid(f"out/{name}")
                self.assertEqual(set(grid.of_cell["segment"]), {0 if "low" in name else 1})
                end = grid.reference[grid.points_of(LEG), 0].max()
                self.assertAlmostEqual(end, 40e-3 if "low" in name else 44e-3, delta=1e-9)
        self.assertEqual(len(list((self.folder / "out").iterdir())), 6)

    def test_no_file_of_a_state_that_was_not_found(self):
        self.write("view_rest.hdf", "of an earlier run")
        run = self.solve(*CONE, "-axisym_snes_max_it", 1, code=3)
        self.assertIn("no state was found for view_rest.hdf", run.out)
        self.assertFalse((self.folder / "view_rest.hdf").exists())


if __name__ == "__main__":
    main()
