#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Evolving contact, DVI and springs: error against CPU time (bowl), CPU time against number of contacts (other scenes).

    contact-methods.py DIR       reads DIR/study.csv, writes DIR/contact-methods-PART.png
"""
from drawing import axis, by_scheme, distinct, for_each, legend, number, numbers, plt, save

TITLES = {
    "bowl": "Ball sliding in a bowl for 2 s: position error",
    "many": "Independent balls in a bowl: CPU time",
    "chain": "Chain of balls in a groove, three contacts per ball: CPU time",
    "pile": "Balls falling into a bowl, 1 s: CPU time",
}


def lines(axes, rows, x, y, xlabel, ylabel):
    for _, mine, look in by_scheme(rows, "method"):
        mine = [row for row in mine if row["status"] == "ok" and number(row[y]) > 0]
        axes.loglog(numbers(mine, x), numbers(mine, y), "-", lw=1.2, ms=5, **look)
    axis(axes, xlabel, ylabel)


def draw(folder, part, rows):
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.8))
    if part == "bowl":
        lines(left, rows, "cpu_seconds", "error", "thread CPU time of the run [s]", "largest position error [m]")
        lines(right, rows, "h", "error", "step $h$ [s]", "largest position error [m]")
    else:
        for row in rows:
            row["per_second"] = str(number(row["cpu_seconds"]) / number(row["end"]))
        lines(left, rows, "contacts", "us_per_step_and_contact", "number of contacts", "thread CPU time per step and contact [µs]")
        lines(right, rows, "contacts", "per_second", "number of contacts", "thread CPU time per second of motion [s/s]")
    figure.suptitle(TITLES[part], fontsize=11)
    save(figure, folder, f"contact-methods-{part}.png", legend(figure, distinct(rows, "method")))


for_each("part", draw)
