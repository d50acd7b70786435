#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An output format in one file: its option, its file in the summary, and a resumed run with the same bytes.

    sink_test.py PROGRAM
"""
import json
import os
import pathlib
import signal
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

        def finish(output, *options, code=0, end=None):
            """Runs the program; end: (signal, write, file) of tests/support/end_at_write.cpp. Returns its messages."""
            environment = dict(os.environ, **({"HILDA_END_AT": "%d %d %s" % end} if end else {}))
            process = subprocess.run([program, "run", "double_pendulum", "--end", "1", "--quiet", "--output", output, *options],
                                     cwd=here, stderr=subprocess.PIPE, text=True, env=environment, check=False)
            expect(process.returncode == code, f"exit code {process.returncode}, not {code}: {process.stderr}")
            return process.stderr

        expect("--momentum: must be a digit from 1 to 9, got 'many'" in finish("a", "--momentum", "many", code=2),
               "the option of the format is checked")
        finish("none")
        expect(not (here / "none" / "momentum.csv").exists(), "without the option the file is not written")

        finish("whole", "--momentum", "9")
        whole = (here / "whole" / "momentum.csv").read_bytes()
        expect(whole.count(b"\n") == 1002, f"a header and 1001 rows: {whole.count(chr(10).encode())}")
        files = json.loads((here / "whole" / "summary.json").read_text())["files"]
        expect(files == ["model.json", "momentum.csv", "trajectory.csv", "summary.json"], f"the summary lists the file: {files}")

        checkpoints = ["--momentum", "9", "--checkpoint", "1e-9"]  # after each step
        finish("cut", *checkpoints, code=130, end=(signal.SIGINT, 100, "cut/checkpoint.new.tmp"))
        err = finish("cut", "--momentum", "8", "--resume", code=2)
        expect("belongs to another run" in err and "--momentum 9" in err, f"another value of the option is another run: {err}")
        finish("cut", *checkpoints, "--resume", code=-signal.SIGKILL, end=(signal.SIGKILL, 50, "cut/checkpoint.new.tmp"))
        part = (here / "cut" / "momentum.csv").stat().st_size
        expect(part < len(whole) // 2, f"the run was killed: {part} of {len(whole)} bytes")
        finish("cut", "--momentum", "9", "--resume")
        expect((here / "cut" / "momentum.csv").read_bytes() == whole, "interrupted, killed and resumed: the same bytes")
        finish("cut", "--force")
        expect(not (here / "cut" / "momentum.csv").exists(), "a new run removes the file of an earlier one")
    print(f"{len(whole)} bytes")


if __name__ == "__main__":
    main()
