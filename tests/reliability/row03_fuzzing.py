#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 3: fuzzing of all readers without a crash, a leak, an input slower than 5 s or more than 1 GB of memory.

Each target of tests/fuzz runs with libFuzzer (preset fuzz, clang with address and undefined-behaviour sanitizers) for
--seconds, by default 60; 28800 (8 hours) for a release. New inputs are kept in build/fuzz/corpus/TARGET, inputs that
fail in build/fuzz/failures. Then both programs are started with 300 random changes of valid command lines.
"""
import pathlib
import random
import re
import subprocess

import matrix


def options(parser):
    parser.add_argument("--seconds", type=int, default=60, help="time of each target")
    parser.add_argument("--targets", default="", help="TARGET,TARGET,...; default: all")
    parser.add_argument("--no-build", action="store_true", help="use the targets that are built")


def seeds_of(target):
    """Folders with the first inputs of a target: its corpus, for `model` also the models of the examples and tests"""
    folders = [matrix.SOURCE / "tests/fuzz/corpus" / target]
    if target == "model":
        folders += [matrix.SOURCE / "examples/models", matrix.SOURCE / "tests/data/models"]
    return [folder for folder in folders if folder.is_dir()]


def target_names():
    text = (matrix.SOURCE / "tests/fuzz/CMakeLists.txt").read_text()
    return re.search(r"set\(targets ([^)]*)\)", text).group(1).split()


WORDS = ["", "--", "-", "--=", "-1", "nan", "1e999", "\u00fc", "a" * 5000, "--step=", "%n", "0x1", "1;2", "\t"]


def command_lines(row, rng):
    """Random changes of the kept command lines, as processes. No command that runs long or writes outside its folder"""
    for program, corpus in ((row.hilda, "arguments"), (row.granular, "granular_arguments")):
        files = sorted((matrix.SOURCE / "tests/fuzz/corpus" / corpus).iterdir())
        seeds = [file.read_text(errors="replace").split("\n") for file in files]
        for _ in range(150):
            words = list(rng.choice(seeds))
            for _ in range(rng.randrange(1, 4)):
                at = rng.randrange(len(words) + 1)
                change = rng.randrange(5)
                if change == 0 and at < len(words):
                    words[at] = words[at][:rng.randrange(len(words[at]) + 1)]
                elif change == 1 and at < len(words):
                    del words[at]
                elif change == 2:
                    words.insert(at, rng.choice(rng.choice(seeds)))
                elif change == 3:
                    words.insert(at, rng.choice(WORDS))
                elif at < len(words) and words[at]:
                    words[at] = words[at] + rng.choice("0-=,x.")
            if "reproduce" not in words:
                yield program, words


def main():
    row = matrix.Row("3 fuzzing", options)
    build = matrix.SOURCE / "build/fuzz"
    targets = [name for name in row.options.targets.split(",") if name] or target_names()
    if not row.options.no_build:
        subprocess.run(["cmake", "--preset", "fuzz"], cwd=matrix.SOURCE, check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["cmake", "--build", build, "--target", *(f"hilda_fuzz_{name}" for name in targets)],
                       check=True, stdout=subprocess.DEVNULL)
    (build / "failures").mkdir(parents=True, exist_ok=True)
    for name in targets:
        grown = build / "corpus" / name
        grown.mkdir(parents=True, exist_ok=True)
        limits = [f"-max_total_time={row.options.seconds}", "-timeout=5", "-rss_limit_mb=1024", "-max_len=8192"]
        reports = ["-close_fd_mask=3", f"-artifact_prefix={build}/failures/{name}-", "-print_final_stats=1"]
        ended = row.run(["nice", build / f"tests/fuzz/hilda_fuzz_{name}", *limits, *reports, grown, *seeds_of(name)],
                        limit=row.options.seconds + 600, cwd=build)
        runs = re.search(r"number_of_executed_units: (\d+)", ended.err)
        print(f"{name}: {runs.group(1) if runs else 'no'} runs")
        row.case(name, ended.code == 0 and runs, f"exit {ended.code}: {ended.err[-1500:]}")
    with matrix.scratch() as folder:
        for program, words in command_lines(row, random.Random(1)):
            words = [word.replace("\0", "") for word in words]
            ended = row.run([program, *words], cwd=folder, limit=20, stdin=-3)
            # A valid command line may start a run that is longer than the limit.
            row.case(f"{pathlib.Path(program).name} {words}"[:300], ended.code in (0, 2, 3, 4, 5, 7, -9),
                     f"exit {ended.code}: {ended.err[-300:]}")
    row.end()


main()
