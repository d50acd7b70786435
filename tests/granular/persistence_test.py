#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of hilda-granular are bitwise identical for interrupted and uninterrupted runs, any threads, any back end.

    persistence_test.py WHAT PROGRAM [PROGRAM]

WHAT is kills, ends, longer, bodies or threads; a second PROGRAM has another back end.
"""
import json
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from case_runs import ATTACHED, CASE, Runs, expect


def kills(runs, wanted=20, legs=20):
    """Kills a run at random instants, wall time / legs apart on average, and resumes it until it is complete"""
    case = runs.case("cup", **ATTACHED)
    begin = time.monotonic()
    runs.finish(case, "--output", "whole")
    seconds = time.monotonic() - begin
    whole = runs.sha("whole")
    contacts = (runs.folder / "whole" / "contacts.csv").read_text().count("\n")
    expect(contacts > 300, f"there are more than 300 contacts: {contacts}")

    draw = random.Random(7)
    resume = ("--output", "cut", "--checkpoint", "0.02", "--resume")
    done = with_checkpoint = runs_to_the_end = 0
    while done < wanted:
        process = runs.start(case, *resume)
        try:
            process.communicate(timeout=draw.uniform(0, 2 * seconds / legs))
            expect(process.returncode == 0, "a run that was not killed exits with 0")
            expect(runs.sha("cut") == whole, "the killed run and the uninterrupted run give the same files")
            runs.remove("cut")
            runs_to_the_end += 1
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.communicate()
            done += 1
            with_checkpoint += (runs.folder / "cut" / "checkpoint").exists()
    expect(with_checkpoint > 0, "some runs were killed after a checkpoint")
    runs.finish(case, *resume)
    expect(runs.sha("cut") == whole, "the killed run and the uninterrupted run give the same files")
    left = [file.name for file in (runs.folder / "cut").iterdir()]
    left = [name for name in left if name.startswith("checkpoint")]
    expect(left == ["checkpoint.end"], f"a complete run leaves the checkpoint of its end: {left}")
    expect("the run is complete already" in runs.finish(case, *resume), "a complete run is not resumed")
    print(f"{done} kills, {with_checkpoint} with a checkpoint, {1 + runs_to_the_end} runs to the end; {seconds:.2f} s uncut; {whole}")


def ends(runs):
    """Signals, damaged checkpoints, checkpoints of other cases, and a lost particle"""
    case = runs.case("cup", end=0.05)
    runs.finish(case, "--output", "whole")
    whole = runs.sha("whole")
    out = runs.folder / "cut"

    def interrupt(which):
        process = runs.start(case, "--output", "cut", "--checkpoint", "0.01", "--force")
        while not (out / "checkpoint.1").exists():
            expect(process.poll() is None, "a run in progress has two checkpoints")
            time.sleep(0.001)
        process.send_signal(which)
        _, err = process.communicate()
        expect(process.returncode == 128 + which, f"signal {which} ends with its code, not {process.returncode}")
        expect("--resume continues" in err, f"the message states how to continue: {err}")
        summary = runs.summary("cut")
        expect(summary["status"] == "interrupted" and summary["exit_code"] == 128 + which, f"summary of an interrupted run: {summary}")

    for which in (signal.SIGINT, signal.SIGTERM):
        interrupt(which)
        runs.finish(case, "--output", "cut", "--resume")
        expect(runs.sha("cut") == whole, "the interrupted run and the uninterrupted run give the same files")
        runs.remove("cut")

    interrupt(signal.SIGINT)
    newest = (out / "checkpoint").read_bytes()
    other = runs.case("other", end=0.06, skin=0.2)
    for options in ((other,), (case, "--set", "/skin=0.2"), (case, "--seed", "3"), (case, "--step", "4e-6")):
        err = runs.finish(*options, "--output", "cut", "--resume", code=5)
        expect("cut/case.json: is another case, or this case with other options" in err, f"the checkpoint of another case is rejected: {err}")
    mine = (out / "case.json").read_text()
    (out / "case.json").write_text((runs.folder / "other.json").read_text())
    edited = runs.case("edited", end=0.05, skin=0.3)
    (out / "case.json").write_text((runs.folder / "edited.json").read_text())
    err = runs.finish(edited, "--output", "cut", "--resume", code=5)
    expect("cut/checkpoint: the checkpoint belongs to another run" in err, f"also if case.json is replaced: {err}")
    (out / "case.json").write_text(mine)
    (out / "checkpoint").write_bytes(newest[:len(newest) // 2] + bytes([newest[len(newest) // 2] ^ 1]) + newest[len(newest) // 2 + 1:])
    err = runs.finish(case, "--output", "cut", "--resume")
    expect("hilda: warning: cut/checkpoint: the checkpoint is damaged" in err and "the one before" in err, err)
    expect(runs.sha("cut") == whole, "the previous checkpoint gives the same files")

    runs.remove("cut")
    interrupt(signal.SIGINT)
    for name in ("checkpoint", "checkpoint.1"):
        (out / name).write_bytes(b"HILDAGRN" + b"\0" * 100)
    expect("cut/checkpoint: the checkpoint is damaged" in runs.finish(case, "--output", "cut", "--resume", code=5),
           "damaged checkpoints are rejected")

    # another mesh file
    plate = "v 0 0 0.041\nv 0.02 0 0.041\nv 0.01 {} 0.041\nf 1 3 2\n"
    (runs.folder / "plate.obj").write_text(plate.format(0.02))
    meshed = runs.case("meshed", end=0.002,
                       boundaries=CASE["boundaries"] + [{"name": "roof", "type": "mesh", "file": "plate.obj", "material": "steel"}])
    runs.finish(meshed, "--output", "meshed")
    (runs.folder / "plate.obj").write_text(plate.format(0.019))
    err = runs.finish(meshed, "--output", "meshed", "--resume", "--end", "0.003", code=5)
    expect("meshed/checkpoint.end: the triangles of the mesh 'roof' have changed since the checkpoint was written" in err, err)

    # a signal stops the run immediately, and the run continues from there
    rare = runs.case("rare", end=0.08, interval=0.01, frame_interval=0.01)
    begin = time.monotonic()
    runs.finish(rare, "--output", "rare")
    seconds = time.monotonic() - begin
    rare_sha = runs.sha("rare")
    slowest = 0
    for which, frame in ((signal.SIGINT, 1), (signal.SIGTERM, 2), (signal.SIGINT, 4), (signal.SIGTERM, 5)):
        process = runs.start(rare, "--output", "cut2", "--force")
        while not (runs.folder / "cut2" / "vtk" / f"particles-{frame:06}.vtp").exists():
            expect(process.poll() is None, "the run is in progress when the signal is sent")
            time.sleep(0.001)
        sent = time.monotonic()
        process.send_signal(which)
        _, err = process.communicate()
        slowest = max(slowest, time.monotonic() - sent)
        expect(process.returncode == 128 + which and "--resume continues" in err, f"{process.returncode}: {err}")
        counters = runs.summary("cut2")["counters"]
        runs.finish(rare, "--output", "cut2", "--resume")
        expect(runs.sha("cut2") == rare_sha, "a run stopped by a signal gives the same files")
        resumed = runs.summary("cut2")["provenance"].get("resumed_at_step", 0)
        expect(resumed == counters["steps"], f"the run continues from its last step: {resumed}, {counters}")
        runs.remove("cut2")
    expect(slowest < 0.5 * seconds + 2, f"the run stops immediately: {slowest:.2f} s of {seconds:.2f} s")

    # without a floor particles leave the domain
    lost = runs.case("lost", boundaries=CASE["boundaries"][1:], end=0.1)
    err = runs.finish(lost, "--output", "lost", "--checkpoint", "1e-4", code=4)
    expect("error[particle_lost]: particle " in err and "t = " in err and "velocity" in err, err)
    summary = runs.summary("lost")
    expect(summary["status"] == "particle_lost" and summary["counters"]["t"] > 0.01, f"the summary states the end: {summary}")
    expect(runs.finish(lost, "--output", "lost", "--resume", code=4) == err, "the last checkpoint remains and can be restored")

    # neither rows nor checkpoints cause a neighbour search
    searches = []
    for name, options in (("often", ("--interval", "1e-5", "--checkpoint", "1e-9")), ("seldom", ("--interval", "0.01"))):
        runs.finish(case, "--end", "0.01", "--output", name, *options)
        searches.append(runs.summary(name)["counters"]["rebuilds"])
    expect(searches[0] == searches[1] and 0 < searches[1] < 200, f"numbers of searches: {searches}")
    often, seldom = ((runs.folder / name / "particles.csv").read_bytes() for name in ("often", "seldom"))
    expect(often == seldom, "rows and checkpoints do not change the particles")
    expect("checkpoint_interval has no effect: a checkpoint can be written after every step"
           in runs.finish(case, "--end", "1e-4", "--set", "/checkpoint_interval=1e-3", "--output", "old"), "the old key is read")

    # frames that a part of the run did not write are not in the collection
    cut = runs.start("rare", "--output", "some", "--no-vtk", "--checkpoint", "1e-4")
    while not (runs.folder / "some" / "checkpoint").exists():
        expect(cut.poll() is None, "the run is in progress when the signal is sent")
        time.sleep(0.001)
    cut.send_signal(signal.SIGINT)
    cut.communicate()
    runs.finish("rare", "--output", "some", "--resume")
    listed = re.findall('file="(.*?)"', (runs.folder / "some" / "run.pvd").read_text())
    expect(listed and all((runs.folder / "some" / name).exists() for name in listed), f"the listed frames exist: {listed}")
    print(f"both signals, fallback, rejections and a lost particle; at most {1e3 * slowest:.0f} ms to stop; {whole}")


def longer(runs):
    """A complete or interrupted run continued to a later end gives the files of a run to that end"""
    def whole(case, end, *options):
        runs.finish(case, "--end", end, "--output", "whole", "--force", *options)
        files = {name: (runs.folder / "whole" / name).read_bytes() for name in ("case.json", "checkpoint.end")}
        sha = runs.sha("whole")
        runs.remove("whole")
        return sha, files

    def longer_run(case, end, *options, code=0):
        return runs.finish(case, "--end", end, "--output", "out", "--resume", *options, code=code)

    def same(files):
        return all((runs.folder / "out" / name).read_bytes() == files[name] for name in files)

    # 0.015 s is a multiple of the interval, 0.0153 s is not; the second step goes from one extension to the next
    case = runs.case("cup", **ATTACHED, frame_interval=2e-3, interval=1e-3)
    for first, options in (("0.015", ()), ("0.0153", ()), ("0.0153", ("--no-vtk",)), ("0.002", ("--threads", "2"))):
        runs.finish(case, "--end", first, "--output", "out", *options)
        for end in ("0.02", "0.0261"):
            sha, files = whole(case, end, *options)
            longer_run(case, end, *options)
            expect(runs.sha("out") == sha, f"a run to {first} s continued to {end} s {options} gives the same files")
            expect(same(files), f"{first} s to {end} s {options}: case.json and checkpoint.end are the same")
        runs.remove("out")

    # without intervals in the case, those of the first run remain
    bare = dict(CASE, **ATTACHED)
    for key in ("interval", "frame_interval"):
        del bare[key]
    (runs.folder / "bare.json").write_text(json.dumps(dict(bare, end=0.01)))
    runs.finish("bare", "--output", "out")
    longer_run("bare", "0.013")
    stated = runs.case("stated", **ATTACHED, end=0.01, interval=1e-5, frame_interval=1e-4)
    expect(runs.sha("out").split() and (runs.folder / "out" / "run.csv").read_text().count("\n") == 1302,
           "the interval of the rows is a thousandth of the first end")
    runs.finish(stated, "--end", "0.013", "--output", "whole")
    expect(runs.sha("out") == runs.sha("whole"), "the intervals of a continued run are those of its start")
    longer_run("bare", "0.014")
    runs.finish(stated, "--end", "0.014", "--output", "whole", "--resume")
    expect(runs.sha("out") == runs.sha("whole"), "also if it is continued again")
    for output in ("out", "whole"):
        runs.remove(output)

    # an extension that is killed or stopped, and an interrupted run with another end
    sha, _ = whole(case, "0.08")
    runs.finish(case, "--end", "0.01", "--output", "out")
    kills = 0
    while runs.interrupt(case, "out", 1 + kills, signal.SIGKILL, "--end", "0.08", "--resume", "--checkpoint", "0.01"):
        kills += 1
        expect(kills < 200, "the extension comes to its end")
    expect(kills > 0, "the extension is killed at least once")
    expect(runs.sha("out") == sha, f"an extension that was killed {kills} times gives the same files")
    runs.remove("out")
    process = runs.start(case, "--end", "0.1", "--output", "out", "--checkpoint", "1e-4")
    while not (runs.folder / "out" / "vtk" / "particles-000010.vtp").exists():
        expect(process.poll() is None, "the run is in progress when the signal is sent")
        time.sleep(0.001)
    process.send_signal(signal.SIGINT)
    process.communicate()
    checkpoint = runs.summary("out")["counters"]["t"]
    early = f"{checkpoint + 1e-4:.6g}"
    expect("--end must be after t = " in longer_run(case, "0.001", code=2), "an end before the checkpoint is refused")
    longer_run(case, early)
    sha, _ = whole(case, early)
    expect(runs.sha("out") == sha, f"an interrupted run ends at {early} s as well, without later frames")
    runs.remove("out")

    # what is refused
    runs.finish(case, "--end", "0.01", "--output", "out")
    before = runs.sha("out")
    expect("the run is complete already, with the end 0.01 s; --end with a later time extends it" in longer_run(case, "0.01"),
           "the end of the run")
    expect("--end must be after t = 0.01 s, which the run in out has reached, got 0.005" in longer_run(case, "0.005", code=2),
           "an earlier end")
    err = runs.finish(case, "--output", "out", "--resume")
    expect("the run is complete already, with the end 0.01 s" in err, f"options need not be repeated: {err}")
    err = longer_run(case, "0.02", "--set", "/skin=0.2", code=5)
    expect("is another case, or this case with other options; --force overwrites it" in err, f"another case: {err}")
    expect("--resume: " in err and "; /skin was missing and is 0.2 now; a run can change " in err, f"the entry that differs: {err}")
    end = runs.folder / "out" / "checkpoint.end"
    content = end.read_bytes()
    end.write_bytes(content[:1000])
    expect("out/checkpoint.end: the checkpoint is damaged" in longer_run(case, "0.02", code=5), "a damaged checkpoint.end")
    end.unlink()
    expect("has ended without checkpoint.end; --force starts it again" in longer_run(case, "0.02", code=2), "no checkpoint.end")
    (runs.folder / "out" / "case.json").write_text("{")
    expect("out/case.json:1:2" in longer_run(case, "0.02", code=3), "a damaged case.json")
    expect(runs.sha("out") == before, "a refused extension changes no file")
    print(f"ends at and between checkpoints, with and without frames; {kills} kills; {before}")


def bodies(runs):
    """A tool of several parts and finite surfaces: any number of threads, and a run that is killed and resumed"""
    part = {"material": "steel", "density": 3000, "part_of": "bell"}
    can = {"name": "can", "type": "cylinder", "r": [0.01, 0.01, 0], "axis": [0, 0, 1], "radius": 0.01, "length": 0.06, "inside": True,
           "open": ["+"], "omega": [0, 0, "5*t"], "material": "steel"}
    bell = [{"name": "left", "type": "sphere", "radius": 2e-3, "r": [0.007, 0.01, 0.036], **part},
            {"name": "bell", "type": "body", "from_parts": True, "omega": [0, 20, 0], "material": "steel"},
            {"name": "rod", "type": "cylinder", "axis": [1, 0, 0], "radius": 1e-3, "length": 6e-3, "r": [0.007, 0.01, 0.036], **part},
            {"name": "ring", "type": "torus", "axis": [1, 0, 0], "radius": 1e-3, "ring_radius": 2e-3, "r": [0.013, 0.01, 0.036], **part}]
    case = runs.case("bell", boundaries=[can, *bell], end=0.12)
    runs.finish(case, "--output", "whole")
    whole = runs.sha("whole")
    header, *rows = (line.split(",") for line in (runs.folder / "whole" / "run.csv").read_text().splitlines())
    last = dict(zip(header, map(float, rows[-1])))
    expect(any(float(row[header.index("ring_Fz")]) != 0 for row in rows), "grains load the parts")
    for of, names in (("bell", ("left", "rod", "ring")), ("can", ("can-",))):
        rest = last[f"{of}_Fz"] - sum(last[f"{name}_Fz"] for name in names)
        expect(of == "can" or abs(rest) < 1e-8, f"the load on {of} is that of its parts: {rest}")
    for count in (2, 3, 8):
        runs.finish(case, "--output", "out", "--force", "--threads", str(count))
        expect(runs.sha("out") == whole, f"{count} threads give the same files")
    kills = 0
    runs.remove("out")
    while runs.interrupt(case, "out", 1 + kills, signal.SIGKILL, "--resume", "--checkpoint", "0.02"):
        kills += 1
        expect(kills < 200, "the run comes to its end")
    expect(kills > 0 and runs.sha("out") == whole, f"a run that was killed {kills} times gives the same files")
    print(f"1, 2, 3, 8 threads and {kills} kills; {whole}")


def threads(runs, others):
    """Different numbers of threads and back ends, with enough particles to distribute the loops"""
    cup = dict(CASE["boundaries"][1], r=[0.02, 0.02, 0], radius=0.03)
    case = runs.case("heap", end=0.015, interval=5e-3, boundaries=[CASE["boundaries"][0], cup, CASE["boundaries"][2]],
                     domain={"low": [-0.012, -0.012, -0.002], "high": [0.052, 0.052, 0.08]},
                     fill=[dict(CASE["fill"][0], low=[0, 0, 0], high=[0.04, 0.04, 0.02])])
    one = None
    for program in (None, *others):
        for count in (1, 2, 3, 4, 8):
            runs.finish(case, "--output", "out", "--force", "--threads", str(count), program=program)
            sha = runs.sha("out")
            one = one or sha
            expect(sha == one, f"{count} threads of {program or runs.program} give the same files")
    gpu = runs.start(case, "--output", "out", "--force", "--device", "cuda")
    _, err = gpu.communicate()
    expect(gpu.returncode in (0, 7), f"a GPU runs the case or is not available: {err}")
    if gpu.returncode == 0:
        expect(runs.sha("out") == one, "a GPU gives the same files")
    print(f"1, 2, 3, 4, 8 threads, {1 + len(others)} back ends{', a GPU' if gpu.returncode == 0 else ''}; {one}")


def main():
    what, program, *others = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(program, folder)
        if what == "kills":
            kills(runs)
        elif what == "ends":
            ends(runs)
        elif what == "longer":
            longer(runs)
        elif what == "bodies":
            bodies(runs)
        else:
            threads(runs, others)


if __name__ == "__main__":
    main()
