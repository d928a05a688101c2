//! The tests that the course framework Nori gives its students: pictures of one pixel whose value is known, and directional
//! albedos of a coat of facets over a matt base.
//!
//! Their numbers have six digits; some are estimates themselves, off by up to 8e-4 of their value.

use crate::data::data;
use crate::mitsuba::{attribute, child, number, numbers, property};
use crate::scene::scene_of;
use crate::shots::{Shot, limit};
use crate::table::{samples, tell};
use roxmltree::{Document, Node};
use specula::bsdf::microfacet::{Beckmann, Distribution};
use specula::bsdf::{FresnelModel, Glass, RoughDielectric};
use specula::math::Vec3;
use std::fmt::Write as _;
use std::path::Path;

/// How far their estimates are off, as a part of their value.
const THEIR_ERROR: f64 = 8e-4;

/// The name of a strategy there as settings here.
fn settings(integrator: &str) -> &'static str {
    match integrator {
        "whitted" => "integrator = \"whitted\"",
        "path_ems" => "integrator = \"path\"\ndirect = \"light\"",
        "path_mats" => "integrator = \"path\"\ndirect = \"bsdf\"",
        "path_mis" => "integrator = \"path\"\ndirect = \"both\"",
        other => panic!("unknown integrator {other}"),
    }
}

/// A picture of 8 by 8 pixels instead of one.
fn scene_file(folder: &Path, scene: &Node<'_, '_>, spp: u32) -> (String, String) {
    let integrator = attribute(&child(scene, "integrator").expect("an integrator"), "type");
    let camera = child(scene, "camera").expect("a camera");
    let look = camera.descendants().find(|node| node.has_tag_name("lookat"));
    let three = |name: &str, otherwise: [f64; 3]| {
        look.map_or(otherwise, |look| numbers(attribute(&look, name)).try_into().expect("three numbers"))
    };
    let (from, at) = (three("origin", [0.0; 3]), three("target", [0.0, 0.0, 1.0]));
    let (up, fov) = (three("up", [0.0, 1.0, 0.0]), number(property(&camera, "fov").expect("an angle")));
    // 0.8^100 of the light is missing.
    let mut file = format!(
        "[camera]\nfrom = {from:?}\nat = {at:?}\nup = {up:?}\nvfov_deg = {fov:?}\n[film]\nwidth = 8\nheight = 8\nfilter = \"box\"\n\
         [render]\n{}\nsampler = \"independent\"\nspp = {spp}\nmax_depth = 100\n",
        settings(integrator)
    );
    let mut albedo = String::new();
    for (i, mesh) in scene.children().filter(|node| node.has_tag_name("mesh")).enumerate() {
        let name = folder.join(property(&mesh, "filename").expect("a file"));
        let of = |tag: &str, name: &str| {
            child(&mesh, tag)
                .and_then(|node| property(&node, name))
                .map(|value| format!("{:?}", numbers(value)))
        };
        let reflectance = of("bsdf", "albedo").expect("an albedo");
        let emission = of("emitter", "radiance").unwrap_or_else(|| "0.0".to_owned());
        let _ = write!(
            file,
            "[materials.m{i}]\ntype = \"diffuse\"\nreflectance = {reflectance}\nemission = {emission}\n[[shapes]]\n\
             type = \"mesh\"\nfile = {name:?}\nmaterial = \"m{i}\"\n"
        );
        albedo += &format!(
            "{} {reflectance} ",
            name.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
        );
    }
    (format!("{integrator}: {}", albedo.trim_end()), file)
}

