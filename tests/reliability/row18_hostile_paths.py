#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 18: hostile paths as model, case, table of a fill, samples of a model and output folder are refused within 1 s."""
import os

import matrix
import model as models


def case_with(file):
    return {"hilda_case": 1, "domain": {"low": [0, 0, 0], "high": [1, 1, 1]}, "step": 1e-6, "end": 1e-5,
            "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
            "laws": [{"restitution": 0.7, "mu": 0.3}],
            "fill": [{"type": "csv", "file": file}]}


def main():
    row = matrix.Row("18 hostile paths")
    with matrix.scratch() as folder:
        os.mkfifo(folder / "pipe")
        (folder / "pipe.json").symlink_to("pipe")
        (folder / "loop.json").symlink_to("loop.json")
        (folder / "nowhere.json").symlink_to("/nowhere/model.json")
        (folder / "secret").write_text("precious")
        (folder / "folder.json").mkdir()
        (folder / "cases").mkdir()
        (folder / "table.csv").write_text("x,y,z,radius\n0.5,0.5,0.5,1e-3\n")
        (folder / "cases/link.csv").symlink_to("../table.csv")
        (folder / "bench.json").write_text(models.text(models.valid()))

        def refused(what, command, codes=(3, 5, 2)):
            before = matrix.now()
            ended = row.run(command, cwd=folder, limit=20, stdin=-3)
            fast = ended.seconds < 1 and matrix.now() - before < 15
            kept = (folder / "secret").read_text() == "precious"
            row.case(what, ended.code in codes and matrix.is_one_line(ended.err) and fast and kept,
                     f"exit {ended.code}, {ended.seconds:.2f} s: {ended.err}")

        for path in ("", "pipe", "pipe.json", "/dev/zero", "/dev/random", "loop.json", "nowhere.json", "folder.json",
                     "a" * 300 + ".json", "../" * 40 + "nowhere.json", "a\nb.json"):
            refused(f"model {path!r}", [row.hilda, "check", path], (2, 3, 5))
            if path != "a\nb.json":
                refused(f"case {path!r}", [row.granular, path, "--output", "out"], (3,))
                refused(f"problem {path!r}", [row.hilda, "study", "energy", "--problem", path, "--output", "out"])
        for path in ("../table.csv", str(folder / "table.csv"), "cases/link.csv", "/etc/passwd", "/dev/zero",
                     "cases/../../secret"):
            (folder / "cases/bad.json").write_text(models.text(case_with(path)))
            refused(f"table {path!r}", [row.granular, "cases/bad.json", "--output", "out"], (3,))
        for path in ("../table.csv", str(folder / "table.csv"), "link.csv", "/etc/passwd", "/dev/zero", "../secret"):
            model = models.valid()
            model["constraints"] = [{"name": "motor", "type": "hinge-driver", "body_i": "ground", "body_j": model["bodies"][0]["name"],
                                     "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1], "angle": {"file": path, "column": "x"}}]
            (folder / "cases/bad.json").write_text(models.text(model))
            refused(f"samples {path!r}", [row.hilda, "check", "cases/bad.json"], (3,))
        for path in ("secret", "secret/out", "/dev/null", "/proc/out"):
            refused(f"output {path!r}", [row.hilda, "run", "bench.json", "--end", "0.01", "--output", path], (2, 5))
    row.end()


main()
