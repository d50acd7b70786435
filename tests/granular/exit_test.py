#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""hilda-granular reports a wrong argument, a wrong entry and a failed run by its exit code and one line on stderr.

    exit_test.py PROGRAM
"""
import json
import sys
import tempfile

from case_runs import CASE, Runs, expect

POSITIVE = "must be a positive, finite number"


def arguments(runs, case):
    """Wrong options and their values: exit code 2"""
    def refused(message, *given):
        runs.refused(case, 2, message, *given)

    refused("granular: unknown option '--checkpoin'; did you mean '--checkpoint'\\?", "--checkpoin", "1")
    refused("granular: unknown option '--seeds'; did you mean '--seed'\\?", "--seeds=1")
    refused("granular: one argument too many: 'other.json'", "other.json")
    refused("--device: must be cpu, cuda or cuda:N", "--device", "gpu")
    for option, value, message in (
            ("--end", "0", f"{POSITIVE}, got '0'"), ("--end", "1s", f"{POSITIVE}, got '1s'"),
            ("--step", "-1e-6", POSITIVE), ("--interval", "nan", POSITIVE),
            ("--every", "nan", POSITIVE), ("--seed", "-1", "must be a whole number from 0"),
            ("--seed", "1.5", "must be a whole number from 0"), ("--threads", "0", "must be a whole number from 1"),
            ("--checkpoint", "-1", "must be a finite number, not negative"),
            ("--set", "step=1", "must be /json/pointer=VALUE"), ("--set", "/step", "must be /json/pointer=VALUE"),
            ("--output", "", "must not be empty")):
        refused(f"granular: {option}: {message}", option, value)
    refused("--full: is valid for validations only, but short.json is a file", "--full")
    refused("exclude each other", "--force", "--resume")
    refused("--every is the old name of --interval; give only one of them", "--every", "1", "--interval", "1")
    for option in (("--end", "1"), ("--set", "/end=1"), ("--seed", "1"), ("--every", "1"), ("--json",), ("--resume",),
                   ("--allow-paths",)):
        ended = runs.run("head-on", *option)
        message = f"granular: {option[0]}: is valid for cases only, but head-on is a validation"
        expect(ended.returncode == 2 and message in ended.stderr, f"{ended.returncode}: {ended.stderr}")


def texts(runs):
    """Options that print a text, and arguments that are missing or unknown"""
    for option, start, contained in (("--help", "hilda-granular: runs a granular case or a validation\n",
                                      "Exit codes: 0 done, 1 internal"), ("--version", "hilda-granular ", "git ")):
        ended = runs.run(option)
        expect(ended.returncode == 0 and ended.stderr == "" and ended.stdout.startswith(start)
               and contained in ended.stdout, f"{option}: {ended.returncode}: {ended.stdout}{ended.stderr}")
    for given, code, message in (
            ((), 2, "granular: CASE is required"),
            (("--sedd", "1"), 2, "granular: unknown option '--sedd'; did you mean '--seed'?"),
            (("none",), 3, "none: does not exist; validations: brick, comparison-drum, comparison-penetration, comparison-silo, cratering, drum, head-on, hopper, low-velocity-cratering, oblique, repose, shear, stacking, waves, wheel; "
                          "cases: bed, fed_hopper, settle_push_load, shaken_box")):
        ended = runs.run(*given)
        expect(ended.returncode == code and ended.stderr == f"hilda: error: {message}\n",
               f"{given}: {ended.returncode}: {ended.stderr}")


def entries(runs, case):
    """Wrong entries of the case and of the options that change it: exit code 3, with the place"""
    def refused(pointer, message, *given):
        runs.refused(case, 3, rf"short.json:1:\d+ \({pointer}\): {message}", *given)

    refused("/laws/0/mu", r'mu must not be negative, got -1 \(from --set "/laws/0/mu=-1"\)', "--set", "/laws/0/mu=-1")
    refused("/steps", r'unknown key.*\(from --set "/steps=1"\)', "--set", "/steps=1")
    refused("/laws", r'--set "/laws/7/mu=1": there is no "7" in a list of 2', "--set", "/laws/7/mu=1")
    refused("/step", r"step must not be above .*; --accept-step accepts it \(from --step 1e-3\)", "--step", "1e-3")
    refused("/end", r"end must be at most 9e15 steps", "--end", "1e30")
    refused("/end", r"end must be at least one step, got 1e-08", "--end", "1e-8")
    runs.refused("none", 3, "none.json: does not exist")
    long = "a" * 300 + ".json"
    for name, message in ("", "'': is not the name of a file: "), (long, f"{long}: cannot be read: File name too long"):
        ended = runs.run(name)
        expect(ended.returncode == 3 and ended.stderr.startswith(f"hilda: error: {message}"),
               f"{ended.returncode}: {ended.stderr}")

    coarse = runs.case("coarse", step=3e-5, end=3e-5)
    runs.refused(coarse, 3, r"coarse.json:1:\d+ \(/step\): step must not be above .* got 3e-05; --accept-step")
    expect("warning" in runs.finish(coarse, "--accept-step"), "an unstable step is accepted with --accept-step")


def failures(runs):
    """Lost particles and motions of boundaries that are not finite: exit code 4"""
    one = {"r": [0.01, 0.01, 0.05], "radius": 1e-3, "material": "glass"}
    space = {"fill": [], "gravity": [0, 0, 0], "boundaries": CASE["boundaries"][:2]}
    lost = r"particle {} {} at t = {}\d* s, with a velocity of \({}\) m/s"
    leaves = runs.case("leaves", particles=[one, dict(one, r=[0.01, 0.01, 0.06], v=[0, 0, 2])], **space)
    runs.refused(leaves, 4, lost.format(1, "has left the domain", "0.01", "0, 0, 2"))
    fast = runs.case("fast", particles=[dict(one, v=[0, 0, 500])], **space)
    runs.refused(fast, 4, lost.format(0, "moves by more than a cell in one step", "", "0, 0, 500"), "--force")
    for name in (leaves, fast):
        summary = json.loads((runs.folder / "out" / name / "summary.json").read_text())
        expect(summary["status"] == "particle_lost" and "velocity" in summary["message"], f"{summary}")

    tool = {"name": "shoe", "type": "sphere", "radius": 1e-3, "r": [0.01, 0.01, 0.05], "mass": 1e-3, "material": "steel"}
    falls = runs.case("falls", boundaries=[CASE["boundaries"][0], tool], fill=[], particles=[dict(one, r=[0.01, 0.018, 0.001])])
    left = r"boundary 'shoe' has left the domain at \(0.01, 0.01, -0.002\d*\) m: boundaries do not touch each other, .*, at t = 0.10\d* s"
    runs.refused(falls, 4, left)
    summary = json.loads((runs.folder / "out" / falls / "summary.json").read_text())
    expect(summary["status"] == "tool_left" and "(/boundaries/1): nothing holds boundary 'shoe' above 'floor'" in summary["case"]["warnings"][0],
           f"{summary}")
    rises = runs.case("rises", boundaries=[CASE["boundaries"][0], dict(tool, v=[0, 0, 2], F=[0, 0, 0.1])], fill=[], end=0.05,
                      particles=[dict(one, r=[0.01, 0.018, 0.001])])
    expect("warning: t = 0.01" in (err := runs.finish(rises, "--output", "rises")) and "boundary 'shoe' has left the domain" in err, err)
    runs.refused(rises, 4, "boundary 'shoe' has left the domain .*(a warning, with --strict)", "--strict")

    floor = {"name": "floor", "type": "plane", "normal": [0, 0, 1], "v": [0, 0, "sqrt(1e-4-t)"], "material": "steel"}
    runs.refused(runs.case("sinks", boundaries=[floor]), 4, r"boundary 'floor': v is not finite at t = 0.0001\d* s")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        short = runs.case("short", end=1e-4, interval=5e-5)
        arguments(runs, short)
        texts(runs)
        runs.refused(short, 7, "--device cuda:99: ", "--device", "cuda:99")
        expect([file.name for file in runs.folder.iterdir()] == ["short.json"], "rejected runs write no files")
        entries(runs, short)
        failures(runs)
    print("exit codes 0, 2, 3, 4, 7")


if __name__ == "__main__":
    main()
