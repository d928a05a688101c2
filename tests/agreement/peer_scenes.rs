//! Two scenes with converged pictures by Mitsuba, `peer-scenes` of the data: what is between ours and theirs is noise.

use crate::peers;
use crate::scene::scene_of;
use crate::shots::{Shot, Verdict};
use crate::table::{HEAD, row, samples, tell};

/// Side of the pictures.
const SIZE: u32 = 256;

/// Samples of the references.
const THEIR_SAMPLES: f64 = 4096.0;

/// The mean square difference less what our noise makes of it, with its standard error, and the variance of one sample of ours.
///
/// What is left is the noise of the reference, which has about the same variance per sample, and bias.
fn excess(found: &Shot, reference: &Shot, spp: u32) -> [f64; 3] {
    let pixels = found.mean.iter().zip(&found.variance).zip(&reference.mean);
    let terms: Vec<f64> =
        pixels.map(|((a, v), b)| (0..3).map(|c| (a[c] - b[c]).powi(2) - v[c]).sum::<f64>() / 3.0).collect();
    let n = terms.len() as f64;
    let mean = terms.iter().sum::<f64>() / n;
    let error = (terms.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt() / n.sqrt();
    let noise = found.variance.iter().flatten().sum::<f64>() / (3.0 * n);
    [mean, error, noise * f64::from(spp)]
}

#[test]
fn what_is_between_us_and_mitsuba_vanishes_as_samples_grow() {
    let Some(folder) = crate::data::data("peer-scenes") else { return };
    let mut table = HEAD.to_owned();
    let mut failed = Vec::new();
    for name in ["cornell", "glossyrow"] {
        let reference = Shot::read(&folder.join(name).join("reference.exr"), None);
        for (query, spp) in [("stream", 4), ("single", 8), ("stream", 16), ("stream", 64)] {
            // Another set of numbers for each, lest one be tested twice.
            let spp = samples(spp);
            let settings = format!(
                "integrator = \"path\"\nsampler = \"independent\"\nquery = \"{query}\"\nspp = {spp}\nseed = {spp}"
            );
            let found = Shot::of(&scene_of(&peers::scene_file(&folder, name, &settings, SIZE)));
            let [left, error, sample] = excess(&found, &reference, spp);
            let mut truth = reference.clone();
            // Theirs is not known, ours is about the same.
            for (to, from) in truth.variance.iter_mut().zip(&found.variance) {
                *to = from.map(|v| v * f64::from(spp) / THEIR_SAMPLES);
            }
            // Means of single precision over thousands of samples.
            let verdict = Verdict::of(&found.blocks(8), &truth.blocks(8).doubted(5e-4));
            let remarks = format!(
                "{query}; blocks of 8 by 8; mean square left over {left:.1e} +- {error:.0e}, of which the noise of the reference {:.1e}",
                sample / THEIR_SAMPLES
            );
            table += &row(name, spp, &verdict, &remarks);
            // Where noise is given per pixel by the samples themselves, mean squares are off by four errors once in 16 000.
            let their_noise = sample / THEIR_SAMPLES;
            let is_noise = (left - their_noise).abs() < 4.0 * error + 0.5 * their_noise;
            // Channels share noise, so deviations of the sum are an upper bound: beyond 3.5 once in 2000 pictures.
            let means = verdict.bias.abs() < 3e-3 && verdict.bias_deviations < 3.5;
            // A few samples may miss what is rare, and then tell too little of their noise. Of 3072 numbers, three for a block, one block is
            // beyond by chance once in a hundred pictures; light by way of the smoothest balls is rare enough for two.
            let blocks = spp < 16 || verdict.beyond <= 6;
            if !(is_noise && means && blocks) {
                failed
                    .push(format!("{name}, {spp} samples, {query}: {left} +- {error} is left, {verdict:?}"));
            }
        }
    }
    tell("Peer scenes", &table);
    assert!(failed.is_empty(), "{failed:#?}");
}
