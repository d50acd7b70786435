# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse-grained fields of a granular run, of fields-NAME.csv: profiles along one axis, or slices at several times."""
import glob
import os

import matplotlib.ticker
import numpy

import drawing
import options
from drawing import Line2D, axis, lines_below, plt

QUANTITIES = ["volume_fraction", "velocity", "pressure", "shear", "temperature"]
MOST_TIMES = 4
LEAST = 0.01  # of the largest density; maps show no values below


class Fields:
    """The columns of a table as arrays with the axes t, z, y, x"""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            names = file.readline().strip().split(",")
            try:
                table = numpy.loadtxt(file, delimiter=",", ndmin=2)
            except ValueError as error:
                drawing.stop(options.DAMAGED, f"{path}: is not a table of numbers: {error}")
        if table.size > 0 and table.shape[1] != len(names):
            drawing.stop(options.DAMAGED, f"{path}:1: must have the names of {table.shape[1]} columns, got {len(names)}")
        self.empty = table.size == 0
        if self.empty:
            return
        column = dict(zip(names, table.T))
        self.t = numpy.unique(column["t"])
        self.axes = {a: numpy.unique(column[a]) for a in "xyz"}
        shape = [len(self.t)] + [len(self.axes[a]) for a in "zyx"]
        self.column = {name: values.reshape(shape) for name, values in column.items()}

    def stress(self, component):
        return self.column["kinetic_stress_" + component] + self.column["contact_stress_" + component]

    def of(self, quantity):
        """The curves of a quantity: labels and arrays"""
        if quantity == "volume_fraction":
            return {"": self.column["volume_fraction"]}
        if quantity == "velocity":
            present = self.column["density"] > 0
            return {a: numpy.where(present, self.column["velocity_" + a], numpy.nan) for a in "xyz"}
        if quantity == "pressure":
            return {a + a: self.stress(a + a) for a in "xyz"}
        if quantity == "shear":
            return {a + b: self.stress(a + b) for a, b in ("xy", "yz", "zx")}
        density = numpy.where(self.column["density"] > 0, self.column["density"], numpy.nan)
        return {"": sum(self.column[f"kinetic_stress_{a}{a}"] for a in "xyz") / (3 * density)}

    def map_of(self, quantity):
        """One array for a map, and the label of its colours"""
        values = self.of(quantity)
        if quantity == "velocity":
            return numpy.sqrt(sum(v ** 2 for v in values.values())), "speed [m/s]"
        if quantity == "pressure":
            return sum(values.values()) / 3, "pressure [Pa]"
        if quantity == "shear":
            return numpy.sqrt(sum(v ** 2 for v in values.values())), "shear stress [Pa]"
        return values[""], LABELS[quantity]

    def times(self):
        """Indices of at most MOST_TIMES times, the last one among them"""
        return sorted({round(k) for k in numpy.linspace(0, len(self.t) - 1, min(MOST_TIMES, len(self.t)))})


LABELS = {"volume_fraction": "volume fraction", "velocity": "velocity [m/s]", "pressure": "normal stress [Pa]",
          "shear": "shear stress [Pa]", "temperature": "velocity variance [m²/s²]"}


def nonzero(values):
    return bool(numpy.any(numpy.nan_to_num(values) != 0))


def profile(fields, along, quantities):
    """Curves along the axis with several cells: colours for the times, dashes for the components"""
    names = [q for q in quantities if any(nonzero(v) for v in fields.of(q).values())]
    upright = along == "z"
    figure, all_axes = plt.subplots(1, len(names), figsize=(min(11, max(6, 2.9 * len(names))), 4), squeeze=False,
                                    sharey=upright)
    at = fields.axes[along]
    colours = plt.get_cmap("viridis")
    times = fields.times()
    for quantity, axes in zip(names, all_axes.flat):
        for dash, (component, values) in zip(("-", "--", ":"), fields.of(quantity).items()):
            if not nonzero(values):
                continue
            for k, n in enumerate(times):
                curve = values[n].reshape(-1)
                line = (curve, at) if upright else (at, curve)
                axes.plot(*line, dash, color=colours(0.9 * k / max(1, len(times) - 1)), lw=1.2,
                          label=component if k == len(times) - 1 and component else None)
        if quantity in ("velocity", "pressure", "shear"):
            axes.legend(frameon=False, fontsize=9)
        labels = (LABELS[quantity], f"${along}$ [m]" if not upright or axes is all_axes[0, 0] else "")
        axis(axes, *(labels if upright else reversed(labels)))
        axes.locator_params(axis="x", nbins=3)
    return figure


