//! Paths that end at random, the less they carry the likelier.

use super::vertex::{Beyond, State, Surroundings};
use super::wave::Slots;
use crate::bsdf::choice::Step;
use crate::math::lanes::{Compare, IntLanes, Isa, Lanes, MaskLanes, WIDEST};
use crate::sampling::{Dim, Sampler, Vertex};

/// The part of what reaches the pixel from which on a path goes on for sure: at 1, as others have it, noise grows more than time
/// shrinks where paths are short; see `benches/record/lights.md`.
const FULL: f32 = 0.25;

/// The least probability with which a path goes on: what survives counts twenty times at most.
const LEAST_SURVIVAL: f32 = 0.05;

/// Ends ways on at random, the less they carry the likelier, and lets the others count for them. How many ended.
///
/// What radiance has grown by on its way through glass is no gain of light: it does not count.
#[inline(always)]
pub(super) fn roulette<S: Isa, const N: usize>(
    isa: S,
    (around, slots, depth): (&Surroundings<'_>, &Slots, u32),
    (lanes, step): (&State<S>, &mut Step<S::F>),
    beyond: &Beyond<N>,
    (sampler, vertex): (&impl Sampler<I = S::I>, Vertex),
) -> u64 {
    if around.roulette.is_none_or(|first| depth < first) {
        return 0;
    }
    let mut carried = (lanes.beta * step.weight).max_channel();
    if around.surfaces.media {
        carried *= radiance_scale(isa, slots, (lanes, step), beyond);
    }
    let survival = (carried * (1.0 / FULL)).clamp(LEAST_SURVIVAL, 1.0);
    let ends = sampler.get_1d(Dim::Roulette, vertex).ge(survival);
    let cut = (step.valid & ends).count() as u64;
    step.valid = step.valid & !ends;
    step.weight *= survival.recip();
    cut
}

/// The squared index of refraction of what each way on goes through: radiance in glass is greater by it, and light that comes out
/// loses it again.
#[inline(always)]
fn radiance_scale<S: Isa, const N: usize>(
    isa: S,
    slots: &Slots,
    (lanes, step): (&State<S>, &Step<S::F>),
    beyond: &Beyond<N>,
) -> S::F {
    let mut names = [0; WIDEST];
    lanes.slot.store(&mut names);
    isa.load(&squared_indices(slots, (&names, step.crosses.bits(), step.valid.bits()), beyond))
}

/// Out of line: scalar work, the same for all instruction sets.
#[inline(never)]
fn squared_indices<const N: usize>(
    slots: &Slots,
    (names, crossing, valid): (&[u32; WIDEST], u32, u32),
    beyond: &Beyond<N>,
) -> [f32; WIDEST] {
    let mut squares = [1.0; WIDEST];
    for (lane, square) in squares.iter_mut().enumerate().take(N) {
        if valid >> lane & 1 == 0 {
            continue;
        }
        let crosses = crossing & beyond.changed;
        let media =
            if crosses >> lane & 1 == 1 { &beyond.media[lane] } else { &slots.media[names[lane] as usize] };
        *square = media.ior() * media.ior();
    }
    squares
}
