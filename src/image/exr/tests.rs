//! Files written, read back, and damaged.

use std::fs;
use std::path::PathBuf;

use super::*;
use crate::image::{Pixels, Raster, decode_gray, decode_raster, read_shown_within};
use crate::trust::{Limit, Limits, Trust};

/// A crop of three by two pixels at (4, 5) of ten by eight, with a channel of each kind.
fn small() -> Picture {
    let channel = |name: &str, samples| Channel { name: name.to_owned(), samples };
    Picture {
        full: [10, 8],
        window: Window { x0: 4, y0: 5, x1: 7, y1: 7 },
        channels: vec![
            channel("R", Samples::Float(vec![0.0, 0.1, 0.2, 0.3, 0.4, 1e30])),
            channel("G", Samples::Float(vec![1.0; 6])),
            channel("B", Samples::Float(vec![-0.5; 6])),
            channel("A", Samples::Half(vec![0.0, 0.5, 1.0, 1.0, 1.0, 1.0])),
            channel("id.U", Samples::Uint(vec![u32::MAX, 1, 2, 3, 4, 5])),
        ],
        attributes: vec![
            ("specula:note".to_owned(), "Größe 日本".to_owned()),
            ("specula:a name of more than thirty-one bytes".to_owned(), String::new()),
        ],
        warnings: Vec::new(),
    }
}

fn temporary() -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("a.exr");
    (dir, path)
}

/// Names and types of attributes that are numbers.
const DATA: &[u8] = b"dataWindow\0box2i\0";
const DISPLAY: &[u8] = b"displayWindow\0box2i\0";
const CHROMATICITIES: &[u8] = b"chromaticities\0chromaticities\0";

/// The same file with other numbers in an attribute: they follow its name, its type and its size.
fn with<const N: usize>(file: &[u8], attribute: &[u8], numbers: [[u8; 4]; N]) -> Vec<u8> {
    let mut file = file.to_vec();
    let start = file.windows(attribute.len()).position(|w| w == attribute).expect("there");
    let start = start + attribute.len() + 4;
    file[start..start + 4 * N].copy_from_slice(numbers.as_flattened());
    file
}

#[test]
fn a_crop_comes_back_with_all_its_channels_and_metadata() {
    let (_dir, path) = temporary();
    assert_eq!(write(&path, small()).expect("written"), [], "nothing was cut");
    let back = read(&path).expect("read");
    let wanted = small();
    assert_eq!((back.full, back.window), (wanted.full, wanted.window), "windows");
    for channel in &wanted.channels {
        assert_eq!(back.channel(&channel.name), Some(&channel.samples), "{}", channel.name);
    }
    for (key, value) in &wanted.attributes {
        assert_eq!(back.attribute(key), Some(value.as_str()), "{key}");
    }
    let infos = channels(&path).expect("read");
    let kinds: Vec<_> = infos.iter().map(|c| (c.name.as_str(), c.bits, c.is_float)).collect();
    let wanted = [("A", 16, true), ("B", 32, true), ("G", 32, true), ("R", 32, true), ("id.U", 32, false)];
    assert_eq!(kinds, wanted, "kinds");
    let colour = back.into_decoded(&path).expect("colour");
    assert_eq!(colour.image.pixel(1, 0), Rgb::new(0.1, 1.0, -0.5), "colour");
    assert_eq!(colour.alpha.map(|a| a.len()), Some(6), "alpha");
}

#[test]
fn halves_are_cut_at_their_largest_and_told() {
    let (_dir, path) = temporary();
    let mut picture = small();
    picture.channels[0].samples = Samples::Half(vec![1e6, -1e6, 65504.0, f32::INFINITY, 0.1, 0.0]);
    let warnings = write(&path, picture).expect("written");
    assert!(warnings.len() == 1 && warnings[0].what.contains("2 values"), "{warnings:?}");
    let back = read(&path).expect("read").channel("R").expect("there").to_f32();
    assert_eq!(back[..4], [65504.0, -65504.0, 65504.0, f32::INFINITY], "values");
    assert!((back[4] - 0.1).abs() < 0.1 / 2048.0, "eleven bits: {}", back[4]);
}

