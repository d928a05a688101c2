#!/usr/bin/env python3
"""Specula beside Mitsuba 3 on landscapes: memory at its peak per triangle, and seconds to the first samples.

    pip install mitsuba==3.9.1 numpy       # in an environment of its own
    cargo build --release
    DRJIT_LIBLLVM_PATH=PATH/OF/libLLVM-19.so benches/peers/footprint.py [--millions 1 10] [--passes N] [--markdown FILE]

A height field of 1 M and one of 10 M triangles is written as a binary PLY file without normals, and rendered with one sample for each
of 64 x 64 pixels, paths of at most 5 vertices under a constant sky, by a process of its own each time. Seconds go by the clock from the start of
the process to its end, a picture written. Memory is the most that was resident (`getrusage`), and the same less that of a run
on 2 triangles: what triangles cost. Medians over the passes, contestants in turn; in brackets half the distance between the quartiles.
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parents[2]
SPECULA = HERE / "target/release/specula"
SIZE, DEPTH = 64, 5


def write_landscape(file, cells):
    """Hills over [-1, 1]^2, two triangles to each of `cells` x `cells`."""
    side = np.linspace(-1, 1, cells + 1, dtype=np.float32)
    x, z = np.meshgrid(side, side)
    y = 0.1 * np.sin(7 * x) * np.cos(5 * z) + 0.02 * np.sin(61 * x + 47 * z) + 0.004 * np.sin(391 * x - 433 * z)
    corner = np.arange(cells, dtype=np.int32)[None, :] + np.arange(cells, dtype=np.int32)[:, None] * (cells + 1)
    a, b, c, d = corner, corner + 1, corner + cells + 2, corner + cells + 1
    faces = np.empty(2 * cells * cells, dtype=np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    faces["count"] = 3
    faces["corners"] = np.stack([a, d, c, a, c, b], axis=-1).reshape(-1, 3)
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {x.size}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {faces.size}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    with file.open("wb") as out:
        out.write(head.encode())
        np.stack([x, y, z], axis=-1).astype("<f4").tofile(out)
        faces.tofile(out)
    return int(faces.size)


def specula_command(folder, mesh):
    scene = folder / f"{mesh.stem}.toml"
    scene.write_text(
        f"[camera]\nfrom = [0.0, 1.1, 2.2]\nat = [0.0, 0.2, 0.0]\nvfov_deg = 45.0\n[film]\nwidth = {SIZE}\nheight = {SIZE}\n"
        f"[render]\nintegrator = \"path\"\nspp = 1\nmax_depth = {DEPTH}\n[materials.rock]\ntype = \"diffuse\"\n"
        f"[[shapes]]\ntype = \"mesh\"\nfile = \"{mesh.name}\"\nnormals = \"flat\"\nmaterial = \"rock\"\n"
        "[[lights]]\ntype = \"environment\"\nradiance = 1.0\n"
    )
    return [SPECULA, "render", scene, "-q", "-o", folder / "specula.exr"]


def mitsuba_command(folder, mesh):
    return [sys.executable, __file__, "--mitsuba", mesh, folder / "mitsuba.exr"]


def render_with_mitsuba(mesh, picture):
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    look = mi.ScalarTransform4f().look_at([0.0, 1.1, 2.2], [0.0, 0.2, 0.0], [0.0, 1.0, 0.0])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "component_format": "float32"}
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": DEPTH, "rr_depth": 1_000_000},
            "sensor": {"type": "perspective", "fov_axis": "y", "fov": 45.0, "to_world": look, "film": film},
            "rock": {"type": "ply", "filename": mesh, "face_normals": True, "bsdf": {"type": "diffuse"}},
            "sky": {"type": "constant", "radiance": 1.0},
        }
    )
    mi.Bitmap(mi.render(scene, spp=1)).write(picture)


def run(command):
    """Seconds by the clock, and bytes resident at most."""
    start = time.monotonic()
    child = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        raise SystemExit(f"{command[0]} failed")
    return time.monotonic() - start, usage.ru_maxrss * 1024


def shown(values, digits):
    quarter = statistics.quantiles(values, n=4) if len(values) > 1 else [values[0]] * 3
    return f"{statistics.median(values):.{digits}f} ({(quarter[2] - quarter[0]) / 2:.{digits}f})"


def main():
    if sys.argv[1:2] == ["--mitsuba"]:
        render_with_mitsuba(*sys.argv[2:4])
        return
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--millions", type=float, nargs="+", default=[1, 10])
    arguments.add_argument("--passes", type=int, default=5)
    arguments.add_argument("--markdown", type=pathlib.Path)
    arguments = arguments.parse_args()
    lines = [
        "| triangles | contestant | s to the first samples | peak bytes per triangle | less that of an empty scene |",
        "|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        contestants = {"specula": specula_command, "mitsuba llvm_ad_rgb": mitsuba_command}
        write_landscape(folder / "empty.ply", 1)
        empty = {name: run(command(folder, folder / "empty.ply"))[1] for name, command in contestants.items()}
        for millions in arguments.millions:
            mesh = folder / "landscape.ply"
            triangles = write_landscape(mesh, round((millions * 5e5) ** 0.5))
            found = {name: [] for name in contestants}
            for turn in range(arguments.passes):
                for name in list(contestants)[:: 1 if turn % 2 == 0 else -1]:
                    found[name].append(run(contestants[name](folder, mesh)))
            for name, runs in found.items():
                line = (
                    f"| {triangles:,} | {name} | {shown([run[0] for run in runs], 2)} | "
                    f"{shown([run[1] / triangles for run in runs], 0)} | "
                    f"{shown([(run[1] - empty[name]) / triangles for run in runs], 0)} |"
                )
                lines.append(line)
                print(line, flush=True)
    if arguments.markdown:
        arguments.markdown.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
