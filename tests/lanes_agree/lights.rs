//! Lights.

use crate::{Part, Table, agree, viewer};
use specula::image::Image;
use specula::light::{
    Area, Directional, DiscArea, Environment, EnvironmentMap, Light, LightSample, MeshArea, Point,
    RectangleArea, Reference, SphereLight, Spot, spot_cosines,
};
use specula::math::lanes::Lanes;
use specula::math::{Frame, Rgb, Vec3};

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

fn lights() -> Vec<(&'static str, Light)> {
    use glam::Vec3 as P;
    let radiance = Rgb::gray(2.0);
    let rectangle = RectangleArea::new(P::new(0.5, 4.0, 0.0), P::X * 0.5, P::Z);
    let mesh =
        MeshArea::new(vec![[P::Y * 5.0, P::new(1.0, 5.0, 0.0), P::new(0.0, 5.0, 2.0)]]).expect("has area");
    let pixels = (0..128_u16).map(|i| Rgb::gray(f32::from(i % 13))).collect();
    let picture =
        EnvironmentMap::new(Image::from_pixels(16, 8, pixels).expect("fits"), 1.0, 0.3).expect("shines");
    let position = Vec3::new(0.0, 4.0, 1.0);
    let [cos_outer, cos_inner] = spot_cosines(0.9, 0.5);
    let axis = Vec3::new(0.0, -1.0, 0.0);
    vec![
        ("rectangle", Light::Rectangle(Area { surface: rectangle, radiance, two_sided: true })),
        (
            "disc",
            Light::Disc(Area {
                surface: DiscArea::new(P::Y * 5.0, P::NEG_Y, 1.0),
                radiance,
                two_sided: false,
            }),
        ),
        ("mesh", Light::Mesh(Area { surface: mesh, radiance, two_sided: true })),
        ("sphere", Light::Sphere(SphereLight { center: position, radius: 0.5, radiance })),
        ("point", Light::Point(Point { position, intensity: radiance })),
        ("spot", Light::Spot(Spot { position, axis, intensity: radiance, cos_outer, cos_inner })),
        ("sun", Light::Directional(Directional { direction: axis, irradiance: radiance })),
        ("sky", Light::Environment(Environment::Constant(radiance))),
        ("picture", Light::Environment(Environment::Map(Box::new(picture)))),
    ]
}
