#!/usr/bin/env python3
"""Specula beside Mitsuba 3 on the same scenes and cores: samples per second of CPU, error, efficiency.

    pip install mitsuba==3.9.1 numpy       # in an environment of its own
    cargo build --release
    DRJIT_LIBLLVM_PATH=PATH/OF/libLLVM-19.so benches/peers/efficiency.py [--scenes NAME ..] [--passes N] [--markdown FILE]

Scenes: `cornell` and `glossyrow` of `peer-scenes` in the folder that `SPECULA_DATA` names; `glass`, the box of the first with a ball of glass and one of rough gold in it; and
`landscape`, a million triangles under a picture of a sky and a square light. Contestants render each in turn, there and back, pass
after pass, each pass with another seed. Time is CPU time of rendering alone: what Mitsuba compiles and loads, and what Specula loads and builds, is
left out. The rows with `--target-error` end by error instead of by a number of samples. Efficiency is 1 / (relMSE * CPU seconds), relMSE the mean of (x - r)(x - s) / (m^2 + 0.01) over pixels and channels, where r and s are two long
pictures by Mitsuba with the mean m: their own noise cancels. It is told for the picture as it is, and averaged two by two. Bias is the mean of
x - m over that of m. Shown are medians of times and means of errors over the passes, and in brackets half the distance between the quartiles.
"""

import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile

import footprint
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402  (needs a variant)

HERE = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ.get("SPECULA_DATA", HERE / "../shared/data"))
SPECULA = HERE / "target/release/specula"
SCENES = ["cornell", "glossyrow", "glass", "landscape"]
SIZE = 512
GOLD = {"type": "conductor", "eta": [0.143, 0.375, 1.442], "k": [3.983, 2.386, 1.603]}


def described(name, folder):
    """A scene as `peer-scenes` writes it, with balls, glass and pictures of skies besides."""
    if name == "landscape":
        footprint.write_landscape(folder / "landscape.ply", 707)
        light = folder / "light.obj"
        light.write_text("v -0.3 1.2 -0.9\nv 0.3 1.2 -0.9\nv 0.3 1.2 -0.3\nv -0.3 1.2 -0.3\nf 1 2 3\nf 1 3 4\n")
        return {
            "max_depth": 5,
            "camera": {"origin": [0.0, 1.1, 2.2], "target": [0.0, 0.1, 0.0], "up": [0, 1, 0], "vfov": 45.0},
            "environment": str(DATA / "env/quarry_03_1k.exr"),
            "shapes": [
                {
                    "name": "rock",
                    "obj": str(folder / "landscape.ply"),
                    "material": {"type": "diffuse", "albedo": [0.5, 0.45, 0.4]},
                },
                {"name": "light", "obj": str(light), "material": {"type": "emitter", "radiance": [20.0, 17.0, 12.0]}},
            ],
        }
    place = DATA / "peer-scenes" / ("cornell" if name == "glass" else name)
    scene = json.loads((place / "scene.json").read_text())
    for shape in scene["shapes"]:
        shape["obj"] = str(place / shape["obj"])
    if name == "glass":
        scene["max_depth"] = 12
        scene["shapes"] = [shape for shape in scene["shapes"] if shape["name"] not in ("tall", "short")]
        scene["shapes"] += [
            {"name": "ball", "ball": [0.42, -0.62, 0.35, 0.38], "material": {"type": "dielectric", "ior": 1.5}},
            {"name": "gold", "ball": [-0.42, -0.55, -0.3, 0.45], "material": GOLD | {"alpha": 0.15}},
        ]
    return scene


