#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Plug-ins outside the source tree take part in runs and studies; wrong ones are refused with exit code 7.

    plugin_test.py PROGRAM FOLDER      FOLDER: every_kind.so, nothing.so, twice.so, undefined.so
"""

import csv
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

program, plugins, tests = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(__file__).resolve().parent.parent
faults = []


def check(passed, text):
    if not passed:
        faults.append(text)


def call(*arguments):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)


def refused(code, words, *arguments):
    ended = call(*arguments)
    check(ended.returncode == code and words in ended.stderr and ended.stderr.count("\n") == 1,
          f"{arguments}: exit {ended.returncode}, expected {code} and '{words}':\n{ended.stderr}")


mine = ["--load", plugins / "every_kind.so"]
with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)

    # every kind of entry
    for command, word in (("integrators", "demo-kick"), ("models", "plugin_pendulum"), ("study", "invariants"),
                          ("schema", '"rope"'), ("schema", '"demo-egg"'), ("schema", '"demo-oil"'),
                          ("schema", '"angular-speed"')):
        listed = call(*mine, command)
        check(listed.returncode == 0 and word in listed.stdout, f"hilda {command}: no {word}\n{listed.stderr}")
        check(word not in call(command).stdout, f"hilda {command} without --load has {word}")

    # a scheme, a joint and a force, a surface and a friction law, a problem, an output, in runs
    for name, run in (("joint", ["run", tests / "one_file_joint/atwood.json", "--step", "1e-3"]),
                      ("surface", ["run", tests / "one_file_contact/egg_on_oil.json", "--step", "1e-4"]),
                      ("scheme", ["run", "plugin_pendulum", "--integrator", "demo-kick", "--momentum", "6"])):
        ended = call(*mine, *run, "--quiet", "--no-plot", "--output", folder / name)
        check(ended.returncode == 0, f"{name}: exit {ended.returncode}\n{ended.stderr}")
    check((folder / "scheme/momentum.csv").exists(), "the output format of the plug-in wrote no file")

    # an output type: (J + m l²) ω²/2 + m g z = 0 for the pendulum, which starts at rest with z = 0
    ended = call(*mine, "run", "plugin_pendulum", "--integrator", "rA-half-2", "--step", "1e-3", "--quiet", "--no-plot", "--set",
                 '/outputs=[{"name": "turn", "type": "angular-speed", "body": "bar"}]', "--output", folder / "output")
    check(ended.returncode == 0, f"output type: exit {ended.returncode}\n{ended.stderr}")
    if ended.returncode == 0:
        with open(folder / "output/outputs.csv", encoding="utf-8") as speeds, \
                open(folder / "output/trajectory.csv", encoding="utf-8") as motion:
            rows = [(float(a["turn.omega"]), float(b["bar.rz"])) for a, b in zip(csv.DictReader(speeds), csv.DictReader(motion))]
        check(len(rows) > 900 and max(omega for omega, _ in rows) > 2.5 and
              max(abs(2.7 / 2 * omega ** 2 + 2 * 9.81 * z) for omega, z in rows) < 1e-3,
              f"output type: the energy is not that of the pendulum, {len(rows)} rows")
    refused(3, "unknown type \"angular-sped\"; did you mean 'angular-speed'?", *mine, "run", "plugin_pendulum", "--set",
            '/outputs=[{"name": "turn", "type": "angular-sped", "body": "bar"}]', "--output", folder / "refused")

    # its scheme has a row in the studies; it is of first order
    for study in ("convergence", "energy", "iterations", "timing", "work-precision"):
        arguments = ["--expect", "order_r=1+-0.1"] if study == "convergence" else []
        steps = "1e-2" if study == "energy" else "4e-3,2e-3,1e-3"
        more = ["--repeats", "1"] if study in ("timing", "work-precision") else []
        ended = call(*mine, "study", study, "--problem", "plugin_pendulum", "--integrator", "rA-half-1,demo-kick",
                     "--steps", steps, "--no-plot", *more, "--output", folder / study)
        check(ended.returncode == 0, f"study {study}: exit {ended.returncode}\n{ended.stderr}")
        with open(folder / study / "study.csv", encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["integrator"] == "demo-kick"]
        check(rows and all(row.get("status", "ok") == "ok" for row in rows), f"study {study}: no row of demo-kick")
    order = call(*mine, "study", "convergence", "--problem", "plugin_pendulum", "--integrator", "demo-kick",
                 "--steps", "4e-3,2e-3,1e-3,5e-4", "--no-plot", "--output", folder / "order", "--expect",
                 "order_r=1+-0.1")
    check(order.returncode == 0, f"order of the scheme of the plug-in:\n{order.stdout}{order.stderr}")

    # its study
    ended = call(*mine, "study", "invariants", "--steps", "1e-2", "--end", "0.1", "--check", "--no-plot", "--output",
                 folder / "invariants")
    check(ended.returncode == 0 and "passed" in ended.stdout, f"study invariants:\n{ended.stderr}")

    # a study or a run that was interrupted continues with the same plug-in only
    changed = folder / "changed.so"
    shutil.copy(plugins / "every_kind.so", changed)
    energy = ["study", "energy", "--problem", "plugin_pendulum", "--integrator",
              "demo-kick,rA-half-1,rA-half-2,rA-half-1-kick,rA-rattle,rA-rkmk-4", "--steps", "1e-5", "--end", "3",
              "--jobs", "1", "--no-plot", "--quiet", "--output", folder / "part"]
    run = ["run", "plugin_pendulum", "--integrator", "demo-kick", "--step", "1e-5", "--end", "20", "--quiet",
           "--output", folder / "cut"]
    begun = {"part": folder / "part/study.part", "cut": folder / "cut/model.json"}
    for name, command in (("part", energy), ("cut", run)):
        process = subprocess.Popen([program, "--load", str(changed), *map(str, command)],
                                   stderr=subprocess.DEVNULL)
        while process.poll() is None and (not begun[name].exists() or begun[name].stat().st_size == 0):
            time.sleep(0.001)
        first = begun[name].stat().st_size  # of a study: what its rows depend on
        time.sleep(0.05)
        while name == "part" and process.poll() is None and begun[name].stat().st_size == first:
            time.sleep(0.001)
        process.send_signal(signal.SIGINT)
        check(process.wait() == 130, f"{name} is not interrupted: {process.returncode}")
    with open(changed, "ab") as file:
        file.write(b"\0")
    for name, command in (("part", energy), ("cut", run)):
        refused(2, "changed.so (", "--load", changed, *command, "--resume")
    refused(2, "the same plug-ins (--load)", "--load", changed, *energy, "--resume")
    shutil.copy(plugins / "every_kind.so", changed)
    for name, command in (("part", energy), ("cut", run)):
        ended = call("--load", changed, *command, "--resume")
        check(ended.returncode == 0, f"{name} does not continue: {ended.returncode}\n{ended.stderr}")

    # a result with a plug-in is repeated with the same plug-in only
    ended = call(*mine, "run", "plugin_pendulum", "--integrator", "demo-kick", "--end", "0.01", "--quiet", "--output",
                 folder / "once")
    check(ended.returncode == 0, f"run to be repeated:\n{ended.stderr}")
    refused(2, "whose code would be executed", "rerun", folder / "once")
    ended = call(*mine, "rerun", folder / "once")
    check(ended.returncode == 0, f"rerun with a plug-in: {ended.returncode}\n{ended.stdout}{ended.stderr}")

    # wrong plug-ins
    other = folder / "other.so"
    whole = (plugins / "every_kind.so").read_bytes()
    at = whole.index(b"hilda plug-in interface: ") + len(b"hilda plug-in interface: ")
    other.write_bytes(whole[:at] + b"9" + whole[at + 1:])
    text = folder / "text.so"
    text.write_text("no library", encoding="utf-8")
    broken = folder / "broken.so"
    broken.write_bytes(whole[at - 100:at + 200])
    refused(7, "is built for hilda 9", "--load", other, "models")
    refused(7, "registers nothing", "--load", plugins / "nothing.so", "models")
    refused(7, "throws while it is loaded: two entries", "--load", plugins / "twice.so", "models")
    refused(7, "undefined symbol", "--load", plugins / "undefined.so", "models")
    refused(7, "is not a plug-in of hilda", "--load", text, "models")
    refused(7, "cannot be loaded", "--load", broken, "models")
    refused(7, "missing.so", "--load", folder / "missing.so", "models")
    refused(7, "is loaded already", *mine, *mine, "models")
    refused(2, "--load goes before the command", "models", *mine)
    refused(2, "needs a FILE", "--load")

for fault in faults:
    print(fault)
sys.exit(1 if faults else 0)
