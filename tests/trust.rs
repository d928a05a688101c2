//! What scenes may ask for, and where their files may lie: `--limits` and `--sandbox` through the whole program.

#[path = "support/desk.rs"]
mod desk;

use desk::Desk;
use specula::trust::Limit;
use std::fs;

const SCENE: &str = "[film]\nwidth = 8\nheight = 6\n[render]\nspp = 2\nbackend = 'brute'\n[materials.m]\ntype = 'diffuse'\n[[lights]]\ntype = 'environment'\nradiance = 1\n";

/// Two triangles.
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

fn shape(rest: &str) -> String {
    format!("[[shapes]]\nmaterial = 'm'\n{rest}\n")
}

/// A desk with a scene of these shapes, and files that they may name.
fn desk(rest: &str) -> Desk {
    let desk = Desk::new();
    let write = |name: &str, text: &str| fs::write(desk.path(name), text).expect("written");
    write("scene.toml", &format!("{SCENE}{rest}"));
    write("a.obj", OBJ);
    write("many.obj", &format!("mtllib a.mtl\nmtllib b.mtl a.mtl\n{OBJ}"));
    write("a.ply", PLY);
    image::GrayImage::new(5, 4).save(desk.path("a.png")).expect("written");
    desk
}

/// The end of `render` with these words, and what was told.
fn render(desk: &Desk, words: &[&str]) -> (i32, String) {
    let (status, _, log) = desk.run(&[&["render", "scene.toml", "-o", "a.exr", "-q"], words].concat());
    (status, log)
}

/// A ball with a picture on it; the file is named in the third line.
fn picture_of(file: &str) -> String {
    format!(
        "[materials.p]\ntype = 'diffuse'\nreflectance = {{ file = '{file}' }}\n[[shapes]]\ntype = 'sphere'\nmaterial = 'p'\n"
    )
}

const MESH: &str = "type = 'mesh'\nfile = 'a.obj'";

/// A limit that refuses what a scene with these shapes asks for, one that just does not, and what is told.
fn check_limit((limit, rest, refused, allowed, told): (&str, String, &str, &str, &str)) {
    let desk = desk(&rest);
    let (status, log) = render(&desk, &["--limits", &format!("{limit}={refused}")]);
    assert!(status == 2 && log.contains(told), "{limit}={refused}: {status}, {log}");
    assert!(log.contains(&format!("allow more by `--limits {limit}=")), "{limit}: the remedy: {log}");
    assert!(!desk.path("a.exr").exists(), "{limit}: no picture");
    let (status, log) = render(&desk, &["--limits", &format!("none,{limit}={allowed}")]);
    assert_eq!((status, log.as_str()), (0, ""), "{limit}={allowed}");
    let (status, log) = render(&desk, &[]);
    assert_eq!((status, log.as_str()), (0, ""), "{limit} by default");
}

