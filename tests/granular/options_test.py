#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Options of hilda-granular: changed entries of the case, old names, --resume, --strict, and waiting threads.

    options_test.py PROGRAM
"""
import json
import os
import re
import sys
import tempfile

from case_runs import Runs, expect


def changed_entries(runs, case):
    """Options that change entries, and the case.json of the output"""
    process = runs.start(case, "--output", "set", "--step", "2.5e-6", "--end", "5e-5", "--interval", "2.5e-5",
                         "--seed", "9", "--json", "-v", "--set", "/name=a cup", "--set", "/laws/0/mu=0.5")
    out, err = process.communicate()
    summary = json.loads(out)
    expect(process.returncode == 0 and summary == runs.summary("set"), f"stdout contains the summary only: {out}")
    expect("steps of 2.5e-06 s" in err, f"-v reports the steps: {err}")
    ran = json.loads((runs.folder / "set" / "case.json").read_text())
    expect([ran[key] for key in ("name", "step", "end", "interval")] == ["a cup", 2.5e-6, 5e-5, 2.5e-5], f"{ran}")
    expect(ran["laws"][0]["mu"] == 0.5 and ran["fill"][0]["seed"] == 9, f"case.json: {ran}")
    changes = ["/name=a cup", "/laws/0/mu=0.5", "/step=2.5e-06", "/end=5e-05", "/interval=2.5e-05", "/fill/0/seed=9"]
    expect(summary["case"]["set"] == changes, f"changed entries: {summary}")
    counters = summary["counters"]
    expect(summary["exit_code"] == 0 and counters["steps"] == 20 and counters["rows"] == 3, f"{summary}")
    provenance = summary["provenance"]
    for key in ("version", "git", "build_type", "flags", "compiler", "libraries", "command_line", "cpu", "threads",
                "device"):
        expect(provenance.get(key), f"provenance has {key}: {summary}")
    expect(provenance["threads"] == 1 and "'/name=a cup'" in provenance["command_line"], f"{summary}")

    (runs.folder / "again.json").write_text(json.dumps(ran))
    runs.finish("again", "--quiet", "--output", "again")
    particles = (runs.folder / "set" / "particles.csv").read_bytes()
    expect((runs.folder / "again" / "particles.csv").read_bytes() == particles,
           "case.json of the output gives the results of the case with its options")
    runs.finish(case, "--quiet", "--output", "seed", "--end", "5e-5", "--step", "2.5e-6", "--seed", "10")
    expect((runs.folder / "seed" / "particles.csv").read_bytes() != particles, "another seed gives other particles")
    return summary


def old_names(runs, case):
    """Old names of keys and of the option: read with one notice for each, and written with the new names"""
    here = runs.folder
    new = json.loads((here / "short.json").read_text())
    old = {("every" if key == "interval" else key): value for key, value in new.items()}
    (here / "old.json").write_text(json.dumps(old))
    err = runs.finish("old", "--output", "old")
    notice = r"hilda: warning: old.json:1:\d+ \(/every\): every was renamed to interval; the old name is still read\n"
    expect(len(re.findall(notice, err)) == 1, f"one notice with the place: {err}")
    ran = json.loads((here / "old" / "case.json").read_text())
    expect(list(ran) == list(new) and ran["interval"] == 5e-5, f"case.json has the new names: {ran}")
    runs.finish(case, "--quiet", "--output", "new")
    for name in ("particles.csv", "run.csv"):
        expect((here / "old" / name).read_bytes() == (here / "new" / name).read_bytes(), f"both names give one {name}")
    expect(runs.finish("old", "--quiet", "--output", "old", "--force") == "", "--quiet suppresses the notice")

    def rows(output):
        return (here / output / "run.csv").read_text().count("\n")

    err = runs.finish(case, "--output", "new", "--force", "--every", "2.5e-5")
    expect("hilda: warning: --every was renamed to --interval; the old name is still read\n" in err, f"notice: {err}")
    expect(rows("new") == 6, "--every sets the interval")
    err = runs.finish(case, "--output", "new", "--force", "--set", "/every=2.5e-5")
    expect('every was renamed to interval; the old name is still read (from --set "/every=2.5e-5")' in err, f"{err}")
    expect(rows("new") == 6, "--set /every sets the interval")
    runs.finish("old", "--quiet", "--output", "old", "--force", "--interval", "2.5e-5")
    expect(rows("old") == 6, "--interval replaces the old name in the file")
    (here / "both.json").write_text(json.dumps(dict(old, interval=5e-5)))
    runs.refused("both", 3, r"both.json:1:\d+ \(/every\): every is the old name of interval, which is given as well; "
                            "remove one of them")


def resume(runs, case, particles):
    """--resume without a checkpoint, and after the end of the run"""
    err = runs.finish(case, "--output", "never", "--resume")
    expect("hilda: warning: never: has no checkpoint; starting from the initial state\n" in err, f"{err}")
    expect((runs.folder / "never" / "particles.csv").read_bytes() == particles, "it is the whole run")
    process = runs.start(case, "--output", "never", "--resume", "--quiet", "--json")
    out, err = process.communicate()
    expect(process.returncode == 0 and err == "" and json.loads(out) == runs.summary("never"),
           f"the summary of the complete run: {out} {err}")


def strict(runs, case, watch):
    """The watch over a run: its summary, its warnings, and --strict"""
    # 20 steps with a row every 10 steps: the first sample only
    expect(watch["samples"] == 1 and not watch["energy"]["passive"] and watch["warnings"] == []
           and 0 < watch["largest_displacement"] < 0.1 and len(watch["momentum"]["impulse"]) == 3,
           f"the watch: {watch}")
    grain = {"radius": 1e-3, "material": "glass"}
    hits = runs.case("hits", fill=[], gravity=[0, 0, 0], boundaries=[], step=2e-6, end=1e-3, interval=1e-4,
                     particles=[dict(grain, r=[0.008, 0.01, 0.05], v=[2, 0, 0]),
                                dict(grain, r=[0.012, 0.01, 0.05], v=[-2, 0, 0])])
    err = runs.finish(hits, "--output", "hits")
    # 500 steps with a row every 50 steps: the first, in every 128th, and in the last before every 100th
    expect(runs.summary("hits")["watch"]["samples"] == 1 + 3 + 5, "number of samples")
    warning = r"hilda: warning: t = \S+ s: an overlap of 0.05\d* of the smaller radius is above 0.05"
    expect(len(re.findall(warning, err)) == 1, f"one warning: {err}")
    watch = runs.summary("hits")["watch"]
    expect(watch["warnings"] == ["overlap_large"] and 0.08 < watch["largest_overlap"] < 0.12
           and watch["energy"]["passive"], f"the watch: {watch}")
    runs.refused(hits, 4, r"\[overlap_large\]: .*--strict", "--strict", "--output", "strict")
    expect(runs.summary("strict")["status"] == "overlap_large", "the status of a strict run")
    runs.finish(case, "--quiet", "--strict", "--output", "strict", "--force")


def waiting_threads(runs, particles):
    """Waiting threads sleep; settings of the user remain"""
    kept = {key: value for key, value in os.environ.items() if key not in ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT")}
    for given, spins in ({}, "3000"), ({"GOMP_SPINCOUNT": "77"}, "77"):
        output = f"spins{spins}"
        ended = runs.run("short.json", "--output", output, "--quiet", "--threads", "2",
                         env=dict(kept, OMP_DISPLAY_ENV="verbose", **given))
        settings = ended.stderr.split("OPENMP DISPLAY ENVIRONMENT END")[-2]
        expect(ended.returncode == 0 and f"GOMP_SPINCOUNT = '{spins}'" in settings,
               f"{ended.returncode}: {ended.stderr}")
        expect((runs.folder / output / "particles.csv").read_bytes() == particles,
               "the waiting of threads does not change the results")


def wrong_instruction_set(runs, case):
    """A wrong HILDA_ISA: a run is refused, and --version, which a bug report contains, names it"""
    wrong = dict(env=dict(runs.environment, HILDA_ISA="nonsense"))
    refused = runs.run(f"{case}.json", "--output", "isa", **wrong)
    expect(refused.returncode == 2 and "HILDA_ISA: must be" in refused.stderr and "got 'nonsense'" in refused.stderr, f"{refused}")
    version = runs.run("--version", **wrong)
    expect(version.returncode == 0 and "vector instructions: HILDA_ISA: must be" in version.stdout, f"{version}")


def list_of_laws(runs):
    """The list as JSON has the laws of the text."""
    laws, text = json.loads(runs.run("laws", "--json").stdout), runs.run("laws").stdout
    expect(len(laws) > 10 and all(set(law) == {"kind", "name", "description", "is_default"} for law in laws), f"{laws}")
    expect(all(law["name"] in text for law in laws) and sum(law["is_default"] for law in laws) == len({law["kind"] for law in laws}),
           f"one default of each kind: {laws}")
    refused = runs.run("cases", "--json")
    expect(refused.returncode == 2 and "--json: is valid for cases only" in refused.stderr, refused.stderr)


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(sys.argv[1], folder)
        short = runs.case("short", end=1e-4, interval=5e-5)
        expect(runs.finish(short, "--quiet") == "", "a valid case with --quiet prints nothing")
        summary = changed_entries(runs, short)
        old_names(runs, short)
        particles = (runs.folder / "out" / "short" / "particles.csv").read_bytes()
        resume(runs, short, particles)
        strict(runs, short, summary["watch"])
        waiting_threads(runs, particles)
        wrong_instruction_set(runs, short)
        list_of_laws(runs)
    print("changed entries, old names, --resume, --strict, waiting threads, a wrong instruction set and the list of laws")


if __name__ == "__main__":
    main()
