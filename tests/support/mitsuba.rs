//! Scenes of Mitsuba (XML of 0.5 to 3) in the words of our scene files, as far as these have words for them.
//!
//! What has none is replaced by the nearest there is and told ([`Peer::remarks`]); the shapes concerned can be drawn alone, so
//! that a comparison leaves out their pixels.

#![allow(dead_code, reason = "each test program uses a part")]

use roxmltree::{Document, Node};
use specula::bsdf::FresnelModel;
use specula::image::{Image, Window, exr};
use specula::math::Rgb;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

/// A scene by another renderer's own description.
#[derive(Clone, Debug)]
pub(crate) struct Peer {
    folder: PathBuf,
    /// Where pictures that had to be changed are.
    desk: Arc<TempDir>,
    defaults: BTreeMap<String, String>,
    camera: String,
    /// Columns and rows.
    pub(crate) size: [u32; 2],
    filter: String,
    /// Path edges, counted as ours.
    pub(crate) max_depth: u32,
    materials: BTreeMap<String, Surface>,
    shapes: Vec<Placed>,
    lights: Vec<String>,
    /// What our scene files have no words for, and what was put in its place.
    replaced: Vec<String>,
}

/// A material.
#[derive(Clone, Debug, Default)]
struct Surface {
    /// Lines of its table.
    toml: String,
    /// Lines of the table of the material within, where it is a mix of one.
    inner: Option<String>,
    replaced: bool,
}

/// A shape, with the names of material and file resolved.
#[derive(Clone, Debug)]
struct Placed {
    toml: String,
    surface: Surface,
}

impl Peer {
    /// # Panics
    /// If the file is not what the notes on the data say.
    pub(crate) fn read(file: &Path) -> Self {
        let mut peer = Self {
            folder: file.parent().expect("a folder").to_owned(),
            desk: Arc::new(tempfile::tempdir().expect("a folder")),
            defaults: BTreeMap::new(),
            camera: String::new(),
            size: [0; 2],
            filter: "box".to_owned(),
            max_depth: 0,
            materials: BTreeMap::new(),
            shapes: Vec::new(),
            lights: Vec::new(),
            replaced: Vec::new(),
        };
        peer.file(file);
        peer
    }

    /// The scene as a file of ours, with this table `render`, in pictures of that size.
    pub(crate) fn scene(&self, render: &str, [width, height]: [u32; 2]) -> String {
        let mut text = self.head(render, [width, height]);
        for (index, shape) in self.shapes.iter().enumerate() {
            write(&mut text, index, &shape.toml, &shape.surface);
        }
        for light in &self.lights {
            text += &format!("[[lights]]\n{light}");
        }
        text
    }

    /// The shapes whose material was replaced, white before black; all others are black, and hide them.
    pub(crate) fn marks(&self, size: [u32; 2]) -> String {
        let mut text = self.head("integrator = \"path\"\nspp = 64", size);
        for (index, shape) in self.shapes.iter().enumerate() {
            let radiance = if shape.surface.replaced { 1.0 } else { 0.0 };
            let toml = format!("type = \"emission\"\nradiance = {radiance:?}\ntwo_sided = true\n");
            write(&mut text, index, &shape.toml, &Surface { toml, ..Surface::default() });
        }
        text
    }

    fn head(&self, render: &str, [width, height]: [u32; 2]) -> String {
        format!(
            "{}[film]\nwidth = {width}\nheight = {height}\nfilter = \"{}\"\n[render]\nmax_depth = {}\n{render}\n",
            self.camera, self.filter, self.max_depth
        )
    }

