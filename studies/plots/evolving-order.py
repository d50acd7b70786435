#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error over step size for evolving contacts, one figure per problem.

    evolving-order.py DIR       reads DIR/study.csv, writes DIR/evolving-order-PROBLEM.png
"""
import math

from drawing import Line2D, axis, by_scheme, chosen, distinct, for_each, legend, number, numbers, plt, save
from slopes import guides

PANELS = {"r": "position $r$ [m]", "A": "orientation $\\|A\\|_F$", "alpha": r"contact points $\bar\alpha$ [m]",
          "F_N": "normal force $F_N$ [N]"}
ROUNDING = 1e-9  # the limit of the fit in the study


def fitted_order(h, e):
    """Slope of log e over log h, rounded"""
    x, y = [math.log(v) for v in h], [math.log(v) for v in e]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return round(sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x))


def draw(folder, problem, rows):
    names = chosen(list(PANELS))
    at_rounding = [n for n in names if not any(number(row["error_" + n]) > ROUNDING for row in rows)]
    names = [n for n in names if n not in at_rounding]
    if not names:
        return
    figure, all_axes = plt.subplots(-(-len(names) // 2), min(2, len(names)),
                                    figsize=(max(6, 4.4 * min(2, len(names))), 1 + 3.3 * -(-len(names) // 2)), sharex=True,
                                    squeeze=False)
    hollow_points = False
    for norm, axes in zip(names, all_axes.flat):
        by_order = {}
        for _, mine, look in by_scheme(rows):
            mine = [row for row in mine if number(row["error_" + norm]) > 0]
            h, e = numbers(mine, "h"), numbers(mine, "error_" + norm)
            clean = [(x, y) for x, y in zip(h, e) if y > ROUNDING]
            if len(clean) > 1:
                by_order.setdefault(fitted_order(*zip(*clean)), []).extend(clean)
            hollow_points = hollow_points or len(clean) < len(h)
            axes.loglog(h, e, "-", lw=1.4, **{key: value for key, value in look.items() if key != "marker"})
            for hollow in (False, True):
                part = [(x, y) for x, y in zip(h, e) if (y <= ROUNDING) == hollow]
                axes.loglog([x for x, _ in part], [y for _, y in part], ls="", ms=6,
                            **look | ({"mfc": "white"} if hollow else {}))
        by_order = {order: points for order, points in by_order.items() if 1 <= order <= 4}
        guides(axes, by_order)
        axis(axes, title=PANELS[norm])
    for axes in list(all_axes.flat)[len(names):]:
        axes.remove()
    for axes in all_axes[-1][:2 - len(names) % 2]:
        axes.set_xlabel("step $h$ [s]")
    for axes in all_axes[:, 0]:
        axes.set_ylabel("largest error over the instants")
    figure.suptitle(f"{problem}: error over step size" +
                    (f"\nno panel, at rounding: {', '.join(at_rounding)}" if at_rounding else ""))
    more = [Line2D([], [], color="0.3", marker="o", mfc="white", ls="", label="at rounding")] if hollow_points else []
    save(figure, folder, f"evolving-order-{problem}.png", legend(figure, distinct(rows, "integrator"), more=more, columns=5))


for_each("problem", draw)
