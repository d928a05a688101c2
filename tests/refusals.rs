//! What is wrong with a command line, a scene, a mesh or a picture is told with its place; the program ends with status 2,
//! without a panic, and leaves the old picture as it was.
//!
//! Messages are tested to the letter beside the readers; here it counts that each mistake comes through the whole program.

#[path = "support/desk.rs"]
mod desk;

use desk::Desk;
use std::fs;

/// A file, and what is in it.
type File = (&'static str, &'static [u8]);

/// One mistake.
struct Case {
    name: &'static str,
    files: &'static [File],
    /// What follows `render -o old.png -o old.exr`, or a whole command line that starts with another command.
    words: &'static str,
    /// What each line of the log must hold one of, in any order.
    told: &'static [&'static str],
}

/// A faulty scene, complete but for the fault.
const fn scene(name: &'static str, text: &'static str, told: &'static [&'static str]) -> Case {
    // A scene by itself is one file; its slice must be a constant.
    Case { name, files: &[], words: text, told }
}

/// The words by which a file is rendered on a stage.
const MESH: &str = "stage.toml";
const STAGE: &[u8] =
    b"[[shapes]]\ntype = 'mesh'\nfile = 'model.obj'\nmaterial = 'm'\n[materials.m]\ntype = 'diffuse'\n\
    [film]\nwidth = 4\nheight = 4\n[render]\nspp = 1\n[[lights]]\ntype = 'environment'\nradiance = 1\n";

/// A faulty mesh on a good stage.
const fn mesh(name: &'static str, files: &'static [File], told: &'static [&'static str]) -> Case {
    Case { name, files, words: MESH, told }
}

/// The same of another format.
const fn ply(name: &'static str, files: &'static [File], told: &'static [&'static str]) -> Case {
    Case { name, files, words: "stage.toml -D shapes.0.file='model.ply'", told }
}

const GOOD: File = (
    "good.toml",
    b"[film]\nwidth = 4\nheight = 4\n[render]\nspp = 1\n[materials.m]\ntype = 'diffuse'\n[[shapes]]\ntype = 'sphere'\n\
      material = 'm'\n[[lights]]\ntype = 'environment'\nradiance = 1\n",
);

/// A faulty command line with a good scene.
const fn words(name: &'static str, words: &'static str, told: &'static [&'static str]) -> Case {
    Case { name, files: &[GOOD], words, told }
}

