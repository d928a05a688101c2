//! Settings for those who do not want to choose: by what was measured over scenes that ship.
//!
//! A preset is an error that is good enough. Which settings reach it soonest is taken from `presets.json`, curves of settings of scenes
//! (`benches/presets.rs` measures them, `benches/record/presets.md` tells of which): of settings that every scene there of the integrator's kind was
//! measured with, and whose bias is small beside the error to the end of its interval, the ones that take the least part of the time that the scene's own
//! settings take, in the geometric mean, if that is less than clocks are off by. Where there are none, those of the scene stay. How many samples that
//! is in a scene, a [`super::pilot::Pilot`] finds.

use super::curve::Curve;
use super::student::Interval;
use crate::scene::description::Integrator;
use serde_json::Value;
use std::sync::OnceLock;

/// How good a picture is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// To see whether everything is there.
    Draft,
    /// To judge light and materials.
    Preview,
    /// To show.
    Final,
    /// To compare others with.
    Reference,
}

impl Preset {
    /// All of them, the coarsest first.
    pub const ALL: [Self; 4] = [Self::Draft, Self::Preview, Self::Final, Self::Reference];

    /// The word for it.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Preview => "preview",
            Self::Final => "final",
            Self::Reference => "reference",
        }
    }

    /// The preset of that word.
    #[must_use]
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.word() == word)
    }

    /// The relMSE that is good enough.
    #[must_use]
    pub const fn target(self) -> f64 {
        match self {
            Self::Draft => 3e-2,
            Self::Preview => 1e-2,
            Self::Final => 1e-3,
            Self::Reference => 1e-4,
        }
    }
}

/// How light is followed, as far as settings for one are no settings for another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// By ray trees.
    Tree,
    /// By paths.
    Path,
}

impl Kind {
    /// The kind of an integrator; `None` of those that follow no light.
    #[must_use]
    pub const fn of(integrator: Integrator) -> Option<Self> {
        match integrator {
            Integrator::Whitted | Integrator::Distribution => Some(Self::Tree),
            Integrator::Path => Some(Self::Path),
            Integrator::View => None,
        }
    }

    /// The word for it, as the record has it.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Tree => "tree",
            Self::Path => "path",
        }
    }
}

/// Settings that were found to be best, and what was found of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Advice {
    /// Keys of the scene file and values, samples left out.
    pub set: Vec<(String, String)>,
    /// The part of the time that scenes take as they are, in the geometric mean.
    pub gain: f64,
    /// With which power of samples variance falls, in the mean.
    pub slope: f64,
    /// Squared bias in relMSE, in the mean.
    pub bias2: f64,
    /// Over how many scenes.
    pub scenes: usize,
}

/// Whether settings, keys of the scene file and values, come into question.
pub type Fits<'a> = dyn Fn(&[(String, String)]) -> bool + 'a;

/// The part of the wanted error that bias may be, to the end of its interval.
const BIAS: f64 = 0.25;

/// The part of the time below which settings are worth it: pictures that are the same bit for bit differ by up to 0.15 in the record.
const WORTH: f64 = 0.8;

/// Scenes, each with curves of settings.
#[derive(Clone, Debug, Default)]
struct Record(Vec<(Kind, Vec<Curve>)>);

/// What was measured.
fn record() -> &'static Record {
    static RECORD: OnceLock<Record> = OnceLock::new();
    RECORD.get_or_init(|| {
        let json = serde_json::from_str(include_str!("presets.json")).unwrap_or_default();
        Record::of_json(&json).unwrap_or_default()
    })
}

impl Record {
    fn of_json(json: &Value) -> Option<Self> {
        let scene = |json: &Value| {
            let kind = [Kind::Tree, Kind::Path].into_iter().find(|kind| json["kind"] == kind.word())?;
            let curves: Option<Vec<Curve>> = json["curves"].as_array()?.iter().map(curve_of_json).collect();
            Some((kind, curves?))
        };
        json["scenes"].as_array()?.iter().map(scene).collect::<Option<Vec<_>>>().map(Self)
    }

