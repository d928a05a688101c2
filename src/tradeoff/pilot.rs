//! A first look at a picture: how long its samples take and how noisy they are, from some of its pixels.
//!
//! Squares of pixels spread over the picture, at its full size, so that edges and textures are what they will be; each rendered twice with different
//! seeds. Half the squared difference of both is the variance of one; the reference that relMSE divides by is what the other numbers of samples say, so
//! that bright specks do not hide themselves. Light that no sample has found is not in it.

use super::curve::Curve;
use super::student::Interval;
use crate::error::Result;
use crate::image::Window;
use crate::measure::RELATIVE_FLOOR;
use crate::render::{Kept, Phase, Progress, Rendered, Settings, Studio};
use crate::sampling::hash;
use crate::scene::Scene;

/// What a first look has found.
#[derive(Clone, Debug, PartialEq)]
pub struct Pilot {
    /// Seconds of the processor that a sample of all pixels takes.
    pub pace_s: f64,
    /// Samples per pixel, and variance in relMSE.
    pub noise: Vec<[f64; 2]>,
    /// How long looking took, and building the hierarchy if it was not there.
    pub spent: Phase,
}

/// Samples per pixel of both looks.
const LOOKS: [u32; 2] = [4, 16];

/// Pixels along the edge of a square.
const SIDE: u32 = 16;

/// Squares, at most.
const SQUARES: u32 = 64;

/// How far seeds are from those of the picture.
const SEEDS: u64 = 1 << 25;

/// Somebody who may stop it, and is told nothing.
struct Unheard<'a>(&'a dyn Progress);

impl Progress for Unheard<'_> {
    fn advance(&self, _done: u64, _total: u64) {}

    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}

impl Pilot {
    /// Looks at a scene in a studio, which then has its hierarchy; `most_s` seconds of the processor are to be enough: then there is no
    /// second look where the first one shows that it would take longer. The scene is as before at the end.
    ///
    /// Fails as rendering does.
    pub fn of(scene: &mut Scene, studio: &mut Studio, most_s: f64, progress: &dyn Progress) -> Result<Self> {
        let said = (scene.render.spp, scene.render.seed);
        let (found, spent) = Phase::of(|| Self::looks(scene, studio, most_s, &Unheard(progress)));
        (scene.render.spp, scene.render.seed) = said;
        Ok(Self { spent, ..found? })
    }

    fn looks(scene: &mut Scene, studio: &mut Studio, most_s: f64, progress: &dyn Progress) -> Result<Self> {
        let squares = squares([scene.film.width, scene.film.height]);
        let pixels: f64 = squares.iter().map(|square| f64::from(square.width() * square.height())).sum();
        let all = f64::from(scene.film.width) * f64::from(scene.film.height);
        let first = scene.render.seed.wrapping_add(SEEDS);
        let mut looks: Vec<(u32, [Values; 2])> = Vec::new();
        let mut pace_s = 0.0;
        for (number, spp) in (0..).zip(LOOKS) {
            if number > 0 && 2.0 * f64::from(spp) * pace_s * pixels / all > most_s {
                break;
            }
            let mut both = [Values::new(), Values::new()];
            let mut cpu = 0.0;
            for (half, values) in (0..).zip(&mut both) {
                scene.render.spp = Some(spp);
                scene.render.seed = first.wrapping_add(2 * number + half);
                for &square in &squares {
                    let settings = Settings { crop: Some(square), ..Settings::default() };
                    let rendered = studio.render(scene, &settings, progress, Kept::default())?;
                    cpu += rendered.statistics.render.cpu.as_secs_f64();
                    values.extend(values_of(&rendered));
                }
            }
            pace_s = cpu / (2.0 * f64::from(spp) * pixels) * all;
            looks.push((spp, both));
        }
        let noise = (0..looks.len()).map(|i| [f64::from(looks[i].0), variance(&looks, i)]).collect();
        Ok(Self { pace_s, noise, spent: Phase::default() })
    }

    /// What is to be expected of more samples, where variance usually falls with the power `slope` of their number, bias being known from elsewhere.
    #[must_use]
    pub fn curve(&self, slope: f64, bias2: f64) -> Option<Curve> {
        let &[spp, variance] = self.noise.last()?;
        let own = match self.noise[..] {
            [.., [n, early], [m, late]] if early > 0.0 && late > 0.0 => (late / early).ln() / (m / n).ln(),
            _ => slope,
        };
        // Half of what two looks at few pixels tell, half of what other scenes do: a choice.
        let slope = (own + slope) / 2.0;
        let ahead = 64.0 * spp;
        let noise = vec![[spp, variance], [ahead, variance * (ahead / spp).powf(slope)]];
        let bias2 = Interval { value: bias2, half: Some(0.0) };
        Some(Curve::measured(String::new(), Vec::new(), (bias2, 0.0, self.pace_s), noise))
    }
}

/// Radiance of pixels.
type Values = Vec<[f32; 3]>;

fn values_of(rendered: &Rendered) -> Values {
    rendered.film.values(rendered.film.window())
}

