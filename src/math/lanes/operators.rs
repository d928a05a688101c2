//! Operator boilerplate of the wide types, from a few private methods each.
//!
//! The float type has `plus`, `minus`, `times`, `over`, `negated`; the integer type `plus`, `minus`, `times`, `and`,
//! `or`, `xor`; both `is_lt`, `is_le`, `is_gt`, `is_ge`, `is_eq`, `is_ne`, `smaller`, `greater`. The float type has
//! `at_most` and `at_least` besides, which limit by one number and need not look for NaN in every lane of it.

/// Forwards one binary operator to a method, for a value and for one number on the right.
macro_rules! binary_operator {
    ([$($g:tt)*] $t:ty, $scalar:ty, $splat:path, $op:ident :: $method:ident => $own:ident) => {
        impl<$($g)*> std::ops::$op for $t {
            type Output = Self;
            #[inline(always)]
            fn $method(self, rhs: Self) -> Self {
                self.$own(rhs)
            }
        }
        impl<$($g)*> std::ops::$op<$scalar> for $t {
            type Output = Self;
            #[inline(always)]
            fn $method(self, rhs: $scalar) -> Self {
                self.$own($splat(self, rhs))
            }
        }
    };
}

/// Forwards one assigning operator.
macro_rules! assigning_operator {
    ([$($g:tt)*] $t:ty, $op:ident :: $method:ident => $plain:tt) => {
        impl<$($g)*> std::ops::$op for $t {
            #[inline(always)]
            fn $method(&mut self, rhs: Self) {
                *self = *self $plain rhs;
            }
        }
        impl<$($g)*> std::ops::$op<f32> for $t {
            #[inline(always)]
            fn $method(&mut self, rhs: f32) {
                *self = *self $plain rhs;
            }
        }
    };
}

/// Forwards the comparisons, for a value and for one number on the right.
macro_rules! comparisons {
    ([$($g:tt)*] $t:ty, $rhs:ty, |$self:ident, $x:ident| $convert:expr, $min:expr, $max:expr) => {
        impl<$($g)*> $crate::math::lanes::Compare<$rhs> for $t {
            #[inline(always)]
            fn lt($self, $x: $rhs) -> Self::Mask {
                $self.is_lt($convert)
            }
            #[inline(always)]
            fn le($self, $x: $rhs) -> Self::Mask {
                $self.is_le($convert)
            }
            #[inline(always)]
            fn gt($self, $x: $rhs) -> Self::Mask {
                $self.is_gt($convert)
            }
            #[inline(always)]
            fn ge($self, $x: $rhs) -> Self::Mask {
                $self.is_ge($convert)
            }
            #[inline(always)]
            fn eq($self, $x: $rhs) -> Self::Mask {
                $self.is_eq($convert)
            }
            #[inline(always)]
            fn ne($self, $x: $rhs) -> Self::Mask {
                $self.is_ne($convert)
            }
            #[inline(always)]
            fn min($self, $x: $rhs) -> Self {
                $min
            }
            #[inline(always)]
            fn max($self, $x: $rhs) -> Self {
                $max
            }
        }
    };
}

/// All operators of a float type.
macro_rules! float_operators {
    ([$($g:tt)*] $t:ty) => {
        binary_operator!([$($g)*] $t, f32, $crate::math::lanes::Lanes::splat, Add::add => plus);
        binary_operator!([$($g)*] $t, f32, $crate::math::lanes::Lanes::splat, Sub::sub => minus);
        binary_operator!([$($g)*] $t, f32, $crate::math::lanes::Lanes::splat, Mul::mul => times);
        binary_operator!([$($g)*] $t, f32, $crate::math::lanes::Lanes::splat, Div::div => over);
        assigning_operator!([$($g)*] $t, AddAssign::add_assign => +);
        assigning_operator!([$($g)*] $t, SubAssign::sub_assign => -);
        assigning_operator!([$($g)*] $t, MulAssign::mul_assign => *);
        assigning_operator!([$($g)*] $t, DivAssign::div_assign => /);
        comparisons!([$($g)*] $t, $t, |self, x| x, self.smaller(x), self.greater(x));
        comparisons!([$($g)*] $t, f32, |self, x| $crate::math::lanes::Lanes::splat(self, x),
            self.at_most(x), self.at_least(x));
        impl<$($g)*> std::ops::Neg for $t {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                self.negated()
            }
        }
    };
}

/// All operators of an integer type but the shifts.
macro_rules! int_operators {
    ([$($g:tt)*] $t:ty) => {
        binary_operator!([$($g)*] $t, u32, $crate::math::lanes::IntLanes::splat, BitAnd::bitand => and);
        binary_operator!([$($g)*] $t, u32, $crate::math::lanes::IntLanes::splat, BitOr::bitor => or);
        binary_operator!([$($g)*] $t, u32, $crate::math::lanes::IntLanes::splat, BitXor::bitxor => xor);
        comparisons!([$($g)*] $t, $t, |self, x| x, self.smaller(x), self.greater(x));
        comparisons!([$($g)*] $t, u32, |self, x| $crate::math::lanes::IntLanes::splat(self, x),
            self.smaller($crate::math::lanes::IntLanes::splat(self, x)),
            self.greater($crate::math::lanes::IntLanes::splat(self, x)));
        impl<$($g)*> std::ops::Not for $t {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                self ^ u32::MAX
            }
        }
        wrapping!([$($g)*] $t, $t, |self, x| x);
        wrapping!([$($g)*] $t, u32, |self, x| $crate::math::lanes::IntLanes::splat(self, x));
    };
}

/// Forwards the wrapping arithmetic.
macro_rules! wrapping {
    ([$($g:tt)*] $t:ty, $rhs:ty, |$self:ident, $x:ident| $convert:expr) => {
        impl<$($g)*> $crate::math::lanes::Wrapping<$rhs> for $t {
            #[inline(always)]
            fn wrapping_add($self, $x: $rhs) -> Self {
                $self.plus($convert)
            }
            #[inline(always)]
            fn wrapping_sub($self, $x: $rhs) -> Self {
                $self.minus($convert)
            }
            #[inline(always)]
            fn wrapping_mul($self, $x: $rhs) -> Self {
                $self.times($convert)
            }
        }
    };
}

/// The operators of a mask type, from `and`, `or`, `xor`.
macro_rules! mask_operators {
    ([$($g:tt)*] $t:ty) => {
        mask_operators!([$($g)*] $t, BitAnd::bitand => and);
        mask_operators!([$($g)*] $t, BitOr::bitor => or);
        mask_operators!([$($g)*] $t, BitXor::bitxor => xor);
        impl<$($g)*> std::ops::Not for $t {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                self ^ $crate::math::lanes::MaskLanes::splat(self, true)
            }
        }
    };
    ([$($g:tt)*] $t:ty, $op:ident :: $method:ident => $own:ident) => {
        impl<$($g)*> std::ops::$op for $t {
            type Output = Self;
            #[inline(always)]
            fn $method(self, rhs: Self) -> Self {
                self.$own(rhs)
            }
        }
    };
}
