# SPDX-License-Identifier: GPL-3.0-or-later
"""Formulas, rendered by KaTeX while the site is built: the pages need no script, only the style sheet and fonts of KaTeX.

KaTeX is the one of Debian (libjs-katex), run by nodejs. A formula with an error is a warning with its page.
"""
import json
import pathlib
import re
import shutil
import subprocess

from docutils import nodes
from sphinx.util import logging

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
logger = logging.getLogger(__name__)


def render(formulas):
    """The HTML of each pair (text, whether it is displayed), or its error"""
    done = subprocess.run(["node", "-e", PROGRAM, str(KATEX / "katex.js")], input=json.dumps(formulas), capture_output=True, text=True,
                          check=True)
    return json.loads(done.stdout)


def render_all(app, doctree, docname):
    """Renders the formulas of a page by one process."""
    if app.builder.format != "html":
        return
    found = [*doctree.findall(nodes.math), *doctree.findall(nodes.math_block)]
    if not found:
        return
    results = render([(node.astext(), isinstance(node, nodes.math_block)) for node in found])
    for node, result in zip(found, results):
        if "error" in result:
            logger.warning("formula %s: %s", node.astext(), result["error"], location=node)
            continue
        block = isinstance(node, nodes.math_block)
        tag = "div" if block else "span"
        text = f'<{tag} class="formula">{result["html"]}</{tag}>'
        node.replace_self(nodes.raw("", text, format="html"))


def add_files(app, exception):
    """Copies the style sheet and the fonts that it uses."""
    if exception is not None or app.builder.format != "html":
        return
    target = pathlib.Path(app.outdir) / "_static" / "katex"
    (target / "fonts").mkdir(parents=True, exist_ok=True)
    style = (KATEX / "katex.min.css").read_text(encoding="utf-8")
    style = re.sub(r",url\(fonts/[\w-]+\.(?:woff|ttf)\) format\(['\"]\w+['\"]\)", "", style)
    (target / "katex.min.css").write_text(style, encoding="utf-8")
    for font in sorted((KATEX / "fonts").glob("*.woff2")):
        shutil.copyfile(font, target / "fonts" / font.name)


def rendered_before(translator, node):
    raise RuntimeError(f"the formula {node.astext()} was not rendered")


def setup(app):
    # Instead of MathJax, whose pages load a script.
    app.add_html_math_renderer("katex", (rendered_before, None), (rendered_before, None))
    app.connect("doctree-resolved", render_all)
    app.connect("build-finished", add_files)
    app.add_css_file("katex/katex.min.css")
    return {"parallel_read_safe": True, "parallel_write_safe": True}