def slices(fields, quantities):
    """Maps over two axes, a line of panels for each time; of three axes with several cells the middle of the shortest one"""
    cells = {a: len(fields.axes[a]) for a in "xyz"}
    across = min("yxz", key=lambda a: cells[a])  # not shown
    horizontal, vertical = [a for a in "xyz" if a != across]
    middle = cells[across] // 2
    index = tuple({across: middle}.get(a, slice(None)) for a in "zyx")
    names = [q for q in quantities if nonzero(fields.map_of(q)[0])]
    times = fields.times()
    figure, all_axes = plt.subplots(len(times), len(names), squeeze=False, sharex=True, sharey=True,
                                    figsize=size_of_slices(fields, horizontal, vertical, len(times), len(names)))
    density = fields.column["density"]
    for k, quantity in enumerate(names):
        values, label = fields.map_of(quantity)
        values = numpy.where(density > LEAST * density.max(), values, numpy.nan)[(times, *index)]
        for axes, n, at_time in zip(all_axes[:, k], times, values):
            shade = axes.pcolormesh(fields.axes[horizontal], fields.axes[vertical], at_time, shading="nearest", cmap="viridis",
                                    vmin=min(0, numpy.nanmin(values)), vmax=numpy.nanmax(values), rasterized=True)
            if quantity == "velocity":
                arrows(axes, fields, (n, *index), horizontal, vertical, numpy.nanmax(values))
            axes.set_aspect("equal")
            axes.locator_params(axis="x", nbins=3)
            axis(axes, f"${horizontal}$ [m]" if n == times[-1] else "",
                 f"$t$ = {fields.t[n]:.4g} s\n${vertical}$ [m]" if k == 0 else "")
            axes.grid(False)
        bar = figure.colorbar(shade, cax=all_axes[0, k].inset_axes([0, 1.06, 1, 0.06]), orientation="horizontal")
        bar.set_label(label.replace(" [", "\n["), fontsize=9)
        bar.formatter = matplotlib.ticker.FormatStrFormatter("%g")
        bar.ax.locator_params(nbins=2)
        bar.ax.xaxis.set_ticks_position("top")
        bar.ax.xaxis.set_label_position("top")
    if cells[across] > 1:
        figure.suptitle(f"slices at {across} = {fields.axes[across][middle]:.4g} m", fontsize=10)
    return figure


def size_of_slices(fields, horizontal, vertical, lines, columns):
    """Width and height of a figure at most 11 inches wide and high, for panels with equal scales"""
    wide, high = (numpy.ptp(fields.axes[a]) * (1 + 1 / len(fields.axes[a])) for a in (horizontal, vertical))
    panel = min(10 / columns - 0.4, (9.5 / lines - 0.3) * wide / high, 4)
    return max(4, columns * (panel + 0.4) + 1), lines * (panel * high / wide + 0.3) + 1.5


def arrows(axes, fields, index, horizontal, vertical, fastest):
    """The velocity in the plane, about 20 × 20 arrows; that of the largest speed has a tenth of the width of the panel"""
    parts = [fields.of("velocity")[a][index] for a in (horizontal, vertical)]
    thin = tuple(slice(max(1, size // 20) // 2, None, max(1, size // 20)) for size in parts[0].shape)
    axes.quiver(fields.axes[horizontal][thin[1]], fields.axes[vertical][thin[0]], parts[0][thin], parts[1][thin],
                color="w", width=6e-3, scale=10 * fastest or None, scale_units="width")


def draw_all(folder, quantities):
    """Writes a figure for each table fields-NAME.csv."""
    quantities = [q for q in QUANTITIES if q in quantities]
    for path in sorted(glob.glob(os.path.join(glob.escape(folder), "fields-*.csv"))):
        fields = Fields(path)
        if fields.empty or not any(nonzero(v) for q in quantities for v in fields.of(q).values()):
            continue
        several = [a for a in "xyz" if len(fields.axes[a]) > 1]
        figure = profile(fields, (several or ["z"])[0], quantities) if len(several) < 2 else slices(fields, quantities)
        below = times_below(figure, fields) if len(several) < 2 else 0.0
        drawing.save(figure, folder, os.path.basename(path).replace(".csv", ".png"), below, top=0.97 if figure._suptitle else 1)
        options.leave_out([])


def times_below(figure, fields):
    times = fields.times()
    colours = plt.get_cmap("viridis")
    return lines_below(figure, [Line2D([], [], color=colours(0.9 * k / max(1, len(times) - 1)), label=f"$t$ = {fields.t[n]:.4g} s")
                                for k, n in enumerate(times)])