def mitsuba_scene(scene, sampler):
    """The scene as Mitsuba has it, without roulette."""
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
        if "ball" in shape:
            *center, radius = shape["ball"]
            part = {"type": "sphere", "center": center, "radius": radius}
        else:
            kind = pathlib.Path(shape["obj"]).suffix[1:]
            part = {"type": kind, "filename": shape["obj"], "face_normals": True}
        if material["type"] == "emitter":
            part["emitter"] = {"type": "area", "radiance": rgb(material["radiance"])}
            part["bsdf"] = {"type": "diffuse", "reflectance": rgb([0, 0, 0])}
        elif material["type"] == "diffuse":
            part["bsdf"] = {"type": "diffuse", "reflectance": rgb(material["albedo"])}
        elif material["type"] == "dielectric":
            part["bsdf"] = {"type": "dielectric", "int_ior": material["ior"], "ext_ior": 1.0}
        else:
            part["bsdf"] = {
                "type": "roughconductor",
                "distribution": "ggx",
                "alpha": material["alpha"],
                "eta": rgb(material["eta"]),
                "k": rgb(material["k"]),
            }
        parts[shape["name"]] = part
    if isinstance(scene["environment"], str):
        turned = mi.ScalarTransform4f().rotate([0, 1, 0], 180)
        parts["environment"] = {"type": "envmap", "filename": scene["environment"], "to_world": turned}
    elif scene["environment"]:
        parts["environment"] = {"type": "constant", "radiance": rgb(scene["environment"])}
    return mi.load_dict(parts)


def specula_scene(name, scene, folder):
    """The scene as a file of ours."""
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
        if "ball" in shape:
            form = f"type = \"sphere\"\ncenter = {number(shape['ball'][:3])}\nradius = {shape['ball'][3]}"
        else:
            form = f"type = \"mesh\"\nfile = \"{shape['obj']}\""
        if material["type"] == "emitter":
            text.append(f"[[lights]]\n{form}\nradiance = {number(material['radiance'])}")
            continue
        if material["type"] == "diffuse":
            surface = f"type = \"diffuse\"\nreflectance = {number(material['albedo'])}"
        elif material["type"] == "dielectric":
            surface = f"type = \"dielectric\"\nior = {material['ior']}"
        else:
            surface = (
                f"type = \"conductor\"\neta = {number(material['eta'])}\nk = {number(material['k'])}\n"
                f"alpha = {material['alpha']}"
            )
        text.append(f"[materials.{shape['name']}]\n{surface}")
        flat = "" if "ball" in shape else "\nnormals = \"flat\""
        text.append(f"[[shapes]]\n{form}{flat}\nmaterial = \"{shape['name']}\"")
    if isinstance(scene["environment"], str):
        text.append(f"[[lights]]\ntype = \"environment\"\nfile = \"{scene['environment']}\"")
    elif scene["environment"]:
        text.append(f"[[lights]]\ntype = \"environment\"\nradiance = {number(scene['environment'])}")
    file = folder / f"{name}.toml"
    file.write_text("\n".join(text) + "\n")
    return file


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def run_mitsuba(scene, spp, seed):
    """CPU seconds, camera samples and the picture."""
    start = cpu_seconds()
    picture = np.array(mi.render(scene, spp=spp, seed=seed))
    dr.sync_thread()
    seconds = cpu_seconds() - start
    # A sampler may take more than it is asked for.
    counted = scene.sensors()[0].sampler().clone()
    counted.set_sample_count(spp)
    return seconds, SIZE * SIZE * counted.sample_count(), picture[:, :, :3]


def run_specula(file, folder, seed, settings):
    """CPU seconds, camera samples and the picture."""
    picture, stats = pathlib.Path(folder) / "picture.exr", pathlib.Path(folder) / "stats.json"
    command = [SPECULA, "render", file, "-q", "-o", picture, "--stats", stats, "--seed", seed, *settings]
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)
    report = json.loads(stats.read_text())
    return report["phases"]["render"]["cpu_s"], report["samples"], np.array(mi.Bitmap(str(picture)))[:, :, :3]


