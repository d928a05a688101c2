#!/usr/bin/env python3
"""The scenes of benches/record/choosing.md, raced by `specula bench`, and its tables.

    python3 benches/reports/choosing.py DATA OUT [--program target/release/specula] [--only dragon,sponza,dining,1m,10m]

DATA holds the models (models/obj/dragon.obj and sponza.obj, scenes/dining-room/models/*.obj). OUT gets the scene files, a JSON
document and an HTML page for each scene, and tables.md, which is made of the documents alone: a scene whose document is there
is not raced again. Needs numpy.
"""

import argparse
import json
import os
import subprocess

import numpy as np

SUN_AND_SKY = """
[[lights]]
type = "directional"
direction = {sun}
irradiance = {irradiance}

[[lights]]
type = "environment"
radiance = {sky}
"""

CLASSES = ["primary", "shadow", "specular", "diffuse1", "diffuse4", "random"]
BUILDS = ["embree-medium-robust", "embree-medium-compact", "embree-low", "embree-high", "bvh2-medium", "cwbvh-medium", "bvh2-very_slow", "cwbvh-very_slow"]
KINDS = [(f"packet{n}", coherent) for coherent in (True, False) for n in (4, 8, 16)] + [("stream", True), ("stream", False)]
REASONS = ["shared_edge", "id_tie", "epsilon", "lost_at_edge", "lost", "other"]


def value_noise(x, z, octave):
    """Random values on a grid (PCG2D of Jarzynski and Olano 2020), joined smoothly."""
    x0, z0 = np.floor(x), np.floor(z)
    fx, fz = ((t * t * (3 - 2 * t)) for t in (x - x0, z - z0))
    i, j = x0.astype(np.int64), z0.astype(np.int64) + 4096 * octave

    def corner(di, dj):
        a, b = (i + di).astype(np.uint32), (j + dj).astype(np.uint32)
        scale = np.uint32(1664525)
        a, b = (v * scale + np.uint32(1013904223) for v in (a, b))
        for _ in range(2):
            a = a + b * scale
            b = b + a * scale
            a, b = (v ^ (v >> np.uint32(16)) for v in (a, b))
        return (a >> np.uint32(8)) / 2.0**24

    low = corner(0, 0) * (1 - fx) + corner(1, 0) * fx
    high = corner(0, 1) * (1 - fx) + corner(1, 1) * fx
    return low * (1 - fz) + high * fz


def height(x, z):
    """Nine octaves of ridged noise, between 0 and about 0.6."""
    total, size, weight = 0.0, 2.0, 0.25
    for octave in range(9):
        ridge = 1 - np.abs(2 * value_noise(x * size, z * size, octave) - 1)
        total = total + weight * ridge * ridge
        size, weight = size * 2, weight * 0.45
    return total


def landscape(file, cells):
    """Writes 2 * cells * cells triangles over a square of side 2."""
    along = np.linspace(-1, 1, cells + 1)
    x, z = np.meshgrid(along, along)
    points = np.stack([x, height(x, z), z], axis=-1).reshape(-1, 3).astype("<f4")
    i = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    faces = np.empty(2 * i.size, dtype=[("n", "u1"), ("v", "<i4", 3)])
    faces["n"] = 3
    faces["v"][0::2] = np.stack([i, i + cells + 1, i + 1], axis=-1)
    faces["v"][1::2] = np.stack([i + 1, i + cells + 1, i + cells + 2], axis=-1)
    with open(file, "wb") as out:
        out.write(
            "ply\nformat binary_little_endian 1.0\n"
            f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n".encode()
        )
        out.write(points.tobytes())
        out.write(faces.tobytes())


def mesh(file, material):
    return f'\n[[shapes]]\ntype = "mesh"\nfile = {json.dumps(os.path.abspath(file))}\nmaterial = "{material}"\n'


