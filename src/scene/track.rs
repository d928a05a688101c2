//! Where a shape is between its keys, in seconds of scene time and double precision.
//!
//! Two neighbouring keys whose steps are of the same kinds in the same order are joined step by step: factors, angles about
//! one axis and translations linearly, so that an angle may run through any number of turns. A key without steps joins with
//! any. Other keys, and steps that turn about different axes, are joined by polar decomposition: on the shorter arc.

use crate::error::Problem;
use crate::math::Polar;
use crate::scene::description::{Located, PerAxis, ShapeKey, Step};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use std::f64::consts::PI;

/// The map of a moving shape as a function of time, invertible at every moment.
#[derive(Clone, Debug)]
pub(super) struct Track {
    times: Vec<f64>,
    /// From each key to the next; one less than keys.
    ways: Vec<Vec<Way>>,
}

/// How one step, or a whole key, goes from one key to the next.
#[derive(Clone, Debug)]
enum Way {
    Still(DAffine3),
    Scale(DVec3, DVec3),
    /// About an axis, from an angle to another.
    Spin(DVec3, f64, f64),
    Translate(DVec3, DVec3),
    Shorter(Box<[Polar; 2]>),
}

/// What is wrong between two keys, and what to do about it.
pub(super) type Fault = (&'static str, &'static str);

/// Said of a list of keys that has one.
pub(super) const ONE: Fault = ("`keys` has one entry only", "give two or more; what stands still needs none");
const FIT: Fault =
    ("`fit` cannot be in a key", "put it into the shape's own `transform`, which comes before the keys");
const SIGN: Fault = (
    "a factor of `scale` has another sign than at the key before, and the shape would be flat in between",
    "give both the same sign; mirror by the shape's own `transform`",
);
const MIRRORED: Fault = (
    "this key and the one before mirror the shape differently, and it would be flat in between",
    "mirror by the shape's own `transform`",
);
const HALF_TURN: Fault = (
    "this key is half a turn from the one before, and which way round is not said",
    "add a key in between, or turn both by `rotate_deg` about the same axis",
);
const FLAT: Fault = ("the steps of this key flatten the shape", "use factors other than zero");

/// The least angle that turns may lack of half a turn: less, and rounding chooses the way round.
const UNDECIDED: f64 = 1e-4;

/// Sine of the greatest angle between axes that count as one.
const SAME_AXIS: f64 = 1e-6;

impl Track {
    /// The track through two or more keys in the order of time; else, or where the way to a key is flat, what is wrong.
    pub(super) fn new(keys: &[Located<ShapeKey>]) -> Result<Self, Problem> {
        if let [only] = keys {
            return Err(Problem::at(only.place.clone(), ONE.0).remedy(ONE.1));
        }
        let ways = keys.windows(2).map(|pair| {
            let problem = |(what, remedy)| Problem::at(pair[1].place.clone(), what).remedy(remedy);
            ways(&pair[0], &pair[1]).map_err(problem)
        });
        let ways = ways.collect::<Result<_, _>>()?;
        Ok(Self { times: keys.iter().map(|key| key.time_s).collect(), ways })
    }

    /// The map at a moment in seconds: before the first key and after the last that of the nearer one.
    pub(super) fn at(&self, time_s: f64) -> DAffine3 {
        let next = self.times.partition_point(|&key| key <= time_s);
        let first = next.saturating_sub(1).min(self.ways.len().saturating_sub(1));
        let (from, to) = (self.times[first], self.times[first + 1]);
        let part = ((time_s - from) / (to - from)).clamp(0.0, 1.0);
        self.ways[first].iter().fold(DAffine3::IDENTITY, |so_far, way| way.at(part) * so_far)
    }

    /// The moments of the keys, in seconds.
    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    /// A bound on the angle in radians through which the shape turns from one moment to another.
    pub(super) fn turn(&self, from_s: f64, to_s: f64) -> f64 {
        let turned = |(times, ways): (&[f64], &Vec<Way>)| {
            let shared = (to_s.min(times[1]) - from_s.max(times[0])).max(0.0) / (times[1] - times[0]);
            shared * ways.iter().map(Way::turn).sum::<f64>()
        };
        self.times.windows(2).zip(&self.ways).map(turned).sum()
    }
}

/// What is wrong between a key and the next. What is wrong with a step by itself is no matter here.
pub(super) fn fault(from: &ShapeKey, to: &ShapeKey) -> Option<Fault> {
    ways(from, to).err().filter(|fault| *fault != FLAT)
}

/// What is wrong with a key by itself.
pub(super) fn fault_of_one(key: &ShapeKey) -> Option<Fault> {
    key.transform.iter().any(|step| matches!(step.value, Step::Fit { .. })).then_some(FIT)
}

