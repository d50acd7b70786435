# SPDX-License-Identifier: GPL-3.0-or-later
"""Executes the Python blocks of the tutorials. The copies on the site have the printed text and the figures after each block.

    execute.py PAGE.md     replaces the page by the one with output; figures are written beside it
"""
import concurrent.futures
import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

BLOCK = re.compile(r"^```python\n(.*?)^```\n", re.S | re.M)
STYLE = {"figure.constrained_layout.use": True, "figure.figsize": (6.4, 3.8), "figure.dpi": 100, "savefig.dpi": 150, "font.size": 10,
         "axes.grid": True, "grid.alpha": 0.3,
         "axes.prop_cycle": "cycler('color', ['#1f5fa8', '#d1622b', '#3a8a4d', '#8c4fa0', '#7a6a53', '#c23b5a'])"}


def blocks(text):
    """The Python blocks of a page, as matches."""
    return BLOCK.finditer(text)


def run_page(page):
    """Executes a page in this process and writes it with its output."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    plt.rcParams.update(STYLE)
    text = page.read_text(encoding="utf-8")
    names, out, end, figures = {"__name__": "__main__"}, [], 0, 0
    for block in blocks(text):
        line = text.count("\n", 0, block.start(1))
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("\n" * line + block[1], str(page), "exec"), names)
        out.append(text[end:block.end()])
        end = block.end()
        if printed.getvalue().strip():
            out.append(f"\n```{{code-block}} text\n:class: output\n\n{printed.getvalue().rstrip()}\n```\n")
        for number in plt.get_fignums():
            figure = plt.figure(number)
            figures += 1
            file = f"{page.stem}-{figures}.png"
            figure.savefig(page.parent / file)
            about = figure.get_label() or f"Figure {figures} of this page"
            out.append(f"\n![{about}]({file})\n")
            plt.close(figure)
    out.append(text[end:])
    page.write_text("".join(out), encoding="utf-8")


def run_pages(pages, environment, jobs):
    """Executes pages, each in its own process and in an empty folder. Returns seconds or error of each."""
    def run(page):
        since = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, str(pathlib.Path(__file__).resolve()), str(page)], cwd=folder,
                                  env={**os.environ, **environment}, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            return done.stderr.strip()
        return time.monotonic() - since
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(run, pages))


if __name__ == "__main__":
    run_page(pathlib.Path(sys.argv[1]))
