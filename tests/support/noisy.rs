//! Scenes whose noise is of different kinds: even, at highlights, in rare bright samples, in blur.

#![allow(dead_code, reason = "each program uses a part")]

/// A scene by its kind.
pub(crate) struct Noisy {
    pub(crate) name: &'static str,
    /// A relMSE that takes some hundred samples.
    pub(crate) target: f64,
    camera: &'static str,
    body: &'static str,
}

impl Noisy {
    /// Its text, of that size and with those settings.
    pub(crate) fn text(&self, [width, height]: [u32; 2], settings: &str) -> String {
        format!(
            "[camera]\n{}\n[film]\nwidth = {width}\nheight = {height}\n[render]\nintegrator = \"path\"\n{settings}\n{}",
            self.camera, self.body
        )
    }
}

/// All of them.
pub(crate) const ALL: [Noisy; 4] = [
    Noisy { name: "box", target: 6e-3, camera: BOX_CAMERA, body: BOX },
    Noisy { name: "glossy", target: 4e-3, camera: ROW_CAMERA, body: GLOSSY },
    Noisy { name: "caustic", target: 4e-2, camera: ROW_CAMERA, body: CAUSTIC },
    Noisy { name: "lens", target: 4e-2, camera: LENS_CAMERA, body: LENS },
];

const BOX_CAMERA: &str = "from = [0.0, 1.0, 3.4]\nat = [0.0, 1.0, 0.0]\nvfov_deg = 42.0";
const ROW_CAMERA: &str = "from = [0.0, 1.4, 4.0]\nat = [0.0, 0.4, 0.0]\nvfov_deg = 36.0";
const LENS_CAMERA: &str =
    "from = [0.0, 1.0, 4.0]\nat = [0.0, 0.4, 0.0]\nvfov_deg = 36.0\nlens_radius = 0.15\nfocus_distance = 4.0";

/// A room with coloured walls, two blocks and a lamp.
const BOX: &str = r#"
[materials.white]
type = "diffuse"
reflectance = 0.7
[materials.red]
type = "diffuse"
reflectance = [0.6, 0.05, 0.05]
[materials.green]
type = "diffuse"
reflectance = [0.1, 0.5, 0.1]
[[shapes]]
type = "rectangle"
edge_u = [1.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -1.0]
material = "white"
[[shapes]]
type = "rectangle"
center = [0.0, 2.0, 0.0]
edge_u = [1.0, 0.0, 0.0]
edge_v = [0.0, 0.0, 1.0]
material = "white"
[[shapes]]
type = "rectangle"
center = [0.0, 1.0, -1.0]
edge_u = [1.0, 0.0, 0.0]
edge_v = [0.0, 1.0, 0.0]
material = "white"
[[shapes]]
type = "rectangle"
center = [-1.0, 1.0, 0.0]
edge_u = [0.0, 0.0, -1.0]
edge_v = [0.0, 1.0, 0.0]
material = "red"
[[shapes]]
type = "rectangle"
center = [1.0, 1.0, 0.0]
edge_u = [0.0, 0.0, 1.0]
edge_v = [0.0, 1.0, 0.0]
material = "green"
[[shapes]]
type = "box"
min = [-0.6, 0.0, -0.6]
max = [-0.1, 1.1, -0.1]
material = "white"
[[shapes]]
type = "box"
min = [0.1, 0.0, 0.0]
max = [0.6, 0.5, 0.5]
material = "white"
[[lights]]
type = "rectangle"
center = [0.0, 1.99, 0.0]
edge_u = [0.25, 0.0, 0.0]
edge_v = [0.0, 0.0, 0.25]
radiance = [12.0, 10.0, 8.0]
"#;

/// Metal balls of three widths on a matt floor under a lamp and a dim sky.
const GLOSSY: &str = r#"
[materials.floor]
type = "diffuse"
reflectance = 0.4
[materials.narrow]
type = "conductor"
metal = "Au"
alpha = 0.05
[materials.middle]
type = "conductor"
metal = "Ag"
alpha = 0.15
[materials.wide]
type = "conductor"
metal = "Cu"
alpha = 0.4
[[shapes]]
type = "rectangle"
edge_u = [20.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -20.0]
material = "floor"
[[shapes]]
type = "sphere"
center = [-1.0, 0.45, 0.0]
radius = 0.45
material = "narrow"
[[shapes]]
type = "sphere"
center = [0.0, 0.45, 0.0]
radius = 0.45
material = "middle"
[[shapes]]
type = "sphere"
center = [1.0, 0.45, 0.0]
radius = 0.45
material = "wide"
[[lights]]
type = "rectangle"
center = [1.0, 3.0, 1.0]
edge_u = [0.4, 0.0, 0.0]
edge_v = [0.0, 0.0, 0.4]
radiance = 20.0
[[lights]]
type = "environment"
radiance = [0.2, 0.25, 0.3]
"#;

/// A glass ball and a small bright lamp: what the ball gathers is found by chance.
const CAUSTIC: &str = r#"
[materials.floor]
type = "diffuse"
reflectance = 0.6
[materials.glass]
type = "dielectric"
[[shapes]]
type = "rectangle"
edge_u = [20.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -20.0]
material = "floor"
[[shapes]]
type = "sphere"
center = [0.0, 0.5, 0.0]
radius = 0.5
material = "glass"
[[lights]]
type = "sphere"
center = [1.2, 2.4, 0.4]
radius = 0.2
radiance = 60.0
[[lights]]
type = "environment"
radiance = 0.1
"#;

/// Bright small balls before and behind what is in focus.
const LENS: &str = r#"
[materials.floor]
type = "diffuse"
reflectance = { checker = [0.7, 0.1], repeat = [40, 40] }
[materials.shiny]
type = "mirror"
reflectance = 0.9
[materials.lamp]
type = "emission"
radiance = [30.0, 24.0, 12.0]
[materials.clay]
type = "diffuse"
reflectance = [0.5, 0.3, 0.2]
[[shapes]]
type = "rectangle"
edge_u = [10.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -10.0]
material = "floor"
[[shapes]]
type = "sphere"
center = [0.0, 0.4, 0.0]
radius = 0.4
material = "clay"
[[shapes]]
type = "sphere"
center = [-0.8, 0.3, 1.6]
radius = 0.2
material = "shiny"
[[shapes]]
type = "sphere"
center = [1.4, 0.6, -3.0]
radius = 0.12
material = "lamp"
[[shapes]]
type = "sphere"
center = [-1.6, 0.5, -4.0]
radius = 0.12
material = "lamp"
[[lights]]
type = "rectangle"
center = [0.0, 3.0, 1.0]
edge_u = [0.5, 0.0, 0.0]
edge_v = [0.0, 0.0, 0.5]
radiance = 10.0
"#;
