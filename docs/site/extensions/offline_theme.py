# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the theme of Debian independent of a web server: imports of /javascript/FILE in style sheets, and of modules in scripts, which
browsers do not load from files, are replaced by the file."""
import pathlib
import re

JAVASCRIPT = pathlib.Path("/usr/share/javascript")


def include(match):
    return (JAVASCRIPT / match[1]).read_text(encoding="utf-8")


def replace_imports(app, exception):
    if exception is not None or app.builder.format != "html":
        return
    for path in pathlib.Path(app.outdir).rglob("*.css"):
        text = path.read_text(encoding="utf-8")
        changed = re.sub(r"@import url\(/javascript/([^)]+)\);", include, text)
        if changed != text:
            path.unlink()
            path.write_text(changed, encoding="utf-8")
    for path in pathlib.Path(app.outdir).rglob("scripts/*.js"):
        text = path.read_text(encoding="utf-8")
        changed = re.sub(r'^import \w+ from "\./([^"]+)";', lambda match: (path.parent / match[1]).read_text(encoding="utf-8"), text,
                         flags=re.MULTILINE)
        if changed != text:
            path.unlink()
            path.write_text(changed, encoding="utf-8")


def setup(app):
    app.connect("build-finished", replace_imports)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
