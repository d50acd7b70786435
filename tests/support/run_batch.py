#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a batch of the cases of a test program in one process.

    run_batch.py PROGRAM short|long K N

The cases whose names contain "(long)", or the others, are dealt out to N batches; batch K runs, 1 <= K <= N.
"""

import re
import subprocess
import sys
import tempfile


def main(program, kind, batch, batches):
    listed = subprocess.run([program, "--list-test-names-only"], capture_output=True, text=True, check=False)
    names = [name for name in listed.stdout.splitlines() if name]
    # The exit code of the list is the number of cases, at most 255.
    if not names or listed.returncode != min(len(names), 255):
        print(f"{program} lists {len(names)} cases and ends with exit code {listed.returncode}")
        print(listed.stderr)
        return 1
    cases = [name for name in names if ("(long)" in name) == (kind == "long")][int(batch) - 1 :: int(batches)]
    if not cases:
        return 0
    with tempfile.NamedTemporaryFile("w", suffix=".txt", encoding="utf-8") as file:
        file.write("".join(name.replace(",", "\\,") + "\n" for name in cases))
        file.flush()
        # Each line is passed on when it comes: after a timeout the last one names the case that ended last.
        command = [program, "--durations", "yes", "--input-file", file.name]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            lines = []
            for line in process.stdout:
                lines.append(line)
                print(line, end="", flush=True)
    if process.returncode != 0:
        return 1
    number = re.search(r"in (\d+) test cases?\)", "".join(lines))
    if number is None or int(number[1]) != len(cases):
        print(f"{len(cases)} cases were to run")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
