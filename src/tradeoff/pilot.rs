//! A first look at a picture: how long its samples take and how noisy they are, from some of its pixels.
//!
//! Squares of pixels spread over the picture, at its full size, so that edges and textures are what they will be; each rendered twice with different
//! seeds, as many of them as there is time for. Half the squared difference of both is the variance of one; the reference that relMSE divides by is
//! what the other numbers of samples say, so that bright specks do not hide themselves. Light that no sample has found is not in it.

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

/// Pixels along the edge of a part of a picture all of which is looked at.
const PART: u32 = 2 * SIDE;

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
    /// Looks at a scene in a studio, which then has its hierarchy; `most_s` seconds of tracing by the clock are to be enough: the first look ends
    /// at the square that would take longer, but for the very first one, and there is a second look only where there is time for all of it. The scene is as
    /// before at the end.
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
        let seed = scene.render.seed.wrapping_add(SEEDS);
        let [few, many] = LOOKS;
        let first = Look::at(&squares, (few, seed), (scene, studio, most_s), progress)?;
        // At the pace of the first one.
        let both_s = first.spent.wall.as_secs_f64() * (1.0 + f64::from(many) / f64::from(few));
        let mut looks = vec![first];
        if looks[0].squares == squares.len() && both_s <= most_s {
            let seed = seed.wrapping_add(2);
            looks.push(Look::at(&squares, (many, seed), (scene, studio, f64::INFINITY), progress)?);
        }
        let all = f64::from(scene.film.width) * f64::from(scene.film.height);
        let pace_s = looks.last().map_or(0.0, |look| look.pace_s() * all);
        let noise = (0..looks.len()).map(|i| [f64::from(looks[i].spp), variance(&looks, i)]).collect();
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

/// Squares, each rendered twice with different seeds.
#[derive(Clone, Debug, Default)]
struct Look {
    /// Samples per pixel.
    spp: u32,
    /// What both times came to.
    both: [Values; 2],
    /// How many squares there are, of how many pixels.
    squares: usize,
    pixels: u32,
    /// How long tracing took.
    spent: Phase,
}

impl Look {
    /// Looks at squares, with the seed and the next one, until there are no more or the next square would make it longer than `most_s`; at the first one
    /// in any case.
    fn at(
        squares: &[Window],
        (spp, seed): (u32, u64),
        (scene, studio, most_s): (&mut Scene, &mut Studio, f64),
        progress: &dyn Progress,
    ) -> Result<Self> {
        let mut look = Self { spp, ..Self::default() };
        scene.render.spp = Some(spp);
        for &square in squares {
            let pixels = square.width() * square.height();
            let pace_s = look.spent.wall.as_secs_f64() / f64::from(look.pixels.max(1));
            if look.squares > 0 && pace_s * f64::from(look.pixels + pixels) > most_s {
                break;
            }
            for (half, values) in (0..).zip(&mut look.both) {
                scene.render.seed = seed.wrapping_add(half);
                let settings = Settings { crop: Some(square), ..Settings::default() };
                let rendered = studio.render(scene, &settings, progress, Kept::default())?;
                look.spent += rendered.statistics.render;
                values.extend(values_of(&rendered));
            }
            look.squares += 1;
            look.pixels += pixels;
        }
        Ok(look)
    }

    /// Seconds of the processor for a sample of a pixel.
    fn pace_s(&self) -> f64 {
        self.spent.cpu.as_secs_f64() / (2.0 * f64::from(self.spp) * f64::from(self.pixels.max(1)))
    }
}

fn values_of(rendered: &Rendered) -> Values {
    rendered.film.values(rendered.film.window())
}

