//! When the picture is taken.

/// From its opening to its closing, in seconds of scene time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Shutter {
    pub(super) open_s: f64,
    pub(super) close_s: f64,
}

impl Shutter {
    /// Whether it is open for some time, so that what moves is blurred.
    pub(super) fn is_open(self) -> bool {
        self.close_s > self.open_s
    }

    /// The time in seconds at a moment of the shutter in [0, 1].
    pub(super) fn at(self, moment: f64) -> f64 {
        if moment >= 1.0 { self.close_s } else { self.open_s + (self.close_s - self.open_s) * moment }
    }

    /// The moments in ]0, 1[ that times in seconds are while the shutter is open.
    pub(super) fn moments(self, times_s: &[f64]) -> impl Iterator<Item = f64> {
        let length = self.close_s - self.open_s;
        times_s
            .iter()
            .map(move |time| (time - self.open_s) / length)
            .filter(|moment| *moment > 0.0 && *moment < 1.0)
    }
}