#[test]
fn numbers_of_nori_are_found() {
    let Some(data) = data("scenes/nori-tests") else { return };
    let files =
        ["pa4/test-mesh-furnace.xml", "pa4/test-mesh.xml", "pa5/test-furnace.xml", "pa5/test-direct.xml"];
    let mut table =
        "| test | scene | expected | found | off, % | deviations |\n|---|---|---|---|---|---|\n".to_owned();
    let mut failed = Vec::new();
    for name in files {
        let file = data.join(name);
        let text = std::fs::read_to_string(&file).expect("a test");
        let document = Document::parse(&text).expect("XML");
        let root = document.root_element();
        let references = numbers(property(&root, "references").expect("references"));
        let scenes: Vec<_> = root.children().filter(|node| node.has_tag_name("scene")).collect();
        assert_eq!(references.len(), scenes.len(), "{name}");
        for (expected, scene) in references.into_iter().zip(&scenes) {
            let (what, text) = scene_file(file.parent().expect("a folder"), scene, samples(1024));
            let [found, error] = Shot::of(&scene_of(&text)).mean_of(1);
            let deviations = (found - expected).abs() / error.hypot(THEIR_ERROR / 3.0 * expected);
            let off = (found / expected - 1.0) * 100.0;
            let _ = writeln!(
                table,
                "| {name} | {what} | {expected} | {found:.6} | {off:+.3} | {deviations:.1} |"
            );
            // 28 numbers, once in a hundred runs beyond by chance.
            if deviations > limit(28) {
                failed.push(format!("{name}, {what}: {found}, not {expected}"));
            }
        }
    }
    tell("Nori's numbers", &table);
    assert!(failed.is_empty(), "{failed:?}");
}

/// kd + (1 - max kd) times what a coat of Beckmann facets reflects, as luminance.
#[test]
fn albedos_of_nori_are_found() {
    const SIDE: u16 = 1024;
    let Some(data) = data("scenes/nori-tests/pa5") else { return };
    let text = std::fs::read_to_string(data.join("ttest-microfacet.xml")).expect("a test");
    let document = Document::parse(&text).expect("XML");
    let root = document.root_element();
    let [angles, references] =
        ["angles", "references"].map(|name| numbers(property(&root, name).expect("a list")));
    let bsdf = child(&root, "bsdf").expect("a material");
    let [alpha, inside, outside] =
        ["alpha", "intIOR", "extIOR"].map(|name| number(property(&bsdf, name).expect("a number")));
    let kd = numbers(property(&bsdf, "kd").expect("a colour"));
    let base = 0.212_671 * kd[0] + 0.715_160 * kd[1] + 0.072_169 * kd[2];
    let coat = 1.0 - kd.iter().copied().fold(0.0, f64::max);
    #[expect(clippy::cast_possible_truncation, reason = "numbers of a scene")]
    let lobe = RoughDielectric {
        glass: Glass::new(FresnelModel::Exact, (inside / outside) as f32),
        facets: Distribution::from(Beckmann::isotropic(alpha as f32)),
    };
    let mut table =
        "| angle | expected | found | off, % | found without correlation of heights | off, % |\n|---|---|---|---|---|---|\n".to_owned();
    for (angle, expected) in angles.into_iter().zip(references) {
        #[expect(clippy::cast_possible_truncation, reason = "a direction")]
        let [sin, cos] = [angle.to_radians().sin() as f32, angle.to_radians().cos() as f32];
        let wo = Vec3::new(sin, 0.0, cos);
        let [mut own, mut apart] = [0.0, 0.0];
        let middle = |i: u16| (f32::from(i) + 0.5) / f32::from(SIDE);
        for u2 in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| [middle(i), middle(j)])) {
            let [mirrored, _] = lobe.sample(wo, u2);
            if mirrored.valid {
                let weight = f64::from(mirrored.weight.g);
                own += weight;
                // Visible normals hold the masking of the viewer; what is left is that of the light.
                let correlated = f64::from(lobe.facets.g2_over_g1(wo, mirrored.wi));
                apart += weight / correlated * f64::from(lobe.facets.g1(mirrored.wi));
            }
        }
        let [own, apart] = [own, apart].map(|sum| base + coat * sum / f64::from(SIDE).powi(2));
        let off = |found: f64| (found / expected - 1.0) * 100.0;
        let _ = writeln!(
            table,
            "| {angle} | {expected} | {own:.6} | {:+.3} | {apart:.6} | {:+.3} |",
            off(own),
            off(apart)
        );
        assert!(off(apart).abs() < 0.12, "without correlation at {angle}: {apart}, not {expected}");
        // Correlated heights hide less from both at grazing angles.
        assert!(off(own).abs() < 0.15, "at {angle}: {own}, not {expected}");
    }
    tell("Nori's albedos", &table);
}
