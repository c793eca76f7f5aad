# SPDX-License-Identifier: BSD-2-Clause
"""The peer: Newton's method on the same two equations of each slice in vectorised NumPy, on one core, against Gaiter. The
same designs of the paper's leg, starting values and accuracy; its pressures are checked against Gaiter's archive to
1e-9. By processor time, which other users of the machine disturb less. python3 numpy_newton.py [GAITER]"""
import re
import shutil
import statistics
import subprocess
import time

import h5py
import numpy as np

from sweep_runs import ENVIRONMENT, GAITER, STRETCH_AND_VOLTAGE, Sweep, print_load, spread

DESIGNS, REPETITIONS, SLICES, WALL_POINTS = 40_000, 5, 6, 3
BLOCKS = {"a segment at a time": 10**9, "20,000 at a time": 20_000}  # slices; of these, temporaries stay in the cache
LEG = [(35.85, 43.37, 0.013392, 7.898e-5, -0.01600, -0.001137), (43.37, 49.95, 0.009989, 4.967e-5, -0.01465, -0.001386),
       (49.95, 55.59, 0.008678, 7.532e-5, -0.00913, -0.000828), (55.59, 60.17, 0.01373, 3.492e-5, -0.01686, -0.001133),
       (60.17, 62.35, 0.01188, 5.511e-5, -0.01466, -0.001392), (62.35, 63.15, 0.012223, 2.731e-5, -0.01513, -0.001263)]
THICKNESS, MU, ALPHA = 1e-3, (21193.0, 10.514), (3.507, 12.147)
PERMITTIVITY = 8.8541878128e-12 * 7.41
STEP = 1e-7  # of the pressure: Newton doubles the digits, so that the next one is below 1e-13


def rule(points):
    nodes, weights = np.polynomial.legendre.leggauss(points)
    return 0.5 * (nodes + 1), 0.5 * weights


class Slices:
    """Many slices of one segment: radius of the leg and reference radii of the bandage [m], voltage squared."""

    def __init__(self, segment, leg_radius, outer, voltage):
        self.a, self.b, self.c, self.d = segment[2:]
        self.leg, self.outer, self.inner = leg_radius, outer, outer - THICKNESS
        self.area = (self.outer - self.inner) * (self.outer + self.inner)
        self.drive = 2 * PERMITTIVITY * voltage**2
        self.log_wall = np.log(self.outer / self.inner)
        nodes, self.weights = rule(WALL_POINTS)
        self.inverse_squares = [np.exp(-2 * node * self.log_wall) / self.inner**2 for node in nodes]

    def bandage(self, radius, energised):
        """Pressure of the bandage [Pa] and its derivative by the radius."""
        swell = (radius - self.inner) * (radius + self.inner)
        pressure, slope = np.zeros_like(radius), np.zeros_like(radius)
        for weight, inverse_square in zip(self.weights, self.inverse_squares):
            excess = swell * inverse_square  # lambda^2 - 1
            log_stretch = np.log1p(excess)
            inverse = 1 / (1 + excess)
            stress, stress_slope = 0, 0
            for mu, alpha in zip(MU, ALPHA):
                power = np.exp(0.5 * alpha * log_stretch)
                reciprocal = 1 / power
                sine = power - reciprocal
                stress = stress + mu * sine
                stress_slope = stress_slope + mu * (0.5 * alpha * (power + reciprocal) - sine)
            share = weight * inverse
            pressure += share * stress
            slope += share * inverse * inverse_square * stress_slope
        pressure *= self.log_wall
        slope *= 2 * self.log_wall * radius
        if energised:
            inside = radius * radius
            outside = inside + self.area
            log = np.log1p(self.area / inside)
            maxwell = self.drive * self.area / (inside * outside * log * log)
            pressure -= maxwell
            slope -= 2 * radius * maxwell * (2 * self.area / (inside * outside * log) - 1 / inside - 1 / outside)
        return pressure, slope

    def strain(self, pressure):
        growth, decay = self.a * np.exp(self.b * pressure), self.c * np.exp(self.d * pressure)
        return growth + decay, self.b * growth + self.d * decay

    def start(self):
        """From the rigid leg, one step with the bandage as a power law of the radius; as Gaiter starts."""
        rigid, slope = self.bandage(self.leg, False)
        strain, strain_slope = self.strain(rigid)
        k = self.leg * slope / rigid
        pressure = rigid - rigid * k * strain / (1 + rigid * k * strain_slope)
        return self.leg * (1 - strain - strain_slope * (pressure - rigid)), pressure

    def solve(self, radius, pressure, energised):
        for _ in range(20):
            strain, strain_slope = self.strain(pressure)
            bandage, slope = self.bandage(radius, energised)
            leg_residual, bandage_residual = radius - self.leg * (1 - strain), pressure - bandage
            compliance = self.leg * strain_slope
            step = -(bandage_residual + slope * leg_residual) / (1 + compliance * slope)
            radius = radius - leg_residual - compliance * step
            pressure = pressure + step
            if np.max(np.abs(step) / pressure) < STEP:
                return radius, pressure
        raise ArithmeticError("Newton's method does not converge")