#[test]
fn what_is_asked_for_is_limited() {
    let picture = picture_of("a.png");
    let instance = |i: u32| format!("[[shapes]]\ntype = 'instance'\nname = 's{i}'\nof = 's{}'\n", i - 1);
    let ball = "[[shapes]]\ntype = 'sphere'\nname = 's0'\nmaterial = 'm'\n".to_owned();
    let chain = ball + &(1..7).map(instance).collect::<String>();
    // What is asked for, a limit that refuses it and one that just does not, and the place and what is told.
    let cases: [(&str, String, &str, &str, &str); 15] = [
        (
            "pixels",
            String::new(),
            "47",
            "48",
            "scene.toml:3:10: a picture of 8 by 6 pixels is too large: 48 pixels",
        ),
        ("samples", String::new(), "95", "96", "scene.toml:5:7: 2 samples of 8 by 6 pixels are too many: 96"),
        ("triangles", shape(MESH), "1", "2", "a.obj: 2 triangles in all, and 1 are allowed"),
        ("triangles", shape("type = 'mesh'\nfile = 'a.ply'"), "0", "2", "a.ply:7: 1 triangles in all"),
        ("triangles", shape("type = 'mesh'\nfile = 'a.ply'"), "1", "2", "a.ply: 2 triangles in all"),
        (
            "triangles",
            shape(MESH).repeat(2),
            "3",
            "4",
            "scene.toml:19:8: with this the scene has 4 triangles",
        ),
        (
            "triangles",
            shape(MESH) + &shape("type = 'mesh'\nfile = 'a.ply'"),
            "3",
            "4",
            "scene.toml:19:8: with this the scene has 4 triangles",
        ),
        (
            "triangles",
            shape("type = 'height_field'\nfile = 'a.png'"),
            "23",
            "24",
            "scene.toml:15:8: with this",
        ),
        ("texels", picture.clone(), "19", "20", "a.png: a picture of 5 by 4 pixels is too large: 20 texels"),
        ("textures", picture, "19", "20", "scene.toml:14:24: with this the scene has 20 texels in all"),
        ("bytes", shape(MESH), "41", "500", "a.obj: 42 bytes, and 41 are allowed"),
        ("scene_bytes", String::new(), "100", "1e4", "scene.toml: `scene.toml` is not read: "),
        (
            "files",
            shape(MESH) + &shape("type = 'mesh'\nfile = 'a.ply'"),
            "1",
            "2",
            "scene.toml:19:8: with this the scene has 2 files",
        ),
        (
            "files",
            shape("type = 'mesh'\nfile = 'many.obj'"),
            "2",
            "3",
            "many.obj:2: 3 files, and 2 are allowed",
        ),
        ("nesting", chain, "4", "7", ": an instance of an instance and so on: 5 levels"),
    ];
    cases.into_iter().for_each(check_limit);
}

#[test]
fn the_remedy_helps() {
    for limit in ["pixels", "triangles", "bytes"] {
        let desk = desk(&shape(MESH));
        let (_, log) = render(&desk, &["--limits", &format!("{limit}=1")]);
        let remedy = log.split('`').find(|text| text.starts_with("--limits ")).expect("a remedy");
        let words: Vec<&str> = remedy.split(' ').collect();
        let (status, log) = render(&desk, &words);
        assert_eq!((status, log.as_str()), (0, ""), "{remedy}");
    }
}

#[test]
fn includes_are_limited_in_depth_bytes_and_number() {
    let desk = desk("");
    let chain: Vec<String> = (0..4).map(|i| format!("{i}.toml")).collect();
    for (i, name) in chain.iter().enumerate() {
        let include = chain.get(i + 1).map_or(String::new(), |next| format!("include = ['{next}']\n"));
        fs::write(desk.path(name), include).expect("written");
    }
    fs::write(desk.path("scene.toml"), format!("include = ['0.toml']\n{SCENE}")).expect("written");
    let (status, log) = render(&desk, &["--limits", "include_depth=4"]);
    assert!(status == 2 && log.contains("2.toml:1:12: files include each other more than 4 deep"), "{log}");
    assert!(log.contains("--limits include_depth=5"), "{log}");
    assert_eq!(render(&desk, &["--limits", "include_depth=5"]).0, 0, "all of them");
    let (status, log) = render(&desk, &["--limits", "files=3"]);
    assert!(status == 2 && log.contains("1.toml:1:12: `2.toml` is not read: 4 files"), "{log}");
    assert_eq!(render(&desk, &["--limits", "files=5"]).0, 0, "all of them");
    let all: u64 = chain.iter().map(|name| fs::metadata(desk.path(name)).expect("there").len()).sum();
    let all = all + fs::metadata(desk.path("scene.toml")).expect("there").len();
    let (status, log) = render(&desk, &["--limits", &format!("scene_bytes={}", all - 1)]);
    assert!(status == 2 && log.contains(&format!("{all} bytes of scene files")), "{log}");
    assert_eq!(render(&desk, &["--limits", &format!("scene_bytes={all}")]).0, 0, "all of them");
}

