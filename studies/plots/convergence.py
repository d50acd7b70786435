#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of the convergence study: error against step size.   Fang (2022), Figs. 3.4, 3.6, 3.7, 3.8

    convergence.py DIR

Reads DIR/study.csv and DIR/study.json. For the default selection of the study it writes two figures with one panel
for each problem: DIR/convergence-position.png and DIR/convergence-loads.png. For any other selection it writes one
figure for each problem, DIR/convergence-PROBLEM.png, with one panel for each error norm.
"""
from drawing import SLOPES, Line2D, axis, directory, distinct, legend, numbers, plt, read, record, save, slopes, style, where

# The schemes of the dissertation are drawn on top of the others and come first in the legends.
OF_THE_TEXT = ("rA-full-1", "rA-half-1", "rA-half-2")

PANELS = [
    [("r", "position $r$ [m]"), ("A", "orientation $\\|A\\|_F$"), ("v", "velocity $\\dot r$ [m/s]"),
     ("omega", "angular velocity $\\bar\\omega$ [rad/s]"), ("Q", "constraint loads, relative")],
    [("r_end", "position [m]"), ("A_end", "orientation"), ("v_end", "velocity [m/s]"),
     ("omega_end", "angular velocity [rad/s]"), ("observable", "")],
]
UNITS = {"r": "m", "v": "m/s", "w": "rad/s"}
AT_FLOOR = "at rounding or Newton tolerance"


def text_first(schemes):
    return [s for s in OF_THE_TEXT if s in schemes] + [s for s in schemes if s not in OF_THE_TEXT]


def series(rows, scheme, norm):
    """Steps, errors and floor flags of one scheme, without the rows that have no error"""
    rows = [row for row in where(rows, integrator=scheme) if row[norm] not in ("", "0")]
    return numbers(rows, "h"), numbers(rows, norm), [row["floor_" + norm] == "1" for row in rows]


def above_floor(rows, norm):
    """True if at least one error of this norm is above rounding and above the Newton tolerance"""
    return any(row[norm] not in ("", "0") and row["floor_" + norm] != "1" for row in rows)


def curve(axes, points, colour, marker, zorder, size=6.0, width=1.4, line="-"):
    """One error curve; the markers of points at rounding or at the Newton tolerance are hollow"""
    h, e, floor = points
    axes.loglog(h, e, line, color=colour, lw=width, zorder=zorder)
    for hollow in (False, True):
        chosen = [n for n, f in enumerate(floor) if f == hollow]
        axes.loglog([h[n] for n in chosen], [e[n] for n in chosen], marker, color=colour,
                    mfc="white" if hollow else colour, ms=size, zorder=zorder + 0.1)


# The two figures of the default selection

MOTIONS = {"double_pendulum_moving": "planar", "n_pendulum_2_spin": "spatial, spinning bars"}


def guide(axes, slope, points, above):
    """A straight line of this slope above or below the points, with its slope written on it"""
    h = [min(x for x, _ in points), max(x for x, _ in points)]
    ratios = [e / x ** slope for x, e in points]
    factor = 1.7 * max(ratios) if above else min(ratios) / 1.7
    axes.loglog(h, [factor * x ** slope for x in h], "--", color="0.5", lw=1, zorder=1)
    middle = (h[0] * h[1]) ** 0.5
    axes.annotate(f"slope {slope}", (middle, factor * middle ** slope), xytext=(0, 5 if above else -5),
                  textcoords="offset points", ha="right" if above else "left", va="bottom" if above else "top",
                  fontsize=9, color="0.35")


def two_line_legend(figure, schemes):
    """The schemes of the text in the first line, the others in the second; the height it takes"""
    def handle(scheme):
        colour, marker = style(scheme, schemes)
        return Line2D([], [], color=colour, marker=marker, label=scheme, lw=2 if scheme in OF_THE_TEXT else 1.2)
    blank = Line2D([], [], ls="", label="")
    lines = [[Line2D([], [], ls="", label=title)] + [handle(s) for s in schemes if (s in OF_THE_TEXT) == text]
             for title, text in (("dissertation:", True), ("second-order relatives:", False))]
    columns = max(map(len, lines))
    lines = [line + [blank] * (columns - len(line)) for line in lines]
    handles = [line[column] for column in range(columns) for line in lines]  # a legend is filled by columns
    figure.legend(handles=handles, loc="lower center", ncol=columns, frameon=False, fontsize=9.5)
    return 0.5 / figure.get_figheight()


def overview(folder, rows, norm, name, title, label):
    schemes = text_first(distinct(rows, "integrator"))
    problems = distinct(rows, "problem")
    figure, all_axes = plt.subplots(1, len(problems), figsize=(9, 4.4), sharey=True, squeeze=False)
    for problem, axes in zip(problems, all_axes[0]):
        of_problem = where(rows, problem=problem)
        for place, scheme in enumerate(schemes):
            colour, marker = style(scheme, schemes)
            points = series(of_problem, scheme, norm)
            if scheme in OF_THE_TEXT:
                curve(axes, points, colour, marker, 20 + place, size=7, width=2)
            else:  # the markers shrink from the lowest curve to the uppermost, so that coinciding curves are visible
                later = place - len(OF_THE_TEXT)
                curve(axes, points, colour, marker, 5 + later, size=12 - 3.5 * later, width=3 - later)
        clean = [(x, e) for scheme in schemes for x, e, floor in zip(*series(of_problem, scheme, norm)) if not floor]
        if clean:
            guide(axes, 1, clean, above=True)
            guide(axes, 2, clean, above=False)
        axis(axes, "step $h$ [s]" + (f"   (hollow: {AT_FLOOR})" if len(clean) < len(of_problem) else ""),
             title=f"{problem} ({MOTIONS[problem]})" if problem in MOTIONS else problem, size=10.5)
    all_axes[0][0].set_ylabel(label)
    figure.suptitle(title, fontsize=12)
    save(figure, folder, name, two_line_legend(figure, schemes), top=1)


# The figures of any other selection

def draw(folder, problem, rows):
    """All error norms of one problem; a norm whose errors are all at rounding or Newton tolerance has no panel"""
    schemes = text_first(distinct(rows, "integrator"))
    shown = [[panel for panel in panels if above_floor(rows, panel[0])] for panels in PANELS]
    if not any(shown):
        shown = PANELS
    columns = max(len(panels) for panels in shown)
    figure, all_axes = plt.subplots(2, columns, figsize=(3.6 * columns, 7.6), sharex=True, squeeze=False)
    observable = rows[0]["observable_scalar"]
    body, component = observable.rsplit(".", 1)
    for panels, line in zip(shown, all_axes):
        for axes in line[len(panels):]:
            axes.remove()
        for (norm, title), axes in zip(panels, line):
            clean = []
            for place, scheme in enumerate(schemes):
                colour, marker = style(scheme, schemes)
                points = series(rows, scheme, norm)
                clean += [(x, y) for x, y, floor in zip(*points) if not floor]
                if scheme in OF_THE_TEXT:
                    curve(axes, points, colour, marker, 60 + place, size=8 - place, width=2.2 - 0.3 * place)
                else:
                    curve(axes, points, colour, marker, 50 - place, size=5, width=1)
            h = sorted({x for x, _ in clean})
            if len(h) > 1:
                slopes(axes, h, 1.8 * max(error for _, error in clean))
            axis(axes, "step $h$ [s]",
                 title=title or f"${component[0]}_{component[1]}$ of {body} [{UNITS[component[0]]}], norm of Fig. 3.4")
    all_axes[0][0].set_ylabel("error, rms over the instants")
    all_axes[1][0].set_ylabel(f"error at the end, {body}")
    left_out = [norm for panels in PANELS for norm, _ in panels if not any((norm, _) in p for p in shown)]
    more = SLOPES + [Line2D([], [], color="0.3", marker="o", mfc="white", ls="", label=AT_FLOOR)]
    figure.suptitle(f"{problem}: error against step size" +
                    (f" (no panel, {AT_FLOOR}: {', '.join(left_out)})" if left_out else ""))
    save(figure, folder, f"convergence-{problem}.png", legend(figure, schemes, more=more, columns=int(1.8 * columns)))


def figures(folder):
    # "observable" is "watched" in results of earlier versions
    rows = [{column.replace("watched", "observable"): value for column, value in row.items()}
            for row in read(folder, "study.csv")]
    if record(folder).get("selection") == "default":
        overview(folder, rows, "r", "convergence-position.png", "Error of the positions against step size",
                 "position error, rms [m]")
        overview(folder, rows, "Q", "convergence-loads.png",
                 "Error of the constraint loads (forces and torques) against step size",
                 "relative error of the loads, rms")
    else:
        for problem in distinct(rows, "problem"):
            draw(folder, problem, where(rows, problem=problem))


figures(directory())
