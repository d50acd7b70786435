#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What pages state about the program is true: versions, counts, and the names of the architecture page.

    statements_test.py [PROGRAM GRANULAR_PROGRAM]

- The version of CMakeLists.txt is that of granular/CMakeLists.txt, CITATION.cff, the newest version of CHANGELOG.md with its date, the
  citation in README.md, all requests find_package(hilda X.Y) and names libhildaX.Y, and the programs. The recipe of conda-build and
  pyproject.toml read it from CMakeLists.txt.
- The counts in README.md, CONTRIBUTING.md and docs/guide/reproduce.md are those of the programs and of tests/mutations/mutations.json.
- The names in backticks on docs/architecture.md occur in the sources. `X::y` is a member of the class or namespace X. The files of its
  tables exist, and it lists each folder of the rooms.
- README.md names each command of hilda with which results are computed or used.
- README.md, CITATION.cff and pyproject.toml cite the dissertation.
"""
import functools
import json
import pathlib
import re
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = ("io", "lie", "dae", "contact", "granular", "reference", "run", "studies", "python")
BASIC = {"DP1", "DP2", "D", "CD"}  # constraints that are no joints; neither are drivers
FAULTS = []


def text(name):
    return (ROOT / name).read_text(encoding="utf-8")


def expect(place, what, stated, true):
    if stated != true:
        FAULTS.append(f"{place}: {what}: {stated} is stated, {true} is true")


def found(pattern, name):
    """The first group of the pattern in a file; None and a fault if it does not occur"""
    match = re.search(pattern, text(name), re.M)
    if match is None:
        FAULTS.append(f"{name}: has no '{pattern}'")
    return match and match[1]


def tracked(*endings):
    """Files of the tree with these endings, without what builds and runs have written"""
    for top in sorted(ROOT.iterdir()):
        if top.name.startswith(".") or top.name in ("build", "out"):
            continue
        for path in [top] if top.is_file() else sorted(top.rglob("*")):
            if (path.suffix in endings or path.name in endings) and path.is_file():
                yield path.relative_to(ROOT).as_posix()


def versions(programs):
    version = found(r"^project\(hilda VERSION (\S+)", "CMakeLists.txt")
    minor = ".".join(version.split(".")[:2])
    expect("granular/CMakeLists.txt", "version", found(r"project\(hilda_granular VERSION (\S+)", "granular/CMakeLists.txt"), version)
    expect("CITATION.cff", "version", found(r"^version: (\S+)$", "CITATION.cff"), version)
    expect("README.md", "version in the citation", found(r"\*HILDA (\d[\d.]*\d):", "README.md"), version)
    newest = re.search(r"^## (\d\S*)(?: - (\d{4}-\d\d-\d\d))?$", text("CHANGELOG.md"), re.M)
    expect("CHANGELOG.md", "newest version", newest[1], version)
    expect("CHANGELOG.md", "its date, that of CITATION.cff", newest[2], found(r"^date-released: (\S+)$", "CITATION.cff"))
    found(r"(load_file_regex\(\"CMakeLists\.txt\")", "cmake/packages/conda/meta.yaml")
    expect("pyproject.toml", "fields from CMakeLists.txt", tomllib.loads(text("pyproject.toml"))["project"].get("dynamic"), ["version"])
    for name in tracked(".md", ".txt", ".cmake", "packages"):
        for pattern in (r"find_package\(hilda (\d[\d.]*)", r"\blibhilda(\d[\d.]*\d)"):
            for stated in re.findall(pattern, text(name)) if name != "CHANGELOG.md" else ():
                expect(name, "version of the library", stated, minor)
    for program in programs:
        answer = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
        expect(pathlib.Path(program).name, "--version", answer.split()[1], version)


def citations():
    for name in ("README.md", "CITATION.cff", "pyproject.toml"):
        # line breaks, comments, quotation marks and other typography aside
        words = " ".join(re.findall(r"[\w()]+", text(name)))
        for part in ("Luning", "Fang", "Multibody Dynamics Numerical Methods and Modeling Approaches for Handling Frictional Contact",
                     "Doctor of Philosophy (Mechanical Engineering)", "University of Wisconsin Madison", "2022"):
            if part not in words:
                FAULTS.append(f"{name}: does not name '{part}'")


def ask(program, *arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, check=True).stdout


def counts_of(hilda):
    """The true number of what pages count, by its name in the text"""
    schema = json.loads(ask(hilda, "schema"))

    def types(of):
        return [one["$ref"].rsplit("/", 1)[1] for one in schema["$defs"][of]["oneOf"]]

    joints = [name for name in types("any_constraint") if name not in BASIC and not name.endswith("driver")]
    return {"joints": len(joints), "force elements": len(types("any_force")),
            "surfaces": len(schema["$defs"]["surface"]["allOf"]),
            "integrators": len(json.loads(ask(hilda, "integrators", "--json"))),
            "built-in models": len(json.loads(ask(hilda, "models", "--json"))),
            "studies": len(json.loads(ask(hilda, "study", "--json")))}


def counts(programs):
    mutations = len(json.loads(text("tests/mutations/mutations.json")))
    expect("CONTRIBUTING.md", "places of mutations.py", int(found(r"changes the source in (\d+) places", "CONTRIBUTING.md")), mutations)
    source = text("studies/program/repeating/reproduction.cpp")
    entries = len(re.findall(r'^ +{"[\w-]+", \d,', source, re.M))
    page = text("docs/guide/reproduce.md")
    for total in set(re.findall(r"^\[ *\d+/(\d+)\]", page, re.M)):
        expect("docs/guide/reproduce.md", "number of studies", int(total), entries)
    for done in re.findall(r"^(\d+) passed, (\d+) failed, (\d+) without criterion, (\d+) with an error", page, re.M):
        expect("docs/guide/reproduce.md", "sum of the results", sum(map(int, done)), entries)
    if not programs:
        return
    true = counts_of(programs[0])
    for name in ("README.md", "CONTRIBUTING.md"):
        for what, number in true.items():
            for stated in re.findall(rf"\b(\d+) {what}\b", text(name)):
                expect(name, what, int(stated), number)
    expect("README.md", "joints is counted", "joints" in re.findall(r"\b\d+ (joints)\b", text("README.md")), True)
    commands = re.findall(r"^  ([a-z]+) {2,}\S", ask(programs[0], "--help"), re.M)
    if len(commands) < 10:
        FAULTS.append(f"hilda --help: {len(commands)} commands were found in its text")
    named = text("README.md")
    for command in commands:
        if command not in ("help", "info", "schema", "models", "integrators", "new", "collect") and f"hilda {command}" not in named:
            FAULTS.append(f"README.md: does not name hilda {command}")


@functools.cache
def sources():
    endings = (".hpp", ".cpp", ".h", ".cu", ".cuh", ".py", ".cmake", "CMakeLists.txt", ".in")
    return {name: text(name) for name in tracked(*endings) if name.split("/")[0] in (*ROOMS, "tests", "cmake", "docs")}


@functools.cache
def all_code():
    return "\n".join(sources().values())


@functools.cache
def bodies(scope):
    """The texts between the braces of the classes and namespaces with this name"""
    parts = []
    for source in sources().values():
        if scope not in source:
            continue
        for start in re.finditer(rf"\b(?:class|struct|namespace)\s+(?:\w+::)*{scope}\b[^;{{()]*\{{", source):
            depth, end = 1, start.end()
            for brace in re.finditer(r"[{}]", source[start.end():]):
                depth += 1 if brace[0] == "{" else -1
                end = start.end() + brace.start()
                if depth == 0:
                    break
            parts.append(source[start.end():end])
    return "\n".join(parts)


def is_member(scope, name):
    return (re.search(rf"\b{scope}(?:<[^>\n]*>)?::{name}\b", all_code()) is not None
            or re.search(rf"\b{name}\b", bodies(scope)) is not None)


def architecture():
    page = "docs/architecture.md"
    body = re.sub(r"```.*?```", "", text(page), flags=re.S)
    words = set(re.findall(r"\w+", all_code()))
    stems = {word for name in sources() for word in re.findall(r"\w+", name)}
    names = 0
    for number, line in enumerate(body.splitlines(), 1):
        for code in re.findall(r"`([^`]+)`", line):
            if code.startswith(("-", "cmake ", "hilda ", "hilda-", "ctest ", '"')):
                continue  # commands, options and keys
            for word in re.findall(r"[A-Za-z_]\w+", code):
                names += 1
                if word not in words and word not in stems and word != "KIND":
                    FAULTS.append(f"{page}:{number}: {word} of `{code}` does not occur in the sources")
            for scopes, name in re.findall(r"((?:\w+::)+)(\w+)", code):
                scope = scopes[:-2].split("::")[-1]
                if not is_member(scope, name):
                    FAULTS.append(f"{page}:{number}: {scope} has no member {name}")
        if line.startswith("|"):
            for file in re.findall(rf"(?<![\w(/.`])((?:{'|'.join(ROOMS)})/[\w./-]*\w/?)", re.sub(r"`[^`]*`", "", line)):
                if not (ROOT / file).exists():
                    FAULTS.append(f"{page}:{number}: {file} does not exist")
    expect(page, "names in backticks are found", names > 100, True)

    # The list of folders: ROOM/ NAME/ (NAME/, NAME/) ...; continued lines begin with more spaces.
    layout, listed = None, {}
    for line in body.splitlines():
        if match := re.match(rf" {{4}}({'|'.join(ROOMS)})/ ", line):
            layout = match[1]
        elif not line.startswith("     "):
            layout = None
        if layout:
            listed.setdefault(layout, set()).update(re.findall(r"(?<![\w.-])([\w.-]+)/", line))
    for room in ROOMS:
        for folder in {pathlib.PurePath(name).parent for name in sources() if name.startswith(room + "/")}:
            # a folder and its folders, without those of each kind of law and of each chapter
            parts = folder.parts[1:2] if folder.parts[1:2] in (("force_models",), ("experiments",)) else folder.parts[1:3]
            for part in parts:
                if part not in listed.get(room, ()) and part != "__pycache__":
                    FAULTS.append(f"{page}: the list of folders has no {room}/…/{part}")
    for room, folders in listed.items():
        there = {path.name for path in (ROOT / room).rglob("*") if path.is_dir()} | {room}
        for folder in folders - there:
            FAULTS.append(f"{page}: {room} has no folder {folder}")


def main():
    if len(sys.argv) not in (1, 3):
        sys.exit("usage: statements_test.py [PROGRAM GRANULAR_PROGRAM]")
    programs = sys.argv[1:]
    versions(programs)
    counts(programs)
    citations()
    architecture()
    for fault in FAULTS:
        print(fault)
    print(f"{len(FAULTS)} faults")
    return 1 if FAULTS else 0


if __name__ == "__main__":
    sys.exit(main())
