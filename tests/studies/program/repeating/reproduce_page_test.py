#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of hilda reproduce: balanced tags, no scripts and no network, and every linked file exists.

    reproduce_page_test.py HILDA
"""
import html.parser
import os
import subprocess
import sys
import tempfile

EMPTY = {"meta", "img", "br", "hr", "link", "input"}


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.open, self.links, self.anchors, self.faults, self.tags = [], [], set(), [], set()

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.tags.add(tag)
        if tag not in EMPTY:
            self.open.append(tag)
        if "id" in attributes:
            if attributes["id"] in self.anchors:
                self.faults.append(f"two elements have the id {attributes['id']}")
            self.anchors.add(attributes["id"])
        self.links += [attributes[key] for key in ("href", "src") if key in attributes]
        self.faults += [f"attribute {key}" for key in attributes if key.startswith("on")]

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"unexpected </{tag}> at {self.getpos()}")


def check(folder):
    """The faults of the page in this folder"""
    with open(os.path.join(folder, "index.html"), encoding="utf-8") as file:
        text = file.read()
    page = Page()
    page.feed(text)
    page.close()
    faults = page.faults + [f"<{tag}> is not closed" for tag in page.open]
    faults += [f"<{tag}>" for tag in page.tags & {"script", "iframe", "link", "object"}]
    for link in page.links:
        if link.startswith("#"):
            if link[1:] not in page.anchors:
                faults.append(f"no section {link}")
        elif ":" in link or link.startswith("/") or not os.path.isfile(os.path.join(folder, link)):
            faults.append(f"no file {link}")
    faults += [f"no text '{part}'" for part in ("The figures of the dissertation", "Figs. 5.7, 5.8", "acceptance criterion")
               if part not in text]
    return faults, page.links


def main():
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as here:
        done = subprocess.run([program, "reproduce", "--chapter", "5", "--output", "a"], cwd=here, text=True,
                              capture_output=True, check=False, timeout=600)
        if done.returncode != 0:
            sys.exit(f"exit code {done.returncode}: {done.stdout}{done.stderr}")
        faults, links = check(os.path.join(here, "a"))
        # without matplotlib: the page has its tables and says why there is no figure
        environment = dict(os.environ, HILDA_PYTHON="/nonexistent/python")
        bare = subprocess.run([program, "reproduce", "--chapter", "5", "--output", "b"], cwd=here, text=True,
                              capture_output=True, check=False, timeout=600, env=environment)
        more, _ = check(os.path.join(here, "b"))
        with open(os.path.join(here, "b", "index.html"), encoding="utf-8") as file:
            text = file.read()
        if bare.returncode != 0 or "No figure. " not in text or "/nonexistent/python was not found" not in text:
            more.append("the page without Python does not say why it has no figures")
    for fault in faults + more:
        print(fault)
    if faults or more:
        sys.exit(1)
    print(f"{len(links)} links, 0 faults")


main()
