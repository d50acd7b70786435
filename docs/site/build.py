#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the documentation site. docs/build calls it after the packages are installed and the programs are built.

Steps: copy the pages, read the headers by Doxygen, execute the tutorials, draw the gallery, run Sphinx, check the links.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import time

import check
import execute
import gallery
import headers
import pages
import python_names
from pages import ROOT, Failure

HERE = pathlib.Path(__file__).resolve().parent
MARK = ".hilda-site"  # a folder with this file was written by this script
NEEDS = {"hilda": "hilda", "hilda-granular": "hilda-granular", "python/hilda/__init__.py": "the Python package",
         "python/hilda_granular/__init__.py": "the Python package hilda_granular"}


def arguments():
    parser = argparse.ArgumentParser(prog="docs/build", description="Builds the documentation site.")
    parser.error = lambda message: sys.exit(f"hilda: error: docs/build: {message}")
    parser.add_argument("--output", metavar="DIR", default=str(ROOT / "build" / "site"), help="folder of the site (default: build/site)")
    parser.add_argument("--build", metavar="DIR", default=str(ROOT / "build" / "release"),
                        help="build folder with hilda, hilda-granular and python (default: build/release)")
    parser.add_argument("--jobs", metavar="N", type=int, default=len(os.sched_getaffinity(0)), help="number of processes")
    parser.add_argument("--check-arguments", action="store_true", help="check the arguments and do nothing else")
    options = parser.parse_args()
    if options.jobs < 1:
        parser.error(f"--jobs must be at least 1, got {options.jobs}")
    return options


def prepare(output, work):
    """Empties the folders of the site. A folder with other files is refused."""
    for folder in (output, work):
        if folder.is_dir() and any(folder.iterdir()) and not (folder / MARK).exists():
            raise Failure(f"{folder} is not empty and was not written by docs/build; choose another --output or remove it")
        if folder.exists() and not folder.is_dir():
            raise Failure(f"{folder} is a file; choose another --output")
    for entry in ("pages", "doxygen"):
        shutil.rmtree(work / entry, ignore_errors=True)
    shutil.rmtree(output, ignore_errors=True)
    for folder in (output, work):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / MARK).touch()


def run_tutorials(stage, environment, jobs):
    """Executes the front page and the tutorials. Returns the seconds of each."""
    found = [stage / "index.md", *sorted((stage / "docs" / "tutorials").glob("*.md"))]
    found = [path for path in found if execute.BLOCK.search(path.read_text(encoding="utf-8"))]
    outcomes = execute.run_pages(found, environment, jobs)
    for path, outcome in zip(found, outcomes):
        if isinstance(outcome, str):
            raise Failure(f"{path.relative_to(stage)}: a block of the page ends with an error:\n{outcome}")
    return {path.relative_to(stage): outcome for path, outcome in zip(found, outcomes)}


def run_sphinx(stage, output, work, environment, jobs):
    command = [sys.executable, "-m", "sphinx", "-b", "html", "-W", "--keep-going", "-q", "-j", str(jobs), "-c", str(HERE), "-d",
               str(work / "doctrees"), str(stage), str(output)]
    done = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Failure(f"Sphinx reports:\n{(done.stdout + done.stderr).strip().replace(str(stage) + '/', '')}")


def main():
    options = arguments()
    if options.check_arguments:
        return 0
    output, build = pathlib.Path(options.output).resolve(), pathlib.Path(options.build).resolve()
    work, stage = output.with_name(output.name + "-work"), output.with_name(output.name + "-work") / "pages"
    since = time.monotonic()

    def report(text):
        print(f"{time.monotonic() - since:6.1f} s  {text}", flush=True)

    try:
        for file, name in NEEDS.items():
            if not (build / file).exists():
                raise Failure(f"{build} has no {name}; build HILDA there, or give the build folder by --build DIR")
        prepare(output, work)
        environment = {"PATH": f"{build}{os.pathsep}{os.environ.get('PATH', '')}", "PYTHONPATH": str(build / "python"), "MPLBACKEND": "Agg",
                       "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1", "HILDA_SITE_WORK": str(work)}
        sys.path.insert(0, str(build / "python"))
        names = pages.copy(stage)
        pages.copy_front_page(HERE / "index.md", stage / "index.md")
        report(f"{len(names)} pages copied")
        warnings = headers.run_doxygen(work / "doxygen")
        if warnings:
            raise Failure("Doxygen reports:\n" + "\n".join(warnings))
        headers.write_pages(stage)
        python_names.write_pages(stage)
        report(f"{len(headers.installed())} headers read")
        times = run_tutorials(stage, environment, options.jobs)
        report(f"{len(times)} pages executed in {sum(times.values()):.0f} s of run time")
        report(f"{gallery.write(stage, work, environment, options.jobs)} studies drawn for the gallery")
        pages.add_navigation(stage)
        run_sphinx(stage, output, work, environment, options.jobs)
        report("pages written")
        faults, counts = check.site(output)
        if faults:
            raise Failure("the site has faults:\n" + "\n".join(faults))
        report(f"{counts['pages']} pages and {counts['links']} links checked; {output}/index.html")
    except (Failure, OSError) as error:
        sys.exit(f"hilda: error: docs/build: {error}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
