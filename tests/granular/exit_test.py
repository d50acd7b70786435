#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""hilda-granular reports an error by its exit code and one line on stderr.

    exit_test.py PROGRAM
"""
import json
import os
import re
import resource
import subprocess
import sys
import tempfile

from persistence_test import CASE, Runs, expect


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        here = runs.folder
        short = runs.case("short", end=1e-4, interval=5e-5)

        def refused(code, message, *arguments, case=short, **options):
            err = runs.finish(case, "--quiet", *arguments, code=code, **options)
            lines = err.strip().split("\n")
            expect(len(lines) == 1 and re.search(f"^hilda: error.*{message}", lines[0]), f"{message} in one line: {err}")

        refused(2, "granular: unknown option '--checkpoin'; did you mean '--checkpoint'\\?", "--checkpoin", "1")
        refused(2, "granular: unknown option '--seeds'; did you mean '--seed'\\?", "--seeds=1")
        refused(2, "granular: one argument too many: 'other.json'", "other.json")
        refused(2, "--device: must be cpu, cuda or cuda:N", "--device", "gpu")
        for option, value, message in (
                ("--end", "0", "must be a positive, finite number, got '0'"), ("--step", "-1e-6", "must be a positive, finite number"),
                ("--interval", "nan", "must be a positive, finite number"), ("--every", "nan", "must be a positive, finite number"), ("--end", "1s", "must be a positive, finite number, got '1s'"),
                ("--seed", "-1", "must be a whole number from 0"), ("--seed", "1.5", "must be a whole number from 0"),
                ("--threads", "0", "must be a whole number from 1"), ("--checkpoint", "-1", "must be a finite number, not negative"),
                ("--set", "step=1", "must be /json/pointer=VALUE"), ("--set", "/step", "must be /json/pointer=VALUE"),
                ("--output", "", "must not be empty")):
            refused(2, f"granular: {option}: {message}", option, value)
        for option in ("--end", "1"), ("--set", "/end=1"), ("--seed", "1"), ("--every", "1"), ("--json",), ("--resume",):
            process = subprocess.run([sys.argv[1], "head-on", *option], cwd=here, capture_output=True, text=True)
            expect(process.returncode == 2 and f"granular: {option[0]}: is valid for cases only, but head-on is a validation" in process.stderr,
                   f"{process.returncode}: {process.stderr}")
        refused(2, "--full: is valid for validations only, but short.json is a file", "--full")
        refused(2, "exclude each other", "--force", "--resume")
        refused(2, "--every is the old name of --interval; give only one of them", "--every", "1", "--interval", "1")
        place = r"short.json:1:\d+ \({}\): "
        refused(3, place.format("/laws/0/mu") + r'mu must not be negative, got -1 \(from --set "/laws/0/mu=-1"\)', "--set", "/laws/0/mu=-1")
        refused(3, place.format("/steps") + r'unknown key.*\(from --set "/steps=1"\)', "--set", "/steps=1")
        refused(3, place.format("/laws") + r'--set "/laws/7/mu=1": there is no "7" in a list of 2', "--set", "/laws/7/mu=1")
        refused(3, place.format("/step") + r"step must not be above .*; --force overrides \(from --step 1e-3\)", "--step", "1e-3")
        refused(3, place.format("/end") + r"end must be at most 9e15 steps", "--end", "1e30")
        refused(3, place.format("/end") + r"end must be at least one step, got 1e-08", "--end", "1e-8")
        refused(7, "--device cuda:99: ", "--device", "cuda:99")
        refused(3, "none.json: does not exist", case="none")
        long = "a" * 300 + ".json"
        for name, message in ("", "'': is not the name of a file: "), (long, f"{long}: cannot be read: File name too long"):
            process = subprocess.run([sys.argv[1], name], cwd=here, capture_output=True, text=True)
            expect(process.returncode == 3 and process.stderr.startswith(f"hilda: error: {message}"),
                   f"{process.returncode}: {process.stderr}")
        expect(sorted(file.name for file in here.iterdir()) == ["short.json"], "rejected runs write no files")

        expect(runs.finish(short, "--quiet") == "", "a valid case with --quiet prints nothing")
        expect((here / "out" / "short" / "summary.json").exists(), "the output is in out/NAME")
        refused(2, "out/short: is not empty; --force overwrites it, --resume continues its run")
        (here / "other").mkdir()
        (here / "other" / "letter").write_text("precious")
        refused(2, "other: is not empty", "--output", "other")
        expect((here / "other" / "letter").read_text() == "precious", "existing files are not changed")
        refused(5, "short.json/out", "--output", "short.json/out")

        # options that change entries, and the case.json of the output
        process = runs.start(short, "--output", "set", "--step", "2.5e-6", "--end", "5e-5", "--interval", "2.5e-5", "--seed", "9", "--json", "-v",
                             "--set", "/name=a cup", "--set", "/laws/0/mu=0.5")
        out, err = process.communicate()
        summary = json.loads(out)
        expect(process.returncode == 0 and summary == runs.summary("set"), f"stdout contains the summary only: {out}")
        expect("steps of 2.5e-06 s" in err, f"-v reports the steps: {err}")
        ran = json.loads((here / "set" / "case.json").read_text())
        expect([ran[key] for key in ("name", "step", "end", "interval")] == ["a cup", 2.5e-6, 5e-5, 2.5e-5], f"case.json: {ran}")
        expect(ran["laws"][0]["mu"] == 0.5 and ran["fill"][0]["seed"] == 9, f"case.json: {ran}")
        expect(summary["case"]["set"] == ["/name=a cup", "/laws/0/mu=0.5", "/step=2.5e-06", "/end=5e-05", "/interval=2.5e-05", "/fill/0/seed=9"],
               f"changed entries: {summary}")
        expect(summary["exit_code"] == 0 and summary["counters"] == dict(summary["counters"], steps=20, rows=3), f"counters: {summary}")
        for key in ("version", "git", "build_type", "flags", "compiler", "libraries", "command_line", "cpu", "threads", "device"):
            expect(summary["provenance"].get(key), f"provenance has {key}: {summary}")
        expect(summary["provenance"]["threads"] == 1 and "'/name=a cup'" in summary["provenance"]["command_line"], f"{summary}")
        (here / "again.json").write_text(json.dumps(ran))
        runs.finish("again", "--quiet", "--output", "again")
        expect((here / "again" / "particles.csv").read_bytes() == (here / "set" / "particles.csv").read_bytes(),
               "case.json of the output gives the results of the case with its options")
        runs.finish(short, "--quiet", "--output", "seed", "--end", "5e-5", "--step", "2.5e-6", "--seed", "10")
        expect((here / "seed" / "particles.csv").read_bytes() != (here / "set" / "particles.csv").read_bytes(), "another seed gives other particles")

        # old names of keys and of the option: read, with one notice for each, and written with the new names
        old = {("every" if key == "interval" else key): value for key, value in json.loads((here / "short.json").read_text()).items()}
        (here / "old.json").write_text(json.dumps(old))
        err = runs.finish("old", "--output", "old")
        place = r"hilda: warning: old.json:1:\d+ \(/every\): every was renamed to interval; the old name is still read\n"
        expect(len(re.findall(place, err)) == 1, f"one notice with the place: {err}")
        ran = json.loads((here / "old" / "case.json").read_text())
        expect(list(ran) == list(json.loads((here / "short.json").read_text())) and ran["interval"] == 5e-5, f"case.json has the new names: {ran}")
        runs.finish(short, "--quiet", "--output", "new")
        for name in ("particles.csv", "run.csv"):
            expect((here / "old" / name).read_bytes() == (here / "new" / name).read_bytes(), f"the old names give the same {name}")
        expect(runs.finish("old", "--quiet", "--output", "old", "--force") == "", "--quiet suppresses the notice")
        err = runs.finish(short, "--output", "new", "--force", "--every", "2.5e-5")
        expect("hilda: warning: --every was renamed to --interval; the old name is still read\n" in err, f"notice for the option: {err}")
        expect((here / "new" / "run.csv").read_text().count("\n") == 6, "--every sets the interval")
        err = runs.finish(short, "--output", "new", "--force", "--set", "/every=2.5e-5")
        expect('every was renamed to interval; the old name is still read (from --set "/every=2.5e-5")' in err, f"notice for --set: {err}")
        expect((here / "new" / "run.csv").read_text().count("\n") == 6, "--set /every sets the interval")
        runs.finish("old", "--quiet", "--output", "old", "--force", "--interval", "2.5e-5")
        expect((here / "old" / "run.csv").read_text().count("\n") == 6, "--interval replaces the old name in the file")
        (here / "both.json").write_text(json.dumps(dict(old, interval=5e-5)))
        refused(3, r"both.json:1:\d+ \(/every\): every is the old name of interval, which is given as well; remove one of them", case="both")

        # the watch over a run: its summary, its warnings, and --strict
        watch = summary["watch"]
        expect(watch["samples"] == 3 and not watch["energy"]["passive"] and watch["warnings"] == [] and 0 < watch["largest_displacement"] < 0.1
               and len(watch["momentum"]["impulse"]) == 3, f"the watch: {watch}")
        grain = {"radius": 1e-3, "material": "glass"}
        hits = runs.case("hits", fill=[], gravity=[0, 0, 0], boundaries=[], step=2e-6, end=1e-3, interval=1e-4,
                         particles=[dict(grain, r=[0.008, 0.01, 0.05], v=[2, 0, 0]), dict(grain, r=[0.012, 0.01, 0.05], v=[-2, 0, 0])])
        err = runs.finish(hits, "--output", "hits")
        expect(len(re.findall(r"hilda: warning: t = \S+ s: an overlap of 0.05\d* of the smaller radius is above 0.05", err)) == 1, f"one warning: {err}")
        watch = json.loads((here / "hits" / "summary.json").read_text())["watch"]
        expect(watch["warnings"] == ["overlap_large"] and 0.08 < watch["largest_overlap"] < 0.12 and watch["energy"]["passive"], f"the watch: {watch}")
        refused(4, r"\[overlap_large\]: .*--strict", "--strict", "--output", "strict", case=hits)
        expect(json.loads((here / "strict" / "summary.json").read_text())["status"] == "overlap_large", "the status of a strict run")
        runs.finish(short, "--quiet", "--strict", "--output", "strict", "--force")

        # waiting threads sleep; settings of the user remain
        for given, spins in ({}, "1000"), ({"GOMP_SPINCOUNT": "77"}, "77"):
            environment = {key: value for key, value in os.environ.items() if key not in ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT")}
            process = subprocess.run([sys.argv[1], "short.json", "--output", f"spins{spins}", "--quiet", "--threads", "2"], cwd=here,
                                     capture_output=True, text=True, env=dict(environment, OMP_DISPLAY_ENV="verbose", **given))
            expect(process.returncode == 0 and f"GOMP_SPINCOUNT = '{spins}'" in process.stderr.split("OPENMP DISPLAY ENVIRONMENT END")[-2],
                   f"{process.returncode}: {process.stderr}")
            expect((here / f"spins{spins}" / "particles.csv").read_bytes() == (here / "out" / "short" / "particles.csv").read_bytes(),
                   "the waiting of threads does not change the results")
        # the table of a fill is below the folder of the case, also behind a symbolic link
        (here / "below" / "deeper").mkdir(parents=True)
        for folder in (here, here / "below" / "deeper"):
            (folder / "table.csv").write_text("x,y,z,radius\n0.01,0.01,0.02,1e-3\n")
        (here / "below" / "link.csv").symlink_to(here / "table.csv")
        (here / "below" / "folder").symlink_to(here)
        for k, (path, accepted) in enumerate((("below/deeper/table.csv", True), (f"{here}/below/deeper/table.csv", True),
                                              ("below/../below/deeper/table.csv", True), ("table.csv", False), (f"{here}/table.csv", False),
                                              ("below/../table.csv", False), ("below/link.csv", False), ("below/folder/table.csv", False),
                                              ("/dev/zero", False), ("/etc/passwd", False), ("none.csv", False), ("below/none.csv", None))):
            table = runs.case(f"below/table{k}", end=1e-4, interval=5e-5, fill=[{"type": "csv", "file": path, "material": "glass"}])
            if accepted:
                runs.finish(table, "--quiet", "--output", f"table{k}")
            elif accepted is None:
                refused(3, r"\(/fill/0/file\): below/none.csv: does not exist", case=table)
            else:
                refused(3, rf'\(/fill/0/file\): file must be below the folder of the case, \S+/below, got "{path}"; --allow-paths accepts it', case=table)
                expect(not (here / f"out/table{k}").exists(), "a refused case writes no files")
        runs.finish("below/table3", "--quiet", "--output", "table3", "--allow-paths")
        refused(3, "/dev/zero: is not a regular file", "--allow-paths", case="below/table8")
        process = subprocess.run([sys.argv[1], "head-on", "--allow-paths"], cwd=here, capture_output=True, text=True)
        expect(process.returncode == 2 and "--allow-paths: is valid for cases only" in process.stderr, f"{process.stderr}")

        # a full device behind stdout
        with open("/dev/full", "w") as full:
            for arguments in (["short.json", "--output", "pipe", "--json"], ["head-on"]):
                process = subprocess.run([sys.argv[1], *arguments, "--quiet" if arguments[0] != "head-on" else "--verbose"], cwd=here, stdout=full,
                                         stderr=subprocess.PIPE, text=True, env=runs.environment)
                expect(process.returncode == 5 and "standard output: cannot be written" in process.stderr, f"{process.returncode}: {process.stderr}")

        # standard output on a full disk
        for arguments in (("short.json", "--output", "stdout", "--force", "--json"), ("head-on",)):
            with open("/dev/full", "w") as full:
                process = subprocess.run([sys.argv[1], *arguments], cwd=here, stdout=full, stderr=subprocess.PIPE, text=True,
                                         env=runs.environment)
            expect(process.returncode == 5 and process.stderr.endswith("hilda: error: standard output: cannot be written\n"),
                   f"{process.returncode}: {process.stderr}")

        # a full disk
        process = subprocess.run([sys.argv[1], "short.json", "--output", "full", "--quiet", "--threads", "1"], cwd=here,
                                 capture_output=True, text=True, env=runs.environment,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000)))
        expect(process.returncode == 5 and "File too large" in process.stderr, f"{process.returncode}: {process.stderr}")
        expect(not list((here / "full").rglob("*.tmp")), "incomplete files are deleted")

        # a step above the stability limit is rejected, and accepted with --force
        coarse = runs.case("coarse", step=3e-5, end=3e-5)
        refused(3, r"coarse.json:1:\d+ \(/step\): step must not be above .* got 3e-05; --force", case=coarse)
        expect("warning" in runs.finish(coarse, "--force"), "an unstable step is accepted with --force")

        # lost particles: id, time and velocity
        one = {"r": [0.01, 0.01, 0.05], "radius": 1e-3, "material": "glass"}
        where = r"particle {} {} at t = {}\d* s, with a velocity of \({}\) m/s"
        leaves = runs.case("leaves", fill=[], particles=[one, dict(one, r=[0.01, 0.01, 0.06], v=[0, 0, 2])], gravity=[0, 0, 0], boundaries=CASE["boundaries"][:2])
        refused(4, where.format(1, "has left the domain", "0.01", "0, 0, 2"), case=leaves)
        fast = runs.case("fast", fill=[], particles=[dict(one, v=[0, 0, 500])], gravity=[0, 0, 0], boundaries=CASE["boundaries"][:2])
        refused(4, where.format(0, "moves by more than a cell in one step", "", "0, 0, 500"), "--force", case=fast)
        for name in (leaves, fast):
            summary = json.loads((here / "out" / name / "summary.json").read_text())
            expect(summary["status"] == "particle_lost" and "velocity" in summary["message"], f"{summary}")

        floor = {"name": "floor", "type": "plane", "normal": [0, 0, 1], "v": [0, 0, "sqrt(1e-4-t)"], "material": "steel"}
        refused(4, r"boundary 'floor': v is not finite at t = 0.0001\d* s", case=runs.case("sinks", boundaries=[floor]))
        print("exit codes 0, 2, 3, 4, 5, 7")


if __name__ == "__main__":
    main()
