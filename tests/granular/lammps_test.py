#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""hilda-granular export --lammps writes a case for LAMMPS, which computes the same collisions and the same bed.

    lammps_test.py PROGRAM

What has no counterpart is refused with its place. The comparison needs the program lmp (package lammps of Debian, which is large)
and is left out without it.
"""
import csv
import json
import math
import shutil
import subprocess
import sys
import tempfile

from case_runs import Runs, expect

R = 1e-3
GLASS = {"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}
STEEL = {"name": "steel", "density": 7800, "E": 2e8, "nu": 0.3}
LAW = {"restitution": 0.5, "mu": 0.3, "tangential": {"law": "mindlin"}}
PLANE = {"name": "floor", "type": "plane", "normal": [0.1, 0, 1], "material": "steel"}
BALL = {"r": [0, 0, 1.01 * R], "radius": R, "v": [0.1, 0.05, -0.2], "omega": [0, 30, 5], "material": "glass"}
CASE = {"hilda_case": 1, "domain": {"low": [-0.02, -0.02, -0.02], "high": [0.02, 0.02, 0.02]}, "integrator": "velocity-verlet",
        "step": 1e-6, "end": 2e-3, "interval": 2e-5, "frame_interval": 2e-3, "materials": [GLASS, STEEL],
        "laws": [dict(LAW, between=["glass", "glass"]), dict(LAW, between=["glass", "steel"], mu=0.2, restitution=0.7)],
        "boundaries": [PLANE], "particles": [BALL]}
# Two grains that collide obliquely; the first one then turns
PAIR = {"boundaries": [], "gravity": [0, 0, 0],
        "particles": [{"r": [0, 0, 0], "radius": R, "v": [0.1, 0.03, 0], "material": "glass"},
                      {"r": [2.0005 * R, 0.2 * R, 0], "radius": R, "material": "glass"}]}


def write(runs, name, **changes):
    (runs.folder / f"{name}.json").write_text(json.dumps(dict(CASE, **changes)))
    return f"{name}.json"


def exported(runs, name, *arguments, **changes):
    """Lines of in.lammps and of data.lammps"""
    ended = runs.run("export", "--lammps", write(runs, name, **changes), *arguments)
    expect(ended.returncode == 0, f"{name}: {ended.returncode}: {ended.stderr}")
    return [(runs.folder / "out" / f"{name}-lammps" / file).read_text().splitlines() for file in ("in.lammps", "data.lammps")]


def near(a, b, tolerance, what):
    expect(abs(a - b) <= tolerance * abs(b), f"{what}: {a} is not {b}")


def check_coefficients(words, i, j, e, mu):
    """The words of a law of LAMMPS are the laws of the two materials, with its polynomial of the restitution."""
    E_eff = 1 / ((1 - i["nu"] ** 2) / i["E"] + (1 - j["nu"] ** 2) / j["E"])
    G_eff = 1 / sum(2 * (2 - m["nu"]) * (1 + m["nu"]) / m["E"] for m in (i, j))
    cor = float(words[2])
    alpha = 1.2728 - 4.2783 * cor + 11.087 * cor**2 - 22.348 * cor**3 + 27.467 * cor**4 - 18.022 * cor**5 + 4.8218 * cor**6
    near(alpha, -math.sqrt(5) * math.log(e) / math.hypot(math.log(e), math.pi), 1e-6, "damping")
    if words[0] == "hertz":
        near(float(words[1]), 4 / 3 * E_eff, 1e-6, "K")
    else:
        expect(words[0] == "hertz/material" and float(words[1]) == i["E"] and float(words.pop(3)) == i["nu"], f"{words}")
    expect(words[3:7] == ["damping", "tsuji", "tangential", "mindlin"], f"{words}")
    if words[0] == "hertz":
        near(float(words[7]), 8 * G_eff, 1e-6, "k_t")
    else:
        expect(words[7] == "NULL", f"{words}")
    near(float(words[8]), 2 * math.sqrt(G_eff / E_eff), 1e-6, "damping of friction")
    near(float(words[9]), mu, 1e-6, "mu")


def files(runs):
    """The form of both files, and the options of the command"""
    text, data = exported(runs, "form", particles=[BALL, dict(BALL, r=[0.01, 0, 0.01], material="steel", fixed=True)],
                          laws=CASE["laws"] + [dict(LAW, between=["steel", "steel"], restitution=0.05)])
    coefficients = {tuple(line.split()[1:3]): line.split()[3:] for line in text if line.startswith("pair_coeff")}
    check_coefficients(coefficients["1", "1"], GLASS, GLASS, 0.5, 0.3)
    check_coefficients(coefficients["1", "2"], GLASS, STEEL, 0.7, 0.2)
    check_coefficients(coefficients["2", "2"], STEEL, STEEL, 0.05, 0.3)
    walls = [line.split() for line in text if "wall/gran/region" in line]
    expect([words[1:3] for words in walls] == [["wall0_1", "moving1"], ["wall0_2", "moving2"]], f"{walls}")
    check_coefficients(walls[0][5:], GLASS, STEEL, 0.7, 0.2)
    for line in ("units           si", "boundary        f f f", "timestep        1e-06", "run             2000",
                 "group           fixed id 2", "fix             freeze fixed freeze"):
        expect(line in text, f"in.lammps has the line {line}")
    expect(data[2:4] == ["2 atoms", "2 atom types"] and data[5] == "-0.02 0.02 xlo xhi", f"{data[:8]}")
    atom, velocity = (next(line for line in data[data.index(head):] if line.startswith("1 ")).split()
                      for head in ("Atoms # sphere", "Velocities"))
    expect(atom[:2] == ["1", "1"], f"{atom}")
    for found, given in zip(atom[2:] + velocity[1:], [2 * R, 2500, *BALL["r"], *BALL["v"], *BALL["omega"]]):
        expect(abs(float(found) - given) < 1e-6 * abs(given) + 1e-11, f"{atom} {velocity}")

    refused = runs.run("export", "--lammps", "form.json")
    expect(refused.returncode == 2 and "form-lammps: is not empty; --force overwrites its files" in refused.stderr, refused.stderr)
    expect(runs.run("export", "--lammps", "form.json", "--force").returncode == 0, "--force")
    again = [(runs.folder / "out" / "form-lammps" / file).read_text().splitlines() for file in ("in.lammps", "data.lammps")]
    expect(again == [text, data], "the files are the same again")
    text, _ = exported(runs, "set", "--set", "/laws/0/normal/clamped=true", "--end", "1e-3", "--interval", "1e-4",
                       domain=dict(CASE["domain"], periodic=[True, False, False], lost="delete"),
                       laws=[dict(law, tangential={"law": "mindlin", "rescale": True}, normal={"law": "hertz"}) for law in CASE["laws"]],
                       boundaries=[{"type": "box", "low": [-1, -0.01, -0.01], "high": [1, 0.01, 0.01], "material": "steel",
                                    "open": ["-x", "+x", "+z"]}])
    pair = next(line for line in text if line.startswith("pair_coeff"))
    expect(" mindlin_rescale NULL " in pair and pair.endswith(" limit_damping") and "run             1000" in text
           and "boundary        p f f" in text and any("lost ignore" in line for line in text), "\n".join(text))
    expect(sum("wall/gran/region" in line for line in text) == 3, "three sides of a box")


def refusals(runs):
    """What LAMMPS has no counterpart of is refused with its place."""
    def law(**changes):
        first = dict(CASE["laws"][0], **changes)
        return {"laws": [{key: value for key, value in first.items() if value is not None}, CASE["laws"][1]]}

    def wall(**changes):
        return {"boundaries": [dict(PLANE, **changes)]}

    mesh = {"type": "mesh", "lathe": {"profile": [[0.01, 0], [0.01, 0.01]], "segments": 12}, "material": "steel"}
    insert = {"rate": 10, "radius": R, "material": "glass", "region": {"type": "box", "low": [0, 0, 0.01], "high": [0.01, 0.01, 0.015]}}
    clump = {"name": "pair", "material": "glass", "spheres": [{"r": [0, 0, 0], "radius": R}, {"r": [R, 0, 0], "radius": R}]}
    for pointer, what, changes in (
            ("/laws/0/normal", "the normal law hooke", law(normal={"law": "hooke", "k_n": 1e4}, tangential={"law": "none"}, mu=None)),
            ("/laws/0/tangential", "the tangential law coulomb", law(tangential={"law": "coulomb"})),
            ("/laws/0/tangential/spring_bound", "spring_bound", law(tangential={"law": "mindlin", "spring_bound": True})),
            ("/laws/0/mu_s", "mu_s above mu", law(mu_s=0.4)),
            ("/laws/0/rolling", "the rolling law epsd", law(rolling={"law": "epsd", "mu_r": 0.1})),
            ("/laws/0/spin", "the spin law torsional-spring", law(spin={"law": "torsional-spring"})),
            ("/laws/0/cohesion", "the cohesion law sjkr", law(cohesion={"law": "sjkr", "k": 1e3})),
            ("/integrator", "the integrator chung", {"integrator": "chung"}),
            ("/boundaries/0", "a boundary that moves", wall(v=[0, 0, "t"])),
            ("/boundaries/0", "a boundary that moves", wall(mass=1)),
            ("/boundaries/0", "a mesh, of which LAMMPS has no walls,", {"boundaries": [mesh]}),
            ("/boundaries/0/type", "this type of boundary",
             wall(type="cone", normal=None, axis=[0, 0, -1], half_angle=0.5, r=[0, 0, -0.01])),
            ("/boundaries/0/axis", "a cylinder that is not along x, y or z",
             wall(type="cylinder", normal=None, axis=[0, 1, 1], radius=0.02, inside=True)),
            ("/domain/outflow", "an outflow through single sides", {"domain": dict(CASE["domain"], outflow=["-z"])}),
            ("/stages", "a case with stages", {"stages": [{"name": "a", "duration": 1e-3}]}),
            ("/insert", "an insertion", {"insert": [insert]}),
            ("/particles/0/force", "a force on a particle", {"particles": [dict(BALL, force=[0, 0, 1])]}),
            ("/particles/0/attached_to", "an attached particle",
             {"particles": [{"r": [0, 0, 0.01], "radius": R, "material": "glass", "attached_to": "floor"}]}),
            ("/particles/0/replica", "a replica", {"particles": [dict(BALL, replica=1)]}),
            ("/particles/0/clump", "a clump", {"clumps": [clump], "particles": [{"clump": "pair", "r": [0, 0, 0.01]}]})):
        name = write(runs, "refused", **json.loads(json.dumps(changes)))
        case = json.loads((runs.folder / name).read_text())
        case["boundaries"] = [{key: value for key, value in b.items() if value is not None} for b in case["boundaries"]]
        (runs.folder / name).write_text(json.dumps(case))
        ended = runs.run("export", "--lammps", name, "--quiet")
        expect(ended.returncode == 3 and ended.stderr.startswith("hilda: error: refused.json:1:")
               and ended.stderr.endswith(f"({pointer}): {what} has no counterpart in the export to LAMMPS\n"),
               f"{pointer}: {ended.returncode}: {ended.stderr}")
    expect(not (runs.folder / "out" / "refused-lammps").exists(), "a refused export writes no files")
    for given, message in ((("export", "refused.json"), "export: the format is required, --lammps"),
                           (("export", "--lammps"), "export: NAME is required, the case"),
                           (("refused.json", "--lammps"), "--lammps: is valid after export only"),
                           (("export", "--lammps", "refused.json", "--resume"),
                            "--resume: is valid for cases only, but export is a command")):
        ended = runs.run(*given)
        expect(ended.returncode == 2 and ended.stderr == f"hilda: error: granular: {message}\n", f"{given}: {ended.stderr}")


class Both:
    """The results of hilda-granular and of LAMMPS for one case"""

    def __init__(self, runs, name, **changes):
        exported(runs, name, **changes)
        out = runs.folder / "out"
        ended = runs.run(f"{name}.json", "--quiet")
        expect(ended.returncode == 0, ended.stderr)
        ended = subprocess.run(["lmp", "-in", "in.lammps", "-screen", "none"], cwd=out / f"{name}-lammps", check=False,
                               capture_output=True, text=True, env=dict(runs.environment, OMP_NUM_THREADS="1"))
        expect(ended.returncode == 0, (out / f"{name}-lammps" / "log.lammps").read_text()[-1000:])
        with open(out / name / "run.csv") as rows, open(out / f"{name}-lammps" / "lammps.csv") as others:
            by_time = {round(float(row["t"]) * 1e9): row for row in csv.DictReader(rows)}
            self.rows = [(by_time[round(float(other["t"]) * 1e9)], other) for other in csv.DictReader(others)]
        with open(out / name / "particles.csv") as particles:
            self.hilda = [[float(row[key]) for key in ("vx", "vy", "vz", "omega_x", "omega_y", "omega_z")]
                          for row in csv.DictReader(particles)]
        frame = (out / f"{name}-lammps" / "frames.lammpstrj").read_text().split("ITEM: TIMESTEP")[-1].split("ITEM: ATOMS")[1].splitlines()
        self.lammps = [[float(word) for word in line.split()[6:]] for line in frame[1:]]

    def column(self, name):
        return [[float(row[name]) for row in pair] for pair in self.rows]

    def mean(self, name):
        """Of both programs"""
        pairs = self.column(name)
        return [sum(pair[k] for pair in pairs) / len(pairs) for k in (0, 1)]

    def largest_difference(self, particle, of_v, of_omega):
        scales = [of_v] * 3 + [of_omega] * 3
        return max(abs(a - b) / s for a, b, s in zip(self.hilda[particle], self.lammps[particle], scales))


def collisions(runs):
    """Velocities after collisions, relative to the impact velocity v and to v/R"""
    law = CASE["laws"][1]
    cylinder = {"name": "floor", "type": "cylinder", "radius": 4 * R, "material": "steel"}
    sphere = dict(cylinder, type="sphere")
    for name, changes in (
            ("plane", {}), ("free", {"laws": [CASE["laws"][0], dict(law, tangential={"law": "none"})]}),
            ("rescaled", {"laws": [CASE["laws"][0], dict(law, tangential={"law": "mindlin", "rescale": True})]}),
            ("incremental", {"laws": [CASE["laws"][0], dict(law, tangential={"law": "mindlin-incremental"})]}),
            ("clamped", {"laws": [CASE["laws"][0], dict(law, normal={"law": "hertz", "clamped": True})]}),
            ("inelastic", {"laws": [CASE["laws"][0], dict(law, restitution=0.02)]}),
            ("in-cylinder", {"boundaries": [dict(cylinder, axis=[0, 1, 0], inside=True, r=[0, 0, 4 * R])]}),
            ("on-cylinder", {"boundaries": [dict(cylinder, axis=[1, 0, 0], r=[0, 0, -4 * R])]}),
            ("in-sphere", {"boundaries": [dict(sphere, inside=True, r=[0, 0, 4 * R])]}),
            ("on-sphere", {"boundaries": [dict(sphere, r=[0, 0, -4 * R])]})):
        difference = Both(runs, name, **changes).largest_difference(0, 0.2, 0.2 / R)
        print(f"{name}: {difference:.1e}")
        # The ratio of the contact radii of two steps is computed differently.
        expect(difference < (1e-4 if name in ("rescaled", "incremental") else 1e-5), f"{name}: {difference}")
    head_on = Both(runs, "head-on", **dict(PAIR, laws=[dict(CASE["laws"][0], tangential={"law": "none"})]))
    difference = max(head_on.largest_difference(k, 0.1, 0.1 / R) for k in (0, 1))
    print(f"two grains without friction: {difference:.1e}")
    expect(difference < 2e-6, f"two grains without friction: {difference}")
    # LAMMPS has R in the velocity of friction and R - delta/2 in its torque: it is between the levers of HILDA.
    signed = []
    for lever in ("radius", "contact"):
        both = Both(runs, lever, **dict(PAIR, laws=[dict(CASE["laws"][0], lever=lever)]))
        signed.append((both.hilda[0][1] - both.lammps[0][1]) / 0.1)
        expect(both.largest_difference(0, 0.1, 0.1 / R) < 1e-4, lever)
    print(f"two grains with friction: {signed[0]:.1e} with lever radius, {signed[1]:.1e} with contact")
    expect(signed[0] * signed[1] < 0 and abs(sum(signed)) < 1e-5, f"{signed}")


def bed(runs):
    """A bed of 512 grains falls and comes to rest. Single collisions differ after a while; energies and loads do not."""
    low, high = [0, 0, 0], [0.0175, 0.0175, 0.06]
    both = Both(runs, "bed", domain={"low": [-0.002, -0.002, -0.002], "high": [0.0195, 0.0195, 0.06]}, step=5e-6, end=0.05, interval=1e-4,
                particles=[], materials=[GLASS], laws=[LAW], frame_interval=0.05,
                boundaries=[{"name": "box", "type": "box", "low": low, "high": high, "open": ["+z"]}],
                fill=[{"type": "lattice", "low": low, "high": [0.0175, 0.0175, 0.0175], "radius": R, "spacing": 1.05, "jitter": 0.02,
                       "random_v": 0.1}])
    energy, force = both.mean("kinetic_energy"), both.mean("box-z_Fz")
    largest = max(a for a, _ in both.column("kinetic_energy"))
    early = max(abs(a - b) / largest for a, b in both.column("kinetic_energy")[:50])
    late = max(abs(a - b) / largest for a, b in both.column("kinetic_energy"))
    print(f"bed: kinetic energy differs by at most {early:.1e} of its largest value until 5 ms, {late:.1e} until 50 ms; "
          f"means: {energy[1] / energy[0] - 1:.1e}; mean force on the floor: {force[1] / force[0] - 1:.1e}")
    expect(early < 5e-3 and late < 0.15, f"kinetic energy: {early} and {late}")
    expect(abs(energy[1] / energy[0] - 1) < 0.02 and abs(force[1] / force[0] - 1) < 0.02, f"means: {energy}, {force}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        files(runs)
        refusals(runs)
        if shutil.which("lmp") is None:
            print("left out: the comparison with LAMMPS, because there is no program lmp (package lammps)")
            return
        collisions(runs)
        bed(runs)


if __name__ == "__main__":
    main()
