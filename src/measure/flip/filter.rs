//! The filters of FLIP, as halves of separable kernels.
//!
//! Two kinds: what the eye blurs at a distance (the contrast sensitivity functions, a sum of Gaussians for each opponent
//! channel), and what it takes for edges and points (derivatives of a Gaussian). Andersson et al., 2020, "FLIP", sections
//! 4.1.1 and 4.2.1. All are even or odd, so that one side is enough.

use std::f64::consts::PI;

/// a and b of each Gaussian a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees: table 1 of the paper.
const ACHROMATIC: [f64; 2] = [1.0, 0.0047];
const RED_GREEN: [f64; 2] = [1.0, 0.0053];
const BLUE_YELLOW: [[f64; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];

/// Width of what is taken for an edge or a point, in degrees: section 4.2.1.
const FEATURE_WIDTH_DEG: f64 = 0.082;

/// Weights below this part of the greatest are left out: they could not change a float. The narrow Gaussians thus become
/// half as wide as the radius that the paper gives all of them.
const NEGLIGIBLE: f64 = 1e-9;

/// Weights from the centre outwards: `half[k]` is that of the pixels `k` away.
pub(super) type Half = Vec<f32>;

/// All filters for one viewing distance.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Filters {
    /// Luminance.
    pub(super) achromatic: Half,
    /// Red against green.
    pub(super) red_green: Half,
    /// Blue against yellow: the sum of what these two give.
    pub(super) blue_yellow: [Half; 2],
    /// The Gaussian that the derivatives are of.
    pub(super) smooth: Half,
    /// Its first derivative; odd: one side counts positive, the other negative, and the centre nothing.
    pub(super) edge: Half,
    /// Its second derivative.
    pub(super) point: Half,
}

impl Filters {
    /// The filters for that many pixels in a degree of the visual field.
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let [first, second] = blue_yellow(pixels_per_degree);
        let (smooth, edge, point) = features(pixels_per_degree);
        Self {
            achromatic: trimmed(spread(ACHROMATIC, pixels_per_degree)),
            red_green: trimmed(spread(RED_GREEN, pixels_per_degree)),
            blue_yellow: [trimmed(first), trimmed(second)],
            smooth: single(smooth),
            edge: single(edge),
            point: single(point),
        }
    }

    /// How far the widest of them reaches, in pixels.
    pub(super) fn radius(&self) -> usize {
        let [first, second] = &self.blue_yellow;
        let halves = [&self.achromatic, &self.red_green, first, second, &self.smooth];
        halves.iter().map(|half| half.len() - 1).max().unwrap_or(0)
    }
}

/// Three standard deviations of the widest Gaussian, in pixels.
fn spatial_radius(pixels_per_degree: f64) -> u32 {
    let deviation_deg = (BLUE_YELLOW[0][1] / (2.0 * PI * PI)).sqrt();
    whole(3.0 * deviation_deg * pixels_per_degree)
}

/// exp(-pi^2 x^2 / b) at the pixels.
fn gaussian(b: f64, pixels_per_degree: f64) -> Vec<f64> {
    let radius = spatial_radius(pixels_per_degree);
    let x = |k: u32| f64::from(k) / pixels_per_degree;
    (0..=radius).map(|k| (-PI * PI * x(k) * x(k) / b).exp()).collect()
}

/// One Gaussian of sum 1.
fn spread([_, b]: [f64; 2], pixels_per_degree: f64) -> Vec<f64> {
    let weights = gaussian(b, pixels_per_degree);
    let sum = sum(&weights);
    weights.into_iter().map(|w| w / sum).collect()
}

/// Two Gaussians whose squares (they are applied in x and in y) sum to 1 together.
fn blue_yellow(pixels_per_degree: f64) -> [Vec<f64>; 2] {
    let halves = BLUE_YELLOW.map(|[a, b]| {
        let height = (a * (PI / b).sqrt()).sqrt();
        gaussian(b, pixels_per_degree).into_iter().map(|w| height * w).collect::<Vec<_>>()
    });
    let total = halves.iter().map(|half| sum(half).powi(2)).sum::<f64>().sqrt();
    halves.map(|half| half.into_iter().map(|w| w / total).collect())
}