#[test]
fn nothing_is_too_deep_for_the_stack() {
    // Each key of eighty parts holds a table with another such key, as deep as the parser of TOML goes.
    let key = ["a"; 70].join(".");
    let bomb = format!("{}1{}", format!("{{ {key} = ").repeat(70), " }".repeat(70));
    let array = format!("{}{}", "[".repeat(70), "]".repeat(70));
    for (text, place) in
        [(format!("x = {bomb}\n"), "scene.toml:1:"), (format!("x = {array}\n"), "scene.toml:1:")]
    {
        let desk = desk("");
        fs::write(desk.path("scene.toml"), format!("{text}{SCENE}")).expect("written");
        let (status, log) = render(&desk, &[]);
        assert!(status == 2 && log.contains(place), "{log}");
        assert!(log.contains("more than 64 deep") && log.contains("--limits nesting=65"), "{log}");
        let (status, log) = render(&desk, &["--limits", "nesting=none"]);
        assert!(status == 2 && log.contains("unknown key `x`"), "without a limit: {log}");
    }
    let desk = desk("");
    let path = ["a"; 100].join(".");
    let (status, log) = render(&desk, &["-D", &format!("{path}=1")]);
    assert!(status == 2 && log.contains("the path has 100 levels"), "{log}");
    let (status, log) = render(&desk, &["-D", &format!("x={array}")]);
    assert!(status == 2 && log.contains("more than 64 deep"), "{log}");
}

#[test]
fn all_commands_that_read_know_limits() {
    let desk = desk(&shape(MESH));
    let told = |words: &[&str], told: &str| {
        let (status, _, log) = desk.run(words);
        assert!(status == 2 && log.contains(told), "{words:?}: {status}, {log}");
    };
    told(&["plan", "scene.toml", "--limits", "triangles=1"], "a.obj: 2 triangles in all");
    told(&["tradeoff", "scene.toml", "--limits", "triangles=1"], "a.obj: 2 triangles in all");
    let farm = ["farm", "slurm", "scene.toml", "-o", "f.exr", "--limits", "triangles=1"];
    told(&farm, "a.obj: 2 triangles in all");
    assert!(!desk.path("f.farm").exists(), "nothing written");
    told(&["batch", "scene.toml", "--limits", "scene_bytes=9"], "`scene.toml` is not read: ");
    fs::write(desk.path("batch.toml"), "[[jobs]]\nscene = 'scene.toml'\n").expect("written");
    told(&["batch", "batch.toml", "--limits", "scene_bytes=9"], "`batch.toml` is not read: ");
    let deep = format!("x = {}{}\n", "[".repeat(70), "]".repeat(70));
    fs::write(desk.path("deep.toml"), deep).expect("written");
    told(&["batch", "deep.toml"], "more than 64 deep");
    told(&["bench", "scene.toml", "--quick", "--limits", "pixels=7"], "scene.toml:3:10: a picture of 8 by 6");
    let (status, log) = render(&desk, &["-o", "a.part"]);
    assert_eq!(status, 0, "{log}");
    told(
        &["merge", "a.part", "-o", "b.exr", "--limits", "pixels=47"],
        "a.part: 48 pixels, and 47 are allowed",
    );
    told(&["merge", "a.part", "-o", "b.exr", "--limits", "bytes=9"], "bytes, and 9 are allowed");
    told(
        &["diff", "a.exr", "a.exr", "--limits", "texels=47"],
        "a.exr: a picture of 8 by 6 pixels is too large",
    );
    told(&["fuzzy", "a.exr", "-o", "b.exr", "--limits", "texels=47"], "a.exr: a picture of 8 by 6 pixels");
    told(&["render", "scene.toml", "--limits", "texel=3"], "did you mean `texels`?");
    told(&["plan", "scene.toml", "--limits", "texels=few"], "`--limits texels=few` is not a limit");
    assert_eq!(desk.run(&["merge", "a.part", "-o", "b.exr", "-q"]).0, 0, "by default");
    let (_, help, _) = desk.run(&["render", "--help"]);
    for limit in Limit::ALL {
        let default = limit.default_most().map_or("none".to_owned(), |most| format!("{most:e}"));
        let short = limit.default_most().filter(|most| *most < 1000).map_or(default, |most| most.to_string());
        let text = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(&format!("`{}` ({short})", limit.word())), "{limit:?} in {text}");
    }
}

