//! Scenes with files beside them.

use image::{GrayImage, Luma, RgbImage};
use specula::image::Image;
use specula::math::Rgb;
use specula::render::{Settings, Silent, render};
use specula::scene::{self, Built, Scene};
use std::path::Path;

/// A folder of its own for a scene file and its pictures: `four.png`, whose quarters are red, green, blue and white, and
/// `gray.png`, bytes of 128.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self(tempfile::tempdir().expect("a folder"));
        let corners = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
        // 16 by 16 texels, so that the edges between them are narrow.
        let quarters = RgbImage::from_fn(16, 16, |x, y| image::Rgb(corners[(x / 8 + y / 8 * 2) as usize]));
        quarters.save(folder.path().join("four.png")).expect("written");
        GrayImage::from_pixel(4, 4, Luma([128])).save(folder.path().join("gray.png")).expect("written");
        folder
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path().join(name), text).expect("written");
    }

    /// The scene that a text describes, or all that is wrong with it.
    pub(crate) fn load(&self, text: &str) -> Result<Built, String> {
        self.write("scene.toml", text);
        let loaded = scene::load(&self.path().join("scene.toml"), &[]).map_err(|error| error.to_string())?;
        scene::build(&loaded.description).map_err(|error| error.to_string())
    }

    pub(crate) fn scene(&self, text: &str) -> Scene {
        self.load(text).unwrap_or_else(|error| panic!("{error}")).scene
    }
}

/// The integrators, over one lane and over all.
pub(crate) const WAYS: [&str; 4] = [
    "integrator = \"path\"\nmax_depth = 2\nquery = \"single\"\nspp = 16",
    "integrator = \"path\"\nmax_depth = 2\nquery = \"stream\"\nspp = 16",
    "integrator = \"whitted\"\nquery = \"single\"\nspp = 16",
    "integrator = \"whitted\"\nquery = \"stream\"\nspp = 16",
];

/// What is seen of -1 to 1 in x, to the right, and y, up; in white light from all around.
pub(crate) fn frontal(render: &str, rest: &str) -> String {
    format!(
        r#"
        [camera]
        from = [0.0, 0.0, 10.0]
        at = [0.0, 0.0, 0.0]
        vfov_deg = 11.421186
        [film]
        width = 16
        height = 16
        filter = "box"
        [render]
        {render}
        [[lights]]
        type = "environment"
        radiance = 1.0
        {rest}
        "#
    )
}

/// The same of a square of one material.
pub(crate) fn square(render: &str, material: &str) -> String {
    let shape = "[[shapes]]\ntype = \"rectangle\"\nedge_u = [1.0, 0.0, 0.0]\nedge_v = [0.0, 1.0, 0.0]\nmaterial = \"m\"";
    frontal(render, &format!("[materials.m]\n{material}\n{shape}"))
}

pub(crate) fn picture(scene: &Scene) -> Image {
    let film = render(scene, &Settings::default(), &Silent).expect("a picture").film;
    assert_eq!(film.non_finite().count(), 0, "samples that are not finite");
    film.image()
}

pub(crate) fn close(a: Rgb<f32>, b: Rgb<f32>, tolerance: f32) -> bool {
    let d = a - b;
    d.r.abs().max(d.g.abs()).max(d.b.abs()) <= tolerance
}
