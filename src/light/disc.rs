//! Flat discs, by area.

use crate::light::area::{Asked, Density, SampleArea, SurfacePoint};
use crate::math::Vec3;
use crate::math::lanes::{Isa, Lanes};
use crate::sampling::warp;
use std::f32::consts::PI;

/// A flat disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscArea {
    center: Vec3<f32>,
    normal: Vec3<f32>,
    x: Vec3<f32>,
    y: Vec3<f32>,
    area: f32,
}

impl DiscArea {
    /// From the centre, the unit normal and the radius.
    #[must_use]
    pub fn new(center: glam::Vec3, normal: glam::Vec3, radius: f32) -> Self {
        let (x, y) = normal.any_orthonormal_pair();
        let [center, normal, x, y] = [center, normal, x * radius, y * radius].map(Vec3::from);
        Self { center, normal, x, y, area: PI * radius * radius }
    }

    pub(super) fn center(&self) -> Vec3<f32> {
        self.center
    }

    pub(super) fn radius(&self) -> f32 {
        self.x.length()
    }

    pub(super) fn normal(&self) -> Vec3<f32> {
        self.normal
    }
}

impl SampleArea for DiscArea {
    #[inline(always)]
    fn sample<F: Lanes>(&self, asked: Asked<F>, u2: [F; 2]) -> SurfacePoint<F> {
        let like = asked.from.x;
        let [x, y] = warp::disc(u2);
        let p =
            Vec3::splat(like, self.center) + Vec3::splat(like, self.x) * x + Vec3::splat(like, self.y) * y;
        SurfacePoint {
            p,
            n: Vec3::splat(like, self.normal),
            pdf: like.splat(1.0 / self.area),
            by_angle: like.isa().splat_mask(false),
            radiance: None,
        }
    }

    fn pdf(&self, _asked: Asked<f32>, _prim: u32) -> Density {
        Density::Area(1.0 / self.area)
    }

    fn area(&self) -> f32 {
        self.area
    }
}
