//! Camera samples: where on the film, on the lens and while the shutter is open.

use crate::film::{FilterSample, SampleId};
use crate::image::Window;
use crate::integrator::Wave;
use crate::math::Vec3;
use crate::math::lanes::{IntLanes, Isa, Kernel, Lanes, Wrapping};
use crate::render::tiles::Plan;
use crate::sampling::{AnySampler, Dim, Sampler, Vertex};
use std::ops::Range;

/// Rays from the camera, and what their light counts.
pub(super) struct CameraSamples<F> {
    pub(super) weight: F,
    pub(super) o: Vec3<F>,
    pub(super) d: Vec3<F>,
    pub(super) time: F,
}

impl Plan<'_> {
    /// The numbers of samples of pixels.
    #[inline(always)]
    pub(super) fn start<I: IntLanes>(&self, pixel: [I; 2], index: I) -> AnySampler<I> {
        self.sampler.start(self.seed, pixel, index)
    }

    /// The rays of samples of pixels, with these numbers.
    #[inline(always)]
    pub(super) fn camera_samples<I: IntLanes>(
        &self,
        [x, y]: [I; 2],
        sampler: &AnySampler<I>,
    ) -> CameraSamples<I::F> {
        let film = self.filter.sample(sampler.get_2d(Dim::Film, Vertex::ROOT));
        self.camera_samples_at([x, y], film, sampler)
    }

    /// The same with another place on the film.
    #[inline(always)]
    pub(super) fn camera_samples_at<I: IntLanes>(
        &self,
        [x, y]: [I; 2],
        FilterSample { offset, weight }: FilterSample<I::F>,
        sampler: &AnySampler<I>,
    ) -> CameraSamples<I::F> {
        let film = [x.signed_to_float() + 0.5 + offset[0], y.signed_to_float() + 0.5 + offset[1]];
        let camera = &self.scene.camera;
        let time = if self.moves { sampler.get_1d(Dim::Time, Vertex::ROOT) } else { weight.splat(0.0) };
        let lens = if camera.has_lens() {
            sampler.get_2d(Dim::Lens, Vertex::ROOT)
        } else {
            [weight.splat(0.5), weight.splat(0.5)]
        };
        let (o, d) = camera.rays(film, lens, time);
        CameraSamples { weight, o, d, time }
    }
}

/// Goes through samples of all pixels of a window, pixel by pixel in the order of their indices.
#[derive(Clone, Debug)]
pub(super) struct Cursor {
    window: Window,
    samples: Range<u32>,
    next: SampleId,
}

impl Cursor {
    /// Through these samples of each pixel.
    pub(super) fn new(window: Window, samples: Range<u32>) -> Self {
        let next = SampleId { x: window.x0, y: window.y0, index: samples.start };
        Self { window, samples, next }
    }

    /// How many samples of the same pixel come next, the next one included; 0 at the end.
    fn run(&self) -> u32 {
        if self.next.y < self.window.y1 { self.samples.end - self.next.index } else { 0 }
    }

    /// Passes `count` samples of the same pixel.
    fn pass(&mut self, count: u32) {
        self.next.index += count;
        if self.next.index == self.samples.end {
            self.next = SampleId { x: self.next.x + 1, index: self.samples.start, ..self.next };
        }
        if self.next.x == self.window.x1 {
            self.next = SampleId { x: self.window.x0, y: self.next.y + 1, ..self.next };
        }
    }

    /// The next runs of samples of one pixel each, `most` samples in all: the first sample of each and its length.
    pub(super) fn runs(&mut self, mut most: u32) -> impl Iterator<Item = (SampleId, u32)> {
        std::iter::from_fn(move || {
            let count = self.run().min(most);
            let first = self.next;
            self.pass(count);
            most -= count;
            (count > 0).then_some((first, count))
        })
    }
}

impl Iterator for Cursor {
    type Item = SampleId;

    fn next(&mut self) -> Option<SampleId> {
        self.runs(1).next().map(|(first, _)| first)
    }
}

/// Lets the paths of the next samples begin, several of a sample along the same ray, and notes what each sample counts. Their media are to be set where there are any.
pub(super) struct Begin<'a> {
    pub(super) plan: &'a Plan<'a>,
    /// Samples of a pixel each, by their first.
    pub(super) runs: &'a [(SampleId, u32)],
    /// Paths of a sample.
    pub(super) ways: u32,
    pub(super) wave: &'a mut Wave,
    pub(super) weights: &'a mut Vec<f32>,
}

impl<S: Isa> Kernel<S> for Begin<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, isa: S) {
        let Self { plan, runs, ways, wave, weights } = self;
        let paths = runs.iter().map(|(_, count)| *count as usize).sum::<usize>() * ways as usize;
        wave.clear(paths, ways as usize);
        weights.clear();
        weights.resize(paths + S::WIDTH, 0.0);
        let mut to = 0;
        for &(first, count) in runs {
            let pixel = [isa.splat_u32(first.x), isa.splat_u32(first.y)];
            let count = count * ways;
            for skipped in (0..count).step_by(S::WIDTH) {
                let number = first.index * ways + skipped;
                let index = Wrapping::<u32>::wrapping_add(isa.iota(), number);
                let sampler = plan.start(
                    pixel,
                    if ways == 1 { index } else { isa.per_lane_u32(|lane| index.extract(lane) / ways) },
                );
                let CameraSamples { weight, o, d, time } = plan.camera_samples(pixel, &sampler);
                let taken = ((count - skipped) as usize).min(S::WIDTH);
                weight.store(&mut weights[to..]);
                wave.begin(isa, taken, (pixel, index), (o, d, time));
                to += taken;
            }
        }
        if ways > 1 {
            (1..paths / ways as usize).for_each(|sample| weights[sample] = weights[sample * ways as usize]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_passes_every_sample_once_in_order() {
        let window = Window { x0: 2, y0: 3, x1: 5, y1: 5 };
        let expected: Vec<_> = (3..5)
            .flat_map(|y| (2..5).flat_map(move |x| (4..11).map(move |index| SampleId { x, y, index })))
            .collect();
        assert_eq!(Cursor::new(window, 4..11).collect::<Vec<_>>(), expected, "one by one");
        for most in [1, 3, 7, 10, 100] {
            let (mut cursor, mut found) = (Cursor::new(window, 4..11), Vec::new());
            loop {
                let runs: Vec<_> = cursor.runs(most).collect();
                let total: u32 = runs.iter().map(|(_, count)| count).sum();
                assert!(total <= most, "{total} of {most}");
                if runs.is_empty() {
                    break;
                }
                let run = |(first, count): (SampleId, u32)| {
                    (0..count).map(move |i| SampleId { index: first.index + i, ..first })
                };
                found.extend(runs.into_iter().flat_map(run));
            }
            assert_eq!(found, expected, "{most} at once");
        }
    }
}
