# SPDX-License-Identifier: GPL-3.0-or-later
"""Ticks whose labels do not overlap, on logarithmic axes also below one decade."""
import math

from matplotlib.ticker import AutoLocator, FixedLocator, FuncFormatter, MaxNLocator, NullFormatter

HEIGHT = 0.22  # least distance of labels on a vertical axis [inch]


def are_plain(ticks):
    return 1e-3 <= min(ticks) and max(ticks) < 1e4


def parts(x):
    """Mantissa and exponent of a number, as texts"""
    mantissa, exponent = f"{x:.5e}".split("e")
    return mantissa.rstrip("0").rstrip("."), str(int(exponent))


def label(x, plain):
    """A number as a label: 0.002 or, unless plain, 2 x 10^-3"""
    if plain:
        return f"{x:.12g}"
    mantissa, exponent = parts(x)
    return f"$10^{{{exponent}}}$" if mantissa == "1" else rf"${mantissa}\times10^{{{exponent}}}$"


def width(x, plain):
    """About the width of a label with a blank after it [inch]"""
    return 0.12 + 0.09 * (len(f"{x:.12g}") if plain else len(parts(x)[0]) + 5)


def candidates(low, high):
    """Sets of ticks from low to high, from many to few"""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    for mantissas in ((1, 2, 5), (1, 3), (1,)):
        ticks = [m * 10.0 ** e for e in range(first, last + 1) for m in mantissas]
        yield [x for x in ticks if low <= x * (1 + 1e-9) and x * (1 - 1e-9) <= high]


def are_crowded(axis):
    """Whether the labels of a horizontal axis are nearer to each other than the width of a digit"""
    low, high = sorted(axis.get_view_interval())
    labels = axis.get_majorticklabels()  # this updates the ticks
    labels = [label for label, at in zip(labels, axis.get_majorticklocs()) if low <= at <= high and label.get_visible()]
    boxes = [label.get_window_extent() for label in labels if label.get_text()]
    least = 0.6 * axis.axes.figure.dpi / 72 * (labels[0].get_fontsize() if labels else 0)
    return any(right.x0 - left.x1 < least for left, right in zip(boxes, boxes[1:]))


def thin_out(axis):
    """Fewer ticks on a horizontal linear axis with crowded labels"""
    if axis.axis_name != "x" or axis.axes.name == "3d" or not isinstance(axis.get_major_locator(), AutoLocator):
        return
    for most in (9, 7, 6, 5, 4, 3):
        if not are_crowded(axis):
            return
        axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]))


def tidy(axis):
    """Labels of an axis. Logarithmic axes of two decades or more keep their ticks; the minor ticks have no labels."""
    if axis.get_scale() == "linear":
        thin_out(axis)
        return
    if axis.get_scale() != "log" or axis.get_transform().base != 10:
        return
    axis.set_minor_formatter(NullFormatter())
    low, high = sorted(axis.get_view_interval())
    if not 0 < low < high or high / low >= 100:
        return
    name = axis.axis_name
    box = axis.axes.get_window_extent()
    length = (box.width if name == "x" else box.height) / axis.axes.figure.dpi

    def fits(ticks):
        return len(ticks) >= 2 and all(
            length * math.log(b / a) / math.log(high / low) >
            (HEIGHT if name == "y" else max(width(x, are_plain(ticks)) for x in (a, b)))
            for a, b in zip(ticks, ticks[1:]))
    ticks = next(filter(fits, candidates(low, high)), None)
    for most in (4, 3, 2, 1):
        ticks = ticks or next(filter(fits, [[x for x in MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
                                             if low <= x <= high]]), None)
    ticks = ticks or [math.sqrt(low * high)]
    plain = are_plain(ticks)
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_major_formatter(FuncFormatter(lambda x, _: label(x, plain)))
