#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the reference pages in docs/reference from the JSON schemas and from the help texts of the programs.

    docs/generate.py                                            model-file.md, case-file.md and case-keys.md
    docs/generate.py --program HILDA --granular HILDA_GRANULAR  commands.md as well
    docs/generate.py --check [...]                              compares with the files and writes nothing

Exit code 1: a page is out of date (--check), or a schema or a program cannot be read.
"""
import argparse
import json
import os
import re
import subprocess
import sys

from markdown_text import NONE, anchor, code, link, notice, prose, table, wrapped
from schema_page import FROM_SCHEMAS, ROOT, Failure, SchemaPage

PAGES = ROOT / "docs" / "reference"
FROM_PROGRAMS = "python3 docs/generate.py --program build/release/hilda --granular build/release/hilda-granular"
KEYS_ABOUT = ("One line for each key, grouped by the object to which it belongs. A key leads to its section of the reference, which has "
              "the range, the whole description and an example. The column *of* has the types or laws that have the key; it is empty "
              f"for those that all have. {NONE} in the column *default* marks an optional key without a constant default. `note`, free "
              "text without effect, is left out here; most objects have it. `hilda-granular schema` prints the JSON schema.")
SCHEMAS = ("dae/model.schema.json", "granular/case.schema.json")  # of hilda and hilda-granular
COSIM_SCHEMA = "run/cosim/cosim.schema.json"                       # of hilda schema --cosim


# -------------------------------------------------------------------------------------------------------- programs

def output_of(program, *arguments):
    """Standard output of a program, independent of the locale and of the terminal."""
    environment = {**os.environ, "LC_ALL": "C", "LANG": "C", "COLUMNS": "80", "TERM": "dumb"}
    try:
        done = subprocess.run([program, *arguments], env=environment, capture_output=True, text=True, timeout=60)
    except (OSError, subprocess.SubprocessError) as error:
        raise Failure(f"{program}: cannot be run: {error}") from None
    if done.returncode != 0:
        raise Failure(f"{program} {' '.join(arguments)}: exit code {done.returncode}: {done.stderr.strip()}")
    return done.stdout


class Help:
    """A help text: what the command does, its usage, tables of arguments, options and commands, and what follows."""

    def __init__(self, text, program, name):
        text = text.replace(program, name)
        self.about, self.usage, self.footer, self.groups = "", "", "", {}
        group = None
        for block in re.split(r"\n\s*\n", text.strip("\n")):
            for line in block.splitlines():
                if re.match(r"(?i)usage:", line):
                    self.usage, group = line.split(":", 1)[1].strip(), "usage"
                elif re.fullmatch(r"\[?[A-Za-z][\w ]*\]?:", line):
                    group = line.strip("[]:").lower()
                    self.groups[group] = []
                elif group in self.groups and re.match(r" {1,4}\S", line):
                    entry, _, meaning = line.strip().partition("  ")
                    self.groups[group].append([entry, meaning.strip()])
                elif group in self.groups and line.startswith("     ") and self.groups[group]:
                    last = self.groups[group][-1]
                    last[1] = f"{last[1]} {line.strip()}".strip()
                elif group is None:
                    self.about = f"{self.about} {line.strip()}".strip()
                elif not line.startswith(" "):
                    self.footer = f"{self.footer} {line.strip()}".strip()
            if group == "usage":
                group = "after usage"

    @staticmethod
    def split_default(meaning):
        """Meaning without its clause on the default, and the default."""
        for pattern in (r"\s*[(\[](?:by )?default:? ([^)\]]+)[)\]]",
                        r"(?:^|[;,.]\s*)(?:[Bb]y default,?|[Dd]efault:?) ([^;]+?)(?=;|\.?$)"):
            found = re.search(pattern, meaning)
            if found:
                rest = (meaning[:found.start()] + meaning[found.end():]).strip(" ;,")
                return rest, found.group(1)
        return meaning, NONE

    def tables(self):
        parts = []
        for group, entries in self.groups.items():
            if not entries:
                continue
            if group == "subcommands":
                rows = [[code(name), prose(meaning)] for name, meaning in entries]
                parts.append(table(["command", "meaning"], rows))
                continue
            rows = []
            for entry, meaning in entries:
                words = entry.split(" ")
                repeats = words[-1] == "..."
                words = words[:-1] if repeats else words
                required = "REQUIRED" in words
                words = [word for word in words if word != "REQUIRED"]
                meaning, default = self.split_default(meaning)
                argument = " ".join(words[1:])
                rows.append([code(words[0].replace(",", ", ")), code(argument) if argument else NONE,
                             "required" if required else prose(default), prose(meaning)])
            parts.append(table(["argument" if group == "positionals" else "option", "value", "default", "meaning"], rows))
        return parts

    def section(self, title, overall=None):
        """A section of the page; what the help of the whole program states as well is left out."""
        if overall is not None:
            for entries in self.groups.values():
                entries[:] = [entry for entry in entries if not entry[0].startswith("-h,")]
        footer = self.footer if overall is None or self.footer != overall.footer else ""
        parts = [f"## {title}", wrapped(prose(self.about))]
        parts += [f"```text\n{self.usage}\n```"] if self.usage else []
        return "\n\n".join(part for part in parts + self.tables() + [wrapped(prose(footer))] if part)


def list_table(program, *arguments):
    """A list that the program prints with --json, as a table."""
    rows = json.loads(output_of(program, *arguments, "--json"))
    if not rows:
        raise Failure(f"{program} {' '.join(arguments)} --json: the list is empty")

    def shown(value, column):
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, list):
            value = ", ".join(map(str, value)) or None
        text = NONE if value is None else str(value)
        return code(text) if column == 0 else prose(text)

    head = list(rows[0])
    cells = [[shown(row[key], column) for column, key in enumerate(head)] for row in rows]
    return table([name.replace("_", " ") for name in head], cells)


def commands_page(program, granular):
    overall = Help(output_of(program, "help"), program, "hilda")
    commands = [name for name, _ in overall.groups.get("subcommands", [])]
    if not commands:
        raise Failure(f"{program} help: lists no subcommands")
    sections = {"hilda": overall.section("hilda")}
    for command in commands:
        if command != "help":
            title = f"hilda {command}"
            sections[title] = Help(output_of(program, "help", command), program, "hilda").section(title, overall)
    title = "The program hilda-granular"
    sections[title] = Help(output_of(granular, "--help"), granular, "hilda-granular").section(title)
    for title, intro, arguments in (
            ("Integrators", "The list that `hilda integrators` prints. The order is that of positions and velocities; a dash "
             "means that the integrator chooses its own steps.", ["integrators"]),
            ("Built-in models", "The list that `hilda models` prints. `hilda models NAME` prints the model file.", ["models"]),
            ("Studies", "The list that `hilda study` prints. `hilda study KIND` runs one of them.", ["study"])):
        sections[title] = f"## {title}\n\n{wrapped(intro)}\n\n{list_table(program, *arguments)}"
    head = ["# Command reference", notice("the help texts of the programs", FROM_PROGRAMS),
            "\n".join(f"- {link(title)}" for title in sections),
            wrapped("Every command accepts `-h` or `--help`, which prints its options. In the tables, *default* states the value "
                    f"of an option that is not given; {NONE} marks an option without a default or without a value.")]
    return "\n\n".join(head + list(sections.values())) + "\n"


# ----------------------------------------------------------------------------------------------- committed schemas

WIDTH = 130


def schema_text(value, indent=0, before=0):
    """JSON text with short members on common lines of at most WIDTH columns; `before` characters precede it in its line."""
    flat = json.dumps(value, ensure_ascii=False)
    if not isinstance(value, (dict, list)) or not value or indent + before + len(flat) < WIDTH:
        return flat
    names = [json.dumps(key) + ": " for key in value] if isinstance(value, dict) else [""] * len(value)
    items = value.values() if isinstance(value, dict) else value
    pieces = [name + schema_text(item, indent + 2, len(name)) for name, item in zip(names, items)]
    lines = []
    for piece in pieces:
        alone = "\n" in piece or "\"description\": " in piece[:15] or isinstance(value, list) and piece[0] in "{["
        if lines and not alone and not lines[-1][1] and indent + 2 + len(lines[-1][0]) + len(piece) + 3 <= WIDTH:
            lines[-1][0] += ", " + piece
        else:
            lines.append([piece, alone])
    inner = (",\n" + " " * (indent + 2)).join(line for line, _ in lines)
    return f"{'{['[isinstance(value, list)]}\n{' ' * (indent + 2)}{inner}\n{' ' * indent}{'}]'[isinstance(value, list)]}"


def program_schema(program, *options):
    result = subprocess.run([program, "schema", *options], capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise Failure(f"{program} schema: exit code {result.returncode}: {result.stderr.strip()}")
    return schema_text(json.loads(result.stdout)) + "\n"


# ------------------------------------------------------------------------------------------------------------ main

def main():
    parser = argparse.ArgumentParser(description="Writes the reference pages in docs/reference.")
    parser.add_argument("--program", metavar="PATH", help="the program hilda, for commands.md")
    parser.add_argument("--granular", metavar="PATH", help="the program hilda-granular, for commands.md")
    parser.add_argument("--check", action="store_true",
                        help="compare with the files and write nothing; exit code 1 if they differ")
    options = parser.parse_args()
    if (options.program is None) != (options.granular is None):
        parser.error("--program and --granular must be given together")
    try:
        if options.program is not None:
            for name, command in ((SCHEMAS[0], [options.program]), (SCHEMAS[1], [options.granular]),
                                  (COSIM_SCHEMA, [options.program, "--cosim"])):
                path, text = ROOT / name, program_schema(*command)
                if json.loads(path.read_text(encoding="utf-8")) == json.loads(text):
                    continue
                if options.check:
                    print(f"{name} is out of date; run: {FROM_PROGRAMS}")
                    return 1
                path.write_text(text, encoding="utf-8")
                print(f"{name} written")
        model, case = (SchemaPage(ROOT / name) for name in SCHEMAS)
        pages = {"model-file.md": (model.page("Model file reference"), FROM_SCHEMAS),
                 "case-file.md": (case.page("Granular case file reference"), FROM_SCHEMAS),
                 "case-keys.md": (case.keys_page("All keys of a granular case", "case-file.md", KEYS_ABOUT), FROM_SCHEMAS)}
        if options.program is not None:
            pages["commands.md"] = (commands_page(options.program, options.granular), FROM_PROGRAMS)
    except Failure as failure:
        sys.exit(f"docs/generate.py: {failure}")

    outdated = 0
    for name, (text, command) in pages.items():
        anchors = [anchor(line.lstrip("#").strip()) for line in text.splitlines() if re.match(r"#{1,6} ", line)]
        if repeated := sorted({a for a in anchors if anchors.count(a) > 1}):
            sys.exit(f"docs/generate.py: {name}: two headings have the anchor #{repeated[0]}; give one another title")
        path = PAGES / name
        old = path.read_text(encoding="utf-8") if path.exists() else None
        if old == text:
            continue
        if options.check:
            print(f"docs/reference/{name} is {'out of date' if old is not None else 'missing'}; run: {command}")
            outdated = 1
        else:
            PAGES.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            print(f"docs/reference/{name} written")
    return outdated


if __name__ == "__main__":
    sys.exit(main())