/// The variance of look `at`, weighed by what all others say of the pixels; by its own mean where there are none.
#[expect(clippy::cast_precision_loss, reason = "few pictures and pixels")]
fn variance(looks: &[(u32, [Values; 2])], at: usize) -> f64 {
    let (_, [x, y]) = &looks[at];
    let others: Vec<&Values> = looks
        .iter()
        .enumerate()
        .filter(|(i, _)| looks.len() == 1 || *i != at)
        .flat_map(|(_, (_, both))| both)
        .collect();
    let mut sum = 0.0;
    for i in 0..x.len() {
        for c in 0..3 {
            let b = others.iter().map(|values| f64::from(values[i][c])).sum::<f64>() / others.len() as f64;
            let difference = f64::from(x[i][c]) - f64::from(y[i][c]);
            sum += difference * difference / 2.0 / (b * b + RELATIVE_FLOOR);
        }
    }
    sum / (3 * x.len()).max(1) as f64
}

/// Squares over a picture, one at a place by chance in each cell of a grid; all of a small picture.
fn squares([width, height]: [u32; 2]) -> Vec<Window> {
    if u64::from(width) * u64::from(height) <= u64::from(2 * SQUARES * SIDE * SIDE) {
        return vec![Window::whole(width, height)];
    }
    let across = columns([width, height]);
    let down = (SQUARES / across).max(1);
    let mut squares = Vec::new();
    for number in 0..across * down {
        let [column, row] = [number % across, number / across];
        let place = |cell: u32, of: u32, length: u32, salt: u32| {
            let side = SIDE.min(length);
            let [from, to] = [cell * length / of, (cell + 1) * length / of];
            let room = to.saturating_sub(from).saturating_sub(side) + 1;
            (from + hash::combine(hash::mix(number), salt) % room).min(length - side)
        };
        let [x0, y0] = [place(column, across, width, 0), place(row, down, height, 1)];
        squares.push(Window { x0, y0, x1: (x0 + SIDE).min(width), y1: (y0 + SIDE).min(height) });
    }
    squares
}

/// Columns of a grid of about square cells.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 1 to the number of squares"
)]
fn columns([width, height]: [u32; 2]) -> u32 {
    let columns = (f64::from(SQUARES) * f64::from(width) / f64::from(height)).sqrt().round();
    (columns as u32).clamp(1, SQUARES)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Silent;
    use crate::scene;
    use std::num::NonZeroUsize;

    #[test]
    fn squares_lie_in_the_picture_and_are_spread() {
        for size in [[1280, 720], [4000, 300], [17, 9000], [1 << 16, 1 << 16]] {
            let squares = squares(size);
            assert!(squares.len() >= 32 && squares.len() <= 64, "{size:?}: {}", squares.len());
            for (i, square) in squares.iter().enumerate() {
                assert!(square.fits(size[0], size[1]) && !square.is_empty(), "{square:?} in {size:?}");
                assert!(!squares[..i].contains(square), "{square:?} twice");
            }
        }
        assert_eq!(squares([160, 90]), [Window::whole(160, 90)], "all of a small picture");
    }

    #[test]
    fn both_looks_and_the_picture_share_a_hierarchy() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.toml");
        let text = "[film]\nwidth = 8\nheight = 4\n[render]\nintegrator = 'path'\nspp = 3\nseed = 5\n[materials.m]\n\
            type = 'diffuse'\n[[shapes]]\ntype = 'sphere'\nradius = 1.0\nmaterial = 'm'\n[[lights]]\ntype = 'environment'\n\
            radiance = 1.0\n";
        std::fs::write(&path, text).expect("written");
        let loaded = scene::load(&path, &[]).expect("a scene file");
        let mut scene = scene::build(&loaded.description).expect("a scene").scene;
        let mut studio = Studio::new(NonZeroUsize::new(1)).expect("threads");
        let pilot = Pilot::of(&mut scene, &mut studio, 1e9, &Silent).expect("a look");
        assert_eq!(pilot.noise.len(), 2, "both looks: {pilot:?}");
        assert_eq!((scene.render.spp, scene.render.seed), (Some(3), 5), "as before");
        let picture = studio.render(&scene, &Settings::default(), &Silent, Kept::default());
        let statistics = picture.expect("a picture").statistics;
        assert_eq!((statistics.build, statistics.samples), (Phase::default(), 8 * 4 * 3), "built before");
    }

    #[test]
    fn variance_is_half_the_squared_difference_over_the_others() {
        let look = |spp, x: f32, y: f32| (spp, [vec![[x; 3]; 2], vec![[y; 3]; 2]]);
        let looks = [look(4, 1.0, 1.4), look(16, 2.0, 2.0)];
        let wanted = 0.16 / 2.0 / (4.0 + RELATIVE_FLOOR);
        assert!((variance(&looks, 0) / wanted - 1.0).abs() < 1e-5, "{}", variance(&looks, 0));
        assert!(variance(&looks, 1).abs() < 1e-12, "no difference");
        let wanted = 0.16 / 2.0 / (1.44 + RELATIVE_FLOOR);
        assert!((variance(&looks[..1], 0) / wanted - 1.0).abs() < 1e-5, "of one look");
    }
}