fn ways(from: &ShapeKey, to: &ShapeKey) -> Result<Vec<Way>, Fault> {
    let [a, b] = [from, to].map(|key| key.transform.iter().map(|step| &step.value).collect::<Vec<_>>());
    let is_alike = |(a, b): (&&Step, &&Step)| std::mem::discriminant(*a) == std::mem::discriminant(*b);
    if a.is_empty() || b.is_empty() {
        return a
            .iter()
            .map(|step| way(step, &none(step)))
            .chain(b.iter().map(|step| way(&none(step), step)))
            .collect();
    }
    if a.len() == b.len() && a.iter().zip(&b).all(is_alike) {
        return a.iter().zip(&b).map(|(a, b)| way(a, b)).collect();
    }
    let whole = |steps: &[&Step]| -> Result<DAffine3, Fault> {
        steps.iter().try_fold(DAffine3::IDENTITY, |so_far, step| Ok(map(step)? * so_far))
    };
    Ok(vec![shorter(&whole(&a)?, &whole(&b)?)?])
}

/// The step of the same kind that does nothing.
fn none(step: &Step) -> Step {
    match step {
        Step::Scale { .. } => Step::Scale { scale: PerAxis(DVec3::ONE) },
        Step::Rotate { axis, .. } => Step::Rotate { rotate_deg: 0.0, axis: *axis },
        Step::Translate { .. } => Step::Translate { translate: DVec3::ZERO },
        Step::Matrix { .. } => Step::Matrix { matrix: DMat4::IDENTITY.to_cols_array() },
        Step::Fit { fit } => Step::Fit { fit: *fit },
    }
}

fn map(step: &Step) -> Result<DAffine3, Fault> {
    map_of(step).ok_or(FIT)
}

/// The map of a step; none of one that depends on what it carries.
pub(super) fn map_of(step: &Step) -> Option<DAffine3> {
    Some(match step {
        Step::Scale { scale } => DAffine3::from_scale(scale.0),
        Step::Rotate { rotate_deg, axis } => {
            DAffine3::from_axis_angle(axis.normalize(), rotate_deg.to_radians())
        }
        Step::Translate { translate } => DAffine3::from_translation(*translate),
        Step::Matrix { matrix } => DAffine3::from_mat4(DMat4::from_cols_array(matrix).transpose()),
        Step::Fit { .. } => return None,
    })
}

/// The way of a step to another of its kind.
fn way(a: &Step, b: &Step) -> Result<Way, Fault> {
    let (map_a, map_b) = (map(a)?, map(b)?);
    if a == b {
        return Ok(Way::Still(map_a));
    }
    match (a, b) {
        (Step::Scale { scale: a }, Step::Scale { scale: b }) => {
            let (a, b) = (a.0, b.0);
            if (a * b).cmplt(DVec3::ZERO).any() { Err(SIGN) } else { Ok(Way::Scale(a, b)) }
        }
        (Step::Translate { translate: a }, Step::Translate { translate: b }) => Ok(Way::Translate(*a, *b)),
        (Step::Rotate { rotate_deg: a, axis: u }, Step::Rotate { rotate_deg: b, axis: v }) => {
            let [a, b] = [a, b].map(|degrees| degrees.to_radians());
            let [u, v] = [u, v].map(|axis| axis.normalize());
            // A turn by nothing has no axis.
            let u = if a == 0.0 { v } else { u };
            let v = if b == 0.0 { u } else { v };
            if u.cross(v).length() > SAME_AXIS {
                return shorter(&map_a, &map_b);
            }
            Ok(Way::Spin(u, a, b * u.dot(v).signum()))
        }
        _ => shorter(&map_a, &map_b),
    }
}

fn shorter(a: &DAffine3, b: &DAffine3) -> Result<Way, Fault> {
    let [a, b] = [a, b].map(|map| Polar::new(map).ok_or(FLAT));
    let (a, b) = (a?, b?);
    if a.is_mirrored() != b.is_mirrored() {
        return Err(MIRRORED);
    }
    if PI - a.angle(&b) < UNDECIDED { Err(HALF_TURN) } else { Ok(Way::Shorter(Box::new([a, b]))) }
}

impl Way {
    fn at(&self, part: f64) -> DAffine3 {
        match self {
            Self::Still(map) => *map,
            Self::Scale(a, b) => DAffine3::from_scale(a + (b - a) * part),
            Self::Spin(axis, a, b) => DAffine3::from_quat(DQuat::from_axis_angle(*axis, a + (b - a) * part)),
            Self::Translate(a, b) => DAffine3::from_translation(a + (b - a) * part),
            Self::Shorter(ends) => ends[0].between(&ends[1], part),
        }
    }

