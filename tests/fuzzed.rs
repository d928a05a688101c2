//! Inputs on which loaders once failed, and those from which fuzzing starts, through the functions that are fuzzed (`tests/fuzz`).

#[path = "fuzz/loaders.rs"]
mod loaders;

use loaders::LOADERS;
use std::fs;
use std::path::{Path, PathBuf};

/// The files of a folder of a loader, in the order of their names.
fn inputs(folder: &str, loader: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz").join(folder).join(loader);
    let Ok(entries) = fs::read_dir(folder) else { return vec![] };
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths
}

#[test]
fn stored_inputs_have_an_answer_or_a_refusal() {
    let mut failures = 0;
    for loader in LOADERS {
        let (seeds, found) = (inputs("seeds", loader.name), inputs("found", loader.name));
        assert!(!seeds.is_empty(), "{} has seeds", loader.name);
        failures += found.len();
        for path in seeds.into_iter().chain(found) {
            // A panic names the test; this names the file.
            println!("{}", path.display());
            (loader.read)(&fs::read(&path).expect("readable"));
        }
    }
    assert!(failures > 0, "inputs on which loaders once failed");
}

/// Writes the seeds that no editor could: pictures in all the ways their formats know, parts and checkpoints without their checksums.
/// `SPECULA_SEEDS=1 cargo test --test fuzzed -- --ignored` puts them into the sources; otherwise they are made and dropped.
mod seeds {
    use super::loaders::{under_way, unsealed};
    use exr::prelude::{
        AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
        LineOrder, SmallVec, Vec2, WritableImage as _,
    };
    use image::{DynamicImage, ImageFormat};
    use specula::error::{Error, Result};
    use specula::film::{Aov, Layout};
    use specula::render::{Keeper, Kept, Part, Progress, Settings, Silent, State, outline, render_kept};
    use std::fs;
    use std::io::Cursor;
    use std::path::Path;
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::time::Duration;

    fn write(name: &str, bytes: &[u8]) {
        assert!(!bytes.is_empty(), "{name}");
        if std::env::var_os("SPECULA_SEEDS").is_some() {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/seeds");
            fs::write(folder.join(name), bytes).expect("written");
        }
    }

    fn colours() -> DynamicImage {
        let byte = |x: u32| u8::try_from(x % 256).expect("a byte");
        let pixel = |x, y| image::Rgba([byte(40 * x), byte(50 * y), byte(x * y), byte(255 - 20 * x)]);
        DynamicImage::ImageRgba8(image::RgbaImage::from_fn(7, 5, pixel))
    }

    #[test]
    #[ignore = "writes seeds into the sources where SPECULA_SEEDS is set"]
    fn pictures_of_eight_and_sixteen_bits() {
        let encoded = |picture: &DynamicImage, format| {
            let mut bytes = Cursor::new(Vec::new());
            picture.write_to(&mut bytes, format).expect("encoded");
            bytes.into_inner()
        };
        let colours = colours();
        let png = |name: &str, picture: DynamicImage| write(name, &encoded(&picture, ImageFormat::Png));
        png("png/rgba8.png", colours.clone());
        png("png/rgb16.png", DynamicImage::ImageRgb16(colours.to_rgb16()));
        png("png/gray8.png", DynamicImage::ImageLuma8(colours.to_luma8()));
        png("png/gray_alpha16.png", DynamicImage::ImageLumaA16(colours.to_luma_alpha16()));
        let jpeg = |name: &str, picture: DynamicImage| write(name, &encoded(&picture, ImageFormat::Jpeg));
        jpeg("jpeg/rgb.jpg", DynamicImage::ImageRgb8(colours.to_rgb8()));
        jpeg("jpeg/gray.jpg", DynamicImage::ImageLuma8(colours.to_luma8()));
    }

    #[test]
    #[ignore = "writes seeds into the sources where SPECULA_SEEDS is set"]
    fn pictures_of_floats() {
        let half = |i: usize| half::f16::from_f32(0.25 * i as f32);
        let halves = || FlatSamples::F16((0..20).map(half).collect());
        let floats = || FlatSamples::F32((0..20).map(|i| i as f32 - 3.0).collect());
        let uints = || FlatSamples::U32((0..20).collect());
        let ways = [
            ("exr/half.exr", Compression::ZIP16, Blocks::ScanLines),
            ("exr/raw.exr", Compression::Uncompressed, Blocks::ScanLines),
            ("exr/runs.exr", Compression::RLE, Blocks::ScanLines),
            ("exr/zip1_tiles.exr", Compression::ZIP1, Blocks::Tiles(Vec2(2, 3))),
            ("exr/piz.exr", Compression::PIZ, Blocks::ScanLines),
            ("exr/pxr24.exr", Compression::PXR24, Blocks::ScanLines),
            ("exr/b44.exr", Compression::B44, Blocks::Tiles(Vec2(4, 4))),
        ];
        for (name, compression, blocks) in ways {
            let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> =
                ["R", "G", "B"].map(|name| AnyChannel::new(name, halves())).into_iter().collect();
            if name.contains("raw") || name.contains("piz") {
                channels.push(AnyChannel::new("Z", floats()));
                channels.push(AnyChannel::new("id", uints()));
            }
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            let attributes = LayerAttributes::named("first");
            let layer = Layer::new((5, 4), attributes, encoding, AnyChannels::sort(channels));
            let mut bytes = Cursor::new(Vec::new());
            Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).expect("encoded");
            write(name, &bytes.into_inner());
        }
    }

    /// Stops after some samples.
    struct Stop(AtomicU64);

    impl Progress for Stop {
        fn advance(&self, done: u64, _total: u64) {
            self.0.store(done, Ordering::Relaxed);
        }

        fn is_cancelled(&self) -> bool {
            self.0.load(Ordering::Relaxed) >= 700
        }
    }

    #[derive(Default)]
    struct Memory(Mutex<Vec<u8>>);

    impl Keeper for Memory {
        fn every(&self) -> Duration {
            Duration::from_secs(3600)
        }

        fn keep(&self, state: &State) -> Result<()> {
            let mut bytes = Vec::new();
            state.write(&serde_json::json!({}), &mut bytes).expect("written");
            *self.0.lock().expect("sound") = bytes;
            Ok(())
        }

        fn missed(&self, error: Error) {
            panic!("{error}");
        }
    }

    #[test]
    #[ignore = "writes seeds into the sources where SPECULA_SEEDS is set"]
    fn sums() {
        let (scene, settings) = under_way();
        let (keeper, stop) = (Memory::default(), Stop(AtomicU64::new(0)));
        let kept = Kept { begin: None, keeper: Some(&keeper) };
        render_kept(scene, &settings, &stop, kept).expect_err("stopped");
        write("checkpoint/middle", &unsealed(&keeper.0.lock().expect("sound")));
        let small = specula::image::Window { x0: 1, y0: 1, x1: 4, y1: 3 };
        for (name, layout, crop) in
            [("part/plain", Layout::default(), None), ("part/all", Layout::with(Aov::ALL), Some(small))]
        {
            let settings = Settings { layout, crop, ..Settings::default() };
            let rendered = render_kept(scene, &settings, &Silent, Kept::default()).expect("a picture");
            let part = Part {
                outline: outline(scene, &settings).expect("a part"),
                film: rendered.film,
                counters: rendered.statistics.counters,
                about: serde_json::json!({}),
                told: serde_json::json!({}),
            };
            let mut bytes = Vec::new();
            part.write(&mut bytes).expect("written");
            write(name, &unsealed(&bytes));
        }
    }
}
