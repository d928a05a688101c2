//! A scene looks the same wherever it stands and whatever its unit is: carried far from the origin, and enlarged or shrunk by
//! powers of two, with everything that has a length in its unit. Random numbers are the same, so pictures can be compared
//! pixel by pixel.

use glam::DVec3;
use specula::film::{Aov, Layout};
use specula::light::Light;
use specula::render::{Settings, Silent, render};
use specula::scene::description::Normals;
use specula::scene::load::load_mesh;
use specula::scene::{self, Built};
use std::fmt::Write as _;
use std::path::Path;

/// How a scene is carried away: a place p becomes s p + t.
#[derive(Clone, Copy)]
struct Away {
    s: f64,
    t: [f64; 3],
}

const AT_HOME: Away = Away { s: 1.0, t: [0.0; 3] };

impl Away {
    fn p(self, p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| self.s * p[i] + self.t[i])
    }

    fn v(self, v: [f64; 3]) -> [f64; 3] {
        v.map(|x| self.s * x)
    }
}

/// Corners of a tetrahedron standing beside the middle.
const CORNERS: [[f64; 3]; 4] = [[0.9, 0.0, 1.1], [1.7, 0.0, 1.3], [1.2, 0.0, 0.5], [1.25, 0.8125, 0.96875]];

const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// An OBJ and a PLY file with vertices that are where the scene is.
fn write_meshes(folder: &Path, away: Away) {
    let mut obj = String::new();
    for p in CORNERS {
        let [x, y, z] = away.p(p);
        let _ = writeln!(obj, "v {x:?} {y:?} {z:?}");
    }
    for face in FACES {
        let [a, b, c] = face.map(|i| i + 1);
        let _ = writeln!(obj, "f {a} {b} {c}");
    }
    std::fs::write(folder.join("solid.obj"), obj).expect("a mesh");
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty double x\nproperty double y\n\
                  property double z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
    let mut ply = header.as_bytes().to_vec();
    for p in CORNERS {
        let moved = away.p([p[0] - 2.7, p[1], p[2] - 0.4]);
        moved.iter().for_each(|x| ply.extend(x.to_le_bytes()));
    }
    for face in FACES {
        ply.push(3);
        face.iter().for_each(|&i| ply.extend(i32::try_from(i).expect("small").to_le_bytes()));
    }
    std::fs::write(folder.join("solid.ply"), ply).expect("a mesh");
}

