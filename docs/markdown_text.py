# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON values and tables as Markdown, for the reference pages that generate.py writes."""
import json
import re
import textwrap

NONE = "–"


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


def wrapped_item(line):
    return textwrap.fill(line, 120, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def notice(source, command):
    return f"*Generated from {source} by the following command; do not edit.*\n\n```text\n{command}\n```"
