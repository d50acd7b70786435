#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Evolving contact, DVI and springs: error against CPU time (bowl), CPU time against number of contacts (other scenes).

    contact-methods.py DIR       reads DIR/study.csv, writes DIR/contact-methods-PART.png
"""
from drawing import directory, distinct, grid, legend, number, numbers, plt, read, save, style, where

TITLES = {
    "bowl": "Ball sliding in a bowl for 2 s: position error",
    "many": "Independent balls in a bowl: CPU time",
    "chain": "Chain of balls in a groove, three contacts per ball: CPU time",
    "pile": "Balls falling into a bowl, 1 s: CPU time",
}


def lines(axes, rows, x, y, methods):
    for method in methods:
        colour, marker = style(method, methods)
        mine = [row for row in where(rows, method=method) if row["status"] == "ok" and number(row[y]) > 0]
        axes.loglog(numbers(mine, x), numbers(mine, y), "-", marker=marker, color=colour, lw=1.2, ms=5)
    grid(axes)


def draw(folder, part, rows):
    methods = distinct(rows, "method")
    figure, panels = plt.subplots(1, 2, figsize=(11.5, 5.0))
    if part == "bowl":
        lines(panels[0], rows, "cpu_seconds", "error", methods)
        panels[0].set_xlabel("thread CPU time of the run [s]")
        lines(panels[1], rows, "h", "error", methods)
        panels[1].set_xlabel("step $h$ [s]")
        for axes in panels:
            axes.set_ylabel("largest position error [m]")
    else:
        lines(panels[0], rows, "contacts", "us_per_step_and_contact", methods)
        panels[0].set_ylabel("thread CPU time per step and contact [µs]")
        panels[0].set_xlabel("number of contacts")
        for row in rows:
            row["per_second"] = str(number(row["cpu_seconds"]) / number(row["end"]))
        lines(panels[1], rows, "contacts", "per_second", methods)
        panels[1].set_ylabel("thread CPU time per second of motion [s/s]")
        panels[1].set_xlabel("number of contacts")
    figure.suptitle(TITLES[part], fontsize=11)
    save(figure, folder, f"contact-methods-{part}.png", legend(figure, methods))


def main():
    folder = directory()
    rows = read(folder, "study.csv")
    for part in distinct(rows, "part"):
        draw(folder, part, where(rows, part=part))


if __name__ == "__main__":
    main()
