# SPDX-License-Identifier: GPL-3.0-or-later
"""The formulas of the documentation: $...$ in the text and blocks ```math, which GitHub and the site render.

    python3 tests/docs/formulas_test.py

The pages of docs, except for docs/reference, have no formulas in Unicode characters. GitHub reads a formula of the text as
Markdown first; the formulas have only what it leaves unchanged. Their LaTeX is parsed by KaTeX, if it is installed.
"""
import pathlib
import re
import shutil
import sys
import unicodedata
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs" / "site" / "extensions"))

from katex import KATEX, render  # noqa: E402

# What Markdown or the formulas of GitHub do not accept, and what to write instead
REFUSED = (
    (r"\n", "the formula is broken into two lines"),
    (r"\\[^A-Za-z]", "Markdown removes a backslash before punctuation: \\thinspace, \\lbrace, \\lVert, \\cr"),
    (r"(?<![A-Za-z0-9])_(?!\s)", "Markdown takes the underscore for the beginning of emphasis: write a space after it"),
    (r"\*", "Markdown takes * for emphasis: write \\ast"),
    (r"<(?! )", "Markdown takes < for a tag: write a space after it"),
    (r"\]\(", "Markdown takes ]( for a link"),
    (r"\\operatorname|\\DeclareMathOperator|\\(re)?newcommand|\\def\b", "GitHub does not accept this command: write \\mathrm"),
)
TABLE = (r"\|", "| ends the cell of a table: write \\lvert and \\rvert")


def pages():
    found = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "studies/README.md")]
    return found + sorted((ROOT / "docs").rglob("*.md")) + sorted((ROOT / "examples").rglob("*.md"))


def blocks(text):
    """The code blocks, as (line, language, text), and the paragraphs, as (line, None, text) with code spans blanked"""
    found, fence, start, kept, language, in_list = [], None, 1, [], None, False

    def end():
        nonlocal in_list
        if not any(line.strip() for line in kept):
            return
        if fence is None:
            in_list = bool(re.match(r" {0,3}([-*+]|\d+\.) ", kept[0])) or in_list and kept[0].startswith(" ")
        indented = fence is None and not in_list and all(line.startswith("    ") for line in kept)
        found.append((start, "" if indented else language, "\n".join(kept)))

    for number, line in enumerate(text.split("\n"), 1):
        mark = re.match(r"\s*(```+|~~~+)\s*(\S*)", line)
        if fence is None and mark:
            end()
            fence, language, start, kept = mark[1], mark[2], number + 1, []
        elif fence is not None and line.strip() == fence:
            end()
            fence, language, start, kept = None, None, number + 1, []
        elif fence is None and not line.strip():
            end()
            start, kept = number + 1, []
        else:
            kept.append(line)
    end()
    code = re.compile(r"(`+)(?!`)(.*?)(?<!`)\1(?!`)", re.S)
    return [(line, name, text if name is not None else code.sub(lambda span: re.sub(r"[^\n]", "`", span[0]), text))
            for line, name, text in found]


def formulas(text):
    """The formulas of a page, as (line, LaTeX, whether it is displayed), its text without them and without code, as (line, text),
    and what is wrong with them, as (line, message)."""
    found, rest, faults = [], [], []
    for start, language, block in blocks(text):
        if language == "math":
            found.append((start, block, True))
        if language is not None:
            continue

        def line_of(place):
            return start + block.count("\n", 0, place)

        if "$$" in block:
            faults.append((line_of(block.index("$$")), "$$: GitHub changes the formula; write a block ```math"))
            continue
        parts = block.split("$")
        if len(parts) % 2 == 0:
            faults.append((line_of(block.rindex("$")), "a single dollar sign: write it as code"))
            continue
        place = 0
        for k, part in enumerate(parts):
            line = line_of(place)
            place += len(part) + 1
            if k % 2 == 0:
                rest += enumerate(part.split("\n"), line)
                continue
            found.append((line, part, False))
            row = block.split("\n")[line - start].lstrip().startswith("|")
            faults += [(line, f"${part}$: {why}") for pattern, why in REFUSED + (TABLE,) * row if re.search(pattern, part)]
            if not part.strip() or part != part.strip():
                faults.append((line, f"${part}$: a space beside the dollar sign"))
            if parts[k - 1] and not re.search(r"[\s(]$", parts[k - 1]):
                faults.append((line, f"${part}$: GitHub accepts only a space or a bracket ( before the dollar sign"))
            if re.match(r"\w", parts[k + 1]):
                faults.append((line, f"${part}$: GitHub does not accept a letter or digit after the dollar sign"))
    return found, rest, faults


