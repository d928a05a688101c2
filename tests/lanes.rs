//! Laws of the lanes: every width computes, lane by lane, what plain `f32` and `u32` compute.

use specula::math::lanes::{
    Compare, IntLanes, Isa, Kernel, Lanes, Level, MaskLanes, Portable, Select, Wrapping,
};

/// Numbers where implementations tend to differ.
const FLOATS: [f32; 32] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    1.5,
    2.5,
    -2.5,
    0.499_999_97,
    3.0,
    -7.25,
    1e-3,
    1e-20,
    -1e-30,
    1e30,
    -1e38,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-45,
    -1e-40,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    8_388_607.5,
    8_388_609.0,
    -16_777_217.0,
    123_456.79,
    std::f32::consts::PI,
    -0.333_333_34,
    65_504.0,
];

const INTS: [u32; 32] = [
    0,
    1,
    2,
    3,
    7,
    31,
    32,
    255,
    256,
    65_535,
    65_536,
    0x7FFF_FFFF,
    0x8000_0000,
    0x8000_0001,
    0xFFFF_FFFF,
    0xFFFF_FFFE,
    0x0F0F_0F0F,
    0xF0F0_F0F0,
    0x1234_5678,
    0x9E37_79B9,
    0xDEAD_BEEF,
    0x0000_FF00,
    0x00FF_0000,
    0xAAAA_AAAA,
    0x5555_5555,
    747_796_405,
    2_891_336_453,
    99,
    1000,
    0x0100_0000,
    0x00FF_FFFF,
    0xC000_0000,
];

/// Runs a kernel at every level of this machine and at odd widths, printing what is missing.
macro_rules! at_every_width {
    ($kernel:expr) => {
        for level in Level::available() {
            level.run($kernel);
        }
        Portable::<4>.run($kernel);
        Portable::<16>.run($kernel);
        if Level::named("avx512").is_err() {
            println!("skipped: this machine has no AVX-512");
        }
    };
}

/// The same number, or both NaN. Zeros of both signs differ unless `loose`.
fn same(a: f32, b: f32, loose: bool) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()) || (loose && a == 0.0 && b == 0.0)
}

#[inline(always)]
fn check<S: Isa>(what: &str, wide: S::F, loose: bool, narrow: impl Fn(usize) -> f32) {
    for i in 0..S::WIDTH {
        let (w, n) = (wide.extract(i), narrow(i));
        assert!(same(w, n, loose), "{} {what}: lane {i} is {w:e}, not {n:e}", S::NAME);
    }
}

#[inline(always)]
fn check_u32<S: Isa>(what: &str, wide: S::I, narrow: impl Fn(usize) -> u32) {
    for i in 0..S::WIDTH {
        let (w, n) = (wide.extract(i), narrow(i));
        assert_eq!(w, n, "{} {what}: lane {i}", S::NAME);
    }
}

#[inline(always)]
fn check_mask<S: Isa>(what: &str, wide: S::M, narrow: impl Fn(usize) -> bool) {
    let mut count = 0;
    for i in 0..S::WIDTH {
        assert_eq!(wide.extract(i), narrow(i), "{} {what}: lane {i}", S::NAME);
        count += usize::from(narrow(i));
    }
    assert_eq!(wide.count(), count, "{} {what}: count", S::NAME);
    assert_eq!(wide.any(), count > 0, "{} {what}: any", S::NAME);
    assert_eq!(wide.none(), count == 0, "{} {what}: none", S::NAME);
    assert_eq!(wide.all(), count == S::WIDTH, "{} {what}: all", S::NAME);
}

/// Every list element beside every other: pairs (a, b) with b rotated by all amounts.
fn pairs<T: Copy>(list: &[T], turn: usize) -> (Vec<T>, Vec<T>) {
    let mut turned = list.to_vec();
    turned.rotate_left(turn);
    (list.to_vec(), turned)
}

struct FloatOperators;

impl<S: Isa> Kernel<S> for FloatOperators {
    type Output = ();
    #[inline(always)]
    fn run(self, isa: S) {
        for turn in 0..FLOATS.len() {
            let (a, b) = pairs(&FLOATS, turn);
            for at in (0..a.len()).step_by(S::WIDTH) {
                let (a, b) = (&a[at..], &b[at..]);
                float_binary::<S>(isa.load(a), isa.load(b), a, b);
                float_limits::<S>(isa.load(a), isa.load(b), a, b);
                float_by_number::<S>(isa.load(a), a, b[0]);
            }
        }
        for a in FLOATS.chunks_exact(S::WIDTH) {
            float_unary::<S>(isa.load(a), a);
        }
    }
}

