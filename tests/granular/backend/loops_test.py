#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The object of an instruction set defines one global symbol: no other unit can take a function from it.

    loops_test.py NM OBJECT...
"""
import re
import subprocess
import sys

for file in sys.argv[2:]:
    name = re.search(r"granular_(v\d)\.o$", file)[1]
    listed = subprocess.run([sys.argv[1], "--extern-only", "--defined-only", "--format=posix", file], check=True,
                            capture_output=True, text=True).stdout
    symbols = [line.split()[0] for line in listed.splitlines()]
    if symbols != [f"hilda_granular_loops_{name}"]:
        sys.exit(f"{file}: the global symbols are {symbols}")
