#!/usr/bin/env python3
"""Kills a rendering at random times and lets it go on, until it has been killed often enough; then compares the picture.

    python3 benches/farm/kills.py [--program target/release/specula] [--kills 100] [--every 1.0] [--seed 1] [--size 480x270] SCENE[:SPP]

Told are, over all kills: how old the last copy was (from the moment at which it was taken, so that this is the work that was
lost, but for samples of tiles under way: up to 1/16 of the interval), how long runs that were killed before their first copy had
worked (from the moment at which they said from what they begin, so that building the hierarchy counts, too), and whether the
picture is that of a run that nobody killed (an MSE of 0). Neither may be longer than the interval.
"""

import argparse
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time


class Run:
    """A rendering, and what it has said of its copies."""

    def __init__(self, words):
        self.begin, self.copies, self.said = None, [], []
        self.child = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.reader = threading.Thread(target=self.read)
        self.reader.start()

    def read(self):
        for line in self.child.stderr:
            self.said.append(line.rstrip())
            if self.begin is None and re.search("beginning anew|going on from", line):
                self.begin = time.monotonic()
            kept = re.search(r"kept (\d+) samples in .*, ([0-9.]+) s", line)
            if kept:
                self.copies.append((time.monotonic() - float(kept[2]), int(kept[1])))

    def end(self):
        self.child.wait()
        self.reader.join()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--program", default="target/release/specula")
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--every", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("scene")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    width, height = options.size.split("x")
    scene, _, spp = options.scene.partition(":")
    common = [program, "render", scene, "--integrator", "path", "--spp", spp or "4096"]
    common += ["--width", width, "--height", height]
    dice = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        path = lambda name: os.path.join(folder, name)
        subprocess.run([*common, "-q", "-o", path("one.exr")], stdout=subprocess.DEVNULL, check=True)
        words = [*common, "--log-level", "debug", "--checkpoint", path("a.ckpt")]
        words += ["--checkpoint-every", f"{options.every}s", "--resume", "-o", path("kept.exr")]
        kills, pictures, ages, begun = 0, 0, [], []
        while kills < options.kills:
            run = Run(words)
            time.sleep(dice.uniform(0.0, 4.0 * options.every))
            killed = time.monotonic()
            run.child.send_signal(signal.SIGKILL)
            run.end()
            if run.child.returncode == 0:
                pictures += same(program, path)
                os.remove(path("kept.exr"))
                continue
            kills += 1
            if os.path.exists(path("kept.exr")):
                raise SystemExit("a picture before its end")
            if run.copies:
                ages.append(killed - run.copies[-1][0])
            else:
                # One that has not said so yet has lost nothing.
                begun.append(killed - (run.begin or killed))
                if begun[-1] > options.every:
                    raise SystemExit(f"no copy after {begun[-1]:.3f} s: {run.said}")
        subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        pictures += same(program, path)
        ages.sort()
        print("scene,spp,every_s,kills,with_copy,before_first,before_first_most_s,age_median_s,age_most_s,pictures_the_same")
        print(
            f"{os.path.basename(scene)},{spp},{options.every},{kills},{len(ages)},{len(begun)},"
            f"{max(begun, default=0.0):.3f},{ages[len(ages) // 2]:.3f},{ages[-1]:.3f},{pictures}"
        )
        if ages[-1] > options.every:
            sys.exit(f"a copy was {ages[-1]:.3f} s old")


def same(program, path):
    """1; ends if the picture is another one."""
    words = [program, "diff", "-q", "--metric", "mse", "--max-error", "0", path("kept.exr"), path("one.exr")]
    if subprocess.run(words, stdout=subprocess.DEVNULL).returncode != 0:
        raise SystemExit("another picture")
    return 1


if __name__ == "__main__":
    main()
