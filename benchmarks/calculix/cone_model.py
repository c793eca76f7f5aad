# SPDX-License-Identifier: BSD-2-Clause
"""The comparison cone as CalculiX's input, and what CalculiX's output says of it. Lengths in mm, stresses in MPa.

A calf of neo-Hookean material, 35 mm high, radius 36.1 to 43.1 mm, in a tube of Ogden material whose reference
external radius is the calf's mean radius over the stretch. The undeformed tube lies inside the undeformed calf:
first the calf's surface is drawn in until it is a cylinder within the tube, then it grows back in contact with the
tube, then it is let go. (Stretching the tube and letting it go at once, or inflating it, fails or takes far longer:
without friction the released tube is thrown along the taper.)
"""

import dataclasses
import math
import re

YOUNG, POISSON = 80e-3, 0.40
OGDEN = [(21.193e-3, 3.507), (10.514e-6, 12.147)]  # W = sum mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3)
HEIGHT, WALL = 35.0, 1.0
LOWER_RADIUS, UPPER_RADIUS = 36.1, 43.1
STRETCH = 1.4
PENALTY = 5.0  # of the contact [MPa/mm]: 2.5e-4 mm of overlap at the pressures here
CLEARANCE = 0.01  # between the thinned calf and the tube
SQUEEZE = 0.165  # of the calf when it is let go, about that of the result
# The steps do not wait for each node of the contact to settle, and shrink less eagerly than by default.
STEP = [
    "*STEP, NLGEOM, INC=400",
    "*CONTROLS, PARAMETERS=CONTACT", "0.1, 0.1, 100, 60",
    "*CONTROLS, PARAMETERS=TIME INCREMENTATION", "20, 30, 9, 60, 50, 25, , 12",
    "*STATIC", "0.1, 1, 1e-6, 0.1",
]


@dataclasses.dataclass
class Mesh:
    """Elements (CAX8R) along the height, across the wall, along the calf's radius."""

    axial: int
    wall: int
    radial: int


class Grid:
    """Nodes and eight-node elements of one body; position(i, j) at half steps, i outwards, j upwards."""

    def __init__(self, columns, rows, position, first_node, first_element):
        self.nodes, self.elements, self.number = {}, {}, {}
        for j in range(2 * rows + 1):
            for i in range(2 * columns + 1):
                if i % 2 and j % 2:
                    continue
                node = first_node + len(self.nodes)
                self.number[i, j] = node
                self.nodes[node] = position(i / (2 * columns), j / (2 * rows))
        for j in range(rows):
            for i in range(columns):
                corner = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
                self.elements[first_element + len(self.elements)] = [
                    self.number[2 * i + x, 2 * j + y] for x, y in corner]
        self.columns, self.rows = columns, rows

    def column(self, i):
        """Nodes of one line of nodes, upwards."""
        i = 2 * self.columns if i < 0 else i
        return [self.number[i, j] for j in range(2 * self.rows + 1)]

    def row(self, j):
        j = 2 * self.rows if j < 0 else j
        return [self.number[i, j] for i in range(2 * self.columns + 1)]


def bodies(mesh):
    inner = 0.5 * (LOWER_RADIUS + UPPER_RADIUS) / STRETCH - WALL
    tube = Grid(mesh.wall, mesh.axial, lambda x, y: (inner + WALL * x, HEIGHT * y), 1, 1)

    def in_calf(x, y):
        x = 1 - (1 - x) ** 1.5  # finer towards the surface
        return (x * (LOWER_RADIUS + (UPPER_RADIUS - LOWER_RADIUS) * y), HEIGHT * y)

    calf = Grid(mesh.radial, mesh.axial, in_calf, 1 + len(tube.nodes), 1 + len(tube.elements))
    return tube, calf


def write_input(path, mesh, bulk_modulus):
    tube, calf = bodies(mesh)
    lines = ["*NODE, NSET=ALL"]
    for body in (tube, calf):
        lines += [f"{node}, {r:.12g}, {z:.12g}, 0" for node, (r, z) in body.nodes.items()]
    for name, body in (("TUBE", tube), ("CALF", calf)):
        lines.append(f"*ELEMENT, TYPE=CAX8R, ELSET={name}")
        lines += [", ".join(map(str, [number, *nodes])) for number, nodes in body.elements.items()]

    def node_set(name, nodes):
        lines.append(f"*NSET, NSET={name}")
        lines.extend(f"{node}," for node in nodes)

    node_set("SKIN", calf.column(-1))
    node_set("AXIS", calf.column(0))
    node_set("TUBE_ENDS", [*tube.row(0), *tube.row(-1)])
    node_set("ENDS", [*tube.row(0), *tube.row(-1), *calf.row(0), *calf.row(-1)])
    lines.append("*SURFACE, NAME=ON_TUBE, TYPE=ELEMENT")
    lines += [f"{number}, S4" for number in list(tube.elements)[:: mesh.wall]]
    lines.append("*SURFACE, NAME=ON_CALF, TYPE=ELEMENT")
    lines += [f"{number}, S2" for number in list(calf.elements)[mesh.radial - 1 :: mesh.radial]]

    shear, bulk = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
    # CalculiX's Ogden energy has 2 mu / alpha^2 where ours has mu / alpha.
    ogden = ", ".join(f"{0.5 * mu * alpha:.12g}, {alpha}" for mu, alpha in OGDEN)
    held = ["AXIS, 1, 1", "ENDS, 2, 2"]
    inner = tube.nodes[tube.column(0)[0]][0]
    thin = [f"{node}, 1, 1, {inner - CLEARANCE - calf.nodes[node][0]:.12g}" for node in calf.column(-1)]
    lines += [
        "*MATERIAL, NAME=CALF", "*HYPERELASTIC, NEO HOOKE", f"{0.5 * shear:.12g}, {2 / bulk:.12g}",
        "*MATERIAL, NAME=TUBE", "*HYPERELASTIC, OGDEN, N=2", f"{ogden}, {2 / bulk_modulus:.12g}, 1e20",
        "*SOLID SECTION, ELSET=CALF, MATERIAL=CALF", "1.", "*SOLID SECTION, ELSET=TUBE, MATERIAL=TUBE", "1.",
        "*SURFACE INTERACTION, NAME=SMOOTH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{PENALTY}, 1e-12",
        "*CONTACT PAIR, INTERACTION=SMOOTH, TYPE=NODE TO SURFACE", "ON_TUBE, ON_CALF",
        "*BOUNDARY", *held,
        *STEP,
        "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", "ON_TUBE, ON_CALF",
        "*BOUNDARY", *thin, "*END STEP",
        *STEP,
        "*MODEL CHANGE, TYPE=CONTACT PAIR, ADD", "ON_TUBE, ON_CALF",
        "*BOUNDARY", f"SKIN, 1, 1, {-SQUEEZE}", "*END STEP",
        *STEP,
        "*BOUNDARY, OP=NEW", *held,
        "*NODE PRINT, NSET=ALL, FREQUENCY=1000", "U", "*NODE PRINT, NSET=TUBE_ENDS, FREQUENCY=1000", "RF",
        "*EL PRINT, ELSET=TUBE, FREQUENCY=1000", "S", "*END STEP",
    ]
    with open(path, "w") as file:
        file.write("\n".join(lines) + "\n")


