#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An output format in one file: its option, its file in the summary, and a resumed run with the same bytes.

    sink_test.py PROGRAM
"""
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time


def main():
    program = sys.argv[1]

    def expect(condition, what):
        if not condition:
            sys.exit(f"failed: {what}")

    with tempfile.TemporaryDirectory() as folder:
        here = pathlib.Path(folder)

        def start(output, *options):
            return subprocess.Popen([program, "run", "double_pendulum", "--step", "2e-5", "--end", "1", "--quiet",
                                     "--output", output, *options], cwd=here, stderr=subprocess.PIPE, text=True)

        def finish(output, *options, code=0):
            process = start(output, *options)
            _, err = process.communicate()
            expect(process.returncode == code, f"exit code {process.returncode}, not {code}: {err}")
            return err

        expect("--momentum: must be a digit from 1 to 9, got 'many'" in finish("a", "--momentum", "many", code=2),
               "the option of the format is checked")
        finish("none")
        expect(not (here / "none" / "momentum.csv").exists(), "without the option the file is not written")

        finish("whole", "--momentum", "9")
        whole = (here / "whole" / "momentum.csv").read_bytes()
        expect(whole.count(b"\n") == 1002, f"a header and 1001 rows: {whole.count(b'x')}")
        files = json.loads((here / "whole" / "summary.json").read_text())["files"]
        expect(files == ["model.json", "momentum.csv", "trajectory.csv", "summary.json"], f"the summary lists the file: {files}")

        process = start("cut", "--momentum", "9", "--checkpoint", "0.01")
        while not (here / "cut" / "checkpoint.1").exists() and process.poll() is None:
            time.sleep(0.001)
        process.send_signal(signal.SIGINT)
        process.communicate()
        expect(process.returncode == 130, f"the run is interrupted: {process.returncode}")
        err = finish("cut", "--momentum", "8", "--resume", code=2)
        expect("belongs to another run" in err and "--momentum 9" in err, f"another value of the option is another run: {err}")
        process = start("cut", "--momentum", "9", "--checkpoint", "0.01", "--resume")
        time.sleep(0.1)
        process.kill()
        process.communicate()
        if process.returncode == -signal.SIGKILL:  # on a fast machine the run may end before the kill
            finish("cut", "--momentum", "9", "--resume")
        expect((here / "cut" / "momentum.csv").read_bytes() == whole, "interrupted, killed and resumed: the same bytes")
        finish("cut", "--force")
        expect(not (here / "cut" / "momentum.csv").exists(), "a new run removes the file of an earlier one")
    print(f"{len(whole)} bytes")


if __name__ == "__main__":
    main()
