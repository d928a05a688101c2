#!/usr/bin/env python3
"""Specula beside Mitsuba 3 on the same scenes and cores: samples per second of CPU, error, efficiency.

    pip install mitsuba==3.9.1 numpy       # in an environment of its own
    cargo build --release
    DRJIT_LIBLLVM_PATH=/usr/lib/x86_64-linux-gnu/libLLVM-19.so benches/peers/efficiency.py [--passes N] [--markdown FILE]

Contestants render each scene of `shared/data/peer-scenes` in turn, there and back, pass after pass, each pass with another
seed. Time is CPU time of rendering alone: what Mitsuba compiles and loads, and what Specula loads and builds, is left out. Errors are against
the converged references, which are half as wide and high: pictures are averaged two by two first. relMSE = mean of
(x - r)^2 / (r^2 + 0.01) over pixels and channels. Efficiency is 1 / (relMSE * CPU seconds). Shown are medians over the passes, and in brackets
half the distance between the quartiles.
"""

import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402  (needs a variant)

HERE = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ.get("SPECULA_DATA", HERE / "../shared/data")) / "peer-scenes"
SPECULA = HERE / "target/release/specula"
SIZE = 512


def mitsuba_scene(name, sampler):
    """The scene as Mitsuba has it, without roulette."""
    scene = json.loads((DATA / name / "scene.json").read_text())
    camera = scene["camera"]
    look = mi.ScalarTransform4f().look_at(camera["origin"], camera["target"], camera["up"])
    parts = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": scene["max_depth"], "rr_depth": 1_000_000},
        "sensor": {
            "type": "perspective",
            "fov_axis": "y",
            "fov": camera["vfov"],
            "to_world": look,
            "sampler": {"type": sampler, "sample_count": 16},
            "film": {
                "type": "hdrfilm",
                "width": SIZE,
                "height": SIZE,
                "rfilter": {"type": "box"},
                "component_format": "float32",
            },
        },
    }
    rgb = lambda value: {"type": "rgb", "value": value}
    for shape in scene["shapes"]:
        material = shape["material"]
        part = {"type": "obj", "filename": str(DATA / name / shape["obj"]), "face_normals": True}
        if material["type"] == "emitter":
            part["emitter"] = {"type": "area", "radiance": rgb(material["radiance"])}
            part["bsdf"] = {"type": "diffuse", "reflectance": rgb([0, 0, 0])}
        elif material["type"] == "diffuse":
            part["bsdf"] = {"type": "diffuse", "reflectance": rgb(material["albedo"])}
        else:
            part["bsdf"] = {
                "type": "roughconductor",
                "distribution": "ggx",
                "alpha": material["alpha"],
                "eta": rgb(material["eta"]),
                "k": rgb(material["k"]),
            }
        parts[shape["name"]] = part
    if scene["environment"]:
        parts["environment"] = {"type": "constant", "radiance": rgb(scene["environment"])}
    return mi.load_dict(parts)


def specula_scene(name, folder):
    """The scene as a file of ours."""
    scene = json.loads((DATA / name / "scene.json").read_text())
    camera = scene["camera"]
    number = lambda values: str([float(value) for value in values])
    text = [
        f"[camera]\nfrom = {number(camera['origin'])}\nat = {number(camera['target'])}\nup = {number(camera['up'])}",
        f"vfov_deg = {camera['vfov']}",
        f"[film]\nwidth = {SIZE}\nheight = {SIZE}\nfilter = \"box\"",
        f"[render]\nintegrator = \"path\"\nmax_depth = {scene['max_depth']}",
    ]
    for shape in scene["shapes"]:
        material = shape["material"]
        mesh = f"type = \"mesh\"\nfile = \"{DATA / name / shape['obj']}\""
        if material["type"] == "emitter":
            text.append(f"[[lights]]\n{mesh}\nradiance = {number(material['radiance'])}")
            continue
        if material["type"] == "diffuse":
            surface = f"type = \"diffuse\"\nreflectance = {number(material['albedo'])}"
        else:
            surface = (
                f"type = \"conductor\"\neta = {number(material['eta'])}\nk = {number(material['k'])}\n"
                f"alpha = {material['alpha']}"
            )
        text.append(f"[materials.{shape['name']}]\n{surface}")
        text.append(f"[[shapes]]\n{mesh}\nnormals = \"flat\"\nmaterial = \"{shape['name']}\"")
    if scene["environment"]:
        text.append(f"[[lights]]\ntype = \"environment\"\nradiance = {number(scene['environment'])}")
    file = pathlib.Path(folder) / f"{name}.toml"
    file.write_text("\n".join(text) + "\n")
    return file


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def run_mitsuba(scene, spp, seed):
    start = cpu_seconds()
    picture = np.array(mi.render(scene, spp=spp, seed=seed))
    dr.sync_thread()
    return cpu_seconds() - start, picture[:, :, :3]


