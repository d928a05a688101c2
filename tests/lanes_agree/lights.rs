//! Lights.

use crate::lights_list::lights;
use crate::{Part, Table, agree, viewer};
use specula::light::{Light, LightSample, Reference};
use specula::math::lanes::Lanes;
use specula::math::{Frame, Vec3};

#[test]
fn lights_are_the_same_at_every_width() {
    agree(&Illumination { lights: lights() });
}

/// Lights above a plane.
struct Illumination {
    lights: Vec<(&'static str, Light)>,
}

impl Part for Illumination {
    #[inline(always)]
    fn shade<F: Lanes>(&self, table: &mut Table, input: [F; 8]) {
        let [_, _, u, v, _, k, x, y] = input;
        let (zero, one) = (y.splat(0.0), y.splat(1.0));
        let n = Frame::about(Vec3::new(zero, one, zero)).to_world(viewer(input));
        let at = Reference { p: Vec3::new(x * 3.0, y * 3.0, k.min(2.0)), n };
        for (who, light) in &self.lights {
            table.put_light(who, at, light.sample(at, [u, v]));
            if *who == "strip" {
                let part = (u * 14.0).to_int();
                table.put_light("part of a strip", at, light.sample_part(at, Some(part), [v, u]));
            }
        }
    }
}

impl Table {
    #[inline(always)]
    fn put_light<F: Lanes>(&mut self, who: &str, at: Reference<F>, sample: LightSample<F>) {
        let LightSample { wi, p, li, pdf, valid } = sample;
        let way = p - at.p;
        // At the rim of the sphere the chord vanishes as the root of what 1e-7 is lost of.
        let reach = if who == "sphere" { 2e-3 } else { 1e-5 };
        // Squares of distances and quotients by cosines: 1e-7 beside a cosine of 1e-3 is 1e-4.
        let bound = 3e-4;
        self.put_all([who, "direction"], [1e-5, 1.0], valid, [wi.x, wi.y, wi.z]);
        self.put_all([who, "way"], [reach, 1.0], valid, [way.x, way.y, way.z]);
        self.put_all([who, "density"], [bound, 0.0], valid, [pdf; 3]);
        self.put_all([who, "radiance"], [bound, 0.1], valid, [li.r; 3]);
    }
}
