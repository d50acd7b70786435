# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the last row of a CSV file with expected values; used by the tests of the examples.

    check_last_row.py FILE COLUMN VALUE TOLERANCE [COLUMN VALUE TOLERANCE ...]

COLUMN is the name of a column, or a pattern such as '*_Fz' for the sum of all columns that match. Ends with 1 if
|column - VALUE| > TOLERANCE.
"""
import csv
import fnmatch
import sys

path, rest = sys.argv[1], sys.argv[2:]
if not rest or len(rest) % 3 != 0:
    sys.exit(__doc__)
with open(path, newline="") as file:
    row = list(csv.DictReader(file))[-1]

failed = False
for column, value, tolerance in zip(rest[0::3], map(float, rest[1::3]), map(float, rest[2::3])):
    matching = [float(v) for name, v in row.items() if fnmatch.fnmatchcase(name, column)]
    if not matching:
        sys.exit(f"{path}: no column matches '{column}'; the columns are {', '.join(row)}")
    error = sum(matching) - value
    passed = abs(error) <= tolerance  # False for NaN
    failed = failed or not passed
    print(f"{column} = {sum(matching):.9g}, expected {value:.9g}, error {error:.1e}: "
          + ("passed" if passed else f"FAILED, the tolerance is {tolerance:g}"))
sys.exit(1 if failed else 0)
