#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 25: all commands that read and write files, on bad disks, with bad descriptors, links and damaged inputs.

For check, run, resume, kinematics, inverse, fit, cosim, granular, study, collect, plot, view, rerun, import and export:

    plain        exit code 0
    descriptors  with 0, 1, 2 or all of them closed, and with /dev/full as stdout: the same tables, or an error
    disk         disks of 0 to 256 KiB (tmpfs): exit code 5 and one line, or the whole result; no temporary is left
    folder       a folder that cannot be written: exit code 5 and one line
    links        a link to another file in the place of each file of the result: the other file is unchanged
    inputs       each input missing, empty, cut, doubled, of other bytes, a pipe, a folder, unreadable: an error within 5 s, or
                 the result

and cosim with each transport is killed at random times and resumed; runs whose tables are removed end or go on.
"""
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import time

import matrix

PIN = {"type": "revolute", "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]}
ARM = {"hilda_model": 1, "name": "arm", "gravity": [0, 0, -9.81], "end": 0.2,
       "bodies": [{"name": "upper", "mass": 1, "inertia": [0.1, 0.1, 0.01], "r": [0.5, 0, 0]},
                  {"name": "lower", "mass": 1, "inertia": [0.1, 0.1, 0.01], "r": [1.5, 0, 0]}],
       "constraints": [dict(PIN, name="shoulder", body_i="ground", body_j="upper", s_bar_q_j=[-0.5, 0, 0]),
                       dict(PIN, name="elbow", body_i="upper", body_j="lower", s_bar_p_i=[0.5, 0, 0], s_bar_q_j=[-0.5, 0, 0])],
       "forces": [{"type": "torsion-spring", "name": "spring", "body_i": "upper", "body_j": "lower", "axis_bar_i": [0, 1, 0],
                   "axis_bar_j": [0, 1, 0], "stiffness": 5, "free_angle": 0}],
       "outputs": [{"type": "angle", "name": "bend", "body_i": "upper", "body_j": "lower", "axis_bar_i": [0, 1, 0],
                    "axis_bar_j": [0, 1, 0]}]}
DRIVER = {"type": "hinge-driver", "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0], "angle": "sin(t)"}
DRIVEN = dict(ARM, name="driven", constraints=ARM["constraints"] + [
    dict(DRIVER, name="first", body_i="ground", body_j="upper"), dict(DRIVER, name="second", body_i="upper", body_j="lower")])
BED = {"hilda_case": 1, "name": "bed", "domain": {"low": [-0.02, -0.02, -0.01], "high": [0.02, 0.02, 0.05]}, "step": 1e-5,
       "end": 0.01, "interval": 1e-3, "materials": [{"name": "glass", "density": 2500, "E": 1e7, "nu": 0.24}],
       "laws": [{"restitution": 0.7, "mu": 0.3, "tangential": {"law": "mindlin"}}],
       "boundaries": [{"name": "box", "type": "box", "low": [-0.01, -0.01, 0], "high": [0.01, 0.01, 0.04], "open": ["+z"]},
                      {"name": "ball", "type": "sphere", "radius": 0.004, "r": [0, 0, 0.02]}],
       "fill": [{"type": "lattice", "low": [-0.01, -0.01, 0], "high": [0.01, 0.01, 0.008], "radius": 1e-3, "spacing": 1.03}]}
BALL = {"hilda_model": 1, "name": "falling", "gravity": [0, 0, -9.81], "end": 0.01,
        "bodies": [{"name": "ball", "density": 7800, "shape": {"sphere": 0.004}, "r": [0, 0, 0.02]}]}
COSIM = {"hilda_cosim": 1, "name": "drop", "model": "ball.json", "case": "bed.json", "substeps": 10, "end": 0.01,
         "interval": 1e-3, "pairs": [{"body": "ball"}]}
URDF = """<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.5 0 0"/><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
</inertial></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint></robot>
"""
MJCF = """<mujoco model="arm"><worldbody><body name="upper"><joint name="shoulder" type="hinge" axis="0 1 0"/>
<inertial pos="0.5 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body></worldbody></mujoco>
"""

STUDY = ["study", "energy", "--problem", "double_pendulum", "--integrator", "rA-half-1", "--steps", "1e-2,5e-3", "--end", "0.2",
         "--no-plot", "--quiet"]
# name: the command, its inputs, and the folder {} of its output: `new`, `empty`, or a result that is `begun` or `done`; None: no output
COMMANDS = {
    "check": (["check", "arm.json"], ["arm.json"], None),
    "run": (["run", "arm.json", "--reactions", "--quiet", "--output", "{}", "--force"], ["arm.json"], "new"),
    "resume": (["run", "arm.json", "--end", "0.4", "--quiet", "--resume", "--output", "{}"], ["arm.json", "{}/checkpoint.end"], "begun"),
    "kinematics": (["kinematics", "driven.json", "--fix-initial", "--quiet", "--output", "{}", "--force"], ["driven.json"], "new"),
    "inverse": (["inverse", "driven.json", "--fix-initial", "--quiet", "--output", "{}", "--force"], ["driven.json"], "new"),
    "fit": (["fit", "arm.json", "--data", "data.csv", "--parameter", "/forces/0/stiffness=4", "--column", "bend.angle", "--step", "1e-3",
             "--no-plot", "--quiet", "--output", "{}", "--force"], ["arm.json", "data.csv"], "new"),
    "cosim": (["cosim", "drop.json", "--quiet", "--output", "{}", "--force"], ["drop.json", "ball.json", "bed.json"], "new"),
    "granular": (["granular", "bed.json", "--quiet", "--output", "{}", "--force"], ["bed.json"], "new"),
    "study": ([*STUDY, "--output", "{}", "--force"], [], "new"),
    "collect": (["collect", "s1", "s2", "--no-plot", "--output", "{}", "--force"], ["s1/study.shard", "s2/study.shard"], "new"),
    "plot": (["plot", "{}"], ["{}/trajectory.csv", "{}/summary.json"], "done"),
    "view": (["view", "{}"], ["{}/trajectory.csv", "{}/summary.json", "{}/model.json"], "done"),
    "rerun": (["rerun", "done", "--output", "{}"], ["done/summary.json", "done/trajectory.csv"], "new"),
    "import": (["import", "arm.urdf", "--output", "{}/a.json", "--force"], ["arm.urdf"], "empty"),
    "import MJCF": (["import", "arm.xml", "--output", "{}/a.json", "--force"], ["arm.xml"], "empty"),
    "export": (["export", "tree.json", "--output", "{}/a.urdf", "--force"], ["tree.json"], "empty"),
}
IN_NAMESPACE = ["unshare", "--mount", "--map-root-user", "sh", "-c"]
# The codes of errors of the user's side
REFUSED = (2, 3, 5, 7)


def prepare(row, folder):
    """The inputs of all commands, and the results that some of them read"""
    tree = {key: value for key, value in ARM.items() if key not in ("outputs", "forces")}
    for name, content in (("arm", ARM), ("driven", DRIVEN), ("tree", tree), ("bed", BED), ("ball", BALL), ("drop", COSIM)):
        (folder / f"{name}.json").write_text(json.dumps(content))
    (folder / "arm.urdf").write_text(URDF)
    (folder / "arm.xml").write_text(MJCF)
    for words in (["run", "arm.json", "--quiet", "--output", "done"],
                  ["run", "arm.json", "--quiet", "--checkpoint", "1e-9", "--output", "begun"],
                  [*STUDY, "--shard", "1/2", "--output", "s1"], [*STUDY, "--shard", "2/2", "--output", "s2"]):
        ended = row.run([row.hilda, *words], cwd=folder)
        if ended.code != 0:
            raise SystemExit(f"{words}: {ended.err}")
    lines = (folder / "done/outputs.csv").read_text().split("\n")
    (folder / "data.csv").write_text("\n".join([lines[0], *lines[1::10]]) + "\n")


class Scene:
    """A copy of the prepared folder for one case"""

    def __init__(self, row, prepared, parent, name):
        self.row, self.folder = row, parent / "case"
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(prepared, self.folder, symlinks=True)
        words, inputs, of = COMMANDS[name]
        self.output = of if of in ("begun", "done") else "out"
        if of == "empty":
            (self.folder / "out").mkdir()
        self.command = [row.hilda, *self.filled(words)]
        self.inputs = self.filled(inputs)

    def filled(self, words):
        return [word.replace("{}", self.output) for word in words]

    def run(self, *before, **options):
        return self.row.run([*before, *self.command], cwd=self.folder, limit=60, **{"stdin": subprocess.DEVNULL, **options})

    def result(self):
        """The files of the output, by name; tables with their bytes, others without"""
        found = {}
        root = self.folder / self.output
        for file in sorted(root.rglob("*")):
            if file.is_file():
                # JSON, pages and the table of a study have times and paths
                exact = file.suffix == ".csv" and file.name not in ("events.csv", "study.csv", "fit.csv")
                found[str(file.relative_to(root))] = file.read_bytes() if exact else None
        return found

    def temporaries(self):
        return [str(file) for file in self.folder.rglob("*.tmp*")]


def same(one, other):
    return all(other.get(name, 0) == content for name, content in one.items())


def is_error(ended, codes=REFUSED):
    lines = [line for line in ended.err.strip().split("\n") if line.startswith("hilda")]
    return ended.code in codes and len(lines) >= 1 and "Traceback" not in ended.err


def descriptors(row, scene, name, whole):
    closed = {0: "<&-", 1: ">&-", 2: "2>&-"}
    for which in ((0,), (1,), (2,), (0, 1, 2), (1, 2)):
        s = scene()
        ended = s.run("sh", "-c", f'exec "$@" {" ".join(closed[one] for one in which)}', "sh")
        fine = same(whole, s.result()) if ended.code == 0 else ended.code in REFUSED
        row.case(f"{name}: descriptors {which} closed", fine, f"exit {ended.code}: {ended.err}")
    s = scene()
    ended = s.run("sh", "-c", 'exec "$@" >/dev/full', "sh")
    fine = same(whole, s.result()) if ended.code == 0 else ended.code == 5
    row.case(f"{name}: stdout is full", fine, f"exit {ended.code}: {ended.err}")


def disks(row, scene, name, whole):
    for size in ("0", "4k", "16k", "64k", "256k")[name == "rerun":]:  # its folder must be empty
        s = scene()
        target = s.folder / s.output
        kept = s.folder / "kept"
        if target.exists():
            target.rename(kept)
        target.mkdir()
        # The output is the disk itself: tmpfs has no page for `0`, so it is 4 KiB filled by a file.
        fill = f"cp -r kept/. {s.output}/ 2>/dev/null || exit 99; " if kept.exists() else ""
        block = f"head -c 4096 /dev/zero > {s.output}/.fill; " if size == "0" else ""
        script = (f'mount -t tmpfs -o size={"4k" if size == "0" else size} none {s.output} || exit 98; {fill}{block}"$@"; code=$?; '
                  f'find {s.output} -name "*.tmp*" | sed "s/^/left: /"; exit $code')
        ended = s.run(*IN_NAMESPACE, script, "sh")
        if ended.code == 99:
            continue
        clean = "left:" not in ended.out
        row.case(f"{name}: disk of {size}", clean and (ended.code == 0 or is_error(ended, (5,))), f"exit {ended.code}: {ended.out[-200:]} {ended.err}")
    s = scene()
    (s.folder / s.output).mkdir(exist_ok=True)
    script = f'mount --bind {s.output} {s.output} && mount -o remount,ro,bind {s.output} && exec "$@"'
    ended = s.run(*IN_NAMESPACE, script, "sh")
    row.case(f"{name}: read-only", is_error(ended, (5,)), f"exit {ended.code}: {ended.err}")


def links(row, scene, name, whole):
    if COMMANDS[name][2] == "empty":
        return  # the user names the file, and a link there is followed
    for file in whole:
        s = scene()
        (s.folder / "precious").write_text("precious")
        place = s.folder / s.output / file
        place.parent.mkdir(parents=True, exist_ok=True)
        if file in s.inputs or f"{s.output}/{file}" in s.inputs:
            continue
        place.unlink(missing_ok=True)
        place.symlink_to(s.folder / "precious")
        ended = s.run()
        kept = (s.folder / "precious").read_text() == "precious"
        row.case(f"{name}: link {file}", kept and ended.code >= 0, f"exit {ended.code}, kept {kept}: {ended.err}")


def damage(file, how, rng):
    content = file.read_bytes()
    file.unlink()
    if how == "empty":
        file.write_bytes(b"")
    elif how == "cut":
        file.write_bytes(content[:len(content) // 2])
    elif how == "doubled":
        file.write_bytes(content + content)
    elif how == "bytes":
        file.write_bytes(bytes(rng.randrange(256) for _ in range(len(content))))
    elif how == "zeros":
        file.write_bytes(bytes(len(content)))
    elif how == "pipe":
        os.mkfifo(file)
    elif how == "folder":
        file.mkdir()
    elif how == "device":
        file.symlink_to("/dev/zero")
    elif how == "loop":
        file.symlink_to(file.name)


def inputs(row, scene, name, whole):
    rng = random.Random(name)
    for number in range(len(COMMANDS[name][1])):
        for how in ("missing", "empty", "cut", "doubled", "bytes", "zeros", "pipe", "folder", "device", "loop"):
            s = scene()
            damage(s.folder / s.inputs[number], how, rng)
            begin = matrix.now()
            ended = s.run()
            seconds = matrix.now() - begin
            # rerun compares with the damaged tables; a view or a plot may not need the file
            fine = ended.code in (0, 6) or is_error(ended)
            row.case(f"{name}: {s.inputs[number]} {how}", fine and seconds < 30 and not s.temporaries(),
                     f"exit {ended.code}, {seconds:.1f} s, {s.temporaries()}: {ended.err}")


def kills_of_cosim(row, prepared, parent):
    for transport in ("in-process", "pipe", "mpi"):
        scene = Scene(row, prepared, parent, "cosim")
        more = ["--transport", transport, "--checkpoint", "0.05"]
        ended = row.run([*scene.command, *more], cwd=scene.folder)
        if ended.code != 0:
            row.case(f"cosim {transport}", ended.code == 2 and "--transport" in ended.err, ended.err)
            continue
        whole = scene.result()
        rng = random.Random(transport)
        for kill in range(5):
            scene = Scene(row, prepared, parent, "cosim")
            row.killed_after([*scene.command, *more], rng.uniform(0.02, 0.6), cwd=scene.folder)
            again = [word for word in scene.command if word != "--force"] + more
            ended = row.run([*again, "--resume"], cwd=scene.folder)
            if ended.code == 2:  # there was no checkpoint yet
                ended = row.run([*scene.command, *more], cwd=scene.folder)
            found = scene.result()
            wrong = [name for name, content in whole.items() if found.get(name, 0) != content]
            row.case(f"cosim {transport}: kill {kill}", ended.code == 0 and not wrong, f"exit {ended.code}, {wrong}: {ended.err}")


def removed_tables(row, prepared, parent):
    long_run = ["run", "arm.json", "--end", "200", "--interval", "1e-3", "--quiet", "--output", "out"]
    for what in ("out/trajectory.csv", "out"):
        scene = Scene(row, prepared, parent, "run")
        with subprocess.Popen([row.hilda, *long_run], cwd=scene.folder, env=row.environment, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as process:
            time.sleep(0.7)
            target = scene.folder / what
            if target.is_dir():
                shutil.rmtree(target)
            else:
                target.unlink(missing_ok=True)
            time.sleep(0.3)
            process.send_signal(signal.SIGTERM)
            try:
                out, err = process.communicate(timeout=30)
            except subprocess.TimeoutExpired:
                process.kill()
                out, err = process.communicate()
            row.case(f"run: {what} removed", process.returncode in (0, 5, 143), f"exit {process.returncode}: {out[-200:]} {err}")


def main():
    def options(parser):
        parser.add_argument("--commands", default="", help="names, separated by commas; default: all")
        parser.add_argument("--kinds", default="", help="descriptors, disks, links, inputs; default: all")

    row = matrix.Row("25 commands", options)
    wanted = [name for name in row.options.commands.split(",") if name] or list(COMMANDS)
    kinds = {"descriptors": descriptors, "disks": disks, "links": links, "inputs": inputs}
    chosen = [kind for kind in row.options.kinds.split(",") if kind] or list(kinds)
    with matrix.scratch() as folder:
        prepared = folder / "prepared"
        prepared.mkdir()
        prepare(row, prepared)
        for name in wanted:
            def scene(name=name):
                return Scene(row, prepared, pathlib.Path(folder), name)

            s = scene()
            ended = s.run()
            whole = s.result() if COMMANDS[name][2] else {}
            row.case(f"{name}: plain", ended.code == 0 and (whole or name == "check"), f"exit {ended.code}: {ended.err}")
            for kind in chosen:
                if name != "check" or kind in ("descriptors", "inputs"):
                    kinds[kind](row, scene, name, whole)
        if not row.options.commands:
            kills_of_cosim(row, prepared, folder)
            removed_tables(row, prepared, folder)
    row.end()


main()
