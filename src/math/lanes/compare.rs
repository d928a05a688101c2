//! Masks, choice by mask, and comparisons that give masks.

use std::fmt::Debug;
use std::ops::{BitAnd, BitOr, BitXor, Not};

/// One truth value per lane. One lane is `bool`.
pub trait MaskLanes:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
{
    /// True in every lane if `x` is: another mask of the same kind.
    fn splat(self, x: bool) -> Self;
    /// Lane i in bit i; the bits above are zero.
    fn bits(self) -> u32;
    /// Whether some lane is set.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
    /// Whether every lane is set.
    fn all(self) -> bool;
    /// Whether no lane is set.
    #[inline(always)]
    fn none(self) -> bool {
        !self.any()
    }
    /// How many lanes are set.
    #[inline(always)]
    fn count(self) -> usize {
        self.bits().count_ones() as usize
    }
    /// Whether lane `i` is set.
    #[inline(always)]
    fn extract(self, i: usize) -> bool {
        self.bits() >> i & 1 != 0
    }
}

/// Values that can be chosen lane by lane: lanes, and structures made of lanes.
pub trait Select: Copy {
    /// One truth value per lane.
    type Mask: MaskLanes;
    /// `yes` in the lanes where `mask` is set, `no` in the others. Both are computed.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
}

/// Comparisons with a value, or with one number for all lanes.
///
/// As in IEEE 754, comparisons with NaN are false but for `ne`.
pub trait Compare<Rhs = Self>: Select {
    /// self < rhs.
    fn lt(self, rhs: Rhs) -> Self::Mask;
    /// self <= rhs.
    fn le(self, rhs: Rhs) -> Self::Mask;
    /// self > rhs.
    fn gt(self, rhs: Rhs) -> Self::Mask;
    /// self >= rhs.
    fn ge(self, rhs: Rhs) -> Self::Mask;
    /// self = rhs.
    fn eq(self, rhs: Rhs) -> Self::Mask;
    /// self is not rhs.
    fn ne(self, rhs: Rhs) -> Self::Mask;
    /// The smaller; if one is NaN, the other. Which zero is returned for zeros of both signs is unspecified.
    fn min(self, rhs: Rhs) -> Self;
    /// The greater; if one is NaN, the other. Which zero is returned for zeros of both signs is unspecified.
    fn max(self, rhs: Rhs) -> Self;
}
