# SPDX-License-Identifier: GPL-3.0-or-later
"""Mean loads on the boundaries of a granular run, of loads.csv, with bands of one standard deviation."""
import drawing
import options
from drawing import COLOURS, Line2D, axis, lines_below, numbers, plt, read

PANELS = [("F", "force", "N"), ("T", "torque", "N m")]


def draw(folder, quantities):
    """Writes loads.png: a panel for each component that is not zero, a curve for each boundary."""
    rows = read(folder, "loads.csv")
    boundaries = [name.removesuffix("_Fx_mean") for name in rows[0] if name.endswith("_Fx_mean")] if rows else []
    size = {b: max(abs(v) for a in "xyz" for v in numbers(rows, f"{b}_F{a}_mean")) for b in boundaries}
    shown = sorted((b for b in boundaries if size[b] > 0), key=lambda b: -size[b])[:options.MOST_CURVES]
    panels = [(f"{kind}{a}", f"{name} {a} [{unit}]") for kind, name, unit in PANELS if name in quantities for a in "xyz"
              if any(any(numbers(rows, f"{b}_{kind}{a}_mean")) for b in shown)]
    if not panels:
        return
    lines, columns = -(-len(panels) // 3), min(3, len(panels))
    figure, all_axes = plt.subplots(lines, columns, figsize=(max(6, 3.6 * columns), 1 + 2.9 * lines), squeeze=False)
    t = numbers(rows, "t")
    for (load, label), axes in zip(panels, all_axes.flat):
        for k, b in enumerate(shown):
            mean, deviation = numbers(rows, f"{b}_{load}_mean"), numbers(rows, f"{b}_{load}_std")
            axes.plot(t, mean, "o-", ms=3, lw=1.1, color=COLOURS[k])
            axes.fill_between(t, [m - s for m, s in zip(mean, deviation)], [m + s for m, s in zip(mean, deviation)],
                              color=COLOURS[k], alpha=0.15, lw=0)
        axis(axes, "$t$ [s]", "mean " + label)
    for axes in list(all_axes.flat)[len(panels):]:
        axes.remove()
    options.leave_out([b for b in boundaries if size[b] > 0 and b not in shown])
    below = lines_below(figure, [Line2D([], [], color=COLOURS[k], marker="o", ms=3, label=b) for k, b in enumerate(shown)])
    drawing.save(figure, folder, "loads.png", below, top=1)
    options.leave_out([])
