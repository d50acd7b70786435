#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation is consistent with the repository: generated pages, links, file names and JSON examples.

    docs_test.py [PROGRAM GRANULAR_PROGRAM]

Checked are README.md, CONTRIBUTING.md, CHANGELOG.md, studies/README.md and all pages in docs and examples:
- The reference pages are those that docs/generate.py writes. commands.md needs the two programs.
- Drawings in docs are those that the scripts beside them write.
- Relative links lead to files and headings that exist.
- File names in backticks such as `lie/so3.hpp` exist. `lie/steps/*.hpp` matches at least one file. Names of examples such as
  `dae/forces/x.cpp`, `contact/detection/x_y.cpp`, `dae/forces/NAME.cpp` and `dae/forces/my_force.cpp` are not checked,
  nor are files that the page declares with <!-- new file: dae/forces/drag.hpp -->, nor lines between
  <!-- old names --> and <!-- end of old names -->.
- JSON blocks and example files with the key hilda_model or hilda_case are valid against their schema. The program
  accepts the models among them.
- Every page begins with a title, no line contains a tab, and every code block is closed.
- Every page of results ends with the commit and the date of the last measurement of its numbers.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parents[1]
SCHEMAS = {"hilda_model": "dae/model.schema.json", "hilda_case": "granular/case.schema.json"}
NOT_SOURCES = {"build", "out"}
GENERATED = {"granular/force_models.hpp"}  # written by the build


def pages():
    found = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "studies/README.md")]
    found += sorted((ROOT / "docs").rglob("*.md")) + sorted((ROOT / "examples").rglob("*.md"))
    return [path for path in found if path.exists() or path.name == "README.md"]


def split(text):
    """The lines of a page outside of code blocks, as (number, line), and the code blocks, as (number, language, text)."""
    lines, blocks, fence = [], [], None
    for number, line in enumerate(text.splitlines(), 1):
        mark = re.match(r"\s*(```+|~~~+)\s*(\w*)", line)
        if fence is None and mark:
            fence, block = mark.group(1), (number, mark.group(2), [])
        elif fence is not None and line.strip() == fence:
            blocks.append((block[0], block[1], "\n".join(block[2])))
            fence = None
        elif fence is not None:
            block[2].append(line)
        else:
            lines.append((number, line))
    return lines, blocks, fence is None


def anchors(path):
    """The fragments that GitHub gives to the headings of a page."""
    found = []
    for _, line in split(path.read_text(encoding="utf-8"))[0]:
        if heading := re.match(r"#{1,6} +(.*?)[ #]*$", line):
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1))
            anchor = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
            repeated = sum(1 for other in found if re.sub(r"-\d+$", "", other) == anchor)
            found.append(f"{anchor}-{repeated}" if repeated else anchor)
    return found


def link_faults(path, lines):
    for number, line in lines:
        line = re.sub(r"`[^`]*`", "", line)
        for target in re.findall(r"\]\(<?([^)\s>]+)>?(?: \"[^\"]*\")?\)", line):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, fragment = target.partition("#")
            file = (path.parent / name).resolve() if name else path
            if not file.exists():
                yield number, f"the link target {target} does not exist"
            elif ROOT not in file.parents and file != ROOT:
                yield number, f"the link {target} leaves the repository"
            elif fragment and file.suffix == ".md" and fragment not in anchors(file):
                yield number, f"{name or path.name} has no heading for the link #{fragment}"


def file_name_faults(lines):
    checked = True
    new = {name for _, line in lines for name in re.findall(r"<!-- new file: (\S+) -->", line)}
    for number, line in lines:
        if "<!-- old names -->" in line or "<!-- end of old names -->" in line:
            checked = "<!-- end" in line
        if not checked:
            continue
        for name in re.findall(r"`((?:[\w.-]+/)+[\w.*-]+\.\w+)`", line):
            room = name.split("/")[0]
            is_example = re.match(r"my_|x[_.]|[A-Z]+\.", name.split("/")[-1])
            if room in NOT_SOURCES or not (ROOT / room).is_dir() or is_example or name in new | GENERATED:
                continue
            if not ((ROOT / name).exists() or "*" in name and any(ROOT.glob(name))):
                yield number, f"the file {name} does not exist"


