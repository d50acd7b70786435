# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel of pip: it is made from the libraries of a build, contains what it needs, and registers each entry once.

    wheel_check.py BUILD FOLDER      the build folder of the libraries; FOLDER is kept, so that a second check compiles nothing
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
USE = """
import json, hilda, hilda_granular
from hilda import cosim
world = hilda_granular.World("bed")
run = hilda.run("double_pendulum", "rA-half-2", end=0.1, step=1e-3)
maps = {line.split()[-1] for line in open("/proc/self/maps") if "hilda" in line}
try:
    hilda.run("no_such_problem", "rA-half-1")
except Exception as error:
    raised = f"{type(error).__module__}.{type(error).__name__}: {error}"
print(json.dumps({"steps": world.step(10), "r": world.r.sum().hex(), "end": [x.hex() for x in run.r[-1].ravel()],
                  "integrators": [str(i) for i in hilda.integrators()], "problems": [str(p) for p in hilda.problems()], "raised": raised,
                  "files": sorted(maps)}))
"""


def result(path):
    """What the packages in this folder do"""
    environment = {**os.environ, "PYTHONPATH": str(path), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run([sys.executable, "-W", "error", "-c", USE], env=environment, text=True, capture_output=True, cwd="/")
    if done.returncode:
        sys.exit(f"failed: {path}: {done.stderr}")
    return json.loads(done.stdout)


def main():
    build, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    sys.path.insert(0, str(ROOT / "python"))
    import build_backend
    build_backend.BUILD = folder / "build"
    build_backend.libraries = lambda: build  # the libraries of the tests, without a comparison of commits
    shutil.rmtree(folder / "unpacked", ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    name = build_backend.build_wheel(str(folder))
    with zipfile.ZipFile(folder / name) as wheel:
        wheel.extractall(folder / "unpacked")

    ours, theirs = result(folder / "unpacked"), result(build / "python")
    elsewhere = [file for file in ours.pop("files") if not file.startswith(str(folder / "unpacked"))]
    if elsewhere:
        sys.exit(f"failed: the packages of the wheel load {elsewhere}")
    theirs.pop("files")
    if ours != theirs:
        sys.exit(f"failed: the wheel and the build differ: {ours} {theirs}")


if __name__ == "__main__":
    main()
