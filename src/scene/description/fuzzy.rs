//! The filter that makes fuzzy reflections.

use super::Knob;
use crate::scene::record::{Value, choice, record};

record! {
    /// The filter that makes fuzzy reflections of sharp ones.
    pub struct FuzzyFilter {
        /// What weights follow from.
        weighting: FuzzyWeighting = FuzzyWeighting::Phong;
        /// Under the weighting `shininess`: what reflections are multiplied by.
        strength: f32 = 1.0, min(0.0), max(1.0);
        /// The part of a lobe that may lie outside of its window.
        lost_mass: f32 = 0.01, above(0.0), below(1.0);
        /// The greatest half angle of a lobe; what is beyond is cut off.
        max_angle_deg: f32 = 90.0, unit("degrees"), above(0.0), max(90.0);
        /// The greatest radius of a window; what is beyond is cut off.
        max_radius: f32 = 512.0, unit("pixels"), min(0.0), max(8192.0);
        /// What the radius of a window follows from.
        radius: FuzzyRadius = FuzzyRadius::Differential;
        /// The outline of a window.
        window: FuzzyWindow = FuzzyWindow::Round;
        /// What is made of pixels being samples of area and not of solid angle.
        correction: FuzzyCorrection = FuzzyCorrection::SolidAngle;
        /// Whether pixels whose window is below half a pixel are left as they are at once.
        skip: bool = true;
        /// How what lies outside of the lobe is told.
        rejection: FuzzyRejection = FuzzyRejection::Cosine;
        /// Whether weights are looked up in a table.
        table: bool = false;
        /// How many pixels of a window count at most, or `off` for all.
        taps: Knob<u32> = Knob::Off, min(1.0), max(1_048_576.0);
        /// Windows of at least twice this radius are looked at in a smaller picture, where their radius is from this to twice as much; or
        /// `off`.
        pyramid: Knob<f32> = Knob::At(8.0), unit("pixels"), min(2.0), max(8192.0);
        /// From this radius on every other row and column is filtered and the rest interpolated; or `off`.
        half: Knob<f32> = Knob::Off, unit("pixels"), min(0.0), max(8192.0);
    }
}

impl FuzzyFilter {
    /// As it could stand in a scene file, in JSON, defaults written out.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        Value::to_json(self)
    }
}

choice! {
    /// How lobes become fuzzy reflections.
    pub enum FuzzyBy {
        /// By rays within the lobe.
        "lobe" => Lobe,
        /// Under `whitted` and `distribution`: by one ray of an ideal mirror and a filter over the picture, for the first surface seen.
        "two-pass" => TwoPass,
        /// By an ideal mirror whose normal trembles: `glossy` materials become `jitter` ones that are as sharp straight on. `phong` materials stay as
        /// they are, by rays within the lobe: what they reflect changes with the angle, which a mirror whose normal trembles cannot.
        "jitter" => Jitter,
    }
}

choice! {
    /// What the weights of the filter follow from.
    pub enum FuzzyWeighting {
        /// cos(J)^p of the exponent of the lobe.
        "phong" => Phong,
        /// 2 strength cos(J)^shininess, normalised: the exponent of the lobe is the shininess, and the strength scales the reflection.
        "shininess" => Shininess,
    }
}

choice! {
    /// What the radius of a window follows from.
    pub enum FuzzyRadius {
        /// How far apart the rays of neighbouring pixels end: also where the reflector is curved or the receiver tilted.
        "differential" => Differential,
        /// Distances, as if reflector and receiver were flat and seen straight on.
        "cone" => Cone,
    }
}

choice! {
    /// The outline of a window.
    pub enum FuzzyWindow {
        /// An ellipse, in most cases a circle.
        "round" => Round,
        /// The rectangle about it.
        "rectangle" => Rectangle,
    }
}

choice! {
    /// What is made of pixels being samples of area and not of solid angle.
    pub enum FuzzyCorrection {
        /// Each pixel counts the solid angle that it has as seen from the reflector.
        "solid-angle" => SolidAngle,
        /// Three more in the exponent: right for a flat receiver straight ahead.
        "cosine" => Cosine,
        /// Nothing: lobes come out broader.
        "none" => None,
    }
}

choice! {
    /// How what lies outside of the lobe is told.
    pub enum FuzzyRejection {
        /// By the cosine.
        "cosine" => Cosine,
        /// By the angle.
        "angle" => Angle,
    }
}
