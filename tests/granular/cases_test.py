#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Built-in cases of hilda-granular: their list, their files, runs by name, and wrong names.

    cases_test.py PROGRAM
"""
import json
import re
import sys
import tempfile

from case_runs import Runs, expect


def listed(runs):
    """Names and notes; no name is that of a validation"""
    ended = runs.run("cases")
    expect(ended.returncode == 0 and ended.stderr == "", f"{ended.stderr}")
    names = re.findall(r"^(\w+)  +\S", ended.stdout, re.MULTILINE)
    expect({"bed", "shaken_box"} <= set(names), f"names: {ended.stdout}")
    unknown = runs.run("bedd").stderr
    validations = re.search(r"validations: (.*); cases: (.*)\n", unknown)
    expect(validations[2].split(", ") == names, f"the message has the same names: {unknown}")
    expect(not set(validations[1].split(", ")) & set(names), f"a name is that of a validation as well: {unknown}")
    return names


def written(runs, names):
    """Files of the cases: to stdout, to a file, to a folder; a changed file is kept"""
    text = runs.run("cases", "bed").stdout
    expect(json.loads(text)["name"] == "bed", f"stdout has the file: {text}")
    for to, file in (("bed.json", "bed.json"), (".", "bed.json"), ("other.json", "other.json")):
        ended = runs.run("cases", "bed", "--write", to)
        expect(ended.returncode == 0 and (runs.folder / file).read_text() == text, f"--write {to}: {ended.stderr}")
    ended = runs.run("cases", "--write", "all")
    expect(ended.returncode == 0 and sorted(file.stem for file in (runs.folder / "all").iterdir()) == names, f"{ended.stderr}")
    (runs.folder / "all" / "bed.json").write_text("{}")
    for given in (("bed", "--write", "all"), ("--write", "all")):
        ended = runs.run("cases", *given)
        expect(ended.returncode == 2 and "bed.json exists and is another case" in ended.stderr, f"{given}: {ended.stderr}")
    (runs.folder / "bed.json").unlink()


def run_by_name(runs, names):
    """A case by name, with options, writes the results of its file to out/NAME"""
    options = "--quiet", "--end", "1e-4", "--set", "/laws/0/mu=0.1"
    for name in names:
        ended = runs.run(name, *options)
        expect(ended.returncode == 0, f"{name}: {ended.stderr}")
        ended = runs.run(f"all/{name}.json", *options, "--output", f"file/{name}")
        expect(ended.returncode == 0 and runs.sha(f"out/{name}") == runs.sha(f"file/{name}"), f"{name}: {ended.stderr}")
    # Files and folders in the working directory do not change the meaning of a word.
    for word in ("schema", "laws", "cases", "bed"):
        (runs.folder / word).mkdir()
    for word in ("schema", "laws", "cases"):
        ended = runs.run(word)
        expect(ended.returncode == 0 and ended.stdout, f"{word} beside a folder {word}: {ended.stderr}")
    ended = runs.run("bed", *options)
    expect(ended.returncode == 2 and "out/bed" in ended.stderr, f"bed beside a folder bed: {ended.stderr}")
    for word in ("schema", "laws", "cases", "bed"):
        (runs.folder / word).rmdir()
    # A file with such a name is given with its folder.
    (runs.folder / "bed").write_text("{}")
    ended = runs.run("./bed", "--output", "none")
    expect(ended.returncode == 3 and ended.stderr.startswith("hilda: error: ./bed:1:1 (/): "), f"{ended.stderr}")
    (runs.folder / "bed").unlink()


def wrong(runs):
    """Wrong words and places"""
    for given, code, message in (
            (("cases", "bedd"), 2, "granular: unknown case 'bedd'; did you mean 'bed'?"),
            (("bed", "other"), 2, "granular: one argument too many: 'other'"),
            (("bed", "--write", "x.json"), 2, "granular: --write: is valid after cases only"),
            (("cases", "--end", "1"), 2, "granular: --end: is valid for cases only, but cases is a command"),
            (("cases", "--write", "x.json"), 2, "granular: --write without NAME writes all cases to a folder; 'x.json' is the name "
                                                "of a file"),
            (("bed", "--set", "/laws/0/mu=-1"), 3, 'bed:5:38 (/laws/0/mu): mu must not be negative, got -1 '
                                                   '(from --set "/laws/0/mu=-1")'),
            (("bad.json",), 3, "bad.json: does not exist")):
        ended = runs.run(*given)
        expect(ended.returncode == code and ended.stderr == f"hilda: error: {message}\n", f"{given}: {ended.stderr}")
    for word, meant in (("hoper", "hopper"), ("shaken_bx", "shaken_box")):
        ended = runs.run(word)
        start = f"hilda: error: {word}: does not exist; did you mean '{meant}'? validations: "
        expect(ended.returncode == 3 and ended.stderr.startswith(start), f"{word}: {ended.stderr}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        names = listed(runs)
        written(runs, names)
        runs.remove("all")
        runs.run("cases", "--write", "all")
        run_by_name(runs, names)
        wrong(runs)
    print(f"built-in cases: {', '.join(names)}")


if __name__ == "__main__":
    main()
