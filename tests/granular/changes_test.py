#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""hilda-granular --resume with a changed case: by --set or by an edited file, with one result for any interruptions.

    changes_test.py PROGRAM
"""
import csv
import json
import signal
import sys
import tempfile

from case_runs import CASE, Runs, expect

HALF, END = "0.01", "0.03"
CUP = dict(end=0.01, interval=1e-3, frame_interval=2e-3,
           domain={"low": [-0.002, -0.002, -0.002], "high": [0.022, 0.022, 0.08], "outflow": ["+z"]},
           insert=[{"name": "feed", "rate": 1000, "v": [0, 0, -1], "radius": 5e-4, "material": "glass",
                    "region": {"type": "box", "low": [0.005, 0.005, 0.0305], "high": [0.015, 0.015, 0.035]}}])
CHANGES = ("--set", "/gravity=[1,0,-20]", "--set", "/laws/0/mu=0.05", "--set", "/laws/1/rolling/mu_r=0.3",
           "--set", '/boundaries/0/r=[0,0,"1e-4*sin(2*pi*40*t)+0.02*(t-0.01)"]', "--set", "/boundaries/1/omega=[0,0,-3]",
           "--set", '/boundaries/2/F=[0,0,-0.05]', "--set", "/insert/0/rate=2000", "--set", "/interval=5e-4", "--end", END)
EDITED = dict(CUP, end=0.03, interval=5e-4, gravity=[1, 0, -20],
              laws=[dict(CASE["laws"][0], mu=0.05),
                    dict(CASE["laws"][1], rolling={"law": "epsd", "mu_r": 0.3, "eta_r": 0.3})],
              boundaries=[dict(CASE["boundaries"][0], r=[0, 0, "1e-4*sin(2*pi*40*t)+0.02*(t-0.01)"]),
                          dict(CASE["boundaries"][1], omega=[0, 0, -3]), dict(CASE["boundaries"][2], F=[0, 0, -0.05])],
              insert=[dict(CUP["insert"][0], rate=2000)])


def table(runs, output, name="run.csv"):
    with open(runs.folder / output / name, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def content(runs, output):
    """All output that does not depend on wall time and on the options of the last part of the run"""
    out = runs.folder / output
    files = {file.name: file.read_bytes() for pattern in ("*.csv", "*.pvd", "vtk/*", "case*.json", "checkpoint.end")
             for file in sorted(out.glob(pattern)) if file.name != "case-given.json"}
    summary = runs.summary(output)
    del summary["case"]["set"], summary["timing"], summary["provenance"]
    return dict(files, summary=json.dumps(summary))


def same(one, other, what):
    expect(one.keys() == other.keys(), f"{what}: the same files: {sorted(one)} and {sorted(other)}")
    expect(one == other, f"{what}: {[name for name in one if one[name] != other[name]]} differ")


def one_result(runs):
    """A change by --set and by an edited file, with other threads, and after interruptions"""
    case = runs.case("cup", **CUP)
    runs.finish(case, "--output", "half")
    results = {}

    def continued(output, *arguments, source=case, **options):
        if not (runs.folder / output).exists():
            runs.finish(case, "--output", output, "--threads", "2")
        return runs.finish(source, "--output", output, "--resume", *arguments, **options)

    err = continued("set", *CHANGES)
    expect("hilda: set: the case changes at t = 0.01 s: /gravity was [0, 0, -9.81] and is [1, 0, -20] now; " in err
           or "hilda: set: the case changes at t = 0.01 s: " in err and "/laws/0/mu was 0.3 and is 0.05 now" in err, f"notice: {err}")
    results["set"] = content(runs, "set")
    continued("threads", *CHANGES, "--threads", "2")
    same(results["set"], content(runs, "threads"), "2 threads")

    # interruptions, first with the options and then without, or by a kill
    for number, which in enumerate((signal.SIGINT, signal.SIGKILL)):
        output = f"cut{number}"
        runs.finish(case, "--output", output)
        options = CHANGES
        parts = 0
        while runs.interrupt(case, output, 1 + parts, which, "--resume", *options, "--checkpoint", "0.01", "--threads", str(1 + parts % 2)):
            parts += 1
            has_changed = "gravity" in json.loads((runs.folder / output / "case.json").read_text())
            options = () if has_changed else CHANGES
        expect(parts > 0, f"{output}: {parts} interruptions")
        same(results["set"], content(runs, output), f"{output}: {parts} interruptions by signal {which}")

    # an edited file in place of options; a second resume has no options at all
    edited = runs.case("edited", **EDITED)
    continued("edited", source=edited)
    one, two = content(runs, "set"), content(runs, "edited")
    for name in one:
        if name.endswith((".csv", ".vtp", ".pvd")):
            expect(one[name] == two[name], f"an edited file gives the same {name}")

    summary = runs.summary("set")
    expect(len(summary["changes"]) == 1 and summary["changes"][0]["t"] == 0.01 and summary["changes"][0]["step"] == 2000
           and summary["changes"][0]["case_before"] == "case-1.json" and len(summary["changes"][0]["changes"]) == 8,
           f"history: {summary['changes']}")
    expect(json.loads((runs.folder / "set" / "case-1.json").read_text())["laws"][0]["mu"] == 0.3, "the earlier case is kept")
    ran = json.loads((runs.folder / "set" / "case.json").read_text())
    expect(ran["laws"][0]["mu"] == 0.05 and ran["end"] == 0.03, f"case.json is the changed case: {ran}")
    times = [float(row["t"]) for row in table(runs, "set")]
    expect(times == sorted(times) and len(times) == 11 + 40 == summary["counters"]["rows"], f"rows: {times}")
    plain = table(runs, "half")
    expect(table(runs, "set")[:len(plain)] == plain, "the rows before the change are kept")
    inserted = int(table(runs, "set")[-1]["inserted"])
    flow = {row["t"]: int(row["inserted"]) for row in table(runs, "set")}
    expect(flow["0.01"] in (9, 10) and flow["0.025"] - flow["0.015"] == 20, f"the rate counts from the change on: {flow}")

    # a second change and a later end
    runs.finish(case, "--output", "set", "--resume", "--set", "/insert/0/active=false", "--end", "0.035")
    summary = runs.summary("set")
    expect([round(change["t"], 9) for change in summary["changes"]] == [0.01, 0.03] and (runs.folder / "set" / "case-2.json").exists(),
           f"two changes: {summary['changes']}")
    expect(int(table(runs, "set")[-1]["inserted"]) == inserted, "the insertion is off")
    return edited


def closed_forms(runs):
    """Gravity, and the velocity of a wall, before and after a change"""
    grain = {"r": [0.01, 0.01, 0.05], "radius": 1e-3, "material": "glass"}
    wall = {"name": "wall", "type": "plane", "normal": [0, 0, 1], "r": [0, 0, "0.1*t"], "material": "steel"}
    case = runs.case("free", particles=[grain], fill=[], boundaries=[wall], end=0.01, interval=1e-3)
    runs.finish(case, "--output", "free")
    runs.finish(case, "--output", "free", "--resume", "--end", "0.02", "--set", "/gravity=[0,0,5]",
                "--set", "/boundaries/0/r=[0,0,0]", "--set", "/boundaries/0/v=[0,0,-0.3]")
    row = table(runs, "free")[-1]
    grain = table(runs, "free", "particles.csv")[0]
    expect(abs(float(grain["vz"]) - (-9.81 * 0.01 + 5 * 0.01)) < 1e-7, f"gravity: {grain}")
    expect(abs(float(row["wall_z"]) - (0.1 * 0.01 - 0.3 * 0.01)) < 1e-12 and float(row["wall_vz"]) == -0.3, f"the wall: {row}")


def flows(runs):
    """The particles that are due from a sequence of changes of an insertion, in closed form"""
    feed = dict(CUP["insert"][0], rate=250)
    space = dict(CUP, gravity=[0, 0, 0], fill=[], boundaries=[], domain=CASE["domain"])
    case = runs.case("flows", **dict(space, insert=[dict(feed, v=[0, 0, 0], interval=1e-3)]))
    end, due = 0.01, 2.5
    runs.finish(case, "--output", "flows")
    # the rate goes to another value and back, and so do the time of the end and the switch
    for changes, rate, until in (((("rate", 550),), 550, 1), ((("rate", 250),), 250, 1), ((("rate", 550),), 550, 1),
                                 ((("to", 0.043),), 550, 0.043), ((("to", 1),), 550, 1), ((("to", 0.043),), 550, 0.043), ((("to", 1),), 550, 1),
                                 ((("active", "false"),), 0, 1), ((("active", "true"), ("rate", 250)), 250, 1), ((("rate", 550),), 550, 1)):
        due += rate * max(0, min(end + 0.01, until) - end)
        end = round(end + 0.01, 2)
        runs.finish(case, "--output", "flows", "--resume", "--end", str(end), *(
            option for key, value in changes for option in ("--set", f"/insert/0/{key}={value}")))
        inserted = int(table(runs, "flows")[-1]["inserted"])
        # the particles of the interval of the insertions before the end may be missing
        expect(due - 1 - 550 * 1.1e-3 < inserted <= due + 1e-6, f"{inserted} particles until {end} s, {due} are due")
    runs.finish(case, "--output", "flows", "--resume", "--end", str(end + 0.01), "--set", "/insert/0/rate=1e-9")
    inserted = int(table(runs, "flows")[-1]["inserted"])
    expect(inserted == int(due + 1e-6), f"{inserted} particles in all, {due} are due")
    # only the velocity changes: the number goes on, and the particles have the velocity of their time
    fall = runs.case("fall", **dict(space, insert=[feed]))
    runs.finish(fall, "--output", "fall")
    for speed, end in ((2, 0.02), (1, 0.03)):
        runs.finish(fall, "--output", "fall", "--resume", "--end", str(end), "--set", f"/insert/0/v=[0,0,{speed}]")
    speeds = sorted(round(float(row["vz"]), 6) for row in table(runs, "fall", "particles.csv"))
    expect(speeds == [-1] * 2 + [1] * 3 + [2] * 2, f"velocities: {speeds}")


def refused(runs):
    """Entries that cannot change, and changes that do not continue the state"""
    case = runs.case("cup", **CUP)
    runs.finish(case, "--output", "kept", "--quiet")
    before = content(runs, "kept")

    def no(code, message, *options, source=case):
        runs.refused(source, code, message, "--output", "kept", "--resume", "--end", END, *options)

    can = "; a run can change name, note, end, interval and gravity; r, v, omega, F and T of boundaries; "
    for change, shown in (("/step=2e-6", "/step was 5e-06 and is 2e-06 now"), ("/skin=0.2", "/skin was missing and is 0.2 now"),
                          ("/fill/0/seed=3", "/fill/0/seed was missing and is 3 now"),
                          ("/materials/0/E=8e7", "/materials/0/E was 7e\\+07 and is 8e\\+07 now"),
                          ("/boundaries/2/r=[0,0,0.05]", r"/boundaries/2/r was \[0, 0, 0.04\] and is \[0, 0, 0.05\] now"),
                          ("/boundaries/2/mass=3e-3", "/boundaries/2/mass was 0.002 and is 0.003 now"),
                          ("/frame_interval=1e-3", "/frame_interval was 0.002 and is 0.001 now"),
                          ("/laws/0/tangential/law=coulomb", '/laws/0/tangential/law was "mindlin" and is "coulomb" now'),
                          ("/domain/outflow=[]", "/domain/outflow was ")):
        no(5, f"--resume: kept/case.json: is another case, or this case with other options; --force overwrites it; {shown}.*{can}",
           "--set", change)
    no(5, "/boundaries was another value and is another value now", source=runs.case("fewer", **dict(CUP, boundaries=CASE["boundaries"][:2])))
    no(3, r"cup.json:\d+:\d+ \(/laws/1/spin\): the spin law must be that of the run, only its numbers can change",
       "--set", '/laws/1/spin={"law": "torsional-spring"}')
    no(3, r"cup.json:\d+:\d+ \(/boundaries/0/r\): the formula must begin at the place of the boundary at t = 0.01 s, "
          r"\(0, 0, \S+\) m, got \(0, 0, 0.001\)", "--set", '/boundaries/0/r=[0,0,"0.1*t"]')
    no(3, r"mu must not be negative, got -1", "--set", "/laws/0/mu=-1")
    runs.refused(case, 2, "--end must be after t = 0.01 s", "--output", "kept", "--resume", "--set", "/laws/0/mu=0.1")
    after = content(runs, "kept")
    same(before, after, "a refused change changes nothing")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        closed_forms(runs)
        flows(runs)
        refused(runs)
        one_result(runs)
    print("changes by --set and by a file, one result with interruptions, closed forms, refusals")


if __name__ == "__main__":
    main()
