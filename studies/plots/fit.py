#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Data and fitted model over time, and their differences, a column of panels for each quantity.

    fit.py DIR      reads DIR/fit.csv and DIR/fit.json, writes DIR/fit.png
"""
import os

import options
from drawing import directory, plt, read_rows, record, save, stop

MOST_PANELS = 4


def numbers(rows, column):
    return [float(row[column]) if row[column] else float("nan") for row in rows]


def draw(folder):
    fit = record(folder, "fit.json")
    missing = [key for key in ("model", "columns", "parameters", "values") if key not in fit]
    if missing:
        stop(options.DAMAGED, f"{os.path.join(folder, 'fit.json')}: has no key '{missing[0]}'")
    rows = read_rows(folder, "fit.csv")
    names = [column["name"] for column in fit["columns"]]
    units = {column["name"]: f" [{column['unit']}]" if column["unit"] not in ("", "1") else "" for column in fit["columns"]}
    shown = names[:MOST_PANELS]
    t = numbers(rows, "t")
    figure, axes = plt.subplots(2, len(shown), figsize=(min(11, 3.6 * len(shown) + 1.2), 5), sharex=True, squeeze=False,
                                layout="constrained", gridspec_kw={"height_ratios": (2, 1)})
    for above, below, name in zip(axes[0], axes[1], shown):
        data, model = numbers(rows, name + ".data"), numbers(rows, name + ".model")
        above.plot(t, model, "-", lw=1.2, color="C0", label="model")
        above.plot(t, data, "o", ms=3, mfc="none", color="C1", label="data")
        above.set_title(name + units[name], fontsize="medium")
        below.plot(t, [d - m for d, m in zip(data, model)], "o", ms=3, mfc="none", color="C1")
        below.axhline(0, lw=0.8, color="0.6")
        below.set_xlabel("t [s]")
        for panel in (above, below):
            panel.grid(True, alpha=0.3)
    axes[0][0].legend(fontsize="small")
    axes[1][0].set_ylabel("data - model")
    left_out = f"; not shown: {len(names) - len(shown)} more" if len(names) > len(shown) else ""
    figure.suptitle(f"{fit['model']}: {len(fit['parameters'])} parameters, {fit['values']} values{left_out}", fontsize="medium")
    save(figure, folder, "fit.png")


if __name__ == "__main__":
    draw(directory())
