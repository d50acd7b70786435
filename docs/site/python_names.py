# SPDX-License-Identifier: GPL-3.0-or-later
"""The public names of the Python packages, their docstrings, and their pages."""
import importlib
import inspect
import types

from pages import write

GROUPS = (  # page, title, the modules whose names it has
    ("models", "Models and runs", ("hilda.model", "hilda.result", "hilda.simulation", "hilda.surface", "hilda.stored", "hilda.cosimulation")),
    ("integrators", "Integrators", ("hilda.integrator", "hilda._hilda")),
    ("studies", "Studies", ("hilda.orders", "hilda.work", "hilda.parameters", "hilda.fitting")),
    ("errors", "Errors and warnings", ("hilda.errors",)),
    ("grains", "Grains", ("hilda_granular.world", "hilda_granular.boundary", "hilda_granular.results")),
    ("grains-errors", "Errors of grains", ("hilda_granular.errors",)),
)
PACKAGES = ("hilda", "hilda_granular")
INDEX = """# Python interface

The package `hilda` runs models in Python, with NumPy arrays as results, and `hilda_granular` computes grains. [Python](../../docs/guide/python.md)
and [Grains in Python](../../docs/guide/python-granular.md) in the user guide show their use with examples. Arguments and results are in SI units. A bar in a name (`omega_bar`) marks components in a body frame.

| page | names |
| --- | --- |
"""


def public(package):
    """The public names: module, name and object of each."""
    found = []
    for name in package.__all__:
        thing = getattr(package, name)
        if name.startswith("__"):
            continue
        if isinstance(thing, types.ModuleType):
            found.append((thing.__name__, None, thing))
            found += [(thing.__name__, key, value) for key, value in vars(thing).items()
                      if not key.startswith("_") and getattr(value, "__module__", None) == thing.__name__ and key not in package.__all__]
        else:
            found.append((thing.__module__, name, thing))
    return found


def members(thing):
    """The public methods and properties that a class defines itself."""
    for name, member in vars(thing).items():
        described = callable(member) or isinstance(member, property) or inspect.isdatadescriptor(member)
        if not name.startswith("_") and described:
            yield name, member


def full_name(package, module, name):
    """Name by which a user imports it."""
    return f"{package.__name__}.{name}" if name in package.__all__ else f"{module}.{name}"


def documented(package):
    """All public names with their docstrings, as ("hilda.Model.run", text)."""
    for module, name, thing in public(package):
        shown = module if name is None else full_name(package, module, name)
        yield shown, thing.__doc__ or ""
        if inspect.isclass(thing):
            for member, value in members(thing):
                yield f"{shown}.{member}", value.__doc__ or ""


def write_pages(target):
    """The pages of the packages, which must be importable."""
    packages = [importlib.import_module(name) for name in PACKAGES]
    names = [(package, *entry) for package in packages for entry in public(package)]
    groups = list(GROUPS)
    known = {module for _, _, modules in GROUPS for module in modules}
    for package, module in dict.fromkeys((package, module) for package, module, _, _ in names):
        if module not in known:
            short = module.rpartition(".")[2]
            groups.append((short, f"Module {module}" if module in sorted(vars(package)) or "." in module else module, (module,)))
    index = INDEX
    for page, title, modules in groups:
        lines, shown = [title, "=" * len(title), ""], []
        for package, module, name, thing in names:
            if module not in modules:
                continue
            if name is None:
                if not thing.__name__.endswith(".errors"):
                    lines += [f".. automodule:: {module}", ""]
                continue
            full = full_name(package, module, name)
            shown.append(f"`{full.removeprefix('hilda.')}`")
            if inspect.isclass(thing):
                lines += [full.removeprefix("hilda."), "-" * len(full.removeprefix("hilda.")), "", f".. autoclass:: {full}", "   :members:",
                          "   :undoc-members:", "   :show-inheritance:", "   :member-order: bysource", ""]
            else:
                lines += [f".. autofunction:: {full}", ""]
        write(target / "api" / "python" / f"{page}.rst", "\n".join(lines))
        index += f"| [{title}]({page}.rst) | {', '.join(shown)} |\n"
    write(target / "api" / "python" / "index.md", index)
