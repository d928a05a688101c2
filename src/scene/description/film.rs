//! The picture, and how samples become pixels.

use crate::scene::record::{choice, record};

record! {
    /// The picture and how samples become pixels.
    pub struct Film {
        /// Columns.
        width: u32 = 1280, unit("pixels"), min(1.0), max(65536.0);
        /// Rows.
        height: u32 = 720, unit("pixels"), min(1.0), max(65536.0);
        /// How samples are weighted about the middle of a pixel. Mitchell's is the sharpest; where samples are few, its negative
        /// lobes leave dark specks beside bright edges, which gaussian does not.
        filter: Filter = Filter::Mitchell;
        /// How far the filter reaches; absent: 0.5 for box, 1 for tent, 1.5 for gaussian, 2 for mitchell.
        filter_radius: Option<f32>, unit("pixels"), above(0.0), max(16.0);
        /// Exposure of the PNG preview, in powers of two; EXR files are not touched by it.
        exposure_ev: f32 = 0.0, unit("stops"), min(-100.0), max(100.0);
        /// How radiance beyond white is shown in the PNG preview.
        tone: Tone = Tone::Filmic;
        /// Whether the outputs `albedo` and `normal` are of what polished surfaces show, as denoisers want them, instead of the first surface.
        follow_polished: bool = true;
    }
}

choice! {
    /// How samples are weighted about the middle of a pixel.
    pub enum Filter {
        /// All alike.
        "box" => Box,
        /// Falling linearly.
        "tent" => Tent,
        /// A Gaussian, shifted down to zero at its radius.
        "gaussian" => Gaussian,
        /// The sharpening cubic of Mitchell and Netravali.
        "mitchell" => Mitchell,
    }
}

impl Filter {
    /// How far it reaches where the film does not say, in pixels.
    #[must_use]
    pub const fn default_radius(self) -> f32 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Gaussian => 1.5,
            Self::Mitchell => 2.0,
        }
    }
}

choice! {
    /// How radiance beyond white is shown in the PNG preview.
    pub enum Tone {
        /// Cut off at white.
        "clip" => Clip,
        /// Rolled off smoothly.
        "filmic" => Filmic,
    }
}
