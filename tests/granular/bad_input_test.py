#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Wrong cases, tables and checkpoints are refused in one line; no output of hilda-granular has a number that is not finite.

    bad_input_test.py PROGRAM [SAMPLE]

Every number of a case is replaced by numbers beyond single precision and by NaN and infinity, names are given twice,
tables have wrong cells, and checkpoints have wrong lengths, indices and numbers under a right checksum. Legal values
that are extreme end with 0 or 4; the last state of a failed run is finite, and --resume continues from it.
With SAMPLE only every SAMPLE-th number of the case and of the checkpoint is replaced: a program with sanitizers starts slowly.
"""
import collections
import copy
import json
import math
import re
import resource
import shutil
import struct
import sys
import tempfile

from case_runs import Runs, expect

# Pairs of particles of four materials, in contact with each other and with a floor, so that all laws act
LAWS = [
    {"between": ["a", "a"], "restitution": 0.9, "mu": 0.3, "mu_s": 0.4, "tangential": {"law": "mindlin"},
     "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}, "spin": {"law": "torsional-spring"},
     "cohesion": {"law": "sjkr", "k": 10}},
    {"between": ["a", "b"], "mu": 0.1, "normal": {"law": "hooke", "k_n": 1e4, "gamma_n": 10},
     "tangential": {"law": "coulomb", "k_t": 1e4, "gamma_t": 3},
     "rolling": {"law": "constant-torque", "mu_r": 0.1, "slow": 1e-3, "after": 1e-4},
     "cohesion": {"law": "constant", "F_c": 1e-6}},
    {"between": ["b", "b"], "restitution": 0.5, "mu": 0.1, "tangential": {"law": "mindlin-incremental"},
     "rolling": {"law": "pseudo-force", "mu_r": 0.1, "k_r": 2, "eta_r": 0.1}},
    {"between": ["a", "c"], "mu": 0.1, "normal": {"law": "scaled-hooke", "k_n": 1e4, "gamma_n": 10},
     "tangential": {"law": "coulomb", "k_t": 1e4, "gamma_t": 3}},
    {"between": ["b", "c"], "restitution": 0.5, "mu": 0.1, "normal": {"law": "hunt-crossley", "alpha": 0.2},
     "tangential": {"law": "mindlin-deresiewicz"}},
    {"between": ["c", "c"], "restitution": 0.5, "mu": 0.1, "normal": {"law": "kuwabara-kono", "A": 1e-6},
     "tangential": {"law": "mindlin"}},
    {"between": ["d", "d"], "mu": 0.1, "normal": {"law": "walton-braun", "k_1": 1e4, "k_2": 2e4, "S": 10},
     "tangential": {"law": "coulomb", "k_t": 1e4, "gamma_t": 3}},
    {"between": ["b", "d"], "restitution": 0.5, "mu": 0.1, "normal": {"law": "walton-braun", "k_1": 1e4},
     "tangential": {"law": "coulomb", "k_t": 1e4, "gamma_t": 3}},
    {"between": ["a", "d"], "restitution": 0.5}, {"between": ["c", "d"], "restitution": 0.5}]
FILL = {"radius": 0.05, "material": "b"}
CASE = {
    "hilda_case": 1, "domain": {"low": [-1, -1, -1], "high": [1, 1, 1], "periodic": [False, True, False],
                                "outflow": ["-z"]},
    "gravity": [0, 0, -9.81], "step": 1e-5, "end": 3e-5, "interval": 1e-5, "frame_interval": 2e-5, "skin": 0.2,
    "orientation": True,
    "materials": [{"name": name, "density": 2500, "E": 7e7, "nu": 0.24} for name in "abcd"],
    "laws": LAWS,
    "boundaries": [
        {"name": "floor", "type": "plane", "normal": [0, 0, 1], "r": [0, 0, -0.5], "material": "b"},
        {"name": "tube", "type": "cylinder", "axis": [0, 0, 1], "radius": 0.9, "inside": True, "v": [0, 0, 1],
         "omega": [0, 0, 1], "material": "a"},
        {"name": "cone", "type": "cone", "axis": [0, 0, 1], "half_angle": 0.5, "r": [0.5, 0.5, -0.5], "material": "a"},
        {"name": "ball", "type": "sphere", "radius": 0.1, "r": [-0.5, -0.5, 0], "material": "b"},
        {"name": "box", "type": "box", "low": [-1, -1, -1], "high": [1, 1, 1], "open": ["+z"], "r": [0, 0, 0.1],
         "v": [0, 0, "sin(2*pi*t)"], "material": "b"},
        {"name": "lid", "type": "plane", "normal": [0, 0, -1], "r": [0, 0, 0.8], "omega": [0, 0, 0], "mass": 2,
         "inertia": 1e-3, "F": [0, 0, -1], "material": "b"},
        {"name": "rod", "type": "frustum", "axis": [0, 0, 1], "radii": [0.05, 0.1], "length": 0.2, "r": [0.45, -0.55, 0], "density": 500,
         "v": [0, 0, 1], "centre": 0.1, "material": "a"},
        {"name": "tyre", "type": "torus", "axis": [0, 0, 1], "radius": 0.02, "ring_radius": 0.15, "r": [0.45, -0.55, 0.1],
         "part_of": "rod", "material": "a"},
        {"name": "plate", "type": "disk", "normal": [0, 0, 1], "radius": 0.1, "two_sided": True, "r": [0.45, -0.55, 0.5], "material": "b"}],
    "particles": [{"r": [0, 0, 0], "radius": 0.05, "material": "a", "v": [0, 0, 1], "omega": [1, 0, 0],
                   "force": [0, 1, 0], "replica": 0, "orientation": [0.6, 0, 0, -0.8]},
                  {"r": [0, 0.0995, 0], "radius": 0.05, "material": "a"}] +
                 [{"r": [x, 0, z], "radius": 0.05, "material": m} for x, z, m in (
                     (0, -0.451, "a"), (0, -0.3511, "b"), (0.2, -0.351, "c"), (0.2, -0.451, "c"), (0.4, -0.351, "d"),
                     (0.4, -0.451, "d"))] +
                 [{"r": [-0.3, 0, -0.451], "radius": 0.05, "material": "a", "attached_to": "floor"}],
    "fill": [dict(FILL, type="lattice", low=[0, 0, 0.2], high=[0.3, 0.3, 0.5], least_radius=0.04, spacing=1.1,
                  jitter=0.5, count=5, seed=2, v=[0, 0, 0], random_v=0.1),
             dict(FILL, type="hcp", low=[-0.5, -0.5, 0.2], high=[-0.2, -0.2, 0.5]),
             dict(FILL, type="poisson", low=[-0.5, 0.1, 0.2], high=[-0.2, 0.4, 0.5])],
    "insert": [{"rate": 2e5, "count": 5, "from": 0, "to": 1, "interval": 1e-5, "radius": 0.03, "least_radius": 0.02, "material": "b",
                "v": [0, 0, 0], "random_v": 0.1, "tries": 1000, "seed": 2,
                "region": {"type": "box", "low": [0.2, -0.3, 0.5], "high": [0.4, 0, 0.7]}}]}

# Keys whose numbers must be positive in single precision
POSITIVE = {"step", "end", "interval", "frame_interval", "skin", "density", "E", "k_n", "k_t", "k_1", "k_2", "alpha", "A",
            "radius", "ring_radius", "length", "density", "mass", "least_radius", "spacing", "rate"}
OUTPUT = ("--contacts", "--replica-rows", "--quiet", "--threads", "1", "--output", "out")


def numbers(value, path=()):
    """Paths of all numbers of a case"""
    if isinstance(value, (dict, list)):
        for key, member in value.items() if isinstance(value, dict) else enumerate(value):
            yield from numbers(member, (*path, key))
    elif not isinstance(value, (bool, str)):
        yield path


def changed(path, value):
    """The text of the case with one entry changed"""
    case = copy.deepcopy(CASE)
    at = case
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return json.dumps(case)


def pointer_to(path):
    return "/" + "/".join(map(str, path))


class Checks(Runs):
    """Runs of small cases in the folder out; counts the refused ones."""

    def __init__(self, program, folder):
        super().__init__(program, folder)
        self.refusals = collections.Counter()
        self.runs = 0

    def start_case(self, text, *arguments):
        (self.folder / "c.json").write_text(text)
        self.remove("out")
        return self.go_on(*arguments)

    def go_on(self, *arguments):
        self.runs += 1
        return self.run("c.json", *OUTPUT, *arguments, timeout=60)

    def refused_case(self, kind, text, pointer, value, *arguments):
        """The case ends with 3 and one line that has the place and the value"""
        ended = self.start_case(text, *arguments)
        match = re.fullmatch(rf"hilda: error: c\.json:\d+:\d+ \({pointer}\): [^\n]*{value}[^\n]*\n", ended.stderr)
        expect(ended.returncode == 3 and match, f"{kind} {pointer}, {value}: {ended.returncode}: {ended.stderr}")
        expect(not (self.folder / "out").exists(), f"{kind}: a refused case writes no files")
        self.refusals[kind] += 1

    def not_finite(self):
        """Numbers of the outputs that are not finite, by file and column"""
        found = []
        for file in sorted((self.folder / "out").rglob("*")):
            if file.suffix == ".csv":
                names, *rows = (line.split(",") for line in file.read_text().splitlines())
                found += [f"{file.name} {name} {cell}" for row in rows for name, cell in zip(names, row)
                          if re.fullmatch("-?(nan|inf)", cell)]
            elif file.suffix == ".vtp":
                head, _, data = file.read_bytes().partition(b'<AppendedData encoding="raw">\n_')
                for kind, name, at in re.findall(rb'type="Float(\d\d)" Name="(.*?)".*?offset="(\d+)"', head):
                    count = struct.unpack_from("<Q", data, int(at))[0] * 8 // int(kind)
                    values = struct.unpack_from(f"<{count}{'d' if kind == b'64' else 'f'}", data, int(at) + 8)
                    found += [f"{file.name} {name} {x}" for x in values if not math.isfinite(x)]
            elif file.name == "summary.json":
                found += ["summary.json null"] * ("null" in file.read_text())
        return found

    def contents(self):
        """The tables and frames of the run"""
        return {file.name: file.read_bytes() for file in (self.folder / "out").rglob("*")
                if file.suffix in (".csv", ".vtp", ".pvd")}


def each_number(checks):
    """Each number of the case, replaced in turn"""
    for path in list(numbers(CASE))[::checks.sample]:
        pointer = pointer_to(path)
        for literal in ("NaN", "Infinity", "-Infinity", "1e400"):
            text = changed(path, "value").replace('"value"', literal)
            checks.refused_case("a number that is not finite", text, pointer, f"got '{literal}'")
        for value, got in ((1e39, r"1e\+39"), (-1e39, r"-1e\+39")):
            checks.refused_case("a number beyond single precision", changed(path, value), pointer, f"got {got}")
        key = path[-1] if isinstance(path[-1], str) else path[-2]
        for value in (1e-46, 0, -1) if key in POSITIVE else ():
            checks.refused_case("a number that must be positive", changed(path, value), pointer,
                                f"(must|may) .*got {'-?' if value else ''}{abs(value)}")


def twice(checks):
    """Names, laws and keys that are given twice"""
    kind = "something given twice"
    for part, number, got in (("materials", 2, 'two materials have the same name, got "c"'),
                              ("boundaries", 3, 'two boundaries have the same name, got "ball"')):
        text = json.dumps(dict(CASE, **{part: [*CASE[part], CASE[part][number]]}))
        checks.refused_case(kind, text, f"/{part}/{len(CASE[part])}/name", got)
    side = dict(CASE["boundaries"][0], name="box-x")
    checks.refused_case(kind, json.dumps(dict(CASE, boundaries=[side, *CASE["boundaries"]])), "/boundaries/5/name", "box-x")
    for pair in (["a", "b"], ["b", "a"]):
        text = json.dumps(dict(CASE, laws=[*LAWS, dict(LAWS[1], between=pair)]))
        checks.refused_case(kind, text, f"/laws/{len(LAWS)}/between",
                            f'two laws have the same materials, got "{pair[0]}" and "{pair[1]}"; first at c.json')
    for pointer, key in (("", "step"), ("/domain", "low"), ("/materials/1", "E"), ("/laws/0", "restitution"),
                         ("/laws/0/tangential", "law"), ("/boundaries/1", "radius"), ("/particles/0", "r"),
                         ("/fill/0", "seed")):
        whole = json.loads(json.dumps(CASE))
        at = whole
        for part in pointer.split("/")[1:]:
            at = at[int(part) if isinstance(at, list) else part]
        at["the key"] = at[key]
        checks.refused_case(kind, json.dumps(whole).replace("the key", key), f"{pointer}/{key}",
                            f'the key "{key}" is given twice')


def restitutions(checks):
    """The restitution of every normal and tangential law"""
    for kind, name in re.findall(r"^(normal|tangential) +(\S+)", checks.run("laws").stdout, re.M):
        for e, got in ((-1, "-1"), (-1e-9, "-1e-09"), (1.0000001, r"1\.0000001"), (7, "7")):
            law = {"restitution": e, "mu": 0.1, kind: {"law": name}, "between": ["a", "a"]}
            checks.refused_case("a restitution", json.dumps(dict(CASE, laws=[law, *LAWS[1:]])), "/laws/0/restitution",
                                f"restitution must be from 0 to 1, got {got}")


def derived(checks):
    """Numbers of single precision whose combination is not in its range"""
    stiff = dict(CASE["materials"][0], E=3e38, nu=-0.999)
    checks.refused_case("a combination", json.dumps(dict(CASE, materials=[stiff, *CASE["materials"][1:]])), "/laws/0",
                        r'the effective modulus E\* of "a" and "a" must be at most .*, got 7\.')
    weak = dict(LAWS[7], restitution=0, normal={"law": "walton-braun", "k_1": 1e30})
    checks.refused_case("a combination", json.dumps(dict(CASE, laws=[*LAWS[:7], weak, *LAWS[8:]])), "/laws/7",
                        "the stiffness k_2.* got inf")
    for changes, value in (({"v": [-3.4e38, 0, -3.4e38], "random_v": 3.4e38}, r"velocities must be in the range of single precision.*e\+38"),
                           ({"radius": 1e-30, "least_radius": 1e-30, "low": [0, 0, 0.2], "high": [3e-30, 3e-30, 0.2 + 1e-9],
                             "count": 1}, "(mass must be in the range|high must be at least)")):
        checks.refused_case("a combination", json.dumps(dict(CASE, fill=[dict(CASE["fill"][0], **changes)])),
                            "/fill/0(/high/2)?", value, "--force", "--accept-step")
    heavy = dict(CASE["materials"][0], density=3e38)
    radius = {"r": [0, 0, 0], "radius": 0.8, "material": "a"}
    checks.refused_case("a combination", json.dumps(dict(CASE, materials=[heavy, *CASE["materials"][1:]], particles=[radius],
                                                         boundaries=[])), "/particles/0", "the mass must be .*got 6")
    pressed = dict(LAWS[1], normal={"law": "hooke", "k_n": 3e38, "gamma_n": 3e38})
    checks.refused_case("a combination", json.dumps(dict(CASE, laws=[LAWS[0], pressed, *LAWS[2:]], particles=[
        dict(CASE["particles"][2], v=[0, 0, -1e5])])), "/particles/0", "the contact force is not finite at t = 0 s, got",
        "--force", "--accept-step")


def tables(checks):
    """Cells, rows and headers of a table of particles"""
    header = "x,y,z,radius,material,vx,vy,vz,omega_x,omega_y,omega_z,e0,e1,e2,e3"
    rows = [[str(x), "0", "0.3", "0.05", "1", "0", "0", "0", "0", "0", "0", "1", "0", "0", "0"] for x in (-0.3, 0, 0.3)]
    case = json.dumps(dict(CASE, particles=[], fill=[{"type": "csv", "file": "t.csv"}]))

    def refused(text, message):
        (checks.folder / "t.csv").write_text(text)
        checks.refused_case("a table", case, "/fill/0(/file)?", rf"t\.csv{message}")

    def table(lines, names=header):
        return "\n".join(["# a comment", names, *(",".join(line) for line in lines)]) + "\n"

    (checks.folder / "t.csv").write_text(table(rows))
    ended = checks.start_case(case)
    expect(ended.returncode == 0 and not checks.not_finite(), f"{ended.returncode}: {ended.stderr}")
    for column, name in enumerate(header.split(",")):
        cells = ["", "abc", "nan", "inf", "-inf", "1e39", "-1e39", "1e400", "0x1p3", "1 2"]
        cells += {"radius": ["0", "-1", "1e-46"], "material": ["1.5", "-1", "4"]}.get(name, [])
        for k, cell in enumerate(cells):
            wrong = copy.deepcopy(rows)
            wrong[k % 3][column] = cell
            got = re.escape(cell).replace("e39", r"e\+?39")
            refused(table(wrong), f":{3 + k % 3}: .*({name}|material has this number).* got '?{got}'?")
        for names in (header.replace(name, f"{name},{name}", 1), f"{header},{name}"):
            duplicate = [row[:column] + [row[column]] + row[column:] for row in rows]
            refused(table(duplicate, names), f":2: two columns have the same name, got '{name}'")
    for name in ("x", "y", "z", "radius", "vy", "omega_z", "e3"):
        refused(table(rows, re.sub(rf"\b{name}\b", "other", header)), f":3: missing column {name}; the columns are .*'other'")
    refused(table([rows[0], rows[1][:-1]]), ":4: a row must have a field for each of the 15 columns, got 14")
    refused(table([rows[0], rows[1] + ["0"]]), ":4: a row must have a field for each of the 15 columns, got 16")
    for text in ("", header, "# only a comment\n"):
        refused(text, ": contains no particles")
    for column, cell, message in (
            (11, "0.5", "Euler parameters must have the length 1"), (2, "3", "is outside the domain along z, got 3"),
            (0, "-0.29", "must not overlap by more than 5 % of a radius at the start, got")):
        wrong = copy.deepcopy(rows)
        wrong[1][column] = cell
        refused(table(wrong), rf":[34]: particle [01].*{message}")


def extremes(checks):
    """Legal values that are extreme: 0 or 4, and only finite numbers in the outputs"""
    ends = collections.Counter()
    for path, values in (
            (("gravity", 2), (-1e38, 1e10)), (("particles", 0, "v", 0), (1e5, -3e38)), (("particles", 0, "omega", 0), (1e10, 1e30, -3e38)),
            (("particles", 0, "force", 1), (1e5, 3e38)), (("materials", 0, "density"), (1e30, 1e38)), (("materials", 3, "E"), (1e-30, 3e38)),
            (("laws", 0, "mu"), (3e38,)), (("laws", 0, "rolling", "eta_r"), (1e30, 3e38)), (("laws", 0, "rolling", "mu_r"), (3e38,)),
            (("laws", 0, "cohesion", "k"), (1e15, 3e38)), (("laws", 1, "cohesion", "F_c"), (1e10, 3e38)), (("laws", 1, "normal", "k_n"), (1e-38, 3e38)),
            (("laws", 1, "normal", "gamma_n"), (3e38,)), (("laws", 1, "tangential", "k_t"), (3e38,)), (("laws", 1, "tangential", "gamma_t"), (3e38,)),
            (("laws", 1, "rolling", "slow"), (1e-46, 3e38)), (("laws", 2, "rolling", "k_r"), (3e38,)), (("laws", 3, "normal", "k_n"), (3e38,)),
            (("laws", 4, "normal", "alpha"), (3e38,)), (("laws", 5, "normal", "A"), (3e38,)), (("laws", 6, "normal", "S"), (3e38,)),
            (("laws", 0, "restitution"), (0, 1e-46)), (("boundaries", 1, "v", 0), (1e5, 1e30, -3e38)), (("boundaries", 4, "v", 1), (1e15, 3e38)),
            (("boundaries", 4, "v", 2), ("1e30*t", "exp(1e5*t)*1e37")), (("boundaries", 5, "omega", 0), (1e10, 3e38)),
            (("boundaries", 5, "mass"), (2e-38, 3e38)), (("boundaries", 5, "F", 2), (3e38,)), (("boundaries", 3, "r", 0), (-3e38,)),
            (("boundaries", 2, "half_angle"), (1e-46, 1.5707963)), (("boundaries", 3, "radius"), (2e-38,)), (("skin",), (2e-38,)),
            (("fill", 0, "random_v"), (1e30, 3e38))):
        for value in values:
            ended = checks.start_case(changed(path, value), "--force", "--accept-step")
            what = f"{pointer_to(path)} = {value}: {ended.returncode}: {ended.stderr}"
            ends[ended.returncode] += 1
            if ended.returncode == 3:
                expect(re.fullmatch(r"hilda: error: c\.json:\d+:\d+ \(/.*\): .*, got .*\n", ended.stderr), what)
                continue
            expect(ended.returncode in (0, 4) and not checks.not_finite(), f"{what}{checks.not_finite()}")
            if ended.returncode == 4:
                resumed(checks, ended, what)
            else:
                expect(checks.go_on("--resume", "--end", "4e-5").returncode in (0, 4) and not checks.not_finite(), what)
    expect(ends[0] > 15 and ends[4] > 15, f"both ends: {ends}")
    return ends


def resumed(checks, ended, what):
    """The last state of a failed run is restored, and the run fails in the same way"""
    expect(re.fullmatch(r"hilda: error\[[a-z_]+\]: [^\n]*\n", ended.stderr), what)
    before = checks.contents()
    again = checks.go_on("--resume")
    expect(again.returncode == 4 and not checks.not_finite(), f"{what}, resumed: {again.returncode}: {again.stderr}")
    if "particle_lost" in ended.stderr or "not_finite" in ended.stderr:
        expect(again.stderr == ended.stderr and checks.contents() == before, f"{what}, resumed: {again.stderr}")


def last_state(checks):
    """A run that fails has the files of a run that ends before the failed step, with and without earlier checkpoints"""
    for integrator in ("symplectic-euler", "velocity-verlet"):
        one = {"r": [0, 0, 0], "radius": 0.05, "material": "a", "v": [1, 0, 0]}
        kick = dict(CASE["boundaries"][0], v=[0, 0, "20*step(t-2e-4)"], r=[0, 0, -0.0501])
        stiff = dict(LAWS[1], normal={"law": "hooke", "k_n": 1e14})
        case = dict(CASE, integrator=integrator, particles=[one, dict(one, r=[0.5, 0, 0.01], v=[0, 0, 0])], fill=[],
                    boundaries=[kick], laws=[LAWS[0], stiff, *LAWS[2:]], end=1e-3, interval=1e-4)
        ended = checks.start_case(json.dumps(case), "--force", "--accept-step")
        expect(ended.returncode == 4 and "moves by more than a cell" in ended.stderr,
               f"{integrator}: {ended.returncode}: {ended.stderr}")
        failed, steps = checks.contents(), checks.summary("out")["counters"]["steps"]
        expect(15 < steps < 100 and not checks.not_finite(), f"{integrator}: {steps} steps")
        expect(checks.start_case(json.dumps(case), "--force", "--accept-step", "--checkpoint", "1e-9").stderr == ended.stderr and checks.contents() == failed,
               f"{integrator}: checkpoints do not change the last state")
        resumed(checks, ended, integrator)
        whole = checks.start_case(json.dumps(case), "--force", "--accept-step", "--end", repr(steps * 1e-5))
        expect(whole.returncode == 0, f"{integrator}: {whole.stderr}")
        for name in ("particles.csv", "run.csv"):
            expect(checks.contents()[name] == failed[name], f"{integrator}: {name} is that of a run to the last state")


def checksum(data):
    """io::checksum"""
    h = 0xcbf29ce484222325
    words = struct.unpack_from(f"<{len(data) // 8}Q", data)
    for word in (*words, *data[8 * len(words):]):
        h = (h ^ word) * 0x100000001b3 & 0xffffffffffffffff
        h ^= h >> 29
    return struct.pack("<Q", h)


def sealed(data):
    """A checkpoint with this content, and with its length and checksum"""
    data = data[:16] + struct.pack("<Q", len(data)) + data[24:-8]
    return data + checksum(data)


def checkpoints(checks):
    """Checkpoints with wrong headers, lengths, indices and numbers"""
    expect(checks.start_case(json.dumps(CASE)).returncode == 0, "the case runs")
    kept, out = checks.folder / "kept", checks.folder / "out"
    out.rename(kept)
    good = (kept / "checkpoint.end").read_bytes()
    expect(sealed(good) == good, "the checksum of a checkpoint")

    def resume(data):
        checks.remove("out")
        shutil.copytree(kept, out)
        (out / "checkpoint.end").write_bytes(data)
        return checks.go_on("--resume", "--end", "5e-5")

    def refused(data, message):
        ended = resume(data)
        expect(ended.returncode == 5 and re.fullmatch(rf"hilda: error: out/checkpoint\.end: {message}[^\n]*\n", ended.stderr),
               f"{message}: {ended.returncode}: {ended.stderr}")
        checks.refusals["a checkpoint"] += 1

    damaged, place = "the checkpoint is damaged", r"the checkpoint is damaged at byte \d+"
    expect(resume(good).returncode == 0, "a checkpoint that was not changed")
    for length in (0, 7):
        refused(good[:length], f"{damaged}: the header is not that of a checkpoint, which begins with 'HILDAGRN', got '{'HILDAGR'[:length]}'")
    for length in (8, 31, 32, 100, len(good) - 1):
        refused(good[:length], f"{damaged}: it(s length)? must [^,]*, got {length}")
    for length in (32, 40, len(good) // 3, len(good) // 2, len(good) - 8):
        refused(sealed(good[:length]), f"{place}: (unexpected end of data|invalid length).*, got")
    refused(sealed(good + b"12345678"), f"{place}: unread bytes after the content, got 8")
    refused(b"HILDACKP" + good[8:], f"{damaged}: the header is not that of a checkpoint, which begins with 'HILDAGRN', got 'HILDACKP'")
    refused(good[:-1] + bytes([good[-1] ^ 1]), rf"{damaged}: wrong checksum, it must be \d+, got \d+")
    refused(sealed(good[:8] + struct.pack("<Q", 3) + good[16:]), "the checkpoint has format 3; this program reads format")
    begin = 32 + struct.unpack_from("<Q", good, 24)[0]  # after the id of the run
    refused(sealed(good[:40] + b"x" + good[41:]), "the checkpoint belongs to another run")
    nan, huge, most = 0x7fc00000, 0xffffffff, 0x7f7fffff
    ends = collections.Counter()
    for at in range(begin, len(good) - 12, 4 * checks.sample * max(1, (len(good) - begin) // 4 // 200)):
        for value in (nan, huge, most):
            wrong = bytearray(good)
            struct.pack_into("<I", wrong, at, value)
            ended = resume(sealed(bytes(wrong)))
            what = f"{value:x} at byte {at}: {ended.returncode}: {ended.stderr}"
            ends[ended.returncode] += 1
            if ended.returncode == 5:
                message = rf"out/checkpoint\.end: {damaged}( at byte \d+)?: [^\n]*"
                length = r"out/\w+\.csv: is shorter than the checkpoint states: \d+ bytes, not \d+"
                expect(re.fullmatch(rf"hilda: error: ({message}|{length})\n", ended.stderr), what)
                expect("got" in ended.stderr or "not finite" in ended.stderr or "bytes, not" in ended.stderr, what)
                checks.refusals["a crafted checkpoint"] += 1
            else:
                expect(ended.returncode in (0, 4) and not checks.not_finite(), f"{what}{checks.not_finite()}")
    expect(ends[5] > 200 / checks.sample, f"crafted checkpoints are refused: {ends}")
    return ends


def main():
    with tempfile.TemporaryDirectory() as folder:
        checks = Checks(sys.argv[1], folder)
        checks.sample = int(sys.argv[2]) if len(sys.argv) > 2 else 1
        each_number(checks)
        twice(checks)
        restitutions(checks)
        derived(checks)
        tables(checks)
        legal = extremes(checks)
        last_state(checks)
        crafted = checkpoints(checks)
    expect(sum(checks.refusals.values()) > 1900 / checks.sample, f"refused: {checks.refusals}")
    used = [sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    print(f"{checks.runs} runs; refused: {dict(checks.refusals)}; extreme values, by exit code: {dict(legal)}; "
          f"crafted checkpoints: {dict(crafted)}; {sum(used):.1f} s of CPU")


if __name__ == "__main__":
    main()
