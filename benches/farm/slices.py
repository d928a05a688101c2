#!/usr/bin/env python3
"""What slices cost: CPU seconds of N slices and their merge over those of one run, in turn.

    python3 benches/farm/slices.py [--program target/release/specula] [--of 8] [--passes 5] [-t 1] [--size 480x270] SCENE[:SPP] ...

CPU seconds are those of the processes, all of them: reading the scene, building, rendering, writing parts, reading and
adding them, writing the picture. The merged picture is compared with that of one run by `specula diff`.
"""

import argparse
import json
import os
import statistics
import subprocess
import tempfile


def seconds(words):
    """CPU seconds of a program that must succeed."""
    child = subprocess.Popen(words, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = status
    if status != 0:
        raise SystemExit(f"{' '.join(words)}: status {status}")
    return usage.ru_utime + usage.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--program", default="target/release/specula")
    parser.add_argument("--of", type=int, default=8)
    parser.add_argument("--passes", type=int, default=5)
    parser.add_argument("-t", "--threads", default="1")
    parser.add_argument("scenes", nargs="+")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    width, height = options.size.split("x")
    print("scene,spp,slices,passes,one_s,slices_s,merge_s,ratio_median,ratio_least,ratio_most,rmse")
    for scene in options.scenes:
        scene, _, spp = scene.partition(":")
        spp = spp or "256"
        with tempfile.TemporaryDirectory() as folder:
            path = lambda name: os.path.join(folder, name)
            common = [program, "render", scene, "-q", "-t", options.threads, "--spp", spp]
            common += ["--integrator", "path", "--width", width, "--height", height]
            parts = [path(f"{k}.part") for k in range(options.of)]
            ones, slices, merges = [], [], []
            for _ in range(options.passes):
                ones.append(seconds([*common, "-o", path("one.exr")]))
                cut = [[*common, "--slice", f"{k}/{options.of}", "-o", part] for k, part in enumerate(parts)]
                slices.append(sum(seconds(words) for words in cut))
                merges.append(seconds([program, "merge", "-q", *parts, "-o", path("all.exr")]))
            ratios = [(a + b) / one for one, a, b in zip(ones, slices, merges)]
            diff = subprocess.run(
                [program, "diff", "-q", "--json", path("all.exr"), path("one.exr")], stdout=subprocess.PIPE, check=True
            )
            median = statistics.median
            numbers = [median(ones), median(slices), median(merges), median(ratios), min(ratios), max(ratios)]
            shown = ",".join(f"{number:.4g}" for number in numbers)
            rmse = json.loads(diff.stdout)["rmse"]
            print(f"{os.path.basename(scene)},{spp},{options.of},{options.passes},{shown},{rmse:.3g}", flush=True)


if __name__ == "__main__":
    main()
