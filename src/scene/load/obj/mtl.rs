//! Materials of MTL files.
//!
//! MTL describes the shading of the 1990s, to which the names that start in `P` add that of the 2010s (Exocortex 2012,
//! Clara.io's extension); what a file says is taken for the nearest material there is. In this order:
//!
//! | said | becomes |
//! |---|---|
//! | `illum` 4, 5, 6, 7 or 9 with `Ni` above 1; `d` between 0 and 1; `Tf` neither black nor white with `Ni` above 1 | dielectric of index `Ni`, 1.5 where that is not above 1, without absorption |
//! | `Pm` from 0.5 | conductor of reflectance `Kd` and `alpha` = `Pr`^2 |
//! | `Pc` from 0.5; `Pr` below 0.05 | glazed of index `Ni` (as above) over a base of `Kd` |
//! | `Pr` below 1 | glossy of the reflectance that `Ni` (as above) has straight on, as wide as `alpha` = `Pr`^2, over a base of what is left of `Kd` |
//! | `illum` 3, 5 or 8 with `Ks` above zero | mirror of reflectance `Ks` |
//! | `Ks` and `Ns` above zero, `illum` not 0 or 1 | glossy of exponent `Ns` and reflectance `Ks` over a base of `Kd` |
//! | `Ke` above zero, `Kd` black or missing | emission alone |
//! | all else | diffuse of reflectance `Kd`, gray 0.5 where it is missing |
//!
//! Each of the others also gives off the radiance `Ke`. Where a metal has no `Pr`, its width is that of `Ns`: alpha^2 =
//! 2 / (`Ns` + 2) (Walter and others 2007, Microfacet Models for Refraction); 0 without `Ns`. A lobe of that width about
//! the half vector has about four times the exponent of one about the mirror direction, which halves angles.
//!
//! Lines are checked here, since tobj names none, refuses files with nameless materials and panics at colours of one
//! number, which stand for gray; what is left is read by tobj. The first material of a name counts.
//!
//! `d 0` means opaque: exporters write it for opaque surfaces, and nobody draws invisible ones. `Tf` filters at a
//! surface and has no thickness to make absorption of. Sheen (`Ps`), the roughness of coats (`Pcr`) and anisotropy are not
//! read.
//!
//! Of textures `map_Kd` colours the matt base, times `Kd` unless that is black; of a metal it is not read. `map_Ke` shines,
//! times `Ke` likewise. `map_d` cuts holes, `norm` is a normal map; `map_Bump` and `bump` are heights, or normals where the
//! picture looks like that. A file that is not there is told; the base is gray 0.5 then, and light that of `Ke`. One that cannot
//! be read is told, too, and does not shine.

use super::maps::{Map, Maps, Use};
use super::outline::keyword;
use super::single;
use crate::error::{Place, Problem, Problems};
use crate::math::Rgb;
use crate::scene::description::{Material, Optics, Scattering, Texture};
use crate::trust::Trust;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Materials by name, and what was wrong with them.
#[derive(Debug)]
pub(super) struct Library<'a> {
    pub(super) materials: HashMap<String, Material>,
    pub(super) warnings: Vec<Problem>,
    /// Pictures that lie where they must not.
    pub(super) refused: Problems,
    trust: &'a Trust,
}

impl<'a> Library<'a> {
    /// Empty; files are trusted so far.
    pub(super) fn new(trust: &'a Trust) -> Self {
        Self { materials: HashMap::new(), warnings: vec![], refused: Problems::default(), trust }
    }

    /// Adds the materials of a file; the first definition of a name counts. Fails, saying why, where tobj refuses all of
    /// it.
    pub(super) fn read(&mut self, path: &Path, text: &str) -> Result<(), String> {
        let file: Arc<Path> = path.into();
        let mut statements = Statements::default();
        for (number, line) in (1..).zip(text.lines().map(str::trim)) {
            let (keyword, rest) = keyword(line);
            let place = || Place { file: file.clone(), line: Some(number), column: None };
            if keyword == "newmtl" && rest.trim().is_empty() {
                let problem = Problem::at(place(), "a material without a name");
                self.warnings
                    .push(problem.remedy("only faces after a `usemtl` without a name have it; name it"));
            }
            if let Some(what) = Use::of(keyword) {
                let Some(maps) = statements.maps.last_mut() else { continue };
                match maps.add(what, rest, (path, self.trust), place()) {
                    Ok(warnings) => self.warnings.extend(warnings),
                    Err(problem) => self.refused.push(problem),
                }
            } else if statements.add(keyword, rest).is_none() {
                let problem = Problem::at(place(), format!("`{line}` makes no sense and is ignored"));
                self.warnings.push(problem.remedy(format!("give `{keyword}` finite numbers")));
            }
        }
        if statements.textures > 0 {
            let what = format!(
                "textures other than `map_Kd`, `map_Ke`, `map_d`, `map_Bump` and `norm` are not read, {} in all",
                statements.textures
            );
            self.warnings.push(Problem::at(Place::file(path), what));
        }
        let (materials, _) =
            tobj::load_mtl_buf(&mut statements.text.as_bytes()).map_err(|error| error.to_string())?;
        for ((material, name), maps) in materials.iter().zip(statements.names).zip(statements.maps) {
            self.materials.entry(name).or_insert_with(|| understand(material, maps));
        }
        Ok(())
    }
}

