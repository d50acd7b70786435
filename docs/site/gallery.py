# SPDX-License-Identifier: GPL-3.0-or-later
"""The gallery of studies: quick ones are run for their figures, the others are listed with their pages."""
import concurrent.futures
import os
import re
import shutil
import subprocess

from pages import ROOT, Failure, write as write_page

# study, further options, figure, what it shows
SHOWN = (
    ("convergence", ["--problem", "double_pendulum_moving", "--integrator", "rA-full-1,rA-half-1,rA-half-1-momentum,rA-half-2,rA-rkmk-4"],
     "convergence-double_pendulum_moving.png", "Relative errors over the step. The slopes of the lines are the orders."),
    ("energy", [], "energy-double_pendulum.png", "Energy of a conservative model over time."),
    ("compare", [], "compare.png", "Differences of several integrators to the reference solution."),
    ("tolerance", [], "tolerance-four_link.png", "Errors over the tolerance of Newton's method."),
    ("snapshots", [], "snapshots-slider_crank.png", "A model at four times."),
    ("friction", [], "friction-brick.png", "A brick that is thrown on a floor with friction."),
    ("evolving-contact", [], "evolving-contact-planar.png", "A ball in a bowl; the contact points are unknowns of the equations."),
    ("evolving-friction", [], "evolving-friction-forces.png", "The same with friction and rolling resistance, until it rests."),
    ("snapshots", ["--problem", "examples/models/arch.json", "--integrator", "rA-moreau-1"], "snapshots-arch.png",
     "Rigid contact: a masonry arch that is too thin collapses with five hinges."),
    ("snapshots", ["--problem", "examples/models/dominoes.json", "--integrator", "rA-moreau-1", "--steps", "5e-4"],
     "snapshots-dominoes.png", "Rigid contact: a row of dominoes."),
    ("granular-head-on", [], "granular-head-on.png", "Restitution of a head-on collision of two grains, by integrator and step."),
    ("granular-oblique", [], "granular-oblique.png", "Oblique impact of a grain on a wall, over the angle."),
)
HEAD = """# Gallery

Figures of studies, drawn when this site was built. Each is one command; the page of a study has its question, its acceptance criteria
and the measured numbers.

"""
TABLE = """## All studies

| study | content |
| --- | --- |
"""


def run(program, work, environment, study, options, figure):
    """Runs a study. Returns its folder."""
    folder = work / "gallery" / figure.removesuffix(".png")
    command = [program, "study", study, *options, "--output", str(folder), "--force", "--quiet", "--jobs", "1"]
    done = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, check=False,
                          cwd=ROOT)
    if done.returncode != 0:
        raise Failure(f"gallery: {' '.join(command)} ends with exit code {done.returncode}: {done.stderr.strip()}")
    return folder


def studies(program, environment):
    """Names and descriptions of all studies"""
    text = subprocess.run([program, "study"], env={**os.environ, **environment}, capture_output=True, text=True, check=True).stdout
    found = []
    for line in text.splitlines():
        begin = re.match(r"([a-z][\w-]*)\s+(\S.*)$", line)
        if begin:
            found.append([begin[1], begin[2]])
        elif found and line.startswith("  "):
            found[-1][1] += " " + line.strip()
    return found


def link(study):
    """The name of a study, with a link to its page if there is one"""
    for name in (study, study.rsplit("-", 1)[0]):
        if (ROOT / "docs" / "results" / f"{name}.md").is_file():
            return f"[{study}](../docs/results/{name}.md)"
    return study


def write(stage, work, environment, jobs):
    """Writes the page. Returns the number of figures."""
    program = shutil.which("hilda", path=environment["PATH"])
    text = HEAD
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        folders = list(pool.map(lambda one: run(program, work, environment, *one[:3]), SHOWN))
    (stage / "gallery").mkdir(parents=True, exist_ok=True)
    for (study, options, figure, what), folder in zip(SHOWN, folders):
        if not (folder / figure).is_file():
            raise Failure(f"gallery: hilda study {study} has not drawn {figure}")
        shutil.copy(folder / figure, stage / "gallery" / figure)
        title = study if sum(one[0] == study for one in SHOWN) == 1 else figure.removesuffix(".png")
        text += (f"## {title}\n\n{what} Page: {link(study)}.\n\n"
                 f"    hilda study {' '.join([study, *options])}\n\n![{what}]({figure})\n\n")
    text += TABLE + "".join(f"| {link(name)} | {content} |\n" for name, content in studies(program, environment))
    write_page(stage / "gallery" / "index.md", text)
    return len(SHOWN)