#[test]
fn numbers_that_are_not_finite_stay_out_of_colour() {
    let (_dir, path) = temporary();
    let mut picture = small();
    picture.channels[0].samples =
        Samples::Float(vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.3, f32::NAN, 0.0]);
    write(&path, picture).expect("written");
    let colour = crate::image::read(&path).expect("read");
    let reds: Vec<_> = colour.image.pixels().iter().map(|p| p.r).collect();
    assert_eq!(reds, [0.0, 65504.0, -65504.0, 0.3, 0.0, 0.0], "replaced");
    let stored = crate::image::read_as_stored(&path, &Trust::default()).expect("read");
    let bits: Vec<_> = stored.image.pixels().iter().map(|p| p.r.to_bits()).collect();
    let wanted = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.3, f32::NAN, 0.0].map(f32::to_bits);
    assert!(bits == wanted && stored.warnings.is_empty(), "as stored: {bits:x?}");
    let told: Vec<_> = colour.warnings.iter().map(|w| w.what.as_str()).collect();
    assert!(told.len() == 2 && told[0].starts_with("2 NaN") && told[1].starts_with("2 inf"), "{told:?}");
}

#[test]
fn what_a_file_cannot_hold_is_refused_and_the_old_one_stays() {
    type Spoil = fn(&mut Picture);
    let (_dir, path) = temporary();
    fs::write(&path, b"old").expect("written");
    let cases: [(&str, Spoil); 5] = [
        ("samples for", |p| p.channels[1].samples = Samples::Float(vec![0.0; 5])),
        ("two channels", |p| p.channels[1].name = "R".to_owned()),
        ("window", |p| p.full = [5, 5]),
        ("no channel", |p| p.channels.clear()),
        ("1 to 255", |p| p.attributes[0].0 = "x".repeat(256)),
    ];
    for (message, spoil) in cases {
        let mut picture = small();
        spoil(&mut picture);
        let error = write(&path, picture).expect_err(message).to_string();
        assert!(error.contains(message), "{error}");
        assert_eq!(fs::read(&path).expect("there"), b"old", "{message}: untouched");
    }
}

#[test]
fn damaged_files_are_refused_or_read_but_never_panic() {
    let (_dir, path) = temporary();
    let mut picture = small();
    picture.channels[0].samples = Samples::Float(vec![f32::MAX, 0.1, 0.2, 0.3, 0.4, 0.5]);
    write(&path, picture).expect("written");
    let sound = fs::read(&path).expect("there");
    for length in (0..sound.len()).step_by(7) {
        fs::write(&path, &sound[..length]).expect("written");
        assert!(read(&path).is_err(), "cut to {length} of {} bytes", sound.len());
    }
    let mut refused = 0;
    for position in 0..sound.len() {
        for flip in [0x01, 0xff] {
            let mut bytes = sound.clone();
            bytes[position] ^= flip;
            fs::write(&path, &bytes).expect("written");
            refused += usize::from(crate::image::read(&path).is_err());
        }
    }
    assert!(refused > sound.len() / 2, "only {refused} of {} flips were noticed", 2 * sound.len());
}

#[test]
fn a_few_bytes_that_claim_gigabytes_are_refused() {
    let (_dir, path) = temporary();
    let mut picture = small();
    (picture.full, picture.window) = ([3, 2], Window::whole(3, 2));
    write(&path, picture).expect("written");
    let bytes = fs::read(&path).expect("there");
    fs::write(&path, with(&bytes, DATA, [0_i32, 0, 16_000, 15].map(i32::to_le_bytes))).expect("written");
    let error = read(&path).expect_err("refused").to_string();
    assert!(error.contains("claims more pixels"), "{error}");
}

#[test]
fn layers_without_a_plain_colour_are_searched_in_order() {
    let samples = || Samples::Float(vec![0.5; 6]);
    let names = ["Z", "ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"];
    let channels = names.map(|name| Channel { name: name.to_owned(), samples: samples() }).into();
    let picture = Picture { channels, ..small() };
    assert!(picture.clone().into_decoded(Path::new("a.exr")).is_ok(), "found in its layer");
    let grey = Picture { channels: vec![Channel { name: "Y".to_owned(), samples: samples() }], ..small() };
    let grey = grey.into_decoded(Path::new("a.exr")).expect("grey");
    assert_eq!(grey.image.pixel(0, 0), Rgb::gray(0.5), "grey");
    let none = Picture { channels: picture.channels[..2].to_vec(), ..picture };
    let error = none.into_decoded(Path::new("a.exr")).expect_err("none").to_string();
    assert!(error.contains("(Z, ViewLayer.Combined.R)"), "{error}");
}

