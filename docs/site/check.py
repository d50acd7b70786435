#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the built site: links, anchors and images lead to files of the site, and nothing is loaded from elsewhere.

    check.py DIR
"""
import html.parser
import pathlib
import re
import sys
import urllib.parse

# Attributes whose target the browser loads. Links (a href) are followed by the reader, and may lead elsewhere.
LOADED = {"src", "srcset", "data", "poster"}


class Page(html.parser.HTMLParser):
    """The identifiers, the links and the loaded files of one page"""

    def __init__(self, text):
        super().__init__()
        self.identifiers, self.links, self.loaded = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or name == "name" and tag == "a":
                self.identifiers.add(value)
            elif value is None:
                continue
            elif name == "href" and tag in ("a", "area"):
                self.links.append((self.getpos()[0], value))
            elif name in ("href", "xlink:href") and not value.startswith("#"):
                # <link> to stylesheets, and images in drawings
                self.loaded.append((self.getpos()[0], value))
            elif name in LOADED:
                self.loaded.append((self.getpos()[0], value))
            elif name == "style":
                self.loaded += [(self.getpos()[0], target) for target in urls(value)]


def urls(text):
    """Targets of url() and @import in a style sheet, without data"""
    found = re.findall(r"url\(\s*['\"]?([^'\")]+)['\"]?\s*\)", text) + re.findall(r"@import\s+['\"]([^'\"]+)['\"]", text)
    return [target for target in found if not target.startswith(("data:", "#"))]


def is_external(target):
    return bool(re.match(r"[a-zA-Z][a-zA-Z0-9+.-]*:|//", target)) and not target.startswith("data:")


def site(folder):
    """Faults of the site in a folder, and numbers of pages and links."""
    folder = pathlib.Path(folder)
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    faults, links = [], 0

    def look(path, line, target, identifiers):
        parts = urllib.parse.urlsplit(target)
        file = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
        if file.is_dir():
            file = file / "index.html"
        name = path.relative_to(folder)
        if not file.is_file():
            faults.append(f"{name}:{line}: {target}: the file does not exist")
        elif folder.resolve() not in file.parents:
            faults.append(f"{name}:{line}: {target}: the file is not in the site")
        elif identifiers and parts.fragment and file.suffix == ".html":
            if urllib.parse.unquote(parts.fragment) not in pages[folder / file.relative_to(folder.resolve())].identifiers:
                faults.append(f"{name}:{line}: {target}: the page has no such anchor")

    for path, page in pages.items():
        for line, target in page.links:
            if not is_external(target) and target != "#":
                links += 1
                look(path, line, target, True)
        for line, target in page.loaded:
            if is_external(target):
                faults.append(f"{path.relative_to(folder)}:{line}: {target}: is loaded from elsewhere")
            elif not target.startswith("data:"):
                links += 1
                look(path, line, target, False)
    for path in sorted(folder.rglob("*.css")):
        for target in urls(path.read_text(encoding="utf-8")):
            links += 1
            if is_external(target):
                faults.append(f"{path.relative_to(folder)}: {target}: is loaded from elsewhere")
            else:
                look(path, 0, target, False)
    for path in sorted(folder.rglob("*.js")):
        text = path.read_text(encoding="utf-8")
        for target in re.findall(r"""(?:import\s*\(?|\.src\s*=|fetch\(|importScripts\()\s*["'](?:https?:)?//[^"']*""", text):
            faults.append(f"{path.relative_to(folder)}: {target}: is loaded from elsewhere")
    return faults, {"pages": len(pages), "links": links}


def main():
    if len(sys.argv) != 2 or not pathlib.Path(sys.argv[1]).is_dir():
        sys.exit("hilda: error: check.py: give the folder of the site")
    faults, counts = site(pathlib.Path(sys.argv[1]).resolve())
    for fault in faults:
        print(fault)
    print(f"{counts['pages']} pages, {counts['links']} links, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
