# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures of the dissertation that the pages claim are those of docs/results/dissertation-figures.md, and each of them
is computed: its study writes the tables, with the columns that the page names.

    HILDA_PROGRAM=build/release/hilda python3 tests/docs/figures_test.py

Studies that take some seconds are run. Of the others the list of files of the program and the columns of docs/guide/outputs.md
are compared.
"""
import csv
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["HILDA_PROGRAM"]
SHORT = {"friction", "evolving-contact", "snapshots"}
# Columns of all studies, in outputs.md before the table of the studies
COMMON = {"h", "t", "cpu_seconds", "bodies", "rows", "degrees_of_freedom"}
CLAIMS = ["studies/README.md", "docs/reference/commands.md", "docs/results/README.md", "docs/guide/reproduce.md",
          "studies/program/repeating/reproduction.cpp"]


def numbers(text):
    """The figures and tables of a text such as "Figs. 3.4, 3.6-3.8, Table 3.1": 3.4, 3.6, 3.7, 3.8, Table 3.1"""
    found = set()
    for word, first, last in re.findall(r"(Table )?(\d\.\d+)(?:(?:-| to )(\d\.\d+))?", text):
        chapter, number = first.split(".")
        end = int(last.split(".")[1]) if last else int(number)
        found |= {f"{word}{chapter}.{k}" for k in range(int(number), end + 1)}
    return found


def rows():
    """(figures, study, {table: columns}) of each row of the page with a command"""
    study = ""
    for line in (ROOT / "docs/results/dissertation-figures.md").read_text(encoding="utf-8").split("\n"):
        cells = line.split(" | ")
        if len(cells) != 5 or not line.startswith("| ") or "---" in line:
            continue
        command = re.search(r"`hilda study ([a-z-]+)", cells[2])
        if command:
            study = command.group(1)
        elif "the same" not in cells[2]:
            continue
        tables = {name: re.findall(r"`(\w+)`", columns) for name, columns in re.findall(r"([\w-]+\.csv)(?: \(([^)]*)\))?", cells[3])}
        yield cells[0].lstrip("| "), study, tables


def documented():
    """{(study, table): columns} of docs/guide/outputs.md"""
    text = (ROOT / "docs/guide/outputs.md").read_text(encoding="utf-8")
    found = {}
    for studies, tables, content in re.findall(r"^\| `([\w-]+)`, ([\w.,* -]+\.csv) \| (.*) \|$", text, re.M):
        names = set(re.findall(r"`(\w+)`", content))
        for table in tables.split(", "):
            found.setdefault((studies, table), set()).update(names)
    section = text[text.index("### convergence"):]
    found["convergence", "study.csv"] = set(re.findall(r"`(\w+)`", section[:section.index("\n### ", 5)]))
    return found


class Figures(unittest.TestCase):
    def test_each_figure_has_tables_with_columns(self):
        count = 0
        for figures, study, tables in rows():
            with self.subTest(figures):
                self.assertTrue(tables, "a figure has a table")
                for table, columns in tables.items():
                    self.assertTrue(columns, f"{table}: the columns of the figure are named")
                count += 1
        self.assertGreater(count, 35)

    def test_the_columns_are_those_of_the_studies(self):
        columns_of = documented()
        folders = {}
        with tempfile.TemporaryDirectory() as parent:
            for study in SHORT:
                folders[study] = pathlib.Path(parent) / study
                subprocess.run([PROGRAM, "study", study, "--no-plot", "--quiet", "--output", folders[study]], check=True)
            for figures, study, tables in rows():
                files = subprocess.run([PROGRAM, "help", "study", study], check=True, capture_output=True, text=True).stdout
                for table, columns in tables.items():
                    with self.subTest(f"{figures}: {study}, {table}"):
                        if study in SHORT:
                            name = "loop.csv" if table == "SCENE.csv" else table
                            with open(folders[study] / name, encoding="utf-8") as file:
                                lines = list(csv.reader(file))
                            self.assertLessEqual(set(columns), set(lines[0]))
                            self.assertGreater(len(lines), 2)
                        else:
                            self.assertIn(table, files.replace(",", " ").split())
                            same = columns_of[study, "study.csv"] if table == "motion.csv" else set()  # "the same quantities"
                            self.assertLessEqual(set(columns), columns_of[study, table] | same | COMMON)

    def test_claimed_figures_are_on_the_page(self):
        on_page = set().union(*(numbers(figures) for figures, _, _ in rows()))
        for name in CLAIMS:
            text = (ROOT / name).read_text(encoding="utf-8")
            for claim in re.findall(r"Figs?\. (?:[\d., -]|and |to |Table |Fig\. )*\d", text):
                with self.subTest(f"{name}: {claim}"):
                    self.assertLessEqual(numbers(claim), on_page)


if __name__ == "__main__":
    unittest.main()