/// A header of a PNG file that claims a picture of that size, with a few bytes of pixels.
fn claim(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    image::GrayImage::new(1, 1)
        .write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png)
        .expect("written");
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let crc = crc32fast::hash(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    bytes
}

#[test]
fn claims_of_terabytes_are_refused_whatever_the_limits() {
    let vertices = PLY.replace("vertex 4", "vertex 1000000000000").replace("ascii", "binary_little_endian");
    let faces = PLY.replace("face 1", "face 1000000000000");
    let picture = picture_of("a.png");
    let hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n";
    let sky = "[[lights]]\ntype = 'environment'\nfile = 'a.hdr'\n";
    let mesh = shape("type = 'mesh'\nfile = 'a.ply'");
    let cases: [(&str, &[u8], &str, &str); 4] = [
        ("a.ply", vertices.as_bytes(), &mesh, "get a complete copy of the file"),
        ("a.ply", faces.as_bytes(), &mesh, "the file ends here"),
        ("a.png", &claim(1_000_000, 1_000_000), &picture, "claims more pixels than its bytes can hold"),
        ("a.hdr", hdr.as_bytes(), sky, "claims more pixels than its bytes can hold"),
    ];
    for (name, bytes, rest, without) in cases {
        let desk = desk(rest);
        let scene = fs::read_to_string(desk.path("scene.toml")).expect("there");
        let scene = if name == "a.hdr" {
            scene.replacen(
                "type = 'environment'\nradiance = 1",
                "type = 'point'\nposition = [0, 1, 0]\nintensity = 1",
                1,
            )
        } else {
            scene
        };
        fs::write(desk.path("scene.toml"), scene).expect("written");
        fs::write(desk.path(name), bytes).expect("written");
        let (status, log) = render(&desk, &["--limits", "none"]);
        // A surface can do without a picture that cannot be read, but not with one that asks for too much.
        let end = if name == "a.png" { 0 } else { 2 };
        assert!(status == end && log.contains(name) && log.contains(without), "{name}: {status}, {log}");
        let (status, log) = render(&desk, &[]);
        assert!(status == 2 && log.contains(name), "{name}: {log}");
    }
}

/// A folder `in` for scenes, what lies beside it, and links between.
#[cfg(unix)]
fn yard() -> Desk {
    use std::os::unix::fs::symlink;
    let desk = Desk::new();
    let write = |name: &str, text: &str| fs::write(desk.path(name), text).expect("written");
    fs::create_dir_all(desk.path("in/sub")).expect("made");
    write("out.obj", OBJ);
    write("out.toml", "[film]\nwidth = 8\n");
    write("out.mtl", "newmtl a\nKd 1 0 0\n");
    image::GrayImage::new(5, 4).save(desk.path("out.png")).expect("written");
    write("in/a.obj", OBJ);
    write("in/mtl.obj", &format!("mtllib ../out.mtl\nusemtl a\n{OBJ}"));
    write("in/map.obj", &format!("mtllib map.mtl\nusemtl a\n{OBJ}"));
    write("in/map.mtl", "newmtl a\nmap_Kd ../out.png\n");
    write("in/sub/more.toml", "include = ['../../out.toml']\n");
    write("in/sub/fine.toml", "[film]\nwidth = 8\nheight = 6\n");
    symlink(desk.path("out.obj"), desk.path("in/link.obj")).expect("linked");
    symlink("..", desk.path("in/up")).expect("linked");
    symlink("a.obj", desk.path("in/alias.obj")).expect("linked");
    desk
}

/// The end of `render` of a scene in the yard that begins so and has these shapes, and what was told.
#[cfg(unix)]
fn yarded(desk: &Desk, (top, rest): (&str, &str), words: &[&str]) -> (i32, String) {
    fs::write(desk.path("in/scene.toml"), format!("{top}{SCENE}{rest}")).expect("written");
    let (status, _, log) = desk.run(&[&["render", "in/scene.toml", "-o", "a.exr", "-q"], words].concat());
    (status, log)
}

