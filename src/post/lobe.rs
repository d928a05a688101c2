//! The lobe whose weights the filter takes.
//!
//! Everything is told by t = 1 - cos J, half the square of the chord between two unit vectors, which keeps its digits where
//! the cosine is near 1. The lobe is that about the mirror direction, without a cosine at the surface: density
//! (p + 1) / (2 pi) cos^p J, of which cos(Q)^(p + 1) lies outside of the cone of half angle Q.

/// Entries of a table of the lobe, but one.
const STEPS: usize = 512;

/// Least exponent from which a table is not worth having: its lobe is below half a pixel anywhere.
const SHARPEST: f32 = 1e9;

/// The part of the lobe that lies outside of the cone that a roughness names.
const LOST_BY_NAME: f64 = 0.01;

/// The half angle of the cone of roughness 1: where the method's authors take their lobes to end.
const WIDEST_DEG: f64 = 10.0;

/// A lobe that ends at a cone.
#[derive(Clone, Debug, PartialEq)]
pub struct Lobe {
    /// Exponent of the cosine.
    pub exponent: f32,
    /// 1 - cos Q of the half angle Q of the cone.
    pub t_max: f32,
    /// The half angle Q, in radians.
    angle: f32,
    /// cos^p at equal steps of t from 0 to `t_max`, and one entry more; empty if it is to be computed.
    pub(super) table: Vec<f32>,
}

impl Lobe {
    /// The lobe of an exponent from 0 on, that ends where the part `lost` of it is outside, in (0, 1), or at the half angle `max_angle` in radians.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "numbers for kernels of single precision")]
    pub fn new(exponent: f32, lost: f32, max_angle: f32) -> Self {
        let exponent = exponent.clamp(0.0, SHARPEST);
        let t = -(f64::from(lost).ln() / (f64::from(exponent) + 1.0)).exp_m1();
        let cap = 2.0 * (f64::from(max_angle) * 0.5).sin().powi(2);
        // A right angle has no weight, and beyond it there is no lobe.
        let t_max = t.min(cap).min(1.0 - 1e-6) as f32;
        let angle = 2.0 * (0.5 * t_max).sqrt().asin();
        Self { exponent, t_max, angle, table: Vec::new() }
    }

    /// The same with a table of its weights, from which they are interpolated: off by (p dt)^2 / 8 at most, dt being 1/512 of the range.
    #[must_use]
    pub fn tabulated(mut self) -> Self {
        let entry = |i: usize| self.weight(self.t_max * (i as f32) / (STEPS as f32));
        self.table = (0..STEPS + 2).map(entry).collect();
        self
    }

    /// cos^p at t = 1 - cos J.
    #[must_use]
    pub fn weight(&self, t: f32) -> f32 {
        (self.exponent * (-t).ln_1p()).exp()
    }

    /// Half angle of the cone in radians.
    #[must_use]
    pub fn angle(&self) -> f32 {
        self.angle
    }

    /// Entries of the table for a unit of t.
    pub(super) fn steps_per_t(&self) -> f32 {
        STEPS as f32 / self.t_max.max(1e-30)
    }

    /// The square of the chord between normals beyond which two pixels are taken for different faces: angles of 2 Q.
    pub(super) fn normals_apart(&self) -> f32 {
        let cos = 1.0 - self.t_max;
        if cos <= std::f32::consts::FRAC_1_SQRT_2 {
            return 4.0;
        }
        (4.0 * self.t_max * (2.0 - self.t_max)).max(1e-9)
    }
}

