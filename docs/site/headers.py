# SPDX-License-Identifier: GPL-3.0-or-later
"""The C++ interface: Doxygen reads the installed headers, and each folder of headers has one page for Breathe.

Doxygen reads copies of the headers whose comments are prepared for it: the first comment is that of the file, indented equations are
preformatted blocks, and characters that are commands of Doxygen or HTML are escaped.
"""
import json
import pathlib
import re
import subprocess
import xml.etree.ElementTree as ElementTree

from pages import ROOT, Failure, write

OPTIONS = """
PROJECT_NAME = HILDA
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
WARN_IF_INCOMPLETE_DOC = NO
WARN_NO_PARAMDOC = NO
RECURSIVE = YES
FILE_PATTERNS = *.hpp
BUILTIN_STL_SUPPORT = YES
SORT_MEMBER_DOCS = NO
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = HILDA_HD= HILDA_HOST_DEVICE= HILDA_ALWAYS_INLINE=inline
"""
HIDDEN_SECTIONS = ("private-", "friend", "define", "related")


def installed():
    """The installed headers, as cmake/install.cmake lists them, relative to the root of the repository."""
    text = (ROOT / "cmake" / "install.cmake").read_text(encoding="utf-8")
    call = re.search(r"\nhilda_install_headers\(\n(.*?)\)\ninstall", text, re.S)
    if call is None:
        raise Failure("cmake/install.cmake: no call of hilda_install_headers was found")
    pieces = re.split(r"\b(FOLDERS|FILES|EXCEPT)\b", re.sub(r"#.*", "", call[1]))
    lists = {key: names.split() for key, names in zip(pieces[1::2], pieces[2::2])}
    found = {path.relative_to(ROOT).as_posix() for folder in lists["FOLDERS"] for path in (ROOT / folder).rglob("*.hpp")}
    found = (found | set(lists["FILES"])) - set(lists["EXCEPT"])
    if missing := [name for name in sorted(found) if not (ROOT / name).is_file()]:
        raise Failure(f"cmake/install.cmake: the header {missing[0]} does not exist")
    return sorted(found)


def escaped(text):
    """A line of a comment without commands of Doxygen; code in backticks and @param remain."""
    pieces = re.split(r"(`[^`]*`)", text)
    for i in range(0, len(pieces), 2):
        pieces[i] = re.sub(r"([\\<>&#%]|@(?!param\b))", r"\\\1", pieces[i])
        pieces[i] = re.sub(r"(\\>|/\w+)::", r"\1\\::", pieces[i])  # no link request
    text = "".join(pieces)
    # References at the right end of a line are in parentheses.
    return re.sub(r"(\S) {3,}((?:Fang|Eqs?\.|Secs?\.|Fig\.|App\.)\s.*)$", r"\1 (\2)", text)


def prepared(lines):
    """The lines of a header with comments for Doxygen."""
    out, comment, first = [], [], True
    for line in [*lines, ""]:
        mark = re.match(r"(\s*)///(?![</])( ?)(.*)$", line)
        if mark:
            comment.append((mark[1], mark[3]))
            continue
        if comment:
            out += block(comment, first)
            comment, first = [], False
        if trailing := re.match(r"(.*?///<)(.*)$", line):
            line = trailing[1] + escaped(trailing[2])
        out.append(line)
    return out


def block(comment, is_first):
    """A comment of `///` lines, as (indentation, text), in which runs of indented lines are preformatted."""
    indent, texts = comment[0][0], [text for _, text in comment]
    out, code = ["@file"] if is_first else [], []

    def end_code():
        blank = 0
        while code and not code[-1].strip():
            code.pop()
            blank += 1
        if code:
            margin = min(len(text) - len(text.lstrip()) for text in code if text.strip())
            out.extend([*[""] * (not out or bool(out[-1])), "@code{.unparsed}", *(text[margin:] for text in code), "@endcode"])
        out.extend([""] * blank)
        code.clear()

    in_list = False
    for text in texts:
        width = len(text) - len(text.lstrip())
        in_list = bool(re.match(r"\s*(?:[-+*]|\d+\.|@param)\s", text)) or in_list and bool(text.strip())
        if width >= 4 and not in_list or code and not text.strip():
            code.append(text)
            continue
        end_code()
        out.append(escaped(text))
    end_code()
    return [f"{indent}/// {text}".rstrip() for text in out]