fn mesh_of(file: &str) -> String {
    shape(&format!("type = 'mesh'\nfile = '{file}'"))
}

#[cfg(unix)]
#[test]
fn a_sandbox_is_not_left() {
    let desk = yard();
    let absolute = desk.path("out.obj").display().to_string();
    let own = |file: &str| format!("[[shapes]]\ntype = 'mesh'\nfile = '{file}'\n");
    let outside: [(&str, String, &str); 12] = [
        ("include = ['../out.toml']\n", String::new(), "in/scene.toml:1:12: "),
        ("include = ['sub/more.toml']\n", String::new(), "in/sub/more.toml:1:12: "),
        ("include = ['up/out.toml']\n", String::new(), "in/scene.toml:1:12: "),
        ("", mesh_of("../out.obj"), "in/scene.toml:15:8: "),
        ("", mesh_of(&absolute), "in/scene.toml:15:8: "),
        ("", mesh_of("link.obj"), "in/scene.toml:15:8: "),
        ("", mesh_of("up/out.obj"), "in/scene.toml:15:8: "),
        ("", mesh_of("sub/../../out.obj"), "in/scene.toml:15:8: "),
        ("", picture_of("../out.png"), "in/scene.toml:14:24: "),
        (
            "",
            format!("[[lights]]\ntype = 'mesh'\nradiance = 1\nfile = '{absolute}'\n"),
            "in/scene.toml:15:8: ",
        ),
        ("", own("mtl.obj"), "in/mtl.obj:1: `in/../out.mtl` lies outside"),
        ("", own("map.obj"), "in/map.mtl:2: "),
    ];
    for (top, rest, place) in outside {
        let (status, log) = yarded(&desk, (top, &rest), &["--sandbox"]);
        assert!(status == 2 && log.contains(place), "{top}{rest}: {status}, {log}");
        assert!(log.contains("lies outside of the scene's folder `in`; put it there"), "{top}{rest}: {log}");
        let (status, log) = yarded(&desk, (top, &rest), &[]);
        assert_eq!(status, 0, "without a sandbox: {top}{rest}: {log}");
    }
}

#[cfg(unix)]
#[test]
fn a_sandbox_has_all_that_lies_in_it_and_tells_nothing_of_the_rest() {
    use std::os::unix::fs::symlink;
    let desk = yard();
    let inside = desk.path("in/a.obj").canonicalize().expect("there").display().to_string();
    // A picture that is missing is made up for; one that lies outside is not, be it there or not.
    let (status, log) = yarded(&desk, ("", &picture_of("lost.png")), &["--sandbox"]);
    assert!(status == 0 && log.contains("no such file") && log.contains("made gray"), "{status}, {log}");
    for file in ["../lost.png", "up/lost.png"] {
        let (status, log) = yarded(&desk, ("", &picture_of(file)), &["--sandbox"]);
        assert!(
            status == 2 && log.contains("lies outside") && !log.contains("no such file"),
            "{file}: {log}"
        );
    }
    // Nothing is told of what is outside, not even whether it is there.
    let (_, log) = yarded(&desk, ("", &mesh_of("../lost.obj")), &["--sandbox"]);
    assert!(log.contains("lies outside") && !log.contains("no such file"), "{log}");
    fs::write(desk.path("in/space.obj"), format!("mtllib ../out one.mtl\nusemtl a\n{OBJ}")).expect("written");
    let told = || yarded(&desk, ("", &mesh_of("space.obj")), &["--sandbox"]);
    let before = told();
    fs::write(desk.path("out one.mtl"), "").expect("written");
    assert_eq!(told(), before, "the same of a file of materials with a space in its name");
    let (status, log) = yarded(&desk, ("", &mesh_of("a.obj")), &["--sandbox", "-D", "shapes.0.file=out.obj"]);
    assert!(status == 2 && log.contains("command line: ") && log.contains("lies outside"), "{log}");
    for file in ["a.obj", "alias.obj", "sub/../a.obj", "../in/a.obj", &inside] {
        let (status, log) = yarded(&desk, ("include = ['sub/fine.toml']\n", &mesh_of(file)), &["--sandbox"]);
        assert_eq!((status, log.as_str()), (0, ""), "{file}");
    }
    // The scene file itself may be a link, and what is written goes where it is to go.
    yarded(&desk, ("", &mesh_of("a.obj")), &[]);
    symlink(desk.path("in/scene.toml"), desk.path("in/sub/linked.toml")).expect("linked");
    fs::write(desk.path("in/sub/a.obj"), OBJ).expect("written");
    let words = ["render", "in/sub/linked.toml", "--sandbox", "-o", "b.exr", "-q"];
    let (status, _, log) = desk.run(&words);
    assert_eq!((status, log.as_str()), (0, ""), "a linked scene");
    assert!(desk.path("b.exr").exists(), "outside of the sandbox");
}

