# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions shared by the figures: reading tables, and the same colour and marker for a scheme in all figures."""
import csv
import json
import os
import sys
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PatchCollection
from matplotlib.lines import Line2D

import options
import slopes
import ticks
from options import OF_THE_TEXT, PREFERRED, chosen, directory, shown

RESOLUTION = 200  # of raster formats [dpi]
plt.rcParams.update({
    "pdf.fonttype": 42, "ps.fonttype": 42,  # embedded TrueType fonts; Type 3 is refused by some publishers
    "svg.hashsalt": "hilda",                # the same file from the same table
    "figure.max_open_warning": 0,
})
# formats that contain the date unless it is removed
UNDATED = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "ps": {}, "eps": {}}

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
    "rA-rattle-4": ("#bcbddc", "d"), "rA-rattle-6": ("#9e9ac8", "p"), "rA-rattle-8": ("#54278f", "8"),
    "rA-rattle-gbs-4": ("#c7e9c0", "d"), "rA-rattle-gbs-6": ("#74c476", "p"), "rA-rattle-gbs-8": ("#006d2c", "8"),
    "rA-dp-5": ("#b2182b", "d"), "rA-dop853": ("#1a9850", "p"), "rA-radau-5": ("#01665e", "h"),
    "ida-rp": ("#000000", "h"), "ida-rp-baumgarte": ("#444444", "H"), "ida-rp-index1": ("#888888", "8"),
    "evolving": ("#0072b2", "o"), "evolving, KLU": ("#56b4e9", "^"), "evolving, text": ("#332288", "d"),
    "DVI": ("#d55e00", "s"), "DEM": ("#009e73", "P"),
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


def stop(code, text):
    """Ends with an error of hilda plot"""
    print(text, file=sys.stderr)
    sys.exit(code)


class Cell(str):
    """A field of a table. One that should be a number and is none ends the script with its place."""

    def __new__(cls, text, row, column):
        cell = super().__new__(cls, text)
        cell.row, cell.column = row, column
        return cell

    def __float__(self):
        try:
            return float(str(self))
        except ValueError:
            return self.row.damaged(f"column {self.column} must be a number, got {str(self)!r}")

    def __int__(self):
        try:
            return int(str(self))
        except ValueError:
            return self.row.damaged(f"column {self.column} must be an integer, got {str(self)!r}")


class Row(dict):
    """A row of a table by the names of its columns. A column that is missing ends the script with the place."""

    def __init__(self, file, line, names, cells):
        self.file, self.line = file, line
        if len(cells) != len(names):
            self.damaged(f"must have {len(names)} fields, got {len(cells)}")
        super().__init__(zip(names, cells))

    def __getitem__(self, column):
        if column not in self:
            stop(options.DAMAGED, f"{self.file}:1: has no column {column}")
        return Cell(super().__getitem__(column), self, column)

    def damaged(self, what):
        stop(options.DAMAGED, f"{self.file}:{self.line}: {what}")


def read(*path):
    """The rows of a CSV file as dictionaries of strings; those of the group of run.h5 if the run has written this instead"""
    name = os.path.join(*path)
    tables = os.path.join(os.path.dirname(name), "run.h5")
    if not os.path.exists(name) and os.path.exists(tables):
        return read_hdf5(tables, os.path.splitext(os.path.basename(name))[0])
    try:
        with open(name, newline="", encoding="utf-8") as file:
            lines = csv.reader(file, strict=True)
            names = next(lines, [])
            rows = [(lines.line_num, cells) for cells in lines if cells]
            if rows and len(rows[-1][1]) < len(names) and not ends_with_a_line(name):
                rows.pop()  # a run that goes on has written a part of its last row
    except (UnicodeDecodeError, csv.Error) as error:
        stop(options.DAMAGED, f"{name}: is not a CSV table in UTF-8: {error}")
    if len(set(names)) < len(names) or not names:
        stop(options.DAMAGED, f"{name}:1: must have the names of the columns, each once")
    return [Row(name, line, names, cells) for line, cells in rows]


def read_rows(*path):
    """The same of a table that must have rows"""
    rows = read(*path)
    if not rows:
        stop(options.DAMAGED, f"{os.path.join(*path)}: has no rows")
    return rows