/// A Gaussian of sum 1 and its derivatives, of which the positive and the negative weights sum to 1 each.
fn features(pixels_per_degree: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let deviation = 0.5 * FEATURE_WIDTH_DEG * pixels_per_degree;
    let distances: Vec<f64> = (0..=whole(3.0 * deviation)).map(f64::from).collect();
    let smooth: Vec<f64> = distances.iter().map(|x| (-0.5 * (x / deviation).powi(2)).exp()).collect();
    let edge: Vec<f64> = distances.iter().zip(&smooth).map(|(x, g)| x * g).collect();
    let point: Vec<f64> =
        distances.iter().zip(&smooth).map(|(x, g)| ((x / deviation).powi(2) - 1.0) * g).collect();
    let rising = sum(&point.iter().map(|w| w.max(0.0)).collect::<Vec<_>>());
    let falling = sum(&point.iter().map(|w| (-w).max(0.0)).collect::<Vec<_>>());
    let (smooth_sum, edge_sum) = (sum(&smooth), edge.iter().sum::<f64>());
    (
        smooth.into_iter().map(|w| w / smooth_sum).collect(),
        edge.into_iter().map(|w| w / edge_sum).collect(),
        point.into_iter().map(|w| w / if w > 0.0 { rising } else { falling }).collect(),
    )
}

/// The sum of both sides of an even kernel.
fn sum(half: &[f64]) -> f64 {
    2.0 * half.iter().sum::<f64>() - half[0]
}

/// Without the negligible weights at its end.
fn trimmed(half: Vec<f64>) -> Half {
    let threshold = half[0] * NEGLIGIBLE;
    let kept = half.iter().rposition(|&w| w >= threshold).unwrap_or(0);
    single(half[..=kept].to_vec())
}

#[expect(clippy::cast_possible_truncation, reason = "weights are in [-1, 1]")]
fn single(half: Vec<f64>) -> Half {
    half.into_iter().map(|w| w as f32).collect()
}

/// Rounded up; radii are far below 2^32.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive; a cast saturates")]
fn whole(x: f64) -> u32 {
    x.ceil() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Viewing distances from absurdly near to absurdly far.
    const DISTANCES: [f64; 5] = [1.0, 10.0, 67.020_64, 120.0, 1000.0];

    fn both_sides(half: &[f32]) -> f64 {
        sum(&half.iter().map(|&w| f64::from(w)).collect::<Vec<_>>())
    }

    #[test]
    fn blurs_keep_a_constant() {
        for ppd in DISTANCES {
            let filters = Filters::new(ppd);
            for half in [&filters.achromatic, &filters.red_green, &filters.smooth] {
                assert!((both_sides(half) - 1.0).abs() < 1e-6, "{ppd}: {}", both_sides(half));
            }
            let [first, second] = &filters.blue_yellow;
            let twice = both_sides(first).powi(2) + both_sides(second).powi(2);
            assert!((twice - 1.0).abs() < 1e-6, "{ppd}: {twice}");
        }
    }

    #[test]
    fn derivatives_ignore_a_constant_and_answer_a_step_with_one() {
        for ppd in DISTANCES {
            let filters = Filters::new(ppd);
            assert!(both_sides(&filters.point).abs() < 1e-6, "{ppd}: {}", both_sides(&filters.point));
            let step: f32 = filters.edge[1..].iter().sum();
            assert!((step - 1.0).abs() < 1e-6 && filters.edge[0].abs() < 1e-9, "{ppd}: {step}");
            let rising: f32 = 2.0 * filters.point.iter().filter(|&&w| w > 0.0).sum::<f32>();
            assert!((rising - 1.0).abs() < 1e-6, "{ppd}: {rising}");
        }
    }

    #[test]
    fn what_is_left_out_would_not_have_been_seen() {
        let filters = Filters::new(67.020_64);
        assert_eq!(filters.radius(), 10, "three deviations of blue against yellow");
        assert!(filters.achromatic.len() < 9, "{} weights", filters.achromatic.len());
        let whole = spread(ACHROMATIC, 67.020_64);
        let lost: f64 = whole[filters.achromatic.len()..].iter().sum();
        assert!(lost < 1e-9, "{lost}");
    }
}