/// Every kind of shape, light and placement, in glass, metal and chalk, with a lens and an open shutter. `far_pose` moves and
/// turns a shape about an origin that is not the scene's.
#[expect(clippy::too_many_lines, reason = "one scene, nearly all of it text")]
fn text(away: Away) -> String {
    let Away { s, t } = away;
    let (p, v) = (|a, b, c| away.p([a, b, c]), |a, b, c| away.v([a, b, c]));
    let size = |x: f64| s * x;
    format!(
        r#"
[film]
width = 96
height = 64
[render]
spp = 8
max_depth = 6
[camera]
from = {from:?}
at = {at:?}
vfov_deg = 42.0
lens_radius = {lens:?}
shutter_close_s = 1.0
[materials.floor]
type = "diffuse"
reflectance = {{ checker = [0.7, 0.2], repeat = [8, 8] }}
[materials.chalk]
type = "oren_nayar"
reflectance = [0.7, 0.5, 0.3]
[materials.glass]
type = "dielectric"
absorption = {absorption:?}
[materials.gold]
type = "conductor"
metal = "Au"
alpha = 0.2
[materials.glaze]
type = "glazed"
reflectance = [0.2, 0.3, 0.6]
[[shapes]]
type = "rectangle"
center = {middle:?}
edge_u = {floor_u:?}
edge_v = {floor_v:?}
material = "floor"
[[shapes]]
type = "sphere"
name = "ball"
center = {ball:?}
radius = {ball_radius:?}
material = "glass"
[[shapes]]
type = "instance"
of = "ball"
material = "gold"
transform = [{{ translate = {beside:?} }}]
[[shapes]]
type = "box"
min = {low:?}
max = {high:?}
material = "glaze"
transform = [{{ translate = {home:?} }}, {{ rotate_deg = 25.0, axis = [0, 1, 0] }}, {{ translate = {there:?} }}]
[[shapes]]
type = "cylinder"
from = {foot:?}
to = {top:?}
radius = {thin:?}
material = "chalk"
[[shapes]]
type = "torus"
center = {ring:?}
axis = [0.3, 1.0, 0.2]
major_radius = {major:?}
minor_radius = {minor:?}
material = "gold"
keys = [{{ time_s = 0.0 }}, {{ time_s = 1.0, transform = [{{ translate = {slide:?} }}] }}]
[[shapes]]
type = "mesh"
file = "solid.obj"
material = "glaze"
[[shapes]]
type = "mesh"
file = "solid.ply"
material = "chalk"
normals = "smooth"
[[lights]]
type = "rectangle"
center = {lamp:?}
edge_u = {lamp_u:?}
edge_v = {lamp_v:?}
radiance = 9.0
[[lights]]
type = "sphere"
center = {bulb:?}
radius = {bulb_radius:?}
radiance = [40.0, 30.0, 20.0]
[[lights]]
type = "point"
position = {spark:?}
intensity = {power:?}
[[lights]]
type = "environment"
radiance = 0.1
"#,
        from = p(0.3, 1.9, 5.1),
        at = p(0.1, 0.4, 0.0),
        lens = size(0.02),
        absorption = 0.3 / s,
        middle = p(0.0, 0.0, 0.0),
        floor_u = v(6.0, 0.0, 0.0),
        floor_v = v(0.0, 0.0, -6.0),
        ball = p(-0.4, 0.5, 1.2),
        ball_radius = size(0.5),
        beside = v(-1.3, 0.1, -1.1),
        low = p(0.4, 0.0, -1.5),
        high = p(1.2, 0.9, -0.8),
        home = t.map(|x| -x),
        there = t,
        foot = p(2.1, 0.0, -0.6),
        top = p(1.9, 1.4, -0.8),
        thin = size(0.2),
        ring = p(0.3, 0.3, 2.0),
        major = size(0.3),
        minor = size(0.08),
        slide = v(0.2, 0.1, 0.0),
        lamp = p(0.5, 3.0, 0.5),
        lamp_u = v(0.6, 0.0, 0.0),
        lamp_v = v(0.0, 0.0, 0.4),
        bulb = p(-2.0, 1.6, 1.0),
        bulb_radius = size(0.1),
        spark = p(2.2, 1.8, 2.0),
        power = 1.5 * s * s,
    )
}

fn built(away: Away) -> Built {
    built_of(&text(away), away)
}

fn built_of(text: &str, away: Away) -> Built {
    let folder = tempfile::tempdir().expect("a folder for a scene");
    let path = folder.path().join("scene.toml");
    write_meshes(folder.path(), away);
    std::fs::write(&path, text).expect("a scene file");
    let loaded = scene::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
    scene::build(&loaded.description).unwrap_or_else(|error| panic!("{error}"))
}

fn picture(away: Away) -> Vec<f32> {
    let built = built(away);
    let rendered = render(&built.scene, &Settings::default(), &Silent).expect("a picture");
    assert_eq!(rendered.film.non_finite().count(), 0, "samples that are not finite");
    rendered.film.channels(Aov::Beauty).expect("it is kept").concat()
}

/// Root mean square of differences, over the mean of the picture, and the part of all pixels that differ by more than a
/// hundredth of it.
fn difference(a: &[f32], b: &[f32]) -> (f64, f64) {
    let n = a.len() as f64;
    let mean = a.iter().map(|&x| f64::from(x)).sum::<f64>() / n;
    let off = || a.iter().zip(b).map(|(a, b)| f64::from(a - b).abs() / mean);
    ((off().map(|d| d * d).sum::<f64>() / n).sqrt(), off().filter(|d| *d > 0.01).count() as f64 / n)
}