    fn advice(&self, kind: Kind, target: f64, fits: &Fits<'_>) -> Option<Advice> {
        let scenes: Vec<&Vec<Curve>> =
            self.0.iter().filter(|(of, _)| *of == kind).map(|(_, all)| all).collect();
        let sets = scenes.first()?.iter().map(|curve| &curve.set).filter(|set| fits(set));
        let all = sets.filter_map(|set| advice_of(set, target, &scenes));
        let all = all.filter(|it| it.set.is_empty() || it.gain < WORTH);
        all.min_by(|a, b| a.gain.total_cmp(&b.gain))
    }
}

/// What scenes say of settings; `None` where one was not measured with them, does not reach the target, or does not know their bias well enough.
#[expect(clippy::cast_precision_loss, reason = "few scenes")]
fn advice_of(set: &[(String, String)], target: f64, scenes: &[&Vec<Curve>]) -> Option<Advice> {
    let (mut logarithms, mut slopes, mut bias2) = (0.0, 0.0, 0.0);
    for curves in scenes {
        let plain = curves.iter().find(|curve| curve.set.is_empty())?;
        let own = curves.iter().find(|curve| curve.set == set)?;
        if !set.is_empty() && own.most_bias2().is_none_or(|most| most > BIAS * target) {
            return None;
        }
        let time = |curve: &Curve| curve.samples_for(target).map(|spp| curve.time(spp));
        // Where the scene as it is has a bias of its own, both are as far from the target.
        if let (Some(plain), Some(own)) = (time(plain), time(own)) {
            logarithms += (own / plain).ln();
        } else if !set.is_empty() {
            return None;
        }
        slopes += own.slope();
        bias2 += own.bias2;
    }
    let count = scenes.len() as f64;
    Some(Advice {
        set: set.to_vec(),
        gain: (logarithms / count).exp(),
        slope: slopes / count,
        bias2: bias2 / count,
        scenes: scenes.len(),
    })
}

/// The settings to take for an error, of those that fit; none of a kind that was not measured.
#[must_use]
pub fn advice(kind: Kind, target: f64, fits: &Fits<'_>) -> Option<Advice> {
    record().advice(kind, target, fits)
}

/// A curve as the record has it.
#[must_use]
pub fn curve_to_json(curve: &Curve) -> Value {
    let set: serde_json::Map<String, Value> =
        curve.set.iter().map(|(key, value)| (key.clone(), value.clone().into())).collect();
    serde_json::json!({
        "set": set,
        "bias2": curve.found_bias2.value,
        "bias2_half": curve.found_bias2.half,
        "fixed_s": curve.fixed_s,
        "pace_s": curve.pace_s,
        "noise": curve.noise(),
    })
}

