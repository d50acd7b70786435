#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A run by mpirun has the bytes of a run on one process, for any number of processes, threads and interruptions.

    distributed_test.py PROGRAM
"""
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import one_hash_test
from case_runs import Runs, expect

STEP, STEPS = one_hash_test.STEP, 240
SMALL = 3e-4  # a radius for which the cells of the grains are used [m]


def without_large(case):
    """The case with particles of similar sizes: larger ones need wider ghosts"""
    return dict(case, end=STEP * STEPS, particles=[dict(p, radius=min(SMALL, p["radius"])) for p in case["particles"]],
                fill=[f for f in case["fill"] if f["radius"] < SMALL])


# Moving planes, a cylinder, a plate of triangles, a tool, attached and fixed particles, an applied force, insertion and outflow
DAM = without_large(one_hash_test.DAM)
# Replicas in a periodic domain, with the accelerations of the previous step, attached particles and moving bodies
REPLICAS = without_large(one_hash_test.REPLICAS)
CASES = {"dam": DAM, "replicas": REPLICAS, "verlet": dict(DAM, integrator="velocity-verlet"),
         "euler": dict(REPLICAS, integrator="symplectic-euler")}
CLUMP = {"clumps": [{"name": "pair", "material": "glass", "spheres": [{"r": [0, 0, 0], "radius": 2e-4}, {"r": [2e-4, 0, 0], "radius": 2e-4}]}]}


class Processes(Runs):
    """Runs by mpirun"""
    def __init__(self, program, folder):
        super().__init__(program, folder)
        self.environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")

    def mpirun(self, count, name, *arguments):
        command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(count), self.program, f"{name}.json", *arguments]
        return subprocess.Popen(command, cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, start_new_session=True)

    def on(self, count, name, *arguments, code=0):
        """Standard error of a run on this number of processes"""
        process = self.mpirun(count, name, *arguments)
        _, err = process.communicate(timeout=600)
        expect(process.returncode == code, f"{name} on {count}: ended with {process.returncode}, not {code}: {err}")
        return err

    def refused_on(self, count, name, code, message, *arguments):
        err = self.on(count, name, "--output", "refused", *arguments, code=code)
        lines = [line for line in err.split("\n") if line.startswith("hilda: error")]
        expect(len(lines) == 1 and re.search(message, lines[0]), f"{message} in one line: {err}")
        expect(not (self.folder / "refused").exists(), f"{message}: no files are written")


def sha(runs, output):
    return one_hash_test.sha(runs, output) if (runs.folder / output / "replicas.csv").exists() else runs.sha(output)


def children(process):
    """Ids of the processes that mpirun has started"""
    found = []
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat", encoding="ascii") as file:
                    fields = file.read().rsplit(")", 1)[1].split()
                if int(fields[1]) == process.pid:
                    found.append(int(entry))
            except OSError:
                pass
    return sorted(found)


def is_running(process):
    try:
        with open(f"/proc/{process}/stat", encoding="ascii") as file:
            return file.read().rsplit(")", 1)[1].split()[0] not in ("Z", "X")
    except OSError:
        return False


def same_bytes(runs, counts):
    options, end = ("--replica-rows", "--quiet"), ("--end", f"{STEP * STEPS:.12g}")
    for name, case in CASES.items():
        runs.case(name, **case)
        runs.finish(name, "--output", "one", *options, *end)
        whole = sha(runs, "one")
        for count in counts if name == "dam" else ():
            runs.on(count, name, "--output", "several", "--contacts", "--threads", "2" if count == 2 else "1", *options, *end)
            expect(sha(runs, "several") == whole, f"{name}: the bytes of {count} processes")
            runs.remove("several")
        # interrupted on one number of processes, and continued on others
        runs.on(2, name, "--output", "parts", "--contacts", *options, "--end", f"{STEP * 90:.12g}")
        runs.on(3, name, "--output", "parts", "--contacts", *options, "--resume", "--end", f"{STEP * 150:.12g}")
        runs.finish(name, "--output", "parts", *options, "--resume", *end)
        expect(sha(runs, "parts") == whole, f"{name}: the bytes after continuations on 3 processes and on one")
        for output in ("one", "parts"):
            runs.remove(output)


# Many pieces of particles in contact. All cases have more particles than the first process collects as a whole, up to 1024 for
# each process, with 2 or 3 processes.
MANY = {"hilda_case": 1, "domain": {"low": [-0.001, -0.001, -0.001], "high": [0.021, 0.021, 0.026]}, "step": 2e-6, "interval": 1e-4,
        "orientation": True, "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
        "laws": [{"restitution": 0.9, "mu": 0.3, "tangential": {"law": "mindlin"}, "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}}],
        "boundaries": [{"name": "box", "type": "box", "low": [0, 0, 0], "high": [0.02, 0.02, 0.025], "open": ["+z"]}],
        "fill": [{"type": "hcp", "low": [0, 0, 0], "high": [0.02, 0.02, 0.015], "radius": 3.6e-4, "spacing": 1, "random_v": 0.3}]}
# Fewer particles than processes
FEW = dict(MANY, fill=[], particles=[{"r": [0.002 * k, 0.002, 4e-4], "v": [0.5, 0, -0.1], "radius": 3.6e-4, "material": "glass"}
                                     for k in (1, 2)])


def pieces(runs):
    """Frames, tables and checkpoints of particles that are collected in pieces, and of processes without particles"""
    step = MANY["step"]
    for name, case, parts in (("many", MANY, (60, 100, 140)), ("few", FEW, (500, 900, 1300))):
        half, next_part, end = (("--end", f"{n * step:.12g}") for n in parts)
        runs.case(name, **dict(case, end=parts[-1] * step))
        runs.finish(name, "--output", "one", "--quiet", "--contacts", *end)
        for count in (2, 4):
            runs.on(count, name, "--output", "several", "--quiet", "--contacts", *end)
            expect(runs.sha("several") == runs.sha("one"), f"{name}: the bytes of {count} processes")
            runs.remove("several")
        runs.on(2, name, "--output", "parts", "--quiet", "--contacts", *half)
        runs.on(3, name, "--output", "parts", "--quiet", "--contacts", "--resume", *next_part)
        runs.finish(name, "--output", "parts", "--quiet", "--contacts", "--resume", *end)
        expect(runs.sha("parts") == runs.sha("one"), f"{name}: the bytes after continuations on 3 processes and on one")
        for output in ("one", "parts"):
            runs.remove(output)


def lost_process(runs):
    """A process that is killed ends the others, and the run continues from the last checkpoint."""
    name = runs.case("killed", **dict(DAM, end=STEP * 4000))
    # Only the checkpoints decide.
    for victim in (1, 0):
        process = runs.mpirun(3, name, "--output", "killed", "--quiet", "--checkpoint", "0.3", *(("--resume",) if victim == 0 else ()))
        file = runs.folder / "killed" / "checkpoint"
        before = file.stat().st_mtime_ns if file.exists() else 0
        deadline = time.time() + 300
        while not (file.exists() and file.stat().st_mtime_ns != before) and process.poll() is None and time.time() < deadline:
            time.sleep(1e-2)
        expect(process.poll() is None, f"the run is interrupted: {process.returncode}")
        ranks = children(process)
        expect(len(ranks) == 3, f"three processes: {ranks}")
        os.kill(ranks[victim], signal.SIGKILL)
        _, err = process.communicate(timeout=60)
        expect(process.returncode != 0, "mpirun reports the process that was killed")
        expect("another process of the run has disappeared" in err, f"the others say why they end: {err}")
        time.sleep(0.2)
        expect(not any(is_running(rank) for rank in ranks), "all processes have ended")
    end = f"{STEP * 400:.12g}"
    short = runs.case("short", **dict(DAM, end=STEP * 4000))
    runs.finish(short, "--output", "whole", "--quiet", "--end", end)
    process = runs.mpirun(3, short, "--output", "resumed", "--quiet", "--contacts", "--end", end, "--checkpoint", "0.01")
    file = runs.folder / "resumed" / "checkpoint"
    while not file.exists() and process.poll() is None:
        time.sleep(1e-3)
    if process.poll() is None:
        os.kill(children(process)[2], signal.SIGKILL)
    process.communicate(timeout=60)
    if (runs.folder / "resumed" / "summary.json").exists():
        print("the run was complete before it was killed")
    else:
        runs.on(2, short, "--output", "resumed", "--quiet", "--contacts", "--end", end, "--resume")
    expect(runs.sha("resumed") == runs.sha("whole"), "the bytes after a process was killed")


def refusals(runs):
    runs.case("dam", **DAM)
    tiny = {key: DAM[key] for key in DAM if key not in ("loads", "fields", "insert", "contacts")}
    runs.case("tiny", **dict(tiny, domain={"low": [0, 0, 0], "high": [8e-4, 8e-4, 2e-3]}, fill=[], boundaries=[],
                             particles=[{"r": [4e-4, 4e-4, 6e-4], "radius": 2e-4, "material": "glass"}]))
    runs.refused_on(4, "tiny", 3, "has [123] blocks of 2 x 2 x 2 cells, .*got 4")
    runs.case("large", **dict(one_hash_test.DAM))
    runs.refused_on(2, "large", 3, "larger than the cells")
    runs.case("clumps", **dict(DAM, **CLUMP, insert=[], particles=[{"clump": "pair", "r": [0.006, 0.004, 0.012]}]))
    runs.refused_on(2, "clumps", 3, "/clumps")
    runs.refused_on(2, "dam", 2, "--device cuda", "--device", "cuda")
    # two runs of their own, each with its output
    shell = f"{runs.program} dam.json --output own$OMPI_COMM_WORLD_RANK"
    ended = subprocess.run(["mpirun", "--oversubscribe", "--bind-to", "none", "-n", "2", "sh", "-c", shell], cwd=runs.folder,
                           env=runs.environment, capture_output=True, text=True, timeout=120, check=False)
    lines = [line for line in ended.stderr.split("\n") if line.startswith("hilda: error")]
    expect(ended.returncode == 2 and len(lines) == 1 and "different arguments" in lines[0], f"different arguments: {ended}")
    expect(not (runs.folder / "own0").exists(), "different arguments: no files are written")


def main():
    if shutil.which("mpirun") is None:
        print("skipped: there is no mpirun")
        return
    with tempfile.TemporaryDirectory() as folder:
        runs = Processes(os.path.abspath(sys.argv[1]), folder)
        check = sys.argv[2:] or ("refusals", "bytes", "pieces", "lost")
        if "refusals" in check:
            refusals(runs)
        if "bytes" in check:
            same_bytes(runs, (2, 3, 4, 8))
        if "pieces" in check:
            pieces(runs)
        if "lost" in check:
            lost_process(runs)
    print("ok")


if __name__ == "__main__":
    main()