/// The variance of look `at`, weighed by what all others say of the pixels; by its own mean where there are none.
#[expect(clippy::cast_precision_loss, reason = "few pictures and pixels")]
fn variance(looks: &[Look], at: usize) -> f64 {
    let [x, y] = &looks[at].both;
    let others: Vec<&Values> = looks
        .iter()
        .enumerate()
        .filter(|(i, _)| looks.len() == 1 || *i != at)
        .flat_map(|(_, look)| &look.both)
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

/// Squares over a picture, one at a place by chance in each cell of a grid; all of a small picture, in parts. They follow one another by chance, so that
/// the first few are spread, too.
fn squares([width, height]: [u32; 2]) -> Vec<Window> {
    let mut squares = if u64::from(width) * u64::from(height) <= u64::from(2 * SQUARES * SIDE * SIDE) {
        parts([width, height])
    } else {
        spread([width, height])
    };
    squares.sort_by_key(|square| hash::pixel_key(0, [square.x0, square.y0]));
    squares
}

/// All of a picture.
fn parts([width, height]: [u32; 2]) -> Vec<Window> {
    let part = |x0: u32, y0: u32| Window { x0, y0, x1: (x0 + PART).min(width), y1: (y0 + PART).min(height) };
    let edges = |length: u32| (0..length).step_by(PART as usize);
    edges(height).flat_map(|y| edges(width).map(move |x| part(x, y))).collect()
}

/// One in each cell of a grid.
fn spread([width, height]: [u32; 2]) -> Vec<Window> {
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
        for size in [[160, 90], [37, 21], [5, 4]] {
            let squares = squares(size);
            let places = squares
                .iter()
                .flat_map(|it| (it.y0..it.y1).flat_map(|y| (it.x0..it.x1).map(move |x| [y, x])));
            let mut places: Vec<[u32; 2]> = places.collect();
            places.sort_unstable();
            let all: Vec<[u32; 2]> = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [y, x])).collect();
            assert_eq!(places, all, "all of a small picture, once");
        }
    }

    #[test]
    fn the_first_few_squares_are_spread() {
        for size in [[1280, 720], [160, 90]] {
            let squares = squares(size);
            for axis in 0..2 {
                let middle = |it: &Window| [it.x0 + it.x1, it.y0 + it.y1][axis];
                let beyond = squares[..8].iter().filter(|it| middle(it) > size[axis]).count();
                assert!((1..8).contains(&beyond), "{size:?}: {beyond} of 8 beyond the middle, {squares:?}");
            }
        }
    }

    /// A ball in white light.
    fn ball([width, height]: [u32; 2]) -> Scene {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.toml");
        let head = format!("[film]\nwidth = {width}\nheight = {height}\n");
        let text = "[render]\nintegrator = 'path'\nspp = 3\nseed = 5\n[materials.m]\n\
            type = 'diffuse'\n[[shapes]]\ntype = 'sphere'\nradius = 1.0\nmaterial = 'm'\n[[lights]]\ntype = 'environment'\n\
            radiance = 1.0\n";
        std::fs::write(&path, head + text).expect("written");
        let loaded = scene::load(&path, &[]).expect("a scene file");
        scene::build(&loaded.description).expect("a scene").scene
    }

    #[test]
    fn a_look_ends_when_its_time_is_over() {
        let squares = squares([160, 90]);
        let (mut scene, mut studio) = (ball([160, 90]), Studio::new(NonZeroUsize::new(1)).expect("threads"));
        let mut look =
            |most_s| Look::at(&squares, (4, 7), (&mut scene, &mut studio, most_s), &Silent).expect("a look");
        let (all, one) = (look(1e9), look(0.0));
        assert_eq!((all.squares, all.pixels), (squares.len(), 160 * 90), "all of them in time");
        assert_eq!((one.squares, one.pixels), (1, squares[0].width() * squares[0].height()), "the first one");
        for (all, one) in all.both.iter().zip(&one.both) {
            assert_eq!(one[..], all[..one.len()], "as far as it came");
        }
        let pilot = Pilot::of(&mut scene, &mut studio, 0.0, &Silent).expect("a look");
        assert_eq!(pilot.noise.len(), 1, "no second one: {pilot:?}");
        assert!(pilot.pace_s >= 0.0 && pilot.noise[0][1].is_finite(), "{pilot:?}");
    }

    #[test]
    fn both_looks_and_the_picture_share_a_hierarchy() {
        let mut scene = ball([8, 4]);
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
        let look =
            |spp, x: f32, y: f32| Look { spp, both: [vec![[x; 3]; 2], vec![[y; 3]; 2]], ..Look::default() };
        let looks = [look(4, 1.0, 1.4), look(16, 2.0, 2.0)];
        let wanted = 0.16 / 2.0 / (4.0 + RELATIVE_FLOOR);
        assert!((variance(&looks, 0) / wanted - 1.0).abs() < 1e-5, "{}", variance(&looks, 0));
        assert!(variance(&looks, 1).abs() < 1e-12, "no difference");
        let wanted = 0.16 / 2.0 / (1.44 + RELATIVE_FLOOR);
        assert!((variance(&looks[..1], 0) / wanted - 1.0).abs() < 1e-5, "of one look");
    }
}
