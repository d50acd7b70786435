# SPDX-License-Identifier: GPL-3.0-or-later
"""KaTeX of Debian (libjs-katex), run by nodejs."""
import json
import pathlib
import subprocess

KATEX = pathlib.Path("/usr/share/javascript/katex")
PROGRAM = """
const katex = require(process.argv[1]);
const formulas = JSON.parse(require("fs").readFileSync(0, "utf8"));
process.stdout.write(JSON.stringify(formulas.map(([text, display]) => {
    try {
        return {html: katex.renderToString(text, {displayMode: display, output: "htmlAndMathml", strict: "ignore"})};
    } catch (error) {
        return {error: String(error.message)};
    }
})));
"""


def render(formulas):
    """The HTML of each pair (text, whether it is displayed), or its error"""
    done = subprocess.run(["node", "-e", PROGRAM, str(KATEX / "katex.js")], input=json.dumps(formulas), capture_output=True, text=True,
                          check=True)
    return json.loads(done.stdout)
