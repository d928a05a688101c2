//! Small scenes with files.

#![allow(dead_code, reason = "each test program uses a part")]

use crate::desk::Desk;
use image::RgbImage;

/// A scene of a mesh whose materials name `inner.png`, a wall with `paint.png`, and a ball that `keys` may move, seen by a camera that moves.
pub(crate) fn scene(keys: &str) -> String {
    format!(
        r#"
[camera]
fps = 10.0
shutter_close_s = 0.05
keys = [{{ time_s = -1.0, from = [-1.0, 1.0, 4.0] }}, {{ time_s = 1.0, from = [1.0, 1.0, 4.0] }}]
[film]
width = 16
height = 12
[render]
integrator = "path"
spp = 2
[materials.wall]
type = "diffuse"
reflectance = {{ file = "paint.png" }}
[materials.glass]
type = "dielectric"
[[shapes]]
type = "mesh"
file = "model.obj"
[[shapes]]
type = "rectangle"
center = [0.0, 0.0, -2.0]
edge_u = [4.0, 0.0, 0.0]
edge_v = [0.0, 3.0, 0.0]
material = "wall"
[[shapes]]
type = "sphere"
radius = 0.4
material = "glass"
{keys}
[[lights]]
type = "environment"
radiance = 1.0
"#
    )
}

/// Moves the ball.
pub(crate) const KEYS: &str = r#"keys = [
    { time_s = -1.0, transform = [{ translate = [-1.0, 0.5, 0.0] }] },
    { time_s = 1.0, transform = [{ translate = [1.0, 0.5, 0.0] }] },
]"#;

/// A directory with `model.toml`, in which a ball moves, `still.toml`, in which nothing but the camera does, and their files.
pub(crate) fn desk() -> Desk {
    let desk = Desk::new();
    write(&desk, "model.toml", &scene(KEYS));
    write(&desk, "still.toml", &scene(""));
    write(&desk, "model.mtl", "newmtl red\nKd 0.8 0.1 0.1\nmap_Kd inner.png\n");
    let mesh = "mtllib model.mtl\nusemtl red\nv -1 0 -1\nv 1 0 -1\nv 0 1.5 -1\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    write(&desk, "model.obj", mesh);
    paint(&desk, "paint.png", [200, 100, 50]);
    paint(&desk, "inner.png", [50, 100, 200]);
    desk
}

pub(crate) fn write(desk: &Desk, name: &str, text: &str) {
    std::fs::write(desk.path(name), text).expect("written");
}

pub(crate) fn read(desk: &Desk, name: &str) -> Vec<u8> {
    std::fs::read(desk.path(name)).expect("readable")
}

/// A picture of one colour.
pub(crate) fn paint(desk: &Desk, name: &str, color: [u8; 3]) {
    RgbImage::from_pixel(4, 4, image::Rgb(color)).save(desk.path(name)).expect("written");
}
