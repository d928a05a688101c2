//! Materials of MTL files.
//!
//! MTL describes the shading of the 1990s; what it says is taken for the nearest material there is. In this order:
//!
//! | said | becomes |
//! |---|---|
//! | `illum` 4, 5, 6, 7 or 9 with `Ni` above 1; `d` between 0 and 1; `Tf` neither black nor white with `Ni` above 1 | dielectric of index `Ni`, 1.5 where that is not above 1, without absorption |
//! | `illum` 3, 5 or 8 with `Ks` above zero | mirror of reflectance `Ks` |
//! | `Ks` and `Ns` above zero | glossy of exponent `Ns` and reflectance `Ks` over a base of `Kd` |
//! | `Ke` above zero, `Kd` black or missing | emission alone |
//! | all else | diffuse of reflectance `Kd`, gray 0.5 where it is missing |
//!
//! Each of the others also gives off the radiance `Ke`.
//!
//! Lines are checked here, since tobj names none and panics at colours of one number, which stand for gray; what is left
//! is read by tobj. The first material of a name counts.
//!
//! `d 0` means opaque: exporters write it for opaque surfaces, and nobody draws invisible ones. `Tf` filters at a
//! surface and has no thickness to make absorption of. Textures are not read.

use super::outline::keyword;
use crate::error::{Place, Problem};
use crate::math::Rgb;
use crate::scene::description::{Material, Scattering, Texture};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Materials by name, and what was wrong with them.
#[derive(Debug, Default)]
pub(super) struct Library {
    pub(super) materials: HashMap<String, Material>,
    pub(super) warnings: Vec<Problem>,
}

impl Library {
    /// Adds the materials of a file; the first definition of a name counts. Fails, saying why, where tobj refuses all of
    /// it.
    pub(super) fn read(&mut self, path: &Path, text: &str) -> Result<(), String> {
        let file: Arc<Path> = path.into();
        let mut statements = String::new();
        let mut textures = 0;
        for (number, line) in (1..).zip(text.lines().map(str::trim)) {
            let (keyword, rest) = keyword(line);
            textures += usize::from(keyword.starts_with("map_"));
            if statement(&mut statements, keyword, rest).is_none() {
                let place = Place { file: file.clone(), line: Some(number), column: None };
                let problem = Problem::at(place, format!("`{line}` makes no sense and is ignored"));
                self.warnings.push(problem.remedy(format!("give `{keyword}` finite numbers")));
            }
        }
        if textures > 0 {
            let what = format!("textures are not read, {textures} in all");
            self.warnings.push(Problem::at(Place::file(path), what));
        }
        let (materials, _) =
            tobj::load_mtl_buf(&mut statements.as_bytes()).map_err(|error| error.to_string())?;
        for material in materials {
            let understood = understand(&material);
            self.materials.entry(material.name).or_insert(understood);
        }
        Ok(())
    }
}

/// Writes a line down as tobj can read it; `None` if it makes no sense. Lines of no interest are left out.
fn statement(statements: &mut String, keyword: &str, rest: &str) -> Option<()> {
    let rest = match keyword {
        "newmtl" => rest.trim().to_owned(),
        "Kd" | "Ks" | "Ke" | "Tf" => color(rest)?.map(|x| x.to_string()).join(" "),
        "Ns" | "Ni" | "Tr" => number(rest)?.to_string(),
        "d" => number(rest.trim_start().trim_start_matches("-halo"))?.to_string(),
        "illum" => rest.trim().parse::<u8>().ok()?.to_string(),
        _ => return Some(()),
    };
    statements.extend([keyword, " ", &rest, "\n"]);
    Some(())
}

fn understand(said: &tobj::Material) -> Material {
    let [r, g, b] = said.emissive.unwrap_or_default().map(|x| x.max(0.0));
    let radiance = Rgb::new(r, g, b);
    let scattering = scattering(said);
    let matt = matches!(scattering, Scattering::Diffuse { .. });
    if matt && !radiance.is_black() && said.diffuse.is_none_or(|kd| kd.iter().all(|&x| x <= 0.0)) {
        return Scattering::Emission { radiance, two_sided: false }.into();
    }
    Material { emission: radiance, scattering }
}

fn scattering(said: &tobj::Material) -> Scattering {
    let rgb = |[r, g, b]: [f32; 3]| Rgb::new(r.clamp(0.0, 1.0), g.clamp(0.0, 1.0), b.clamp(0.0, 1.0));
    let kd = Texture::Constant(rgb(said.diffuse.unwrap_or([0.5; 3])));
    let ks = said.specular.filter(|ks| ks.iter().any(|&x| x > 0.0)).map(rgb);
    let exponent = said.shininess.filter(|&ns| ns > 0.0).map(|ns| ns.min(1e9));
    let mirror = matches!(said.illumination_model, Some(3 | 5 | 8));
    match (ks, exponent) {
        _ if is_clear(said) => {
            let ior = said.optical_density.filter(|&ni| ni > 1.0).map_or(1.5, |ni| ni.min(10.0));
            Scattering::Dielectric { ior, absorption: Rgb::BLACK, priority: 0 }
        }
        (Some(reflectance), _) if mirror => Scattering::Mirror { reflectance },
        (Some(reflectance), Some(exponent)) => Scattering::Glossy { exponent, reflectance, diffuse: kd },
        _ => Scattering::Diffuse { reflectance: kd },
    }
}