def head(eye, at, angle):
    return (
        f"[camera]\nfrom = {eye}\nat = {at}\nvfov_deg = {angle}\n[film]\nwidth = 512\nheight = 512\n"
        '[materials.matt]\ntype = "diffuse"\nreflectance = 0.6\n[materials.polished]\ntype = "mirror"\nreflectance = 0.8\n'
    )


def ground(cells, out):
    file = os.path.join(out, f"landscape_{cells}.ply")
    if not os.path.exists(file):
        landscape(file, cells)
    eye = [0.9, float(height(np.array(0.9), np.array(0.9))) + 0.25, 0.9]
    return (
        head(eye, [0.0, 0.2, 0.0], 50.0)
        + mesh(file, "matt").rstrip() + '\nnormals = "flat"\n'
        + SUN_AND_SKY.format(sun=[1.0, -0.6, -0.4], irradiance=3.0, sky=[0.3, 0.4, 0.6])
    )


def scenes(data, out):
    """Name in tables, file's stem, text of the scene, and what else `bench` is told."""
    lit = SUN_AND_SKY.format(sun=[-0.5, -1.0, -0.3], irradiance=5.0, sky=1.0)
    dragon = (
        head([1.6, 1.9, 4.6], [0.0, 0.82, 0.0], 30.0)
        + mesh(f"{data}/models/obj/dragon.obj", "polished").rstrip() + "\ntransform = [{ fit = 2.0 }]\n"
        + '\n[[shapes]]\ntype = "rectangle"\nedge_u = [9.0, 0.0, 0.0]\nedge_v = [0.0, 0.0, -9.0]\ncenter = [0.0, 0.0, 0.0]\nmaterial = "matt"\n'
        + lit
    )
    sponza = head([-600.0, 150.0, 20.0], [600.0, 300.0, -40.0], 60.0) + mesh(f"{data}/models/obj/sponza.obj", "matt") + lit
    folder = f"{data}/scenes/dining-room/models"
    room = head([-0.587317, 2.7623, 9.71429], [-0.574259, 2.698437, 8.716417], 36.0) + SUN_AND_SKY.format(
        sun=[-0.887, -0.289, -0.36], irradiance=10.0, sky=1.0
    )
    for file in sorted(os.listdir(folder)):
        if file.endswith(".obj"):
            room += mesh(f"{folder}/{file}", "matt")
    yield "dragon on a stage, 100 k", "dragon", lambda: dragon, []
    yield "Sponza, 34 k", "sponza", lambda: sponza, ["--rays", "8192"]
    yield "dining room, 270 k", "dining", lambda: room, ["--rays", "8192"]
    yield "landscape, 1 M", "1m", lambda: ground(708, out), []
    yield "landscape, 10 M", "10m", lambda: ground(2236, out), ["--quick", "--rays", "8192"]


def pair(value, digits=2):
    return "-" if value is None else f"{value[0]:.{digits}f} ± {value[1]:.{digits}f}"


def rate(scene, name, contestant, query="single", coherent=None, threads=1):
    for row in scene["rates"]:
        hits = "any" if name == "shadow" else "closest"
        if (row["class"], row["contestant"], row["query"], row["coherent"], row["hits"], row["threads"]) == (
            name, contestant, query, coherent, hits, threads,
        ):
            return row
    return None


def over(top, bottom):
    """The ratio of two medians and, as relative spreads add, its spread."""
    if top is None or bottom is None:
        return None
    (a, da), (b, db) = top["rays_per_cpu_s"], bottom["rays_per_cpu_s"]
    return [a / b, a / b * (da / a + db / b)]


def table(columns, rows):
    yield "| " + " | ".join(columns) + " |"
    yield "|" + "---|" * len(columns)
    for row in rows:
        yield "| " + " | ".join(row) + " |"


