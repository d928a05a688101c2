//! What is fuzzed: every loader, given any bytes, has an answer or a refusal, without a panic.
//!
//! Limits are tight, so that what is large is refused and not waited for. Shared by the fuzz targets and by `tests/fuzzed.rs`.

#![allow(dead_code, reason = "each target uses a part")]

use specula::error::Place;
use specula::film::{Aov, Layout, Precision};
use specula::image::{self, Pixels};
use specula::light::EnvironmentMap;
use specula::render::{Checkpoint, Kept, Limits as Ends, Part, PartFile, Settings, Silent, render_kept};
use specula::scene::description::Normals;
use specula::scene::load::{About, Shading, decode_mesh};
use specula::scene::{self, Built, Needs, Scene, Wanted, needs};
use specula::texture::{Bitmap, Space};
use specula::trust::{Limit, Limits, Sandbox, Trust};
use std::fs;
use std::hint::black_box;
use std::io::Read;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use tempfile::TempDir;

/// Something that reads files of a kind.
pub(crate) struct Loader {
    /// As its folders are called.
    pub(crate) name: &'static str,
    /// Reads what might be a file.
    pub(crate) read: fn(&[u8]),
}

/// All of them.
pub(crate) const LOADERS: [Loader; 10] = [
    Loader { name: "scene", read: scene },
    Loader { name: "obj", read: obj },
    Loader { name: "mtl", read: mtl },
    Loader { name: "ply", read: ply },
    Loader { name: "exr", read: exr },
    Loader { name: "hdr", read: hdr },
    Loader { name: "png", read: png },
    Loader { name: "jpeg", read: jpeg },
    Loader { name: "checkpoint", read: checkpoint },
    Loader { name: "part", read: part },
];

/// What files may ask for here.
fn limits() -> Limits {
    Limits::default()
        .with(Limit::Pixels, Some(1 << 20))
        .with(Limit::Triangles, Some(1 << 16))
        .with(Limit::Texels, Some(1 << 16))
        .with(Limit::Textures, Some(1 << 18))
        .with(Limit::Bytes, Some(1 << 20))
        .with(Limit::SceneBytes, Some(1 << 20))
        .with(Limit::Files, Some(100))
}

/// A folder with files that scenes and materials may name, and how far those are trusted.
struct Stage {
    folder: TempDir,
    trust: Trust,
}

impl Stage {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The one of this process; in memory where the system has a folder for that.
    fn get() -> &'static Self {
        static STAGE: OnceLock<Stage> = OnceLock::new();
        STAGE.get_or_init(|| {
            let memory = Path::new("/dev/shm");
            let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
            let folder = folder.expect("a folder");
            let seeds = Path::new(env!("CARGO_MANIFEST_DIR"));
            // The manifest is that of the fuzz targets, or that of the renderer.
            let seeds =
                [seeds.join("seeds"), seeds.join("tests/fuzz/seeds")].into_iter().find(|it| it.is_dir());
            let seeds = seeds.expect("seeds");
            for (from, name) in [
                ("obj/two_materials.obj", "a.obj"),
                ("mtl/kinds.mtl", "m.mtl"),
                ("ply/quad.ply", "a.ply"),
                ("png/palette.png", "a.png"),
                ("jpeg/gray.jpg", "a.jpg"),
                ("exr/half.exr", "a.exr"),
                ("hdr/two.hdr", "a.hdr"),
                ("scene/plain.toml", "more.toml"),
            ] {
                fs::copy(seeds.join(from), folder.path().join(name)).expect("copied");
            }
            let trust = Trust { limits: limits(), sandbox: Some(Sandbox::new(folder.path())) };
            Self { folder, trust }
        })
    }

    /// The scene in a file, as far as it is one.
    fn scene(&self, name: &str) -> Option<Built> {
        let path = self.path(name);
        let loaded = scene::load_within(&path, &[], &self.trust).ok()?;
        let built = scene::build_within(&loaded.description, &self.trust).ok()?;
        assert!(scene::fingerprint(&loaded.description, self.folder.path()).len() == 32, "a hash");
        black_box(Needs::of(&built.scene, &Wanted::anything()));
        black_box(needs::warnings(&built.scene, &built.origins));
        // With what has no effect left out.
        let from = (&self.trust, &Arc::default());
        black_box(scene::build_from(&loaded.description, &Wanted::default(), from).is_ok());
        Some(built)
    }
}

/// A scene file that may name the files of the stage.
pub(crate) fn scene(data: &[u8]) {
    let stage = Stage::get();
    fs::write(stage.path("scene.toml"), data).expect("written");
    stage.scene("scene.toml");
}

/// A mesh in a file of that name.
fn mesh(data: &[u8], name: &str) {
    let stage = Stage::get();
    let shading = match data.len() % 3 {
        0 => Shading::from(Normals::File),
        1 => Shading::from(Normals::Smooth),
        _ => Shading { normals: Normals::Smooth, crease_deg: 30.0 },
    };
    let about = if data.len().is_multiple_of(2) { About::Needed } else { About::Middle };
    if let Ok(loaded) = decode_mesh(data.to_vec(), &stage.path(name), shading, about, &stage.trust) {
        assert!(!loaded.mesh.triangles().is_empty(), "a mesh has triangles");
        assert!(loaded.mesh.positions().iter().all(|p| p.is_finite()), "finite");
    }
}

/// A mesh that may name the materials of the stage.
pub(crate) fn obj(data: &[u8]) {
    mesh(data, "fuzzed.obj");
}

/// A mesh.
pub(crate) fn ply(data: &[u8]) {
    mesh(data, "fuzzed.ply");
}

