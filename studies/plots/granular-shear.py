#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct shear of a sample of grains.                                                          Fang (2022), Sec. 7.2.2

    granular-shear.py DIR     reads DIR/study.csv and DIR/motion.csv, writes DIR/granular-shear.png
"""
from drawing import COLOURS, directory, distinct, grid, number, numbers, plt, read, save, where


def smooth(values, width=5):
    """Moving mean over `width` values, of fewer at the ends"""
    half = width // 2
    parts = [values[max(0, k - half):k + half + 1] for k in range(len(values))]
    return [sum(part) / len(part) for part in parts]


def styles(rows):
    """Colour, line and label of each test: the four stresses, then the tests that differ in speed or friction"""
    fast, rough = max(numbers(rows, "speed")), max(numbers(rows, "mu"))
    stresses = distinct(rows, "stress")
    for row in rows:
        colour, dash = COLOURS[stresses.index(row["stress"])], "-"
        label = f"{number(row['stress']) / 1000:g} kPa"
        if number(row["speed"]) < fast:
            colour, dash, label = "0.2", ":", label + f", {1000 * number(row['speed']):g} mm/s"
        if number(row["mu"]) < rough:
            dash, label = "--", label + rf", $\mu$ = {number(row['mu']):g}"
        yield row, {"color": colour, "ls": dash, "label": label, "lw": 1.4, "zorder": 3 if dash == ":" else 2}


def draw(folder):
    rows, motion = read(folder, "study.csv"), read(folder, "motion.csv")
    figure, (stress, line, lid) = plt.subplots(1, 3, figsize=(12.5, 4.2))
    for row, look in styles(rows):
        mine = where(motion, stress=row["stress"], speed=row["speed"], mu=row["mu"])
        x = [1000 * value for value in numbers(mine, "x")]
        stress.plot(x, [value / 1000 for value in smooth(numbers(mine, "tau"))], **look)
        lid.plot(x, [1000 * value for value in smooth(numbers(mine, "lid"))], **look)
    stress.set(xlabel="displacement $x$ [mm]", ylabel=r"shear stress $\tau$ [kPa]", xlim=(0, None), ylim=(0, None))
    stress.legend(frameon=False, fontsize=7, loc="upper left", ncol=2)
    stress.set_ylim(0, 1.45 * stress.get_ylim()[1])
    lid.set(xlabel="displacement $x$ [mm]", ylabel="rise of the lid [mm]", xlim=(0, None))
    lid.axhline(0, color="0.6", lw=0.8)

    first = rows[0]
    four = where(rows, speed=first["speed"], mu=first["mu"])
    sigma, tau = numbers(four, "sigma"), numbers(four, "tau_peak")
    slope = sum(s * t for s, t in zip(sigma, tau)) / sum(s * s for s in sigma)
    largest = 1.08 * max(sigma) / 1000
    line.plot([0, largest], [0, slope * largest], "-", color="0.35", lw=1, label=rf"$\tau$ = {slope:.3f} $\sigma$")
    for row, look in styles(rows):
        other = look["label"] if look["ls"] != "-" else None
        line.plot(number(row["sigma"]) / 1000, number(row["tau_peak"]) / 1000, "o" if look["ls"] == "-" else "s", ls="none",
                  color=look["color"], ms=6, mfc="none" if look["ls"] == ":" else look["color"] if look["ls"] == "-" else "w",
                  label=other)
    line.set(xlabel=r"normal stress in the shear plane $\sigma$ [kPa]", ylabel=r"largest shear stress $\tau$ [kPa]",
             xlim=(0, None), ylim=(0, None))
    line.legend(frameon=False, fontsize=8, loc="upper left")
    for axes in (stress, line, lid):
        grid(axes)
    save(figure, folder, "granular-shear.png", top=1)


draw(directory())
