#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""All rows of the reliability matrix, one after the other, and a table of their cases.

    run_all.py [--build DIR] [--rows 1,2,18] [--quick]     --quick leaves out the rows that take more than some minutes
"""
import argparse
import pathlib
import re
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
LONG = {3, 4, 6, 10, 15, 16, 20, 22, 23}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=str(HERE.parents[1] / "build/release"))
    parser.add_argument("--rows", default="")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    wanted = {int(number) for number in options.rows.split(",") if number}
    table, failed = [], False
    for script in sorted(HERE.glob("row*.py")):
        number = int(re.match(r"row(\d+)", script.name).group(1))
        if (wanted and number not in wanted) or (options.quick and number in LONG):
            continue
        begin = time.monotonic()
        ended = subprocess.run([sys.executable, script, "--build", options.build], stdout=subprocess.PIPE, text=True,
                               check=False)
        lines = ended.stdout.strip().split("\n")
        for line in lines[:-1]:
            print(f"      {line}", flush=True)
        print(f"[{number}] {lines[-1]} ({time.monotonic() - begin:.0f} s)", flush=True)
        counts = re.fullmatch(r"(.*), (\d+), (\d+)", lines[-1])
        table.append((counts.group(1), int(counts.group(2)), int(counts.group(3))) if counts else (script.name, 0, 0))
        failed = failed or ended.returncode != 0
    print(f"\n{'row':<28}{'cases':>8}{'passed':>8}")
    for name, cases, passed in table:
        print(f"{name:<28}{cases:>8}{passed:>8}")
    print(f"{'total':<28}{sum(one[1] for one in table):>8}{sum(one[2] for one in table):>8}")
    sys.exit(1 if failed else 0)


main()
