#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What hilda-granular leaves is one set of bytes, however often it is killed, with any threads and back end.

    persistence_test.py WHAT PROGRAM [PROGRAM]      WHAT is kills, ends or threads; a second PROGRAM has another back end
"""
import hashlib
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

# Grains of many sizes in a cup that shakes, under a lid that lies on them, with all that has a history.
CASE = {
    "hilda_case": 1, "name": "cup",
    "domain": {"low": [-0.002, -0.002, -0.002], "high": [0.022, 0.022, 0.08]},
    "step": 5e-6, "end": 0.2, "every": 1e-2, "frames_every": 1.5e-2, "checkpoint_every": 1e-3, "orientation": True,
    "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24},
                  {"name": "steel", "density": 7800, "E": 2e8, "nu": 0.3}],
    "laws": [{"between": ["glass", "glass"], "restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"},
              "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}, "spin": {"law": "torsional-spring"}},
             {"between": ["glass", "steel"], "restitution": 0.5, "mu": 0.4, "tangential": {"law": "mindlin"},
              "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}}],
    "boundaries": [{"name": "floor", "type": "plane", "normal": [0, 0, 1], "r": [0, 0, "1e-4*sin(2*pi*40*t)"], "material": "steel"},
                   {"name": "wall", "type": "cylinder", "r": [0.01, 0.01, 0], "axis": [0, 0, 1], "radius": 0.01,
                    "inside": True, "omega": [0, 0, "5*t"], "material": "steel"},
                   {"name": "lid", "type": "plane", "normal": [0, 0, -1], "r": [0, 0, 0.04], "mass": 2e-3, "F": [0, 0, "-0.1*t"],
                    "free": [False, False, True], "material": "steel"}],
    "fill": [{"type": "lattice", "low": [0.003, 0.003, 0], "high": [0.017, 0.017, 0.03], "radius": 1e-3,
              "least_radius": 6e-4, "spacing": 1.02, "jitter": 1, "random_v": 0.2, "material": "glass"}]}


class Runs:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)
        self.environment = dict(os.environ, OMP_WAIT_POLICY="passive")

    def case(self, name, **changes):
        (self.folder / f"{name}.json").write_text(json.dumps(dict(CASE, **changes)))
        return name

    def start(self, name, *arguments, program=None):
        threads = () if "--threads" in arguments else ("--threads", "1")
        return subprocess.Popen([program or self.program, f"{name}.json", *threads, *arguments], cwd=self.folder,
                                env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def finish(self, name, *arguments, code=0, **options):
        process = self.start(name, *arguments, **options)
        _, err = process.communicate()
        if process.returncode != code:
            sys.exit(f"{' '.join(process.args)}: ended with {process.returncode}, not {code}: {err}")
        return err

    def sha(self, output):
        """One for all that does not tell of the clock"""
        out = self.folder / output
        files = [out / name for name in ("particles.csv", "contacts.csv", "run.csv")]
        files += sorted((out / "vtk").iterdir())
        whole = hashlib.sha256()
        for file in files:
            whole.update(file.name.encode() + b"\0" + file.read_bytes())
        summary = self.summary(output)
        whole.update(json.dumps({key: summary[key] for key in summary if key not in ("timing", "provenance")}).encode())
        return whole.hexdigest()

    def summary(self, output):
        return json.loads((self.folder / output / "summary.json").read_text())

    def remove(self, output):
        shutil.rmtree(self.folder / output, ignore_errors=True)


def expect(condition, what):
    if not condition:
        sys.exit(f"not so: {what}")


def kills(runs, wanted=20, legs=20):
    """Killed at random moments, a leg apart on average, and resumed until it is done"""
    case = runs.case("cup")
    begin = time.monotonic()
    runs.finish(case, "--output", "whole")
    seconds = time.monotonic() - begin
    whole = runs.sha("whole")
    contacts = (runs.folder / "whole" / "contacts.csv").read_text().count("\n")
    expect(contacts > 300, f"the grains touch, {contacts} times")

    draw = random.Random(7)
    resume = ("--output", "cut", "--checkpoint", "0.02", "--resume")
    done = kept = runs_to_the_end = 0
    while done < wanted:
        process = runs.start(case, *resume)
        try:
            process.communicate(timeout=draw.uniform(0, 2 * seconds / legs))
            expect(process.returncode == 0, "a run that was not killed ends well")
            expect(runs.sha("cut") == whole, "the run that was killed leaves what the whole one does")
            runs.remove("cut")
            runs_to_the_end += 1
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.communicate()
            done += 1
            kept += (runs.folder / "cut" / "checkpoint").exists()
    expect(kept > 0, "some were killed with a checkpoint there")
    runs.finish(case, *resume)
    expect(runs.sha("cut") == whole, "the run that was killed leaves what the whole one does")
    left = [file.name for file in (runs.folder / "cut").iterdir()]
    expect(not any(name.startswith("checkpoint") for name in left), f"no checkpoint is left of a run that is done: {left}")
    expect("is done already" in runs.finish(case, *resume), "there is no more to do")
    print(f"{done} kills, {kept} with a checkpoint, {1 + runs_to_the_end} runs to the end; {seconds:.2f} s uncut; {whole}")


def ends(runs):
    """Signals, damaged and foreign checkpoints, and a grain that is lost"""
    case = runs.case("cup", end=0.05)
    runs.finish(case, "--output", "whole")
    whole = runs.sha("whole")
    out = runs.folder / "cut"

    def interrupt(which):
        process = runs.start(case, "--output", "cut", "--checkpoint", "0.01", "--force")
        while not (out / "checkpoint.1").exists():
            expect(process.poll() is None, "two checkpoints are kept while it runs")
            time.sleep(0.001)
        process.send_signal(which)
        _, err = process.communicate()
        expect(process.returncode == 128 + which, f"signal {which} ends with its code, not {process.returncode}")
        expect("--resume goes on" in err, f"says how to go on: {err}")
        summary = runs.summary("cut")
        expect(summary["status"] == "interrupted" and summary["exit_code"] == 128 + which, f"summary of an interrupted run: {summary}")

    for which in (signal.SIGINT, signal.SIGTERM):
        interrupt(which)
        runs.finish(case, "--output", "cut", "--resume")
        expect(runs.sha("cut") == whole, "a run that was interrupted leaves what the whole one does")
        runs.remove("cut")

    interrupt(signal.SIGINT)
    newest = (out / "checkpoint").read_bytes()
    other = runs.case("other", end=0.06)
    for options in ((other,), (case, "--end", "0.06"), (case, "--set", "/laws/0/mu=0.2"), (case, "--seed", "3"), (case, "--step", "4e-6")):
        err = runs.finish(*options, "--output", "cut", "--resume", code=5)
        expect("cut/case.json: is another case, or this one with other options" in err, f"a foreign one is refused: {err}")
    mine = (out / "case.json").read_text()
    (out / "case.json").write_text((runs.folder / "other.json").read_text())
    err = runs.finish(other, "--output", "cut", "--resume", code=5)
    expect("cut/checkpoint: the checkpoint belongs to another run" in err, f"also where case.json is not: {err}")
    (out / "case.json").write_text(mine)
    (out / "checkpoint").write_bytes(newest[:len(newest) // 2] + bytes([newest[len(newest) // 2] ^ 1]) + newest[len(newest) // 2 + 1:])
    err = runs.finish(case, "--output", "cut", "--resume")
    expect("hilda: warning: cut/checkpoint: the checkpoint is damaged" in err and "the one before" in err, err)
    expect(runs.sha("cut") == whole, "the checkpoint before the last does as well")

    runs.remove("cut")
    interrupt(signal.SIGINT)
    for name in ("checkpoint", "checkpoint.1"):
        (out / name).write_bytes(b"HILDAGRN" + b"\0" * 100)
    expect("cut/checkpoint: the checkpoint is damaged" in runs.finish(case, "--output", "cut", "--resume", code=5),
           "damaged ones are refused")

    # a signal between two times at which a checkpoint may be written stops the run at once all the same
    rare = runs.case("rare", end=0.08, checkpoint_every=0.03, every=0.01, frames_every=0.01)
    begin = time.monotonic()
    runs.finish(rare, "--output", "rare")
    seconds = time.monotonic() - begin
    rare_sha = runs.sha("rare")
    slowest = between = 0
    for which, frame in ((signal.SIGINT, 1), (signal.SIGTERM, 2), (signal.SIGINT, 4), (signal.SIGTERM, 5)):
        process = runs.start(rare, "--output", "cut2", "--force")
        while not (runs.folder / "cut2" / "vtk" / f"particles-{frame:06}.vtp").exists():
            expect(process.poll() is None, "it is not done before the signal")
            time.sleep(0.001)
        sent = time.monotonic()
        process.send_signal(which)
        _, err = process.communicate()
        slowest = max(slowest, time.monotonic() - sent)
        expect(process.returncode == 128 + which and "--resume goes on" in err, f"{process.returncode}: {err}")
        counters = runs.summary("cut2")["counters"]
        expect(round(counters["t_checkpoint"] / 0.03, 9) in (0, 1, 2), f"the case says when: {counters}")
        between += counters["t"] > counters["t_checkpoint"] + 0.004
        runs.finish(rare, "--output", "cut2", "--resume")
        expect(runs.sha("cut2") == rare_sha, "what a run that was stopped between leaves is what the whole one does")
        resumed = runs.summary("cut2")["provenance"].get("resumed_at_step", 0)
        expect(resumed == round(counters["t_checkpoint"] / 5e-6), f"goes on from there: {resumed}, {counters}")
        runs.remove("cut2")
    expect(between > 0, "some were stopped in the middle of an interval")
    expect(slowest < 0.5 * seconds + 2, f"stops at once: {slowest:.2f} s of {seconds:.2f} s")

    # without a floor they fall out of the domain
    lost = runs.case("lost", boundaries=CASE["boundaries"][1:], end=0.1)
    err = runs.finish(lost, "--output", "lost", "--checkpoint", "1e-4", code=4)
    expect("error[particle_lost]: particle " in err and "t = " in err and "velocity" in err, err)
    summary = runs.summary("lost")
    expect(summary["status"] == "particle_lost" and summary["counters"]["t"] > 0.01, f"says where it ended: {summary}")
    expect(runs.finish(lost, "--output", "lost", "--resume", code=4) == err, "the last checkpoint stays, and can be loaded")
    lost = runs.case("lost2", boundaries=CASE["boundaries"][1:], end=0.1, checkpoint_every=5e-6)
    runs.finish(lost, "--output", "lost2", code=4)
    expect(runs.summary("lost2")["status"] == "particle_lost" and (runs.folder / "lost2" / "contacts.csv").exists(),
           "also where neighbours are looked for anew in every step")

    # frames that a part of the run did not write are not told
    cut = runs.start("rare", "--output", "some", "--no-vtk", "--checkpoint", "1e-4")
    while not (runs.folder / "some" / "checkpoint").exists():
        expect(cut.poll() is None, "it is not done before the signal")
        time.sleep(0.001)
    cut.send_signal(signal.SIGINT)
    cut.communicate()
    runs.finish("rare", "--output", "some", "--resume")
    told = re.findall('file="(.*?)"', (runs.folder / "some" / "vtk" / "run.pvd").read_text())
    expect(told and all((runs.folder / "some" / "vtk" / name).exists() for name in told), f"frames that are there: {told}")
    print(f"both signals, fallback, refusals and a lost grain; at most {1e3 * slowest:.0f} ms to stop between; {whole}")


def threads(runs, others):
    """Enough grains for loops to be shared"""
    cup = dict(CASE["boundaries"][1], r=[0.02, 0.02, 0], radius=0.03)
    case = runs.case("heap", end=0.015, every=5e-3, checkpoint_every=5e-3, boundaries=[CASE["boundaries"][0], cup, CASE["boundaries"][2]],
                     domain={"low": [-0.012, -0.012, -0.002], "high": [0.052, 0.052, 0.08]},
                     fill=[dict(CASE["fill"][0], low=[0, 0, 0], high=[0.04, 0.04, 0.02])])
    one = None
    for program in (None, *others):
        for count in (1, 2, 3, 4, 8):
            runs.finish(case, "--output", "out", "--force", "--threads", str(count), program=program)
            sha = runs.sha("out")
            one = one or sha
            expect(sha == one, f"{count} threads of {program or runs.program} give the same")
    gpu = runs.start(case, "--output", "out", "--force", "--device", "cuda")
    _, err = gpu.communicate()
    expect(gpu.returncode in (0, 7), f"a GPU runs it or is not there: {err}")
    if gpu.returncode == 0:
        expect(runs.sha("out") == one, "a GPU gives the same")
    print(f"1, 2, 3, 4, 8 threads, {1 + len(others)} back ends{', a GPU' if gpu.returncode == 0 else ''}; {one}")


def main():
    what, program, *others = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(program, folder)
        if what == "kills":
            kills(runs)
        elif what == "ends":
            ends(runs)
        else:
            threads(runs, others)


if __name__ == "__main__":
    main()