fn is_clear(said: &tobj::Material) -> bool {
    let unknown = |keyword| said.unknown_param.get(keyword).map(String::as_str);
    let tinted = |tf: [f32; 3]| tf.iter().any(|&x| x > 0.0) && tf.iter().any(|&x| x < 1.0);
    let refracts = said.optical_density.is_some_and(|ni| ni > 1.0);
    let dissolve = said.dissolve.or_else(|| Some(1.0 - unknown("Tr").and_then(number)?));
    dissolve.is_some_and(|d| d > 0.0 && d < 1.0)
        || (refracts && matches!(said.illumination_model, Some(4..=7 | 9)))
        || (refracts && unknown("Tf").and_then(color).is_some_and(tinted))
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
        let mut library = Library::default();
        library.read(Path::new("x.mtl"), &format!("newmtl x\r\n{text}")).expect("read");
        assert!(library.warnings.is_empty(), "{:?}", library.warnings);
        library.materials.remove("x").expect("the material")
    }

    #[test]
    fn each_line_of_the_mapping() {
        let glass = |ior| Scattering::Dielectric { ior, absorption: Rgb::BLACK, priority: 0 };
        let matt = |x| Scattering::Diffuse { reflectance: Texture::gray(x) };
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
            ("illum 3\nKs 0.75", Scattering::Mirror { reflectance: Rgb::gray(0.75) }),
            ("illum 5\nNi 1\nKs 1 1 1", Scattering::Mirror { reflectance: Rgb::WHITE }),
            (
                "Kd 0.5\nKs 0.25\nNs 40",
                Scattering::Glossy {
                    exponent: 40.0,
                    reflectance: Rgb::gray(0.25),
                    diffuse: Texture::gray(0.5),
                },
            ),
        ];
        for (text, expected) in cases {
            assert_eq!(read(text), expected.into(), "{text}");
        }
    }

    #[test]
    fn what_shines_may_scatter_too() {
        let radiance = Rgb::new(0.0, 2.0, 0.0);
        let alone = Scattering::Emission { radiance, two_sided: false };
        assert_eq!(read("Ke 0 2 0"), alone.clone().into(), "no Kd");
        assert_eq!(read("Ke 0 2 0\nKd 0 0 0\nKs 0 0 0\nNs 9"), alone.into(), "black");
        let cases = ["Kd 0.25 0.25 0.25", "d 0.5", "illum 3\nKs 0.75", "Kd 0\nKs 0.25\nNs 40"];
        for text in cases {
            let dark = read(text);
            assert_eq!(dark.emission, Rgb::BLACK, "{text}");
            let expected = Material { emission: radiance, ..dark };
            assert_eq!(read(&format!("{text}\nKe 0 2 0")), expected, "{text}");
        }
    }

    #[test]
    fn the_first_of_a_name_counts_and_the_nameless_are_refused() {
        let mut library = Library::default();
        library.read(Path::new("x.mtl"), "Kd 1\nnewmtl x\nKd 0.25\nnewmtl x\nKd 0.75\n").expect("read");
        let matt: Material = Scattering::Diffuse { reflectance: Texture::gray(0.25) }.into();
        assert_eq!(library.materials.get("x"), Some(&matt), "the first");
        assert_eq!(
            library.read(Path::new("x.mtl"), "newmtl\n"),
            Err("invalid object name".into()),
            "no name"
        );
    }

    #[test]
    fn what_cannot_be_understood_is_told() {
        let mut library = Library::default();
        library
            .read(Path::new("x.mtl"), "newmtl x\nKd red\nNs nan\nmap_Kd x.png\nKs 1 2\nillum -1\n")
            .expect("read");
        let warnings: Vec<String> = library.warnings.iter().map(ToString::to_string).collect();
        let expected = [
            "x.mtl:2: `Kd red` makes no sense and is ignored; give `Kd` finite numbers",
            "x.mtl:3: `Ns nan` makes no sense and is ignored; give `Ns` finite numbers",
            "x.mtl:5: `Ks 1 2` makes no sense and is ignored; give `Ks` finite numbers",
            "x.mtl:6: `illum -1` makes no sense and is ignored; give `illum` finite numbers",
            "x.mtl: textures are not read, 1 in all",
        ];
        assert_eq!(warnings, expected, "warnings");
    }
}