def tables(path):
    """The rows of CalculiX's .dat file by the first word of each table's title."""
    result, rows = {}, []
    with open(path) as file:
        for line in file:
            title = re.match(r" *(displacements|forces|stresses) ", line)
            if title:
                rows = result.setdefault(title[1], [])
                rows.clear()  # of several increments the last
            elif line.strip():
                rows.append([float(word) for word in line.split()])
    return result


def gauss_points(corners_and_middles):
    """Radius and volume over 2 pi r of the four points of an eight-node element, in CalculiX's order."""
    g = 1 / math.sqrt(3)
    for eta in (-g, g):
        for xi in (-g, g):
            a, b = 1 - xi, 1 + xi
            c, d = 1 - eta, 1 + eta
            value = [-a * c * (1 + xi + eta) / 4, -b * c * (1 - xi + eta) / 4, -b * d * (1 - xi - eta) / 4,
                     -a * d * (1 + xi - eta) / 4, a * b * c / 2, b * c * d / 2, a * b * d / 2, a * c * d / 2]
            by_xi = [c * (2 * xi + eta) / 4, c * (2 * xi - eta) / 4, d * (2 * xi + eta) / 4,
                     d * (2 * xi - eta) / 4, -xi * c, c * d / 2, -xi * d, -c * d / 2]
            by_eta = [a * (2 * eta + xi) / 4, b * (2 * eta - xi) / 4, b * (2 * eta + xi) / 4,
                      a * (2 * eta - xi) / 4, -a * b / 2, -eta * b, a * b / 2, -eta * a]

            def total(weights, axis):
                return sum(w * x[axis] for w, x in zip(weights, corners_and_middles))

            area = total(by_xi, 0) * total(by_eta, 1) - total(by_xi, 1) * total(by_eta, 0)
            yield total(value, 0), area


def evaluate(path, mesh):
    """Mean contact pressure: normal force over the deformed area of the tube's whole inner face [MPa].

    CalculiX does not print the normal force of this contact, but the tube's equilibrium gives it: its radial
    part is the hoop stress over the radius, summed over the tube, its axial part what the tube's ends carry.
    """
    found = tables(path)
    tube, calf = bodies(mesh)
    place = {}
    for node, u_r, u_z, _ in found["displacements"]:
        r, z = tube.nodes[node] if node in tube.nodes else calf.nodes[node]
        place[int(node)] = (r + u_r, z + u_z)
    axial = 180 * sum(row[2] for row in found["forces"])  # printed: of 2 degrees of the tube

    stress = {(int(row[0]), int(row[1])): row[2:] for row in found["stresses"]}
    radial = 0
    tan2 = math.tan(math.radians(1) / math.sqrt(3)) ** 2  # the points lie beside the plane of the mesh
    for number, nodes in tube.elements.items():
        for point, (radius, area) in enumerate(gauss_points([place[n] for n in nodes]), 1):
            xx = 0.5 * (stress[number, point][0] + stress[number, point + 4][0])
            zz = 0.5 * (stress[number, point][2] + stress[number, point + 4][2])
            hoop = (zz - xx * tan2) / (1 - tan2)
            radial += 2 * math.pi * area * hoop

    # The force along the mean normal, and what the slopes' scatter about it adds.
    area = slope = square = 0
    face = [place[n] for n in tube.column(0)]
    for k in range(0, len(face) - 1, 2):
        for x, weight in ((0.5 - math.sqrt(0.15), 5 / 18), (0.5, 8 / 18), (0.5 + math.sqrt(0.15), 5 / 18)):
            values = ((1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1))
            slopes = (4 * x - 3, 4 - 8 * x, 4 * x - 1)
            r, dr, dz = (sum(w * face[k + i][axis] for i, w in enumerate(weights))
                         for weights, axis in ((values, 0), (slopes, 0), (slopes, 1)))
            piece = weight * 2 * math.pi * r * math.hypot(dr, dz)
            area += piece
            slope += piece * math.atan2(dr, dz)
            square += piece * math.atan2(dr, dz) ** 2
    slope /= area
    scatter = square / area - slope**2
    return math.hypot(radial, axial) * (1 + 0.5 * scatter) / area