fn curve_of_json(json: &Value) -> Option<Curve> {
    let set = json["set"].as_object()?.iter();
    let set: Option<Vec<_>> =
        set.map(|(key, value)| Some((key.clone(), value.as_str()?.to_owned()))).collect();
    let noise = json["noise"].as_array()?.iter().map(|at| Some([at[0].as_f64()?, at[1].as_f64()?]));
    let noise: Vec<[f64; 2]> = noise.collect::<Option<_>>()?;
    let number = |key: &str| json[key].as_f64();
    // Older records have no interval: then bias may be anything.
    let bias2 = Interval { value: number("bias2")?, half: number("bias2_half") };
    let figures = (bias2, number("fixed_s")?, number("pace_s")?);
    (!noise.is_empty()).then_some(())?;
    Some(Curve::measured(String::new(), set?, figures, noise))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve whose bias is known to a ten-thousandth of itself.
    fn curve(set: &[(&str, &str)], bias2: f64, pace_s: f64, variance: f64) -> Curve {
        known(set, Interval { value: bias2, half: Some(1e-4 * bias2) }, pace_s, variance)
    }

    fn known(set: &[(&str, &str)], bias2: Interval, pace_s: f64, variance: f64) -> Curve {
        let set = set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let noise = vec![[1.0, variance], [100.0, variance / 100.0]];
        Curve::measured(String::new(), set, (bias2, 0.0, pace_s), noise)
    }

    #[test]
    fn the_quickest_over_all_scenes_are_advised() {
        let [fast, biased, rare] = [("render.a", "1"), ("render.b", "1"), ("render.c", "1")];
        let scene = |slow: f64, more: Option<Curve>| {
            let curves = vec![
                curve(&[], 0.0, 1.0, 1.0),
                curve(&[fast], 0.0, slow, 1.0),
                curve(&[biased], 1e-3, 0.1, 1.0),
            ];
            (Kind::Tree, curves.into_iter().chain(more).collect())
        };
        let record = Record(vec![scene(0.5, Some(curve(&[rare], 0.0, 0.01, 1.0))), scene(0.8, None)]);
        let set = |target, fits: &Fits<'_>| record.advice(Kind::Tree, target, fits).expect("advice");
        assert_eq!(set(1e-2, &|_| true).set[0].0, "render.b", "bias is small beside the target");
        let fine = set(1e-3, &|_| true);
        assert_eq!(fine.set[0].0, "render.a", "bias is too large, and not all scenes know the other");
        assert!((fine.gain - 0.4_f64.sqrt()).abs() < 1e-9 && fine.scenes == 2, "{fine:?}");
        assert!((fine.slope + 1.0).abs() < 1e-9, "{fine:?}");
        let plain = set(1e-3, &|set| set.is_empty());
        assert!(plain.set.is_empty() && (plain.gain - 1.0).abs() < 1e-12, "as the scenes say");
        assert_eq!(record.advice(Kind::Path, 1e-2, &|_| true), None, "nothing measured");
    }

    #[test]
    fn settings_whose_bias_is_not_known_well_enough_are_not_advised() {
        let set = [("render.a", "1")];
        let advised = |value, half| {
            let curves = vec![curve(&[], 0.0, 1.0, 1.0), known(&set, Interval { value, half }, 0.5, 1.0)];
            let record = Record(vec![(Kind::Tree, curves)]);
            !record.advice(Kind::Tree, 1e-2, &|_| true).expect("advice").set.is_empty()
        };
        assert!(advised(1e-4, Some(1e-3)), "small for certain");
        assert!(!advised(0.0, Some(3e-3)), "it may be as large as that, whatever was found");
        assert!(!advised(0.0, None), "it may be anything");
    }

    #[test]
    fn settings_that_gain_no_more_than_clocks_are_off_are_not_advised() {
        let set = [("render.a", "1")];
        let advised = |pace_s| {
            let record =
                Record(vec![(Kind::Tree, vec![curve(&[], 0.0, 1.0, 1.0), curve(&set, 0.0, pace_s, 1.0)])]);
            !record.advice(Kind::Tree, 1e-2, &|_| true).expect("advice").set.is_empty()
        };
        assert!(advised(0.7) && !advised(0.9), "a tenth may be chance");
    }

    #[test]
    fn curves_of_the_record_come_back() {
        for half in [Some(3e-5), None] {
            let one = known(&[("render.a", "1")], Interval { value: -1e-5, half }, 0.5, 1.0);
            assert_eq!(curve_of_json(&curve_to_json(&one)), Some(one), "there and back");
        }
    }

    #[test]
    fn the_record_is_sound_and_both_kinds_have_settings_for_every_preset() {
        let json: Value = serde_json::from_str(include_str!("presets.json")).expect("JSON");
        let record = Record::of_json(&json).expect("a record");
        for kind in [Kind::Tree, Kind::Path] {
            let scenes: Vec<&Vec<Curve>> =
                record.0.iter().filter(|(of, _)| *of == kind).map(|(_, curves)| curves).collect();
            assert!(scenes.len() > 1, "{kind:?}: too few scenes to speak for others");
            for curves in &scenes {
                assert!(curves.iter().any(|curve| curve.set.is_empty()), "{kind:?}: one as it is");
                assert!(curves.iter().all(|curve| curve.most_bias2().is_some()), "{kind:?}: {curves:?}");
                assert_eq!(curves.len(), scenes[0].len(), "{kind:?}: the same settings");
            }
            for preset in Preset::ALL {
                let found = advice(kind, preset.target(), &|_| true);
                let found = found.unwrap_or_else(|| panic!("{kind:?}, {preset:?}: no settings"));
                // What is twenty times as fast has been measured wrongly.
                assert!(found.gain > 0.05 && found.scenes == scenes.len(), "{kind:?}, {preset:?}: {found:?}");
            }
        }
    }

    #[test]
    fn words_are_those_of_presets() {
        for preset in Preset::ALL {
            assert_eq!(Preset::of(preset.word()), Some(preset), "{preset:?}");
        }
        assert!(Preset::ALL.windows(2).all(|two| two[0].target() > two[1].target()), "finer and finer");
    }
}
