//! The arguments: extremes for the grids, and random numbers between them.

use super::random::Random;

/// One argument, or the components of one vector.
pub(crate) struct Axis {
    pub(crate) extremes: Vec<Vec<f32>>,
    pub(crate) random: fn(&mut Random) -> Vec<f32>,
}

/// An axis of these numbers, and random ones.
pub(crate) fn of(values: &[f32], random: fn(&mut Random) -> Vec<f32>) -> Axis {
    scalars(values, random)
}

fn scalars(values: &[f32], random: fn(&mut Random) -> Vec<f32>) -> Axis {
    Axis { extremes: values.iter().map(|x| vec![*x]).collect(), random }
}

/// The greatest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

const COSINES: [f32; 18] = [
    0.0, 1e-45, 1e-40, 1.2e-38, 1e-30, 1e-20, 1e-10, 1e-7, 1e-5, 1e-3, 0.1, 0.5, 0.7, 0.9, 0.999, 0.99999,
    BELOW_ONE, 1.0,
];

fn any_cosine(random: &mut Random) -> f32 {
    let [which, u, v] = random.triple();
    match (which * 3.0) as u32 {
        0 => u,
        1 => 1e-45 * 1e45_f64.powf(f64::from(u)) as f32 + 1e-44 * v,
        _ => 1.0 - 1e-8 * 1e8_f32.powf(u),
    }
}

/// Cosines from 0 by way of the denormals to 1.
pub(crate) fn cosine() -> Axis {
    scalars(&COSINES, |random| vec![any_cosine(random).min(1.0)])
}

/// Ratios of indices, near 1 among them.
pub(crate) fn eta() -> Axis {
    let near = [1e-7_f32, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2];
    let mut values = vec![1e-3, 0.1, 0.5, 0.667, 1.0, 1.33, 1.5, 2.4, 10.0, 1e3];
    values.extend(near.iter().flat_map(|d| [1.0 - d, 1.0 + d]));
    scalars(&values, |random| {
        let [which, u, _] = random.triple();
        let near = 1e-7 * 1e6_f32.powf(u);
        vec![if which < 0.25 {
            1.0 + near
        } else if which < 0.5 {
            1.0 - near
        } else {
            random.logarithmic(1e-3, 1e3)
        }]
    })
}

/// Indices of coats.
pub(crate) fn coat() -> Axis {
    scalars(&[1.0, 1.0000001, 1.001, 1.5, 2.4, 10.0], |random| vec![random.logarithmic(1.0, 10.0)])
}

/// Extinctions.
pub(crate) fn extinction() -> Axis {
    scalars(&[0.0, 1e-6, 1e-3, 0.1, 1.0, 3.0, 100.0, 1e4, 1e6], |random| vec![random.logarithmic(1e-7, 1e6)])
}

/// Extinctions of mirrors.
pub(crate) fn mirroring() -> Axis {
    scalars(&[1.0, 3.0, 100.0, 1e4, 1e6], |random| vec![random.logarithmic(1.0, 1e6)])
}

/// Phong's exponents.
pub(crate) fn exponent() -> Axis {
    scalars(&[0.0, 1e-3, 1.0, 10.0, 1e3, 1e6, 1e8, 1e9], |random| vec![random.logarithmic(1e-3, 1e9)])
}

/// Roughnesses.
pub(crate) fn alpha() -> Axis {
    scalars(&[1e-6, 1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0], |random| vec![random.logarithmic(1e-6, 1.0)])
}

/// Few roughnesses, for grids of many axes.
pub(crate) fn few_alpha() -> Axis {
    scalars(&[1e-6, 1e-3, 0.1, 1.0], |random| vec![random.logarithmic(1e-6, 1.0)])
}

/// Few ratios of indices, for grids of many axes.
pub(crate) fn few_eta() -> Axis {
    Axis {
        extremes: [1e-3, 0.667, 1.0 - 1e-7, 1.0, 1.0 + 1e-7, 1.02, 1.5, 1e3].map(|e| vec![e]).to_vec(),
        ..eta()
    }
}

/// Phong's exponents where a lobe's part below the surface has a sum of finitely many terms, or Gauss's limit.
pub(crate) fn whole_exponent() -> Axis {
    scalars(&[0.0, 1.0, 2.0, 7.0, 100.0, 301.0, 1e7, 1e9], |random| vec![(random.unit() * 300.0).floor()])
}