const SCENES: &[Case] = &[
    scene("syntax", "[camera\n", &["scene.toml:1:8: unclosed table"]),
    scene("unknown table", "[camara]\n", &["scene.toml:1:2: unknown key `camara`; did you mean `camera`?"]),
    scene(
        "unknown key",
        "[film]\nwidht = 3\n",
        &["scene.toml:2:1: unknown key `widht`; did you mean `width`?"],
    ),
    scene("wrong type", "[film]\nwidth = 'wide'\n", &["scene.toml:2:9: `width` is a string"]),
    scene("fraction for a count", "[film]\nwidth = 3.5\n", &["scene.toml:2:9: "]),
    scene("zero size", "[film]\nheight = 0\n", &["scene.toml:2:10: `height` is 0"]),
    scene("huge size", "[film]\nwidth = 99999999\n", &["scene.toml:2:9: `width` is 99999999"]),
    scene("not a number", "[camera]\nvfov_deg = nan\n", &["scene.toml:2:12: "]),
    scene("infinite", "[camera]\nfrom = [0, inf, 0]\n", &["scene.toml:2:12: "]),
    scene(
        "two numbers for three",
        "[camera]\nfrom = [0, 1]\n",
        &["scene.toml:2:8: `from` is an array of two"],
    ),
    scene("a flat angle", "[camera]\nvfov_deg = 180\n", &["scene.toml:2:12: `vfov_deg` is 180"]),
    scene("no view", "[camera]\nfrom = [1, 2, 3]\nat = [1, 2, 3]\n", &["`at` is where the camera stands"]),
    scene(
        "up along the view",
        "[camera]\nfrom = [0, 0, 0]\nat = [0, 5, 0]\n",
        &["`up` points along the view"],
    ),
    scene("unknown camera", "[camera]\ntype = 'fisheye'\n", &["scene.toml:2:8: unknown type `fisheye`"]),
    scene("unknown filter", "[film]\nfilter = 'lanczos'\n", &["scene.toml:2:10: `filter` is `lanczos`"]),
    scene("unknown integrator", "[render]\nintegrator = 'magic'\n", &["scene.toml:2:14: "]),
    scene("unknown backend", "[render]\nbackend = 'octree'\n", &["scene.toml:2:11: `backend` is `octree`"]),
    scene("no samples", "[render]\nspp = 0\n", &["scene.toml:2:7: `spp` is 0"]),
    scene(
        "unknown material kind",
        "[materials.a]\ntype = 'velvet'\n",
        &["scene.toml:2:8: unknown type `velvet`"],
    ),
    scene("material without kind", "[materials.a]\n", &["scene.toml:1:1: missing key `type`"]),
    scene(
        "more light than arrives",
        "[materials.a]\ntype = 'diffuse'\nreflectance = 1.5\n",
        &["scene.toml:3:15: "],
    ),
    scene(
        "unknown metal",
        "[materials.a]\ntype = 'conductor'\nmetal = 'Xx'\n",
        &["scene.toml:3:9: unknown metal `Xx`"],
    ),
    scene("metal without optics", "[materials.a]\ntype = 'conductor'\n", &["one of the keys"]),
    scene(
        "an index below one",
        "[materials.a]\ntype = 'dielectric'\nior = 0.5\n",
        &["scene.toml:3:7: `ior` is 0.5"],
    ),
    scene(
        "a key of another kind",
        "[materials.a]\ntype = 'mirror'\nior = 1.5\n",
        &["`ior` does not go with"],
    ),
    scene(
        "unknown material",
        "[[shapes]]\ntype = 'sphere'\nmaterial = 'x'\n",
        &["scene.toml:3:12: unknown material `x`"],
    ),
    scene("no material", "[[shapes]]\ntype = 'sphere'\n", &["scene.toml:1:1: missing key `material`"]),
    scene("unknown shape", "[[shapes]]\ntype = 'cube'\n", &["scene.toml:2:8: unknown type `cube`"]),
    scene(
        "no radius",
        "[[shapes]]\ntype = 'sphere'\nradius = 0\nmaterial = 'm'\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:3:10: `radius` is 0"],
    ),
    scene(
        "a box inside out",
        "[[shapes]]\ntype = 'box'\nmin = [1, 0, 0]\nmax = [0, 1, 1]\nmaterial = 'm'\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:4:7: `max` is not above `min`"],
    ),
    scene(
        "edges along each other",
        "[[shapes]]\ntype = 'rectangle'\nedge_u = [1, 0, 0]\nedge_v = [2, 0, 0]\nmaterial = 'm'\n[materials.m]\ntype = 'mirror'\n",
        &["`edge_v` is parallel to `edge_u`"],
    ),
    scene(
        "an instance of nothing",
        "[[shapes]]\ntype = 'instance'\nof = 'x'\n",
        &["scene.toml:3:6: unknown shape `x`"],
    ),
    scene(
        "an instance of itself",
        "[[shapes]]\ntype = 'instance'\nname = 'a'\nof = 'a'\n",
        &["shape `a` is an instance of itself"],
    ),
    scene(
        "a name twice",
        "[[shapes]]\ntype = 'sphere'\nname = 'a'\nmaterial = 'm'\n[[shapes]]\ntype = 'disc'\nname = 'a'\nmaterial = 'm'\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:7:8: a shape named `a` is there already"],
    ),
    scene(
        "flattened",
        "[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\ntransform = [{ scale = 0 }]\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:4:24: `scale` is zero"],
    ),
    scene(
        "no axis",
        "[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\ntransform = [{ rotate_deg = 3, axis = [0, 0, 0] }]\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:4:39: "],
    ),
    scene(
        "a matrix without inverse",
        "[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\ntransform = [{ matrix = [1,0,0,0, 2,0,0,0, 0,0,1,0, 0,0,0,1] }]\n[materials.m]\ntype = 'mirror'\n",
        &["`matrix` has no inverse"],
    ),
    scene(
        "an unknown step",
        "[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\ntransform = [{ shear = 1 }]\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:4:14: one of the keys"],
    ),
    scene("unknown light", "[[lights]]\ntype = 'laser'\n", &["scene.toml:2:8: unknown type `laser`"]),
    scene(
        "darker than dark",
        "[[lights]]\ntype = 'point'\nposition = [0, 1, 0]\nintensity = -1\n",
        &["scene.toml:4:13: "],
    ),
    scene(
        "a light without direction",
        "[[lights]]\ntype = 'directional'\ndirection = [0, 0, 0]\nirradiance = 1\n",
        &["scene.toml:3:13: "],
    ),
    scene(
        "two skies",
        "[[lights]]\ntype = 'environment'\nradiance = 1\n[[lights]]\ntype = 'environment'\nradiance = 2\n",
        &["scene.toml:4:1: a second environment"],
    ),
    scene(
        "a mesh that is not there",
        "[[shapes]]\ntype = 'mesh'\nfile = 'lost.obj'\n",
        &["scene.toml:3:8: no such file `lost.obj`"],
    ),
    scene(
        "a folder for a file",
        "[[shapes]]\ntype = 'mesh'\nfile = '.'\n",
        &["scene.toml:3:8: `.` is a directory"],
    ),
    scene(
        "a mesh of another format",
        "[[shapes]]\ntype = 'mesh'\nfile = 'scene.toml'\n",
        &["scene.toml:3:8: `scene.toml` is of an unknown format"],
    ),
    scene(
        "an include that is not there",
        "include = ['more.toml']\n",
        &["scene.toml:1:12: no such file `more.toml`"],
    ),
    scene("an include of itself", "include = ['scene.toml']\n", &["scene.toml:1:12: "]),
    scene(
        "a cylinder without length",
        "[[shapes]]\ntype = 'cylinder'\nfrom = [0, 1, 0]\nto = [0, 1, 0]\nmaterial = 'm'\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:4:6: "],
    ),
    scene(
        "a ring without a hole",
        "[[shapes]]\ntype = 'torus'\nmajor_radius = 1\nminor_radius = 2\nmaterial = 'm'\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:4:16: "],
    ),
    scene(
        "a ring about nothing",
        "[[shapes]]\ntype = 'torus'\naxis = [0, 0, 0]\nmaterial = 'm'\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:3:8: "],
    ),
    scene(
        "heights of nothing",
        "[[shapes]]\ntype = 'height_field'\nfile = 'hills.png'\nmaterial = 'm'\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:3:8: no such file `hills.png`"],
    ),
    scene(
        "a cone that shines",
        "[[shapes]]\ntype = 'cone'\nmaterial = 'm'\n[materials.m]\ntype = 'emission'\nradiance = 1\n",
        &["scene.toml:1:1: ", "can be lights"],
    ),
    scene(
        "one key",
        "[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\nkeys = [{ time_s = 0 }]\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:4:8: "],
    ),
    scene(
        "keys that go back",
        "[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\nkeys = [{ time_s = 1 }, { time_s = 0 }]\n[materials.m]\ntype = 'mirror'\n",
        &["scene.toml:4:36: "],
    ),
    scene(
        "a shutter that closes before it opens",
        "[camera]\nshutter_open_s = 1\nshutter_close_s = 0\n",
        &["scene.toml:3:19: "],
    ),
];

