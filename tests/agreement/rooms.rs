//! Rooms by other renderers: a Cornell box by Tungsten closely, a staircase loosely.

use crate::data::data;
use crate::mitsuba::Peer;
use crate::scene::scene_of;
use crate::shots::{Shot, Verdict};
use crate::table::{HEAD, dump, row, samples, tell};
use std::collections::BTreeMap;

#[test]
fn the_box_is_that_of_tungsten() {
    let Some(folder) = data("scenes/cornell-box") else { return };
    let peer = Peer::read(&folder.join("scene.xml"));
    let spp = samples(32);
    let settings = format!("integrator = \"path\"\nsampler = \"independent\"\nspp = {spp}");
    let found = Shot::of(&scene_of(&peer.scene(&settings, [256, 256])));
    let reference = Shot::read(&folder.join("TungstenRender.exr"), None).blocks(4);
    let [found, reference] = [found, reference].map(|shot| shot.blocks(16));
    // Without the lamp and its edges.
    let dropped: Vec<bool> = reference.mean.iter().map(|pixel| pixel[0] > 1.5).collect();
    let verdict = Verdict::of(&found.without(&dropped), &reference.without(&dropped).doubted(3e-3));
    let table =
        HEAD.to_owned() + &row("cornell-box", spp, &verdict, "blocks of 64 by 64 pixels of the reference");
    tell("Boxes", &table);
    assert!(verdict.bias.abs() < 3e-3 && verdict.beyond <= 3, "{verdict:?}");
}

/// Blocks of a picture by how far they are from a reference: up to a twentieth, a tenth, a quarter, and beyond.
fn by_distance(found: &Shot, reference: &Shot) -> [usize; 4] {
    let mut counts = [0; 4];
    found.mean.iter().zip(&reference.mean).for_each(|(a, b)| counts[distance(*a, *b)] += 1);
    counts
}

/// How far a block is off in its worst channel: up to a twentieth, a tenth, a quarter, or beyond.
fn distance(a: [f64; 3], b: [f64; 3]) -> usize {
    let off = (0..3).map(|c| (a[c] / b[c].max(1e-3) - 1.0).abs()).fold(0.0, f64::max);
    [0.05, 0.1, 0.25].into_iter().position(|limit| off < limit).unwrap_or(3)
}

/// Loosely: the steps' coats are smooth instead of rough, and the description has another floor than the picture.
#[test]
fn the_staircase_is_nearly_that_of_tungsten() {
    let Some(folder) = data("scenes/staircase2") else { return };
    let peer = Peer::read(&folder.join("scene.xml"));
    let spp = samples(128);
    let settings = format!("integrator = \"path\"\nsampler = \"independent\"\nspp = {spp}");
    let found = Shot::of(&scene_of(&peer.scene(&settings, [128, 128])));
    let reference = Shot::read(&folder.join("TungstenRender.exr"), None).blocks(8);
    dump("staircase2", &found, &reference);
    let [found, reference] = [found, reference].map(|shot| shot.blocks(8));
    let counts = by_distance(&found, &reference);
    let verdict = Verdict::of(&found, &reference.doubted(0.05));
    let remarks = format!(
        "blocks of 64 by 64: {} within 5 %, {} within 10, {} within 25, {} beyond; {}",
        counts[0],
        counts[1],
        counts[2],
        counts[3],
        peer.remarks()
    );
    tell("Staircase", &(HEAD.to_owned() + &row("staircase2", spp, &verdict, &remarks)));
    // Smooth coats are the greatest difference, at the steps.
    assert!(verdict.bias.abs() < 0.02, "{verdict:?}");
    assert!(counts[0] > 200 && counts[3] < 6, "{counts:?}");
}

