#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of hilda-granular: its output folder, the tables that a case may name, and full disks.

    files_test.py PROGRAM
"""
import resource
import subprocess
import sys
import tempfile

from case_runs import Runs, expect


def output_folder(runs, case):
    runs.finish(case, "--quiet")
    expect((runs.folder / "out" / "short" / "summary.json").exists(), "the output is in out/NAME")
    runs.refused(case, 2, "out/short: is not empty; --force overwrites it, --resume continues its run")
    letter = runs.folder / "other" / "letter"
    letter.parent.mkdir()
    letter.write_text("precious")
    runs.refused(case, 2, "other: is not empty", "--output", "other")
    expect(letter.read_text() == "precious", "existing files are not changed")
    runs.refused(case, 5, "short.json/out", "--output", "short.json/out")


def tables(runs):
    """The table of a fill is below the folder of the case, also behind a symbolic link"""
    here = runs.folder
    (here / "below" / "deeper").mkdir(parents=True)
    for folder in (here, here / "below" / "deeper"):
        (folder / "table.csv").write_text("x,y,z,radius\n0.01,0.01,0.02,1e-3\n")
    (here / "below" / "link.csv").symlink_to(here / "table.csv")
    (here / "below" / "folder").symlink_to(here)

    def case(name, path):
        return runs.case(f"below/{name}", end=1e-4, interval=5e-5,
                         fill=[{"type": "csv", "file": path, "material": "glass"}])

    for k, path in enumerate(("deeper/table.csv", f"{here}/below/deeper/table.csv", "../below/deeper/table.csv")):
        runs.finish(case(f"accepted{k}", path), "--quiet", "--output", f"accepted{k}")
    for path in ("../table.csv", f"{here}/table.csv", "deeper/../../table.csv", "link.csv", "folder/table.csv",
                 "/dev/zero", "/etc/passwd", "../none.csv"):
        message = rf'\(/fill/0/file\): file must be below the folder of the case, \S+/below, got "{path}"; ' \
                  "--allow-paths accepts it"
        runs.refused(case("refused", path), 3, message)
        expect(not (here / "out/refused").exists(), "a refused case writes no files")
    # relative to the case: the table of this name in the working directory is not read
    runs.refused(case("refused", "table.csv"), 3, r"\(/fill/0/file\): below/table.csv: does not exist")
    runs.finish(case("elsewhere", "../table.csv"), "--quiet", "--output", "elsewhere", "--allow-paths")
    runs.refused(case("refused", "/dev/zero"), 3, "/dev/zero: is not a regular file", "--allow-paths")


def full_disks(runs):
    case = ("short.json", "--output", "stdout", "--force", "--json")
    for arguments in case, (*case, "--quiet"), ("oblique", "--verbose"):
        with open("/dev/full", "w", encoding="ascii") as full:
            ended = runs.run(*arguments, stdout=full)
        expect(ended.returncode == 5 and ended.stderr.endswith("hilda: error: standard output: cannot be written\n"),
               f"{ended.returncode}: {ended.stderr}")
    ended = runs.run("short.json", "--output", "full", "--quiet", "--threads", "1", stdout=subprocess.DEVNULL,
                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000)))
    expect(ended.returncode == 5 and "File too large" in ended.stderr, f"{ended.returncode}: {ended.stderr}")
    expect(not list((runs.folder / "full").rglob("*.tmp")), "incomplete files are deleted")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        output_folder(runs, runs.case("short", end=1e-4, interval=5e-5))
        tables(runs)
        full_disks(runs)
    print("the output folder, tables of particles and full disks")


if __name__ == "__main__":
    main()