    fn turn(&self) -> f64 {
        match self {
            Self::Spin(_, a, b) => (b - a).abs(),
            Self::Shorter(ends) => ends[0].angle(&ends[1]),
            Self::Still(_) | Self::Scale(..) | Self::Translate(..) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;

    fn located<T>(value: T) -> Located<T> {
        Located { value, place: Place::file("a.toml") }
    }

    fn track(keys: &[(f64, &[Step])]) -> Result<Track, Problem> {
        let key = |&(time_s, steps): &(f64, &[Step])| {
            located(ShapeKey { time_s, transform: steps.iter().cloned().map(located).collect() })
        };
        Track::new(&keys.iter().map(key).collect::<Vec<_>>())
    }

    fn turn(rotate_deg: f64, axis: DVec3) -> Step {
        Step::Rotate { rotate_deg, axis }
    }

    fn x_at(track: &Track, time_s: f64) -> DVec3 {
        track.at(time_s).transform_point3(DVec3::X)
    }

    #[test]
    fn two_keys_turn_a_shape_right_round() {
        let z = |angle| turn(angle, DVec3::Z);
        let track = track(&[(1.0, &[z(0.0)]), (3.0, &[z(720.0)])]).expect("a track");
        for i in 0..=64 {
            let part = f64::from(i) / 64.0;
            let (sin, cos) = (part * 2.0 * 2.0 * PI).sin_cos();
            let found = x_at(&track, 1.0 + 2.0 * part);
            assert!(found.abs_diff_eq(DVec3::new(cos, sin, 0.0), 1e-12), "{found} at {part}");
        }
        assert!((track.turn(1.0, 3.0) - 4.0 * PI).abs() < 1e-12, "two turns in all");
        assert!((track.turn(-5.0, 1.5) - PI).abs() < 1e-12, "half a turn in the first quarter");
    }

    #[test]
    fn the_nearest_key_holds_outside() {
        let at = |x| Step::Translate { translate: DVec3::X * x };
        let track = track(&[(0.0, &[at(1.0)]), (1.0, &[at(3.0)]), (2.0, &[at(-1.0)])]).expect("a track");
        for (time_s, x) in
            [(-1.0, 1.0), (0.0, 1.0), (0.5, 2.0), (1.0, 3.0), (1.25, 2.0), (2.0, -1.0), (9.0, -1.0)]
        {
            assert_eq!(track.at(time_s).translation, DVec3::X * x, "at {time_s}");
        }
    }

    #[test]
    fn a_key_without_steps_joins_with_any() {
        let steps = [Step::Scale { scale: PerAxis(DVec3::splat(3.0)) }, turn(360.0, DVec3::Z)];
        for (keys, part) in [([(0.0, &steps[..]), (1.0, &[])], 0.75), ([(0.0, &[]), (1.0, &steps[..])], 0.25)]
        {
            let found = x_at(&track(&keys).expect("a track"), part);
            assert!(found.abs_diff_eq(DVec3::Y * 1.5, 1e-6), "a quarter of the way: {found}");
        }
    }

    #[test]
    fn other_axes_and_other_steps_go_the_shorter_way() {
        let steps: [(&[Step], &[Step]); 3] = [
            (&[turn(20.0, DVec3::Z)], &[turn(-440.0, -DVec3::Z + DVec3::X * 1e-4)]),
            (&[turn(20.0, DVec3::Z)], &[turn(30.0, DVec3::Z), turn(50.0, DVec3::Z)]),
            (&[turn(20.0, DVec3::Z)], &[Step::Matrix { matrix: matrix_of_80() }]),
        ];
        for (a, b) in steps {
            let track = track(&[(0.0, a), (1.0, b)]).expect("a track");
            let (sin, cos) = (50.0_f64).to_radians().sin_cos();
            let found = x_at(&track, 0.5);
            assert!(found.abs_diff_eq(DVec3::new(cos, sin, 0.0), 1e-3), "{a:?} to {b:?}: {found}");
            for (time_s, steps) in [(0.0, a), (1.0, b)] {
                let whole = steps.iter().fold(DAffine3::IDENTITY, |m, step| map(step).expect("a map") * m);
                assert!(track.at(time_s).abs_diff_eq(whole, 1e-6), "{steps:?} at its key");
            }
        }
    }

    fn matrix_of_80() -> [f64; 16] {
        DMat4::from_rotation_z(80.0_f64.to_radians()).transpose().to_cols_array()
    }

    #[test]
    fn an_axis_turned_over_turns_backwards() {
        let track =
            track(&[(0.0, &[turn(90.0, DVec3::Z)]), (1.0, &[turn(90.0, -DVec3::Z)])]).expect("a track");
        assert!(x_at(&track, 0.5).abs_diff_eq(DVec3::X, 1e-12), "by way of nothing");
    }

    #[test]
    fn what_would_be_flat_on_the_way_is_refused() {
        let scale = |x: f64| Step::Scale { scale: PerAxis(DVec3::new(x, 1.0, 1.0)) };
        let fit = Step::Fit { fit: 1.0 };
        let both = [scale(-1.0), turn(1.0, DVec3::X)];
        let halves = [turn(180.0, DVec3::X), turn(0.0, DVec3::Y)];
        let cases: [(&[Step], &[Step], Fault); 5] = [
            (&[scale(1.0)], &[scale(-1.0)], SIGN),
            (&[scale(1.0)], &both, MIRRORED),
            (&[turn(0.0, DVec3::Z)], &halves, HALF_TURN),
            (std::slice::from_ref(&fit), std::slice::from_ref(&fit), FIT),
            (&[scale(1.0)], &[scale(0.0), scale(1.0)], FLAT),
        ];
        for (a, b, (what, remedy)) in cases {
            let found = track(&[(0.0, a), (1.0, b)]).expect_err("a fault").to_string();
            assert_eq!(found, format!("a.toml: {what}; {remedy}"), "{a:?} to {b:?}");
        }
    }
}
