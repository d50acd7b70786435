#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Constraint residual over step size, one curve per integrator.

    invariants.py DIR       reads DIR/study.csv, writes DIR/invariants.png
"""
from drawing import directory, distinct, grid, legend, numbers, plt, read, save, style, where


def main():
    folder = directory()
    rows = read(folder, "study.csv")
    schemes = distinct(rows, "integrator")
    figure, axes = plt.subplots(figsize=(6, 4.5))
    for scheme in schemes:
        colour, marker = style(scheme, schemes)
        mine = where(rows, integrator=scheme)
        axes.loglog(numbers(mine, "h"), numbers(mine, "residual"), marker, color=colour)
    axes.set(xlabel="step $h$ [s]", ylabel="largest constraint residual [m or rad]")
    grid(axes)
    save(figure, folder, "invariants.png", legend(figure, schemes))


if __name__ == "__main__":
    main()