#[inline(always)]
#[expect(clippy::float_cmp, reason = "the operator itself is under test")]
fn float_binary<S: Isa>(x: S::F, y: S::F, a: &[f32], b: &[f32]) {
    check::<S>("+", x + y, false, |i| a[i] + b[i]);
    check::<S>("-", x - y, false, |i| a[i] - b[i]);
    check::<S>("*", x * y, false, |i| a[i] * b[i]);
    check::<S>("/", x / y, false, |i| a[i] / b[i]);
    check::<S>("copysign", x.copysign(y), false, |i| a[i].copysign(b[i]));
    check::<S>("flip_sign", x.flip_sign(y), false, |i| if b[i].is_sign_negative() { -a[i] } else { a[i] });
    check_mask::<S>("<", x.lt(y), |i| a[i] < b[i]);
    check_mask::<S>("<=", x.le(y), |i| a[i] <= b[i]);
    check_mask::<S>(">", x.gt(y), |i| a[i] > b[i]);
    check_mask::<S>(">=", x.ge(y), |i| a[i] >= b[i]);
    check_mask::<S>("==", x.eq(y), |i| a[i] == b[i]);
    check_mask::<S>("!=", x.ne(y), |i| a[i] != b[i]);
    let select = S::F::select(x.lt(y), x, y);
    check::<S>("select", select, false, |i| if a[i] < b[i] { a[i] } else { b[i] });
}

#[inline(always)]
fn float_limits<S: Isa>(x: S::F, y: S::F, a: &[f32], b: &[f32]) {
    check::<S>("min", x.min(y), true, |i| a[i].min(b[i]));
    check::<S>("max", x.max(y), true, |i| a[i].max(b[i]));
    for c in [0.75, -3.0] {
        let z = x.mul_add(y, x.splat(c));
        for i in 0..S::WIDTH {
            let (once, twice) = (a[i].mul_add(b[i], c), a[i] * b[i] + c);
            let got = z.extract(i);
            assert!(same(got, once, false) || same(got, twice, false), "{}: {got:e}", S::NAME);
        }
    }
}

#[inline(always)]
#[expect(clippy::float_cmp, reason = "the operator itself is under test")]
fn float_by_number<S: Isa>(x: S::F, a: &[f32], b: f32) {
    check::<S>("+ number", x + b, false, |i| a[i] + b);
    check::<S>("- number", x - b, false, |i| a[i] - b);
    check::<S>("* number", x * b, false, |i| a[i] * b);
    check::<S>("/ number", x / b, false, |i| a[i] / b);
    check::<S>("min number", x.min(b), true, |i| a[i].min(b));
    check::<S>("max number", x.max(b), true, |i| a[i].max(b));
    check_mask::<S>("< number", x.lt(b), |i| a[i] < b);
    check_mask::<S>("!= number", x.ne(b), |i| a[i] != b);
    let mut sum = x;
    sum += b;
    sum *= x;
    sum -= x;
    sum /= b;
    check::<S>("assigning operators", sum, false, |i| ((a[i] + b) * a[i] - a[i]) / b);
}

#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the conversion itself is under test")]
fn float_unary<S: Isa>(x: S::F, a: &[f32]) {
    check::<S>("neg", -x, false, |i| -a[i]);
    check::<S>("abs", x.abs(), false, |i| a[i].abs());
    check::<S>("sqrt", x.sqrt(), false, |i| a[i].sqrt());
    check::<S>("floor", x.floor(), false, |i| a[i].floor());
    check::<S>("round", x.round_ties_even(), false, |i| a[i].round_ties_even());
    check::<S>("recip", x.recip(), false, |i| 1.0 / a[i]);
    check::<S>("rsqrt", x.rsqrt(), false, |i| 1.0 / a[i].sqrt());
    check::<S>(
        "clamp",
        x.clamp(-2.0, 3.0),
        true,
        |i| if a[i].is_nan() { -2.0 } else { a[i].clamp(-2.0, 3.0) },
    );
    check_mask::<S>("is_finite", x.is_finite(), |i| a[i].is_finite());
    check_u32::<S>("to_bits", x.to_bits(), |i| a[i].to_bits());
    check::<S>("from_bits", S::F::from_bits(x.to_bits()), false, |i| a[i]);
    let small = S::F::select(x.abs().lt(2e9), x, x.splat(0.0));
    check_u32::<S>("to_int", small.to_int(), |i| {
        if a[i].abs() < 2e9 { (a[i] as i32).cast_unsigned() } else { 0 }
    });
}

#[test]
fn floats_compute_as_f32_does() {
    at_every_width!(FloatOperators);
}