/// Statements of textures whose names do not start in `map_`.
const TEXTURES: [&str; 3] = ["decal", "disp", "refl"];

/// What is to be read by tobj.
#[derive(Debug, Default)]
struct Statements {
    /// One a line; materials are named by numbers.
    text: String,
    /// The names of the materials.
    names: Vec<String>,
    /// The pictures of each.
    maps: Vec<Maps>,
    /// How many statements of textures were left out.
    textures: usize,
}

impl Statements {
    /// Writes a line down as tobj can read it; `None` if it makes no sense. Lines of no interest are left out.
    fn add(&mut self, keyword: &str, rest: &str) -> Option<()> {
        let rest = match keyword {
            "newmtl" => {
                self.names.push(rest.trim().into());
                self.maps.push(Maps::default());
                self.names.len().to_string()
            }
            "Kd" | "Ks" | "Ke" | "Tf" => color(rest)?.map(|x| x.to_string()).join(" "),
            "Ns" | "Ni" | "Tr" | "Pr" | "Pm" | "Pc" => number(rest)?.to_string(),
            "d" => number(rest.trim_start().trim_start_matches("-halo"))?.to_string(),
            "illum" => rest.trim().parse::<u8>().ok()?.to_string(),
            _ => {
                self.textures += usize::from(keyword.starts_with("map_") || TEXTURES.contains(&keyword));
                return Some(());
            }
        };
        // What comes before the first material belongs to none.
        if !self.names.is_empty() {
            self.text.extend([keyword, " ", &rest, "\n"]);
        }
        Some(())
    }
}

fn understand(said: &tobj::Material, maps: Maps) -> Material {
    let [r, g, b] = said.emissive.unwrap_or_default().map(|x| single(x).max(0.0));
    let radiance = Rgb::new(r, g, b);
    let emission = maps.shining(radiance);
    let scattering = scattering(said, &maps);
    let matt = matches!(scattering, Scattering::Diffuse { .. });
    let black = !maps.has_diffuse();
    if matt
        && black
        && emission != Texture::gray(0.0)
        && said.diffuse.is_none_or(|kd| kd.iter().all(|&x| x <= 0.0))
    {
        return Scattering::Emission { radiance: emission, two_sided: false }.into();
    }
    let normal_map = maps.normal.map(Map::normal);
    let bump = maps.bump.filter(|_| normal_map.is_none()).map(Map::heights);
    Material { emission, normal_map, bump, opacity: maps.opacity.map(Map::opacity), scattering }
}

fn scattering(said: &tobj::Material, maps: &Maps) -> Scattering {
    let kd = maps.colored(said.diffuse.map(rgb));
    let ks = said.specular.filter(|ks| ks.iter().any(|&x| x > 0.0)).map(rgb);
    let exponent = said.shininess.filter(|&ns| ns > 0.0).map(|ns| single(ns).min(1e9));
    let mirror = matches!(said.illumination_model, Some(3 | 5 | 8));
    let highlight = !matches!(said.illumination_model, Some(0 | 1));
    if is_clear(said) {
        return Scattering::glass(ior(said));
    }
    if let Some(scattering) = extended(said, &kd) {
        return scattering;
    }
    match (ks, exponent) {
        (Some(reflectance), _) if mirror => {
            Scattering::Mirror { reflectance: Texture::Constant(reflectance) }
        }
        (Some(reflectance), Some(exponent)) if highlight => Scattering::glossy(exponent, reflectance, kd),
        _ => Scattering::Diffuse { reflectance: kd },
    }
}

