//! Sums, tiles and what is made of them.

use super::*;
use crate::film::{Filter, FilterSample, FilterShape, SampleId};

/// A sample of a made-up scene: value and weight depend on pixel and index alone.
fn sample(id: SampleId) -> (f32, [f32; 4]) {
    let hash =
        (id.x.wrapping_mul(73_856_093) ^ id.y.wrapping_mul(19_349_663) ^ id.index.wrapping_mul(83_492_791))
            >> 9;
    let value = f32::from(u16::try_from(hash & 0xffff).expect("sixteen bits")) * 1e-3;
    (if hash.is_multiple_of(9) { -1.3 } else { 1.3 }, [value, value * 0.1, 7.0 / (value + 0.1), 0.5])
}

fn tile(window: Window, spp: u32) -> Tile {
    let mut tile = Tile::new(window, Layout::default());
    for y in window.y0..window.y1 {
        for x in window.x0..window.x1 {
            for index in 0..spp {
                let id = SampleId { y, x, index };
                let (weight, values) = sample(id);
                tile.add(id, weight, &values);
            }
        }
    }
    tile
}

/// Tiles of that size over a window, last first.
fn film_of_tiles(full: [u32; 2], window: Window, size: u32) -> Film {
    let mut film = Film::new(full, window, Layout::default());
    for y0 in (window.y0..window.y1).step_by(size as usize).rev() {
        for x0 in (window.x0..window.x1).step_by(size as usize).rev() {
            let part = Window { x0, y0, x1: (x0 + size).min(window.x1), y1: (y0 + size).min(window.y1) };
            film.put(&tile(part, 5));
        }
    }
    film
}

#[test]
fn a_film_does_not_depend_on_its_tiles() {
    let whole = film_of_tiles([37, 23], Window::whole(37, 23), 64);
    assert_eq!(film_of_tiles([37, 23], Window::whole(37, 23), 8), whole, "tiles of 8");
    assert_eq!(film_of_tiles([37, 23], Window::whole(37, 23), 1), whole, "tiles of 1");
    assert_eq!(whole.samples(), 37 * 23 * 5, "samples");
}

#[test]
fn a_part_goes_on_where_it_was_left() {
    let window = Window { x0: 2, y0: 1, x1: 9, y1: 6 };
    let whole = film_of_tiles([10, 8], window, 4);
    let mut film = Film::new([10, 8], window, Layout::default());
    let parts = [Window { x0: 2, y0: 1, x1: 6, y1: 6 }, Window { x0: 6, y0: 1, x1: 9, y1: 6 }];
    for (from, to) in [(0, 2), (2, 5)] {
        for part in parts {
            let mut tile = film.part(part);
            for (y, x) in (part.y0..part.y1).flat_map(|y| (part.x0..part.x1).map(move |x| (y, x))) {
                for index in from..to {
                    let id = SampleId { y, x, index };
                    let (weight, values) = sample(id);
                    tile.add(id, weight, &values);
                }
            }
            film.put(&tile);
        }
    }
    assert_eq!(film, whole, "to the bit as in one go");
    assert_eq!(film.samples_of_pixels(), [5, 5], "samples");
}

#[test]
fn a_run_is_what_its_samples_are_one_by_one() {
    let window = Window { x0: 2, y0: 1, x1: 5, y1: 3 };
    let (mut single, mut runs) = (tile(window, 0), tile(window, 0));
    for (y, x) in (1..3).flat_map(|y| (2..5).map(move |x| (y, x))) {
        for (from, to) in [(0, 3), (3, 4), (4, 9)] {
            let mut samples: Vec<_> = (from..to).map(|index| sample(SampleId { x, y, index })).collect();
            samples[0].1[2] = if x == 3 { f32::NAN } else { 0.3 };
            for (index, (weight, values)) in (from..).zip(&samples) {
                single.add(SampleId { x, y, index }, *weight, values);
            }
            let (weights, values): (Vec<_>, Vec<_>) = samples.into_iter().unzip();
            runs.add_run(SampleId { x, y, index: from }, &weights, values.as_flattened());
        }
    }
    assert_eq!(runs, single, "sums, to the bit, and what was dropped");
    assert_eq!(single.non_finite.count(), 6, "dropped");
}

#[test]
fn a_crop_is_a_part_of_the_whole() {
    let whole = film_of_tiles([37, 23], Window::whole(37, 23), 16).image();
    let window = Window { x0: 5, y0: 7, x1: 30, y1: 20 };
    let crop = film_of_tiles([37, 23], window, 16).image();
    for y in 0..window.height() {
        for x in 0..window.width() {
            assert_eq!(crop.pixel(x, y), whole.pixel(x + 5, y + 7), "at {x}, {y}");
        }
    }
}

#[test]
fn a_flat_area_stays_flat_under_a_filter_with_negative_parts() {
    let filter = Filter::new(FilterShape::Mitchell, 2.0);
    for spp in [1, 2, 3, 16] {
        let mut tile = Tile::new(Window::whole(1, 1), Layout::default());
        for index in 0..spp {
            // Every other sample lies in the negative part of one axis: at two samples the weights cancel.
            let u = if index % 2 == 0 { [0.5, 0.5] } else { [0.01, 0.5] };
            tile.add(SampleId { y: 0, x: 0, index }, filter.sample(u).weight, &[0.75, 3.0, 1e-4, 1.0]);
        }
        let mut film = Film::new([1, 1], Window::whole(1, 1), Layout::default());
        film.put(&tile);
        let colour = film.image().pixel(0, 0);
        let error = |a: f32, b: f32| (a / b - 1.0).abs();
        let worst = error(colour.r, 0.75).max(error(colour.g, 3.0)).max(error(colour.b, 1e-4));
        assert!(worst < 1e-6, "{spp} samples: {colour:?}");
    }
}

