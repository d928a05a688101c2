//! Laws of the lanes: every width computes what plain `f32` and `u32` compute.

use specula::math::lanes::{
    Compare, IntLanes, Isa, Kernel, Lanes, MaskLanes, Portable, Scalar, Select, Wrapping,
};
use specula::math::{Rgb, Vec3};

struct Shade<'a> {
    from: &'a [f32],
    to: &'a mut [f32],
}

impl<S: Isa> Kernel<S> for Shade<'_> {
    type Output = usize;
    #[inline(always)]
    fn run(self, isa: S) -> usize {
        let mut kept = 0;
        for (i, chunk) in self.from.chunks_exact(S::WIDTH).enumerate() {
            let x = isa.load(chunk);
            let v = Vec3::new(x, x * 0.5 + 1.0, -x);
            let c = Rgb::gray(v.normalize().z).lerp(Rgb::splat(x, Rgb::WHITE), x.max(0.0).min(1.0));
            let m = x.lt(0.5) | x.gt(0.75);
            let hash = (x.to_bits().wrapping_mul(0x9E37_79B9) ^ (x.to_bits() >> 16)).reverse_bits();
            let y = S::F::select(m, c.luminance(), hash.to_unit());
            y.store(&mut self.to[i * S::WIDTH..]);
            kept += (m & isa.first(3)).count();
        }
        kept
    }
}

#[test]
fn generic_code_reads_well() {
    let from: Vec<f32> = (0..64).map(|i| i as f32 / 50.0 - 0.2).collect();
    let (mut a, mut b) = (vec![0.0; 64], vec![0.0; 64]);
    let n = Scalar.run(Shade { from: &from, to: &mut a });
    Portable::<8>.run(Shade { from: &from, to: &mut b });
    assert!(n > 0, "some");
    assert_eq!(a, b, "same operations");
    let x = Portable::<8>.splat(1.0);
    assert!(x.lt(2.0).all(), "lt");
}
