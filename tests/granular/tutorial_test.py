#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows a tutorial as a reader does, in an empty folder, and compares what the programs print with the page.

    tutorial_test.py GRANULAR_PROGRAM PAGE.md [PROGRAM]          PROGRAM: hilda, for `hilda plot`
    tutorial_test.py --write GRANULAR_PROGRAM PAGE.md PROGRAM    replaces the output and the figures of the page

The blocks of the page are, in their order:
- json: a whole case, which has the key hilda_case, is the file hopper.json. Other blocks are objects whose keys are added to
  the case, or replace those that it has, as the page says. The last block of the page is the whole file again and must equal it.
- python: a script, whose first line is a comment with its name.
- without a language: commands after `$ ` and the output of each, standard output and standard error together. The text must be
  equal, but for the speed of a run, spaces between columns, line and column in a message, which depend on the layout of the
  file, and warnings during a run. Numbers may differ by a relative 1e-3, or by X if the line before the block is
  <!-- within X -->, because the motions of many grains differ between processors. With 2 the numbers are not compared.

The figure figures/FOLDER-NAME.png of the page is out/FOLDER/NAME.png; --write copies it.
Commands of `hilda plot` are left out without PROGRAM or without matplotlib.
"""
import importlib.util
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)")

FIGURE = re.compile(r"!\[.*\]\((figures/(\w+)-(\S+))\)")


def blocks(text):
    """(language, allowed relative difference, span of the contents) of the code blocks"""
    for found in re.finditer(r"(?:<!-- within (\S+) -->\n)?```(\w*)\n(.*?)^```$", text, re.M | re.S):
        yield found.group(2), float(found.group(1) or 1e-3), found.span(3)


def commands(block):
    """(command, expected output) of a console block"""
    return [tuple(part.split("\n", 1)) for part in re.split(r"^\$ ", block, flags=re.M)[1:]]


def without_what_varies(text):
    text = re.sub(r"[\d.e+-]+ million particle-steps/s", "SPEED", text)
    text = re.sub(r"^hilda: warning: t = .*\n", "", text, flags=re.M)
    return re.sub(r" +", " ", re.sub(r"\.json:\d+:\d+", ".json:LINE", text)).rstrip()


def differ(shown, printed, within):
    """What differs, or None"""
    shown, printed = without_what_varies(shown), without_what_varies(printed)
    if NUMBER.sub("N", shown) != NUMBER.sub("N", printed):
        return "the text differs"
    for a, b in zip(NUMBER.findall(shown), NUMBER.findall(printed)):
        if a != b and not abs(float(a) - float(b)) <= within * max(abs(float(a)), abs(float(b))):
            return f"{b} is printed where the page has {a}, which is beyond the relative difference of {within:g}"
    return None


class Reader:
    """Types what the page says."""

    def __init__(self, granular, program, folder):
        self.granular, self.folder = granular, pathlib.Path(folder)
        self.program = program if importlib.util.find_spec("matplotlib") else None
        self.case = None

    def save(self, text):
        block = json.loads(text)
        self.case = block if "hilda_case" in block else {**self.case, **block}
        (self.folder / "hopper.json").write_text(json.dumps(self.case, indent=1), encoding="utf-8")

    def run(self, command):
        """The output of a command; None if it is left out"""
        words = shlex.split(command)
        if words[:2] == ["hilda", "granular"]:
            words = [self.granular, *words[2:]]
        elif words[0] == "python3":
            words[0] = sys.executable
        elif words[:2] == ["hilda", "plot"]:
            if self.program is None:
                return None
            words[0] = self.program
        else:
            sys.exit(f"failed: the test does not know the command {command}")
        done = subprocess.run(words, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        return done.stdout


def write_figure(source, target):
    """A copy with at most 128 colours, which has a third of the size"""
    from PIL import Image  # matplotlib needs it as well
    target.parent.mkdir(exist_ok=True)
    Image.open(source).convert("RGB").quantize(128).save(target, optimize=True)


def main():
    arguments = [str(pathlib.Path(a).resolve()) for a in sys.argv[1:] if a != "--write"]
    page = pathlib.Path(arguments[1])
    text = page.read_text(encoding="utf-8")
    faults, changes, whole = [], [], None
    with tempfile.TemporaryDirectory() as folder:
        reader = Reader(arguments[0], (arguments + [None])[2], folder)
        for language, within, (begin, end) in blocks(text):
            block, line = text[begin:end], text.count("\n", 0, begin) + 1
            if language == "json":
                before, whole = reader.case, json.loads(block)
                reader.save(block)
            elif language == "python":
                name = re.match(r"# (\w+\.py)\n", block)
                (reader.folder / name.group(1)).write_text(block, encoding="utf-8")
            elif language == "" and block.startswith("$ "):
                printed = []
                for command, shown in commands(block):
                    output = reader.run(command)
                    output = shown if output is None else output.rstrip() + "\n"
                    printed.append(f"$ {command}\n{output}")
                    if fault := differ(shown, output, within):
                        faults.append(f"{page.name}:{line}: $ {command}\n{fault}; printed:\n{output}")
                changes.append((begin, end, "".join(printed)))
        if reader.program is not None:
            for name, *source in FIGURE.findall(text):
                file = reader.folder.joinpath("out", *source)
                if not file.exists():
                    faults.append(f"{page.name}: out/{'/'.join(source)} has not been drawn")
                elif "--write" in sys.argv:
                    write_figure(file, page.parent / name)
        if before != whole:
            faults.append(f"{page.name}: the last JSON block is not the file that the steps have built:\n{json.dumps(before, indent=1)}")
    if "--write" in sys.argv:
        for begin, end, output in reversed(changes):
            text = text[:begin] + output + text[end:]
        page.write_text(text, encoding="utf-8")
    elif faults:
        sys.exit("failed: " + "\n".join(faults))
    else:
        print(f"{len(changes)} blocks of commands print what {page.name} shows")


main()
