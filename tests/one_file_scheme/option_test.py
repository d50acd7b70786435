#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An option that a scheme declares, --damping of demo-kick, is an option of the whole program.

    option_test.py PROGRAM
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile


def main():
    program = sys.argv[1]

    def expect(condition, what):
        if not condition:
            sys.exit(f"failed: {what}")

    with tempfile.TemporaryDirectory() as folder:
        here = pathlib.Path(folder)

        def call(*arguments, code=0):
            ended = subprocess.run([program, *arguments], cwd=here, capture_output=True, text=True, check=False)
            expect(ended.returncode == code, f"{arguments}: exit {ended.returncode}, not {code}: {ended.stderr}")
            return ended.stdout if code == 0 else ended.stderr

        def settings(name):
            return json.loads((here / name).read_text())

        # help and lists
        for of in (["run"], ["fit"], ["study"], ["study", "energy"]):
            expect("--damping D" in call("help", *of), f"the help of {of} has the option")
        expect("--damping" not in call("help", "study", "friction"), "a study without integrators does not have it")
        listed = {one["name"]: one["options"] for one in json.loads(call("integrators", "--json"))}
        expect([name for name, options in listed.items() if "--damping" in options] == ["demo-kick"], f"{listed}")

        # accepted for this scheme, refused for the others
        kick = ["run", "double_pendulum", "--integrator", "demo-kick", "--end", "0.2", "--quiet"]
        call(*kick, "--damping", "3", "--checkpoint", "1e-9", "--output", "damped")
        call(*kick, "--output", "plain")
        expect("--damping: must be a finite number, not negative, got '-1'" in call(*kick, "--damping", "-1", code=2), "its check")
        for command in (["run", "double_pendulum"], ["study", "energy", "--integrator", "rA-half-1"]):
            err = call(*command, "--damping", "3", code=2)
            expect(err.endswith("no selected integrator uses --damping; it is for demo-kick\n"), err)
        err = call("study", "friction", "--damping", "3", code=2)
        expect("--damping is for studies of models" in err, err)

        # it acts: the energy of the damped pendulum decreases, and its value is in the summary
        runs = {name: settings(f"{name}/summary.json") for name in ("damped", "plain")}
        expect([runs[name]["integrator"]["damping"] for name in ("damped", "plain")] == [3, 0], "summary.json")
        lost = {name: run["invariants"]["energy_start"] - run["invariants"]["energy_end"] for name, run in runs.items()}
        expect(lost["damped"] > 10 * abs(lost["plain"]) > 0 and math.isfinite(lost["damped"]), f"energy: {lost}")
        call("run", "double_pendulum", "--end", "0.1", "--quiet", "--output", "other")
        expect("damping" not in settings("other/summary.json")["integrator"], "the summary of another integrator")

        # identity of checkpoints
        longer = ["run", "double_pendulum", "--integrator", "demo-kick", "--end", "0.3", "--quiet", "--resume", "--output", "damped"]
        for given, text in ((["--damping", "2"], "--damping 2"), ([], "--damping 0")):
            err = call(*longer, *given, code=2)
            expect("it has --damping 3" in err and text in err, f"another value is another run: {err}")
        call(*longer, "--damping", "3")
        call(*[word if word != "0.2" else "0.3" for word in kick], "--damping", "3", "--output", "whole")
        expect((here / "damped/trajectory.csv").read_bytes() == (here / "whole/trajectory.csv").read_bytes(), "resumed: the same bytes")

        # identity of shards and of an interrupted study, study.json
        study = ["study", "energy", "--problem", "double_pendulum", "--integrator", "demo-kick", "--end", "0.1", "--steps",
                 "1e-2,5e-3", "--quiet", "--no-plot"]
        call(*study, "--damping", "3", "--shard", "1/2", "--output", "s1")
        call(*study, "--damping", "2", "--shard", "2/2", "--output", "s2")
        err = call("collect", "s1", "s2", "--output", "all", "--no-plot", code=2)
        expect("the shards differ in --damping: '3' in s1" in err and "'2' in s2" in err, err)
        call(*study, "--damping", "3", "--shard", "2/2", "--output", "s2", "--force")
        call("collect", "s1", "s2", "--output", "all", "--no-plot")
        expect(settings("all/study.json")["settings"]["damping"] == 3, "study.json")

        # with damping the scheme does not converge to the motion: its order is not the declared one
        order = ["study", "convergence", "--problem", "double_pendulum", "--integrator", "demo-kick", "--steps", "4e-3,2e-3,1e-3",
                 "--end", "0.5", "--quiet", "--no-plot"]
        for damping, below in (("0", False), ("3", True)):
            call(*order, "--damping", damping, "--output", f"order{damping}")
            expect(("and 1 is declared" in (here / f"order{damping}/study.json").read_text()) == below,
                   f"the finding of a study with --damping {damping}")


if __name__ == "__main__":
    main()
