#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 7: each damaged checkpoint is detected: exit code 5, and the memory does not grow with a wrong length.

Bits of the first 512 bytes, random flips of bits, truncations, another model, versions, byte order. By default every
tenth of 5306 damages is tried, with both programs; --full tries all.
"""
import json
import random
import shutil

import matrix


def options(parser):
    parser.add_argument("--full", action="store_true", help="all damages instead of every tenth")


def damages(good, rng):
    for bit in range(8 * 512):
        yield f"bit {bit}", flipped(good, bit)
    for _ in range(1000):
        bit = rng.randrange(8 * len(good))
        yield f"random bit {bit}", flipped(good, bit)
    for k in range(200):
        yield f"truncation {k}", good[:rng.randrange(len(good))]
    for version in (0, 1, 8, 2 ** 31, 2 ** 63):
        yield f"version {version}", good[:8] + version.to_bytes(8, "little") + good[16:]
    yield "byte order", good[:8] + good[8:16][::-1] + good[16:24][::-1] + good[24:]
    for k in range(4):
        yield f"appended {k}", good + b"\0" * (k + 1)


def flipped(good, bit):
    wrong = bytearray(good)
    wrong[bit // 8] ^= 1 << bit % 8
    return bytes(wrong)


def main():
    row = matrix.Row("7 corrupt checkpoints", options)
    with matrix.scratch() as folder:
        row.run([row.hilda, "run", "double_pendulum", "--end", 0.05, "--output", "model", "--quiet"], cwd=folder)
        case = json.loads((matrix.SOURCE / "granular/cases/bed.json").read_text())
        case["fill"][0]["high"] = [0.01, 0.01, 0.006]
        (folder / "bed.json").write_text(json.dumps(case))
        end = repr(100 * case["step"])
        row.run([row.granular, "bed.json", "--quiet", "--end", end, "--output", "grains"], cwd=folder)
        longer = {"model": [row.hilda, "run", "double_pendulum", "--end", 0.1,
                            "--output", "model", "--resume", "--quiet"],
                  "grains": [row.granular, "bed.json", "--end", repr(200 * case["step"]),
                             "--output", "grains", "--resume", "--quiet"]}
        for number, (name, command) in enumerate(longer.items()):
            file = folder / name / "checkpoint.end"
            good = file.read_bytes()
            shutil.copytree(folder / name, folder / "kept")
            # The memory of a run that is refused: see below
            most = row.run([command[0], "--version"]).bytes + (64 << 20) + 2 * len(good)
            for k, (what, wrong) in enumerate(damages(good, random.Random(1))):
                if wrong == good or (not row.options.full and k % 20 != 10 * number):
                    continue
                file.write_bytes(wrong)
                ended = row.run(command, cwd=folder)
                refused = ended.code == 5 and matrix.is_one_line(ended.err)
                row.case(f"{name} {what}", refused and ended.bytes < max(most, 256 << 20),
                         f"exit {ended.code}, {ended.bytes >> 20} MB: {ended.err}")
            shutil.rmtree(folder / name)
            shutil.move(folder / "kept", folder / name)
            other = (["--set", "/bodies/0/mass=7"] if name == "model" else ["--set", "/laws/0/mu=0.123"])
            ended = row.run(command + other, cwd=folder)
            row.case(f"{name} of another model", ended.code in (2, 5) and matrix.is_one_line(ended.err),
                     f"exit {ended.code}: {ended.err}")
            row.case(f"{name} undamaged", row.run(command, cwd=folder).code == 0)
    row.end()


main()
