#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of the convergence study: error against step size.   Fang (2022), Figs. 3.4, 3.6, 3.7, 3.8

    convergence.py DIR [--integrator NAME,...] [--quantity r,A,v,omega,Q,r_end,...]

Reads DIR/study.csv and DIR/study.json. For the default selection of the study it writes two figures with one panel
for each problem: DIR/convergence-position.png and DIR/convergence-loads.png. --quantity A, v or omega draws such a figure
of another quantity. For any other selection it writes one figure for each problem, DIR/convergence-PROBLEM.png, with one
panel for each error norm.
"""
from drawing import (OF_THE_TEXT, Line2D, axis, chosen, declared_order, directory, distinct, legend, lines_below, numbers, plt,
                     read, record, save, shown, style, where)
from slopes import guides

PANELS = [
    [("r", "position $r$ [m]"), ("A", "orientation $\\|A\\|_F$"), ("v", "velocity $\\dot r$ [m/s]"),
     ("omega", "angular velocity $\\bar\\omega$ [rad/s]"), ("Q", "constraint loads, relative")],
    [("r_end", "position [m]"), ("A_end", "orientation"), ("v_end", "velocity [m/s]"),
     ("omega_end", "angular velocity [rad/s]"), ("observable", "")],
]
UNITS = {"r": "m", "v": "m/s", "w": "rad/s"}
AT_FLOOR = "at rounding or Newton tolerance"


def series(rows, scheme, norm):
    """Steps, errors and floor flags of one scheme, without the rows that have no error"""
    rows = [row for row in where(rows, integrator=scheme) if row[norm] not in ("", "0")]
    return numbers(rows, "h"), numbers(rows, norm), [row["floor_" + norm] == "1" for row in rows]


def above_floor(rows, norm):
    """True if at least one error of this norm is above rounding and above the Newton tolerance"""
    return any(row[norm] not in ("", "0") and row["floor_" + norm] != "1" for row in rows)


def weight(scheme, schemes):
    """Size of the markers, width of the line, and order of drawing. The schemes of the text are on top; the markers of the
    others are larger, so that coinciding curves are visible."""
    place = schemes.index(scheme)
    if scheme in OF_THE_TEXT:
        return 6.5 - place, 2 - 0.3 * place, 60 + place
    later = place / len(schemes)
    return 12 - 5 * later, 3.2 - 2 * later, 50 + 8 * later


def curve(axes, points, scheme, schemes, scale=1.0):
    """One error curve; the markers of points at rounding or at the Newton tolerance are hollow"""
    h, e, floor = points
    (colour, marker), (size, width, zorder) = style(scheme, schemes), weight(scheme, schemes)
    axes.loglog(h, e, "-", color=colour, lw=scale * width, zorder=zorder)
    for hollow in (False, True):
        chosen_points = [n for n, f in enumerate(floor) if f == hollow]
        axes.loglog([h[n] for n in chosen_points], [e[n] for n in chosen_points], marker, color=colour,
                    mfc="white" if hollow else colour, ms=scale * size, zorder=zorder + 0.1)


def points_by_order(folder, rows, schemes, norm):
    """The points (h, error) above the floor, by the declared order of their scheme in this norm. The loads have the order
    of the multipliers."""
    by_order = {}
    for scheme in schemes:
        order = declared_order(folder, scheme, "declared_order_lambda" if norm == "Q" else "declared_order")
        if order:
            h, e, floor = series(rows, scheme, norm)
            by_order.setdefault(order, []).extend((x, y) for x, y, f in zip(h, e, floor) if not f)
    return by_order


def hollow_in(rows, norms):
    """The entry of hollow markers in the legend, if there are any"""
    there = any(row[norm] not in ("", "0") and row["floor_" + norm] == "1" for norm in norms for row in rows)
    return [HOLLOW] if there else []


HOLLOW = Line2D([], [], color="0.3", marker="o", mfc="white", ls="", label=AT_FLOOR)

# The two figures of the default selection

MOTIONS = {"double_pendulum_moving": "planar", "n_pendulum_2_spin": "spatial, spinning bars"}
# norm: name of the figure, title, label of the axis
OVERVIEWS = {
    "r": ("position", "Error of the positions against step size", "position error, rms [m]"),
    "A": ("orientation", "Error of the orientations against step size", "orientation error $\\|A\\|_F$, rms"),
    "v": ("velocity", "Error of the velocities against step size", "velocity error, rms [m/s]"),
    "omega": ("angular-velocity", "Error of the angular velocities against step size",
              "angular velocity error, rms [rad/s]"),
    "Q": ("loads", "Error of the constraint loads (forces and torques) against step size",
          "relative error of the loads, rms"),
}


def two_line_legend(figure, schemes, more):
    """The schemes of the text in the first line, the others in the second; the height it takes"""
    def handle(scheme):
        colour, marker = style(scheme, schemes)
        return Line2D([], [], color=colour, marker=marker, label=scheme, lw=2 if scheme in OF_THE_TEXT else 1.2)
    blank = Line2D([], [], ls="", label="")
    lines = [[Line2D([], [], ls="", label=title)] + [handle(s) for s in schemes if (s in OF_THE_TEXT) == text]
             for title, text in (("dissertation:", True), ("others:", False))]
    lines = [line for line in lines if len(line) > 1]
    lines[0] += more
    columns = max(map(len, lines))
    lines = [line + [blank] * (columns - len(line)) for line in lines]
    handles = [line[column] for column in range(columns) for line in lines]  # a legend is filled by columns
    return lines_below(figure, handles, columns)


def overview(folder, rows, norm):
    name, title, label = OVERVIEWS[norm]
    schemes = shown(distinct(rows, "integrator"))
    problems = distinct(rows, "problem")
    figure, all_axes = plt.subplots(1, len(problems), figsize=(9.5, 4.6), sharey=True, squeeze=False)
    for problem, axes in zip(problems, all_axes[0]):
        of_problem = where(rows, problem=problem)
        for scheme in schemes:
            curve(axes, series(of_problem, scheme, norm), scheme, schemes)
        guides(axes, points_by_order(folder, of_problem, schemes, norm), size=9)
        axis(axes, "step $h$ [s]", title=f"{problem} ({MOTIONS[problem]})" if problem in MOTIONS else problem, size=10.5)
    all_axes[0][0].set_ylabel(label)
    figure.suptitle(title, fontsize=12)
    save(figure, folder, f"convergence-{name}.png", two_line_legend(figure, schemes, hollow_in(rows, [norm])),
         top=1)


# The figures of any other selection

ACROSS = 3  # panels in a line


def draw(folder, problem, rows):
    """All error norms of one problem; a norm whose errors are all at rounding or Newton tolerance has no panel"""
    schemes = shown(distinct(rows, "integrator"))
    kinds = [[panel for panel in panels if panel[0] in chosen([norm for part in PANELS for norm, _ in part])]
             for panels in PANELS]
    panels = [[panel for panel in kind if above_floor(rows, panel[0])] for kind in kinds]
    if not any(panels):  # only rounding errors are left to show, those of norms that the model has
        panels = [[panel for panel in kind if any(row[panel[0]] not in ("", "0") for row in rows)] for kind in kinds]
    lines = [kind[k:k + ACROSS] for kind in panels for k in range(0, len(kind), ACROSS)]
    if not lines:
        return
    columns = max(map(len, lines))
    figure, all_axes = plt.subplots(len(lines), columns, figsize=(max(6, 3.4 * columns), 1.2 + 2.8 * len(lines)),
                                    sharex=True, squeeze=False)
    body, component = rows[0]["observable_scalar"].rsplit(".", 1)
    for panels_of_line, line in zip(lines, all_axes):
        for axes in line[len(panels_of_line):]:
            axes.remove()
        at_end = panels_of_line[0] in PANELS[1]
        line[0].set_ylabel(f"error at the end, {body}" if at_end else "error, rms over the instants")
        for (norm, title), axes in zip(panels_of_line, line):
            for scheme in schemes:
                curve(axes, series(rows, scheme, norm), scheme, schemes, scale=0.8)
            guides(axes, points_by_order(folder, rows, schemes, norm))
            axis(axes, title=title or f"${component[0]}_{component[1]}$ of {body} [{UNITS[component[0]]}], norm of Fig. 3.4")
            axes.xaxis.set_tick_params(labelbottom=True)
    for column in range(columns):
        last = max(k for k, line in enumerate(lines) if column < len(line))
        all_axes[last][column].set_xlabel("step $h$ [s]")
    left_out = [norm for kind in kinds for norm, _ in kind if not any((norm, _) in part for part in panels)
                and any(row[norm] for row in rows)]
    more = hollow_in([row for row in rows if row["integrator"] in schemes], [norm for kind in panels for norm, _ in kind])
    figure.suptitle(f"{problem}: error against step size" +
                    (f"\nno panel, {AT_FLOOR}: {', '.join(left_out)}" if left_out else ""))
    save(figure, folder, f"convergence-{problem}.png", legend(figure, schemes, more=more, columns=5),
         top=1)


def figures(folder):
    # "observable" is "watched" in results of earlier versions
    rows = [{column.replace("watched", "observable"): value for column, value in row.items()}
            for row in read(folder, "study.csv")]
    if record(folder).get("selection") == "default":
        names = chosen(list(OVERVIEWS))
        for norm in names if len(names) < len(OVERVIEWS) else ("r", "Q"):
            overview(folder, rows, norm)
    else:
        for problem in distinct(rows, "problem"):
            draw(folder, problem, where(rows, problem=problem))


figures(directory())