/// Loosely: our scene files have no sky with a sun. Light adds up, so the picture is compared with the best sum, per channel, of one lit by
/// a constant sky and one lit by a sun where theirs is.
#[test]
fn the_dining_room_is_nearly_that_of_tungsten() {
    let Some(folder) = data("scenes/dining-room") else { return };
    let peer = Peer::read(&folder.join("scene.xml"));
    let spp = samples(64);
    let settings = format!("integrator = \"path\"\nsampler = \"sobol\"\nspp = {spp}");
    // Seen from where light goes, the direction of the file is that towards the sun.
    let lights = [
        "type = \"environment\"\nradiance = 1.0\n",
        "type = \"directional\"\ndirection = [-0.88698, -0.288862, -0.360313]\nirradiance = 1.0\n",
    ];
    let [sky, sun] = lights.map(|light| Shot::of(&scene_of(&peer.lit_by(light).scene(&settings, [80, 45]))));
    let reference = Shot::read(&folder.join("TungstenRender.exr"), None).blocks(16);
    // Without what the window shows.
    let dropped: Vec<bool> = sky.blocks(5).mean.iter().map(|pixel| pixel[1] > 0.3).collect();
    let [sky, sun, reference] = [sky, sun, reference].map(|shot| shot.blocks(5).without(&dropped));
    let (found, [of_sky, of_sun]) = fit(&sky, &sun, &reference);
    let counts = by_distance(&found, &reference);
    let verdict = Verdict::of(&found, &reference.clone().doubted(0.1));
    let remarks = format!(
        "the best sum of sky and sun; blocks of 80 by 80: {} within 5 %, {} within 10, {} within 25, {} beyond; {}",
        counts[0],
        counts[1],
        counts[2],
        counts[3],
        peer.remarks()
    );
    tell("Dining room", &(HEAD.to_owned() + &row("dining-room", spp, &verdict, &remarks)));
    // Places of the blocks that are left.
    let places = dropped.iter().enumerate().filter(|(_, dropped)| !**dropped).map(|(i, _)| [i % 16, i / 16]);
    let mut regions: BTreeMap<&str, Region> = BTreeMap::new();
    for (i, place) in places.enumerate() {
        let (own, truth) = (found.mean[i], reference.mean[i]);
        let is_sunny = of_sun[1] * sun.mean[i][1] > of_sky[1] * sky.mean[i][1];
        regions.entry(region(place, is_sunny)).or_default().add(own, truth);
    }
    let rows: String = regions.iter().map(|(name, region)| region.row(name)).collect();
    let head = "| region | blocks | within 5 % | within 10 | within 25 | beyond | mean, % |\n|---|---|---|---|---|---|---|\n";
    tell("Dining room by regions", &(head.to_owned() + &rows));
    // As many as were found, and those that may go beyond with other random numbers.
    assert!(counts[3] <= FAR + 4, "where the sun falls is where it fell: {counts:?}");
    assert!(verdict.bias.abs() < 0.12, "{verdict:?}");
}

/// Blocks of the dining room that were more than a quarter off when this was written: the sky and the sun are others.
const FAR: usize = 46;

/// Blocks that lie together.
#[derive(Default)]
struct Region {
    counts: [usize; 4],
    found: f64,
    truth: f64,
}

impl Region {
    fn add(&mut self, found: [f64; 3], truth: [f64; 3]) {
        self.counts[distance(found, truth)] += 1;
        self.found += found.iter().sum::<f64>();
        self.truth += truth.iter().sum::<f64>();
    }

    fn row(&self, name: &str) -> String {
        let [near, close, far, beyond] = self.counts;
        let mean = (self.found / self.truth - 1.0) * 100.0;
        format!(
            "| {name} | {} | {near} | {close} | {far} | {beyond} | {mean:+.1} |\n",
            near + close + far + beyond
        )
    }
}

/// What a block of the dining room shows, of 16 columns and 9 rows of them.
fn region([column, row]: [usize; 2], is_sunny: bool) -> &'static str {
    match (column, row) {
        (_, 7..) => "floor and legs",
        (_, 5..) if (2..=12).contains(&column) => "table and chairs",
        (6..=8, 1..=3) => "painting",
        (13.., _) => "wall around the window",
        _ if is_sunny => "walls in the sun",
        _ => "walls in the shade",
    }
}

/// The sum of two pictures that comes nearest to a third, by least squares of relative differences, channel by channel, and how much of each
/// is in it.
fn fit(a: &Shot, b: &Shot, to: &Shot) -> (Shot, [[f64; 3]; 2]) {
    let (mut sum, mut parts) = (a.clone(), [[0.0; 3]; 2]);
    for c in 0..3 {
        let [mut aa, mut ab, mut bb, mut at, mut bt] = [0.0; 5];
        for ((a, b), to) in a.mean.iter().zip(&b.mean).zip(&to.mean) {
            let weight = (to[c] + 0.05).powi(-2);
            aa += weight * a[c] * a[c];
            ab += weight * a[c] * b[c];
            bb += weight * b[c] * b[c];
            at += weight * a[c] * to[c];
            bt += weight * b[c] * to[c];
        }
        let determinant = aa * bb - ab * ab;
        let (x, y) = ((at * bb - bt * ab) / determinant, (aa * bt - ab * at) / determinant);
        (parts[0][c], parts[1][c]) = (x, y);
        for (i, pixel) in sum.mean.iter_mut().enumerate() {
            pixel[c] = x * a.mean[i][c] + y * b.mean[i][c];
            sum.variance[i][c] = x * x * a.variance[i][c] + y * y * b.variance[i][c];
        }
    }
    (sum, parts)
}
