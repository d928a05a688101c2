//! A light of every kind.

use specula::image::Image;
use specula::light::{
    Area, Directional, DiscArea, Environment, EnvironmentMap, Light, MeshArea, Point, RectangleArea,
    SphereLight, Spot, spot_versines,
};
use specula::math::{Rgb, Vec3};

/// All of them, with names, above the plane y = 0.
pub(crate) fn lights() -> Vec<(&'static str, Light)> {
    use glam::Vec3 as P;
    let radiance = Rgb::gray(2.0);
    let rectangle = RectangleArea::new(P::new(0.5, 4.0, 0.0), P::X * 0.5, P::Z);
    let mesh =
        MeshArea::new(vec![[P::Y * 5.0, P::new(1.0, 5.0, 0.0), P::new(0.0, 5.0, 2.0)]]).expect("has area");
    let gable = {
        let [a, b, c] = [P::new(-1.0, 4.0, 0.0), P::new(1.0, 4.0, 0.0), P::new(0.0, 5.0, 0.5)];
        let d = P::new(0.0, 4.0, 2.0);
        MeshArea::new(vec![[a, c, b], [a, b, d], [b, c, d]]).expect("has area")
    };
    let strip = {
        let p = |i: u16| P::new(f32::from(i) * 0.3, 4.0 + f32::from(i) * 0.1, f32::from(i % 2));
        MeshArea::new((0..14).map(|i| [p(i), p(i + 1), p(i + 2)]).collect()).expect("has area")
    };
    let pixels = (0..128_u16).map(|i| Rgb::gray(f32::from(i % 13))).collect();
    let picture =
        EnvironmentMap::new(Image::from_pixels(16, 8, pixels).expect("fits"), 1.0, 0.3).expect("shines");
    let position = Vec3::new(0.0, 4.0, 1.0);
    let [versine_outer, versine_inner] = spot_versines(0.9, 0.5);
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
        ("gable", Light::Mesh(Area { surface: gable, radiance, two_sided: false })),
        ("strip", Light::Mesh(Area { surface: strip, radiance, two_sided: true })),
        ("sphere", Light::Sphere(SphereLight { center: position, radius: 0.5, radiance, two_sided: false })),
        ("point", Light::Point(Point { position, intensity: radiance })),
        ("spot", Light::Spot(Spot { position, axis, intensity: radiance, versine_outer, versine_inner })),
        ("sun", Light::Directional(Directional { direction: axis, irradiance: radiance })),
        ("sky", Light::Environment(Environment::Constant(radiance))),
        ("picture", Light::Environment(Environment::Map(std::sync::Arc::new(picture)))),
    ]
}
