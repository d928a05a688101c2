//! Which pixels show a fuzzy reflector, and where on it they are.

use specula::post::{Fuzzy, GBuffer, Lobe};

/// What a pixel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// Not all of it shows one reflector.
    Outside,
    /// Another reflector, none, or the border of the picture is within the window.
    Silhouette,
    /// The window is below two pixels.
    Contact,
    /// None of these.
    Inside,
}

impl Class {
    pub(crate) const OF_MASK: [Self; 3] = [Self::Inside, Self::Silhouette, Self::Contact];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Silhouette => "silhouettes",
            Self::Contact => "contact",
            Self::Inside => "inside",
        }
    }
}

/// The class of each pixel by its samples.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "places in small pictures")]
pub(crate) fn classes(samples: &[GBuffer]) -> Vec<Class> {
    let window = samples[0].window;
    let (width, height) = (window.width() as i64, window.height() as i64);
    let reflector = |x: i64, y: i64| -> u32 {
        if x < 0 || y < 0 || x >= width || y >= height {
            return 0;
        }
        let of = |g: &GBuffer| g.texels[(y * width + x) as usize].mirror.map_or(0, |mirror| mirror.reflector);
        let first = of(&samples[0]);
        if samples.iter().all(|g| of(g) == first) { first } else { 0 }
    };
    let (lost, cap) = (Fuzzy::default().lost_mass, Fuzzy::default().max_angle);
    let class = |x: i64, y: i64| {
        let own = reflector(x, y);
        let Some(mirror) = samples[0].texels[(y * width + x) as usize].mirror.filter(|_| own > 0) else {
            return Class::Outside;
        };
        let alpha = Lobe::new(mirror.exponent, lost, cap).angle() / (1.0 + mirror.s / mirror.length());
        let radius = alpha.tan() * samples[0].scale;
        // Along eight directions: a window is an ellipse, and reflectors are not finer than that.
        let reach = radius.ceil() as i64;
        let at = |k: i64, (dx, dy): (i64, i64)| {
            let far = if dx != 0 && dy != 0 { k * 7 / 10 } else { k };
            reflector(x + dx * far, y + dy * far)
        };
        let around = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)];
        if radius < 2.0 {
            Class::Contact
        } else if around.iter().any(|&d| (1..=reach).any(|k| at(k, d) != own)) {
            Class::Silhouette
        } else {
            Class::Inside
        }
    };
    (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| class(x, y)).collect()
}
