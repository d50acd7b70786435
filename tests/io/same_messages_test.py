#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The same mistake in a model and in a granular case gives the same message: place, rule, value and remedy.

    same_messages_test.py HILDA HILDA_GRANULAR
"""
import pathlib
import re
import subprocess
import sys
import tempfile

MODEL = """{"hilda_model": 1, "name": "input",
 "note": "n",
 "gravity": [0, 0, -9.81], "end": 1,
 "bodies": [{"name": "a", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 1]},
            {"name": "b", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 2]}]}
"""
CASE = """{"hilda_case":  1, "name": "input",
 "note": "n",
 "gravity": [0, 0, -9.81], "end": 1,
 "domain": {"low": [0, 0, 0], "high": [1, 1, 1]}, "step": 1e-5,
 "materials": [{"name": "a", "density": 1, "E": 7e7, "nu": 0.2},
               {"name": "b", "density": 1, "E": 7e7, "nu": 0.2}]}
"""
# (text to replace, replacement): the lines 1 to 3 of both files are equal but for the kind of file
EDITS = [
    ('"note": "n"', '"note": 5'), ('"note": "n"', '"note": "n'), ('"note": "n"', '"note": "\\q"'), ('"note": "n"', '"note": "\t"'),
    ('"note": "n"', '"note": "\\ud800"'), ('"note": "n"', '"nöte": "n"'), ('"note": "n"', '"note" "n"'), ('"note": "n"', '"note": n'),
    ('"note": "n"', '"note": "n", "note": "m"'), ('"note": "n"', "'note': 1"), ('"note": "n"', '"note": "n", // comment'),
    ('"note": "n"', '"note": ' + 70 * "["), ('"note": "n"', '"note": "' + 5000 * "n" + '"'),
    ('"gravity"', '"gravty"'), ('"end": 1', '"end": 0'), ('"end": 1', '"end": -1'), ('"end": 1', '"end": true'), ('"end": 1', '"end": NaN'),
    ('"end": 1', '"end": 1e999'), ('"end": 1', '"end": 01'), ('"end": 1', '"end": 99999999999999999999'), ('"end": 1', '"end": {}'),
    ('"end": 1,', '"end": 1'), ('"end": 1,', '"end": 1,,'), ("[0, 0, -9.81]", "[0, -9.81]"), ("[0, 0, -9.81]", "[0, 0, null]"),
    ("[0, 0, -9.81]", "[0, 0, -9.81,]"), ("[0, 0, -9.81]", "9.81"), ("[0, 0, -9.81]", '"down"'), ('"name": "input"', '"name": 7'),
    ("]}\n", "]} x"), ("]}\n", "]}\0"), ("]}\n", "]}{}"), ("]}\n", "]"), ('"name": "b"', '"name": "a"'), ('"name": "b"', '"name": ""'),
    ('"name": "b"', '"name": "b\\n"'), ('"name": "b", ', ""),
]
SETS = ["end=1", "/end", "/end=-1", "/end=true", "/end=null", "/gravity/3=1", "/gravity/-1=1", "/gravity/x=1", "/nothing/x=1", "/a~2=1", "/gravty=1",
        "/end={\"a\": 1, \"a\": 2}", "/note=5", "/gravity=[1]", "/gravity=[1", "/name={}"]


def main():
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "input.json"

        def message(command, text, changes=()):
            path.write_bytes(text.encode())
            options = [option for change in changes for option in ("--set", change)]
            done = subprocess.run(command + options, cwd=folder, capture_output=True)
            return done.returncode, done.stderr.decode(errors="replace")

        def compare(what, edit, changes=()):
            model = message([sys.argv[1], "check", "input.json"], edit(MODEL), changes)
            case = message([sys.argv[2], "input.json", "--output", "out"], edit(CASE), changes)
            # Where the two kinds of file differ: the names of lists, the lines below the first three, lists of other keys
            same = lambda text: re.sub(r"allowed: .*|input.json:[4-9]:\d+|\d+ keys|^hilda: error: (granular: )?", "*",
                                       text.replace("bodies", "materials").replace('"domain"', '"materials"'))
            if model[0] not in (2, 3) or model[0] != case[0] or same(model[1]) != same(case[1]):
                faults.append(f"{what}:\n  model {model}\n  case  {case}")
            if model[0] == 3 and not re.match(r"hilda: error: input\.json:\d+:\d+ \(/[^ ]*\): .*\n$", case[1]):
                faults.append(f"{what}: no place in one line: {case}")

        for old, new in EDITS:
            assert old in MODEL and old in CASE
            compare((old, new[:60]), lambda text, old=old, new=new: text.replace(old, new, 1))
        for change in SETS:
            compare(f"--set {change}", lambda text: text, [change])
        compare("byte order mark", lambda text: "\ufeff" + text.replace('"end": 1', '"end": -1'))
        compare("empty file", lambda text: "")

    for fault in faults:
        print(fault)
    print(f"{len(EDITS) + len(SETS) + 2} mistakes, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
