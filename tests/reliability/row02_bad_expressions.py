#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 2: 100 bad expressions end with exit code 3 and the column of the error."""
import re

import matrix
import model as models

TEXTS = ["", " ", "+", "*", "t+", "t*", "2t", "2 3", "t t", "(", ")", "()", "(t", "t)", "((t)",
         "sin", "sin(", "sin()", "sin(t", "sin t", "sin(t,t)", "min(t)", "min()", "min(t,)", "min(,t)", "max(t",
         "if(t)", "if(t,1)", "if(t,1,2,3)", "if()", "step()", "step(t,t)",
         "sine(t)", "cosinus(t)", "exp2(t)", "ln(t)", "atan2(t,t)", "pow(t,2)", "x", "T", "time", "theta",
         "t^", "^t", "t^^2", "t***2", "2^t", "t^t", "t^(1+t)",
         "1e", "1e+", "1e-", "1.2.3", "..", ".", "1e400", "0x10", "1_000",
         "t;t", "t,t", ",", "t=1", "t==1", "t<1", "t>1", "t&1", "t|1", "!t", "t!", "t%2", "t//2", "\"t\"", "'t'",
         "$t", "@t", "#", "\\", "`t`", "{t", "t}", "{}", "{", "[t]", "t[0]",
         "t\n+", "t\t*", "\u00b2", "t\u00b2", "\u03c0",
         "1/0", "0/0", "sqrt(-1)", "log(0)", "asin(2)", "acos(-2)", "exp(1000)", "1e300*1e300",
         "(" * 65 + "t" + ")" * 65, "-" * 70 + "t", "system(\"ls\")"]


def main():
    row = matrix.Row("2 bad expressions")
    with matrix.scratch() as folder:
        for text in TEXTS:
            (folder / "bad.json").write_text(models.text(models.changed("/forces/1/components", [text, 0, 0])))
            ended = row.run([row.hilda, "check", "bad.json"], cwd=folder)
            place = re.match(r"hilda: error: bad\.json:\d+:\d+ \(/forces/1/components(/0)?\): .+", ended.err, re.S)
            # An empty text has no column.
            column = re.search(r"column \d+", ended.err) or not text.strip()
            passed = ended.code == 3 and matrix.is_one_line(ended.err) and place and column and ended.seconds < 1
            row.case(repr(text)[:80], passed, f"exit {ended.code}: {ended.err}")
    row.end()


main()
