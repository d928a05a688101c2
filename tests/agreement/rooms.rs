//! Rooms by other renderers: a Cornell box by Tungsten closely, a staircase loosely.

use crate::data::data;
use crate::mitsuba::Peer;
use crate::scene::scene_of;
use crate::shots::{Shot, Verdict};
use crate::table::{HEAD, dump, row, samples, tell};

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
    for (a, b) in found.mean.iter().zip(&reference.mean) {
        let off = (0..3).map(|c| (a[c] / b[c].max(1e-3) - 1.0).abs()).fold(0.0, f64::max);
        counts[[0.05, 0.1, 0.25].into_iter().position(|limit| off < limit).unwrap_or(3)] += 1;
    }
    counts
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
    let found = fit(&sky, &sun, &reference);
    let counts = by_distance(&found, &reference);
    let verdict = Verdict::of(&found, &reference.doubted(0.1));
    let remarks = format!(
        "the best sum of sky and sun; blocks of 80 by 80: {} within 5 %, {} within 10, {} within 25, {} beyond; {}",
        counts[0],
        counts[1],
        counts[2],
        counts[3],
        peer.remarks()
    );
    tell("Dining room", &(HEAD.to_owned() + &row("dining-room", spp, &verdict, &remarks)));
    let all: usize = counts.iter().sum();
    assert!(counts[3] * 5 < all * 2, "where the sun falls is where it fell: {counts:?}");
}

/// The sum of two pictures that comes nearest to a third, by least squares of relative differences, channel by channel.
fn fit(a: &Shot, b: &Shot, to: &Shot) -> Shot {
    let mut sum = a.clone();
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
        for (i, pixel) in sum.mean.iter_mut().enumerate() {
            pixel[c] = x * a.mean[i][c] + y * b.mean[i][c];
            sum.variance[i][c] = x * x * a.variance[i][c] + y * y * b.variance[i][c];
        }
    }
    sum
}
