//! Unsigned integer lanes: hashes, indices, bit patterns.

use std::fmt::Debug;
use std::ops::{BitAnd, BitOr, BitXor, Not, Shl, Shr};

use super::{Compare, Isa, Lanes, Select};

/// Arithmetic modulo 2^32 with a value, or with one number for all lanes.
pub trait Wrapping<Rhs = Self> {
    /// self + rhs modulo 2^32.
    fn wrapping_add(self, rhs: Rhs) -> Self;
    /// self - rhs modulo 2^32.
    fn wrapping_sub(self, rhs: Rhs) -> Self;
    /// self * rhs modulo 2^32.
    fn wrapping_mul(self, rhs: Rhs) -> Self;
}

/// Lanes of `u32`. Comparisons are unsigned; shifts are by the same amount in all lanes, which must be below 32.
pub trait IntLanes:
    Select
    + Debug
    + Send
    + Sync
    + 'static
    + Wrapping<Self>
    + Wrapping<u32>
    + Compare<Self>
    + Compare<u32>
    + BitAnd<Self, Output = Self>
    + BitAnd<u32, Output = Self>
    + BitOr<Self, Output = Self>
    + BitOr<u32, Output = Self>
    + BitXor<Self, Output = Self>
    + BitXor<u32, Output = Self>
    + Not<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
    /// Floats of the same width.
    type F: Lanes<Int = Self, Isa = Self::Isa, Mask = Self::Mask>;
    /// The token that makes values of this kind.
    type Isa: Isa<F = Self::F, I = Self, M = Self::Mask>;
    /// The number of lanes.
    const WIDTH: usize;

    /// The token this value was made with.
    fn isa(self) -> Self::Isa;
    /// `x` in all lanes: another value of the same kind.
    fn splat(self, x: u32) -> Self;
    /// The bits in reverse order.
    fn reverse_bits(self) -> Self;
    /// The nearest floats to the lanes read as two's complement.
    fn signed_to_float(self) -> Self::F;
    /// Lane `i`. Slow; for tests and rare cases.
    ///
    /// # Panics
    /// If `i >= WIDTH`.
    fn extract(self, i: usize) -> u32;
    /// Writes all lanes to the first `WIDTH` elements.
    ///
    /// # Panics
    /// If `to` is shorter than `WIDTH`.
    fn store(self, to: &mut [u32]);
    /// The lanes that are set in `mask`, packed to the front in order; what follows them is unspecified.
    fn compress(self, mask: Self::Mask) -> Self;

    /// Random bits as a number in [0, 1): the upper 24 bits times 2^-24, exactly.
    #[inline(always)]
    fn to_unit(self) -> Self::F {
        (self >> 8).signed_to_float() * (1.0 / 16_777_216.0)
    }
}
