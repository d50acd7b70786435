#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""CPU time for a given accuracy over the stiffness and the damping of a strut.

    stiffness.py DIR       reads DIR/times.csv, writes DIR/stiffness.png
"""
from drawing import axis, by_scheme, directory, distinct, legend, number, plt, read, save, shown


def draw(folder):
    rows = read(folder, "times.csv")
    reached = [row for row in rows if row["cpu_seconds_needed"]]
    accuracies = sorted(distinct(reached or rows, "accuracy"), key=number, reverse=True)
    stiff = max((row["k"] for row in rows if number(row["c"]) > 0), key=number)
    sweeps = [("c = 0", "stiffness k [N/m]", "k", [row for row in rows if number(row["c"]) == 0]),
              (f"k = {number(stiff):.0e} N/m", "damping c [N s/m]", "c", [row for row in rows if row["k"] == stiff])]
    figure, panels = plt.subplots(len(accuracies), 2, figsize=(9.6, 3.1 * len(accuracies) + 1), sharey="row", squeeze=False)
    for row_of_axes, accuracy in zip(panels, accuracies):
        for axes, (fixed, label, column, of) in zip(row_of_axes, sweeps):
            values = sorted(distinct(of, column), key=number)
            for _, mine, look in by_scheme([row for row in of if row["accuracy"] == accuracy]):
                points = [(values.index(row[column]), 1e3 * number(row["cpu_seconds_needed"])) for row in mine]
                axes.semilogy([x for x, _ in points], [y for _, y in points], "-", lw=1.2, ms=5, **look)
            axes.set_xticks(range(len(values)), [f"{number(value):.0e}" if number(value) else "0" for value in values],
                            fontsize=8)
            axis(axes, label, title=f"{fixed}, rms error {number(accuracy):.0e} m")
        row_of_axes[0].set_ylabel("CPU time [ms]")
    save(figure, folder, "stiffness.png", legend(figure, shown(distinct(rows, "integrator")), columns=4), top=1)


draw(directory())
