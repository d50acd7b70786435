#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 6: full disks, read-only folders and limits of the file size end with exit code 5; the last checkpoint is
complete, and no temporary file is left.

Disks of 8, 32, 128, 512 KiB and 2 MiB (tmpfs, in a mount namespace of its own) for checkpoint, CSV and VTK; limits of
the file size of 5 lengths; a folder that cannot be written.
"""
import resource

import matrix

SIZES = ("8k", "32k", "128k", "512k", "2m")
OUTPUTS = {"checkpoint": ["--checkpoint", "1e-9"],
           "csv": ["--reactions", "--checkpoint", "0.05"],
           "vtk": ["--vtk", "1e-3", "--checkpoint", "0.05"]}
OF_CHECKPOINTS = ("--checkpoint", "1e-9", "0.05")
IN_NAMESPACE = ["unshare", "--mount", "--map-root-user", "sh", "-c"]


def main():
    row = matrix.Row("6 full disk")
    with matrix.scratch() as folder:
        (folder / "disk").mkdir()
        run = [row.hilda, "run", "n_pendulum_2_spin", "--step", "1e-3", "--interval", "1e-3", "--quiet", "--output"]
        for size in SIZES:
            for name, options in OUTPUTS.items():
                # In the namespace: mount the disk, run, list the files, resume on a disk that is no longer full
                script = (f'mount -t tmpfs -o size={size} none disk && "$@"; code=$?; '
                          'find disk -name "*.tmp" | sed "s/^/left: /"; '
                          'if [ -e disk/out/checkpoint ] && [ $code -eq 5 ]; then cp -r disk/out whole; fi; exit $code')
                row.run(["rm", "-rf", "whole"], cwd=folder)
                ended = row.run([*IN_NAMESPACE, script, "sh", *run, "disk/out", "--end", "40", *options],
                                cwd=folder, limit=300)
                resumable = True
                if (folder / "whole").exists():
                    others = [option for option in options if option not in OF_CHECKPOINTS]
                    again = row.run([*run, "whole", *others, "--resume", "--end", "41"], cwd=folder, limit=5)
                    # A damaged checkpoint ends at once with exit code 5; otherwise the run goes on until the limit.
                    resumable = again.code in (0, -9)
                clean = "left:" not in ended.out and matrix.is_one_line(ended.err)
                row.case(f"{size} {name}", ended.code == 5 and clean and resumable,
                         f"exit {ended.code}, {ended.out} {ended.err}")
        for most in (0, 1000, 10000, 100000, 1000000):
            row.run(["rm", "-rf", "limited"], cwd=folder)
            ended = row.run([*run, "limited", "--end", "40", *OUTPUTS["csv"]], cwd=folder, limit=300,
                            preexec_fn=lambda most=most: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
            left = list(folder.glob("limited/**/*.tmp"))
            row.case(f"file size {most}", ended.code == 5 and not left and "File too large" in ended.err,
                     f"exit {ended.code}, {left}: {ended.err}")
        script = 'mount -t tmpfs none disk && mount -o remount,ro disk && exec "$@"'
        ended = row.run([*IN_NAMESPACE, script, "sh", *run, "disk/out", "--end", "40"], cwd=folder)
        row.case("read-only", ended.code == 5 and matrix.is_one_line(ended.err), f"exit {ended.code}: {ended.err}")
    row.end()


main()
