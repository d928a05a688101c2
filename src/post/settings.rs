//! How the filter weighs, how far it looks, and what it does to be quick.

/// The knobs of the filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fuzzy {
    /// What weights follow from.
    pub weighting: Weighting,
    /// The part of the lobe that may lie outside of the window, in (0, 1): says how wide the window is.
    pub lost_mass: f32,
    /// The greatest half angle of a lobe, in radians: what is beyond is cut off.
    pub max_angle: f32,
    /// The greatest radius of a window, in pixels: what is beyond is cut off.
    pub max_radius: f32,
    /// What follows the radius of the window from.
    pub radius: Radius,
    /// The outline of the window.
    pub shape: Shape,
    /// What is made of pixels being samples of area and not of solid angle.
    pub correction: Correction,
    /// What is done to be quick.
    pub speed: Speed,
}

impl Default for Fuzzy {
    fn default() -> Self {
        Self {
            weighting: Weighting::Phong,
            lost_mass: 0.01,
            max_angle: std::f32::consts::FRAC_PI_2,
            max_radius: 512.0,
            radius: Radius::Differential,
            shape: Shape::Round,
            correction: Correction::SolidAngle,
            speed: Speed::default(),
        }
    }
}

/// What weights follow from: the two forms of Kulikova and Dmitriev. Their common factors cancel, since weights are normalised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighting {
    /// cos(J)^p of a Phong exponent p.
    #[default]
    Phong,
    /// 2 strength cos(J)^shininess: the strength scales the reflection.
    Shininess,
}

/// What the radius of a window follows from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Radius {
    /// From distances, as if reflector and receiver were flat and seen straight on: Q / (1 + s / r).
    Cone,
    /// From how far apart the rays of neighbouring pixels end, as seen from the reflector: also where it is curved or tilted.
    #[default]
    Differential,
}

/// The outline of a window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shape {
    /// An ellipse, in most cases a circle.
    #[default]
    Round,
    /// The rectangle about it.
    Rectangle,
}

/// What is made of pixels being samples of area and not of solid angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Correction {
    /// Nothing: on a receiver straight ahead the lobe of exponent p comes out as that of p - 3.
    None,
    /// Three more in the exponent, which is exact for a flat receiver straight ahead.
    Cosine,
    /// Each pixel counts the solid angle that it has as seen from the reflector, by the places of its neighbours.
    #[default]
    SolidAngle,
}

/// How what lies outside of the lobe is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rejection {
    /// By 1 - cos J, before anything else is computed.
    #[default]
    Cosine,
    /// By the angle J itself.
    Angle,
}

/// What is done to be quick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Whether pixels whose window has a radius below half a pixel are left as they are, without a look: nothing but themselves is in it.
    pub skip: bool,
    /// How what lies outside of the lobe is told.
    pub rejection: Rejection,
    /// Whether weights come from a table.
    pub table: bool,
    /// How many pixels of a window count at most; all if absent. They are spread evenly, and turned from pixel to pixel.
    pub taps: Option<u32>,
    /// Windows of at least twice this radius, in pixels, are looked at in a smaller picture, where their radius is between this and
    /// twice as much.
    pub pyramid: Option<f32>,
    /// From this radius on, in pixels, every other row and column is filtered, and the rest is interpolated.
    pub half: Option<f32>,
}

impl Speed {
    /// All pixels of all windows, with nothing spared but what lies outside of lobes.
    pub const PLAIN: Self = Self {
        skip: true,
        rejection: Rejection::Cosine,
        table: false,
        taps: None,
        pyramid: None,
        half: None,
    };
}

impl Default for Speed {
    fn default() -> Self {
        Self { pyramid: Some(8.0), ..Self::PLAIN }
    }
}
