# SPDX-License-Identifier: GPL-3.0-or-later
"""Formulas, rendered by KaTeX while the site is built: the pages need no script, only the style sheet and fonts of KaTeX.

Formulas are $...$ in the text and blocks ```math, which GitHub renders as well. A formula with an error is a warning with its page.
"""
import pathlib
import re
import shutil

from docutils import nodes
from sphinx.util import logging

from katex import KATEX, render

logger = logging.getLogger(__name__)


def is_displayed(node):
    return isinstance(node, (nodes.math_block, nodes.literal_block))


def take_punctuation(node):
    """Removes the bracket before and the punctuation after a formula of the text, and returns both."""
    found = []
    for step, pattern in ((-1, r"[(\[]+$"), (1, r"^[.,;:!?)\]]+")):
        place = node.parent.index(node) + step
        text = node.parent[place] if 0 <= place < len(node.parent) else None
        match = re.search(pattern, text.astext()) if isinstance(text, nodes.Text) else None
        found.append(match[0] if match else "")
        if match:
            node.parent[place] = nodes.Text(text.astext()[:match.start()] + text.astext()[match.end():])
    return found


def render_all(app, doctree, docname):
    """Renders the formulas of a page by one process."""
    if app.builder.format != "html":
        return
    found = [*doctree.findall(nodes.math), *doctree.findall(nodes.math_block)]
    found += [node for node in doctree.findall(nodes.literal_block) if node.get("language") == "math"]
    if not found:
        return
    results = render([(node.astext(), is_displayed(node)) for node in found])
    for node, result in zip(found, results):
        if "error" in result:
            logger.warning("formula %s: %s", node.astext(), result["error"], location=node)
            continue
        html = result["html"]
        if is_displayed(node):
            text = f'<div class="formula">{html}</div>'
        elif html.count('class="base"') <= 2:  # short: a line break would separate it from its punctuation
            before, after = take_punctuation(node)
            text = f'<span class="formula unbroken">{before}{html}{after}</span>'
        else:
            text = f'<span class="formula">{html}</span>'
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
