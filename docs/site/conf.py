# SPDX-License-Identifier: GPL-3.0-or-later
# Configuration of Sphinx. docs/build calls Sphinx with these files and a folder of prepared pages.
import gc
import json
import os
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
WORK = pathlib.Path(os.environ["HILDA_SITE_WORK"])
sys.path.insert(0, str(HERE / "extensions"))

# Sphinx keeps all pages in memory: with the default thresholds a fifth of the time is garbage collection.
gc.set_threshold(200_000, 50, 50)

project = "HILDA"
copyright = "the authors of HILDA, GPL-3.0-or-later"
version = release = re.search(r"project\(\s*hilda\s+VERSION\s+([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
language = "en"

extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton", "mathematics",
              "header_directive", "offline_theme"]
exclude_patterns = []
needs_sphinx = "5.3"

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 6
myst_dmath_allow_space = False

breathe_projects = {"hilda": str(WORK / "doxygen" / "xml")}
breathe_default_project = "hilda"
breathe_show_include = False
hilda_headers = json.loads((WORK / "doxygen" / "headers.json").read_text(encoding="utf-8"))
cpp_index_common_prefix = ["hilda::"]

autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_type_aliases = {"Source": "Source"}
add_module_names = False
napoleon_use_ivar = True
napoleon_use_rtype = False

html_math_renderer = "katex"
toc_object_entries = False  # the sidebar is copied for each page
html_theme = "furo"
html_title = f"HILDA {version}"
html_static_path = [str(HERE / "static")]
html_css_files = ["hilda.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}
pygments_style = "friendly"
highlight_language = "none"  # blocks without a language are output and equations of comments
copybutton_prompt_text = "$ "


def plain_docstring(app, what, name, thing, options, lines):
    """Docstrings are plain text: `lambda_` and |theta| are no markup of reStructuredText."""
    for i, line in enumerate(lines):
        pieces = re.split(r"(``[^`]*``|`[^`]*`|:\w+:`[^`]*`)", line)
        for k in range(0, len(pieces), 2):
            pieces[k] = re.sub(r"(?<![\w`])(\w*[a-z])_(?![\w`])", r"``\1_``", pieces[k])
            pieces[k] = re.sub(r"\|(\w+)\|", r"\|\1\|", pieces[k])
        lines[i] = "".join(pieces)


def setup(app):
    app.connect("autodoc-process-docstring", plain_docstring)
