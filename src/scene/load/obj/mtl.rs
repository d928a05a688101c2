//! Materials of MTL files.
//!
//! MTL describes the shading of the 1990s; what it says is taken for the nearest material there is. In this order:
//!
//! | said | becomes |
//! |---|---|
//! | `Ke` above zero | emission of that radiance |
//! | `illum` 4, 5, 6, 7 or 9 with `Ni` above 1; `d` between 0 and 1; `Tf` neither black nor white with `Ni` above 1 | dielectric of index `Ni`, 1.5 where that is not above 1, without absorption |
//! | `illum` 3, 5 or 8 with `Ks` above zero | mirror of reflectance `Ks` |
//! | `Ks` and `Ns` above zero | glossy of exponent `Ns` and reflectance `Ks` over a base of `Kd` |
//! | all else | diffuse of reflectance `Kd`, gray 0.5 where it is missing |
//!
//! `d 0` means opaque: exporters write it for opaque surfaces, and nobody draws invisible ones. `Tf` filters at a
//! surface and has no thickness to make absorption of. Textures are not read.

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

/// What an MTL file says of a material.
#[derive(Clone, Debug, Default)]
struct Entry {
    name: String,
    kd: Option<[f32; 3]>,
    ks: [f32; 3],
    ke: [f32; 3],
    tf: Option<[f32; 3]>,
    ns: f32,
    ni: f32,
    dissolve: Option<f32>,
    illum: u32,
}

impl Library {
    /// Adds the materials of a file; the first definition of a name counts.
    pub(super) fn read(&mut self, path: &Path, text: &str) {
        let file: Arc<Path> = path.into();
        let mut entry: Option<Entry> = None;
        let mut textures = 0;
        for (number, line) in (1..).zip(text.lines()) {
            let (keyword, rest) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
            if keyword == "newmtl" {
                self.add(entry.replace(Entry { name: rest.trim().into(), ..Entry::default() }));
                continue;
            }
            textures += usize::from(keyword.starts_with("map_"));
            if let Some(entry) = &mut entry
                && entry.set(keyword, rest).is_none()
            {
                let place = Place { file: file.clone(), line: Some(number), column: None };
                let problem = Problem::at(place, format!("`{}` makes no sense and is ignored", line.trim()));
                self.warnings.push(problem.remedy(format!("give `{keyword}` finite numbers")));
            }
        }
        self.add(entry);
        if textures > 0 {
            let what = format!("textures are not read, {textures} in all");
            self.warnings.push(Problem::at(Place::file(path), what));
        }
    }

    fn add(&mut self, entry: Option<Entry>) {
        if let Some(entry) = entry {
            let material = entry.scattering().into();
            self.materials.entry(entry.name).or_insert(material);
        }
    }
}

impl Entry {
    /// Takes in one line; `None` if it cannot be understood. Lines of no interest are understood.
    fn set(&mut self, keyword: &str, rest: &str) -> Option<()> {
        match keyword {
            "Kd" => self.kd = Some(color(rest)?),
            "Ks" => self.ks = color(rest)?,
            "Ke" => self.ke = color(rest)?,
            "Tf" => self.tf = Some(color(rest)?),
            "Ns" => self.ns = number(rest)?,
            "Ni" => self.ni = number(rest)?,
            "d" => self.dissolve = Some(number(rest.trim_start().trim_start_matches("-halo"))?),
            "Tr" if self.dissolve.is_none() => self.dissolve = Some(1.0 - number(rest)?),
            "illum" => self.illum = rest.trim().parse().ok()?,
            _ => {}
        }
        Some(())
    }

    fn scattering(&self) -> Scattering {
        let rgb = |[r, g, b]: [f32; 3]| Rgb::new(r.clamp(0.0, 1.0), g.clamp(0.0, 1.0), b.clamp(0.0, 1.0));
        let kd = Texture::Constant(rgb(self.kd.unwrap_or([0.5; 3])));
        let shiny = self.ks.iter().any(|&x| x > 0.0);
        if self.ke.iter().any(|&x| x > 0.0) {
            let [r, g, b] = self.ke.map(|x| x.max(0.0));
            Scattering::Emission { radiance: Rgb::new(r, g, b), two_sided: false }
        } else if self.is_clear() {
            let ior = if self.ni > 1.0 { self.ni.min(10.0) } else { 1.5 };
            Scattering::Dielectric { ior, absorption: Rgb::BLACK, priority: 0 }
        } else if shiny && [3, 5, 8].contains(&self.illum) {
            Scattering::Mirror { reflectance: rgb(self.ks) }
        } else if shiny && self.ns > 0.0 {
            let exponent = self.ns.min(1e9);
            Scattering::Glossy { exponent, reflectance: rgb(self.ks), diffuse: kd }
        } else {
            Scattering::Diffuse { reflectance: kd }
        }
    }

    fn is_clear(&self) -> bool {
        let tinted = |tf: [f32; 3]| tf.iter().any(|&x| x > 0.0) && tf.iter().any(|&x| x < 1.0);
        let refracts = self.ni > 1.0;
        self.dissolve.is_some_and(|d| d > 0.0 && d < 1.0)
            || (refracts && [4, 5, 6, 7, 9].contains(&self.illum))
            || (refracts && self.tf.is_some_and(tinted))
    }
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

    fn read(text: &str) -> Scattering {
        let mut library = Library::default();
        library.read(Path::new("x.mtl"), &format!("newmtl x\r\n{text}"));
        assert!(library.warnings.is_empty(), "{:?}", library.warnings);
        library.materials.remove("x").expect("the material").scattering
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
            ("Ke 0 2 0\nd 0.5", Scattering::Emission { radiance: Rgb::new(0.0, 2.0, 0.0), two_sided: false }),
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
            assert_eq!(read(text), expected, "{text}");
        }
    }

    #[test]
    fn what_cannot_be_understood_is_told() {
        let mut library = Library::default();
        library.read(Path::new("x.mtl"), "newmtl x\nKd red\nNs nan\nmap_Kd x.png\nKs 1 2\n");
        let warnings: Vec<String> = library.warnings.iter().map(ToString::to_string).collect();
        let expected = [
            "x.mtl:2: `Kd red` makes no sense and is ignored; give `Kd` finite numbers",
            "x.mtl:3: `Ns nan` makes no sense and is ignored; give `Ns` finite numbers",
            "x.mtl:5: `Ks 1 2` makes no sense and is ignored; give `Ks` finite numbers",
            "x.mtl: textures are not read, 1 in all",
        ];
        assert_eq!(warnings, expected, "warnings");
    }
}