def solve_all(stretch, voltage, block_slices):
    """Mean pressures at rest and under voltage [Pa], designs x segments."""
    heights, weights = rule(SLICES)
    means = np.empty((2, stretch.size, len(LEG)))
    designs = block_slices // SLICES
    for s, segment in enumerate(LEG):
        low, high = 1e-3 * segment[0], 1e-3 * segment[1]
        for first in range(0, stretch.size, designs):
            block = slice(first, first + designs)
            count = stretch[block].size
            slices = Slices(segment, np.tile(low + (high - low) * heights, count),
                            np.repeat(0.5 * (low + high) / stretch[block], SLICES), np.repeat(voltage[block], SLICES))
            state = slices.solve(*slices.start(), False)
            means[0, block, s] = state[1].reshape(count, SLICES) @ weights
            means[1, block, s] = slices.solve(*state, True)[1].reshape(count, SLICES) @ weights
    return means


def solver_rate():
    """Equilibria a second of processor time of Gaiter's solver by itself, starting values included: slices of the ankle
    at rest whose constants are at hand, 8192 at a time."""
    command = [GAITER.parent / "slice_throughput", "--benchmark_filter=batched_snes/8192", "--benchmark_repetitions=1",
               "--benchmark_report_aggregates_only=false", "--benchmark_color=false", "--benchmark_min_time=0.3"]
    text = subprocess.run(command, env=ENVIRONMENT, check=True, capture_output=True, text=True).stdout
    found = re.search(r"batched_snes/8192.*?([.\d]+)M/s", text)
    return 1e6 * float(found[1])


def main():
    print_load("before")
    words = [*STRETCH_AND_VOLTAGE, "-slice_count", SLICES, "-wall_points", WALL_POINTS, "-sweep_samples", DESIGNS]
    equilibria = 2 * SLICES * len(LEG) * DESIGNS
    rates = {f"NumPy, {name}": [] for name in BLOCKS}
    rates.update({"Gaiter's solver": [], "Gaiter's sweep without its archive": [], "Gaiter's sweep": []})
    for _ in range(REPETITIONS):
        sweep = Sweep(1, *words, keep=True)
        with h5py.File(sweep.file) as file:
            stretch, voltage = file["bandage_stretch"][:], file["voltage"][:]
            expected = np.stack([file["pressure_rest"][:], file["pressure_actuated"][:]])
        shutil.rmtree(sweep.file.parent)
        for name, block in BLOCKS.items():
            start = time.process_time()
            found = solve_all(stretch, voltage, block)
            rates[f"NumPy, {name}"].append(equilibria / (time.process_time() - start))
            error = np.max(np.abs(found / expected - 1))
            if not error < 1e-9:
                raise SystemExit(f"the two do not solve the same equations: their pressures differ by {error:.1e}")
        processor = sweep.said["processor"]
        rates["Gaiter's solver"].append(solver_rate())
        rates["Gaiter's sweep"].append(equilibria / processor)
        rates["Gaiter's sweep without its archive"].append(
            equilibria / (processor * (1 - sweep.said["archive_processor_percent"] / 100)))
    print_load("after")
    print(f"mean pressures differ by at most {error:.1e}; medians of {REPETITIONS} runs, {equilibria / 1e6:.2f} million "
          f"equilibria at rest and under voltage\n{'':36} {'equilibria/s':>12} {'noise':>6}  "
          + "  ".join(f"times {name}" for name in list(rates)[:len(BLOCKS)]))
    against = [statistics.median(rates[name]) for name in list(rates)[:len(BLOCKS)]]
    for name, found in rates.items():
        middle, noise = spread(found)
        print(f"{name:36} {middle:12.3g} {noise:6.0%}  " + "  ".join(f"{middle / peer:10.1f}" for peer in against))


if __name__ == "__main__":
    main()