def validators():
    found = {}
    for key, name in SCHEMAS.items():
        schema = json.loads((ROOT / name).read_text(encoding="utf-8"))
        found[key] = jsonschema.validators.validator_for(schema)(schema)
    return found


def json_faults(text, program, known):
    """What is wrong with the text of a model or a case; nothing for other JSON."""
    key = next((key for key in SCHEMAS if f'"{key}"' in text), None)
    if key is None:
        return
    try:
        value = json.loads(text)
    except ValueError as error:
        yield f"is not JSON: {error}"
        return
    if not isinstance(value, dict) or key not in value:
        return
    for error in known[key].iter_errors(value):
        yield f"{error.json_path}: {error.message[:200]}"
    if key == "hilda_model" and program is not None and '"demo-' not in text:  # demo-*: types of the test programs only
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "model.json"
            file.write_text(text, encoding="utf-8")
            done = subprocess.run([program, "check", str(file), "--quiet"], capture_output=True, text=True)
            if done.returncode != 0:
                yield f"hilda check rejects it: {done.stderr.strip()[:300]}"


def main():
    if len(sys.argv) not in (1, 3):
        sys.exit("usage: docs_test.py [PROGRAM GRANULAR_PROGRAM]")
    programs = sys.argv[1:]
    program = programs[0] if programs else None
    faults, links, blocks_checked, known = [], 0, 0, validators()

    command = [sys.executable, str(ROOT / "docs" / "generate.py"), "--check"]
    command += ["--program", programs[0], "--granular", programs[1]] if programs else []
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        faults.append((done.stdout + done.stderr).strip())

    for script in sorted((ROOT / "docs").rglob("figures/*.py")):
        done = subprocess.run([sys.executable, str(script), "--check"], capture_output=True, text=True)
        if done.returncode != 0:
            faults.append((done.stdout + done.stderr).strip())

    for path in pages():
        name = path.relative_to(ROOT).as_posix()
        if not path.exists():
            faults.append(f"{name}: does not exist")
            continue
        text = path.read_text(encoding="utf-8")
        lines, blocks, closed = split(text)
        links += text.count("](")
        first = next((line for _, line in lines if line.strip() and not line.lstrip().startswith("<!--")), "")
        if not re.match(r"# \S", first):
            faults.append(f"{name}: does not begin with a title, such as '# HILDA'")
        if not closed:
            faults.append(f"{name}: a code block is not closed")
        is_result = name.startswith("docs/results/") and path.name not in ("README.md", "dissertation-figures.md")
        if is_result and not re.search(r"\nNumbers as of commit `[0-9a-f]{8}` \(\d{4}-\d\d-\d\d\)\.\n$", text):
            faults.append(f"{name}: does not end with the line 'Numbers as of commit `12345678` (2026-01-31).'")
        for number, line in enumerate(text.splitlines(), 1):
            if "\t" in line:
                faults.append(f"{name}:{number}: contains a tab; use spaces")
        for number, fault in [*link_faults(path, lines), *file_name_faults(lines)]:
            faults.append(f"{name}:{number}: {fault}")
        for number, language, block in blocks:
            if language == "json":
                blocks_checked += 1
                faults += [f"{name}:{number}: the JSON block {fault}" for fault in json_faults(block, program, known)]
    for path in sorted((ROOT / "examples").rglob("*.json")):
        blocks_checked += 1
        text = path.read_text(encoding="utf-8")
        faults += [f"{path.relative_to(ROOT).as_posix()}: {fault}" for fault in json_faults(text, program, known)]

    for fault in faults:
        print(fault)
    print(f"{len(pages())} pages, {links} links, {blocks_checked} JSON texts, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
