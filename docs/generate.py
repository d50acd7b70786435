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
import pathlib
import re
import subprocess
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "reference"
FROM_SCHEMAS = "python3 docs/generate.py"
FROM_PROGRAMS = "python3 docs/generate.py --program build/release/hilda --granular build/release/hilda-granular"
NONE = "–"
KEYS_ABOUT = ("One line for each key, grouped by the object to which it belongs. A key leads to its section of the reference, which has "
              "the range, the whole description and an example. The column *of* has the types or laws that have the key; it is empty "
              f"for those that all have. {NONE} in the column *default* marks an optional key without a constant default. `note`, free "
              "text without effect, is left out here; most objects have it. `hilda-granular schema` prints the JSON schema.")
SCHEMAS = ("dae/model.schema.json", "granular/case.schema.json")  # of hilda and hilda-granular


class Failure(Exception):
    """A schema or a program that does not have the expected form."""


# ------------------------------------------------------------------------------------------------ JSON and Markdown

def number(x):
    if isinstance(x, (bool, int)):
        return json.dumps(x)
    if x == 0 or 1e-3 <= abs(x) < 1e4:
        return repr(x).removesuffix(".0")
    mantissa, exponent = f"{x:.15e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"


def one_line(x):
    if isinstance(x, dict):
        return "{" + ", ".join(f"{json.dumps(k)}: {one_line(v)}" for k, v in x.items()) + "}"
    if isinstance(x, list):
        return "[" + ", ".join(map(one_line, x)) + "]"
    return number(x) if isinstance(x, (int, float)) else json.dumps(x, ensure_ascii=False)


def pretty(x, indent=0, before=0, width=100):
    """JSON text in lines of at most `width` characters where possible; `before` characters precede x in its line."""
    text = one_line(x)
    if not isinstance(x, (dict, list)) or indent + before + len(text) < width:
        return text
    pad = " " * (indent + 2)
    if isinstance(x, list):
        inner = ",\n".join(pad + pretty(v, indent + 2) for v in x)
        return f"[\n{inner}\n{' ' * indent}]"
    lines, line = [], ""
    for key, value in x.items():
        name = json.dumps(key) + ": "
        member = name + pretty(value, indent + 2, len(name))
        if line and "\n" not in line + member and len(pad + line + ", " + member) < width:
            line += ", " + member
        else:
            lines += [line] if line else []
            line = member
    inner = ",\n".join(pad + part for part in lines + [line])
    return f"{{\n{inner}\n{' ' * indent}}}"


def code(text):
    return f"`{text}`"


def prose(text, keys=()):
    """Text of a description as Markdown. Options and those of the keys that contain an underscore become code."""
    text = re.sub(r"(?<![A-Za-z0-9`])_|_(?![A-Za-z0-9])|\*", lambda found: "\\" + found.group(), text)
    text = re.sub(r"(?<![\w-])--[a-z][a-z-]*", lambda found: code(found.group()), text)

    def as_code(found):
        return code(found.group()) if found.group() in keys else found.group()

    return re.sub(r"\b[A-Za-z]+(?:_[A-Za-z]+)+\b", as_code, text)


def wrapped(text):
    return textwrap.fill(text, 120, break_long_words=False, break_on_hyphens=False)


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    for row in rows:
        lines.append("| " + " | ".join(cell.replace("|", r"\|").replace("\n", " ") for cell in row) + " |")
    return "\n".join(lines)