def halved(picture):
    return picture.reshape(SIZE // 2, 2, SIZE // 2, 2, 3).mean(axis=(1, 3), dtype=np.float64)


def errors(picture, references):
    """relMSE of the picture as it is and averaged two by two, and the bias of its mean."""
    found = []
    for size in [lambda x: x.astype(np.float64), halved]:
        x, r, s = (size(image) for image in [picture, *references])
        m = (r + s) / 2
        found.append(float(np.mean((x - r) * (x - s) / (m**2 + 0.01))))
    return (*found, float(np.mean(x - m) / np.mean(m)))


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--scenes", nargs="+", default=SCENES, choices=SCENES)
    arguments.add_argument("--passes", type=int, default=5)
    arguments.add_argument("--spp", type=int, default=32)
    arguments.add_argument("--reference-spp", type=int, default=512, help="of each of the two long pictures")
    arguments.add_argument("--markdown", type=pathlib.Path)
    arguments = arguments.parse_args()
    lines = [
        "| scene | contestant | Msamples per CPU s | relMSE, 10^-6 | after 2 x 2 | bias | efficiency, of the best Mitsuba row | after 2 x 2 |",
        "|---|---|---|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for name in arguments.scenes:
            for line in compete(name, folder, arguments):
                lines.append(line)
                print(line, flush=True)
    if arguments.markdown:
        arguments.markdown.write_text("\n".join(lines) + "\n")


def compete(name, folder, arguments):
    described_scene, spp = described(name, folder), arguments.spp
    file = specula_scene(name, described_scene, folder)
    contestants = {}
    for sampler in ["independent", "multijitter"]:
        scene = mitsuba_scene(described_scene, sampler)
        run_mitsuba(scene, spp, 1_000)
        contestants[f"mitsuba {sampler}"] = lambda seed, scene=scene: run_mitsuba(scene, spp, seed)
    long = arguments.reference_spp
    references = [
        np.mean([run_mitsuba(scene, 64, seed + turn)[2] for turn in range(max(long // 64, 1))], axis=0, dtype=np.float64)
        for seed in [2_000, 3_000]
    ]
    ways = {f"specula {sampler}": ["--sampler", sampler, "--spp", spp] for sampler in ["independent", "sobol", "blue_noise"]}
    # As good as as many samples everywhere are: the error that Sobol's numbers leave is the target.
    _, _, trial = run_specula(file, folder, 1_000, ways["specula sobol"])
    target = f"{errors(trial, references)[0]:.3g}"
    for sampler in ["sobol", "blue_noise"]:
        ways[f"specula {sampler} --target-error {target}"] = ["--sampler", sampler, "--target-error", target]
    for contestant, settings in ways.items():
        contestants[contestant] = lambda seed, settings=settings: run_specula(file, folder, seed, settings)
    found = {contestant: [] for contestant in contestants}
    for turn in range(arguments.passes):
        order = list(contestants) if turn % 2 == 0 else list(contestants)[::-1]
        for contestant in order:
            seconds, samples, picture = contestants[contestant](turn)
            found[contestant].append((seconds, samples, *errors(picture, references)))
    rows = {}
    for contestant, runs in found.items():
        rates = [run[1] / run[0] / 1e6 for run in runs]
        whole, half, bias = (statistics.mean(run[i] for run in runs) for i in [2, 3, 4])
        seconds = statistics.median(run[0] for run in runs)
        rows[contestant] = (rates, whole, half, bias, [1 / (error * seconds) for error in [whole, half]])
    best = [max(row[4][i] for contestant, row in rows.items() if contestant.startswith("mitsuba")) for i in [0, 1]]
    for contestant, (rates, whole, half, bias, efficiency) in rows.items():
        quarter = statistics.quantiles(rates, n=4) if len(rates) > 1 else [rates[0]] * 3
        yield (
            f"| {name} | {contestant} | {statistics.median(rates):.2f} ({(quarter[2] - quarter[0]) / 2:.2f}) | "
            f"{whole * 1e6:.0f} | {half * 1e6:.0f} | {bias:+.1e} | {efficiency[0] / best[0]:.2f} | {efficiency[1] / best[1]:.2f} |"
        )


if __name__ == "__main__":
    main()
