#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 27: laws, meshes, insertion, tables of grains; import and export of models. Each kind with 60 generated variants.

    impact    a grain falls on a plane: its rebound has the coefficient of restitution of the case, or the key is refused
    slide     a grain of 1e-5 to 1e5 m begins to slide: it rolls with 5/7 of its speed, or the size is refused
    weld      a mesh with a crack of 1e-20 to 1e-10 of its size below a grain: the rebound is that on a plane
    inside    an insertion over a closed mesh: no particle is inside of a solid or outside of a container
    behind    an insertion that cannot keep up: a warning with both masses; exit code 4 with --strict
    columns   a particle table with one name of a column misspelt: a warning with the right name; exit code 3 with --strict
    inertia   a URDF file with a damaged <inertial>: refused, or the mass and inertia of the file
    attitude  export and import of a body at the signed permutations of the axes, near them and at any attitude: the same A
"""
import csv
import itertools
import json
import math
import random
import re
import struct

import matrix

SEEDS = 60
GRAVITY = 9.81


def case(R, E, law, step, end, particle, boundaries=None, gravity=GRAVITY, density=2500, size=None):
    size = size or 100 * R
    return {"hilda_case": 1, "name": "c", "gravity": [0, 0, -gravity], "domain": {"low": [-size] * 3, "high": [size] * 3}, "step": step,
            "end": end, "interval": end, "materials": [{"name": "g", "density": density, "E": E, "nu": 0.3}], "laws": [law],
            "boundaries": boundaries or [{"name": "b", "type": "plane", "normal": [0, 0, 1]}], "particles": [particle]}


def hertz_time(R, E, v, density=2500):
    """Duration of the impact of a grain on a plane of the same material [s]"""
    E_star = E / (2 * (1 - 0.09))
    m = density * 4 / 3 * math.pi * R ** 3
    return 2.87 * (m * m / (R * E_star * E_star * v)) ** 0.2


class Door:
    def __init__(self, row, folder):
        self.row, self.folder = row, folder

    def write(self, name, content):
        (self.folder / name).write_text(content if isinstance(content, str) else json.dumps(content))

    def granular(self, *options, limit=120):
        return self.row.run([self.row.granular, "case.json", "--output", "out", "--force", "--quiet", "--no-vtk", *options], cwd=self.folder,
                            limit=limit)

    def particles(self):
        with open(self.folder / "out/particles.csv", encoding="utf-8") as lines:
            return [{key: float(value) for key, value in line.items()} for line in csv.DictReader(lines)]

    # Each kind returns what, passed, why.

    def impact(self, rng):
        R, E, v, e = 10 ** rng.uniform(-4, -1), 10 ** rng.uniform(6, 10), 10 ** rng.uniform(-1.5, 0.5), rng.uniform(0.2, 0.95)
        name = rng.choice(["hertz", "hooke", "scaled-hooke", "hunt-crossley", "kuwabara-kono", "walton-braun"])
        t = hertz_time(R, E, v)
        m = 2500 * 4 / 3 * math.pi * R ** 3
        k = m * (math.pi / t) ** 2
        normal = {"law": name}
        if name in ("hooke", "scaled-hooke"):
            normal["k_n"] = k if name == "hooke" else 10 * k
        if name == "walton-braun":
            normal.update(k_1=k, k_2=k / e ** 2)
        law = {"normal": normal} if name == "walton-braun" else {"restitution": e, "normal": normal}
        gap = 1e-3 * R
        self.write("case.json", case(R, E, law, t / 200, gap / v + 20 * t, {"r": [0, 0, R + gap], "radius": R, "v": [0, 0, -v]}, gravity=0))
        ended = self.granular()
        what = f"impact {name} R {R:.2g} E {E:.2g} v {v:.2g} e {e:.2f}"
        if ended.code != 0:
            return what, ended.code in (2, 3) and matrix.is_one_line(ended.err), ended.err
        rebound = self.particles()[0]["vz"] / v
        return what, abs(rebound - e) < 0.03, f"{rebound:.3f}"

    def slide(self, rng):
        R = 10 ** rng.uniform(-5, 5)
        E = 2500 * GRAVITY * R * 10 ** rng.uniform(4.5, 6)
        v, mu = 0.3 * math.sqrt(GRAVITY * R), rng.uniform(0.2, 0.6)
        name = rng.choice(["mindlin", "mindlin-incremental", "mindlin-deresiewicz"])
        t = hertz_time(R, E, v)
        end = 3 * 2 / 7 * v / (mu * GRAVITY)
        self.write("case.json", case(R, E, {"restitution": 0.5, "mu": mu, "tangential": {"law": name}}, t / 60, end,
                                     {"r": [0, 0, R], "radius": R, "v": [v, 0, 0]}))
        ended = self.granular()
        what = f"slide {name} R {R:.2g} E {E:.2g} mu {mu:.2f}"
        if ended.code != 0:
            return what, ended.code in (2, 3) and matrix.is_one_line(ended.err), ended.err
        left = self.particles()[0]["vx"] / v
        return what, abs(left - 5 / 7) < 0.01, f"{left:.4f} v"

    def weld(self, rng):
        R, half = 0.002, 0.03
        crack = half * 10 ** rng.uniform(-20, -10)
        side = rng.uniform(-0.3, 0.3) * half
        binary = rng.random() < 0.5
        corners = [[[-half, -half, 0], [side, -half, 0], [side, half, 0]], [[-half, -half, 0], [side, half, 0], [-half, half, 0]],
                   [[side + crack, -half, 0], [half, -half, 0], [half, half, 0]],
                   [[side + crack, -half, 0], [half, half, 0], [side + crack, half, 0]]]
        if binary:
            data = bytes(80) + struct.pack("<I", 4)
            for t in corners:
                data += struct.pack("<12fH", 0, 0, 1, *[x for p in t for x in p], 0)
            (self.folder / "m.stl").write_bytes(data)
        else:
            facets = "".join("facet normal 0 0 1\nouter loop\n" + "".join("vertex {!r} {!r} {!r}\n".format(*p) for p in t) +
                             "endloop\nendfacet\n" for t in corners)
            self.write("m.stl", f"solid a\n{facets}endsolid a\n")
        law = {"restitution": 0.5, "mu": 0.3, "tangential": {"law": "mindlin"}}
        t = hertz_time(R, 1e7, 0.3)
        above = [side + rng.uniform(-0.05, 0.05) * R, rng.uniform(-0.2, 0.2) * half, R * 1.001]
        self.write("case.json", case(R, 1e7, law, t / 200, 3 * t, {"r": above, "radius": R, "v": [0, 0, -0.3]},
                                     [{"name": "m", "type": "mesh", "file": "m.stl"}], gravity=0, size=0.05))
        ended = self.granular()
        what = f"weld {crack:.1e} {'binary' if binary else 'text'}"
        if ended.code != 0:
            return what, ended.code == 3 and matrix.is_one_line(ended.err), ended.err
        rebound = self.particles()[0]["vz"] / 0.3
        return what, abs(rebound - 0.5) < 0.01, f"{rebound:.3f}"

    def inside(self, rng):
        low = [rng.uniform(0.005, 0.015) for _ in range(3)]
        high = [rng.uniform(0.025, 0.035) for _ in range(3)]
        container = rng.random() < 0.5
        R = 10 ** rng.uniform(-3.5, -3)
        region = {"type": "box", "low": [0, 0, 0], "high": [0.04] * 3}
        content = {"hilda_case": 1, "name": "c", "gravity": [0, 0, 0], "domain": {"low": [-0.01] * 3, "high": [0.05] * 3}, "step": 1e-6,
                   "end": 2e-6, "interval": 1e-6, "materials": [{"name": "g", "density": 2500, "E": 5e6, "nu": 0.3}],
                   "laws": [{"restitution": 0.5, "mu": 0.5, "tangential": {"law": "mindlin"}}],
                   "boundaries": [{"name": "m", "type": "mesh", "box": {"low": low, "high": high, "inside": container}}],
                   "insert": [{"name": "a", "count": 300, "radius": R, "region": region}], "fill": []}
        self.write("case.json", content)
        ended = self.granular()
        what = f"inside {'container' if container else 'solid'} R {R:.2g}"
        if ended.code != 0:
            return what, ended.code == 3 and matrix.is_one_line(ended.err), ended.err
        wrong = 0
        rows = self.particles()
        for p in rows:
            is_in = all(a < p[x] < b for a, b, x in zip(low, high, "xyz"))
            wrong += is_in != container
        return what, len(rows) > 0 and wrong == 0, f"{wrong} of {len(rows)}"

    def behind(self, rng):
        rate = 10 ** rng.uniform(-0.5, 1)
        content = {"hilda_case": 1, "name": "c", "domain": {"low": [0, 0, 0], "high": [0.02, 0.02, 0.2], "outflow": ["-z"], "lost": "delete"},
                   "step": 1e-5, "end": 0.03, "interval": 0.01, "materials": [{"name": "g", "density": 2500, "E": 1e7, "nu": 0.3}],
                   "laws": [{"restitution": 0.5, "mu": 0.5, "tangential": {"law": "mindlin"}}],
                   "insert": [{"name": "a", "mass_rate": rate, "to": 0.03, "radius": 0.001, "v": [0, 0, -rng.uniform(0.1, 1)],
                               "region": {"type": "box", "low": [0, 0, 0.15], "high": [0.02, 0.02, 0.16]}}]}
        self.write("case.json", content)
        ended = self.granular()
        inserted = sum(2500 * 4 / 3 * math.pi * p["radius"] ** 3 for p in self.particles()) if ended.code == 0 else 0
        due = 0.03 * rate
        # as the guide says: a tenth, of what was due at the insertion before the last one, and ten particles
        late = due - inserted > max(0.1 * due, 10 * 2500 * 4 / 3 * math.pi * 1e-9)
        unclear = abs(due - inserted - 0.1 * due) < 0.1 * due  # those of the last interval wait for the next one
        summary = json.loads((self.folder / "out/summary.json").read_text())
        said = "cannot keep up" in summary["insertions"][0].get("warning", "")
        strict = self.granular("--strict")
        late = said if unclear else late
        return f"behind {rate:.2g} kg/s", ended.code == 0 and said == late and (strict.code == 4) == late, (
            f"exit {ended.code}, {strict.code}, inserted {inserted:.3g} of {due:.3g} kg, {summary['insertions']}")

    def columns(self, rng):
        names = ["id", "material", "radius", "x", "y", "z", "vx", "vy", "vz", "omega_x", "omega_y", "omega_z"]
        wrong = rng.choice(names[6:])
        how = rng.randrange(4)
        letters = "abcdefgz_"
        at = rng.randrange(len(wrong))
        spelt = [wrong[:at] + wrong[at + 1:], wrong[:at] + rng.choice(letters) + wrong[at:], wrong.upper(),
                 wrong.replace("omega_", "w").replace("v", "velocity_")][how]
        if spelt in names or not spelt or any(spelt == other for other in names):
            spelt = wrong + "_"
        header = [spelt if name == wrong else name for name in names]
        self.write("p.csv", ",".join(header) + "\n0,0,0.001,0,0,0.01,0.1,0.2,0.3,1,2,3\n")
        content = case(0.001, 1e7, {"restitution": 0.5}, 1e-6, 2e-6, {}, gravity=0)
        del content["particles"]
        content["fill"] = [{"type": "csv", "file": "p.csv"}]
        self.write("case.json", content)
        ended, strict = self.granular(), self.granular("--strict")
        if ended.code == 3:
            return f"columns {spelt} for {wrong}", spelt in ended.err, ended.err
        return (f"columns {spelt} for {wrong}", ended.code == 0 and spelt in ended.err and "warning" in ended.err and strict.code == 3,
                f"exit {ended.code}, {strict.code}: {ended.err}")

    def inertia(self, rng):
        fixed = rng.random() < 0.5
        mass, ixx = rng.uniform(0.5, 5), rng.uniform(0.1, 0.2)
        values = {"mass": f"{mass!r}", "ixx": f"{ixx!r}", "iyy": f"{ixx!r}", "izz": f"{ixx!r}", "ixy": "0", "ixz": "0", "iyz": "0"}
        damaged = rng.choice(sorted(values))
        how = rng.choice(["missing", "comma", "text", "empty", "nan", "two", "element", "none"])
        if how == "comma":
            values[damaged] = values[damaged].replace(".", ",") if "." in values[damaged] else "0,5"
        elif how == "text":
            values[damaged] = "heavy"
        elif how == "empty":
            values[damaged] = ""
        elif how == "nan":
            values[damaged] = "nan"
        elif how == "two":
            values[damaged] += " 1"
        inertia = " ".join(f'{key}="{values[key]}"' for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz") if how != "missing" or key != damaged)
        of_mass = "<mass/>" if how == "missing" and damaged == "mass" else f'<mass value="{values["mass"]}"/>'
        if how == "element":
            of_mass, inertia = ("", inertia) if damaged == "mass" else (of_mass, None)
        inertial = f'<inertial><origin xyz="0.5 0 0"/>{of_mass}{"" if inertia is None else f"<inertia {inertia}/>"}</inertial>'
        robot = (f'<robot name="a"><link name="base"/><link name="arm"><inertial><origin xyz="0.1 0 0"/><mass value="1"/><inertia ixx="0.1" '
                 f'iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="tool">{inertial}</link>'
                 '<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>'
                 f'<joint name="k" type="{"fixed" if fixed else "continuous"}"><parent link="arm"/><child link="tool"/>'
                 '<axis xyz="0 1 0"/></joint></robot>')
        self.write("a.urdf", robot)
        ended = self.row.run([self.row.hilda, "import", "a.urdf", "--output", "a.json", "--force"], cwd=self.folder)
        what = f"inertia {how} {damaged} {'fixed' if fixed else 'moving'}"
        if how != "none":
            return what, ended.code == 3 and "a.urdf" in ended.err, f"exit {ended.code}: {ended.err}"
        total = sum(body["mass"] for body in json.loads((self.folder / "a.json").read_text())["bodies"])
        return what, ended.code == 0 and abs(total - 1 - mass) < 1e-12 * mass, f"exit {ended.code}, mass {total}: {ended.err}"

    def attitude(self, rng, seed):
        def turn(axis, angle):
            c, s = math.cos(angle), math.sin(angle)
            i, j = (axis + 1) % 3, (axis + 2) % 3
            A = [[float(a == b) for b in range(3)] for a in range(3)]
            A[i][i], A[i][j], A[j][i], A[j][j] = c, -s, s, c
            return A

        def product(A, B):
            return [[sum(A[i][k] * B[k][j] for k in range(3)) for j in range(3)] for i in range(3)]

        permutations = list(itertools.permutations(range(3)))
        signed = []
        for p in permutations:
            for signs in range(8):
                A = [[0.0] * 3 for _ in range(3)]
                for i in range(3):
                    A[i][p[i]] = -1.0 if signs >> i & 1 else 1.0
                det = (A[0][0] * (A[1][1] * A[2][2] - A[1][2] * A[2][1]) - A[0][1] * (A[1][0] * A[2][2] - A[1][2] * A[2][0]) +
                       A[0][2] * (A[1][0] * A[2][1] - A[1][1] * A[2][0]))
                if det > 0:
                    signed.append(A)
        A = signed[seed % 24]
        if seed >= 24:
            small = 10 ** rng.uniform(-12, 0)
            for axis in range(3):
                A = product(A, turn(axis, small * rng.uniform(-1, 1)))
        model = {"hilda_model": 1, "name": "m", "gravity": [0, 0, -9.81],
                 "bodies": [{"name": "a", "mass": 1, "inertia": [1, 2, 2.5], "r": [0.1, 0.2, 0.3], "A": A}],
                 "constraints": [{"name": "j", "type": "revolute", "body_i": "ground", "body_j": "a",
                                  "s_bar_p_i": [0, 0, 0], "s_bar_q_j": [-sum(A[k][i] * v for k, v in enumerate((0.1, 0.2, 0.3))) for i in range(3)],
                                  "axis_bar_i": [A[k][2] for k in range(3)], "axis_bar_j": [0, 0, 1]}]}
        self.write("m.json", model)
        out = self.row.run([self.row.hilda, "export", "m.json", "--output", "m.urdf", "--force"], cwd=self.folder)
        back = self.row.run([self.row.hilda, "import", "m.urdf", "--output", "back.json", "--force"], cwd=self.folder)
        self.row.run(["rm", "-rf", "one", "two"], cwd=self.folder)
        rows = []
        for name, file in (("one", "m.json"), ("two", "back.json")):
            self.row.run([self.row.hilda, "run", file, "--end", "0.2", "--interval", "0.1", "--step", "1e-3", "--quiet", "--output", name],
                         cwd=self.folder)
            try:
                with open(self.folder / name / "trajectory.csv", encoding="utf-8") as lines:
                    last = list(csv.DictReader(lines))[-1]
                rows.append([float(value) for key, value in last.items() if re.fullmatch(r"a\.(r[xyz]|A\d\d|v[xyz])", key)])
            except (OSError, IndexError):
                rows.append([])
        difference = max((abs(x - y) for x, y in zip(*rows)), default=math.inf) if len(rows[0]) == len(rows[1]) else math.inf
        return f"attitude {seed}", difference < 1e-9, f"difference {difference:.2g}: {out.err} {back.err}"


KINDS = ["impact", "slide", "weld", "inside", "behind", "columns", "inertia", "attitude"]


def main():
    def options(parser):
        parser.add_argument("--kinds", default="", help="names, separated by commas; default: all")

    row = matrix.Row("27 doors", options)
    with matrix.scratch() as folder:
        door = Door(row, folder)
        for kind in [name for name in row.options.kinds.split(",") if name] or KINDS:
            for seed in range(SEEDS):
                rng = random.Random(f"{kind}{seed}")
                row.case(*(door.attitude(rng, seed) if kind == "attitude" else getattr(door, kind)(rng)))
    row.end()


main()
