# SPDX-License-Identifier: BSD-2-Clause
"""An archive as one HTML page, whole in itself: numbers, figures, options. Part of the program, which runs it as
python3 - ARCHIVE PAGE with this text on its standard input."""
import base64
import html
import io
import sys

import h5py
import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

MMHG = 133.322387415  # [Pa]
MOST_POINTS = 20000  # cases that are drawn; of more, evenly many
MOST_ROWS = 60  # of a table
MOST_SEGMENTS = 12  # in figures and tables
PER_CASE = {"case", "wall_time", "rung", "true_error", "segment_time"}  # what is not a swept option
RESULTS = {"pressure_rest": "pressure at rest (kPa)", "pressure_actuated": "pressure under voltage (kPa)",
           "actuation_drop": "drop by the voltage (kPa)", "volume_change": "volume change"}
LESS_SOLVED = {"_single": "single precision", "_newton_": "Newton stopped early", "_fixed_point": "fixed point"}
STYLE = ("body{font:15px/1.5 sans-serif;max-width:62em;margin:2em auto;padding:0 1em}table{border-collapse:collapse}"
         "td,th{padding:.15em .7em;text-align:right;border-bottom:1px solid #ddd}td:first-child,th:first-child"
         "{text-align:left}img{max-width:100%}pre{overflow:auto;background:#f6f6f6;padding:1em}")


def words_of(variable):
    """The words of a CF enumeration, by their value."""
    return dict(zip(np.atleast_1d(variable.attrs["flag_values"]).tolist(), variable.attrs["flag_meanings"].split()))


