//! Veach's plates: four roughnesses under lights of several sizes, by asking lights, by following lobes, and by both.
//!
//! Veach 1997 (Robust Monte Carlo Methods for Light Transport Simulation), figure 9.2.

use crate::data::data;
use crate::mitsuba::Peer;
use crate::scene::scene_of;
use crate::shots::{Shot, Verdict};
use crate::table::{HEAD, dump, row, samples, tell};
use specula::film::{Aov, Layout};
use specula::render::{Settings, Silent, render};
use std::fmt::Write as _;
use std::path::PathBuf;

const SIZE: [u32; 2] = [160, 90];

const STRATEGIES: [&str; 3] = ["light", "bsdf", "both"];

fn plates() -> Option<(PathBuf, Peer)> {
    let folder = data("scenes/veach-mis")?;
    let mut peer = Peer::read(&folder.join("scene.xml"));
    // The picture shows no light that plates and floor throw on each other, whatever the description says; and where strategies are
    // compared it would be the same for all.
    peer.max_depth = 2;
    Some((folder, peer))
}

fn settings(direct: &str, spp: u32) -> String {
    format!("integrator = \"path\"\nsampler = \"independent\"\ndirect = \"{direct}\"\nspp = {spp}")
}

/// All three bring the same picture, and it is that of Tungsten.
#[test]
fn strategies_agree_with_each_other_and_with_tungsten() {
    let Some((folder, peer)) = plates() else { return };
    let reference = Shot::read(&folder.join("TungstenRender.exr"), None).blocks(8);
    let mut table = HEAD.to_owned();
    let mut failed = Vec::new();
    let shots = STRATEGIES.map(|direct| {
        let spp = samples(if direct == "both" { 64 } else { 256 });
        (spp, Shot::of(&scene_of(&peer.scene(&settings(direct, spp), SIZE))))
    });
    for (direct, (spp, shot)) in STRATEGIES.into_iter().zip(&shots) {
        // Without the lights themselves, whose edges filters treat differently.
        let dropped: Vec<bool> = reference.blocks(10).mean.iter().map(|pixel| pixel[1] > 3.0).collect();
        dump(&format!("plates_{direct}"), shot, &reference);
        let rare = if direct == "bsdf" {
            "; the small lamp is met too seldom for its noise to be known"
        } else {
            ""
        };
        // Their noise is not known.
        let truth = reference.blocks(10).without(&dropped).doubted(5e-3);
        let verdict = Verdict::of(&shot.blocks(10).without(&dropped), &truth);
        table += &row(
            "veach-mis",
            *spp,
            &verdict,
            &format!("{direct}, against Tungsten's direct light; blocks of 80 by 80{rare}"),
        );
        let local = direct != "bsdf" && verdict.beyond > 3;
        if local || (verdict.bias.abs() > 5e-3 && verdict.bias_deviations > 3.5) {
            failed.push(format!("{direct}: {verdict:?}"));
        }
    }
    for (direct, (spp, shot)) in STRATEGIES.into_iter().zip(&shots).take(2) {
        let verdict = Verdict::of(&shot.blocks(10), &shots[2].1.blocks(10));
        table += &row("veach-mis", *spp, &verdict, &format!("{direct}, against both; blocks of 10 by 10"));
        if verdict.bias_deviations > 3.5 {
            failed.push(format!("{direct} against both: {verdict:?}"));
        }
    }
    tell("Plates", &table);
    assert!(failed.is_empty(), "{failed:?}");
}

/// Plates from the smoothest to the roughest, by where their points are.
const WIDTHS: [f32; 4] = [0.01, 0.05, 0.1, 0.25];

/// Radii of a light of the same power.
const RADII: [f64; 4] = [1.0, 0.4, 0.15, 0.05];

