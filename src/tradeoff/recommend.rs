//! Which settings to take for an error that is wanted.

use super::Outcome;
use super::curve::Curve;

/// What reaches an error soonest.
#[derive(Clone, Debug, PartialEq)]
pub struct Recommendation {
    /// The relMSE that is wanted.
    pub target: f64,
    /// What to do; `None` where no settings reach it.
    pub best: Option<Best>,
    /// The least bias, squared, that any settings have: what a target must be above of. `None` where no settings have pictures enough to tell.
    pub least_bias2: Option<f64>,
}

/// Settings, and what they are expected to take and to bring.
#[derive(Clone, Debug, PartialEq)]
pub struct Best {
    /// The settings in words; empty where all is as the scene says.
    pub name: String,
    /// Keys of the scene file and values, samples left out.
    pub set: Vec<(String, String)>,
    /// Samples per pixel.
    pub spp: u32,
    /// Seconds of the processor that tracing takes, at the size of the sweep.
    pub cpu_s: f64,
    /// relMSE.
    pub error: f64,
    /// Whether so many samples are more than four times those measured, or less than a quarter: then it is a guess.
    pub is_far: bool,
}

/// The part of the time of the scene's own settings below which others are worth it: less may be chance, for runs of a point differ by some per cent.
const WORTH: f64 = 0.9;

/// What to take for each of these errors: the scene's own settings, where no others are quicker by more than chance.
#[must_use]
pub fn recommend(outcomes: &[Outcome], targets: &[f64]) -> Vec<Recommendation> {
    let curves = Curve::all(outcomes);
    let least_bias2 = curves.iter().map(|curve| curve.bias2).min_by(f64::total_cmp);
    let of = |&target: &f64| {
        let reached: Vec<Best> = curves.iter().filter_map(|curve| best(curve, target, outcomes)).collect();
        let plain = reached.iter().find(|it| it.set.is_empty());
        let quickest = reached.iter().min_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s));
        let is_worth_it = |it: &&Best| plain.is_none_or(|plain| it.cpu_s < WORTH * plain.cpu_s);
        let best = quickest.filter(is_worth_it).or(plain).cloned();
        Recommendation { target, best, least_bias2 }
    };
    targets.iter().map(of).collect()
}

/// The samples that a picture may have.
pub const MOST: u32 = 1 << 24;

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 1 to the most there may be"
)]
fn best(curve: &Curve, target: f64, outcomes: &[Outcome]) -> Option<Best> {
    let spp = curve.samples_for(target)?.ceil().max(1.0);
    if spp > f64::from(MOST) {
        return None;
    }
    let measured =
        outcomes.iter().filter(|it| it.point.curve() == curve.name).map(|it| f64::from(it.point.spp));
    let [least, most] = measured.fold([f64::INFINITY, 0.0], |[a, b], spp| [a.min(spp), b.max(spp)]);
    Some(Best {
        name: curve.name.clone(),
        set: curve.set.clone(),
        spp: spp as u32,
        cpu_s: curve.time(spp),
        error: curve.error(spp),
        is_far: spp > 4.0 * most || 4.0 * spp < least,
    })
}

#[cfg(test)]
mod tests {
    use super::super::curve::tests::outcome;
    use super::*;

    #[test]
    fn the_quickest_that_reach_it_are_taken() {
        // One is twice as fast and cannot come below 1e-3.
        let outcomes = [
            outcome("", 10, [2.0, 0.0, 1e-2]),
            outcome("", 40, [8.0, 0.0, 2.5e-3]),
            outcome("coarse", 10, [1.0, 1e-3, 1e-2]),
            outcome("coarse", 40, [4.0, 1e-3, 2.5e-3]),
        ];
        let found = recommend(&outcomes, &[1e-2, 1e-3, 1e-9]);
        let best = |i: usize| found[i].best.clone().expect("reached");
        assert_eq!((best(0).name.as_str(), best(0).spp), ("coarse = 1", 12), "{found:?}");
        assert!((best(0).cpu_s - 1.2).abs() < 1e-9 && best(0).error <= 1e-2, "{found:?}");
        assert_eq!((best(1).name.as_str(), best(1).spp, best(1).is_far), ("", 100, false), "{found:?}");
        assert_eq!(found[2].best, None, "beyond the most samples");
        assert!(found[2].least_bias2.is_some_and(|least| least.abs() < 1e-12), "no bias");
        let outcomes = [
            outcome("", 10, [2.0, 0.0, 1e-2]),
            outcome("", 40, [8.0, 0.0, 2.5e-3]),
            outcome("idle", 10, [1.9, 0.0, 1e-2]),
            outcome("idle", 40, [7.6, 0.0, 2.5e-3]),
        ];
        assert_eq!(
            recommend(&outcomes, &[1e-3])[0].best.clone().expect("reached").name,
            "",
            "a twentieth is chance"
        );
        let mut alone = outcome("", 10, [2.0, 0.0, 1e-2]);
        (alone.moments.bias2, alone.moments.variance) = (None, None);
        assert_eq!(recommend(&[alone], &[1e-2])[0].least_bias2, None, "nothing is known");
    }
}