def ends_with_a_line(path):
    with open(path, "rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read() == b"\n"


def read_hdf5(path, table):
    """The rows of a group of an HDF5 file as dictionaries of numbers"""
    try:
        import h5py  # not needed for CSV files
    except ImportError:
        sys.exit(f"{path}: {sys.executable} has no h5py, which reads HDF5 files (Debian: apt-get install python3-h5py)")
    try:
        with h5py.File(path, "r") as file:
            columns = {dataset.attrs["name"]: dataset[:].tolist() for dataset in file[table].values()}
    except (OSError, KeyError, RuntimeError) as error:
        stop(options.CANNOT_READ, f"{path}: cannot be read: {' '.join(str(error).split())}")
    return [dict(zip(columns, row)) for row in zip(*columns.values())]


def record(folder, name="study.json"):
    """The contents of study.json of the result directory; empty if there is no such file"""
    name = os.path.join(folder, name)
    try:
        with open(name, encoding="utf-8") as file:
            content = json.load(file)
    except FileNotFoundError:
        return {}
    except ValueError as error:
        stop(options.DAMAGED, f"{name}: is not JSON: {error}")
    if not isinstance(content, dict):
        stop(options.DAMAGED, f"{name}: must be an object")
    return content


def distinct(rows, column):
    """The distinct values of a column, in order of first occurrence"""
    return list(dict.fromkeys(row[column] for row in rows))


def where(rows, **values):
    """The rows whose columns have these values"""
    return [row for row in rows if all(row[column] == value for column, value in values.items())]


def number(text):
    """The number in a field; NaN for an empty field"""
    return float("nan") if text == "" else float(text)


def numbers(rows, column):
    """The numbers of a column"""
    return [number(row[column]) for row in rows]


def spheres(axes, places, radius=None, values=None, most=1, **look):
    """Draws circles in the plane of x and z [mm] and returns the collection. `places`: rows with x, z and, if `radius` is
    None, radius [m]. `values` colours them from 0 to `most`; the largest values are drawn last."""
    order = sorted(range(len(places)), key=lambda k: values[k]) if values else range(len(places))
    circles = [plt.Circle((1000 * number(places[k]["x"]), 1000 * number(places[k]["z"])),
                          1000 * (number(places[k]["radius"]) if radius is None else radius)) for k in order]
    drawn = PatchCollection(circles, **({"cmap": "viridis"} if values else {}), **look)
    if values:
        drawn.set_array([values[k] for k in order])
        drawn.set_clim(0, most)
    axes.add_collection(drawn)
    return drawn


def wheel_on_grains(axes, grains, grain, radius, centre, speed):
    """Draws grains, coloured by their speed over `speed`, and a wheel [mm]. `centre`: its columns in the rows of the grains."""
    drawn = spheres(axes, grains, grain, [v / speed for v in numbers(grains, "speed")], linewidths=0.2, edgecolors="0.3")
    at = tuple(1000 * number(grains[0][column]) for column in centre)
    axes.add_patch(plt.Circle(at, 1000 * radius, fill=False, color="k", lw=1.5))
    axes.annotate("", xy=(at[0] + 70, at[1]), xytext=at, arrowprops={"arrowstyle": "->", "color": "k"})
    axes.set(aspect="equal", xlabel="x [mm]")
    return drawn


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


def look(scheme, schemes):
    """Colour, marker and order of drawing of a scheme as arguments of plot functions; earlier schemes are on top"""
    colour, marker = style(scheme, schemes)
    return {"color": colour, "marker": marker, "zorder": 3 - schemes.index(scheme) / len(schemes)}


def by_scheme(rows, column="integrator", preferred=PREFERRED):
    """For each scheme of a column that the figure shows: its name, its rows, and the arguments of plot functions"""
    schemes = options.shown(distinct(rows, column), preferred) if column == "integrator" else distinct(rows, column)
    for scheme in schemes:
        yield scheme, where(rows, **{column: scheme}), look(scheme, schemes)


def along(axes, x, y, place, of, dash="-", **points):
    """A curve of many points with about eight markers. The markers of the curves are at different places, so that
    coinciding curves are visible and the figure is legible without colours."""
    stride = max(1, len(x) // 8)
    axes.plot(x, y, dash, lw=1.2, ms=5, markevery=(place * stride // of, stride), **points)


def step_styles(steps):
    """Text for the title of a figure whose line styles show the steps, and their entries in the legend"""
    if len(steps) == 1:
        return f"h = {float(steps[0]):g} s", []
    return "line style: step h", [Line2D([], [], color="0.4", ls=DASHES[k % len(DASHES)], label=f"h = {float(h):g} s")
                                  for k, h in enumerate(steps)]


def legend(figure, schemes, markers=True, more=(), columns=8):
    """Draws one legend below the figure and returns its height as a fraction of the figure height. It lists the schemes
    that the figure shows."""
    schemes = options.in_legend or schemes
    handles = [Line2D([], [], color=style(s, schemes)[0], marker=style(s, schemes)[1] if markers else None, label=s)
               for s in schemes] + list(more)
    return lines_below(figure, handles, columns)


def caption(figure):
    """The lines that name what the figure does not show"""
    if not options.left_out:
        return []
    text = "not shown: " + ", ".join(options.left_out) + options.left_out_hint[0]
    return textwrap.wrap(text, int(17 * figure.get_figwidth()), break_on_hyphens=False)


def caption_height(figure):
    lines = len(caption(figure))
    return (0.16 * lines + 0.06) / figure.get_figheight() if lines else 0


def lines_below(figure, handles, columns=None):
    """Draws a legend of these lines below the figure, in as many columns as the figure is wide enough for, at most
    `columns`. Returns its height as a fraction of the figure height."""
    columns = min(columns or len(handles), len(handles))
    while True:
        lines = -(-len(handles) // columns)
        box = figure.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, caption_height(figure)),
                            ncol=-(-len(handles) // lines), frameon=False, fontsize=9)
        if columns == 1 or box.get_window_extent(figure.canvas.get_renderer()).width <= figure.bbox.width:
            return 0.24 * lines / figure.get_figheight() + 0.01
        box.remove()
        columns -= 1


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


def declared_order(folder, scheme, key="declared_order"):
    """The declared order of a scheme in study.json; None if it has none"""
    for series in record(folder).get("series") or []:
        if series.get("integrator") == scheme:
            return series.get(key)
    return None


def tidy_and_lay_out(figure, place):
    """Ticks of logarithmic axes, and the panels in a part of the figure. The ticks depend on the size of the panels."""
    figure.tight_layout(rect=place)
    for _ in range(2):  # the labels change the size of the panels
        for axes in figure.axes:
            ticks.tidy(axes.xaxis)
            ticks.tidy(axes.yaxis)
        figure.tight_layout(rect=place)


def write(figure, path, kind):
    """Writes a file that is complete or absent; a link in its place is replaced, not followed"""
    new = path + ".new"
    try:
        if os.path.lexists(new):
            os.remove(new)  # of a program that was killed
        with open(new, "xb") as file:
            figure.savefig(file, format=kind, dpi=RESOLUTION, metadata=UNDATED.get(kind))
        os.replace(new, path)
    except OSError as error:
        if os.path.lexists(new):
            os.remove(new)
        stop(options.CANNOT_WRITE, f"{path}: cannot be written: {error.strerror}")


def save(figure, folder, name, below=0.0, top=0.97):
    """Saves the figure NAME.png in the formats of --format and prints the names of the files; `below` and `top` are the
    margins of the panels as fractions of the figure height"""
    options.check_all_used()
    for line, text in enumerate(reversed(caption(figure))):
        figure.text(0.5, (0.05 + 0.16 * line) / figure.get_figheight(), text, ha="center", va="bottom", fontsize=8,
                    color="0.3")
    below += caption_height(figure)
    if figure._suptitle is not None:
        lines = figure._suptitle.get_text().split("\n")
        wide = int(110 * figure.get_figwidth() / figure._suptitle.get_fontsize())
        figure._suptitle.set_text("\n".join(part for line in lines for part in textwrap.wrap(line, wide)))
    tidy_and_lay_out(figure, (0, below, 1, top))
    slopes.place_labels(figure)
    for kind in options.formats():
        file = f"{os.path.splitext(name)[0]}.{kind}"
        write(figure, os.path.join(folder, file), kind)
        print(file)
    plt.close(figure)


def for_each(column, draw, *tables):
    """Calls draw(folder, value, rows, ...) for each value of a column of study.csv, with the rows that have it in
    study.csv and in further tables of the result directory"""
    folder = directory()
    every = [read(folder, table) for table in ("study.csv", *tables)]
    for value in distinct(every[0], column):
        draw(folder, value, *(where(rows, **{column: value}) for rows in every))