def run_specula(file, folder, spp, seed, settings):
    picture, stats = pathlib.Path(folder) / "picture.exr", pathlib.Path(folder) / "stats.json"
    command = [SPECULA, "render", file, "-q", "-o", picture, "--stats", stats, "--spp", spp, "--seed", seed]
    subprocess.run([str(word) for word in command + settings], check=True, stdout=subprocess.DEVNULL)
    report = json.loads(stats.read_text())
    return report["phases"]["render"]["cpu_s"], np.array(mi.Bitmap(str(picture)))[:, :, :3]


def relative_error(picture, reference):
    half = picture.reshape(SIZE // 2, 2, SIZE // 2, 2, 3).mean(axis=(1, 3), dtype=np.float64)
    return float(np.mean((half - reference) ** 2 / (reference**2 + 0.01))), float(np.mean(half - reference) / np.mean(reference))


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--passes", type=int, default=5)
    arguments.add_argument("--spp", type=int, default=32)
    arguments.add_argument("--markdown", type=pathlib.Path)
    arguments = arguments.parse_args()
    lines = ["| scene | contestant | Msamples per CPU s | relMSE, 10^-6 | bias | efficiency | of the best Mitsuba row |", "|---|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as folder:
        for name in ["cornell", "glossyrow"]:
            reference = np.array(mi.Bitmap(str(DATA / name / "reference.exr")), dtype=np.float64)[:, :, :3]
            file = specula_scene(name, folder)
            spp = arguments.spp
            contestants = {}
            for sampler in ["independent", "multijitter"]:
                scene = mitsuba_scene(name, sampler)
                run_mitsuba(scene, spp, 1_000)
                contestants[f"mitsuba {sampler}"] = lambda seed, scene=scene: run_mitsuba(scene, spp, seed)
            for sampler in ["independent", "sobol", "blue_noise"]:
                settings = ["--sampler", sampler]
                contestants[f"specula {sampler}"] = lambda seed, settings=settings: run_specula(
                    file, folder, spp, seed, settings
                )
            found = {contestant: [] for contestant in contestants}
            for turn in range(arguments.passes):
                order = list(contestants) if turn % 2 == 0 else list(contestants)[::-1]
                for contestant in order:
                    seconds, picture = contestants[contestant](turn)
                    found[contestant].append((seconds, *relative_error(picture, reference)))
            rows = {}
            for contestant, runs in found.items():
                rates = [SIZE * SIZE * spp / seconds / 1e6 for seconds, _, _ in runs]
                errors = [error for _, error, _ in runs]
                bias = statistics.mean(bias for _, _, bias in runs)
                efficiency = 1 / (statistics.mean(errors) * statistics.median(run[0] for run in runs))
                rows[contestant] = (rates, errors, bias, efficiency)
            best = max(row[3] for contestant, row in rows.items() if contestant.startswith("mitsuba"))
            for contestant, (rates, errors, bias, efficiency) in rows.items():
                quarter = statistics.quantiles(rates, n=4) if len(rates) > 1 else [rates[0]] * 3
                line = (
                    f"| {name} | {contestant} | {statistics.median(rates):.2f} ({(quarter[2] - quarter[0]) / 2:.2f}) | "
                    f"{statistics.mean(errors) * 1e6:.0f} | {bias:+.1e} | {efficiency:.0f} | {efficiency / best:.2f} |"
                )
                lines.append(line)
                print(line, flush=True)
    if arguments.markdown:
        arguments.markdown.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