/// Materials that may name the pictures of the stage, of a mesh that uses all of them whatever they are called.
pub(crate) fn mtl(data: &[u8]) {
    let stage = Stage::get();
    fs::write(stage.path("fuzzed.mtl"), data).expect("written");
    let mut text = "mtllib fuzzed.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    let names = String::from_utf8_lossy(data);
    for name in names.lines().filter_map(|line| line.trim().strip_prefix("newmtl ")).take(16) {
        text += &format!("usemtl {name}\nf 1 2 3\n");
    }
    fs::write(stage.path("named.obj"), text).expect("written");
    fs::write(stage.path("mtl.toml"), "[[shapes]]\ntype = 'mesh'\nfile = 'named.obj'\n").expect("written");
    stage.scene("mtl.toml");
}

/// A picture in a file of that name, for all who may want it.
fn picture(data: &[u8], name: &str) {
    let (name, limits) = (Path::new(name), limits());
    if let Ok(raster) = image::decode_raster(data, name, &limits) {
        let pixels = match &raster.pixels {
            Pixels::Gray(values) => values.len(),
            Pixels::Bytes(values) => values.len(),
            Pixels::Floats { values, .. } => values.len(),
        };
        assert_eq!(pixels, raster.width as usize * raster.height as usize, "as many as it says");
        for space in [Space::Srgb, Space::Linear] {
            black_box(Bitmap::new(&raster, space));
        }
    }
    if let Ok(gray) = image::decode_gray(data, name, &limits) {
        assert_eq!(gray.values.len(), gray.width as usize * gray.height as usize, "as many as it says");
    }
    if let Ok(decoded) = image::decode(data, name, &limits) {
        assert!(
            decoded.image.pixels().iter().all(|p| p.r.is_finite() && p.g.is_finite() && p.b.is_finite()),
            "no NaN passes"
        );
        let _ = EnvironmentMap::new(decoded.image, 1.0, 0.0);
    }
}

/// A picture, also as one to be judged, and as a saved first pass.
pub(crate) fn exr(data: &[u8]) {
    picture(data, "fuzzed.exr");
    if let Ok(picture) = image::exr::decode(data, Path::new("fuzzed.exr"), &limits()) {
        let _ = specula::post::saved(&picture, Path::new("fuzzed.exr"));
        let _ = picture.into_stored(Path::new("fuzzed.exr"));
    }
}

/// A picture.
pub(crate) fn hdr(data: &[u8]) {
    picture(data, "fuzzed.hdr");
}

/// A picture.
pub(crate) fn png(data: &[u8]) {
    picture(data, "fuzzed.png");
    let _ = image::png::decode(data, Path::new("fuzzed.png"), &limits());
}

/// A picture.
pub(crate) fn jpeg(data: &[u8]) {
    picture(data, "fuzzed.jpg");
}

/// A file of sums with checksums that are right, which no change by chance would leave so: two bytes that say how long the head is, the
/// head, and the arrays.
fn sealed(data: &[u8]) -> Vec<u8> {
    let (head, arrays) = match data {
        [low, high, rest @ ..] => {
            rest.split_at(usize::from(u16::from_le_bytes([*low, *high])).min(rest.len()))
        }
        _ => (data, &[][..]),
    };
    let number = |length: usize| u32::try_from(length).expect("short").to_le_bytes();
    let mut bytes = b"SPECSUMS\x01\0\0\0".to_vec();
    bytes.extend(number(head.len()));
    bytes.extend(number(arrays.len()));
    bytes.extend([0; 4]);
    let sum = crc32fast::hash(&[&bytes, head].concat());
    bytes.extend(sum.to_le_bytes());
    bytes.extend(head);
    bytes.extend(arrays);
    bytes.extend(crc32fast::hash(arrays).to_le_bytes());
    bytes
}

/// What [`sealed`] makes that file of.
pub(crate) fn unsealed(file: &[u8]) -> Vec<u8> {
    let head = u32::from_le_bytes(file[12..16].try_into().expect("four"));
    let mut data = u16::try_from(head).expect("a short head").to_le_bytes().to_vec();
    data.extend(&file[28..file.len() - 4]);
    data
}

/// A part of a picture: as it is, and with right checksums.
pub(crate) fn part(data: &[u8]) {
    for bytes in [data, &sealed(data)] {
        let Ok(file) = PartFile::open(bytes, bytes.len() as u64) else { continue };
        let Ok(Part { film, .. }) = file.read() else { continue };
        film.picture(Precision::Float, vec![]);
        film.image();
        let mut sum = film.clone();
        sum.add(&film);
        sum.picture(Precision::Half, vec![]);
    }
}

/// The scene and the settings of the pictures that checkpoints are of.
pub(crate) fn under_way() -> (&'static Scene, Settings) {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    let scene = SCENE.get_or_init(|| {
        let stage = Stage::get();
        stage.scene("more.toml").expect("a scene").scene
    });
    let layout = Layout::with([Aov::Variance, Aov::ObjectId]);
    let limits = Ends { error: Some(1e-9), ..Ends::default() };
    (scene, Settings { threads: NonZeroUsize::new(1), layout, limits, ..Settings::default() })
}

/// A checkpoint: as it is, and with right checksums. What is accepted is gone on from.
pub(crate) fn checkpoint(data: &[u8]) {
    let (scene, settings) = under_way();
    for bytes in [data, &sealed(data)] {
        let reader: Box<dyn Read + '_> = Box::new(bytes);
        let Ok(checkpoint) = Checkpoint::open(reader, bytes.len() as u64) else { continue };
        let begin = Some((checkpoint, Place::file("fuzzed.ckpt")));
        if let Ok(rendered) = render_kept(scene, &settings, &Silent, Kept { begin, keeper: None }) {
            rendered.film.image();
        }
    }
}