/// The plate that each pixel shows in full.
fn plate_of_pixels(peer: &Peer) -> Vec<Option<usize>> {
    let scene = scene_of(&peer.scene("integrator = \"view\"\nspp = 16", SIZE));
    let settings = Settings { layout: Layout::with([Aov::Position, Aov::Normal]), ..Settings::default() };
    let film = render(&scene, &settings, &Silent).expect("a picture").film;
    let place = film.channels(Aov::Position).expect("kept");
    let normal = film.channels(Aov::Normal).expect("kept");
    (0..place[0].len())
        .map(|i| {
            let (x, y) = (place[0][i], place[1][i]);
            // Their tops lean towards the viewer by different angles; floor and wall do not.
            let [nx, ny] = [normal[0][i], normal[1][i]];
            let leans = (0.1..0.8).contains(&nx) && nx.hypot(ny) > 0.999;
            let plate = if x < 1.6 {
                0
            } else if x < 5.1 {
                1
            } else if x < 8.9 {
                2
            } else {
                3
            };
            (leans && y > 0.9).then_some(plate)
        })
        .collect()
}

/// Mean variance of a sample over the pixels of a plate that a light shines on, over the square of their mean.
fn noise(shot: &Shot, plates: &[Option<usize>], plate: usize, spp: u32) -> f64 {
    let pixels: Vec<usize> = (0..plates.len()).filter(|&i| plates[i] == Some(plate)).collect();
    assert!(pixels.len() > 100, "pixels of plate {plate}");
    let mean = pixels.iter().map(|&i| shot.mean[i][1]).sum::<f64>();
    let variance = pixels.iter().map(|&i| shot.variance[i][1]).sum::<f64>() * f64::from(spp);
    variance / pixels.len() as f64 / (mean / pixels.len() as f64).powi(2)
}

/// Lobes find large lights in smooth plates, lights find small ones over rough plates, and both together are never much worse than
/// the better of the two.
#[test]
fn both_strategies_together_are_never_much_worse_than_the_better_one() {
    let Some((_, peer)) = plates() else { return };
    let plates = plate_of_pixels(&peer);
    let spp = samples(64);
    let mut found = [[[0.0; 3]; 4]; 4];
    for (row, radius) in RADII.into_iter().enumerate() {
        let radiance = 7.6 / (radius * radius);
        let light = format!(
            "type = \"sphere\"\ncenter = [0.0, 6.5, 0.0]\nradius = {radius:?}\nradiance = {radiance:?}\n"
        );
        let peer = peer.lit_by(&light);
        for (column, direct) in STRATEGIES.into_iter().enumerate() {
            let shot = Shot::of(&scene_of(&peer.scene(&settings(direct, spp), SIZE)));
            for (plate, cells) in found[row].iter_mut().enumerate() {
                cells[column] = noise(&shot, &plates, plate, spp);
            }
        }
    }
    let mut table = format!(
        "Variance of a sample over the square of the mean: {}.\n\n| radius of the light | alpha {} |\n|---|---|---|---|---|\n",
        STRATEGIES.join(" / "),
        WIDTHS.map(|width| width.to_string()).join(" | alpha ")
    );
    for (radius, row) in RADII.into_iter().zip(&found) {
        let cells = row.map(|[light, bsdf, both]| format!("{light:.2} / {bsdf:.2} / {both:.2}"));
        let _ = writeln!(table, "| {radius} | {} |", cells.join(" | "));
    }
    tell("Strategies", &table);
    for (radius, row) in RADII.into_iter().zip(&found) {
        for (width, [light, bsdf, both]) in WIDTHS.into_iter().zip(row) {
            let better = light.min(*bsdf);
            assert!(*both < 2.5 * better, "radius {radius}, alpha {width}: {both} beside {light} and {bsdf}");
        }
    }
    let [large_smooth, small_rough] = [found[0][0], found[3][3]];
    assert!(
        large_smooth[1] * 10.0 < large_smooth[0],
        "lobes find large lights in smooth plates: {large_smooth:?}"
    );
    assert!(
        small_rough[0] * 10.0 < small_rough[1],
        "lights are found by asking over rough plates: {small_rough:?}"
    );
}
