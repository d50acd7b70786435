# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages of the site: copies of the Markdown pages of the repository, with the navigation.

The copies keep their paths relative to the root of the repository. Relative links between pages are valid without a change.
"""
import pathlib
import re
import shutil

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Folders whose pages are part of the site. The first page of each is its index.
TREES = ("docs",)
SINGLE = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "studies/README.md", "examples/README.md",
          "examples/plugin-granular-law/README.md", "tests/mutations.md")
EXCLUDED = ("docs/site",)

# The sidebar: caption, and its pages. A page whose name is a key of CHILDREN has the pages of that folder below it, in the order in
# which the index page links them.
SIDEBAR = (
    ("Start", ("docs/getting-started", "docs/README", "README")),
    ("User guide", ("docs/guide/*",)),
    ("Tutorials", ("docs/tutorials/README",)),
    ("Reference", ("docs/reference/model-file", "docs/reference/case-file", "docs/reference/case-keys", "docs/reference/commands")),
    ("Interfaces", ("api/python/index", "api/cpp/index")),
    ("Theory", ("docs/theory/README", "docs/architecture")),
    ("Results", ("gallery/index", "docs/results/README")),
    ("Development", ("docs/extending/README", "examples/README", "studies/README", "CONTRIBUTING", "tests/mutations", "CHANGELOG",
                     "docs/renamed")),
)
CHILDREN = {
    "docs/tutorials/README": "docs/tutorials",
    "docs/theory/README": "docs/theory",
    "docs/theory/schemes/README": "docs/theory/schemes",
    "docs/results/README": "docs/results",
    "docs/extending/README": "docs/extending",
    "api/python/index": "api/python",
    "api/cpp/index": "api/cpp",
    "examples/README": "examples/plugin-granular-law",
}
ORDERED_BY = {"docs/guide": "docs/README.md"}
# Titles in the sidebar, where that of the page does not tell it from another one.
TITLES = {"README": "Overview", "docs/README": "All pages by task", "studies/README": "List of studies"}


class Failure(Exception):
    """An error of the build, whose text is one line for the user."""


def sources():
    """The pages of the repository that belong to the site, relative to its root."""
    found = [pathlib.PurePosixPath(name) for name in SINGLE if (ROOT / name).exists()]
    for tree in TREES:
        for path in sorted((ROOT / tree).rglob("*.md")):
            name = path.relative_to(ROOT).as_posix()
            if not name.startswith(tuple(folder + "/" for folder in EXCLUDED)):
                found.append(pathlib.PurePosixPath(name))
    return found


def outside_code(text, change):
    """The text with `change` applied to each line that is not in a code block."""
    lines, fence = [], None
    for line in text.split("\n"):
        mark = re.match(r"\s*(```+|~~~+)", line)
        if fence is None and mark:
            fence = mark[1]
        elif fence is not None and line.strip() == fence:
            fence = None
        elif fence is None:
            line = change(line)
        lines.append(line)
    return "\n".join(lines)


def linked_files(page, text):
    """Relative link targets of a page that are files but no pages."""
    found = set()

    def look(line):
        for target in re.findall(r"\]\(<?([^)\s>#]+)[^)]*\)", re.sub(r"`[^`]*`", "", line)):
            path = ROOT / page.parent / target
            if not re.match(r"[a-z]+:", target) and not target.endswith(".md") and path.is_file():
                found.add(path.resolve())
        return line
    outside_code(text, look)
    return found


def without_folder_links(page, text):
    """Links to folders of the source tree have no target on the site: their text remains, as code."""
    def change(line):
        def replace(link):
            is_folder = not re.match(r"[a-z]+:", link[2]) and (ROOT / page.parent / link[2]).is_dir()
            return f"`{link[1].strip('`')}`" if is_folder else link[0]
        return re.sub(r"\[([^\]]+)\]\(([^)\s#]+)\)", replace, line)
    return outside_code(text, change)


def copy(target):
    """Copies the pages and the files that they link into the folder `target`. Returns the names of the pages, without .md."""
    names = []
    for page in sources():
        text = (ROOT / page).read_text(encoding="utf-8")
        for file in linked_files(page, text):
            write_file(file, target / file.relative_to(ROOT))
        write(target / page, without_folder_links(page, text))
        names.append(page.with_suffix("").as_posix())
    return names


def copy_front_page(source, target):
    """Copies the front page from docs/site to the root of the site."""
    text = source.read_text(encoding="utf-8")
    write(target, text.replace("](../../", "](").replace("](../", "](docs/"))


def write_file(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def in_order_of_links(index, folder, pages):
    """The pages in the order in which the page `index` links them; then the others."""
    text = index.read_text(encoding="utf-8") if index.exists() else ""
    names = [pathlib.PurePosixPath(page).name for page in pages]

    def linked(name):
        found = re.search(rf"\]\((?:[\w./-]*/)?{re.escape(name)}(?:\.md)?[#)]", text)
        return found.start() if found else len(text)

    def place(page):
        # Parts of a page, such as grains-laws of grains, follow it.
        name = pathlib.PurePosixPath(page).name
        whole = next((other for other in names if name.startswith(other + "-") and linked(other) < len(text)), name)
        return linked(whole), whole != name, linked(name), names.index(name)
    return sorted(pages, key=place)


def toctree(pages, caption=None):
    options = [":hidden:"] + ([f":caption: {caption}"] if caption else [])
    return "\n".join(["", "```{toctree}", *options, "", *(f"{TITLES[page]} </{page}>" if page in TITLES else "/" + page for page in pages),
                      "```", ""])


def add_navigation(target):
    """Adds the sidebar to the front page and the pages below to each index page. Every page must have its place."""
    present = {path.relative_to(target).with_suffix("").as_posix() for ending in ("md", "rst") for path in target.rglob("*." + ending)}
    placed = {"index"}

    def below(folder, index):
        order = target / ORDERED_BY.get(folder, f"{index}.md")
        inside = [page for page in present if page.startswith(folder + "/") and page != index]
        direct = [page for page in inside if "/" not in page[len(folder) + 1:] or
                  (page.count("/") == folder.count("/") + 2 and page in CHILDREN)]
        return in_order_of_links(order, folder, sorted(direct))

    for index, folder in CHILDREN.items():
        if index in present and (pages := below(folder, index)):
            placed.update(pages)
            source = next(target / f"{index}.{ending}" for ending in ("md", "rst") if (target / f"{index}.{ending}").exists())
            with open(source, "a", encoding="utf-8") as file:
                file.write(toctree(pages))
    trees = []
    for caption, names in SIDEBAR:
        pages = []
        for name in names:
            pages += below(name[:-2], "") if name.endswith("/*") else [name] if name in present else []
        placed.update(pages)
        if pages:
            trees.append(toctree(pages, caption))
    if missing := sorted(present - placed):
        raise Failure(f"the page {missing[0]} has no place in the sidebar; add it to SIDEBAR in docs/site/pages.py")
    with open(target / "index.md", "a", encoding="utf-8") as file:
        file.write("\n".join(trees))