#[test]
fn a_scene_far_from_the_origin_is_what_it_is_near() {
    let home = picture(AT_HOME);
    for reach in [1e3, 1e5, 1e6, 1e7] {
        for axes in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, -1.0, 1.0]] {
            let away = Away { s: 1.0, t: axes.map(|axis| axis * reach) };
            let (rmse, changed) = difference(&home, &picture(away));
            println!(
                "{axes:?} times {reach:e}: RMSE {rmse:.2e} of the mean, {:.3} % changed",
                changed * 100.0
            );
            assert!(rmse <= 1e-3, "{axes:?} times {reach:e}: RMSE {rmse:e} of the mean");
        }
    }
}

/// The output `position` is a place as the scene's files have it, wherever the scene is counted from.
#[test]
fn positions_are_counted_as_the_files_do() {
    for settings in [
        "integrator = \"path\"",
        "integrator = \"path\"\nquery = \"single\"",
        "integrator = \"whitted\"",
        "integrator = \"whitted\"\nglossy = \"two-pass\"",
    ] {
        let positions = |away: Away| {
            let text = text(away).replace("[render]\nspp = 8", &format!("[render]\n{settings}\nspp = 8"));
            let built = built_of(&text, away);
            let layout = Layout::with([Aov::Position]);
            let rendered = render(&built.scene, &Settings { layout, ..Settings::default() }, &Silent);
            let film = rendered.expect("a picture").film;
            (film.channels(Aov::Position).expect("kept"), film.channels(Aov::Alpha).expect("kept").concat())
        };
        let (home, alpha) = positions(AT_HOME);
        let hit: Vec<usize> = (0..alpha.len()).filter(|&i| alpha[i] >= 1.0).collect();
        assert!(hit.len() > alpha.len() / 2, "{settings}: surfaces");
        for t in [[1e4, 0.0, 0.0], [1e5, -2e5, 3e5], [0.0, 1e7, 0.0]] {
            let (far, _) = positions(Away { s: 1.0, t });
            for axis in 0..3 {
                // Rounding of each sample and of their mean; where pictures differ a sample falls on the other side of an edge.
                let step = f64::from(f32::EPSILON) * t[axis].abs() + 1e-5;
                let off = |&i: &usize| (f64::from(far[axis][i]) - f64::from(home[axis][i]) - t[axis]).abs();
                let beyond = hit.iter().filter(|i| off(i) > 2.0 * step + 1e-3).count();
                println!("{settings}, {t:?}, axis {axis}: {beyond} of {} pixels beyond rounding", hit.len());
                assert!(
                    beyond * 100 <= hit.len(),
                    "{settings}, {t:?}, axis {axis}: {beyond} of {}",
                    hit.len()
                );
            }
        }
    }
}

#[test]
fn a_scene_near_the_origin_is_not_moved() {
    for (t, moved) in [([0.0; 3], false), ([100.0, 0.0, -100.0], false), ([0.0, 1e4, 0.0], true)] {
        let origin = built(Away { s: 1.0, t }).scene.origin;
        assert_eq!(origin.length() > 0.0, moved, "at {t:?}: {origin}");
        if moved {
            assert!(origin.distance(t.into()) < 8.0, "{origin} is near {t:?}");
        }
    }
}

#[test]
fn the_unit_of_length_does_not_matter() {
    let home = picture(AT_HOME);
    for k in (-20..=20).step_by(5) {
        let s = f64::from(k).exp2();
        let (rmse, changed) = difference(&home, &picture(Away { s, t: [0.0; 3] }));
        println!("2^{k}: RMSE {rmse:.2e} of the mean, {:.3} % changed", changed * 100.0);
        assert!(rmse <= 1e-4, "2^{k}: RMSE {rmse:e} of the mean");
    }
    // Far away and in another unit.
    for (s, t) in [(1e-6, [1.0, -1.0, 1.0]), (1e-3, [1e3, 1e3, 0.0]), (1e3, [0.0, 1e9, 1e9])] {
        let (rmse, _) = difference(&home, &picture(Away { s, t }));
        println!("{s:e} at {t:?}: RMSE {rmse:.2e} of the mean");
        assert!(rmse <= 2e-3, "{s:e} at {t:?}: RMSE {rmse:e} of the mean");
    }
}

