# SPDX-License-Identifier: GPL-3.0-or-later
"""Command line of the scripts, and the choice of what a figure shows.

    SCRIPT.py DIR [--format FORMAT,...] [--integrator NAME,...] [--quantity NAME,...]

Exit code after one line on stderr: REFUSED, an option that this figure cannot use, or an unknown name; DAMAGED, a table that
is no result; CANNOT_READ and CANNOT_WRITE, a file.
"""
import difflib
import sys

REFUSED, DAMAGED, CANNOT_READ = 2, 3, 5
CANNOT_WRITE = CANNOT_READ
MOST_CURVES = 8
# The schemes of the dissertation come first in the legends and are drawn on top of the others.
OF_THE_TEXT = ("rA-full-1", "rA-half-1", "rA-half-2")
# of the others, those that are drawn first where a figure has more than MOST_CURVES
PREFERRED = OF_THE_TEXT + ("rA-half-1-momentum", "rA-half-1-kick", "rA-half-2-bdf2", "rA-rkmk-4", "ida-rp",
                           "rA-rattle", "rA-genalpha")

left_out = []  # what the current figure does not show of the table, because it would have more than MOST_CURVES curves
left_out_hint = [""]  # how to show it
in_legend = []  # the integrators that it shows; empty: not chosen by shown()
used = set()   # options that the script has used


def refuse(message):
    print(message, file=sys.stderr)
    sys.exit(REFUSED)


class Arguments:
    def __init__(self, words):
        self.folder = ""
        self.given = {"--format": ["png"], "--integrator": [], "--quantity": []}
        while words:
            word, *words = words
            if word in self.given and words:
                self.given[word] = list(dict.fromkeys(words.pop(0).split(",")))
            elif word.startswith("--") or self.folder:
                sys.exit(sys.modules["__main__"].__doc__)
            else:
                self.folder = word


arguments = Arguments(sys.argv[1:])


def directory():
    """The result directory, the first argument of a script"""
    if not arguments.folder:
        sys.exit(sys.modules["__main__"].__doc__)
    return arguments.folder


def formats():
    return arguments.given["--format"]


def check(option, names, known):
    """Refuses the first name that is not known."""
    for name in names:
        if name not in known:
            nearest = difflib.get_close_matches(name, known, 1)
            refuse(f"{option}: unknown name '{name}'" + (f"; did you mean '{nearest[0]}'?" if nearest else "") +
                   f" (known names: {', '.join(known)})")


def chosen(known):
    """The quantities of --quantity, in the order of `known`; without the option all of `known`"""
    used.add("--quantity")
    names = arguments.given["--quantity"]
    check("--quantity", names, known)
    return [name for name in known if name in names] if names else list(known)


def text_first(schemes):
    return [s for s in OF_THE_TEXT if s in schemes] + [s for s in schemes if s not in OF_THE_TEXT]


def leave_out(names, hint=""):
    """States what the current figure does not show, for its caption."""
    left_out[:] = names
    left_out_hint[0] = hint


def shown(schemes, preferred=PREFERRED):
    """The integrators that a figure shows, in the order of its legend: those of --integrator, or at most MOST_CURVES of
    the table, the preferred ones first. The caption of the figure names the others (see drawing.save)."""
    used.add("--integrator")
    names = arguments.given["--integrator"]
    check("--integrator", names, schemes)
    leave_out([])
    in_legend.clear()
    if names:
        in_legend.extend(text_first(names))
        return list(in_legend)
    first = [s for s in preferred if s in schemes]
    some = (first + [s for s in schemes if s not in first])[:MOST_CURVES]
    leave_out([s for s in schemes if s not in some], " (hilda plot DIR --integrator NAME,... shows them)")
    in_legend.extend(text_first([s for s in schemes if s in some]))
    return list(in_legend)


def check_all_used():
    """Refuses the options that the script has not used, before it writes a figure."""
    for option, names in arguments.given.items():
        if option != "--format" and names and option not in used:
            refuse(f"{option} is not an option of these figures")