/// The exponent of a lobe of that roughness in [0, 1]: the cone that all but a hundredth of it lies in has a half angle of 10 degrees times
/// the roughness. 0 is a mirror, told by the exponent 1e9.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "an exponent needs no more digits")]
pub fn exponent_of_roughness(roughness: f32) -> f32 {
    let angle = (WIDEST_DEG * f64::from(roughness)).to_radians();
    // ln cos angle, without cancellation.
    let ln_cos = (-2.0 * (0.5 * angle).sin().powi(2)).ln_1p();
    if ln_cos > -1e-12 {
        return SHARPEST;
    }
    ((LOST_BY_NAME.ln() / ln_cos - 1.0) as f32).clamp(0.0, SHARPEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cones_hold_all_but_the_part_that_is_given_away() {
        // Exponent, and half angles in degrees for a tenth, a hundredth and a thousandth outside: from the closed form, by hand.
        let table = [
            (50.0, [17.1, 24.0, 29.2]),
            (100.0, [12.2, 17.2, 21.0]),
            (200.0, [8.66, 12.2, 14.9]),
            (500.0, [5.49, 7.76, 9.49]),
            (1000.0, [3.89, 5.49, 6.72]),
            (5000.0, [1.74, 2.46, 3.01]),
            (1e4, [1.23, 1.74, 2.13]),
        ];
        for (exponent, angles) in table {
            for (lost, angle) in [0.1, 0.01, 0.001].into_iter().zip(angles) {
                let found = Lobe::new(exponent, lost, 3.0).angle().to_degrees();
                assert!((found - angle).abs() < 0.006 * angle, "{exponent} {lost}: {found}, not {angle}");
            }
        }
        let capped = Lobe::new(50.0, 0.01, 10_f32.to_radians()).angle().to_degrees();
        assert!((capped - 10.0).abs() < 1e-4, "{capped}");
    }

    #[test]
    fn ten_degrees_cut_off_what_they_do() {
        // Exponent, and the part of the lobe beyond ten degrees: from the closed form, by hand.
        for (exponent, lost, half_a_digit) in
            [(50.0, 0.46, 5e-3), (100.0, 0.21, 5e-3), (200.0, 0.046, 5e-4), (500.0, 5e-4, 5e-5)]
        {
            let lobe = Lobe::new(exponent, 1e-6, 10_f32.to_radians());
            // cos^(p + 1) at the cone, and one less the integral over it of (p + 1) cos^p dt, by the midpoint rule.
            let beyond = (1.0 - lobe.t_max) * lobe.weight(lobe.t_max);
            let dt = lobe.t_max / 2000.0;
            let within: f32 = (0..2000_u16).map(|i| lobe.weight((f32::from(i) + 0.5) * dt)).sum();
            let rest = 1.0 - (exponent + 1.0) * within * dt;
            assert!((beyond - lost).abs() < half_a_digit, "{exponent}: {beyond}, not {lost}");
            assert!((beyond - rest).abs() < 2e-5, "{exponent}: {beyond} beyond, and {rest} not within");
        }
    }

    #[test]
    fn a_table_is_as_close_as_it_says() {
        for exponent in [0.0, 1.0, 20.0, 300.0, 1e4, 1e6] {
            let lobe = Lobe::new(exponent, 1e-3, 3.0).tabulated();
            let dt = lobe.t_max / STEPS as f32;
            let bound = (exponent * dt).powi(2) / 8.0 + 1e-6;
            for i in 0..5000_u16 {
                let t = lobe.t_max * f32::from(i) / 5000.0;
                let at = t * lobe.steps_per_t();
                let (k, part) = (at.floor(), at.fract());
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
                let k = k as usize;
                let between = lobe.table[k] + part * (lobe.table[k + 1] - lobe.table[k]);
                // cos^p is not flatter than its exponential, and curves a little more near a right angle.
                let error = (between - lobe.weight(t)).abs();
                assert!(error < 1.5 * bound, "{exponent} at {t}: {error} of {bound}");
            }
        }
    }

    #[test]
    fn roughness_names_the_cone() {
        for (roughness, angle) in [(1.0, 10.0), (0.5, 5.0), (0.01, 0.1)] {
            let exponent = exponent_of_roughness(roughness);
            let found = Lobe::new(exponent, 0.01, 3.0).angle().to_degrees();
            assert!((found / angle - 1.0).abs() < 1e-3, "{roughness}: {found}");
        }
        assert!(exponent_of_roughness(0.0) >= 1e9, "a mirror");
    }
}