/// A mesh whose file counts from far away, carried back by its own transform to where the other one is.
#[test]
fn a_mesh_far_from_the_origin_of_its_file_keeps_its_form() {
    let shift = [3e6, -5e6, 7e6];
    for name in ["solid.obj", "solid.ply"] {
        let folder = tempfile::tempdir().expect("a folder for meshes");
        let [near, far] = ["near", "far"].map(|name| folder.path().join(name));
        for (path, t) in [(&near, [0.0; 3]), (&far, shift)] {
            std::fs::create_dir(path).expect("a folder");
            write_meshes(path, Away { s: 1.0, t });
        }
        let [near, far] = [near, far].map(|path| {
            let loaded = load_mesh(&path.join(name), Normals::Flat).expect("a mesh");
            let at = |p: &glam::Vec3| p.as_dvec3() + loaded.origin;
            (loaded.mesh.positions().iter().map(at).collect::<Vec<_>>(), loaded.origin)
        });
        assert_eq!(near.1, DVec3::ZERO, "{name}: near its origin it is as it was written");
        for (p, q) in near.0.iter().zip(&far.0) {
            let off = (*q - DVec3::from(shift) - *p).abs().max_element();
            assert!(off <= 1e-7, "{name}: {q} is {off:e} off, which single precision rounds to 0.5");
        }
    }
}

/// The scene that a text describes.
fn scene_of(text: &str) -> scene::Scene {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).expect("a scene file");
    let loaded = scene::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
    scene::build(&loaded.description).unwrap_or_else(|error| panic!("{error}")).scene
}

#[test]
fn directions_are_known_between_places_that_round_to_one_and_at_any_length() {
    let spot = "[[lights]]\ntype = 'spot'\nintensity = 1\nposition = [1000, 0, 1]\nat = [999.99999, 0, 1]\n";
    let Light::Spot(spot) = &scene_of(spot).lights[0] else { panic!("another light") };
    assert!(glam::Vec3::from(spot.axis).abs_diff_eq(-glam::Vec3::X, 1e-6), "{spot:?}");
    for length in ["1e30", "1e-30"] {
        let sun =
            format!("[[lights]]\ntype = 'directional'\nirradiance = 1\ndirection = [0, -{length}, 0]\n");
        let Light::Directional(sun) = &scene_of(&sun).lights[0] else { panic!("another light") };
        assert_eq!(glam::Vec3::from(sun.direction), -glam::Vec3::Y, "{length}");
        let disc = format!(
            "[[lights]]\ntype = 'disc'\ncenter = [0, 0, 0]\nradius = 1\nradiance = 1\nnormal = [0, 0, {length}]\n\
             [camera]\nup = [0, {length}, 0]\n"
        );
        let scene = scene_of(&disc);
        let Light::Disc(_) = &scene.lights[0] else { panic!("another light") };
        let specula::geometry::Shape::Disc(disc) = &scene.world.shapes[0] else { panic!("another shape") };
        assert_eq!(disc.normal, glam::Vec3::Z, "{length}");
        assert!(scene.camera.ray([0.0, 0.0], [0.5; 2], 0.0).d.is_normalized(), "{length}: the camera");
    }
    let keys = "[camera]\nfrom = [0, 0, 0]\nat = [0, 0, -1]\nshutter_close_s = 1\nkeys = [{ time_s = 0 }, \
                { time_s = 1, from = [1000, 0, 0], at = [1000, 0, -1e-5], up = [0, 1, 0] }]\n";
    let ray = |time| {
        let scene = scene_of(keys);
        let [width, height] = [scene.film.width, scene.film.height].map(|n| n as f32);
        scene.camera.ray([0.5 * width, 0.5 * height], [0.5; 2], time)
    };
    for time in [0.0, 0.5, 1.0] {
        assert!(ray(time).d.abs_diff_eq(-glam::Vec3::Z, 1e-6), "the view at {time}: {:?}", ray(time));
    }
}