/// What the names that start in `P` say, where they say anything.
fn extended(said: &tobj::Material, kd: &Texture) -> Option<Scattering> {
    let part = |keyword| Some(unknown(said, keyword).and_then(number)?.clamp(0.0, 1.0));
    let alpha = part("Pr").map(|roughness| roughness * roughness);
    if part("Pm").is_some_and(|metal| metal >= 0.5) {
        let of_exponent =
            said.shininess.filter(|&ns| ns > 0.0).map_or(0.0, |ns| single((2.0 / (ns + 2.0)).sqrt()));
        let optics =
            Optics::Artist { reflectance: said.diffuse.map_or(Rgb::gray(0.5), rgb), edge_tint: Rgb::WHITE };
        return Some(Scattering::metal(alpha.unwrap_or(of_exponent), optics));
    }
    let ior = ior(said);
    if part("Pc").is_some_and(|coat| coat >= 0.5) || alpha.is_some_and(|alpha| alpha < 0.05 * 0.05) {
        return Some(Scattering::glazed(ior, kd.clone()));
    }
    let alpha = alpha.filter(|&alpha| alpha < 1.0)?;
    let straight_on = ((ior - 1.0) / (ior + 1.0)).powi(2);
    let exponent = (2.0 / (alpha * alpha) - 2.0) / 4.0;
    let diffuse = scaled(kd, 1.0 - straight_on);
    Some(Scattering::glossy(exponent, Rgb::gray(straight_on), diffuse))
}

/// A texture made darker.
fn scaled(texture: &Texture, by: f32) -> Texture {
    match texture.clone() {
        Texture::Constant(color) => Texture::Constant(color.scale(by)),
        Texture::Image(mut image) => {
            image.factor = image.factor.scale(by);
            Texture::Image(image)
        }
        checker @ Texture::Checker(_) => checker,
    }
}

fn is_clear(said: &tobj::Material) -> bool {
    let tinted = |tf: [f32; 3]| tf.iter().any(|&x| x > 0.0) && tf.iter().any(|&x| x < 1.0);
    let refracts = said.optical_density.is_some_and(|ni| ni > 1.0);
    let dissolve = said.dissolve.map(single).or_else(|| Some(1.0 - unknown(said, "Tr").and_then(number)?));
    dissolve.is_some_and(|d| d > 0.0 && d < 1.0)
        || (refracts && matches!(said.illumination_model, Some(4..=7 | 9)))
        || (refracts && unknown(said, "Tf").and_then(color).is_some_and(tinted))
}

/// The index of refraction, that of glass where none above 1 is given.
fn ior(said: &tobj::Material) -> f32 {
    said.optical_density.filter(|&ni| ni > 1.0).map_or(1.5, |ni| single(ni).min(10.0))
}

/// What follows a keyword that tobj does not know.
fn unknown<'a>(said: &'a tobj::Material, keyword: &str) -> Option<&'a str> {
    said.unknown_param.get(keyword).map(String::as_str)
}

fn rgb(color: [f64; 3]) -> Rgb<f32> {
    color.map(|x| single(x).clamp(0.0, 1.0)).into()
}

/// One finite number.
fn number(rest: &str) -> Option<f32> {
    rest.split_whitespace().next()?.parse().ok().filter(|x: &f32| x.is_finite())
}

