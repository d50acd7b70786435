#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages of a run of hilda-granular: their ends, their changes against closed forms, one result with interruptions, and errors.
Groups of particles: their table, columns, fields and removal; removal of regions.

    stages_test.py PROGRAM
"""
import csv
import json
import re
import signal
import sys
import tempfile

from case_runs import CASE, Runs, expect

GRAIN = {"radius": 1e-3, "material": "glass"}
FLOOR = {"name": "floor", "type": "plane", "normal": [0, 0, 1], "material": "steel"}
# Grains settle in a cup, a part of them is removed, the floor shakes, and others are inserted
RUN = dict(end=0.1, interval=1e-3, frame_interval=5e-3,
           boundaries=[dict(FLOOR), dict(CASE["boundaries"][1], omega=[0, 0, 0])],
           particles=[dict(GRAIN, r=[0.01, 0.01, 0.045], group="ball")],
           fill=[dict(CASE["fill"][0], random_v=0, group="bed"),
                 {"type": "lattice", "low": [0.006, 0.006, 0.032], "high": [0.014, 0.014, 0.036], "radius": 1e-3, "material": "glass",
                  "group": "lid"}],
           insert=[{"name": "feed", "rate": 2000, "active": False, "v": [0, 0, -0.5], "radius": 5e-4, "material": "glass", "group": "fed",
                    "region": {"type": "box", "low": [0.005, 0.005, 0.06], "high": [0.015, 0.015, 0.07]}}],
           stages=[{"name": "settle", "duration": 0.06, "until": {"share": 0.3, "from": 0.01, "interval": 5e-4}},
                   {"name": "shake", "duration": 0.008, "remove": ["lid"],
                    "set": {"/boundaries/floor/r": [0, 0, "1e-4*sin(2*pi*100*t)"], "/boundaries/wall/omega": [0, 0, "50*t"],
                            "/laws/0/mu": 0.05, "/insert/feed/active": True}},
                   {"name": "tilt", "duration": 0.006, "set": {"/gravity": [3, 0, -9.81], "/insert/feed/active": False,
                                                             "/boundaries/floor/r": [0, 0, 0], "/boundaries/wall/omega": [0, 0, -2]}}])


def table(runs, output, name="run.csv"):
    with open(runs.folder / output / name, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def content(runs, output):
    """All output that does not depend on wall time, with the state at the end"""
    return runs.sha(output), (runs.folder / output / "checkpoint.end").read_bytes()


def one_result(runs):
    """The stages with 1 and 2 threads, and with interruptions in each of them"""
    case = runs.case("cup", **RUN)
    runs.finish(case, "--output", "whole")
    whole = content(runs, "whole")
    summary = runs.summary("whole")
    stages = summary["stages"]
    expect([stage["name"] for stage in stages] == ["settle", "shake", "tilt"]
           and [stage["reason"] for stage in stages] == ["condition", "duration", "duration"]
           and [stage.get("condition_met") for stage in stages] == [True, None, None], f"{stages}")
    expect(0.0105 <= stages[0]["end"] < 0.06 and abs(stages[1]["end"] - stages[0]["end"] - 0.008) < 1e-9
           and abs(summary["counters"]["t"] - stages[0]["end"] - 0.014) < 1e-9 and summary["status"] == "ok", f"{stages}")
    rows = table(runs, "whole")
    for row in rows:
        t = float(row["t"])
        number = sum(t > stage["start"] + 1e-9 for stage in stages[1:])
        expect(int(row["stage"]) == number, f"a row at the begin of a stage is that of the one before: {row['t']}, {row['stage']}")
    groups = table(runs, "whole", "groups.csv")
    names = summary["groups"]
    expect(names == ["ball", "bed", "lid", "fed"], f"{names}")
    for row in rows:
        of = [group for group in groups if group["t"] == row["t"]]
        expect([group["name"] for group in of] == names, f"a row for each group: {of}")
        expect(sum(int(group["particles"]) for group in of) == int(row["particles"]), "each particle is in one group")
        energy = sum(float(group["kinetic_energy"]) for group in of)
        expect(abs(energy - float(row["kinetic_energy"])) <= 1e-7 * energy, f"energy of the groups: {energy}, {row['kinetic_energy']}")
        lid = int(of[2]["particles"])
        expect(lid == (9 if row["stage"] == "0" else 0) and int(row["removed"]) == 9 - lid, f"the lid: {of[2]} {row['removed']}")
    removed = table(runs, "whole", "outflow.csv")
    expect(len(removed) == 9 and {row["side"] for row in removed} == {"removed"}
           and all(abs(float(row["t"]) - stages[0]["end"]) < 1e-12 for row in removed), f"outflow.csv: {removed[:2]}")
    fed = {row["t"]: int(row["inserted"]) for row in rows}
    expect(max(fed[row["t"]] for row in rows if row["stage"] == "0") == 0, f"the insertion begins with its stage: {fed}")
    expect(10 <= max(fed.values()) <= 17 and max(fed.values()) == fed[rows[-1]["t"]], f"the rate in its stage: {fed}")
    ids = {row["group"] for row in table(runs, "whole", "particles.csv")}
    expect(ids == {"0", "1", "3"}, f"column group: {ids}")

    runs.finish(case, "--output", "threads", "--threads", "2")
    expect(content(runs, "threads") == whole, "2 threads give the same files")
    seconds, interval = summary["timing"]["wall_seconds"], 1e-2
    for which in (signal.SIGINT, signal.SIGKILL):
        parts, in_stages = 0, set()
        while runs.interrupt(case, "cut", max(1, int(seconds / 8 / interval)), which,
                             "--resume", "--checkpoint", str(interval), "--threads", str(1 + parts % 2)):
            parts += 1
            if table(runs, "cut"):
                in_stages.add(table(runs, "cut")[-1]["stage"])
            expect(parts < 100, "the run comes to its end")
        expect(parts > 1, f"{parts} interruptions")
        expect(content(runs, "cut") == whole, f"{parts} interruptions by signal {which} in the stages {in_stages} give the same files")
        runs.remove("cut")
    # at the ends of the stages to a step: a run to an earlier end, and its continuation
    for at in (stages[0]["end"] - 5e-6, stages[0]["end"], stages[0]["end"] + 5e-6, stages[1]["end"], stages[1]["end"] + 5e-6):
        runs.finish(case, "--output", "cut", "--end", f"{at:.9g}")
        runs.finish(case, "--output", "cut", "--resume", "--end", "0.1")
        expect(content(runs, "cut")[1] == whole[1], f"a run continued at {at} has the same state")
        expect(table(runs, "cut") == rows, f"a run continued at {at} has the same rows")
        runs.remove("cut")
    expect("the run is complete already" in runs.finish(case, "--output", "whole", "--resume"), "a complete run")
    err = runs.finish(case, "--output", "whole", "--resume", "--end", "0.2", "--set", "/laws/0/mu=0.2", code=5)
    expect("/laws/0/mu was 0.3 and is 0.2 now; a run with stages can change name, note, end and interval" in err, f"{err}")


def closed_forms(runs):
    """Gravity and motions of stages, with the time since their start"""
    space = dict(particles=[dict(GRAIN, r=[0.01, 0.01, 0.05])], fill=[], interval=1e-3, end=1)
    case = runs.case("free", **space, boundaries=[FLOOR], stages=[
        {"name": "fall", "duration": 0.01}, {"name": "up", "end": 0.03, "set": {"/gravity": [0, 0, 5], "/boundaries/floor/v": [0, 0, "-2*t"]}},
        {"name": "on", "duration": 0.01, "set": {"/boundaries/0/v": [0, 0, 0.01]}}])
    runs.finish(case, "--output", "free")
    grain, row = table(runs, "free", "particles.csv")[0], table(runs, "free")[-1]
    expect(abs(float(grain["vz"]) - (-9.81 * 0.01 + 5 * 0.03)) < 1e-7, f"gravity: {grain}")
    expect(abs(float(row["floor_z"]) - (-0.02 ** 2 + 0.01 * 0.01)) < 1e-12 and row["t"] == "0.04", f"the floor: {row}")
    # the friction coefficient of a stage: deceleration of a sliding grain without rotation of its material
    slide = runs.case("slide", particles=[dict(GRAIN, r=[0.005, 0.01, 9.99e-4], v=[0.2, 0, 0])], fill=[], boundaries=[FLOOR], interval=1e-3,
                      end=0.02, stages=[{"name": "rough", "duration": 0.005},
                                        {"name": "smooth", "set": {"/laws/1/mu": 0, "/laws/1/rolling": {"law": "epsd", "mu_r": 0, "eta_r": 0}}}])
    runs.finish(slide, "--output", "slide")
    speed = [float(row["momentum_x"]) for row in table(runs, "slide")]
    expect(speed[5] < 0.97 * speed[0] and abs(speed[-1] - speed[5]) < 1e-6 * speed[0], f"friction: {speed[0]}, {speed[5]}, {speed[-1]}")


def timeouts(runs):
    """A condition that is not met in time, and runs that end before their last stage"""
    until = {"kinetic_energy": 1e-30, "interval": 1e-3}
    stages = [{"name": "settle", "duration": 0.002, "until": until}, {"name": "next", "duration": 1e-3}]
    case = runs.case("late", **dict(RUN, stages=stages))
    err = runs.finish(case, "--output", "late")
    message = "stage 'settle': its condition is not met until t = 0.002 s, after 0.002 s: the kinetic energy is "
    expect(f"hilda: warning: {message}" in err and runs.summary("late")["counters"]["t"] == 0.003, f"{err}")
    first, second = runs.summary("late")["stages"]
    expect(first["reason"] == "duration" and first["condition_met"] is False and "condition_met" not in second, f"the reason: {first}")
    for resume in ((), ("--resume",)):
        runs.refused(case, 4, r"\[stage_timeout\]: " + message + r".*\(a warning, with --strict\)", "--output", "strict", "--strict", *resume)
    strict = runs.summary("strict")
    expect(strict["status"] == "stage_timeout" and strict["stages"][0]["condition_met"] is False, f"{strict['stages']}")
    runs.finish(case, "--output", "strict", "--resume")
    expect(content(runs, "strict")[1] == content(runs, "late")[1], "without --strict the run continues as without the end by it")
    case = runs.case("fails", **dict(RUN, stages=[dict(stages[0], on_timeout="fail"), stages[1]]))
    for resume in ((), ("--resume",)):
        runs.refused(case, 4, r"\[stage_timeout\]: " + message, "--output", "fails", *resume)
    expect(runs.summary("fails")["status"] == "stage_timeout" and runs.summary("fails")["counters"]["t"] == 0.002, "status")
    case = runs.case("short", **dict(RUN, end=0.001, stages=stages))
    err = runs.finish(case, "--output", "short")
    expect("hilda: warning: the run has ended in stage 'settle', before its last stage" in err, f"{err}")
    short = runs.summary("short")["stages"][0]
    expect(short["reason"] == "end of the run" and short["condition_met"] is False, f"{short}")
    runs.refused(case, 4, r"\[stage_timeout\]: stage 'settle': its condition is not met until t = 0.001 s", "--output", "end", "--strict")
    last = runs.case("last", **dict(RUN, end=0.002, stages=[dict(stages[0], on_timeout="fail")]))
    runs.refused(last, 4, r"\[stage_timeout\]: " + message, "--output", "last")
    empty = [{"name": "fill", "duration": 0.003, "until": {"share": 1, "interval": 1e-4}}]
    err = runs.finish(runs.case("empty", **dict(RUN, end=0.003, particles=[], fill=[], insert=[], stages=empty)), "--output", "empty")
    expect("its condition is not met until t = 0.003 s" in err, f"no grains: {err}")
    jump = [{"name": "first", "duration": 1e-3}, {"name": "second", "set": {"/boundaries/floor/r": [0, 0, "1e-3*(1+t)"]}}]
    runs.refused(runs.case("jump", **dict(RUN, stages=jump)), 4, r"\[stage_motion\]: .*the formula must begin at the place of the boundary",
                 "--output", "jump")


def past_ends(runs):
    """A stage whose end is past, and a later end of a run whose stages are over"""
    settle = {"name": "settle", "until": {"share": 1, "interval": 2e-3}}
    stages = [settle, {"name": "past", "end": 1e-3, "set": {"/gravity": [0, 0, 0]}}, {"name": "last", "duration": 1e-3}]
    case = runs.case("past", **dict(RUN, stages=stages))
    message = r"past.json:1:\d+ \(/stages/1/end\): end must be after the start of the stage at t = 0.002 s, got 0.001; the stage has no steps"
    err = runs.finish(case, "--output", "past")
    expect(re.search("hilda: warning: " + message, err), f"{err}")
    past = runs.summary("past")["stages"]
    expect([(stage["start"], stage["end"]) for stage in past] == [(0, 0.002), (0.002, 0.002), (0.002, 0.003)], f"{past}")
    for resume in ((), ("--resume",)):
        runs.refused(case, 4, r"\[stage_end\]: " + message, "--output", "strict_past", "--strict", *resume)

    over = runs.case("over", **dict(RUN, end=0.002, stages=[{"name": "one", "duration": 0.002}]))
    runs.finish(over, "--output", "over")
    for run, ends, t in ("past", (0.0025, 0.2), "0.003"), ("over", (0.01,), "0.002"):
        before = content(runs, run)
        for end in ends:
            runs.refused(run, 2, f"granular: --end has no effect on the run in {run}: its last stage has ended at t = {t} s, and the run with it",
                         "--output", run, "--resume", "--end", str(end))
        expect(content(runs, run) == before, "nothing changes")
        expect("the run is complete already" in runs.finish(run, "--output", run, "--resume"), "a complete run")
    # with a last stage that lasts to the end of the run, a later end extends it
    on = runs.case("on", **dict(RUN, end=0.002, stages=[{"name": "one", "duration": 0.001}, {"name": "two"}]))
    runs.finish(on, "--output", "on")
    runs.refused(on, 2, "--end must be after t = 0.002 s, which the run in on has reached, got 0.0015", "--output", "on", "--resume", "--end", "0.0015")
    runs.finish(on, "--output", "on", "--resume", "--end", "0.003")
    expect(runs.summary("on")["counters"]["t"] == 0.003, "a later end")


def names(runs):
    """Names of boundaries and insertions in --set, and a formula of r with a velocity of 0"""
    case = runs.case("names", **dict(RUN, end=1e-3, stages=[], boundaries=[dict(FLOOR, name="a/b~0"), RUN["boundaries"][1]]))
    runs.finish(case, "--output", "names", "--set", "/boundaries/a~1b~00/v=[0,0,-0.01]", "--set", "/insert/feed/active=true")
    written = json.loads((runs.folder / "names" / "case.json").read_text())
    expect(written["boundaries"][0]["v"] == [0, 0, -0.01] and written["insert"][0]["active"], f"{written['boundaries']}")
    runs.finish(case, "--output", "names", "--resume", "--end", "2e-3", "--set", "/boundaries/a~1b~00/v=[0,0,-0.02]",
                "--set", "/boundaries/wall/omega=[0,0,1]", "--set", "/insert/feed/v=[0,0,-2]")
    z = float(table(runs, "names")[-1]["a/b~0_z"])
    expect(abs(z + 1e-5 + 2e-5) < 1e-12, f"{z}")
    runs.refused(case, 3, r'\(/boundaries\): --set "/boundaries/wal/v=1": there is no "wal" in a list of 2', "--output", "n", "--set", "/boundaries/wal/v=1")
    # a boundary with a velocity has a formula of r from a stage on
    stages = [{"name": "v", "duration": 1e-3},
              {"name": "r", "duration": 1e-3, "set": {"/boundaries/floor/v": [0, 0, 0], "/boundaries/floor/r": [0, 0, "-1e-5-0.02*t"]}}]
    moved = [dict(FLOOR, v=[0, 0, -0.01]), RUN["boundaries"][1]]
    runs.finish(runs.case("r", **dict(RUN, boundaries=moved, stages=stages)), "--output", "r")
    z = float(table(runs, "r")[-1]["floor_z"])
    expect(abs(z + 3e-5) < 1e-12, f"r(t) from a velocity: {z}")
    del stages[1]["set"]["/boundaries/floor/v"]
    runs.refused(runs.case("v", **dict(RUN, boundaries=moved, stages=stages)), 3,
                 r"\(/stages/1/set\): /boundaries/0/v: v must be 0 or not be given if r is a formula, got \[0, 0, -0.01\]$", "--output", "v")


def errors(runs):
    """Wrong entries: exit code 3 with their place"""
    def refused(pointer, message, *stages, **changes):
        case = runs.case("wrong", **dict(RUN, stages=list(stages), **changes))
        runs.refused(case, 3, rf"wrong.json:1:\d+ \({pointer}\): {message}", "--output", "wrong")

    one = {"name": "one"}
    for value, message in (({"/laws/0/mu": -1}, "/laws/0/mu: mu must not be negative, got -1$"),
                           ({"/step": 1e-6}, "/step: cannot be set by a stage; a stage can set gravity; r, v, omega, F and T of boundaries;"),
                           ({"/fill/0/radius": 1e-3, "/materials/0/E": 1}, "/materials/0/E: cannot be set by a stage"),
                           ({"/laws/7/mu": 1}, '/laws: there is no "7" in a list of 2'),
                           ({"gravity": [0, 0, 0]}, "/: must be /json/pointer=VALUE"),
                           ({"/boundaries/flor/v": [0, 0, 1]}, '/boundaries: there is no "flor" in a list of 2'),
                           ({"/laws/1/spin": {"law": "torsional-spring"}}, "/laws/1/spin: the spin law must be that of the run"),
                           ({"/boundaries/floor/v": [0, 0, "sine(t)"]}, "/boundaries/0/v/2: unknown function 'sine'"),
                           ({"/end": 3}, "/end: cannot be set by a stage"),
                           ({"/laws/0/nu": 3}, "/laws/0/nu: unknown key .nu.")):
        refused("/stages/1/set", message, one, {"name": "two", "set": value})
    plane = {"type": "half_space", "r": [0, 0, 0], "normal": [0, 0, 1]}
    for removal, place, message in (
            ("lidd", "", "no entry has the group 'lidd'; did you mean 'lid'\\?"),
            ("", "", "no entry has the group ''"),
            (3, "", "remove must list names of groups and regions, got 3"),
            (dict(plane, group="bedd"), "", "no entry has the group 'bedd'; did you mean 'bed'\\?"),
            (dict(plane, type="halfspace"), "/type", "unknown type \"halfspace\"; did you mean 'half_space'\\?"),
            (dict(plane, normal=[0, 0, 0]), "/normal", "normal must"),
            (dict(plane, radius=1), "/radius", "unknown key \"radius\"; allowed: type, r, normal, group, note"),
            ({"type": "box", "low": [0, 0, 1], "high": [1, 1, 1]}, "/high/2", "high must be above low, 1, got 1"),
            ({"type": "cylinder", "r": [0, 0, 0], "axis": [0, 0, 1], "radius": 0, "length": 1}, "/radius", "radius must be positive, got 0")):
        refused(f"/stages/1/remove/0{place}", message, one, {"name": "two", "remove": [removal]})
    refused("/stages/1/name", 'two stages have the same name, got "one"', one, one)
    refused("/stages/1/end", "end must be after the stages before, which last until t = 0.002 s, got 0.0015", dict(one, duration=2e-3),
            {"name": "two", "end": 1.5e-3})
    refused("/stages/2/end", "end must be after the stages before, which last until t = 0.003 s, got 0.003", dict(one, end=3e-3),
            {"name": "two", "until": {"share": 1}}, {"name": "three", "end": 3e-3})
    refused("/stages/0/end", "end must not be given together with duration", dict(one, duration=1, end=1))
    refused("/stages/0/on_timeout", "on_timeout is only for a stage with until and a duration or end", dict(one, on_timeout="fail"))
    refused("/stages/0/until", "one of the keys kinetic_energy and share is required", dict(one, until={}))
    refused("/stages/0/set", "the stability limit of the step is .* with these laws, the step is 5e-06; --accept-step accepts it",
            {"name": "hard", "set": {"/laws/0/normal": {"law": "hertz"}, "/laws/1/normal/k_n": 1e9}},
            laws=[CASE["laws"][0], {"between": ["glass", "steel"], "normal": {"law": "hooke", "k_n": 1e3, "gamma_n": 10}}])
    tables = "the name of a group must not be empty or contain commas, quotes and control characters, because it is in tables, got "
    refused("/stages/1/groups", tables + '"a,b"', one, {"name": "two", "groups": {"a,b": ["bed"]}})
    refused("/stages/1/groups", "must be an object, got 3", one, {"name": "two", "groups": 3})
    refused("/stages/1/groups/red", "red must be a list, got 3", one, {"name": "two", "groups": {"red": 3}})
    refused("/stages/1/groups/red/0", "no entry has the group 'bedd'; did you mean 'bed'\\?", one, {"name": "two", "groups": {"red": ["bedd"]}})
    refused("/stages/1/groups/red/0/normal", "normal must", one, {"name": "two", "groups": {"red": [dict(plane, normal=[0, 0, 0])]}})
    refused("/particles/0/group", tables + '"a,b"', one,
            particles=[dict(GRAIN, r=[0.01, 0.01, 0.045], group="a,b")])


def whole_entries(runs):
    """A boundary that is set as a whole moves as by its keys"""
    moved = dict(RUN["boundaries"][0], v=[0, 0, -0.01])
    for value in {"/boundaries/floor/v": [0, 0, -0.01]}, {"/boundaries/floor": moved}, {"/boundaries": [moved, RUN["boundaries"][1]]}:
        stages = [{"name": "rest", "duration": 1e-3}, {"name": "move", "duration": 1e-3, "set": value}]
        runs.finish(runs.case("entry", **dict(RUN, stages=stages)), "--force", "--output", "entry")
        z = float(table(runs, "entry")[-1]["floor_z"])
        expect(abs(z + 1e-5) < 1e-12, f"{value}: the floor is at {z}")


def clumps(runs):
    """The group of a clump has the energy and the momentum of its body"""
    shape = {"name": "hook", "material": "glass", "density": 2500,
             "spheres": [{"radius": 2e-3}, {"r": [2.5e-3, 0, 0], "radius": 1e-3}, {"r": [0, 2e-3, 0], "radius": 1.2e-3}]}
    particles = [{"clump": "hook", "r": [0.01, 0.01, 0.04], "omega": [0, 0, 100], "v": [0.1, 0, 0], "group": "one"}]
    case = runs.case("clumps", **dict(RUN, end=0.01, gravity=[0, 0, 0], clumps=[shape], particles=particles, fill=[], insert=[], stages=[]))
    runs.finish(case, "--output", "clumps")
    for all_of, group in zip(table(runs, "clumps"), table(runs, "clumps", "groups.csv")):
        for key in "kinetic_energy", "momentum_x", "momentum_y":
            expect(abs(float(group[key]) - float(all_of[key])) <= 1e-6 * float(all_of["kinetic_energy"]),
                   f"{key} at {group['t']}: {group[key]} and {all_of[key]}")


def cuts(runs):
    """A stage removes the particles whose centres are in a region, and clumps by their centres of mass"""
    # two equal spheres: the centre of mass is between them
    pair = {"name": "pair", "material": "glass", "density": 2500, "spheres": [{"radius": 1e-3}, {"r": [2.1e-3, 0, 0], "radius": 1e-3}]}
    rest = dict(RUN, gravity=[0, 0, 0], end=1e-3, interval=5e-4, boundaries=[FLOOR], insert=[], clumps=[pair],
                fill=[dict(RUN["fill"][0], group="bed"), dict(RUN["fill"][1], low=[0.006, 0.006, 0.042], high=[0.014, 0.014, 0.046])],
                particles=[{"clump": "pair", "r": [x, y, 0.06], "group": "bed"} for x, y in ((0.009, 0.008), (0.0105, 0.012))])
    x_cut = 0.0098  # between the members of both clumps; the centre of mass of the first one is below

    def box(r):
        return 0.002 <= r[0] <= 0.009 and 0.002 <= r[1] <= 0.02 and 0.01 <= r[2] <= 0.044

    def cylinder(r):  # inclined in the plane of y and z
        along = ((r[1] - 0.01) + 7 * (r[2] - 0.005)) / 50 ** 0.5
        away = [r[0] - 0.01, r[1] - 0.01 - along / 50 ** 0.5, r[2] - 0.005 - 7 * along / 50 ** 0.5]
        return 0 <= along <= 0.042 and sum(a * a for a in away) <= 0.006 ** 2

    shapes = (({"type": "box", "low": [0.002, 0.002, 0.01], "high": [0.009, 0.02, 0.044]}, box),
              ({"type": "cylinder", "r": [0.01, 0.01, 0.005], "axis": [0, 1, 7], "radius": 0.006, "length": 0.042}, cylinder),
              ({"type": "half_space", "r": [x_cut, 0, 0], "normal": [-2, 0, 0]}, lambda r: r[0] <= x_cut))

    def left(name, **changes):
        runs.finish(runs.case(name, **dict(rest, **changes)), "--output", name)
        return {row["id"]: row for row in table(runs, name, "particles.csv")}

    whole = left("uncut", stages=[])
    place = {key: [float(row[axis]) for axis in "xyz"] for key, row in whole.items()}
    for key, row in whole.items():  # of a clump: the mean of its two members
        if row["clump"] not in ("", "-1") and key != row["clump"]:
            place[key] = place[row["clump"]] = [(a + b) / 2 for a, b in zip(place[key], place[row["clump"]])]
    number = {name: str(k) for k, name in enumerate(runs.summary("uncut")["groups"])}
    for region, contains in shapes:
        for only in (None, "bed", "lid"):
            cut = dict(region, group=only) if only else region
            rest_of = left("cut", stages=[{"name": "wait", "duration": 5e-4}, {"name": "cut", "remove": [cut]}])
            expected = {key for key, r in place.items()
                        if not (contains(r) and (only is None or whole[key]["group"] == number[only]))}
            expect(set(rest_of) == expected, f"{cut}: {set(rest_of) ^ expected}")
            stages = runs.summary("cut")["stages"]
            expect(stages[1]["removed"] == len(whole) - len(expected) > 0 and "removed" not in stages[0], f"{cut}: {stages}")
            runs.remove("cut")
    # a case without groups
    fill = [{key: value for key, value in entry.items() if key != "group"} for entry in rest["fill"]]
    plain = left("plain", stages=[{"name": "cut", "remove": [shapes[0][0]]}], clumps=[], particles=[], fill=fill)
    singles = [key for key, row in whole.items() if row["clump"] == "-1"]
    expect(len(plain) == len([key for key in singles if not box(place[key])]) < len(singles), f"without groups: {len(plain)} remain")
    # several at once, from the initial state; a region in which nothing is
    far = {"type": "half_space", "r": [0, 0, 0.075], "normal": [0, 0, 1]}
    both = left("both", stages=[{"name": "cut", "remove": ["lid", far, shapes[0][0]]}])
    expect(set(both) == {key for key, r in place.items() if whole[key]["group"] != number["lid"] and not box(r)}, "groups and regions")
    err = runs.finish(runs.case("none", **dict(rest, stages=[{"name": "cut", "remove": [far]}])), "--output", "none")
    expect("stage 'cut': remove: no particle is in its groups and regions at t = 0 s" in err, f"{err}")
    runs.refused("none", 4, r"\[stage_remove\]: stage 'cut': remove: no particle is in its groups and regions at t = 0 s", "--output", "no", "--strict")
    expect(runs.summary("none")["stages"][0]["removed"] == 0 and len(table(runs, "none", "particles.csv")) == len(whole), "nothing is cut")


def assigned(runs):
    """A stage assigns the particles of regions and groups to groups; rows, columns, fields and later removals follow"""
    upper = {"type": "half_space", "r": [0, 0, 0.012], "normal": [0, 0, 1]}
    stages = [{"name": "settle", "duration": 0.02},
              {"name": "mark", "duration": 5e-3, "groups": {"upper": [dict(upper, group="bed"), "lid"], "left": [
                  {"type": "box", "low": [-1, -1, -1], "high": [0.01, 1, 1], "group": "bed"}]}},
              {"name": "cut", "remove": ["upper"]}]
    pair = {"name": "pair", "material": "glass", "spheres": [{"radius": 1e-3}, {"r": [2.1e-3, 0, 0], "radius": 1e-3}]}
    given = dict(RUN, end=0.03, clumps=[pair], stages=stages, insert=[dict(RUN["insert"][0], active=True)],
                 particles=RUN["particles"] + [{"clump": "pair", "r": [0.008, 0.01, 0.05], "group": "bed"}])
    case = runs.case("marked", **given)

    def state(end):
        runs.finish(case, "--force", "--output", "marked", "--end", end)
        names = runs.summary("marked")["groups"]
        rows = table(runs, "marked", "particles.csv")
        return {row["id"]: (names[int(row["group"])], [float(row[a]) for a in "xyz"], row["clump"]) for row in rows}

    before, after, end = state("0.02"), state("0.020005"), state("0.03")
    place = {key: (r if clump == "-1" else [(a + b) / 2 for a, b in zip(r, before[str(int(clump) + 1)][1])])
             for key, (_, r, clump) in before.items() if clump in ("-1", key)}
    for key, (group, _, clump) in before.items():
        r = place[key if clump == "-1" else clump]
        expected = group
        if group == "lid" or group == "bed" and r[2] >= 0.012:
            expected = "upper"
        elif group == "bed" and r[0] <= 0.01:
            expected = "left"
        expect(after[key][0] == expected, f"particle {key} of {group} at {r}: {after[key][0]}, not {expected}")
    counts = {name: sum(group == name for group, _, _ in after.values()) for name in ("upper", "left", "bed", "fed", "ball")}
    expect(min(counts.values()) > 0, f"{counts}")
    rows = {(row["t"], row["name"]): int(row["particles"]) for row in table(runs, "marked", "groups.csv")}
    for name in ("upper", "left", "bed"):
        expect(rows["0.02", name] == (0 if name != "bed" else sum(group == "bed" for group, _, _ in before.values())),
               f"a row at the end of a stage belongs to this stage: {name}, {rows['0.02', name]}")
        expect(rows["0.021", name] == counts[name], f"{name}: {rows['0.021', name]}, {counts[name]}")
    expect(all(group != "upper" for group, _, _ in end.values()), "the group is removed")
    expect(runs.summary("marked")["stages"][2]["removed"] == counts["upper"], "a later stage removes the new group")
    expect({key for key in end if key in after} == {key for key, (group, _, _) in after.items() if group != "upper"}, "all others remain")
    # one result for threads and continuations
    whole = content(runs, "marked")
    for at in ("0.0199", "0.02", "0.020005", "0.0213", "0.025", "0.0251"):
        runs.finish(case, "--output", "cut", "--end", at, "--threads", "2")
        runs.finish(case, "--output", "cut", "--resume", "--end", "0.03")
        expect(content(runs, "cut")[1] == whole[1], f"a run continued at {at} has the same state")
        expect(table(runs, "cut", "groups.csv") == table(runs, "marked", "groups.csv"), f"a run continued at {at} has the same groups")
        runs.remove("cut")
    # nothing is there
    far = {"type": "half_space", "r": [0, 0, 0.075], "normal": [0, 0, 1]}
    runs.case("none", **dict(given, stages=[{"name": "mark", "groups": {"top": [far]}}]))
    message = "stage 'mark': groups: no particle is in the groups and regions of 'top' at t = 0 s"
    expect(message in runs.finish("none", "--output", "unmet", "--end", "1e-3"), "a warning of a group without particles")
    runs.refused("none", 4, r"\[stage_groups\]: " + message, "--output", "unmet-strict", "--strict", "--end", "1e-3")


def cut_of_a_bed(runs):
    """A bed is cut while it moves: one result for the number of threads and a continuation at the cut"""
    at = 0.02
    case = runs.case("bed", **dict(RUN, end=0.03, insert=[], stages=[
        {"name": "settle", "duration": at}, {"name": "cut", "remove": [{"type": "half_space", "r": [0, 0, 0.012], "normal": [0, 0, 1]}]}]))
    runs.finish(case, "--output", "bed")
    removed = table(runs, "bed", "outflow.csv")
    expect(len(removed) > 5 and all(float(row["z"]) >= 0.012 - 1e-9 for row in removed), f"above the plane: {removed[:2]}")
    runs.finish(case, "--output", "bed2", "--threads", "2")
    expect(content(runs, "bed") == content(runs, "bed2"), "2 threads")
    for end in (at - 5e-6, at, at + 5e-6):
        runs.finish(case, "--output", "part", "--end", f"{end:.9g}")
        runs.finish(case, "--output", "part", "--resume", "--end", "0.03")
        expect(content(runs, "part")[1] == content(runs, "bed")[1] and table(runs, "part", "outflow.csv") == removed, f"continued at {end}")
        runs.remove("part")


def fields(runs):
    """The fields of the groups add up to those of all particles, up to the forces between groups, which cancel"""
    grid = {"low": [-0.002, -0.002, -0.002], "high": [0.022, 0.022, 0.08], "cells": [1, 1, 1], "width": 0.002, "edges": "closed",
            "interval": 0.002}
    case = runs.case("fields", **dict(RUN, end=0.07, stages=[], fields=[dict(grid, name="all")] + [
        dict(grid, name=name, group=name) for name in ("ball", "bed", "lid", "fed")]))
    runs.finish(case, "--output", "fields")
    whole, *parts = (table(runs, "fields", f"fields-{name}.csv") for name in ("all", "ball", "bed", "lid", "fed"))
    forces = 0
    for rows in zip(whole, *parts):
        for key, bound in ("density", 0), ("momentum_z", 0), ("boundary_force_z", 1):
            one, others = float(rows[0][key]), [float(row[key]) for row in rows[1:]]
            size = sum(map(abs, others))
            expect(abs(one - sum(others)) <= 1e-9 * max(size, 1e-9), f"{key} at {rows[0]['t']}: {one} and {others}")
            forces += bound * (size > 1.001 * abs(one))
    expect(forces > 0, "groups have forces on each other")
    runs.refused(runs.case("wrong", **dict(RUN, fields=[dict(grid, group="bedd")])), 3,
                 r"\(/fields/0/group\): no entry has the group 'bedd'; did you mean 'bed'\?", "--output", "wrong")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        closed_forms(runs)
        timeouts(runs)
        past_ends(runs)
        names(runs)
        errors(runs)
        whole_entries(runs)
        clumps(runs)
        cuts(runs)
        assigned(runs)
        cut_of_a_bed(runs)
        fields(runs)
        one_result(runs)
    print("stages: closed forms, time-outs, errors, one result with interruptions; groups; removal of groups and regions")


if __name__ == "__main__":
    main()