/// Numbers in [0, 1), both ends.
pub(crate) fn number() -> Axis {
    let values = [0.0, 6e-8, 1e-4, 0.125, 0.3, 0.5, 0.75, 0.9999, BELOW_ONE];
    // Samplers give multiples of 2^-24.
    let values = values.map(|x| (x * 16_777_216.0).round() / 16_777_216.0);
    scalars(&values, |random| vec![random.unit()])
}

/// Fractions of power.
pub(crate) fn fraction() -> Axis {
    scalars(&[0.0, 1e-6, 0.04, 0.5, BELOW_ONE, 1.0], |random| vec![random.unit()])
}

/// Squared sines and twice them: from narrow to wide cones.
pub(crate) fn cone() -> Axis {
    let values = [1e-30, 1e-20, 1e-12, 1e-7, 1e-3, 0.5, BELOW_ONE, 1.0];
    scalars(&values, |random| vec![random.logarithmic(1e-30, 1.0)])
}

/// Lengths.
pub(crate) fn scale() -> Axis {
    scalars(&[1e-6, 1e-3, 1.0, 1e3, 1e6], |random| vec![random.logarithmic(1e-6, 1e6)])
}

fn direction_of(cos: f32, turns: f32) -> Vec<f32> {
    let (cos, angle) = (f64::from(cos), f64::from(turns) * std::f64::consts::TAU);
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    vec![(sin * angle.cos()) as f32, (sin * angle.sin()) as f32, cos as f32]
}

/// Directions above the surface, from grazing to upright, rounded to floats.
pub(crate) fn above() -> Axis {
    let turns = [0.0, 0.11, 0.4, 0.75];
    let all = COSINES.iter().flat_map(|cos| turns.map(|turn| direction_of(*cos, turn)));
    Axis {
        extremes: all.collect(),
        random: |random| direction_of(any_cosine(random).min(1.0), random.unit()),
    }
}

/// Few directions above the surface, for grids of many axes.
pub(crate) fn few_above() -> Axis {
    let cosines = [1e-40, 1e-7, 1e-3, 0.5, 0.9, BELOW_ONE, 1.0];
    let all = cosines.iter().flat_map(|cos| [0.11, 0.61].map(|turn| direction_of(*cos, turn)));
    Axis { extremes: all.collect(), ..above() }
}

/// The same below the surface.
pub(crate) fn few_below() -> Axis {
    let turned = |d: Vec<f32>| vec![d[0], d[1], -d[2]];
    Axis {
        extremes: few_above().extremes.into_iter().map(turned).collect(),
        random: |random| {
            let d = direction_of(any_cosine(random).min(1.0), random.unit());
            vec![d[0], d[1], -d[2]]
        },
    }
}

/// Directions of all the sphere, the poles among them.
pub(crate) fn around() -> Axis {
    let up = above().extremes;
    let down = up.iter().map(|d| vec![d[0], d[1], -d[2]]).collect::<Vec<_>>();
    Axis {
        extremes: up.into_iter().chain(down).collect(),
        random: |random| {
            let mut d = direction_of(any_cosine(random).min(1.0), random.unit());
            d[2] = if random.unit() < 0.5 { -d[2] } else { d[2] };
            d
        },
    }
}

/// Points up to a million away.
pub(crate) fn place() -> Axis {
    let values =
        [[0.0, 0.0, 0.0], [1e-6, -1e-6, 1e-6], [0.3, -0.7, 0.9], [1e3, 1.0, -2.5], [-1e6, 1e-3, 3e5]];
    Axis {
        extremes: values.iter().map(|p| p.to_vec()).collect(),
        random: |random| {
            let size = random.logarithmic(1e-6, 1e6);
            random.triple().map(|x| (x * 2.0 - 1.0) * size).to_vec()
        },
    }
}

/// A direction near another: offsets of the size of a narrow lobe, to be added to it.
pub(crate) fn nearby() -> Axis {
    let mut all = vec![vec![0.0, 0.0, 0.0]];
    for size in [1e-7_f32, 1e-5, 1e-3, 0.1, 1.0] {
        all.extend([vec![size, 0.0, 0.0], vec![-0.3 * size, 0.6 * size, 0.2 * size]]);
    }
    Axis {
        extremes: all,
        random: |random| {
            let size = random.logarithmic(1e-8, 1.0);
            random.triple().map(|x| (x * 2.0 - 1.0) * size).to_vec()
        },
    }
}
