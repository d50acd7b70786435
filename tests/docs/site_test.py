# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation site is built without a warning; it has all public names, and needs no other files.

    HILDA_BUILD=build/release python3 tests/docs/site_test.py

Skipped without Sphinx, MyST, Breathe, Furo or Doxygen.
"""
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["HILDA_BUILD"]).resolve()
MISSING = [name for name in ("sphinx", "myst_parser", "breathe", "furo") if importlib.util.find_spec(name) is None]
MISSING += [name for name in ("doxygen", "node") if shutil.which(name) is None]
if not pathlib.Path("/usr/share/javascript/katex/katex.js").exists():
    MISSING.append("katex")
sys.path[:0] = [str(ROOT / "docs" / "site"), str(BUILD / "python")]


class PythonNames(unittest.TestCase):
    def test_every_public_name_has_a_docstring(self):
        import hilda
        import hilda_granular
        import python_names
        for package in (hilda, hilda_granular):
            names = dict(python_names.documented(package))
            self.assertGreater(len(names), 50)
            self.assertEqual([name for name, text in names.items() if not text.strip()], [])


@unittest.skipIf(MISSING, "not installed: " + ", ".join(MISSING))
class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.site = pathlib.Path(cls.temporary.name) / "site"
        command = [sys.executable, str(ROOT / "docs" / "site" / "build.py"), "--build", str(BUILD), "--output", str(cls.site)]
        done = subprocess.run(command, capture_output=True, text=True)
        # The command checks links, anchors and images, and that nothing is loaded from elsewhere.
        assert done.returncode == 0, done.stdout + done.stderr
        cls.work = cls.site.with_name("site-work")
        import check
        cls.identifiers = set()
        for path in (cls.site / "api").rglob("*.html"):
            cls.identifiers |= check.Page(path.read_text(encoding="utf-8")).identifiers

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_every_python_name_has_an_entry(self):
        import hilda
        import hilda_granular
        import python_names
        for package in (hilda, hilda_granular):
            modules = {thing.__name__ for _, name, thing in python_names.public(package) if name is None}
            missing = [name for name, _ in python_names.documented(package) if name not in self.identifiers and name not in modules]
            self.assertEqual(missing, [])

    def test_every_class_and_function_of_the_headers_has_an_entry(self):
        import headers
        wanted = {}
        for file in sorted((self.work / "doxygen" / "xml").glob("*.xml")):
            if file.name == "index.xml":
                continue
            for compound in ElementTree.parse(file).getroot().iter("compounddef"):
                location = compound.find("location")
                if compound.get("kind") in ("class", "struct") and compound.get("prot") == "public" and location is not None:
                    name = compound.findtext("compoundname")
                    if "@" not in name and "<" not in name:
                        wanted[name] = compound.get("id")
                if compound.get("kind") == "namespace" and "@" not in compound.findtext("compoundname"):
                    for member in compound.iter("memberdef"):
                        if member.get("kind") == "function":
                            wanted[f"{compound.findtext('compoundname')}::{member.findtext('name')}()"] = member.get("id")
        self.assertGreater(len(wanted), 500)
        self.assertGreater(len(headers.installed()), 250)
        missing = [name for name, identifier in wanted.items() if identifier not in self.identifiers]
        self.assertEqual(missing, [])

    def test_a_broken_link_is_found(self):
        import check
        index = self.site / "index.html"
        text = index.read_text(encoding="utf-8")
        try:
            index.write_text(text.replace("</body>", '<a href="none.html">x</a><img src="https://example.org/x.png"></body>'), encoding="utf-8")
            faults, _ = check.site(self.site)
        finally:
            index.write_text(text, encoding="utf-8")
        self.assertEqual(len(faults), 2, faults)
        self.assertRegex(faults[0] + faults[1], "none.html: the file does not exist")
        self.assertRegex(faults[0] + faults[1], "is loaded from elsewhere")

    def test_tutorials_have_their_figures(self):
        tutorials = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
        self.assertGreaterEqual(len(tutorials), 9)
        for page in tutorials:
            if page.stem == "README":
                continue
            text = (self.site / "docs" / "tutorials" / f"{page.stem}.html").read_text(encoding="utf-8")
            self.assertTrue(re.search(r'<img[^>]*_images/[^"]*' + page.stem, text), page)

    def test_a_folder_with_other_files_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "mine.txt").write_text("mine")
            command = [sys.executable, str(ROOT / "docs" / "site" / "build.py"), "--build", str(BUILD), "--output", folder]
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, "is not empty and was not written by docs/build")
            self.assertTrue((pathlib.Path(folder) / "mine.txt").exists())


if __name__ == "__main__":
    if MISSING:
        print("the site is not built; not installed:", ", ".join(MISSING))
    unittest.main()
