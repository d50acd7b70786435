# SPDX-License-Identifier: GPL-3.0-or-later
"""Straight lines that show a slope in logarithmic axes, with labels that do not overlap the curves, each other or a legend."""
import numpy as np

GAP = 2.5  # between a label and what is beside it [points]


def guide(axes, slope, points, above=False, size=8):
    """A straight line of this slope above or below the points (h, error). place_labels() moves its label."""
    h = [min(x for x, _ in points), max(x for x, _ in points)]
    ratios = [e / x ** slope for x, e in points]
    factor = 2 * max(ratios) if above else min(ratios) / 2
    line, = axes.plot(h, [factor * x ** slope for x in h], "--", color="0.5", lw=0.9, zorder=1)
    label = axes.annotate(f"slope {slope}", (h[0], factor * h[0] ** slope), xytext=(0, 0), textcoords="offset points",
                          fontsize=size, color="0.35", zorder=90)
    label.slope_guide = line, above


def guides(axes, by_order, size=8):
    """A guide for each order: above the points of the lowest order, below those of the others. An order with less than two
    steps has none."""
    by_order = {order: points for order, points in sorted(by_order.items()) if len({h for h, _ in points}) > 1}
    if by_order:
        axes.margins(y=0.12)  # room for the text above the uppermost line
    for order, points in by_order.items():
        guide(axes, order, points, above=order == min(by_order), size=size)


def on_curve(axes, line):
    """Points of a line each two pixels, and the half width of the line or its marker there [pixel], as rows x, y, width"""
    vertices = axes.transData.transform(np.column_stack(line.get_data()).astype(float))
    vertices = vertices[np.isfinite(vertices).all(axis=1)]
    pixels_per_point = axes.figure.dpi / 72
    rows = []
    if line.get_marker() not in (None, "None", "", " "):
        rows.append(np.column_stack([vertices, np.full(len(vertices), 0.5 * line.get_markersize() * pixels_per_point)]))
    if line.get_linestyle() not in (None, "None", "", " "):
        for begin, end in zip(vertices, vertices[1:]):
            count = min(2000, 2 + int(np.hypot(*(end - begin)) / 2))
            part = begin + np.linspace(0, 1, count)[:, None] * (end - begin)
            rows.append(np.column_stack([part, np.full(count, 0.5 * line.get_linewidth() * pixels_per_point)]))
    return np.concatenate(rows) if rows else np.zeros((0, 3))


def overlap(a, b):
    """Area that two boxes (x0, y0, x1, y1) have in common"""
    return max(0, min(a[2], b[2]) - max(a[0], b[0])) * max(0, min(a[3], b[3]) - max(a[1], b[1]))


def count_in(box, curves):
    """The number of points of the curves that a box covers"""
    x, y, half = curves.T
    return np.count_nonzero((x > box[0] - half) & (x < box[2] + half) & (y > box[1] - half) & (y < box[3] + half))


def cost_of_label(box, panel, curves, others):
    """0 for a box inside of the panel that overlaps nothing"""
    outside = (box[2] - box[0]) * (box[3] - box[1]) - overlap(box, panel)
    return count_in(box, curves) + 10 * outside + 10 * sum(overlap(box, other) for other in others)


def cost_of_line(begin, end, panel, curves, gap):
    """0 for a line inside of the panel that is beside all curves"""
    outside = sum(max(0, panel[1] + gap - y) + max(0, y + gap - panel[3]) for y in (begin[1], end[1]))
    x, y, half = curves.T
    distance = abs(np.interp(x, [begin[0], end[0]], [begin[1], end[1]]) - y)
    along = (x > begin[0] - half) & (x < end[0] + half)
    return np.count_nonzero(along & (distance < half + gap)) + 10 * outside


def best_place(line, size, panel, curves, others, above, gap):
    """Where a guide and its label overlap as little as possible: nothing, if there is such a place, and then the one nearest to
    the points and to the middle of the line. `line`: its ends [pixel]; `size`: of the label. Returns the shift of the line
    [pixel], the part of the line at which the label is, whether it is above it, and its box."""
    away = 1 if above else -1
    shifts = sorted([(k, side * away) for k in range(60) for side in (1, -1) if k > 0 or side > 0])
    best = None
    for k, side in shifts:
        shift = 3 * k * side
        begin, end = line + np.array([0, shift])
        along = cost_of_line(begin, end, panel, curves, gap)
        if best is not None and along >= best[0]:
            continue
        for part in sorted(np.linspace(0, 1, 41), key=lambda p: abs(p - 0.5)):
            for is_above in (above, not above):
                corner = begin + part * (end - begin) + gap * np.array([-1, 1] if is_above else [1, -1])
                # Above a rising line the corner is the lower right one of the text, below it the upper left one.
                x, y = corner - np.array([size[0], 0] if is_above else [0, size[1]])
                box = np.array([x, y, x + size[0], y + size[1]])
                wider = box + 0.5 * gap * np.array([-1, -1, 1, 1])
                total = along + cost_of_label(wider, panel, curves, others)
                if best is None or total < best[0]:
                    best = total, shift, part, is_above, box
        if best[0] == 0:
            break
    return best[1:]


def place_labels(figure):
    """Moves the guides and their labels to places where they do not overlap the curves and each other: see best_place(). To be
    called after the layout of the figure."""
    renderer = figure.canvas.get_renderer()
    gap = GAP * figure.dpi / 72
    for axes in figure.axes:
        labels = [text for text in axes.texts if hasattr(text, "slope_guide")]
        if not labels:
            continue
        lines = [label.slope_guide[0] for label in labels]
        panel = axes.get_window_extent(renderer).extents
        curves = np.concatenate([on_curve(axes, line) for line in axes.lines if line not in lines] + [np.zeros((0, 3))])
        others = [text.get_window_extent(renderer).extents for text in axes.texts if text not in labels and text.get_text()]
        if axes.get_legend() is not None:
            others.append(axes.get_legend().get_window_extent(renderer).extents)
        for label in labels:
            line, above = label.slope_guide
            extent = label.get_window_extent(renderer)
            ends = axes.transData.transform(np.column_stack(line.get_data()).astype(float))
            shift, part, is_above, box = best_place(ends, (extent.width, extent.height), panel, curves, others, above, gap)
            low, high = axes.get_ylim()
            line.set_ydata(np.asarray(line.get_ydata()) * (high / low) ** (shift / (panel[3] - panel[1])))
            label.xy = axes.transData.inverted().transform(ends[0] + part * (ends[1] - ends[0]) + np.array([0, shift]))
            label.set(ha="right" if is_above else "left", va="bottom" if is_above else "top",
                      position=(-GAP, GAP) if is_above else (GAP, -GAP))
            others.append(box)
            curves = np.concatenate([curves, on_curve(axes, line)])
