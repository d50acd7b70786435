#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Observed scalar at the end of a run and largest constraint force over the first swept entry, a curve for each value
of the others.

    sweep.py DIR      reads DIR/study.csv and DIR/study.json, writes DIR/sweep.png
"""
from drawing import Line2D, axis, directory, distinct, lines_below, numbers, plt, read, record, save, where

MOST_CURVES = 8  # with more, a colour bar of the second entry replaces the legend


def is_number(text):
    try:
        float(str(text))  # not a Cell, which ends the script
        return True
    except ValueError:
        return False


def short(text):
    """A number with four digits; another text as it is"""
    return f"{float(text):.4g}" if is_number(text) else text


def places(values):
    """The abscissae of the values of the first entry: the numbers, or 0, 1, ... if one of them is no number"""
    return {v: float(v) if all(map(is_number, values)) else k for k, v in enumerate(values)}


def is_geometric(values):
    """Whether the values are numbers with a range of a factor 100 and equal ratios"""
    x = sorted(map(float, values)) if all(map(is_number, values)) else [0]
    return len(x) > 2 and x[0] > 0 and x[-1] / x[0] >= 100 and x[1] - x[0] < 0.3 * (x[-1] - x[-2])


def draw(folder):
    study = record(folder)
    rows = [row for row in read(folder, "study.csv") if row["status"] == "ok"]
    if not rows:
        figure = plt.figure(figsize=(6, 2))
        figure.text(0.5, 0.5, "all runs failed", ha="center")
        return save(figure, folder, "sweep.png")
    swept = [entry["pointer"] for entry in study["sweep"]]
    first = swept[0]
    others = [c for c in swept[1:] + ["integrator", "h"] if len(distinct(rows, c)) > 1]
    at, drawn = places(distinct(rows, first)), []
    panels = [("observable_end", f"{study['observable']} at the end" + (f" [{study['observable_unit']}]" if study["observable_unit"] else "")), ("max_force", "largest constraint force [N]")]
    if not any(numbers(rows, "max_force")):
        panels.pop()
    figure, axes = plt.subplots(1, len(panels), figsize=(5.6 * len(panels) + 1, 4.4), squeeze=False)
    curves = list(dict.fromkeys(tuple(row[c] for c in others) for row in rows))
    colours = plt.get_cmap("viridis")
    for k, curve in enumerate(curves):
        mine = sorted(where(rows, **dict(zip(others, curve))), key=lambda row: at[row[first]])
        colour = colours(0.9 * k / max(1, len(curves) - 1))
        for panel, (column, _) in zip(axes[0], panels):
            panel.plot([at[row[first]] for row in mine], numbers(mine, column), "-o", ms=4, lw=1.3, color=colour)
        drawn.append(Line2D([], [], color=colour, marker="o", ms=4,
                            label=", ".join(f"{c} = {short(v)}" for c, v in zip(others, curve))))
    for panel, (column, label) in zip(axes[0], panels):
        axis(panel, first, label)
        values = numbers(rows, column)
        middle, half = (max(values) + min(values)) / 2, (max(values) - min(values)) / 2
        if half < 1e-9 * max(1, abs(middle)):  # equal but for rounding
            panel.set_ylim(middle - max(1, abs(middle)) / 10, middle + max(1, abs(middle)) / 10)
        if not all(map(is_number, at)):
            panel.set_xticks(list(at.values()))
            panel.set_xticklabels(list(at), rotation=20, ha="right", fontsize=8)
        elif is_geometric(list(at)):
            panel.set_xscale("log")
    figure.suptitle(f"{study['model']}: {len(rows)} runs", fontsize=11)
    below = 0.0
    if 1 < len(curves) <= MOST_CURVES:
        columns = max(1, min(len(curves), int(120 / max(len(line.get_label()) + 8 for line in drawn))))
        lines_below(figure, drawn, columns)
        below = 0.26 * -(-len(curves) // columns) / figure.get_figheight() + 0.01
    elif len(curves) > MOST_CURVES:
        bar = figure.colorbar(plt.cm.ScalarMappable(cmap=colours, norm=plt.Normalize(0, (len(curves) - 1) / 0.9)), ax=axes[0, -1])
        some = sorted({round(k * (len(curves) - 1) / 7) for k in range(8)})
        bar.set_ticks(some)
        bar.set_ticklabels([", ".join(map(short, curves[k])) for k in some], fontsize=8)
        bar.set_label(", ".join(others))
        bar.ax.set_ylim(0, len(curves) - 1)
    save(figure, folder, "sweep.png", below)


draw(directory())