struct IntOperators;

impl<S: Isa> Kernel<S> for IntOperators {
    type Output = ();
    #[inline(always)]
    fn run(self, isa: S) {
        for turn in 0..INTS.len() {
            let (a, b) = pairs(&INTS, turn);
            for at in (0..a.len()).step_by(S::WIDTH) {
                let (a, b) = (&a[at..], &b[at..]);
                int_binary::<S>(isa.load_u32(a), isa.load_u32(b), a, b);
                int_by_number::<S>(isa.load_u32(a), a, b[0]);
            }
        }
        for a in INTS.chunks_exact(S::WIDTH) {
            int_unary::<S>(isa.load_u32(a), a);
        }
    }
}

#[inline(always)]
fn int_binary<S: Isa>(x: S::I, y: S::I, a: &[u32], b: &[u32]) {
    check_u32::<S>("+", x.wrapping_add(y), |i| a[i].wrapping_add(b[i]));
    check_u32::<S>("-", x.wrapping_sub(y), |i| a[i].wrapping_sub(b[i]));
    check_u32::<S>("*", x.wrapping_mul(y), |i| a[i].wrapping_mul(b[i]));
    check_u32::<S>("&", x & y, |i| a[i] & b[i]);
    check_u32::<S>("|", x | y, |i| a[i] | b[i]);
    check_u32::<S>("^", x ^ y, |i| a[i] ^ b[i]);
    check_u32::<S>("min", x.min(y), |i| Ord::min(a[i], b[i]));
    check_u32::<S>("max", x.max(y), |i| Ord::max(a[i], b[i]));
    check_mask::<S>("<", x.lt(y), |i| a[i] < b[i]);
    check_mask::<S>("<=", x.le(y), |i| a[i] <= b[i]);
    check_mask::<S>(">", x.gt(y), |i| a[i] > b[i]);
    check_mask::<S>(">=", x.ge(y), |i| a[i] >= b[i]);
    check_mask::<S>("==", x.eq(y), |i| a[i] == b[i]);
    check_mask::<S>("!=", x.ne(y), |i| a[i] != b[i]);
    check_mask::<S>("& of masks", x.lt(y) & x.ne(1), |i| a[i] < b[i] && a[i] != 1);
    check_mask::<S>("| of masks", x.lt(y) | x.eq(1), |i| a[i] < b[i] || a[i] == 1);
    check_mask::<S>("^ of masks", x.lt(y) ^ x.gt(9), |i| (a[i] < b[i]) != (a[i] > 9));
    check_mask::<S>("! of a mask", !x.lt(y), |i| a[i] >= b[i]);
    check_mask::<S>("splat of a mask", x.lt(y).splat(true), |_| true);
    let select = S::I::select(x.lt(y), x, y);
    check_u32::<S>("select", select, |i| if a[i] < b[i] { a[i] } else { b[i] });
}

#[inline(always)]
fn int_by_number<S: Isa>(x: S::I, a: &[u32], b: u32) {
    check_u32::<S>("+ number", x.wrapping_add(b), |i| a[i].wrapping_add(b));
    check_u32::<S>("- number", x.wrapping_sub(b), |i| a[i].wrapping_sub(b));
    check_u32::<S>("* number", x.wrapping_mul(b), |i| a[i].wrapping_mul(b));
    check_u32::<S>("& number", x & b, |i| a[i] & b);
    check_u32::<S>("| number", x | b, |i| a[i] | b);
    check_u32::<S>("^ number", x ^ b, |i| a[i] ^ b);
    check_u32::<S>("<<", x << (b % 32), |i| a[i] << (b % 32));
    check_u32::<S>(">>", x >> (b % 32), |i| a[i] >> (b % 32));
    check_mask::<S>("< number", x.lt(b), |i| a[i] < b);
    check_mask::<S>(">= number", x.ge(b), |i| a[i] >= b);
}

#[inline(always)]
fn int_unary<S: Isa>(x: S::I, a: &[u32]) {
    check_u32::<S>("!", !x, |i| !a[i]);
    check_u32::<S>("reverse_bits", x.reverse_bits(), |i| a[i].reverse_bits());
    check_u32::<S>("splat", x.splat(77), |_| 77);
    check::<S>("signed_to_float", x.signed_to_float(), false, |i| a[i].cast_signed() as f32);
    check::<S>("to_unit", x.to_unit(), false, |i| (a[i] >> 8) as f32 / 16_777_216.0);
}

#[test]
fn integers_compute_as_u32_does() {
    at_every_width!(IntOperators);
}

struct Memory;

