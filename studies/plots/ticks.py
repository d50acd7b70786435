# SPDX-License-Identifier: GPL-3.0-or-later
"""Ticks of logarithmic axes whose labels do not overlap, also below one decade."""
import math

from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullFormatter

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


def tidy(axis):
    """Labels of a logarithmic axis. Axes of two decades or more keep their ticks; the minor ticks have no labels."""
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
