//! Reference numbers of 200 bits: what cancels in them leaves more digits than a float has.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::LazyLock;

const BITS: usize = 200;

/// A number of 200 bits; its exponent neither over- nor underflows.
#[derive(Clone, Debug, PartialEq, PartialOrd)]
pub(crate) struct Big(FBig<HalfEven, 2>);

/// Exactly `x`, which must be finite.
pub(crate) fn big(x: f64) -> Big {
    let exact = FBig::try_from(x).expect("references are of finite numbers");
    Big(exact.with_precision(BITS).value())
}

impl Big {
    /// Zero below zero.
    pub(crate) fn sqrt(&self) -> Self {
        if *self <= big(0.0) { big(0.0) } else { Self(self.0.sqrt()) }
    }
    pub(crate) fn exp(&self) -> Self {
        Self(self.0.exp())
    }
    /// Very small at zero and below, where the logarithm is not.
    pub(crate) fn ln(&self) -> Self {
        if *self <= big(0.0) { big(-1e30) } else { Self(self.0.ln()) }
    }
    /// The angle in [0, pi] of this cosine in [-1, 1].
    pub(crate) fn acos(&self) -> Self {
        if *self >= big(1.0) {
            big(0.0)
        } else if *self <= big(-1.0) {
            pi()
        } else if self.is_positive() {
            Self(self.0.acos())
        } else {
            pi() - Self((-self).0.acos())
        }
    }
    /// The angle of this tangent, in (-pi/2, pi/2).
    pub(crate) fn atan(&self) -> Self {
        let angle = (big(1.0) / (self.square() + 1.0).sqrt()).acos();
        if self.is_positive() { angle } else { -angle }
    }
    /// The same as an `f32`.
    pub(crate) fn to_f32(&self) -> f32 {
        self.to_f64() as f32
    }
    /// The greater of both.
    pub(crate) fn max(&self, other: &Self) -> Self {
        if self > other { self.clone() } else { other.clone() }
    }
    /// The smaller of both.
    pub(crate) fn min(&self, other: &Self) -> Self {
        if self < other { self.clone() } else { other.clone() }
    }
    /// Sine and cosine of that many turns.
    pub(crate) fn sin_cos_turns(&self) -> [Self; 2] {
        let (sin, cos) = self.0.sin_cos_unit(1);
        [Self(sin), Self(cos)]
    }
    pub(crate) fn square(&self) -> Self {
        self * self
    }
    pub(crate) fn abs(&self) -> Self {
        if *self < big(0.0) { -self } else { self.clone() }
    }
    pub(crate) fn to_f64(&self) -> f64 {
        self.0.to_f64().value()
    }
    pub(crate) fn is_positive(&self) -> bool {
        *self > big(0.0)
    }
}

/// The circle's number: Newton's method on tan x = 1.
pub(crate) fn pi() -> Big {
    static PI: LazyLock<Big> = LazyLock::new(|| {
        let mut x = big(std::f64::consts::FRAC_PI_4);
        for _ in 0..3 {
            let (sin, cos) = x.0.sin_cos();
            let (sin, cos) = (Big(sin), Big(cos));
            x = x - (&sin - &cos) / (&sin + &cos);
        }
        x * 4.0
    });
    PI.clone()
}

/// The error function, for `x` in [0, 6]: the series of positive terms (Abramowitz and Stegun 1964, eq. 7.1.6); beyond, where
/// 1e-16 is missing, 1.
pub(crate) fn erf(x: &Big) -> Big {
    if *x > big(6.0) {
        return big(1.0);
    }
    let square2 = x.square() * 2.0;
    let (mut term, mut sum, mut odd) = (x.clone(), x.clone(), 1.0);
    while term > &sum * 1e-50 {
        odd += 2.0;
        term = term * &square2 / odd;
        sum = sum + &term;
    }
    sum * 2.0 * (-x.square()).exp() / pi().sqrt()
}

macro_rules! operator {
    ($op:ident, $method:ident) => {
        impl $op<&Big> for &Big {
            type Output = Big;
            fn $method(self, b: &Big) -> Big {
                Big($op::$method(&self.0, &b.0))
            }
        }
        impl $op<Big> for &Big {
            type Output = Big;
            fn $method(self, b: Big) -> Big {
                $op::$method(self, &b)
            }
        }
        impl $op<&Big> for Big {
            type Output = Big;
            fn $method(self, b: &Big) -> Big {
                $op::$method(&self, b)
            }
        }
        impl $op<Big> for Big {
            type Output = Big;
            fn $method(self, b: Big) -> Big {
                $op::$method(&self, &b)
            }
        }
        impl $op<f64> for &Big {
            type Output = Big;
            fn $method(self, b: f64) -> Big {
                $op::$method(self, &big(b))
            }
        }
        impl $op<f64> for Big {
            type Output = Big;
            fn $method(self, b: f64) -> Big {
                $op::$method(&self, &big(b))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for &Big {
    type Output = Big;
    fn neg(self) -> Big {
        Big(-&self.0)
    }
}
impl Neg for Big {
    type Output = Self;
    fn neg(self) -> Self {
        -&self
    }
}

/// The scalar product.
pub(crate) fn dot(a: &[Big], b: &[Big]) -> Big {
    a.iter().zip(b).fold(big(0.0), |sum, (a, b)| sum + a * b)
}

/// The vector of length 1.
pub(crate) fn unit(a: &[Big]) -> Vec<Big> {
    let length = dot(a, a).sqrt();
    a.iter().map(|x| x / &length).collect()
}

/// The vector product.
pub(crate) fn cross(a: &[Big], b: &[Big]) -> Vec<Big> {
    [(1, 2), (2, 0), (0, 1)].iter().map(|&(i, j)| &a[i] * &b[j] - &a[j] * &b[i]).collect()
}

/// `a + t b`.
pub(crate) fn along(a: &[Big], t: &Big, b: &[Big]) -> Vec<Big> {
    a.iter().zip(b).map(|(a, b)| a + t * b).collect()
}

/// `a - b`.
pub(crate) fn minus(a: &[Big], b: &[Big]) -> Vec<Big> {
    along(a, &big(-1.0), b)
}
