"""What `specula render --preset` and `--budget` predict against what comes of it, on scenes that presets were not made from.

    python3 benches/predicted.py target/release/specula [FOLDER]

For each scene two long references, whose noise is taken out of errors, pictures by presets, and for a budget by a first look and by a sweep of the scene;
errors by `specula diff`. Prints a table in Markdown; files stay in FOLDER where one is named, and references there are used again.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = [
    ("glazed", []),
    ("shapes", []),
    ("motion_blur", []),
    ("textures", []),
    ("glazed", ["-D", "render.integrator=path", "-D", "render.max_depth=8"]),
    ("shapes", ["-D", "render.integrator=path", "-D", "render.max_depth=8"]),
]
SIZE = ["--width", "160", "--height", "90"]
LONG, SEEDS = "1024", ("4711", "4712")
BUDGET = "3s"


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


def relmse(specula, picture, reference):
    return json.loads(run(specula, "diff", picture, reference, "--json"))["relmse"]


def main():
    specula = Path(sys.argv[1]).resolve()
    if len(sys.argv) > 2:
        folder = Path(sys.argv[2])
        folder.mkdir(parents=True, exist_ok=True)
        table(specula, folder)
    else:
        with tempfile.TemporaryDirectory() as folder:
            table(specula, Path(folder))


def table(specula, folder):
    scenes = Path(__file__).resolve().parent.parent / "scenes"
    print("| scene | asked | spp | relMSE predicted | found | ratio | CPU s predicted | found | ratio | s predicted | found |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for name, more in SCENES:
        scene, kind = scenes / f"{name}.toml", "path" if more or name == "textures" else "tree"
        sweep = folder / f"{name}_{kind}.runs"
        references = [folder / f"{name}_{kind}_{seed}.exr" for seed in SEEDS]
        for seed, reference in zip(SEEDS, references):
            if not reference.exists():
                run(specula, "render", scene, "-q", *SIZE, *more, "--spp", LONG, "--seed", seed, "-o", reference)
        noise = relmse(specula, *references) / 2
        if not sweep.exists():
            knobs = ["--knob", "spp=4,32,256", "--knob", "sampler=sobol,blue_noise", "--runs", "3"]
            if kind == "tree":
                knobs += ["--knob", "min_throughput=1e-3,1e-2"]
            run(specula, "tradeoff", scene, "-q", *SIZE, *more, *knobs, "--keep", sweep, "-t", "2")
        budget = ["--budget", BUDGET]
        for asked in (["--preset", "preview"], ["--preset", "final"], budget, [*budget, "--tradeoff", sweep]):
            picture, stats = folder / "a.exr", folder / "a.json"
            run(specula, "render", scene, "-q", *SIZE, *more, *asked, "-o", picture, "--stats", stats)
            cost = json.loads(stats.read_text())["cost"]
            found = sum(relmse(specula, picture, reference) for reference in references) / 2 - noise
            said, came = cost["predicted"], cost["achieved"]
            how = " ".join(asked[:2]).replace("--", "") + (", by a sweep" if len(asked) > 2 else "")
            cells = [f"{name}, {kind}", how, came["spp"]]
            cells += [f"{said['relmse']:.2e}", f"{found:.2e}", f"{found / said['relmse']:.2f}"]
            cells += [f"{said['cpu_s']:.2f}", f"{came['cpu_s']:.2f}", f"{came['cpu_s'] / said['cpu_s']:.2f}"]
            cells += [f"{said['wall_s']:.2f}", f"{came['wall_s']:.2f}"]
            print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


if __name__ == "__main__":
    main()