def run_doxygen(work):
    """Writes the XML of the installed headers to work/xml. Returns the warnings of Doxygen."""
    source = work / "headers"
    for name in installed():
        lines = (ROOT / name).read_text(encoding="utf-8").split("\n")
        write(source / name, "\n".join(prepared(lines)))
    write(work / "Doxyfile", OPTIONS + f'OUTPUT_DIRECTORY = "{work}"\nINPUT = "{source}"\nSTRIP_FROM_PATH = "{source}"\n')
    done = subprocess.run(["doxygen", str(work / "Doxyfile")], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Failure(f"doxygen ends with exit code {done.returncode}: {done.stderr.strip()[-500:]}")
    warnings = sorted({line.replace(f"{source}/", "") for line in done.stderr.splitlines() if line.strip()})
    files = {}
    for file in sorted((work / "xml").glob("*.xml")):
        if file.name == "index.xml":
            continue
        for compound in prepare_xml(file).iter("compounddef"):
            if compound.get("kind") == "file":
                files.setdefault(compound.find("location").get("file"), []).insert(0, compound.get("id"))
            if compound.get("kind") == "namespace" and "@" not in compound.findtext("compoundname"):
                for name, identifier in split_namespace(compound, file.parent):
                    files.setdefault(name, []).append(identifier)
    write(work / "headers.json", json.dumps(files))
    return warnings


def split_namespace(compound, folder):
    """Writes a file for each header with members of a namespace, which the file of the header does not have. Returns headers and
    identifiers."""
    members = {}
    for section in compound.findall("sectiondef"):
        for member in section.findall("memberdef"):
            members.setdefault(member.find("location").get("file"), {}).setdefault(section.get("kind"), []).append(member)
    for count, (name, sections) in enumerate(sorted(members.items())):
        identifier = f"{compound.get('id')}_in_{count}"
        root = ElementTree.Element("doxygen", version="1.9.4")
        part = ElementTree.SubElement(root, "compounddef", id=identifier, kind="namespace", language="C++")
        ElementTree.SubElement(part, "compoundname").text = compound.findtext("compoundname")
        for kind, found in sections.items():
            ElementTree.SubElement(part, "sectiondef", kind=kind).extend(found)
        ElementTree.ElementTree(root).write(folder / f"{identifier}.xml", encoding="utf-8", xml_declaration=True)
        yield name, identifier


def prepare_xml(path):
    """Removes what is not part of the interface, and what the C++ parser of Sphinx does not read."""
    tree = ElementTree.parse(path)
    for compound in tree.getroot().iter("compounddef"):
        if compound.get("kind") == "file":
            # Otherwise each page would declare the namespaces again.
            for inner in compound.findall("innernamespace"):
                compound.remove(inner)
        for inner in compound.findall("innerclass"):
            if inner.get("prot") == "private" or "@" in (inner.text or ""):
                compound.remove(inner)
        for section in compound.findall("sectiondef"):
            if section.get("kind", "").startswith(HIDDEN_SECTIONS):
                compound.remove(section)
                continue
            for member in section.findall("memberdef"):
                prepare_member(section, member)
    tree.write(path, encoding="utf-8", xml_declaration=True)
    return tree.getroot()


def prepare_member(section, member):
    if member.get("kind") == "friend" or member.get("prot") == "private":
        section.remove(member)
        return
    initializer = member.find("initializer")
    if initializer is not None and re.search(r"[{\[\"]", "".join(initializer.itertext())):
        member.remove(initializer)
    arguments = member.find("argsstring")
    if arguments is not None and re.match(r'\s*\(\s*"', arguments.text or ""):
        # a variable with the arguments of its constructor
        member.set("kind", "variable")
        arguments.text = ""
        for parameter in member.findall("param"):
            member.remove(parameter)
    if arguments is not None and arguments.text:
        arguments.text = re.sub(r"=\s*\[\][^{]*\{[^}]*\}", "={}", arguments.text)
    for parameter in member.iter("param"):
        value = parameter.find("defval")
        if value is not None and re.search(r"\{\s*\.|\[", "".join(value.itertext())):
            value.clear()
            value.text = "{}"


def title_of(name):
    """The text of the first comment of a header"""
    lines = []
    for line in (ROOT / name).read_text(encoding="utf-8").split("\n"):
        if line.startswith("///"):
            lines.append(line[3:].strip())
        elif lines:
            break
    return " ".join(lines)


def write_pages(target):
    """One page for each folder of headers."""
    folders = {}
    for name in installed():
        folders.setdefault(str(pathlib.PurePosixPath(name).parent), []).append(name)
    rows = []
    for folder, names in folders.items():
        lines = [folder, "=" * len(folder), ""]
        for name in names:
            lines += [name, "-" * len(name), "", ".. code-block:: cpp", "", f'   #include "{name}"', "",
                      f".. hilda-header:: {name}", ""]
        page = folder.replace("/", "-")
        write(target / "api" / "cpp" / f"{page}.rst", "\n".join(lines))
        rows.append((page, folder, len(names)))
    write(target / "api" / "cpp" / "index.md", INDEX + "".join(
        f"| [{folder}]({page}.rst) | {count} |\n" for page, folder, count in rows))


INDEX = """# C++ interface

The pages have the declarations of the installed headers, one page for each folder. [C++ interface](../../docs/guide/cpp-interface.md)
in the user guide shows their use with examples, and [Architecture](../../docs/architecture.md) their relation.

Arguments and results are in SI units. A bar in a name (`omega_bar`) marks components in a body frame.

| folder | headers |
| --- | --- |
"""
