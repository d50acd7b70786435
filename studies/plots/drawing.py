# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions shared by the figures: reading tables, and the same colour and marker for a scheme in all figures."""
import csv
import json
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

DASHES = ["-", "--", ":", "-."]
# distinguishable with red-green colour blindness
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6bb1"]
MARKERS = "osD^vP*X"
STYLES = {
    "rA-full-1": ("#d55e00", "s"), "rA-full-1-exact": ("#f4a582", "D"),
    "rA-half-1": ("#0072b2", "o"), "rA-half-1-kick": ("#56b4e9", "^"),
    "rA-half-1-momentum": ("#332288", ">"),
    "rA-half-2": ("#009e73", "v"), "rA-half-2-bdf2": ("#66c2a5", "<"),
    "rA-genalpha": ("#cc79a7", "P"), "rA-rattle": ("#8c6bb1", "X"), "rA-rkmk-4": ("#e69f00", "*"),
    "ida-rp": ("#000000", "h"), "ida-rp-baumgarte": ("#444444", "H"), "ida-rp-index1": ("#888888", "8"),
    "evolving": ("#0072b2", "o"), "evolving, KLU": ("#56b4e9", "^"), "evolving, text": ("#332288", "d"),
    "DVI": ("#d55e00", "s"), "DVI, not stabilised": ("#e69f00", "v"), "DVI, text": ("#cc79a7", "<"), "DEM": ("#009e73", "P"),
    "rp-full-1": ("#a6611a", "s"), "rp-bdf2": ("#dfc27d", "D"),
    "rp-half-1": ("#7f7f7f", "o"), "rp-half-1-kick": ("#b0b0b0", "^"),
    "reps-half-1": ("#4d4d4d", "p"), "reps-half-1-kick": ("#969696", ">"),
}


def style(scheme, others=()):
    """Colour and marker of a scheme; a scheme without an entry in STYLES gets them by its position in `others`"""
    if scheme in STYLES:
        return STYLES[scheme]
    unknown = [name for name in others if name not in STYLES]
    k = unknown.index(scheme) if scheme in unknown else 0
    return COLOURS[-1 - k % len(COLOURS)], MARKERS[-1 - k % len(MARKERS)]


def directory():
    """The result directory, the only argument of a script"""
    if len(sys.argv) != 2:
        sys.exit(sys.modules["__main__"].__doc__)
    return sys.argv[1]


def read(*path):
    """The rows of a CSV file as dictionaries of strings"""
    with open(os.path.join(*path), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def record(folder):
    """The contents of study.json of the result directory; empty if there is no such file"""
    try:
        with open(os.path.join(folder, "study.json"), encoding="utf-8") as file:
            return json.load(file)
    except FileNotFoundError:
        return {}


def distinct(rows, column):
    """The distinct values of a column, in order of first occurrence"""
    return list(dict.fromkeys(row[column] for row in rows))


def where(rows, **values):
    """The rows whose columns have these values"""
    return [row for row in rows if all(row[column] == value for column, value in values.items())]


def number(text):
    """The number in a field; NaN for an empty field"""
    return float(text) if text else float("nan")


def numbers(rows, column):
    """The numbers of a column"""
    return [number(row[column]) for row in rows]


def width(scheme, schemes, thinnest=1.0, thickest=3.2):
    """Line width of a scheme; earlier schemes have wider lines, so that coinciding curves are visible"""
    if len(schemes) < 2:
        return thinnest
    return thickest - (thickest - thinnest) * schemes.index(scheme) / (len(schemes) - 1)


def grid(axes):
    """Light grid behind the curves"""
    axes.grid(True, which="major", color="0.92")
    axes.set_axisbelow(True)


def axis(axes, x="", y="", title="", size=10):
    """Labels, title and grid of a panel; an empty text leaves what is there"""
    for text, place in ((x, axes.set_xlabel), (y, axes.set_ylabel)):
        if text:
            place(text)
    if title:
        axes.set_title(title, fontsize=size)
    grid(axes)


def by_scheme(rows, column="integrator"):
    """For each scheme of a column: its name, its rows, and its colour and marker as arguments of plot functions"""
    schemes = distinct(rows, column)
    for scheme in schemes:
        colour, marker = style(scheme, schemes)
        yield scheme, where(rows, **{column: scheme}), {"color": colour, "marker": marker}


def legend(figure, schemes, markers=True, more=(), columns=8):
    """Draws one legend below the figure and returns its height as a fraction of the figure height"""
    handles = [Line2D([], [], color=style(s, schemes)[0], marker=style(s, schemes)[1] if markers else None, label=s)
               for s in schemes] + list(more)
    lines = -(-len(handles) // columns)
    columns = -(-len(handles) // lines)
    lines_below(figure, handles, columns)
    return 0.26 * lines / figure.get_figheight() + 0.01


def lines_below(figure, handles, columns=None):
    """Draws a legend of these lines below the figure, in one row unless a number of columns is given"""
    figure.legend(handles=handles, loc="lower center", ncol=columns or len(handles), frameon=False, fontsize=9)


def bars(rows, column):
    """Lengths of error bars from the columns COLUMN_min and COLUMN_max"""
    values = numbers(rows, column)
    return ([v - low for v, low in zip(values, numbers(rows, column + "_min"))],
            [high - v for v, high in zip(values, numbers(rows, column + "_max"))])


def times_and_ratios(time, ratio, rows, x, **points):
    """Draws the CPU time of a step with its range, and its ratio to that of rA-full-1, over the column x"""
    values, us = numbers(rows, x), numbers(rows, "us_per_step")
    time.errorbar(values, us, yerr=bars(rows, "us_per_step"), fmt="-", lw=1.2, capsize=2, elinewidth=0.8, **points)
    ratio.plot(values, numbers(rows, "ratio_to_full"), "-", lw=1.2, **points)


def slopes(axes, h, top):
    """Reference lines of slope 1 and 2 over the steps h that end at the error `top`"""
    for slope, line in ((1, ":"), (2, "--")):
        axes.plot([h[0], h[-1]], [top * (h[0] / h[-1]) ** slope, top], line, color="0.6", lw=1, zorder=0)


SLOPES = [Line2D([], [], color="0.6", ls=":", label="slope 1"), Line2D([], [], color="0.6", ls="--", label="slope 2")]


def save(figure, folder, name, below=0.0, top=0.97):
    """Saves the figure; `below` and `top` are the margins of the panels as fractions of the figure height"""
    figure.tight_layout(rect=(0, below, 1, top))
    figure.savefig(os.path.join(folder, name), dpi=110)
    plt.close(figure)


def for_each(column, draw, *tables):
    """Calls draw(folder, value, rows, ...) for each value of a column of study.csv, with the rows that have it in
    study.csv and in further tables of the result directory"""
    folder = directory()
    every = [read(folder, table) for table in ("study.csv", *tables)]
    for value in distinct(every[0], column):
        draw(folder, value, *(where(rows, **{column: value}) for rows in every))
