# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python examples of the documentation run."""

import contextlib
import io
import pathlib
import re
import tempfile
import unittest

import matplotlib

matplotlib.use("Agg")
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def check_pages(test, package, expected):
    """Runs the blocks of the pages that import a package, each page in an environment of its own."""
    # The tutorials and the front page of the site are executed by tests/docs/site_test.py.
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    pages = [page for page in pages if f"\nimport {package}\n" in page.read_text() and page.parent.name not in ("tutorials", "site")]
    test.assertTrue({ROOT / page for page in expected} <= {*pages})
    for page in pages:
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            pathlib.Path("examples").symlink_to(ROOT / "examples")  # the commands of the pages are given at the root of a clone
            check_page(test, page)


def check_page(test, page):
    names = {}
    text = page.read_text()
    for block in re.finditer(r"^```python\n(.*?)^```", text, re.S | re.M):
        line = text.count("\n", 0, block.start(1))
        with test.subTest(page=page.name, line=line + 1), contextlib.redirect_stdout(io.StringIO()):
            exec(compile("\n" * line + block[1], str(page), "exec"), names)


class Pages(unittest.TestCase):
    def test_the_blocks_of_each_page_run_in_their_order(self):
        check_pages(self, "hilda", ["README.md", "docs/guide/python.md"])


if __name__ == "__main__":
    unittest.main()
