# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference pages of a JSON schema, for generate.py."""
import json
import pathlib
import re

from markdown_text import (NONE, anchor, code, first_sentence, link, notice, number, one_line, pretty, prose, short_link, table, wrapped,
                           wrapped_item)

ROOT = pathlib.Path(__file__).resolve().parents[1]
FROM_SCHEMAS = "python3 docs/generate.py"


class Failure(Exception):
    """A schema or a program that does not have the expected form."""


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
