#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Constraint residual over step size, one curve per integrator.

    invariants.py DIR       reads DIR/study.csv, writes DIR/invariants.png
"""
from drawing import axis, by_scheme, directory, distinct, legend, numbers, plt, read, save


def draw(folder):
    rows = read(folder, "study.csv")
    figure, axes = plt.subplots(figsize=(6, 4.5))
    for _, mine, look in by_scheme(rows):
        axes.loglog(numbers(mine, "h"), numbers(mine, "residual"), "-", **look)
    axis(axes, "step $h$ [s]", "largest constraint residual [m or rad]")
    save(figure, folder, "invariants.png", legend(figure, distinct(rows, "integrator")))


draw(directory())
