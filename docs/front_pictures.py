#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the pictures of README.md: studies/plots/four-link.png and studies/plots/fed-hopper.png.

    front_pictures.py [PROGRAM]      default: build/release/hilda

four-link.png: the spatial four-link at one time of its motion, its outlines at other times, and the paths of the centres of mass.
fed-hopper.png: the built-in case fed_hopper in the page of hilda view, with the grains coloured by their speed. Takes some minutes.
Needs matplotlib, three.js and chromedriver (Debian: python3-matplotlib, libjs-three, chromium-driver).
"""
import io
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
PLOTS = ROOT / "studies" / "plots"
sys.path.insert(0, str(PLOTS))

from PIL import Image  # noqa: E402

from bodies import Scene, colour_of, common_box, plt, runs  # noqa: E402
from browser import Browser  # noqa: E402
from drawing import Line2D  # noqa: E402

HEIGHT = 640  # of both pictures [pixels]


def write(picture, name, colours):
    """Writes the picture without its white margins, as a PNG file with a palette"""
    white = Image.new("RGB", picture.size, "white")
    inside = Image.frombytes("L", picture.size, bytes(255 if a != b else 0 for a, b in zip(picture.getdata(), white.getdata())))
    left, top, right, bottom = inside.getbbox()
    picture = picture.crop((max(left - 8, 0), max(top - 8, 0), right + 8, bottom + 8))
    picture.quantize(colours, dither=Image.Dither.NONE).save(PLOTS / name, optimize=True)
    print(f"{name}: {picture.width} x {picture.height}, {(PLOTS / name).stat().st_size / 1000:.0f} kB")


def four_link(program, folder):
    subprocess.run([program, "study", "snapshots", "four_link", "--output", folder, "--no-plot", "--quiet"], check=True)
    run = runs(folder)["four_link"]
    rows = next(iter(run.poses.values()))
    shown, period = 0.25, 2.0  # [s]
    figure = plt.figure(figsize=(6.4, 5.2))
    axes = figure.add_axes((0, 0.04, 0.95, 0.98), projection="3d")
    scene = Scene(axes, run, shown, *common_box([(run, t) for t in rows.t[::10]]), look=(20, -55), zoom=1.25)
    for eighth in range(8):
        if eighth * period / 8 != shown:
            scene.outline(eighth * period / 8, colors="0.55", linewidths=0.5)
    scene.t = period
    scene.paths()
    scene.t = shown
    scene.bodies()
    scene.joints()
    scene.finish("")
    handles = [Line2D([], [], color=colour_of(k), lw=2, label=body.replace("_", " ")) for k, body in enumerate(run.bodies)]
    figure.legend(handles=handles, loc="lower center", ncol=len(handles), frameon=False, fontsize=9)
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=HEIGHT / 4.9)
    write(Image.open(drawn).convert("RGB"), "four-link.png", 128)


def fed_hopper(program, folder):
    shown = 0.9  # [s]
    subprocess.run([program, "granular", "fed_hopper", "--end", str(shown), "--output", folder, "--quiet"], check=True)
    subprocess.run([program, "view", folder], check=True, stdout=subprocess.DEVNULL)
    with Browser(460, HEIGHT) as window:
        window.open("file://" + os.path.join(folder, "view.html"))
        window.wait("viewer.ready || viewer.errors.length")
        window.run("viewer.picture_only(); for (const id of ['name', 'clock']) document.getElementById(id).style.display = 'none';"
                   "const legend = document.getElementById('legend');"
                   "legend.innerHTML = legend.innerHTML.replace(/[\\d.]+(?= m)/, speed => Number(speed).toPrecision(3))")
        window.show_time(shown)
        write(Image.open(io.BytesIO(window.screenshot())).convert("RGB"), "fed-hopper.png", 256)


def main():
    program = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "release" / "hilda")
    with tempfile.TemporaryDirectory() as folder:
        four_link(program, os.path.join(folder, "four-link"))
        fed_hopper(program, os.path.join(folder, "fed-hopper"))


if __name__ == "__main__":
    main()
