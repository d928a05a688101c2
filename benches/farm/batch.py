#!/usr/bin/env python3
"""What a batch costs: many tiny jobs, and the memory of a long sequence.

    python3 benches/farm/batch.py [--program target/release/specula] jobs [--count 10000]
    python3 benches/farm/batch.py [--program target/release/specula] frames [--count 500] [--size 64x36] [--side 200]

`jobs` renders pictures of 2 by 2 pixels with one sample, each a job with its own seed, then runs the batch again, when all is done, and
renders some of them by `specula render`, a process each. `frames` renders a sequence in which a mesh of 2 * side^2 triangles moves, so
that its hierarchy is built for each frame, and tells the memory in use (resident, MiB) in each tenth of it. CPU seconds are those of processes.
"""

import argparse
import json
import math
import os
import subprocess
import tempfile
import threading
import time

SCENE = """
[camera]
from = [0.0, 1.0, 4.0]
at = [0.0, 0.5, 0.0]
[film]
width = 2
height = 2
[render]
integrator = "path"
spp = 1
[materials.glass]
type = "dielectric"
[materials.wall]
type = "diffuse"
[[shapes]]
type = "sphere"
center = [0.0, 0.5, 0.0]
radius = 0.5
material = "glass"
[[shapes]]
type = "rectangle"
edge_u = [4.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -4.0]
material = "wall"
[[lights]]
type = "environment"
radiance = 1.0
"""

MOVING = """
[[shapes]]
type = "mesh"
file = "grid.obj"
material = "wall"
keys = [{ time_s = 0.0, transform = [{ translate = [0.0, 0.0, 0.0] }] }, { time_s = 100.0, transform = [{ translate = [0.0, 1.0, 0.0] }] }]
"""


def run(words, watch=None):
    """Seconds by the clock and of CPU, and what a program that must succeed says."""
    begin = time.monotonic()
    child = subprocess.Popen(words, stdout=subprocess.PIPE)
    said = []
    reader = threading.Thread(target=lambda: said.append(child.stdout.read()))
    reader.start()
    while watch and os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
        watch(child.pid)
        time.sleep(0.005)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = status
    reader.join()
    if status != 0:
        raise SystemExit(f"{' '.join(words)}: status {status}")
    return time.monotonic() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, said[0]


def jobs(program, options, path):
    with open(path("scene.toml"), "w") as file:
        file.write(SCENE)
    with open(path("batch.toml"), "w") as file:
        file.write("[defaults]\nscene = 'scene.toml'\noutputs = ['{name}.exr']\n")
        for i in range(options.count):
            file.write(f"[[jobs]]\nname = 'j{i}'\noverrides = {{ render.seed = {i} }}\n")
    print("what,jobs,side_by_side,wall_s,cpu_s,peak_mib,cpu_ms_each")
    for side in ["1", "2"]:
        for what, flags in [("rendered", ["--force"]), ("done before", [])]:
            words = [program, "batch", "-q", "--json", path("batch.toml"), "--jobs", side, *flags]
            wall, cpu, peak, said = run(words)
            counts = json.loads(said)["counts"]
            if counts[what.replace(" ", "_")] != options.count:
                raise SystemExit(f"{counts}")
            print(f"{what},{options.count},{side},{wall:.2f},{cpu:.2f},{peak:.0f},{1000 * cpu / options.count:.2f}", flush=True)
    some = min(options.count, 200)
    walls, cpus = [], []
    for i in range(some):
        words = [program, "render", path("scene.toml"), "-q", "--seed", str(i), "-o", path("one.exr")]
        wall, cpu, peak, _ = run(words)
        walls.append(wall)
        cpus.append(cpu)
    print(f"a process each,{some},1,{sum(walls):.2f},{sum(cpus):.2f},{peak:.0f},{1000 * sum(cpus) / some:.2f}")


def frames(program, options, path):
    side = options.side
    with open(path("grid.obj"), "w") as file:
        for j in range(side + 1):
            for i in range(side + 1):
                file.write(f"v {2 * i / side - 1} {0.1 * math.sin(i * j * 0.01):.4f} {2 * j / side - 1}\n")
        for j in range(side):
            for i in range(side):
                corner = j * (side + 1) + i + 1
                file.write(f"f {corner} {corner + 1} {corner + side + 2} {corner + side + 1}\n")
    with open(path("scene.toml"), "w") as file:
        file.write(SCENE + MOVING)
    width, height = options.size.split("x")
    most = [0] * 10

    def watch(pid):
        done = sum(name.endswith(".exr") for name in os.listdir(path("")))
        try:
            with open(f"/proc/{pid}/status") as file:
                line = next((line for line in file if line.startswith("VmRSS:")), "VmRSS: 0 kB")
        except OSError:
            return
        tenth = min(done * 10 // options.count, 9)
        most[tenth] = max(most[tenth], int(line.split()[1]) / 1024)

    words = [program, "batch", "-q", "--json", path("scene.toml"), "--frames", f"1..{options.count}", "-o", path("#.exr")]
    words += ["-D", f"film.width={width}", "-D", f"film.height={height}"]
    wall, cpu, peak, said = run(words, watch)
    if json.loads(said)["counts"]["rendered"] != options.count:
        raise SystemExit(said)
    print("frames,triangles,wall_s,cpu_s,peak_mib,most_resident_mib_in_each_tenth")
    print(f"{options.count},{2 * side * side},{wall:.2f},{cpu:.2f},{peak:.1f}," + ",".join(f"{mib:.1f}" for mib in most))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/release/specula")
    parser.add_argument("what", choices=["jobs", "frames"])
    parser.add_argument("--count", type=int)
    parser.add_argument("--size", default="64x36")
    parser.add_argument("--side", type=int, default=200)
    options = parser.parse_args()
    options.count = options.count or {"jobs": 10000, "frames": 500}[options.what]
    program = os.path.abspath(options.program)
    with tempfile.TemporaryDirectory() as folder:
        path = lambda name: os.path.join(folder, name)
        {"jobs": jobs, "frames": frames}[options.what](program, options, path)


if __name__ == "__main__":
    main()
