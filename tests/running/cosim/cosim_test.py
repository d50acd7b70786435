#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""hilda cosim: a ball in comparison with a tool of hilda-granular, momentum and energy, the order in the step of the mechanism,
one result for interruptions and threads, and errors.

    cosim_test.py HILDA HILDA-GRANULAR
"""
import copy
import csv
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import jsonschema

M, RADIUS = 3e-3, 6e-3
J = 0.4 * M * RADIUS ** 2
CUP = {"hilda_case": 1, "name": "cup", "domain": {"low": [-0.02, -0.02, -0.01], "high": [0.02, 0.02, 0.1]},
       "step": 5e-6, "end": 1, "interval": 5e-4, "frame_interval": 1,
       "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
       "laws": [{"between": ["glass", "glass"], "restitution": 0.6, "mu": 0.4, "tangential": {"law": "mindlin"}}],
       "boundaries": [{"name": "floor", "type": "plane", "normal": [0, 0, 1], "material": "glass"},
                      {"name": "wall", "type": "cylinder", "axis": [0, 0, 1], "radius": 0.0125, "inside": True, "material": "glass"},
                      {"name": "ball", "type": "sphere", "radius": RADIUS, "r": [7e-4, 3e-4, 0.0225], "material": "glass"}],
       "fill": [{"type": "lattice", "low": [-0.0085, -0.0085, 0], "high": [0.0085, 0.0085, 0.015], "radius": 1e-3, "spacing": 1.02,
                 "jitter": 1, "random_v": 0.05, "material": "glass"}]}
MODEL = {"hilda_model": 1, "name": "ball", "gravity": [0, 0, -9.81], "end": 1,
         "bodies": [{"name": "ball", "mass": M, "inertia": [J, J, J], "r": [7e-4, 3e-4, 0.0225], "r_dot": [0.05, 0, -0.8],
                     "omega": [3, -4, 10]}]}
COSIM = {"hilda_cosim": 1, "model": "model.json", "case": "case.json", "end": 0.02, "interval": 5e-4, "pairs": [{"body": "ball"}]}


# A ball that rocks on three heavy grains with linear springs without damping: a smooth motion without end
SEAT = {"hilda_case": 1, "name": "seat", "domain": {"low": [-0.02] * 3, "high": [0.02, 0.02, 0.04]}, "step": 2e-6, "end": 1,
        "interval": 1e-3, "frame_interval": 1, "gravity": [0, 0, 0],
        "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}, {"name": "heavy", "density": 1e9, "E": 7e7, "nu": 0.24}],
        "laws": [{"between": ["glass", "heavy"], "normal": {"law": "hooke", "k_n": 2e3, "gamma_n": 0}},
                 {"between": ["heavy", "heavy"], "normal": {"law": "hooke", "k_n": 2e3, "gamma_n": 0}}],
        "boundaries": [{"name": "ball", "type": "sphere", "radius": RADIUS, "r": [0, 0, 0.0071], "material": "glass"}],
        "particles": [{"r": [4e-3 * math.cos(a), 4e-3 * math.sin(a), 1.1e-3], "radius": 1.2e-3, "material": "heavy"}
                      for a in (0, 2.1, 4.2)]}


def expect(condition, what):
    if not condition:
        sys.exit(f"failed: {what}")


class Runs:
    def __init__(self, hilda, granular, folder):
        self.hilda, self.granular, self.folder = hilda, granular, pathlib.Path(folder)

    def files(self, name, cosim, case=None, model=None):
        """Writes the three files of a co-simulation to a folder of its own"""
        path = self.folder / name
        path.mkdir(exist_ok=True)
        for file, content in (("cosim.json", cosim), ("case.json", case or CUP), ("model.json", model or MODEL)):
            (path / file).write_text(json.dumps(content))
        return path

    def start(self, name, *arguments):
        return subprocess.Popen([self.hilda, "cosim", f"{name}/cosim.json", *arguments], cwd=self.folder, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def finish(self, name, *arguments, code=0):
        process = self.start(name, *arguments)
        out, err = process.communicate()
        expect(process.returncode == code, f"{name} {arguments}: ended with {process.returncode}, not {code}: {out} {err}")
        return out + err

    def refused(self, name, code, message):
        process = self.start(name, "--output", f"{name}/out", "--quiet")
        _, err = process.communicate()
        expect(process.returncode == code and len(err.strip().split("\n")) == 1 and re.search(message, err),
               f"{name}: {code} with {message}, got {process.returncode} with {err}")

    def table(self, file):
        with open(self.folder / file, encoding="utf-8") as text:
            return [{key: float(value) for key, value in row.items() if value not in ("", None) and re.match(r"^[-+.\d]|nan|inf", value)}
                    for row in csv.DictReader(line for line in text if not line.startswith("#"))]


def as_tool(case, model):
    """The case with the ball as a free tool. Its velocity is that half a step before the start, where nothing touches it."""
    case = copy.deepcopy(case)
    ball = next(b for b in case["boundaries"] if b["name"] == "ball")
    body = model["bodies"][0]
    v = [body["r_dot"][k] - 0.5 * case["step"] * model["gravity"][k] for k in range(3)]
    ball.update(mass=M, inertia=J, v=v, omega=body["omega"], free=[True] * 6)
    if "gravity" in case:  # the grains have none
        ball["F"] = [M * g for g in model["gravity"]]
    return case


def struck():
    """The model of a ball on the seat"""
    model = copy.deepcopy(MODEL)
    model["bodies"][0].update(r=[0, 0, 0.0071], r_dot=[0.02, 0.01, 0], omega=[0, 0, 0])
    return model


def ball_is_a_tool(runs):
    """With one substep the body moves as a tool that hilda-granular integrates, and the grains have the same energy"""
    largest = 0
    # In the cup the motion is chaotic: rounding errors grow to 1e-9 m within 9 ms of impacts.
    for name, case, model, end in ("cup", CUP, MODEL, 0.006), ("seat", SEAT, struck(), 0.05):
        folder = runs.files(name, dict(COSIM, substeps=1, end=end), case, model)
        (folder / "tool.json").write_text(json.dumps(as_tool(case, model)))
        process = subprocess.run([runs.granular, f"{name}/tool.json", "--end", str(end), "--output", f"{name}/tool", "--quiet",
                                  "--threads", "1", "--force"], cwd=runs.folder, check=False)
        expect(process.returncode == 0, "the tool")
        runs.finish(name, "--output", f"{name}/out")
        tool, grains = runs.table(f"{name}/tool/run.csv"), runs.table(f"{name}/out/grains/run.csv")
        body = {round(row["t"], 9): row for row in runs.table(f"{name}/out/tools.csv")}
        for row in tool[:-1]:
            other = body[round(row["t"], 9)]
            for axis in "xyz":
                largest = max(largest, abs(other[f"ball.{axis}"] - row[f"ball_{axis}"]))
        expect(largest < 1e-9, f"{name}: the ball differs from a tool by {largest} m")
        expect(max(abs(row["ball.Fz"]) for row in body.values()) > M * 9.81, f"{name}: there are contacts")
        energy = max(row["kinetic_energy"] for row in tool)
        for one, two in zip(tool[:-1], grains):
            expect(abs(one["kinetic_energy"] - two["kinetic_energy"]) <= 1e-6 * energy, f"energy of the grains at {one['t']}: {one} {two}")
    return largest


def momentum(runs):
    """A ball hits grains in free space: the momentum of both is constant to rounding for any number of substeps"""
    free = copy.deepcopy(CUP)
    free.update(gravity=[0, 0, 0], boundaries=[free["boundaries"][2]], domain={"low": [-0.2] * 3, "high": [0.2, 0.2, 0.2]},
                fill=[dict(free["fill"][0], low=[-0.0085, -0.0085, 0.013], high=[0.0085, 0.0085, 0.0155])])
    model = copy.deepcopy(MODEL)
    model["gravity"] = [0, 0, 0]
    # the same with a second sphere as a part of the boundary, which is in front in the motion
    parts = copy.deepcopy(free)
    parts["boundaries"].append({"name": "nose", "type": "sphere", "radius": 3e-3, "r": [7e-4, 3e-4, 0.0185],
                                "part_of": "ball", "material": "glass"})
    for k, case in (1, free), (2, free), (3, free), (8, free), (4, parts):
        runs.files(f"free{k}", dict(COSIM, substeps=k, end=0.06), case, model)
        runs.finish(f"free{k}", "--output", f"free{k}/out")
        grains, tools = runs.table(f"free{k}/out/grains/run.csv"), runs.table(f"free{k}/out/tools.csv")
        body = runs.table(f"free{k}/out/trajectory.csv")
        # at the end they are apart, and the velocity of the body is constant
        expect(all(row["ball.Fz"] == 0 for row in tools[-12:]) and max(abs(row["ball.Fz"]) for row in tools) > 0.05,
               "there were contacts, and there are none at the end")
        first, last = body[0], body[-1]
        scale = M * 0.8
        for axis in "xyz":
            name = next(key for key in body[0] if re.fullmatch(rf"ball[._]?(r_?dot_?{axis}|v{axis}|{axis}_?dot)", key))
            change = M * (last[name] - first[name])
            before, after = grains[0][f"momentum_{axis}"], grains[-1][f"momentum_{axis}"]
            expect(abs(change + after - before) < 3e-7 * scale, f"k = {k}: the momentum along {axis} changes by {change + after - before}")


def orders(runs):
    """Position of the ball on the seat and mismatch of the energies over the step of the mechanism"""
    ends, errors = [], []
    steps = (1, 10, 20, 40)
    for k in steps:
        runs.files(f"seat{k}", dict(COSIM, substeps=k, end=0.02, interval=4e-3), SEAT, struck())
        runs.finish(f"seat{k}", "--output", f"seat{k}/out")
        rows = runs.table(f"seat{k}/out/tools.csv")
        ends.append([rows[-1][f"ball.{axis}"] for axis in "xyz"])
        errors.append(abs(rows[-1]["ball.energy_error"]))
        expect(max(abs(row["ball.Fz"]) for row in rows) > 2 * M * 9.81 / 3, "the ball is struck")
    distance = [math.dist(end, ends[0]) for end in ends[1:]]
    order = [math.log2(b / a) for a, b in zip(distance, distance[1:])]
    mismatch = [math.log2(b / a) for a, b in zip(errors[1:], errors[2:])]
    print(f"order of the position {order}, of the energy mismatch {mismatch}; {errors}")
    expect(all(o > 0.9 for o in order), f"order of the position: {order}, {distance}")
    expect(all(o > 0.9 for o in mismatch), f"order of the energy mismatch: {mismatch}, {errors}")


def content(runs, output):
    out = runs.folder / output
    files = [file for file in sorted(out.rglob("*")) if file.suffix in (".csv", ".vtp", ".pvd") or file.name == "checkpoint.end"]
    return {str(file.relative_to(out)): file.read_bytes() for file in files if file.parent.name == "grains" or file.suffix == ".csv"}


def one_result(runs):
    """Interruptions and kills, and a later end"""
    runs.files("cut", dict(COSIM, substeps=4, end=0.03))
    runs.finish("cut", "--output", "cut/whole")
    whole = content(runs, "cut/whole")
    expect("tools.csv" in whole and "grains/run.csv" in whole and "trajectory.csv" in whole, f"{list(whole)}")
    runs.finish("cut", "--output", "cut/pipe", "--transport", "pipe", "--threads", "2")
    pipe = content(runs, "cut/pipe")
    expect(pipe == whole, f"the grains in a process of their own: {[name for name in whole if pipe.get(name) != whole[name]]} differ")
    for closed in (0,), (0, 1, 2):  # standard descriptors that are closed
        subprocess.run(["rm", "-rf", str(runs.folder / "cut/closed")], check=True)
        code = subprocess.run([runs.hilda, "cosim", "cut/cosim.json", "--output", "cut/closed", "--transport", "pipe", "--quiet"], cwd=runs.folder,
                              preexec_fn=lambda closed=closed: [os.close(number) for number in closed], check=False).returncode
        expect(code == 0 and content(runs, "cut/closed") == whole, f"closed {closed}: {code}")
    for which, transport in (signal.SIGINT, "in-process"), (signal.SIGKILL, "in-process"), (signal.SIGINT, "pipe"), (signal.SIGKILL, "pipe"):
        parts = 0
        while True:
            process = runs.start("cut", "--output", "cut/part", "--resume", "--checkpoint", "0.02", "--quiet", "--transport", transport)
            file, before, written = runs.folder / "cut/part/checkpoint", None, 0
            while process.poll() is None and written < 3 + parts:
                time.sleep(1e-3)
                try:
                    now = file.stat().st_mtime_ns
                except FileNotFoundError:
                    now = None
                written, before = written + (now not in (None, before)), now
            if process.poll() is None:
                process.send_signal(which)
            _, err = process.communicate()
            if process.returncode == 0:
                break
            expect(process.returncode in (130, -signal.SIGKILL), f"{process.returncode}: {err}")
            parts += 1
            expect(parts < 100, "the run comes to its end")
        expect(parts > 0, "there was an interruption")
        part = content(runs, "cut/part")
        expect(part == whole, f"{parts} interruptions by {which}, {transport}: {[name for name in whole if part.get(name) != whole[name]]} differ")
        subprocess.run(["rm", "-r", str(runs.folder / "cut/part")], check=True)
    # the process of the grains is killed: the mechanism ends, and both continue
    process = runs.start("cut", "--output", "cut/lost", "--transport", "pipe", "--checkpoint", "0.02")
    while process.poll() is None and not (runs.folder / "cut/lost/checkpoint").exists():
        time.sleep(1e-3)
    children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    os.kill(int(children[0]), signal.SIGKILL)
    _, err = process.communicate()
    expect(process.returncode == 4 and "hilda-granular has ended during an exchange" in err, f"{process.returncode}: {err}")
    runs.finish("cut", "--output", "cut/lost", "--resume", "--transport", "pipe")
    expect(content(runs, "cut/lost") == whole, "a run whose grains were killed continues")
    ends_one_by_one(runs, whole)
    runs.finish("cut", "--output", "cut/half", "--end", "0.012")
    runs.finish("cut", "--output", "cut/half", "--resume", "--end", "0.03")
    half = content(runs, "cut/half")
    expect(half == whole, f"a later end: {[name for name in whole if half.get(name) != whole[name]]} differ")
    for transport in "in-process", "pipe":
        said = runs.finish("cut", "--output", "cut/half", "--resume", "--end", "0.03", "--transport", transport)
        expect("its run is complete, with the end 0.03 s" in said and content(runs, "cut/half") == whole, f"a complete run: {said}")


def ends_one_by_one(runs, whole):
    """Kills after the last step: the mechanism has not ended; the grains have, or have not"""
    for substeps in 1, 4:
        name = f"end{substeps}"
        runs.files(name, dict(COSIM, substeps=substeps, end=0.03))
        runs.finish(name, "--output", name + "/whole")
        expected = content(runs, name + "/whole")
        expect(substeps != 4 or expected == whole, "two equal runs")
        for grains_have_ended in True, False:
            cut = runs.folder / name / "cut"
            shutil.copytree(runs.folder / name / "whole", cut)
            for folder in [cut] if grains_have_ended else [cut, cut / "grains"]:
                (folder / "checkpoint.end").rename(folder / "checkpoint")
                (folder / "summary.json").unlink()
            runs.finish(name, "--output", name + "/cut", "--resume")
            got = content(runs, name + "/cut")
            expect(got == expected, f"substeps {substeps}: {[name for name in expected if got.get(name) != expected[name]]} differ")
            shutil.rmtree(cut)
        # killed between the first checkpoints of the two sides: that of the grains is at their last step
        shutil.copytree(runs.folder / name / "whole", cut)
        (cut / "checkpoint.end").unlink()
        (cut / "grains/checkpoint.end").rename(cut / "grains/checkpoint")
        for folder in cut, cut / "grains":
            (folder / "summary.json").unlink()
        runs.finish(name, "--output", name + "/cut", "--resume")
        expect(content(runs, name + "/cut") == expected, f"substeps {substeps}: a run that starts again")
        # the grains have lost their checkpoint
        (cut / "checkpoint.end").rename(cut / "checkpoint")
        (cut / "grains/checkpoint.end").unlink()
        for folder in cut, cut / "grains":
            (folder / "summary.json").unlink()
        process = runs.start(name, "--output", name + "/cut", "--resume", "--quiet")
        _, err = process.communicate()
        expect(process.returncode == 5 and "grains: has no checkpoint of step" in err, f"{process.returncode}: {err}")
        shutil.rmtree(cut)


def ranks(runs):
    """The grains as rank 1 of mpirun: the same files, also after a rank was killed"""
    mpirun = shutil.which("mpirun")
    # Containers without a network interface forbid mpirun to start processes.
    if (mpirun is None or not (pathlib.Path(runs.hilda).parent / "hilda-mpi.so").exists() or
            subprocess.run([mpirun, "--allow-run-as-root", "--oversubscribe", "-n", "2", "true"], capture_output=True, timeout=60,
                           check=False).returncode != 0):
        print("left out: co-simulation on two ranks of mpirun")
        return
    runs.files("ranks", dict(COSIM, substeps=4, end=0.03))
    runs.finish("ranks", "--output", "ranks/whole")
    whole = content(runs, "ranks/whole")

    def start(output, *arguments, count=2, more=()):
        return subprocess.Popen([mpirun, "--allow-run-as-root", "--oversubscribe", *more, "-n", str(count), runs.hilda, "cosim",
                                 "ranks/cosim.json",
                                 "--transport", "mpi", "--output", output, *arguments], cwd=runs.folder, text=True, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, env=dict(os.environ, ASAN_OPTIONS="detect_leaks=0"))  # Open MPI leaks memory

    def finish(code, *arguments, **options):
        process = start(*arguments, **options)
        out, err = process.communicate(timeout=300)
        expect(process.returncode == code, f"mpirun {arguments}: ended with {process.returncode}, not {code}: {out} {err}")
        return err

    finish(0, "ranks/mpi")
    expect("is not empty" in finish(2, "ranks/mpi"), "a folder with results is refused, and both ranks end")
    expect(content(runs, "ranks/mpi") == whole, "two ranks write the same files")
    for which in 0, 1:
        output = f"ranks/killed{which}"
        process = start(output, "--checkpoint", "0.02")
        while process.poll() is None and not (runs.folder / output / "checkpoint").exists():
            time.sleep(1e-3)
        for child in pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split():
            if f"OMPI_COMM_WORLD_RANK={which}\0".encode() in pathlib.Path(f"/proc/{child}/environ").read_bytes():
                os.kill(int(child), signal.SIGKILL)
        process.communicate(timeout=300)
        expect(process.returncode != 0, f"rank {which} was killed: {process.returncode}")
        finish(0, output, "--resume")
        expect(content(runs, output) == whole, f"a run whose rank {which} was killed continues")
    expect("needs two ranks, mpirun -n 2 hilda cosim ..., got 3" in finish(2, "ranks/three", count=3), "three ranks are refused")
    runs.files("ranks", dict(COSIM, pairs=[{"body": "ball", "boundary": "bal"}]))
    err = finish(3, "ranks/wrong")
    expect(err.count("tool 'bal': no boundary of the case has this name") == 1, err)


def errors(runs):
    """Names, places, masses and steps that do not fit"""
    def cosim(name, message, code=3, case=None, model=None, **changes):
        runs.files(name, dict(COSIM, **changes), case, model)
        runs.refused(name, code, message)

    cosim("no-body", r"cosim.json:1:\d+ \(/pairs/0\): no body of .*model.json has the name 'bal'; did you mean 'ball'\?", pairs=[{"body": "bal", "boundary": "ball"}])
    cosim("no-boundary", r"tool 'bal': no boundary of the case has this name 'bal'; did you mean 'ball'\?",
          pairs=[{"body": "ball", "boundary": "bal"}])
    cosim("no-pairs", r"\(/pairs\): pairs must list at least one body and boundary, got none", pairs=[])
    cosim("twice", r"\(/pairs/1\): two pairs have the same body or boundary", pairs=[{"body": "ball"}, {"body": "ball", "boundary": "wall"}])
    cosim("substeps", r"\(/substeps\): substeps must be positive, got 0", substeps=0)
    cosim("key", r"unknown key \"substep\"; did you mean 'substeps'\?", substep=2)

    other = copy.deepcopy(CUP)
    other["boundaries"][2]["r"] = [0, 0, 0.03]
    cosim("place", r"\(/pairs/0\): boundary 'ball' is at \(0, 0, 0.03\) m in the case, but body 'ball' starts with it at \(0.0007, 0.0003, 0.0225\) m",
          case=other)
    # squares of such a place overflow
    cosim("far", r"\(/pairs/0\): boundary 'ball' is at", pairs=[{"body": "ball", "boundary": "ball", "r": [1e155, 0, 0]}])
    other = copy.deepcopy(CUP)
    other["boundaries"][2].update(mass=0.5, free=[True] * 3)
    cosim("mass", r"\(/pairs/0\): boundary 'ball' has the mass 0.5 kg, body 'ball' has 0.003 kg", case=other)
    runs.files("unknown", dict(COSIM, case="other.json"))
    for transport in "in-process", "pipe":
        process = runs.start("unknown", "--output", "unknown/out", "--quiet", "--transport", transport)
        _, err = process.communicate()
        expect(process.returncode in (3, 5) and "unknown/other.json" in err, f"a missing case: {process.returncode} {err}")
        expect(not (runs.folder / "unknown/out").exists(), "no file is written before an error")
    other = copy.deepcopy(CUP)
    other["boundaries"][2]["v"] = ["t", 0, 0]
    cosim("motion", r"tool 'ball': must have no formulas", case=other)


def check(runs):
    """hilda check: the steps, the stability limit of a body on its contacts, and what does not fit"""
    def checked(name, *arguments, code=0, **changes):
        process = subprocess.run([runs.hilda, "check", f"{name}/cosim.json", *arguments], cwd=runs.folder, text=True,
                                 capture_output=True, check=False)
        expect(process.returncode == code, f"check of {name}: ended with {process.returncode}: {process.stderr}")
        return process.stdout if code == 0 else process.stderr

    # Linear springs with k_n = 2000 N/m: one contact, and three of a ball that touches all grains of the seat
    steps = dict(COSIM, substeps=10)
    runs.files("check", steps, SEAT, struck())
    report = json.loads(checked("check", "--json"))
    pair = report["pairs"][0]
    close = lambda a, b: abs(a - b) <= 1e-6 * abs(b)
    expect(close(report["step"], 10 * SEAT["step"]) and close(pair["effective_mass"], M), f"{report}")
    expect(close(pair["single_contact_stiffness"], 2e3) and close(pair["stable_contacts"], 4 * M / (2e3 * report["step"] ** 2)), f"{pair}")
    expect(pair["contact_stiffness"] == 0 and pair["stable_step"] is None, f"{pair}")
    text = checked("check")
    expect("boundary 'ball', mass 0.003 kg" in text and "no contacts at the start" in text and "1000 exchanges" in text, text)
    limit = 2 * math.sqrt(M / 2e3) / SEAT["step"]
    runs.files("below", dict(COSIM, substeps=math.floor(limit)), SEAT, struck())
    checked("below")
    runs.files("above", dict(COSIM, substeps=math.ceil(limit)), SEAT, struck())
    too_large = (r"cosim.json:1:\d+ \(/pairs/0\): the step H = 0.00245 s of the mechanism "
                 r"must be at most 0.00245 s, .* one contact with an overlap of 0.1 %")
    expect(re.search(too_large, checked("above", code=3)), checked("above", code=3))
    runs.refused("above", 3, too_large)
    pressed, case = struck(), copy.deepcopy(SEAT)
    pressed["bodies"][0]["r"][2] -= 2e-5
    case["boundaries"][0]["r"] = pressed["bodies"][0]["r"]
    runs.files("pressed", steps, case, pressed)
    pair = json.loads(checked("pressed", "--json"))["pairs"][0]
    expect(close(pair["contact_stiffness"], 6e3) and close(pair["stable_step"], 2 * math.sqrt(M / 6e3)), f"{pair}")
    runs.files("stiff", dict(COSIM, substeps=math.floor(0.9 * limit)), case, pressed)
    runs.refused("stiff", 3, r"must be at most 0.00141 s, the stability limit of body 'ball' on its contacts at the start with 6e\+03 N/m")
    heavier = dict(MODEL, gravity=[0, 0, -1.62])
    runs.files("moon", COSIM, CUP, heavier)
    process = subprocess.run([runs.hilda, "check", "moon/cosim.json", "--quiet"], cwd=runs.folder, text=True, capture_output=True,
                             check=True)
    other_gravity = "gravity of the model is (0, 0, -1.62) m/s², that of the case is (0, 0, -9.81) m/s²"
    expect(process.stdout == "" and other_gravity in process.stderr, process.stderr)
    expect("valid for models only" in checked("moon", "--fix-initial", code=2), "options of models")
    # a start that violates a constraint writes no file
    model = copy.deepcopy(MODEL)
    model["constraints"] = [{"name": "rod", "type": "distance", "body_i": "ground", "body_j": "ball", "s_bar_p_i": [0, 0, 1],
                             "s_bar_q_j": [0, 0, 0],
                             "length": 0.5}]
    runs.files("violated", COSIM, CUP, model)
    err = runs.finish("violated", "--output", "violated/out", code=3)
    expect("rod" in err, err)
    expect(not (runs.folder / "violated/out/grains").exists(), "no file is written before an error of the start")


def schema(runs):
    """The schema accepts the files of this test and of the examples, and rejects what the program rejects"""
    root = pathlib.Path(__file__).resolve().parents[3]
    validator = jsonschema.Draft202012Validator(json.loads((root / "run/cosim/cosim.schema.json").read_text()))
    examples = list((root / "examples/cosim").glob("*/*.json"))
    files = [json.loads(file.read_text()) for file in examples]
    good = [file for file in files if "hilda_cosim" in file] + [COSIM, dict(COSIM, interval=0.1, integrator="rA-half-1-kick")]
    expect(len(good) > 2, "there are examples")
    for file in good:
        expect(not list(validator.iter_errors(file)), f"{file}: {list(validator.iter_errors(file))}")
    for change in ({"substeps": 0}, {"substeps": 1.5}, {"end": 0}, {"interval": -1}, {"pairs": []},
                   {"pairs": [{"boundary": "ball"}]}, {"step": 1e-3},
                   {"pairs": [{"body": "ball", "r": [0, 0]}]}, {"integrator": "rA-half-2"}, {"hilda_cosim": 2}, {"model": 1}):
        file = dict(COSIM, **change)
        expect(list(validator.iter_errors(file)), f"the schema rejects {change}")
        runs.files("schema", file)
        runs.refused("schema", 3, r"cosim.json:1:\d+")


def example(runs):
    """The pendulum of the example strikes the bed, and loses energy there"""
    folder = pathlib.Path(__file__).resolve().parents[3] / "examples/cosim/strike"
    process = subprocess.run([runs.hilda, "cosim", "strike.json", "--end", "0.25", "--output", runs.folder / "strike"], cwd=folder,
                             text=True, capture_output=True, check=False)
    expect(process.returncode == 0 and "warning" not in process.stderr, f"the example: {process.stderr}")
    rows = runs.table("strike/tools.csv")
    begin = next(row["t"] for row in rows if row["ball.Fx"] != 0)
# The impulse of the bed; the largest row depends on single collisions.
    impulse = 1e-3 * sum(row["ball.Fx"] for row in rows)
    expect(0.18 < begin < 0.229 and 0.019 < abs(impulse) < 0.028, f"it strikes the bed at {begin} s, impulse {impulse} N s")
    work = sum(row["ball.power"] for row in rows) * 1e-3
    expect(-0.058 < work < -0.01, f"the bed takes energy from the ball: {work} J")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], sys.argv[2], folder)
        errors(runs)
        check(runs)
        schema(runs)
        example(runs)
        difference = ball_is_a_tool(runs)
        momentum(runs)
        orders(runs)
        one_result(runs)
        ranks(runs)
    print(f"co-simulation: the ball differs from a tool by {difference:.2g} m; momentum, orders, one result, errors")


if __name__ == "__main__":
    main()
