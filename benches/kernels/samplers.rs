//! Pairs of numbers of every kind of sampler, as the renderer asks for them.

use crate::support::Race;
use specula::math::lanes::{Isa, Kernel, Lanes, Level, Wrapping};
use specula::sampling::{Dim, Sampler, SamplerKind, Vertex};
use std::hint::black_box;

/// Samples of a pixel.
const SPP: u32 = 64;

/// The kinds, by their names in scene files; numbers of samples that are not powers of two cost strata more.
pub(crate) const KINDS: [(&str, SamplerKind); 6] = [
    ("independent", SamplerKind::Independent),
    ("sobol", SamplerKind::OwenSobol),
    ("blue_noise", SamplerKind::BlueNoise { spp: SPP }),
    ("stratified 64", SamplerKind::Stratified { spp: SPP }),
    ("stratified 100", SamplerKind::Stratified { spp: 100 }),
    ("stratified 67", SamplerKind::Stratified { spp: 67 }),
];

/// Pairs of a pass: whole pixels for sixteen lanes.
const PAIRS: usize = 1 << 18;

/// All levels beside each other; the first one draws for one pixel at a time.
pub(crate) fn race(name: &str, kind: SamplerKind) -> Race<'static> {
    Level::available().into_iter().fold(
        Race::new(format!("sampler {name}"), PAIRS, "pairs"),
        |race, level| {
            race.with(level.name(), move || {
                u64::from(level.run(Draw { kind: black_box(kind), pairs: PAIRS }).to_bits())
            })
        },
    )
}

/// The sum of `pairs` pairs: for neighbouring pixels in the lanes, sample after sample, four purposes each.
struct Draw {
    kind: SamplerKind,
    pairs: usize,
}

impl<S: Isa> Kernel<S> for Draw {
    type Output = f32;
    #[inline(always)]
    fn run(self, isa: S) -> f32 {
        let mut sum = isa.splat(0.0);
        let mut vertex = Vertex::ROOT;
        let (mut x, y) = (isa.iota(), isa.splat_u32(7));
        let per_pixel = SPP as usize * 4;
        for _ in 0..self.pairs / (per_pixel * S::WIDTH) {
            for index in 0..SPP {
                let sampler = self.kind.start(1, [x, y], isa.splat_u32(index));
                for dim in [Dim::Film, Dim::LightPoint(0), Dim::LobeDirection, Dim::Lens] {
                    let [u, v] = sampler.get_2d(dim, vertex);
                    sum += u * v;
                }
            }
            #[expect(clippy::cast_possible_truncation, reason = "sixteen at most")]
            let width = S::WIDTH as u32;
            x = Wrapping::<u32>::wrapping_add(x, width);
            vertex = vertex.child(0);
        }
        // All lanes, lest the compiler leave some out.
        let mut lanes = [0.0; 16];
        sum.store(&mut lanes);
        lanes.iter().sum()
    }
}