def anchor(title):
    """The fragment that GitHub gives to a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def link(title):
    return f"[{title}](#{anchor(title)})"


def short_link(title, group):
    """A link to a variant of a group, such as `DP1` of the group `Constraint`, under the heading `Constraint DP1`."""
    return f"[{title.removeprefix(group + ' ')}](#{anchor(title)})"


def first_sentence(text):
    return re.split(r"(?<=[.)\w`*])\. (?=[A-Z])", text.rstrip("."))[0] + "."


# --------------------------------------------------------------------------------------------------------- schemas

class SchemaPage:
    """The reference page of one JSON schema: a section for every type that has a title."""

    def __init__(self, path):
        try:
            self.schema = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise Failure(f"{path.relative_to(ROOT)}: {error}") from None
        self.source = path.relative_to(ROOT).as_posix()
        self.sections = []  # (level, title, node), in the order in which they are found
        self.values = []    # (title, node) of types of single values, which are described last
        self.find(self.schema, 2)
        self.names = {name for node in [self.schema, *self.schema["$defs"].values()] for name in node.get("properties", {})}
        self.groups = [node for _, _, node in self.sections if self.variants(node)]

    # ---- structure

    def target(self, node):
        name = node["$ref"].removeprefix("#/$defs/")
        if name not in self.schema["$defs"]:
            raise Failure(f"{self.source}: {node['$ref']} does not exist")
        return self.schema["$defs"][name]

    def described(self, node):
        """The node that describes a value: the node itself, or what it refers to."""
        while "description" not in node and "$ref" in node:
            node = self.target(node)
        return node

    def inherited(self, node, key, default=None):
        while key not in node and "$ref" in node:
            node = self.target(node)
        return node.get(key, default)

    def keys(self, node):
        """Name -> (subschema, required) of all keys of an object, those of the definitions it refers to included."""
        parts = [self.target(node)] if "$ref" in node else []
        parts += [self.target(part) for part in node.get("allOf", []) if "$ref" in part]
        properties, required = {}, set(node.get("required", []))
        for part in parts:
            for name, (value, needed) in self.keys(part).items():
                properties[name] = value
                if needed:
                    required.add(name)
        properties.update(node.get("properties", {}))
        first = [name for name in ("type", "law") if name in properties]
        last = [name for name in ("note",) if name in properties]
        order = first + [name for name in properties if name not in first + last] + last
        return {name: (properties[name], name in required) for name in order}

    def keys_and_members(self, node):
        """(name, subschema, required) of all keys of an object, and of the members of those that are objects without a section
        of their own, as lathe.profile"""
        for name, (value, required) in self.keys(node).items():
            yield name, value, required
            if self.inherited(value, "title") is None:
                for member, (inner, needed) in self.keys(value).items():
                    if member != "note":
                        yield f"{name}.{member}", inner, needed

    def variants(self, node):
        """The definitions among which the key type or law selects, in the order of the schema."""
        found = [part["$ref"] for part in node.get("oneOf", []) if "$ref" in part]
        for part in node.get("allOf", []):
            selects = any("const" in value for value in part.get("if", {}).get("properties", {}).values())
            if selects and "$ref" in part.get("then", {}):
                found.append(part["then"]["$ref"])
        return [self.target({"$ref": name}) for name in found]

    def is_object(self, node):
        return bool(self.keys(node) or self.variants(node))

    def find(self, node, level):
        """Adds the sections of a node and of all that it contains."""
        title = node.get("title")
        if title is not None:
            if title in [t for _, t, _ in self.sections] + [t for t, _ in self.values]:
                return
            if not self.is_object(node):
                self.values.append((title, node))
                for child in [node.get("items"), node]:
                    if child and "$ref" in child:
                        self.find(self.target(child), level)
                return
            self.sections.append((level, title, node))
            if level == 3:  # its group adds what it contains, after all variants
                return
        for variant in self.variants(node):
            self.find(variant, 3)
        for value, _ in self.keys(node).values():
            self.find_in_value(value)
        for variant in self.variants(node):
            for value, _ in self.keys(variant).values():
                self.find_in_value(value)

    def find_in_value(self, value):
        for part in [value, value.get("items", {})] + value.get("items", {}).get("anyOf", []) + value.get("anyOf", []):
            if "$ref" in part:
                self.find(self.target(part), 2)
            elif "items" in part and part is not value:
                self.find_in_value(part)

    def prose(self, text):
        return prose(text, self.names)

    # ---- cells of a table

    def type_of(self, node):
        if "const" in node:
            return code(one_line(node["const"]))
        if "enum" in node:
            return ", ".join(code(one_line(value)) for value in node["enum"])
        for word in ("anyOf", "oneOf"):
            if word in node:
                rest = {key: value for key, value in node.items() if key != word}
                return " or ".join(self.type_of({**rest, **part}) for part in node[word])
        if "$ref" in node:
            target = self.target(node)
            return link(target["title"]) if "title" in target else self.type_of(target)
        if "if" in node and "$ref" in node.get("then", {}):
            return " or ".join(self.type_of(node[word]) for word in ("then", "else"))
        kind = node.get("type", "any value")
        if kind == ["number", "string"]:  # every number of a model can be an expression
            return "number"
        if isinstance(kind, list):
            return " or ".join(kind)
        if kind != "array":
            return kind
        count = f"{node['minItems']} " if node.get("minItems") == node.get("maxItems") and "minItems" in node else ""
        items = self.type_of(node["items"])
        plain = re.fullmatch(r"number|integer|string|boolean", items)
        return f"list of {count}{items}{'s' if plain else ''}" if plain or not count else f"list of {count}of {items}"

    def unit_and_meaning(self, node):
        text = self.described(node).get("description", "")
        unit = re.search(r" \[([^\],]+)\]", text)  # not a pair such as [radius, z]
        if unit is None:
            return NONE, self.prose(text)
        name = unit.group(1).replace("^2", "²").replace("^3", "³")
        return (NONE if name == "-" else name), self.prose(text[:unit.start()] + text[unit.end():])

    def range_of(self, node):
        low, high = self.inherited(node, "minimum"), self.inherited(node, "maximum")
        above, below = self.inherited(node, "exclusiveMinimum"), self.inherited(node, "exclusiveMaximum")

        def shown(x):
            return "π/2" if x == 1.5707963267948966 else number(x)

        if (low is not None or above is not None) and (high is not None or below is not None):
            left = f"[{shown(low)}" if low is not None else f"({shown(above)}"
            return left + (f", {shown(high)}]" if high is not None else f", {shown(below)})")
        for sign, bound in (("≥", low), (">", above), ("≤", high), ("<", below)):
            if bound is not None:
                return f"{sign} {shown(bound)}"
        if node.get("type") == "array":
            least, most = node.get("minItems"), node.get("maxItems")
            limits = [f"at least {least}"] if least not in (None, most) else []
            limits += [f"at most {most}"] if most not in (None, least) else []
            each = self.range_of(node["items"])
            return ", ".join(limits + ([f"each {each}"] if each != NONE else [])) or NONE
        if "not" in node and "const" in node["not"]:
            return f"not {code(one_line(node['not']['const']))}"
        return NONE

    def default_of(self, node, required):
        if required:
            return "required"
        default = self.inherited(node, "default", self)
        return NONE if default is self else code(one_line(default))

    # ---- sections

    def section(self, level, title, node):
        lines = ["#" * level + " " + title, wrapped(self.prose(node.get("description", "")))]
        variants = self.variants(node)
        group = next((g for g in self.groups if any(v is node for v in self.variants(g))), None)
        rows, deprecated = [], []
        for name, value, required in self.keys_and_members(node):
            unit, meaning = self.unit_and_meaning(value)
            if value.get("deprecated"):
                deprecated.append(f"- {code(name)}: {meaning}")
                continue
            if group is not None and name in ("type", "law"):
                required = self.keys(group).get(name, ({}, True))[0].get("default") != value["const"]
                value = {**value, "default": value["const"]}
            rows.append([code(name), self.type_of(value), unit, self.default_of(value, required), self.range_of(value),
                         meaning])
        if rows:
            lines.append(table(["key", "type", "unit", "default", "range", "meaning"], rows))
        if deprecated:
            lines.append("Deprecated keys:\n\n" + "\n".join(deprecated))
        if variants:
            lines.append(table(["one of", "meaning"], [
                [short_link(v["title"], title), self.prose(first_sentence(v["description"]))] for v in variants]))
        for k, example in enumerate(node.get("examples", [])):
            heading = ("Example", "Second example", "Third example")[k]
            lines.append(f"{heading}:\n\n```json\n{pretty(example)}\n```")
        return "\n\n".join(lines)

    def contents(self):
        lines = []
        for level, title, _ in self.sections:
            if level == 2:
                group = title
                lines.append(f"- {link(title)}")
            else:
                lines[-1] += (": " if lines[-1].count("](") == 1 else ", ") + short_link(title, group)
        lines.append(f"- {link('Types of values')}: " + ", ".join(link(title) for title, _ in self.values))
        return "\n".join(wrapped_item(line) for line in lines)

    def value_section(self, title, node):
        lines = [f"### {title}", wrapped(self.prose(node["description"]))]
        lines.append("Examples: " + ", ".join(code(one_line(e)) for e in node.get("examples", [])))
        return "\n\n".join(lines)

    def page(self, heading):
        lines = [f"# {heading}", notice(self.source, FROM_SCHEMAS), self.contents(),
                 wrapped("In the tables, *default* states the value of a key that is not given. *required* marks a key that "
                         f"must be given; {NONE} marks an optional key without a constant default, or an entry that does not "
                         "apply. Numbers are finite. Unknown keys are errors.")]
        lines += [self.section(*section) for section in self.sections]
        lines.append("## Types of values")
        lines += [self.value_section(*value) for value in self.values]
        return "\n\n".join(lines) + "\n"

    # ---- one line for each key

    def key_rows(self, title, node, of):
        """Rows of the table of all keys: those of a group have the names of the variants that have the key. Equal keys of
        several variants share a row."""
        levels = {t: level for level, t, _ in self.sections}

        def linked(text):
            """Links to other tables of this page, or to the reference page."""
            return re.sub(r"\[([^\]]*)\]\(#", lambda found: found.group(0) if levels.get(found.group(1)) == 2
                          else f"[{found.group(1)}]({of}#", text)

        def row(name, value, required, section, variants):
            unit, meaning = self.unit_and_meaning(value)
            return [f"[{code(name)}]({of}#{anchor(section)})", variants, linked(self.type_of(value)), unit,
                    self.default_of(value, required), first_sentence(meaning) if meaning else NONE]

        variants = self.variants(node)
        selects = next((name for name in ("type", "law") if variants and name in self.keys(variants[0])), None)
        rows = []
        if selects:
            names = [f"[{v['title'].removeprefix(title + ' ')}]({of}#{anchor(v['title'])})" for v in variants]
            default = next((v["title"].removeprefix(title + " ") for v in variants
                            if "default" in self.keys(v)[selects][0]), None)
            default = self.keys(node).get(selects, ({}, True))[0].get("default", default)
            rows.append([f"[{code(selects)}]({of}#{anchor(title)})", "", "one of " + ", ".join(names), NONE,
                         "required" if default is None else code(one_line(default)), self.prose(first_sentence(node["description"]))])
        shared = {}  # cells of a row without the first two -> the key and its variants
        for part in variants or [node]:
            for name, value, required in self.keys_and_members(part):
                if name == "note" or name == selects or value.get("deprecated"):
                    continue
                cells = row(name, value, required, part.get("title", title), "")
                shared.setdefault((name, *cells[2:]), (cells, []))[1].append(part.get("title", title).removeprefix(title + " "))
        for cells, of_variants in shared.values():
            all_of_them = not variants or len(of_variants) == len(variants)
            rows.append([cells[0], "" if all_of_them else ", ".join(of_variants), *cells[2:]])
        return rows

    def keys_page(self, heading, of, about):
        """All keys of the schema, one line each, with links to the reference page `of`"""
        sections = [(title, node) for level, title, node in self.sections if level == 2]
        lines = [f"# {heading}", notice(self.source, FROM_SCHEMAS), wrapped(about),
                 wrapped(" · ".join(link(title) for title, _ in sections))]
        for title, node in sections:
            rows = self.key_rows(title, node, of)
            columns = [0, 1, 2, 3, 4, 5] if any(row[1] for row in rows) else [0, 2, 3, 4, 5]
            head = ["key", "of", "type", "unit", "default", "meaning"]
            lines += [f"## {title}", table([head[k] for k in columns], [[row[k] for k in columns] for row in rows])]
        return "\n\n".join(lines) + "\n"


def wrapped_item(line):
    return textwrap.fill(line, 120, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def notice(source, command):
    return f"*Generated from {source} by the following command; do not edit.*\n\n```text\n{command}\n```"


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


def program_schema(program):
    result = subprocess.run([program, "schema"], capture_output=True, text=True, check=False)
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
            for name, program in zip(SCHEMAS, (options.program, options.granular)):
                path, text = ROOT / name, program_schema(program)
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