/// Three finite numbers, or one for all; not a spectrum.
fn color(rest: &str) -> Option<[f32; 3]> {
    let numbers: Vec<f32> = rest.split_whitespace().map_while(|word| word.parse().ok()).take(3).collect();
    let color = match *numbers.as_slice() {
        [x] => [x; 3],
        [r, g, b] => [r, g, b],
        _ => return None,
    };
    color.iter().all(|x| x.is_finite()).then_some(color)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Material {
        let trust = Trust::default();
        let mut library = Library::new(&trust);
        library.read(Path::new("x.mtl"), &format!("newmtl x\r\n{text}")).expect("read");
        assert!(library.warnings.is_empty(), "{:?}", library.warnings);
        library.materials.remove("x").expect("the material")
    }

    #[test]
    fn each_line_of_the_mapping() {
        let glass = Scattering::glass;
        let matt = |x| Scattering::Diffuse { reflectance: Texture::gray(x) };
        let glazed = |ior| Scattering::glazed(ior, Texture::gray(0.25));
        let metal = |alpha| {
            let optics = Optics::Artist { reflectance: Rgb::gray(0.25), edge_tint: Rgb::WHITE };
            Scattering::metal(alpha, optics)
        };
        let cases = [
            ("Kd 0.25 0.25 0.25", matt(0.25)),
            ("Kd 0.25\nKs 0 0 0\nNs 10", matt(0.25)),
            ("# nothing", matt(0.5)),
            ("Kd 2", matt(1.0)),
            ("Kd 0\nd 0\nNi 1\nillum 2", matt(0.0)),
            ("Kd 0\nTf 1 1 1\nTr 0.0\nNi 1.5\nillum 2", matt(0.0)),
            ("d 0.5", glass(1.5)),
            ("Tr 0.75\nNi 1.25", glass(1.25)),
            ("illum 7\nNi 2.4", glass(2.4)),
            ("Tf 1 0.5 1\nNi 1.33", glass(1.33)),
            ("illum 3\nKs 0.75", Scattering::Mirror { reflectance: Texture::gray(0.75) }),
            ("illum 5\nNi 1\nKs 1 1 1", Scattering::Mirror { reflectance: Texture::gray(1.0) }),
            ("Kd 0.25\nKs 1\nNs 10\nillum 1", matt(0.25)),
            ("Kd 0.25\nKs 1\nNs 10\nillum 0", matt(0.25)),
            ("Kd 0.25\nPr 1\nPm 0\nPs 0.5\nPcr 0.1\naniso 0.5", matt(0.25)),
            ("Kd 0.25\nPm 0", matt(0.25)),
            ("Kd 0.25\nPr 0.5\nPm 1\nillum 3\nKs 1", metal(0.25)),
            ("Kd 0.25\nPm 0.75\nNs 30", metal(0.25)),
            ("Kd 0.25\nPm 1\nd 0.5", glass(1.5)),
            ("Kd 0.25\nPr 0\nPm 0\nNi 1.25", glazed(1.25)),
            ("Kd 0.25\nPc 1\nNi 1", glazed(1.5)),
            (
                // alpha^2 is 1/18, 34 an exponent about the half vector.
                "Kd 0.5\nPr 0.48549177\nNi 3",
                Scattering::glossy(8.5, Rgb::gray(0.25), Texture::gray(0.375)),
            ),
            ("Kd 0.5\nKs 0.25\nNs 40", Scattering::glossy(40.0, Rgb::gray(0.25), Texture::gray(0.5))),
        ];
        for (text, expected) in cases {
            let rounded = match read(text).scattering {
                Scattering::Glossy { exponent, reflectance, diffuse, .. } => {
                    Scattering::glossy((exponent * 1e4).round() / 1e4, reflectance, diffuse)
                }
                other => other,
            };
            assert_eq!(rounded, expected, "{text}");
        }
    }

    #[test]
    fn what_shines_may_scatter_too() {
        let radiance = Rgb::new(0.0, 2.0, 0.0);
        let radiance = Texture::Constant(radiance);
        let alone = Scattering::Emission { radiance: radiance.clone(), two_sided: false };
        assert_eq!(read("Ke 0 2 0"), alone.clone().into(), "no Kd");
        assert_eq!(read("Ke 0 2 0\nKd 0 0 0\nKs 0 0 0\nNs 9"), alone.into(), "black");
        let cases = ["Kd 0.25 0.25 0.25", "d 0.5", "illum 3\nKs 0.75", "Kd 0\nKs 0.25\nNs 40"];
        for text in cases {
            let dark = read(text);
            assert_eq!(dark.emission, Texture::gray(0.0), "{text}");
            let expected = Material { emission: radiance.clone(), ..dark };
            assert_eq!(read(&format!("{text}\nKe 0 2 0")), expected, "{text}");
        }
    }

    #[test]
    fn the_first_of_a_name_counts_and_the_nameless_are_told() {
        let trust = Trust::default();
        let mut library = Library::new(&trust);
        library.read(Path::new("x.mtl"), "Kd 1\nnewmtl x\nKd 0.25\nnewmtl x\nKd 0.75\n").expect("read");
        let matt: Material = Scattering::Diffuse { reflectance: Texture::gray(0.25) }.into();
        assert_eq!(library.materials.get("x"), Some(&matt), "the first");
        library.read(Path::new("y.mtl"), "newmtl \nKd 0.25\nnewmtl y\nKd 0.25").expect("read");
        assert_eq!(library.materials.get(""), Some(&matt), "no name");
        assert_eq!(library.materials.get("y"), Some(&matt), "after one without a name");
        let warning = library.warnings[0].to_string();
        assert!(warning.starts_with("y.mtl:1: a material without a name"), "{warning}");
    }

    #[test]
    fn what_cannot_be_understood_is_told() {
        let trust = Trust::default();
        let mut library = Library::new(&trust);
        library
            .read(
                Path::new("x.mtl"),
                "newmtl x\nKd red\nNs nan\nmap_Kd x.png\nKs 1 2\nillum -1\nmap_Ks y.png\n",
            )
            .expect("read");
        let warnings: Vec<String> = library.warnings.iter().map(ToString::to_string).collect();
        let expected = [
            "x.mtl:2: `Kd red` makes no sense and is ignored; give `Kd` finite numbers",
            "x.mtl:3: `Ns nan` makes no sense and is ignored; give `Ns` finite numbers",
            "x.mtl:4: no such file `x.png`; paths are relative to the file that names them; the surface is made gray",
            "x.mtl:5: `Ks 1 2` makes no sense and is ignored; give `Ks` finite numbers",
            "x.mtl:6: `illum -1` makes no sense and is ignored; give `illum` finite numbers",
            "x.mtl: textures other than `map_Kd`, `map_Ke`, `map_d`, `map_Bump` and `norm` are not read, 1 in all",
        ];
        assert_eq!(warnings, expected, "warnings");
    }
}
