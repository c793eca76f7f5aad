#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Where slices and sliding slices are wrong by 1, 3 and 10 %: segments of many tapers, stretches, heights, leg stiffnesses
and walls, at rest and under voltage, beside axisymmetric finite elements without and (at rest) with friction; and how good the
a-priori estimate of physics/model_error.hpp is. Needs numpy and matplotlib.

    model_map.py [-folder model_map] [-program build/bin/model_map] [-processes 2] [-draws 0]

Writes map.csv, with -draws also draws.csv, and the figures map.png and estimate.png into the folder; what is there already
is not solved again."""
import argparse
import csv
import os
import pathlib
import subprocess
import sys

import numpy as np

OUTPUTS = ["pressure_rest", "pressure_actuated", "actuation_drop", "volume_change"]
LEVELS = [1, 3, 10]  # per cent
TRUSTED = 5  # statuses below have numbers
SOURCE = pathlib.Path(__file__).resolve().parent.parent
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_NUM_THREADS": "1"}


def solve(program, processes, file, *words):
    """The rows of a study, each process its share of them."""
    if not file.exists():
        parts = [file.with_suffix(f".{k}.part") for k in range(processes)]
        runs = [subprocess.Popen([program, *map(str, words), "-part", str(k), "-parts", str(processes), "-output", str(part)],
                                 env=ENVIRONMENT) for k, part in enumerate(parts)]
        if any([run.wait() for run in runs]):
            sys.exit(f"{program} failed")
        lines = [part.read_text().splitlines() for part in parts]
        file.write_text("\n".join(lines[0][:1] + [line for own in lines for line in own[1:]]) + "\n")
        for part in parts:
            part.unlink()
    with open(file) as text:
        rows = list(csv.DictReader(text))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def error(data, model, output):
    """Relative, of a model against the finite elements; NaN where either has no answer."""
    with np.errstate(all="ignore"):
        value = data[f"{model}_{output}"] / data[f"axisym_{output}"] - 1
    good = (data["axisym_status"] < TRUSTED) & (data[f"{model}_status"] < TRUSTED)
    return np.where(good, value, np.nan)


def select(data, **values):
    chosen = np.ones(len(data["taper"]), bool)
    for name, value in {**PANEL, **values}.items():
        chosen &= np.isclose(data[name], value, rtol=1e-9, atol=1e-12)
    return chosen


PANEL = {"slenderness": 1, "compliance": 1, "wall": 0.025, "alpha": 0, "stiffness": 1, "voltage_part": 0}


def grid(data, chosen, values):
    """Tapers [degrees], stretches, and `values` of the chosen rows over both; NaN where there is no row."""
    tapers, stretches = np.round(np.degrees(data["taper"][chosen]), 6), data["stretch"][chosen]
    rows, columns = np.unique(tapers), np.unique(stretches)
    table = np.full((len(rows), len(columns)), np.nan)
    table[np.searchsorted(rows, tapers), np.searchsorted(columns, stretches)] = values[chosen]
    return rows, columns, table


def largest_taper(data, chosen, values, level):
    """Of each stretch: the taper up to which |values| stay below the level, between the tapers solved [degrees]; infinite
    where they all do, NaN where there is no answer before."""
    rows, columns, table = grid(data, chosen, 100 * np.abs(values))
    found = []
    for k in range(len(columns)):
        place = np.inf
        for before, after in zip(range(len(rows)), range(1, len(rows))):
            if np.isnan(table[after, k]):
                place = np.nan
                break
            if table[after, k] > level:  # grows with the square of the taper
                low, high = np.sqrt(table[before, k]), np.sqrt(table[after, k])
                place = rows[before] + (rows[after] - rows[before]) * (np.sqrt(level) - low) / (high - low)
                break
        found.append(place)
    return columns, found


def print_tapers(data, title, model, output, panels):
    print(f"\n{title}: taper in degrees up to which {output} is right within {LEVELS} %; x: no state before it is wrong\n")
    stretches = [s for s in np.unique(data["stretch"]) if s in (1.1, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2)]
    print("| | " + " | ".join(f"stretch {s:g}" for s in stretches) + " |\n|" + "---|" * (len(stretches) + 1))
    for label, values in panels:
        chosen = select(data, **values)
        found = [dict(zip(*largest_taper(data, chosen, error(data, model, output), level))) for level in LEVELS]
        cells = []
        for s in stretches:
            words = []
            for tapers in found:
                place = tapers.get(s, np.nan)
                words.append(f">{np.degrees(data['taper'][chosen].max()):.0f}" if place == np.inf
                             else "x" if np.isnan(place) else f"{place:.1f}")
            cells.append(" / ".join(words))
        print(f"| {label} | " + " | ".join(cells) + " |")


def panels_of(slender, legs):
    names = {1e-4: "rigid leg", 0.1: "leg 10 times stiffer", 1.0: "leg", 10.0: "leg 10 times softer"}
    return [(f"H/R {h:g}, {names[c]}", {"slenderness": h, "compliance": c}) for h in slender for c in legs]


def print_map(data):
    own = data["axisym_error_estimate"][data["axisym_status"] < TRUSTED]
    print(f"{len(data['taper'])} segments; the finite elements' own error of the pressures: median {np.nanmedian(own):.0e}, "
          f"95 % below {np.nanquantile(own, 0.95):.1e}")
    for model in ("slice", "sliding"):
        print_tapers(data, model, model, "pressure_rest", panels_of((0.3, 0.5, 1, 2, 5), (1,)) + panels_of((1,), (1e-4, 0.1, 10)) + [
            ("wall/R 0.005", {"wall": 0.005}), ("wall/R 0.05", {"wall": 0.05}), ("neo-Hookean", {"alpha": 2}),
            ("neo-Hookean, 10 times stiffer", {"alpha": 2, "stiffness": 10})])
    for part in (0.5, 0.8):
        for model in ("slice", "sliding"):
            print_tapers(data, f"{model} at {part:g} of the last stable voltage", model, "pressure_actuated",
                         [("H/R 1", {"voltage_part": part})])
            print_tapers(data, f"{model} at {part:g} of the last stable voltage", model, "actuation_drop",
                         [("H/R 1", {"voltage_part": part})])
    with np.errstate(all="ignore"):
        held = np.abs(data["slice_pressure_rest"] / data["held_pressure_rest"] - 1)
        held = held[(data["voltage_part"] == 0) & (data["held_status"] < 1) & (data["slice_status"] < 1)]
    print(f"\nslices against finite elements that are held along the leg: median {100 * np.median(held):.2f} %, 95 % below "
          f"{100 * np.quantile(held, 0.95):.1f} %, largest {100 * held.max():.1f} %")


def draw_map(data, file):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    slender, legs = (0.3, 1, 2, 5), ((1e-4, "rigid leg"), (1, "leg of the paper's ankle"), (10, "10 times softer leg"))
    figure, axes = plt.subplots(len(legs), len(slender), figsize=(14, 9), sharex=True, sharey=True, layout="constrained")
    for line, (compliance, name) in zip(axes, legs):
        for axis, height in zip(line, slender):
            chosen = select(data, slenderness=height, compliance=compliance)
            for model, color in (("slice", "tab:blue"), ("sliding", "tab:red")):
                tapers, stretches, table = grid(data, chosen, 100 * np.abs(error(data, model, "pressure_rest")))
                if np.nanmax(table) > LEVELS[0]:
                    lines = axis.contour(stretches, tapers, np.ma.masked_invalid(table), LEVELS, colors=color,
                                         linestyles=["dotted", "dashed", "solid"])
                    axis.clabel(lines, fmt="%g %%", fontsize=8)
            tapers, stretches, none = grid(data, chosen, data["axisym_status"] >= TRUSTED)
            axis.contourf(stretches, tapers, np.ma.masked_invalid(none), [0.5, 1.5], colors="0.85")
            axis.set_title(f"H/R {height:g}, {name}", fontsize=9)
            axis.set_ylim(0, 20)
    figure.supxlabel("stretch")
    figure.supylabel("taper [degrees]")
    figure.suptitle("Error of the mean pressure at rest against finite elements without friction: slices blue, sliding slices "
                    "red; grey: no stable state", fontsize=10)
    figure.savefig(file, dpi=130)


def print_estimates(data, title, file=None):
    """Estimated over true error, where the estimate claims to know."""
    figure = None
    if file:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        figure, axes = plt.subplots(2, len(OUTPUTS), figsize=(14, 6), sharex=True, layout="constrained")
    print(f"\n{title}: estimated over true error\n\n| model, output | known | of these without a state | true: median | "
          "estimate below true | median of the ratio | 5 % | 95 % |\n|---|---|---|---|---|---|---|---|")
    for line, model in enumerate(("slice", "sliding")):
        for column, output in enumerate(OUTPUTS):
            asked = (data["voltage_part"] > 0) if output in ("pressure_actuated", "actuation_drop") else data["voltage_part"] == 0
            known = asked & np.isfinite(data[f"{model}_{output}_model_error"])
            # Relative to the model, as estimates are.
            with np.errstate(all="ignore"):
                true = np.abs(data[f"axisym_{output}"] / data[f"{model}_{output}"] - 1)
                ratio = data[f"{model}_{output}_model_error"] / true
            lost = known & (data["axisym_status"] >= TRUSTED)
            good = known & np.isfinite(true)
            large = good & (true > 1e-4)
            print(f"| {model}, {output} | {known.sum()} of {asked.sum()} | {lost.sum()} | {100 * np.median(true[good]):.2f} % | "
                  f"{(ratio[large] < 1).sum()} of {good.sum()} | {np.median(ratio[large]):.2f} | "
                  f"{np.quantile(ratio[large], 0.05):.2f} | {np.quantile(ratio[large], 0.95):.1f} |")
            if figure:
                axes[line, column].hist(np.log10(ratio[large]), bins=np.linspace(-0.5, 2, 51))
                axes[line, column].axvline(0, color="k", linewidth=0.8)
                axes[line, column].set_title(f"{model}, {output}", fontsize=9)
    if figure:
        figure.supxlabel("log10 of estimated over true model error")
        figure.savefig(file, dpi=130)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-folder", type=pathlib.Path, default=pathlib.Path("model_map"))
    parser.add_argument("-program", default=str(SOURCE / "build" / "bin" / "model_map"))
    parser.add_argument("-processes", type=int, default=2)
    parser.add_argument("-draws", type=int, default=0, help="random segments more, for the histogram of the estimate")
    parser.add_argument("-first", type=int, default=16384, help="of the Sobol sequence")
    chosen = parser.parse_args()
    chosen.folder.mkdir(parents=True, exist_ok=True)
    data = solve(chosen.program, chosen.processes, chosen.folder / "map.csv")
    print_map(data)
    draw_map(data, chosen.folder / "map.png")
    print_estimates(data, "map")
    if chosen.draws > 0:
        drawn = solve(chosen.program, chosen.processes, chosen.folder / "draws.csv", "-draws", chosen.draws, "-first", chosen.first)
        print_estimates(drawn, f"{chosen.draws} random segments", chosen.folder / "estimate.png")


if __name__ == "__main__":
    main()