def unicode_faults(rest):
    for line, text in rest:
        if re.search(r"[\u0300-\u036f]", text) or "\u0307" in unicodedata.normalize("NFD", text):
            yield line, f"a letter with a bar or a dot: write a formula: {text.strip()}"
        elif re.search(r"[_^]\{", text):
            yield line, f"a subscript or superscript outside of a formula: {text.strip()}"


class Pages(unittest.TestCase):
    def report(self, faults):
        if faults:
            self.fail("\n" + "\n".join(f"{page.relative_to(ROOT).as_posix()}:{line}: {message}" for page, line, message in faults))

    def test_formulas_are_latex(self):
        read = [page for page in pages() if page.is_relative_to(ROOT / "docs") and not page.is_relative_to(ROOT / "docs" / "reference")]
        self.assertGreater(len([page for page in read if page.is_relative_to(ROOT / "docs" / "theory")]), 25)
        self.report([(page, *fault) for page in read for fault in unicode_faults(formulas(page.read_text(encoding="utf-8"))[1])])

    def test_markdown_leaves_the_formulas_unchanged(self):
        self.report([(page, *fault) for page in pages() for fault in formulas(page.read_text(encoding="utf-8"))[2]])

    def test_katex_parses_every_formula(self):
        if shutil.which("node") is None or not (KATEX / "katex.js").exists():
            self.skipTest("node or KaTeX is not installed")
        found = [(page, line, text, displayed) for page in pages()
                 for line, text, displayed in formulas(page.read_text(encoding="utf-8"))[0]]
        self.assertGreater(len(found), 1000)
        results = render([(text, displayed) for _, _, text, displayed in found])
        self.report([(page, line, f"{text}: {result['error']}")
                     for (page, line, text, _), result in zip(found, results) if "error" in result])


class Faults(unittest.TestCase):
    """The tests above find what they look for."""

    def test_a_formula_in_unicode_is_found(self):
        for text in ("the velocity ω̄", "the velocity ṙ", "u_{n+½} is", "2^{31} cells"):
            self.assertEqual(len([*unicode_faults(formulas(f"\n{text}\n")[1])]), 1, text)
        for text in ("`ω̄` and $u_{n+1}$ by Brüls", "a\n\n    $A ω̄", "```text\nω̄\n```", "```math\nu_{n+1}\n```"):
            self.assertEqual([*unicode_faults(formulas(text)[1])], [], text)

    def test_a_formula_that_markdown_changes_is_found(self):
        for formula in (r"a\,b", r"\{a\}", r"\dot{\bar\omega}_n", "a^*", "a<b", "[a](b)", r"\operatorname{tr} A", " a"):
            self.assertEqual(len(formulas(f"a\n${formula}$ b")[2]), 1, formula)
        for text in ("x$a$", "$a$b", "$a\nb$", "$$a$$", "5 $ and", "| $|a|$ |"):
            self.assertEqual([line for line, _ in formulas(f"a\n\n{text}")[2]], [3], text)
        for text in (r"($\dot{\bar\omega}_ n$), $x_{n+1} < |a|$.", r"| $\lvert a\rvert$ |", "`$` and `$$`"):
            self.assertEqual(formulas(text)[2], [], text)

    def test_formulas_are_found_with_their_lines(self):
        self.assertEqual(formulas("# A\n\nThe `$` sign\nand $a$,\n$b$.\n\n```math\nc\n```\n\n- d\n  ```math\n  e\n  ```\n")[0],
                         [(4, "a", False), (5, "b", False), (8, "c", True), (13, "  e", True)])


if __name__ == "__main__":
    unittest.main()