/// One pixel of 65 536 samples spread as Hammersley's points shows E[w L]; for L = x^2 that is the filter's second moment.
/// The discrepancy of the points is of the order of 1e-4, w L varies by a few units; ignoring signs would be off by 0.1.
#[test]
fn pixels_converge_to_the_filtered_picture() {
    let filter = Filter::new(FilterShape::Mitchell, 2.0);
    let mut tile = Tile::new(Window::whole(1, 1), Layout::default());
    for i in 0..=u16::MAX {
        let u = [i, i.reverse_bits()].map(|n| (f32::from(n) + 0.5) / 65536.0);
        let FilterSample { offset: [x, y], weight } = filter.sample(u);
        tile.add(SampleId { y: 0, x: 0, index: i.into() }, weight, &[x * x, y * y, x * y, 1.0]);
    }
    let mut film = Film::new([1, 1], Window::whole(1, 1), Layout::default());
    film.put(&tile);
    let Rgb { r, g, b } = film.image().pixel(0, 0);
    let worst = (r - second_moment()).abs().max((g - second_moment()).abs()).max(b.abs());
    assert!(worst < 5e-4, "({r}, {g}, {b}) for {}", second_moment());
}

/// Of Mitchell's filter, from the antiderivatives of its two polynomials (times 18) at 0, 1 and 2.
fn second_moment() -> f32 {
    let inner = 21.0 / 6.0 - 36.0 / 5.0 + 16.0 / 3.0;
    let outer = |x: f32| {
        -7.0 * x.powi(6) / 6.0 + 36.0 * x.powi(5) / 5.0 - 60.0 * x.powi(4) / 4.0 + 32.0 * x.powi(3) / 3.0
    };
    2.0 * (inner + outer(2.0) - outer(1.0)) / 18.0
}

#[test]
fn samples_that_are_not_finite_count_as_black_and_are_recorded() {
    let mut tile = Tile::new(Window { x0: 3, y0: 4, x1: 4, y1: 5 }, Layout::default());
    for (index, value) in [2.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY].into_iter().enumerate() {
        let index = u32::try_from(index).expect("small");
        tile.add(SampleId { y: 4, x: 3, index }, 1.0, &[1.0, value, 1.0, 1.0]);
    }
    let mut film = Film::new([8, 8], Window::whole(8, 8), Layout::default());
    film.put(&tile);
    assert_eq!(film.image().pixel(3, 4), Rgb::new(0.25, 0.5, 0.25), "a quarter of the samples");
    assert_eq!(film.non_finite().count(), 3, "counted");
    assert_eq!(film.non_finite().first()[0], SampleId { y: 4, x: 3, index: 1 }, "the first");
    assert_eq!(film.image().pixel(0, 0), Rgb::BLACK, "no samples");
}

#[test]
fn coverage_stays_a_fraction() {
    let mut tile = Tile::new(Window::whole(1, 1), Layout::default());
    tile.add(SampleId { y: 0, x: 0, index: 0 }, 1.3, &[1.0, 1.0, 1.0, 1.0]);
    tile.add(SampleId { y: 0, x: 0, index: 1 }, -1.3, &[0.0, 0.0, 0.0, 0.0]);
    let mut film = Film::new([1, 1], Window::whole(1, 1), Layout::default());
    film.put(&tile);
    assert!(film.image().pixel(0, 0).r > 1.0, "colour overshoots");
    assert_eq!(film.channels(Aov::Alpha), Some(vec![vec![1.0]]), "coverage does not");
}

#[test]
fn a_picture_has_the_channels_of_the_layout() {
    let film = film_of_tiles([37, 23], Window { x0: 1, y0: 2, x1: 5, y1: 6 }, 16);
    let picture = film.picture(Precision::Half, vec![("specula:seed".to_owned(), "0".to_owned())]);
    let names: Vec<_> = picture.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names, ["R", "G", "B", "A"], "names");
    assert!(matches!(picture.channel("R"), Some(Samples::Half(values)) if values.len() == 16), "halves");
    assert_eq!((picture.full, picture.window.x0), ([37, 23], 1), "windows");
}

#[test]
fn halves_are_for_colour_coverage_and_normals_alone() {
    let film = Film::new([1, 1], Window::whole(1, 1), Layout::with(Aov::ALL));
    let picture = film.picture(Precision::Half, vec![]);
    for aov in Aov::ALL {
        let wanted = match aov {
            Aov::Beauty
            | Aov::Alpha
            | Aov::Direct
            | Aov::Indirect
            | Aov::Albedo
            | Aov::Normal
            | Aov::GeometricNormal => "half",
            Aov::Depth
            | Aov::Position
            | Aov::Uv
            | Aov::Variance
            | Aov::Samples
            | Aov::CryptoObject
            | Aov::CryptoMaterial => "float",
            Aov::ObjectId | Aov::MaterialId => "integer",
        };
        for name in aov.channels() {
            let found = match picture.channel(name).expect("kept") {
                Samples::Half(_) => "half",
                Samples::Float(_) => "float",
                Samples::Uint(_) => "integer",
            };
            assert_eq!(found, wanted, "{name}");
        }
    }
}
