# SPDX-License-Identifier: GPL-3.0-or-later
"""The gallery of studies."""
from pages import write as write_page


def write(stage, work, environment, all_studies, jobs):
    write_page(stage / "gallery" / "index.md", "# Gallery\n")
    return 0, 0