def table(head, rows):
    cells = "".join("<tr>" + "".join(f"<td>{html.escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{''.join(f'<th>{html.escape(name)}</th>' for name in head)}</tr>{cells}</table>"


def figure(drawing, caption):
    image = io.BytesIO()
    drawing.savefig(image, format="png", dpi=130, bbox_inches="tight")
    plt.close(drawing)
    data = base64.b64encode(image.getvalue()).decode()
    return f'<figure><img alt="{html.escape(caption)}" src="data:image/png;base64,{data}">' \
           f"<figcaption>{html.escape(caption)}</figcaption></figure>"


class Report:
    """The parts of the page, in order, from an open archive."""

    def __init__(self, file):
        self.file = file
        self.cases = file["status"].shape[0]
        self.segments = [name.decode() for name in file["segment"][:MOST_SEGMENTS]]
        self.step = max(1, -(-self.cases // MOST_POINTS))
        self.results = [name for name in RESULTS if name in file]
        self.swept = [name for name, data in file.items()
                      if data.ndim == 1 and name not in PER_CASE | {"segment"} and data.shape[0] == self.cases]

    def values(self, name):
        """Of the cases that are drawn."""
        data = self.file[name][::self.step]
        return data / 1000 if self.file[name].attrs.get("units") == "Pa" and name in RESULTS else data

    def parts(self):
        yield "Results", self.status()
        if "rung" in self.file:
            yield "Error and cost", self.error_and_cost()
        elif self.cases <= MOST_ROWS // len(self.segments) or self.cases == 1:
            yield "Segments", self.segment_table()
        if self.cases == 1:
            yield "Pressures", self.bars()
        elif "rung" not in self.file:
            for name in self.results:
                yield RESULTS[name], self.against_swept(name)
            yield "Over all designs", self.distribution()
        yield "How it was made", self.origin()

    def status(self):
        status, words = self.file["status"], words_of(self.file["status"])
        count = {}
        for first in range(0, self.cases, 1 << 16):
            for value, times in zip(*np.unique(status[first:first + (1 << 16)], return_counts=True)):
                count[value] = count.get(value, 0) + times
        segments = status.shape[1]
        text = f"<p>{self.cases} designs of {segments} segments" + \
               (f"; figures show every {self.step}th design" if self.step > 1 else "") + \
               (f"; of the segments the first {MOST_SEGMENTS} are shown" if segments > MOST_SEGMENTS else "") + \
               (". <b>The run has not ended.</b>" if "incomplete" in self.file.attrs else "") + "</p>"
        return text + table(["status", "segments"], [(words[value], times) for value, times in sorted(count.items())])

    def segment_table(self):
        status, rows = words_of(self.file["status"]), []
        for case in range(self.cases):
            for i, segment in enumerate(self.segments):
                design = [f"{self.file[name][case]:.6g}" for name in self.swept]
                shown = [self.file[name][case, i] for name in self.results]
                shown = [f"{x / 1000:.4f} ({x / MMHG:.2f})" if self.file[name].attrs["units"] == "Pa" else f"{x:.5f}"
                         for name, x in zip(self.results, shown)]
                error = f"{self.file['error_estimate'][case, i]:.1e}" if "error_estimate" in self.file else ""
                rows.append([segment, *design, *shown, *self.planned(case, i), error,
                             status[self.file["status"][case, i]]])
        head = [name.replace("_", " ") + (" kPa (mmHg)" if self.file[name].attrs["units"] == "Pa" else "")
                for name in self.results]
        plan = ["model", "expected error of discretisation", "of the model", "expected time (us)"]
        return table(["segment", *self.swept, *head, *plan[:len(self.planned(0, 0))], "estimated error", "status"], rows)

    def planned(self, case, i):
        """What -fidelity auto took of a segment and expected of it; nothing in other archives."""
        if not {"planned_discretisation_error", "planned_model_error", "planned_cost", "fidelity"} <= set(self.file):
            return []
        error = [self.file[f"planned_{name}_error"][case, i] for name in ("discretisation", "model")]
        return [words_of(self.file["fidelity"])[self.file["fidelity"][case, i]],
                *("when solved" if np.isnan(x) else f"{x:.1e}" for x in error),
                f"{1e6 * self.file['planned_cost'][case, i]:.3g}"]

    def bars(self):
        names = [name for name in ("pressure_rest_rigid", "pressure_rest", "pressure_actuated") if name in self.file]
        if not names:
            return ""
        drawing, axes = plt.subplots(figsize=(7, 3))
        place = np.arange(len(self.segments))
        for i, name in enumerate(names):
            axes.bar(place + 0.27 * (i - 1), self.file[name][0, :MOST_SEGMENTS] / 1000, 0.25, label=name.replace("_", " "))
        axes.set(xticks=place, xticklabels=self.segments, ylabel="kPa")
        axes.legend()
        return figure(drawing, "Pressure on each segment, mean over its height, ankle first")

    def against_swept(self, name):
        values = self.values(name)
        if len(self.swept) == 2 and self.is_grid():
            return self.maps(name, values)
        drawing, axes = plt.subplots(1, len(self.swept), figsize=(4 * len(self.swept), 3.2), squeeze=False, sharey=True)
        for ax, option in zip(axes[0], self.swept):
            for i, segment in enumerate(self.segments):
                ax.plot(self.values(option), values[:, i], ".", ms=2 if len(values) > 300 else 5, label=segment,
                        rasterized=True)
            ax.set(xlabel=f"{option} ({self.file[option].attrs['units']})")
            ax.locator_params(axis="x", nbins=4)
        axes[0, 0].set(ylabel=RESULTS[name])
        axes[0, -1].legend(fontsize="small", markerscale=3)
        return figure(drawing, f"{RESULTS[name]} against what was swept")

    def is_grid(self):
        x, y = (np.unique(self.file[name][:]) for name in self.swept)
        return self.step == 1 and min(x.size, y.size) > 2 and x.size * y.size == self.cases

    def maps(self, name, values):
        first, second = self.swept
        x, y = np.unique(self.file[first][:]), np.unique(self.file[second][:])
        order = np.lexsort((self.file[second][:], self.file[first][:]))
        columns = min(3, len(self.segments))
        rows = -(-len(self.segments) // columns)
        drawing, axes = plt.subplots(rows, columns, figsize=(3.6 * columns, 3 * rows), squeeze=False, sharex=True,
                                     sharey=True, layout="constrained")
        for ax in axes.flat[len(self.segments):]:
            ax.axis("off")
        for i, (ax, segment) in enumerate(zip(axes.flat, self.segments)):
            shown = ax.contourf(x, y, values[order, i].reshape(x.size, y.size).T, 12)
            drawing.colorbar(shown, ax=ax)
            ax.set(title=segment, xlabel=f"{first} ({self.file[first].attrs['units']})",
                   ylabel=f"{second} ({self.file[second].attrs['units']})")
        return figure(drawing, f"{RESULTS[name]} over {first} and {second}")

    def distribution(self):
        drawing, axes = plt.subplots(1, len(self.results), figsize=(3.6 * len(self.results), 2.8), squeeze=False)
        rows = []
        for ax, name in zip(axes[0], self.results):
            values = self.values(name)
            for i, segment in enumerate(self.segments):
                some = values[np.isfinite(values[:, i]), i]
                if some.size == 0:
                    continue
                ax.hist(some, bins=60, histtype="step", label=segment)
                rows.append([RESULTS[name], segment, *(f"{x:.4g}" for x in np.percentile(some, [0, 5, 50, 95, 100]))])
            ax.set(xlabel=RESULTS[name], yticks=[])
        axes[0, -1].legend(fontsize="small")
        return figure(drawing, "How often each value occurs") + \
            table(["result", "segment", "least", "5 %", "median", "95 %", "most"], rows)

    def error_and_cost(self):
        names = words_of(self.file["rung"])
        rungs = [names[value] for value in self.file["rung"][:]]
        cost, unknowns, error = self.file["segment_time"][:], self.file["unknowns"][:].mean(1), self.file["true_error"][:]
        trusted = self.file["status"][:] < next(value for value, word in words_of(self.file["status"]).items()
                                                if word == "no_equilibrium")
        estimate = np.fmax.reduce(np.where(trusted, self.file["error_estimate"][:], np.nan), axis=1)
        shown = np.isfinite(error) & (error > 0)
        best, front = np.inf, []
        for i in np.argsort(cost):
            if shown[i] and error[i] < best:
                best = error[i]
                front.append(i)
        drawing, axes = plt.subplots(figsize=(9, 6))
        axes.loglog(cost[front], error[front], "-", color="0.8", lw=4, label="Pareto front", drawstyle="steps-post")
        models = [self.kind(name) for name in rungs]
        for model in dict.fromkeys(model for model, is_shown in zip(models, shown) if is_shown):
            mask = shown & (np.array(models) == model)
            axes.loglog(cost[mask], error[mask], "*" if model == "auto" else "o", ms=11 if model == "auto" else 6,
                        label=f"{model}, true error")
        axes.loglog(cost[shown], estimate[shown], "_", color="0.4", label="estimated error")
        for i in np.flatnonzero(shown):
            if i in front or models[i] in ("auto", *LESS_SOLVED.values()):
                axes.annotate(rungs[i], (cost[i], error[i]), fontsize=7, xytext=(4, 5), textcoords="offset points",
                              rotation=20)
        axes.set(xlabel="time of a segment (s)", ylabel="relative error")
        axes.grid(alpha=0.3)
        axes.legend()
        own = np.fmax.reduce(np.where(trusted, self.file["discretisation_error"][:], np.nan), axis=1)
        rows = [[name, f"{error[i]:.1e}", f"{estimate[i]:.1e}", f"{own[i]:.1e}", f"{unknowns[i]:.0f}", f"{cost[i]:.2e}",
                 "yes" if i in front else "", self.taken(i) if models[i] == "auto" else ""]
                for i, name in enumerate(rungs)]
        return figure(drawing, "Error of each rung against the finest, and what it costs") + \
            table(["rung", "true error", "estimated", "own part", "unknowns", "s a segment", "on the front", "taken by auto"], rows)

    def kind(self, rung):
        """What the rungs of one colour have in common."""
        for word, kind in LESS_SOLVED.items():
            if word in rung:
                return kind
        return rung.split("_")[0].replace("first", "first order")

    def taken(self, case):
        """The models and resolutions of the segments that were solved, each once."""
        words, names = words_of(self.file["fidelity"]), ("fidelity", "slices_used", "wall_points_used", "planned_cost")
        rows = zip(*(self.file[name][case] for name in names))
        return ", ".join(dict.fromkeys(f"{words[model]} {slices} x {points}" if slices else words[model]
                                       for model, slices, points, planned in rows if np.isfinite(planned)))

    def origin(self):
        rows = [(name, self.file.attrs[name]) for name in ("command", "created", "ranks", "gaiter_version",
                                                           "petsc_version") if name in self.file.attrs]
        return table(["", ""], rows) + f"<pre>{html.escape(str(self.file.attrs['options']))}</pre>"


def main():
    archive, page = sys.argv[1:]
    with h5py.File(archive) as file:
        parts = "".join(f"<h2>{html.escape(title)}</h2>{text}" for title, text in Report(file).parts())
    text = f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{html.escape(archive)}</title>' \
           f"<style>{STYLE}</style><h1>{html.escape(archive)}</h1>{parts}</html>\n"
    with open(page, "w", encoding="utf-8") as out:
        out.write(text)


if __name__ == "__main__":
    main()