    fn file(&mut self, file: &Path) {
        let text = std::fs::read_to_string(file).expect("a description");
        let document = Document::parse(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let children = || document.root_element().children().filter(Node::is_element);
        for node in children().filter(|node| node.has_tag_name("default")) {
            let name = attribute(&node, "name");
            self.defaults.entry(name.to_owned()).or_insert_with(|| attribute(&node, "value").to_owned());
        }
        for node in children() {
            match node.tag_name().name() {
                "integrator" => self.integrator(&node),
                "sensor" => self.sensor(&node),
                "bsdf" => {
                    let surface = self.surface(&node);
                    self.materials.insert(attribute(&node, "id").to_owned(), surface);
                }
                "shape" => self.shape(&node),
                "emitter" => self.emitter(&node),
                "include" => {
                    let file = self.folder.join(attribute(&node, "filename"));
                    self.file(&file);
                }
                "default" | "path" | "mode" => {}
                other => panic!("unknown element {other}"),
            }
        }
    }

    /// Integrators may wrap others; the innermost tells the depth.
    fn integrator(&mut self, node: &Node<'_, '_>) {
        let all = node.descendants().filter(|node| node.has_tag_name("integrator"));
        let kinds: Vec<_> = all.map(|node| self.resolved(attribute(&node, "type")).to_owned()).collect();
        let depth = node.descendants().find(|node| {
            node.has_tag_name("integer") && matches!(node.attribute("name"), Some("max_depth" | "maxDepth"))
        });
        self.max_depth = match depth {
            Some(node) => self.resolved(attribute(&node, "value")).parse().expect("a depth"),
            None if kinds.iter().any(|kind| kind == "direct") => 2,
            None => panic!("no depth of {kinds:?}"),
        };
    }

    fn sensor(&mut self, node: &Node<'_, '_>) {
        let film = child(node, "film").expect("a film");
        self.size = ["width", "height"]
            .map(|name| self.resolved(property(&film, name).expect("a size")).parse().expect("pixels"));
        if let Some(filter) = child(&film, "rfilter") {
            self.filter = attribute(&filter, "type").to_owned();
        }
        let ratio = f64::from(self.size[1]) / f64::from(self.size[0]);
        let tangent = match property(node, "fov") {
            Some(fov) => (number(fov).to_radians() / 2.0).tan() * ratio,
            // A lens of 50 mm over the diagonal of a film of 36 by 24 mm.
            None => 36_f64.hypot(24.0) / 100.0 / ratio.recip().hypot(1.0),
        };
        let vfov = 2.0 * tangent.atan().to_degrees();
        let transform = child(node, "transform").expect("a place of the camera");
        let [from, at, up] = if let Some(look) = child(&transform, "lookat") {
            ["origin", "target", "up"]
                .map(|name| <[f64; 3]>::try_from(numbers(attribute(&look, name))).expect("three"))
        } else {
            let m = numbers(attribute(&child(&transform, "matrix").expect("a matrix"), "value"));
            let column = |i: usize| [m[i], m[4 + i], m[8 + i]];
            let [from, forward] = [column(3), column(2)];
            [from, [0, 1, 2].map(|i| from[i] + forward[i]), column(1)]
        };
        self.camera = format!("[camera]\nfrom = {from:?}\nat = {at:?}\nup = {up:?}\nvfov_deg = {vfov:?}\n");
    }

    fn shape(&mut self, node: &Node<'_, '_>) {
        let kind = attribute(node, "type");
        let mut toml = match kind {
            "obj" => self.mesh(node),
            "rectangle" => {
                "type = \"rectangle\"\nedge_u = [1.0, 0.0, 0.0]\nedge_v = [0.0, 1.0, 0.0]\n".to_owned()
            }
            "cube" => "type = \"box\"\nmin = [-1.0, -1.0, -1.0]\nmax = [1.0, 1.0, 1.0]\n".to_owned(),
            "disk" => "type = \"disc\"\nnormal = [0.0, 0.0, 1.0]\n".to_owned(),
            "sphere" => {
                format!("type = \"sphere\"\nradius = {:?}\n", property(node, "radius").map_or(1.0, number))
            }
            other => panic!("unknown shape {other}"),
        };
        if let Some(transform) = child(node, "transform") {
            toml += &steps(&transform);
        }
        let mut surface = if let Some(emitter) = child(node, "emitter") {
            let radiance = self.colour(&emitter, "radiance").expect("a radiance");
            Surface { toml: format!("type = \"emission\"\nradiance = {radiance}\n"), ..Surface::default() }
        } else if let Some(reference) = child(node, "ref") {
            self.materials[attribute(&reference, "id")].clone()
        } else {
            self.surface(&child(node, "bsdf").expect("a material"))
        };
        if let Some(medium) = child(node, "medium") {
            // Without an albedo all that it takes is absorbed.
            assert!(
                self.colour(&medium, "albedo").is_some_and(|albedo| albedo == "[0.0, 0.0, 0.0]"),
                "no scattering"
            );
            surface.toml +=
                &format!("absorption = {}\n", self.colour(&medium, "sigma_t").expect("a coefficient"));
        }
        self.shapes.push(Placed { toml, surface });
    }

    /// Without normals in its file a mesh is smooth, unless faces are asked for.
    fn mesh(&self, node: &Node<'_, '_>) -> String {
        let file = self.found(property(node, "filename").expect("a file"));
        let flat = ["faceNormals", "face_normals"].iter().any(|name| property(node, name) == Some("true"));
        let text = || std::fs::read_to_string(&file).expect("a mesh");
        let normals = match (flat, flat || text().lines().any(|line| line.starts_with("vn "))) {
            (true, _) => "flat",
            (false, true) => "file",
            (false, false) => "smooth",
        };
        format!("type = \"mesh\"\nfile = {file:?}\nnormals = \"{normals}\"\n")
    }

    fn emitter(&mut self, node: &Node<'_, '_>) {
        let light = match attribute(node, "type") {
            "constant" => {
                let radiance = self.colour(node, "radiance").unwrap_or_else(|| "1.0".to_owned());
                format!("type = \"environment\"\nradiance = {radiance}\n")
            }
            "envmap" => {
                format!(
                    "type = \"environment\"
{}",
                    self.sky(&self.found(property(node, "filename").expect("a file")))
                )
            }
            "point" => {
                let place = child_named(node, "position").expect("a place");
                let intensity = self.colour(node, "intensity").expect("an intensity");
                format!(
                    "type = \"point\"\nposition = {:?}\nintensity = {intensity}\n",
                    along_axes(&place, 0.0)
                )
            }
            "directional" => {
                let way = child_named(node, "direction").expect("a direction");
                let irradiance = self.colour(node, "irradiance").expect("an irradiance");
                format!(
                    "type = \"directional\"\ndirection = {:?}\nirradiance = {irradiance}\n",
                    along_axes(&way, 0.0)
                )
            }
            other => {
                self.replaced.push(format!("`{other}` left out"));
                return;
            }
        };
        self.lights.push(light);
    }

    /// A picture of the sky that we read as Mitsuba 2 reads that one, turned by half a turn.
    ///
    /// Theirs has its first column at -z, and its rows at k / (height - 1) of the way down, where ours are in the middles of cells. From
    /// version 3 on columns are at k / width, but the references are older, or made as of old.
    fn sky(&self, file: &Path) -> String {
        const FINER: u32 = 8;
        let image = specula::image::read(file).expect("a picture").image;
        let (width, last) = (image.width(), image.height() - 1);
        let mut finer = Image::new(width, last * FINER);
        for y in 0..finer.height() {
            #[expect(clippy::cast_precision_loss, reason = "rows of a picture")]
            let part = ((y % FINER) as f32 + 0.5) / FINER as f32;
            for x in 0..width {
                let [a, b] = [0, 1].map(|row| image.pixel(x, y / FINER + row));
                finer.set_pixel(x, y, a.lerp(b, part));
            }
        }
        let channel = |name: &str, of: fn(&Rgb<f32>) -> f32| exr::Channel {
            name: name.to_owned(),
            samples: exr::Samples::Float(finer.pixels().iter().map(of).collect()),
        };
        let channels = vec![channel("R", |p| p.r), channel("G", |p| p.g), channel("B", |p| p.b)];
        let (full, window) = ([width, finer.height()], Window::whole(width, finer.height()));
        let picture = exr::Picture { full, window, channels, attributes: Vec::new(), warnings: Vec::new() };
        let path = self.desk.path().join(file.with_extension("exr").file_name().expect("a name"));
        exr::write(&path, picture).expect("written");
        format!(
            "file = {path:?}
rotate_deg = 180.0
"
        )
    }

    /// What was replaced, each kind once.
    pub(crate) fn remarks(&self) -> String {
        let mut kinds = self.replaced.clone();
        kinds.sort();
        kinds.dedup();
        kinds.join(", ")
    }

    /// The same with that light instead of all its own, in our words.
    pub(crate) fn lit_by(&self, light: &str) -> Self {
        let mut other = self.clone();
        other.shapes.retain(|shape| !shape.surface.toml.contains("\"emission\""));
        other.lights = vec![light.to_owned()];
        other
    }

    fn surface(&mut self, node: &Node<'_, '_>) -> Surface {
        let inner = child(node, "bsdf");
        let mut surface = Surface::default();
        match attribute(node, "type") {
            "twosided" => return self.surface(&inner.expect("a material within")),
            "mask" => {
                surface = self.surface(&inner.expect("a material within"));
                let file = self.picture(node, "opacity").expect("a picture");
                // The shade as light, whatever the alpha.
                let opacity = format!("{{ file = {file:?}, channel = \"r\", space = \"srgb\" }}");
                surface.toml = format!("opacity = {opacity}\n{}", surface.toml);
            }
            "normalmap" => {
                surface = self.surface(&inner.expect("a material within"));
                // A constant map is the identity in all scenes there are.
                if let Some(file) = self.picture(node, "normalmap") {
                    surface.toml = format!("normal_map = {{ file = {file:?} }}\n{}", surface.toml);
                }
            }
            "diffuse" => {
                let reflectance = self.texture(node, "reflectance").unwrap_or_else(|| "0.5".to_owned());
                surface.toml = format!("type = \"diffuse\"\nreflectance = {reflectance}\n");
            }
            kind @ ("conductor" | "roughconductor") => {
                let metal = self.metal(node) + &facets(node, kind == "roughconductor");
                match self
                    .colour(node, "specularReflectance")
                    .or_else(|| self.colour(node, "specular_reflectance"))
                {
                    Some(factor) if !factor.contains("1.0, 1.0, 1.0") => {
                        surface.toml = format!(
                            "type = \"mix\"\nparts = [{{ material = \"NAME\", weight = {factor} }}]\n"
                        );
                        surface.inner = Some(metal);
                    }
                    _ => surface.toml = metal,
                }
            }
            kind @ ("dielectric" | "roughdielectric") => {
                let rough = facets(node, kind == "roughdielectric");
                surface.toml = format!("type = \"dielectric\"\nior = {:?}\n{rough}", index(node, "bk7"));
            }
            kind => {
                let names = ["diffuse_reflectance", "diffuseReflectance", "base_color"];
                let base = names
                    .iter()
                    .find_map(|name| self.texture(node, name))
                    .unwrap_or_else(|| "0.5".to_owned());
                let ior = index(node, "polypropylene");
                surface.toml = format!("type = \"glazed\"\nior = {ior:?}\nreflectance = {base}\n");
                // Ours has all bounces within the coat, as theirs if asked for.
                surface.replaced = kind != "plastic" || base.contains("file");
                if surface.replaced {
                    self.replaced.push(format!("`{kind}` as `glazed`, with a smooth coat"));
                } else if property(node, "nonlinear") != Some("true") {
                    // Without the change of colour by bounces within: the base that reflects as much after all of them.
                    surface.toml = format!(
                        "type = \"glazed\"\nior = {ior:?}\nreflectance = {}\n",
                        unbounced(&base, ior)
                    );
                }
            }
        }
        surface
    }

    fn metal(&self, node: &Node<'_, '_>) -> String {
        let [eta, k] = match property(node, "material") {
            // As Mitsuba 3.9 converts its tables to RGB.
            Some("Al") => ["[1.6575, 0.880405, 0.521244]", "[9.22381, 6.2695, 4.837]"].map(str::to_owned),
            Some(other) => panic!("unknown metal {other}"),
            None => ["eta", "k"].map(|name| self.colour(node, name).expect("an index")),
        };
        format!("type = \"conductor\"\neta = {eta}\nk = {k}\n")
    }

    /// A colour, or a picture.
    fn texture(&self, node: &Node<'_, '_>, name: &str) -> Option<String> {
        let file = self.picture(node, name).map(|file| format!("{{ file = {file:?} }}"));
        file.or_else(|| self.colour(node, name))
    }

    fn picture(&self, node: &Node<'_, '_>, name: &str) -> Option<PathBuf> {
        let texture = child_named(node, name).filter(|node| node.attribute("type") == Some("bitmap"))?;
        Some(self.found(property(&texture, "filename")?))
    }

    fn colour(&self, node: &Node<'_, '_>, name: &str) -> Option<String> {
        let node = child_named(node, name).filter(|node| !node.has_tag_name("texture"))?;
        let value = attribute(&node, "value");
        Some(match value {
            // As Mitsuba 3.9 converts it to RGB.
            "400:0, 500:8, 600:15.6, 700:18.4" => "[20.7108, 10.8546, 2.77115]".to_owned(),
            other if other.contains(':') => panic!("unknown spectrum {other}"),
            _ => match numbers(value)[..] {
                [gray] => format!("[{gray:?}, {gray:?}, {gray:?}]"),
                ref rgb => format!("{rgb:?}"),
            },
        })
    }

    fn resolved<'a>(&'a self, value: &'a str) -> &'a str {
        value.strip_prefix('$').map_or(value, |name| &self.defaults[name])
    }

    /// A file beside the scene or in the folder that Mitsuba's tests share.
    fn found(&self, name: &str) -> PathBuf {
        let places = [self.folder.join(name), self.folder.join("../common").join(name)];
        places.into_iter().find(|place| place.exists()).unwrap_or_else(|| panic!("{name} is missing"))
    }
}

fn write(text: &mut String, index: usize, shape: &str, surface: &Surface) {
    let name = format!("m{index}");
    if let Some(inner) = &surface.inner {
        let _ = write!(text, "[materials.{name}_inner]\n{inner}");
    }
    let toml = surface.toml.replace("NAME", &format!("{name}_inner"));
    let _ = write!(text, "[materials.{name}]\n{toml}[[shapes]]\n{shape}material = \"{name}\"\n");
}

/// The base under a coat whose light looks as if it had not bounced within.
///
/// rho / (1 - E) where ours is rho' / (1 - rho' F), with the mean reflectance F of the coat from within, and E what Mitsuba has for
/// it: the fit by Egan and Hilgeman 1973. Equal for rho' = rho / (1 - E + rho F).
fn unbounced(base: &str, ior: f64) -> String {
    let inside = FresnelModel::Exact.average_inside(ior);
    let fit = -1.4399 / (ior * ior) + 0.7099 / ior + 0.6681 + 0.0636 * ior;
    let rho = numbers(base.trim_matches(['[', ']']));
    format!("{:?}", rho.iter().map(|rho| rho / (1.0 - fit + rho * inside)).collect::<Vec<_>>())
}

fn facets(node: &Node<'_, '_>, rough: bool) -> String {
    if !rough {
        return String::new();
    }
    let both = property(node, "alpha").map_or(0.1, number);
    let alpha = ["alpha_u", "alpha_v"].map(|name| property(node, name).map_or(both, number));
    let distribution = property(node, "distribution").unwrap_or("beckmann");
    format!("alpha = {alpha:?}\ndistribution = \"{distribution}\"\n")
}

/// The index of the inside over that of the outside.
fn index(node: &Node<'_, '_>, inside: &str) -> f64 {
    let of = |names: [&str; 2], otherwise: &str| match names
        .iter()
        .find_map(|name| property(node, name))
        .unwrap_or(otherwise)
    {
        "vacuum" => 1.0,
        "air" => 1.000_277,
        "bk7" => 1.504_6,
        "diamond" => 2.419,
        "polypropylene" => 1.49,
        value => number(value),
    };
    of(["int_ior", "intIOR"], inside) / of(["ext_ior", "extIOR"], "air")
}

fn steps(transform: &Node<'_, '_>) -> String {
    let steps = transform.children().filter(Node::is_element).map(|step| match step.tag_name().name() {
        "matrix" => format!("{{ matrix = {:?} }}", numbers(attribute(&step, "value"))),
        "translate" => format!("{{ translate = {:?} }}", along_axes(&step, 0.0)),
        "scale" => format!("{{ scale = {:?} }}", along_axes(&step, 1.0)),
        "rotate" => {
            let angle = number(attribute(&step, "angle"));
            format!("{{ rotate_deg = {angle:?}, axis = {:?} }}", along_axes(&step, 0.0))
        }
        other => panic!("unknown step {other}"),
    });
    format!("transform = [{}]\n", steps.collect::<Vec<_>>().join(", "))
}

/// Three numbers, by `value` or by axis.
fn along_axes(node: &Node<'_, '_>, otherwise: f64) -> [f64; 3] {
    match node.attribute("value").map(numbers) {
        Some(all) if all.len() == 1 => [all[0]; 3],
        Some(all) => all.try_into().expect("three numbers"),
        None => ["x", "y", "z"].map(|axis| node.attribute(axis).map_or(otherwise, number)),
    }
}

pub(crate) fn attribute<'a>(node: &Node<'a, '_>, name: &str) -> &'a str {
    node.attribute(name).unwrap_or_else(|| panic!("{} without {name}", node.tag_name().name()))
}

pub(crate) fn child<'a, 'i>(node: &Node<'a, 'i>, tag: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|node| node.has_tag_name(tag))
}

fn child_named<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|node| node.attribute("name") == Some(name))
}

/// The value of a child of that name.
pub(crate) fn property<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    child_named(node, name)?.attribute("value")
}

pub(crate) fn number(text: &str) -> f64 {
    text.trim().parse().unwrap_or_else(|_| panic!("no number: {text}"))
}

/// Numbers between commas or spaces.
pub(crate) fn numbers(text: &str) -> Vec<f64> {
    text.split([',', ' ', '\n', '\t']).filter(|word| !word.is_empty()).map(number).collect()
}