#[cfg(unix)]
#[test]
fn each_scene_of_a_batch_has_a_sandbox_of_its_own() {
    let desk = Desk::new();
    let write = |name: &str, text: &str| fs::write(desk.path(name), text).expect("written");
    fs::create_dir_all(desk.path("in/sub")).expect("made");
    write("in/m.mtl", "newmtl a\nKd 1 0 0\n");
    write("in/sub/a.obj", &format!("mtllib ../m.mtl\nusemtl a\n{OBJ}"));
    write("in/sub/b.obj", OBJ);
    let scene = |file: &str| format!("{SCENE}[[shapes]]\ntype = 'mesh'\nfile = '{file}'\n");
    write("in/scene.toml", &scene("sub/a.obj"));
    write("in/sub/other.toml", &scene("a.obj"));
    write("in/sub/fine.toml", &format!("{SCENE}{}", shape("type = 'mesh'\nfile = 'b.obj'")));
    // The mesh is on the shelf when the second scene asks for it, whose folder its materials do not lie in.
    let scenes = ["in/scene.toml", "in/sub/other.toml", "in/sub/fine.toml"];
    let batch = |limit: &str| {
        let words = [&["batch"][..], &scenes, &["-q", "--sandbox", "--limits", limit]].concat();
        desk.run(&words)
    };
    let (status, out, log) = batch("triangles=2");
    assert!(status == 1 && out.contains("1 failed"), "{status}, {out}{log}");
    let outside = "`in/sub/../m.mtl` lies outside of the scene's folder `in/sub`";
    assert!(log.contains(outside), "{log}");
    assert!(log.contains("specula render in/sub/other.toml --sandbox --limits=triangles=2"), "again: {log}");
    assert!(desk.path("scene.exr").exists() && desk.path("fine.exr").exists(), "the others");
    assert!(!desk.path("other.exr").exists(), "not that one");
    let (status, out, _) = batch("triangles=1");
    assert!(status == 1 && out.contains("failed"), "{out}");
}

#[test]
fn files_of_a_batch_are_as_seen_from_its_folder_and_inside_of_the_sandbox() {
    let desk = Desk::new();
    let write = |name: &str, text: &str| fs::write(desk.path(name), text).expect("written");
    fs::create_dir_all(desk.path("in")).expect("made");
    write("out.obj", OBJ);
    write("in/a.obj", OBJ);
    write("in/scene.toml", &format!("{SCENE}{}", shape(MESH)));
    let jobs = |file: &str| {
        format!(
            "[[jobs]]\nscene = 'in/scene.toml'\noverrides = {{ shapes.0.file = '{file}' }}\noutputs = ['a.exr']\n"
        )
    };
    for (file, sandbox, is_allowed) in
        [("in/a.obj", true, true), ("out.obj", true, false), ("out.obj", false, true)]
    {
        write("batch.toml", &jobs(file));
        let words = [&["batch", "batch.toml", "-q"][..], if sandbox { &["--sandbox"] } else { &[] }].concat();
        let (status, _, log) = desk.run(&words);
        assert_eq!(status == 0, is_allowed, "{file}, {sandbox}: {log}");
        assert_eq!(log.contains("lies outside of the scene's folder `in`"), !is_allowed, "{file}: {log}");
    }
}
