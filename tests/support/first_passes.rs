//! First passes for the two-pass filter, made by hand.

use glam::Vec3;
use specula::image::Window;
use specula::post::{End, GBuffer, Mirror, Texel};

/// A flat mirror seen straight on from the middle between it and what it mirrors: the eye at z = `s` above the mirror z = 0, and at z = `r` a
/// plane whose light at a point is `light`. `scale` is that of the picture, `size` its columns and rows.
pub(crate) fn facing(
    (size, scale): ([u32; 2], f32),
    (s, r): (f32, f32),
    exponent: f32,
    light: impl Fn(Vec3) -> [f32; 3],
) -> GBuffer {
    let window = Window::whole(size[0], size[1]);
    let texels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
    let texel = |[x, y]: [u32; 2]| {
        let u = (x as f32 + 0.5 - size[0] as f32 * 0.5) / scale;
        let v = (y as f32 + 0.5 - size[1] as f32 * 0.5) / scale;
        let (a, b) = (Vec3::new(u * s, v * s, 0.0), Vec3::new(u * (s + r), v * (s + r), r));
        let mirror = Mirror {
            radiance: light(b),
            factor: [1.0; 3],
            a,
            normal: Vec3::Z,
            end: End::At(b),
            s: a.distance(Vec3::new(0.0, 0.0, s)),
            reflector: 1,
            exponent,
            strength: 1.0,
            hit: 1,
        };
        Texel { mirror: Some(mirror), alpha: 1.0, ..Texel::default() }
    };
    GBuffer { full: size, window, scale, weight: 1.0, texels: texels.map(texel).collect() }
}

/// A flat mirror and a plane before it, r = 1 metre apart, seen by parallel rays that are `pitch` metres apart: windows are the same everywhere.
pub(crate) fn parallel(
    (size, pitch): ([u32; 2], f32),
    exponent: f32,
    light: impl Fn(Vec3) -> [f32; 3],
) -> GBuffer {
    let mut g = facing((size, pitch.recip()), (1.0, 1.0), exponent, |_| [0.0; 3]);
    for mirror in g.texels.iter_mut().filter_map(|texel| texel.mirror.as_mut()) {
        let b = mirror.a + Vec3::Z;
        mirror.end = End::At(b);
        mirror.radiance = light(b);
    }
    g
}

/// A picture in which everything odd happens: two reflectors side by side with holes in them, rays that end where they begin, that go
/// on for ever, that end near and far, normals that jump, exponents from 0 to 1e6. Reflector 1 mirrors `light`.0, reflector 2 `light`.1.
pub(crate) fn odd(size: [u32; 2], light: (f32, f32)) -> GBuffer {
    let mut g = facing((size, 60.0), (1.0, 2.0), 50.0, |_| [0.0; 3]);
    for (i, texel) in (0_u32..).zip(&mut g.texels) {
        let (x, y) = (i % size[0], i / size[0]);
        let Some(mirror) = &mut texel.mirror else { continue };
        mirror.reflector = if x + y / 3 < size[0] / 2 { 1 } else { 2 };
        mirror.radiance = [if mirror.reflector == 1 { light.0 } else { light.1 }; 3];
        mirror.exponent = [0.0, 1.0, 50.0, 1e4, 1e6][(y as usize / 5) % 5];
        match (x / 3 + 5 * (y / 4)) % 7 {
            0 => mirror.end = End::At(mirror.a),
            1 => mirror.end = End::Away(Vec3::new(0.01 * (x as f32 - 30.0), 0.0, 1.0).normalize()),
            2 => mirror.end = End::At(mirror.a + Vec3::new(0.0, 0.0, 1e-6)),
            3 => mirror.end = End::At(mirror.a * 1e6 + Vec3::new(0.0, 0.0, 1e7)),
            4 => mirror.normal = Vec3::new(0.6, 0.0, 0.8),
            5 => mirror.strength = 0.0,
            _ => {}
        }
        if (x * 7 + y * 13) % 11 == 0 {
            texel.mirror = None;
        }
    }
    g
}