def tables(found):
    machine, build = found[0][1]["machine"], found[0][1]["build"]
    yield f"{machine['processor']}, {machine['processors']} processors, {machine['isa']}; {build['rustc']}; commit {build['commit']}"
    for name, document in found:
        settings, machine = document["settings"], document["machine"]
        yield f"{name}: {settings['passes']} passes, {settings['rays_per_class']} rays a class, load {machine['load_before']} to {machine['load_after']}"
    yield "\n## Single rays\n"
    rows, kinds, threads, builds, answers = [], [], [], [], []
    for name, document in found:
        [scene] = document["scenes"]
        for of in CLASSES:
            base = rate(scene, of, "embree-medium")
            if base is None:
                continue
            what = f"{of}, {'any' if of == 'shadow' else 'closest'}"
            rows.append([name, what, pair([v / 1e6 for v in base["rays_per_cpu_s"]], 1)] + [pair(over(rate(scene, of, b), base)) for b in BUILDS])
            kinds.append([name, what] + [pair(over(rate(scene, of, "embree-medium", q, c), base)) for q, c in KINDS])
            both = [rate(scene, of, b, threads=2) for b in ("embree-medium", "bvh2-medium", "cwbvh-medium")]
            threads.append([name, what] + [pair(row and row["scaling"]) for row in both])
        for row in scene["builds"]:
            times = " / ".join(f"{t['cpu_s'][0]:.3f} ({t['wall_s'][0]:.3f}) on {t['threads']}" for t in row["times"])
            builds.append([name, row["contestant"], times, f"{row['bytes'] / scene['primitives']:.0f}"])
        cells, total = [], 0
        for contestant in ["embree-medium", "embree-medium-robust", "bvh2-medium", "cwbvh-medium"]:
            counted = dict.fromkeys(REASONS, 0)
            asked = [r for r in scene["agreement"] if r["contestant"] == contestant and r["query"] == "single" and r["hits"] == "closest"]
            total = max(total, sum(r["rays"] for r in asked))
            for row in asked:
                for reason in REASONS:
                    counted[reason] += row[reason]
            cells.append(", ".join(f"{n} {reason}" for reason, n in counted.items() if n) or ("none" if asked else "-"))
        answers.append([name, str(total)] + cells)
    short = [b.removeprefix("embree-medium-").removeprefix("embree-").replace("-", " ") for b in BUILDS]
    yield from table(["scene", "rays, hits", "embree, Mrays"] + short, rows)
    yield "\n## Kinds of query\n"
    yield from table(["scene", "rays, hits"] + [f"{q} {'coherent' if c else 'incoherent'}" for q, c in KINDS], kinds)
    yield "\n## Two threads over one\n"
    yield from table(["scene", "rays, hits", "embree", "bvh2", "cwbvh"], threads)
    yield "\n## Builds\n"
    yield from table(["scene", "build", "CPU s (wall)", "bytes a triangle"], builds)
    yield "\n## Answers\n"
    yield from table(["scene", "rays", "embree", "robust", "bvh2", "cwbvh"], answers)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data")
    parser.add_argument("out")
    parser.add_argument("--program", default="target/release/specula")
    parser.add_argument("--only", default="dragon,sponza,dining,1m,10m")
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    found = []
    for name, stem, text, more in scenes(os.path.abspath(options.data), options.out):
        document = os.path.join(options.out, f"{stem}.json")
        if stem in options.only.split(",") and not os.path.exists(document):
            file = os.path.join(options.out, f"{stem}.toml")
            with open(file, "w") as out:
                out.write(text())
            page = os.path.join(options.out, f"{stem}.html")
            words = [options.program, "bench", file, "--json", "--report", page, *more]
            done = subprocess.run(words, stdout=subprocess.PIPE, check=True)
            with open(document + ".part", "wb") as out:
                out.write(done.stdout)
            os.rename(document + ".part", document)
        if os.path.exists(document):
            with open(document) as file:
                found.append((name, json.load(file)))
    if found:
        with open(os.path.join(options.out, "tables.md"), "w") as out:
            out.write("\n".join(tables(found)) + "\n")


if __name__ == "__main__":
    main()