impl<S: Isa> Kernel<S> for Memory {
    type Output = ();
    #[inline(always)]
    fn run(self, isa: S) {
        check_u32::<S>("iota", isa.iota(), |i| u32::try_from(i).expect("few lanes"));
        for n in 0..40 {
            check_mask::<S>("first", isa.first(n), |i| i < n);
            let partial = isa.load_partial(&FLOATS[..n.min(32)]);
            check::<S>("load_partial", partial, false, |i| if i < n { FLOATS[i] } else { 0.0 });
            let partial = isa.load_partial_u32(&INTS[..n.min(32)]);
            check_u32::<S>("load_partial", partial, |i| if i < n { INTS[i] } else { 0 });
        }
        for index in INTS.chunks_exact(S::WIDTH) {
            let wide = isa.load_u32(index);
            for len in [0, 1, 8, 32] {
                let found = |i: usize| (index[i] as usize) < len;
                check::<S>("gather", isa.gather(&FLOATS[..len], wide), false, |i| {
                    if found(i) { FLOATS[index[i] as usize] } else { 0.0 }
                });
                check_u32::<S>("gather", isa.gather_u32(&INTS[..len], wide), |i| {
                    if found(i) { INTS[index[i] as usize] } else { 0 }
                });
                rows::<S>(isa, len / 3, index);
                quads::<S>(isa, len / 4, index);
            }
        }
        compress::<S>(isa);
    }
}

/// Rows of three from a table of so many, within it and beyond, where indices times three wrap as well.
#[inline(always)]
fn rows<S: Isa>(isa: S, len: usize, index: &[u32]) {
    let (floats, ints) = (&FLOATS.as_chunks::<3>().0[..len], &INTS.as_chunks::<3>().0[..len]);
    let count = u32::try_from(len).expect("a small table");
    let near = |i: usize, name: u32| if count == 0 || i == 3 { name } else { name % count };
    for names in [
        isa.load_u32(index),
        isa.per_lane_u32(|i| index[i] % Ord::max(count, 1)),
        isa.per_lane_u32(|i| near(i, index[i])),
        isa.splat_u32(0x5555_5556),
    ] {
        let (of_floats, of_ints) = (isa.gather_rows(floats, names), isa.gather_rows_u32(ints, names));
        for k in 0..3 {
            check::<S>("gather_rows", of_floats[k], false, |i| {
                floats.get(names.extract(i) as usize).map_or(0.0, |row| row[k])
            });
            check_u32::<S>("gather_rows_u32", of_ints[k], |i| {
                ints.get(names.extract(i) as usize).map_or(0, |row| row[k])
            });
        }
    }
}

/// Rows of four, as those of three.
#[inline(always)]
fn quads<S: Isa>(isa: S, len: usize, index: &[u32]) {
    let floats = &FLOATS.as_chunks::<4>().0[..len];
    let count = u32::try_from(len).expect("a small table");
    for names in [
        isa.load_u32(index),
        isa.per_lane_u32(|i| index[i] % Ord::max(count, 1)),
        isa.per_lane_u32(|i| if count == 0 || i == 3 { index[i] } else { index[i] % count }),
        isa.splat_u32(0x4000_0001),
    ] {
        let found = isa.gather_quads(floats, names);
        for (k, column) in found.into_iter().enumerate() {
            check::<S>("gather_quads", column, false, |i| {
                floats.get(names.extract(i) as usize).map_or(0.0, |row| row[k])
            });
        }
    }
}

/// All masks of eight lanes, and as many patterns for more.
#[inline(always)]
fn compress<S: Isa>(isa: S) {
    for pattern in 0..256_u32 {
        let bits = pattern | pattern.reverse_bits() >> 16;
        let mask = isa.per_lane_u32(|i| bits >> i & 1).ne(0);
        assert_eq!(mask.bits(), bits & (u32::MAX >> (32 - S::WIDTH)), "{}: bits", S::NAME);
        let (mut floats, mut ints) = (vec![0.0; S::WIDTH], vec![0; S::WIDTH]);
        isa.load(&FLOATS).compress(mask).store(&mut floats);
        isa.load_u32(&INTS).compress(mask).store(&mut ints);
        let kept: Vec<usize> = (0..S::WIDTH).filter(|&i| mask.extract(i)).collect();
        for (at, &i) in kept.iter().enumerate() {
            assert!(same(floats[at], FLOATS[i], false), "{}: {pattern:08b} lane {i}", S::NAME);
            assert_eq!(ints[at], INTS[i], "{}: {pattern:08b} lane {i}", S::NAME);
        }
    }
}

#[test]
fn memory_is_read_and_written_in_order() {
    at_every_width!(Memory);
}
