//! How far files are trusted.

use std::path::Path;

use super::values::{given, on_command_line};
use crate::cli::args::{LimitsArgs, TrustArgs};
use crate::error::{Problems, Result};
use crate::scene::load::words::suggest;
use crate::trust::{Limit, Limits, Sandbox, Trust};

/// How far the files of scenes are trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cli) struct Trusted {
    limits: Limits,
    /// Whether only files in the folder of their scene are read.
    sandbox: bool,
}

impl Trusted {
    /// What those words mean; what is wrong with them is added to the problems.
    pub(super) fn new(args: &TrustArgs, problems: &mut Problems) -> Self {
        Self { limits: limits(&args.limits, problems), sandbox: args.sandbox }
    }

    /// What those words mean; all that is wrong with them at once.
    pub(in crate::cli) fn alone(args: &TrustArgs) -> Result<Self> {
        let mut problems = Problems::default();
        let trusted = Self::new(args, &mut problems);
        problems.into_result(trusted)
    }

    /// How far the files of one scene are.
    pub(in crate::cli) fn of(&self, scene: &Path) -> Trust {
        Trust { limits: self.limits, sandbox: self.sandbox.then(|| Sandbox::around(scene)) }
    }

    /// What files may ask for that the user names.
    pub(in crate::cli) fn limits(&self) -> Limits {
        self.limits
    }
}

/// What files may ask for.
pub(super) fn limits(args: &LimitsArgs, problems: &mut Problems) -> Limits {
    let mut limits = Limits::default();
    for text in args.limits.iter().map(|text| text.trim()) {
        if text == NONE {
            limits = Limits::none();
            continue;
        }
        let (word, number) = text.split_once('=').unwrap_or((text, ""));
        let Some(limit) = Limit::ALL.into_iter().find(|limit| limit.word() == word.trim()) else {
            let what = format!("`--limits {text}` limits nothing that is known");
            problems.push(on_command_line(what).remedy(suggest(word.trim(), &Limit::ALL.map(Limit::word))));
            continue;
        };
        let remedy = || format!("give a whole number such as {0}=1000 or {0}=2e9, or {0}=none", limit.word());
        if let Some(most) = given(most(number.trim()), ("limits", text), "a limit", remedy, problems) {
            limits = limits.with(limit, most);
        }
    }
    limits
}

/// The words that say how far files are trusted; none where that is as usual.
pub(in crate::cli) fn words(trust: &Trust) -> Vec<String> {
    let others = Limit::ALL.into_iter().filter(|&limit| trust.limits.most(limit) != limit.default_most());
    let told = |limit: Limit| {
        let most = trust.limits.most(limit).map_or(NONE.to_owned(), |most| most.to_string());
        format!("{}={most}", limit.word())
    };
    let told: Vec<String> = others.map(told).collect();
    let limits = (!told.is_empty()).then(|| format!("--limits={}", told.join(",")));
    trust.sandbox.iter().map(|_| "--sandbox".to_owned()).chain(limits).collect()
}

/// Without a limit.
const NONE: &str = "none";

/// A limit, or that there is none; the outer `None` if it is neither.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut at both ends")]
fn most(text: &str) -> Option<Option<u64>> {
    if text == NONE {
        return Some(None);
    }
    if let Ok(whole) = text.parse() {
        return Some(Some(whole));
    }
    let number = text.parse().ok().filter(|x: &f64| *x >= 0.0 && x.fract() == 0.0)?;
    Some(Some(number as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> std::result::Result<Limits, String> {
        let args = LimitsArgs { limits: text.split(',').map(str::to_owned).collect() };
        let mut problems = Problems::default();
        let limits = limits(&args, &mut problems);
        problems.into_result(limits).map_err(|error| error.to_string())
    }

    #[test]
    fn limits_are_numbers_by_name() {
        let few = Limits::default().with(Limit::Pixels, Some(400_000_000)).with(Limit::Triangles, Some(7));
        assert_eq!(of("pixels=4e8, triangles=7"), Ok(few), "two");
        assert_eq!(of("none"), Ok(Limits::none()), "none at all");
        assert_eq!(of("none,files=3"), Ok(Limits::none().with(Limit::Files, Some(3))), "one");
        assert_eq!(of("bytes=none"), Ok(Limits::default().with(Limit::Bytes, None)), "all but one");
        let huge = Limits::default().with(Limit::Bytes, Some(u64::MAX));
        assert_eq!(of("bytes=1e30"), Ok(huge), "as much as there can be");
    }

    #[test]
    fn words_say_what_was_said() {
        let words_of = |text: &str, sandbox: bool| {
            let limits = of(text).expect("sound");
            words(&Trust { limits, sandbox: sandbox.then(|| Sandbox::new(Path::new(""))) })
        };
        assert_eq!(words(&Trust::default()), [""; 0], "as usual");
        assert_eq!(
            words_of("pixels=4e8,bytes=none", true),
            ["--sandbox", "--limits=pixels=400000000,bytes=none"]
        );
        let all = words_of("none", false).concat();
        assert_eq!(of(all.trim_start_matches("--limits=")), Ok(Limits::none()), "{all}");
    }

    #[test]
    fn what_limits_nothing_is_refused() {
        for text in ["pixels", "pixels=", "pixels=many", "pixels=-1", "pixels=1.5", "pixels=nan", "=3", ""] {
            assert!(of(text).is_err(), "{text}");
        }
        let told = of("pixel=3,texels=x").expect_err("wrong");
        assert!(told.contains("did you mean `pixels`?") && told.contains("texels=2e9"), "{told}");
    }
}
