# SPDX-License-Identifier: GPL-3.0-or-later
"""What the results of studies have in common."""

from __future__ import annotations

from typing import Any, Iterable


class Table:
    """A result with rows."""

    def rows(self) -> list[dict[str, Any]]:
        """The table as a list of rows."""
        raise NotImplementedError

    def to_pandas(self) -> Any:
        """The table as a pandas.DataFrame."""
        import pandas

        return pandas.DataFrame(self.rows())


def aligned(cells: Iterable[list[str]]) -> list[str]:
    """Lines of a table of texts, the columns aligned on the right."""
    lines = list(cells)
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    return ["  ".join(cell.rjust(width) for cell, width in zip(line, widths)) for line in lines]


def new_axes() -> Any:
    """Matplotlib axes in a new figure."""
    import matplotlib.pyplot as plt

    return plt.subplots(layout="constrained")[1]