const MESHES: &[Case] = &[
    mesh("empty", &[("model.obj", b"")], &["model.obj: there is no triangle in this file"]),
    mesh("points only", &[("model.obj", b"v 0 0 0\np 1\n")], &["model.obj:2: there is no triangle in this file, only points"]),
    mesh(
        "index past the end",
        &[("model.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")],
        &["model.obj:4: the face refers to position 4, but there are 3"],
    ),
    mesh("index of zero", &[("model.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n")], &["model.obj:4: "]),
    mesh(
        "backwards past the start",
        &[("model.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -9\n")],
        &["model.obj:4: "],
    ),
    mesh(
        "not a number",
        &[("model.obj", b"v 0 0 0\nv 1 zero 0\nv 0 1 0\nf 1 2 3\n")],
        &["model.obj:2: `zero` is not a number"],
    ),
    mesh(
        "infinite",
        &[("model.obj", b"v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n")],
        &["model.obj:2: `inf` is not finite"],
    ),
    mesh(
        "too large for a number",
        &[("model.obj", b"v 0 0 0\nv 1 1e99 0\nv 0 1 0\nf 1 2 3\n")],
        &["model.obj:2: "],
    ),
    mesh(
        "a coordinate is missing",
        &[("model.obj", b"v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n")],
        &["model.obj:2: 2 of 3 numbers are there"],
    ),
    mesh(
        "a line without area",
        &[("model.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")],
        &["model.obj: there is no triangle"],
    ),
    mesh(
        "not text",
        &[("model.obj", b"\x7fELF\x02\x01\x01\x00\x00\xff\xfe\x00")],
        &["model.obj:1: there is no triangle"],
    ),
    ply("an empty PLY", &[("model.ply", b"")], &["model.ply"]),
    ply("PLY of another kind", &[("model.ply", b"ply\nformat text 1.0\nend_header\n")], &["model.ply:2: "]),
    ply("PLY without an end to its header", &[("model.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n")], &["model.ply"]),
    ply(
        "PLY with an index past the end",
        &[("model.ply", b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
           element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")],
        &["model.ply:13: "],
    ),
    ply(
        "PLY cut short",
        &[("model.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 3000000000\nproperty float x\nproperty float y\n\
           property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\0\0\0\0")],
        &["model.ply"],
    ),
    ply(
        "PLY with a coordinate that is none",
        &[("model.ply", b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
           element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n")],
        &["model.ply:11: "],
    ),
];

const IMAGES: &[Case] = &[
    Case { name: "an empty HDR", files: &[("sky.hdr", b"")], words: "sky.hdr", told: &["sky.hdr"] },
    Case {
        name: "HDR of nothing",
        files: &[("sky.hdr", b"#?RADIANCE\n\n-Y 0 +X 0\n")],
        words: "sky.hdr",
        told: &["sky.hdr"],
    },
    Case {
        name: "a broken HDR",
        files: &[("sky.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 8\n\x02\x02")],
        words: "sky.hdr",
        told: &["sky.hdr"],
    },
    Case {
        name: "an HDR that is huge",
        files: &[("sky.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 999999 +X 999999\n")],
        words: "sky.hdr",
        told: &["sky.hdr"],
    },
    Case {
        name: "an EXR that is text",
        files: &[("sky.exr", b"hello, this is not an EXR file at all")],
        words: "sky.exr",
        told: &["sky.exr"],
    },
    Case {
        name: "an EXR cut short",
        files: &[("sky.exr", b"\x76\x2f\x31\x01\x02\x00\x00\x00channels\x00chlist\x00")],
        words: "sky.exr",
        told: &["sky.exr"],
    },
    Case {
        name: "a picture of another format",
        files: &[("sky.jpg", b"")],
        words: "sky.jpg",
        told: &["scene.toml:3:8: `sky.jpg` is of an unknown format"],
    },
    Case {
        name: "a picture that is not there",
        files: &[],
        words: "lost.exr",
        told: &["scene.toml:3:8: no such file `lost.exr`"],
    },
];

const COMMANDS: &[Case] = &[
    words("no scene", "", &["SCENE"]),
    words("a scene that is not there", "lost.toml", &["lost.toml"]),
    words("an unknown flag", "good.toml --sppp 3", &["--sppp"]),
    words("an unknown command", "!paint good.toml", &["paint"]),
    words("samples that are none", "good.toml --spp 0", &["command line: in `render.spp=0`"]),
    words("samples that are no number", "good.toml --spp many", &["command line"]),
    words("an unknown backend", "good.toml --backend octree", &["command line: in `render.backend=octree`"]),
    words("an unknown integrator", "good.toml --integrator magic", &["command line"]),
    words("a negative size", "good.toml --width -3", &["command line"]),
    words("a crop of nothing", "good.toml --crop 2,2,2,2", &["command line: `--crop 2,2,2,2`"]),
    words("a crop of words", "good.toml --crop left", &["command line: `--crop left`"]),
    words("a crop outside", "good.toml --crop 0,0,9,9", &["the crop 0,0,9,9 is not a part of the picture"]),
    words("no threads", "good.toml -t 0", &["command line: `--threads 0`"]),
    words("too many threads", "good.toml -t 99999999", &["command line: `--threads 99999999`"]),
    words("an output twice", "good.toml -o old.png", &["command line: `old.png` would be written twice"]),
    words("an output of another format", "good.toml -o a.jpg", &["a.jpg"]),
    words("an output in no folder", "good.toml -o no/where/a.png", &["no/where"]),
    words("an override of nothing", "good.toml -D film.depth=3", &["command line: in `film.depth=3`"]),
    words("an override without a value", "good.toml -D film.width", &["command line"]),
    words(
        "an override of the wrong type",
        "good.toml -D film.width=wide",
        &["command line: in `film.width=wide`"],
    ),
    words("statistics onto a picture", "good.toml --stats old.png", &["command line: `old.png`"]),
    words("a plan of nothing", "!plan lost.toml", &["lost.toml"]),
    words("a plan of a fault", "!plan good.toml -D film.width=0", &["command line: in `film.width=0`"]),
    words("a comparison with nothing", "!diff old.exr lost.exr", &["lost.exr"]),
    words("a comparison of what is no picture", "!diff old.exr old.exr", &["old.exr"]),
    words("a comparison of other kinds", "!diff old.exr old.png", &["old."]),
    words("a comparison by no metric", "!diff old.exr old.exr --metric beauty", &["beauty"]),
    words("a largest error below zero", "!diff old.exr old.exr --max-error -1", &["--max-error -1"]),
    words("a shell that is none", "!completions tcl", &["tcl"]),
    words("a folder that is not there", "!man --dir lost", &["lost"]),
];

/// Runs a case in a folder of its own; what is wrong with its outcome.
fn fault(case: &Case, words: &str, files: &[(&str, &[u8])]) -> Option<String> {
    let desk = Desk::new();
    let path = |name: &str| desk.path(name);
    files.iter().for_each(|(name, bytes)| fs::write(path(name), bytes).expect("written"));
    let old: [File; 2] = [("old.png", b"an old picture"), ("old.exr", b"another")];
    old.iter().for_each(|(name, bytes)| fs::write(path(name), bytes).expect("written"));
    let (head, words): (&[&str], _) = match words.strip_prefix('!') {
        Some(words) => (&[], words),
        None => (&["render", "-o", "old.png", "-o", "old.exr"], words),
    };
    let words: Vec<&str> = head.iter().copied().chain(words.split_whitespace()).collect();
    let (status, results, log) = desk.run(&words);
    let kept = |(name, bytes): &File| fs::read(path(name)).is_ok_and(|now| now == *bytes);
    let told = case.told.iter().all(|text| log.contains(text));
    let faults = [
        (status != 2, "another status than 2"),
        (!told, "not told what is wrong"),
        (log.contains("panicked"), "a panic"),
        (!results.is_empty(), "results"),
        (!old.iter().all(kept), "the old picture is lost"),
        (desk.names().len() != files.len() + old.len(), "files are left behind"),
    ];
    let found: Vec<&str> = faults.into_iter().filter(|(is, _)| *is).map(|(_, what)| what).collect();
    (!found.is_empty()).then(|| format!("{}: {} (status {status}):\n{log}", case.name, found.join(", ")))
}

#[test]
fn every_mistake_is_told_with_its_place_and_costs_nothing() {
    let mut faults = Vec::new();
    for case in SCENES {
        faults.extend(fault(case, "scene.toml", &[("scene.toml", case.words.as_bytes())]));
    }
    for case in MESHES {
        let files: Vec<File> = case.files.iter().copied().chain([("stage.toml", STAGE)]).collect();
        faults.extend(fault(case, case.words, &files));
    }
    for case in IMAGES {
        let text = format!("[[lights]]\ntype = 'environment'\nfile = '{}'\n", case.words);
        let mut files: Vec<(&str, &[u8])> = case.files.to_vec();
        files.push(("scene.toml", text.as_bytes()));
        faults.extend(fault(case, "scene.toml", &files));
    }
    for case in COMMANDS {
        faults.extend(fault(case, case.words, case.files));
    }
    let count = SCENES.len() + MESHES.len() + IMAGES.len() + COMMANDS.len();
    println!("{count} mistakes, {} not well told", faults.len());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(count >= 60, "too few to mean much: {count}");
}