#[test]
fn textures_skies_and_heights_are_what_the_display_window_shows() {
    type Case = ([i32; 4], [u32; 2], &'static [(usize, f32)]);
    let (_dir, path) = temporary();
    let channel = |name: &str, values| Channel { name: name.to_owned(), samples: Samples::Half(values) };
    let channels = vec![channel("Y", vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), channel("A", vec![1.0; 6])];
    write(&path, Picture { channels, ..small() }).expect("written");
    let file = fs::read(&path).expect("there");
    // Data of three by two pixels at (4, 5): within, without, partly beyond, and all apart. Windows have their last pixels in them.
    let cases: [Case; 4] = [
        ([0, 0, 9, 7], [10, 8], &[(54, 1.0), (55, 2.0), (56, 3.0), (64, 4.0), (65, 5.0), (66, 6.0)]),
        ([5, 5, 5, 5], [1, 1], &[(0, 2.0)]),
        ([5, 6, 12, 7], [8, 2], &[(0, 5.0), (1, 6.0)]),
        ([-2, -3, 1, 1], [4, 5], &[]),
    ];
    for (display, [columns, rows], data) in cases {
        let file = with(&file, DISPLAY, display.map(i32::to_le_bytes));
        let mut wanted = vec![0.0; columns as usize * rows as usize];
        data.iter().for_each(|&(at, value)| wanted[at] = value);
        let gray = decode_gray(&file, &path, &Limits::default()).expect("heights");
        assert_eq!(
            ([gray.width, gray.height], gray.values),
            ([columns, rows], wanted.clone()),
            "{display:?}"
        );
        let raster = decode_raster(&file, &path, &Limits::default()).expect("a texture");
        let covered = |&x: &f32| [x, x, x, if x > 0.0 { 1.0 } else { 0.0 }];
        let values = wanted.iter().map(covered).collect();
        let Raster { width, height, pixels, .. } = raster;
        assert_eq!(([width, height], pixels), ([columns, rows], Pixels::Floats { values, half: true }));
        fs::write(&path, &file).expect("written");
        let sky = read_shown_within(&path, &Trust::default()).expect("a sky");
        assert_eq!((sky.full, sky.window), ([columns, rows], Window::whole(columns, rows)), "{display:?}");
        let wanted: Vec<_> = wanted.into_iter().map(Rgb::gray).collect();
        assert_eq!(sky.image.pixels(), wanted, "{display:?}");
    }
    let limits = Limits::default().with(Limit::Texels, Some(79));
    let error = decode_gray(&file, &path, &limits).expect_err("80 pixels").to_string();
    assert!(error.contains("10 by 8 pixels is too large"), "{error}");
    // The limit counts four channels of 32 bits to a pixel.
    let limits = limits.with(Limit::Texels, Some(80));
    let many = (0..17).map(|i| channel(&format!("c{i:02}"), vec![0.0; 6])).collect();
    write(&path, Picture { channels: many, ..small() }).expect("written");
    let file = fs::read(&path).expect("there");
    assert!(decode(&file, &path, &limits).is_ok(), "as it is stored");
    let error = decode_shown(&file, &path, &limits).map(drop).expect_err("170 of them").to_string();
    assert!(error.contains("its samples take 2720 bytes"), "{error}");
}

#[test]
fn other_primaries_are_told_where_numbers_are_colour() {
    let (_dir, path) = temporary();
    write(&path, small()).expect("written");
    let file = fs::read(&path).expect("there");
    let rec_709 = [0.64_f32, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];
    for i in 0..8 {
        for (step, told) in [(0.0, 0), (9e-4, 0), (-9e-4, 0), (2e-3, 1), (-2e-3, 1), (f32::NAN, 1)] {
            let mut numbers = rec_709;
            numbers[i] += step;
            let file = with(&file, CHROMATICITIES, numbers.map(f32::to_le_bytes));
            fs::write(&path, &file).expect("written");
            let warnings = [
                crate::image::read(&path).expect("colour").warnings,
                read_shown_within(&path, &Trust::default()).expect("a sky").warnings,
                decode_raster(&file, &path, &Limits::default()).expect("a texture").as_colour,
            ];
            for warnings in warnings {
                assert_eq!(warnings.len(), told, "{i}, {step}: {warnings:?}");
                let is_odd = |it: &Problem| it.what.contains("chromaticities other than those of Rec.709");
                assert!(warnings.iter().all(is_odd), "{warnings:?}");
            }
            let raster = decode_raster(&file, &path, &Limits::default()).expect("a texture");
            assert_eq!(raster.warnings, [], "for normals");
        }
    }
}
