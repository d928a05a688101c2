//! The schema agrees with the loader: what the schema refuses, the loader refuses too, and both accept the
//! scenes that ship. What it means is worked out here independently of the code that makes it.

use serde_json::Value as Json;
use specula::error::Error;
use specula::scene::{self, Loaded};
use std::fs;
use std::path::Path;

/// A scene file as a validator of JSON sees it.
fn json(toml: &str) -> Json {
    toml::from_str(toml).unwrap_or_else(|error| panic!("no TOML: {error}\n{toml}"))
}

/// What is wrong with a value by a schema, for the keywords that the scene schema uses; an unknown keyword is a fault, so
/// that none goes unchecked.
fn faults(schema: &Json, value: &Json, root: &Json, path: &str, out: &mut Vec<String>) {
    let ok = |schema: &Json| {
        let mut faults_of_one = Vec::new();
        faults(schema, value, root, path, &mut faults_of_one);
        faults_of_one.is_empty()
    };
    for (keyword, rule) in schema.as_object().expect("a schema is an object") {
        let good = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "default" => true,
            "properties" | "required" | "additionalProperties" => check_object(schema, keyword, value),
            "$ref" => ok(root.pointer(&text(rule)[1..]).expect("the reference resolves")),
            "oneOf" => list(rule).iter().filter(|schema| ok(schema)).count() == 1,
            "anyOf" => list(rule).iter().any(ok),
            "enum" => list(rule).contains(value),
            "const" => rule == value,
            "type" => is_type(value, text(rule)),
            "minLength" => value.as_str().is_none_or(|value| value.chars().count() as f64 >= number(rule)),
            "minItems" => value.as_array().is_none_or(|items| items.len() as f64 >= number(rule)),
            "maxItems" => value.as_array().is_none_or(|items| items.len() as f64 <= number(rule)),
            "minimum" => value.as_f64().is_none_or(|value| value >= number(rule)),
            "maximum" => value.as_f64().is_none_or(|value| value <= number(rule)),
            "exclusiveMinimum" => value.as_f64().is_none_or(|value| value > number(rule)),
            "exclusiveMaximum" => value.as_f64().is_none_or(|value| value < number(rule)),
            "items" => {
                let items = value.as_array().map_or(&[][..], Vec::as_slice);
                items
                    .iter()
                    .enumerate()
                    .for_each(|(i, item)| faults(rule, item, root, &format!("{path}.{i}"), out));
                true
            }
            _ => panic!("unknown keyword {keyword}"),
        };
        if !good {
            out.push(format!("{path}: {keyword} {rule}"));
        }
    }
    let Some(object) = value.as_object() else { return };
    for (key, value) in object {
        let other = &schema["additionalProperties"];
        let rule = schema["properties"].get(key).or_else(|| other.is_object().then_some(other));
        if let Some(rule) = rule {
            faults(rule, value, root, &format!("{path}.{key}"), out);
        }
    }
}

fn check_object(schema: &Json, keyword: &str, value: &Json) -> bool {
    let Some(object) = value.as_object() else { return true };
    match keyword {
        "required" => list(&schema["required"]).iter().all(|key| object.contains_key(text(key))),
        "additionalProperties" if schema["additionalProperties"] == false => {
            object.keys().all(|key| schema["properties"].get(key).is_some())
        }
        _ => true,
    }
}

fn is_type(value: &Json, kind: &str) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|value| value.fract() == 0.0),
        _ => panic!("unknown type {kind}"),
    }
}

fn list(json: &Json) -> &[Json] {
    json.as_array().expect("an array")
}

fn text(json: &Json) -> &str {
    json.as_str().expect("a string")
}

fn number(json: &Json) -> f64 {
    json.as_f64().expect("a number")
}

fn faults_of(toml: &str) -> Vec<String> {
    let schema = scene::schema();
    let mut found = Vec::new();
    faults(&schema, &json(toml), &schema, "", &mut found);
    found
}

/// What the loader makes of a file of this text.
fn load(dir: &Path, toml: &str) -> Result<Loaded, Error> {
    let path = dir.join("scene.toml");
    fs::write(&path, toml).expect("written");
    scene::load(&path, &[])
}

/// Every key is explained, and says what it is where it is left out or that it must not be.
#[test]
fn every_key_is_described() {
    fn walk(schema: &Json, path: &str, seen: &mut usize) {
        if let Some(properties) = schema.get("properties").and_then(Json::as_object) {
            for (key, value) in properties {
                *seen += 1;
                let text = value.get("description").and_then(Json::as_str).unwrap_or("");
                assert!(text.len() > 3 && text.ends_with('.'), "{path}.{key}: described as {text:?}");
            }
        }
        match schema {
            Json::Object(map) => map.iter().for_each(|(k, v)| walk(v, &format!("{path}.{k}"), seen)),
            Json::Array(items) => items.iter().for_each(|v| walk(v, path, seen)),
            _ => {}
        }
    }
    let mut seen = 0;
    walk(&scene::schema(), "", &mut seen);
    assert!(seen > 100, "only {seen} keys were found");
}

#[test]
fn shipped_scenes_are_valid() {
    let folder = fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes")).expect("the scenes");
    let mut files: Vec<_> = folder.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    assert!(files.len() >= 16, "all of them: {files:?}");
    for path in files {
        let text = fs::read_to_string(&path).expect("readable");
        let errors = faults_of(&text);
        assert!(errors.is_empty(), "{}:\n{}", path.display(), errors.join("\n"));
    }
}

/// Texts that both accept: together they use every kind of table.
const GOOD: &[&str] = &[
    "",
    "camera = {}\nfilm = {}\nrender = {}\nmaterials = {}\nshapes = []\nlights = []\ninclude = []",
    "[camera]\ntype = 'perspective'\nfrom = [0, 1, 2.5]\nat = [0, 0, 0]\nup = [0, 1, 0]\nvfov_deg = 30",
    "[camera]\nshutter_open_s = -1\nshutter_close_s = 0.5\nkeys = [{ time_s = 0 }, { time_s = 1, from = [0, 1, 2], \
     at = [1, 0, 0], up = [0, 0, 1], vfov_deg = 20 }]",
    "[materials.m]\ntype = 'mirror'\n[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\nkeys = [{ time_s = 0 }, \
     { time_s = 1.5, transform = [{ scale = 2 }, { translate = [1, 0, 0] }] }]",
    "[film]\nwidth = 1\nheight = 65536\nfilter = 'box'\nfilter_radius = 0.5\nexposure_ev = -2\ntone = 'clip'",
    "[render]\nintegrator = 'view'\nview = 'cost'\nspp = 1\nmax_depth = 2\nmin_throughput = 0\nbackend = 'brute'\n\
     sampler = 'independent'\nglass_shadows = 'opaque'\ndirect = 'light'\nseed = 9223372036854775807",
    "[render]\nsampler = 'sobol'",
    "[render]\nsampler = 'stratified'\nspp = 7",
    "[render]\nsampler = 'blue_noise'",
    "[materials]\na = { type = 'diffuse' }\nb = { type = 'mirror', reflectance = [1, 0, 0.5], emission = 2 }\n\
     c = { type = 'conductor', metal = 'Au', alpha = 0.1 }\nd = { type = 'conductor', eta = 1, k = [1, 2, 3] }\n\
     e = { type = 'conductor', reflectance = 0.9, edge_tint = 1 }\nf = { type = 'dielectric', ior = 1 }\n\
     g = { type = 'glossy', diffuse = { checker = [0, [1, 1, 1]], repeat = [2, 4] } }\n\
     h = { type = 'glazed', reflectance = 0.25 }\ni = { type = 'emission', radiance = 5, two_sided = true }",
    "[materials.m]\ntype = 'mirror'\n[[shapes]]\ntype = 'sphere'\nname = 's'\nmaterial = 'm'\nhidden = true\n\
     [[shapes]]\ntype = 'instance'\nof = 's'\ntransform = [{ scale = 2 }, { scale = [1, 2, 3] },\n\
     { rotate_deg = 30, axis = [0, 1, 0] }, { translate = [1, 0, 0] }, { fit = 1 },\n\
     { matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }]",
    "[materials.m]\ntype = 'mirror'\n[[shapes]]\ntype = 'mesh'\nfile = 'mesh.obj'\nnormals = 'smooth'\n\
     [[shapes]]\ntype = 'disc'\nmaterial = 'm'\n[[shapes]]\ntype = 'box'\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n\
     material = 'm'\n[[shapes]]\ntype = 'rectangle'\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\nmaterial = 'm'",
    "[materials.m]\ntype = 'mirror'\n[[shapes]]\ntype = 'cylinder'\nmaterial = 'm'\nfrom = [0, 0, 0]\nto = [1, 0, 0]\n\
     radius = 2\ncaps = false\n[[shapes]]\ntype = 'cone'\nmaterial = 'm'\nradius = 1\nend_radius = 0.5\n[[shapes]]\n\
     type = 'torus'\nmaterial = 'm'\ncenter = [0, 1, 0]\naxis = [0, 0, 2]\nmajor_radius = 2\nminor_radius = 1.5\n\
     [[shapes]]\ntype = 'height_field'\nmaterial = 'm'\nfile = 'hills.png'\ncenter = [0, 0, 0]\nsize = [2, 3]\n\
     height = [-1, 1]\nnormals = 'flat'",
    "lights = [{ type = 'point', position = [0, 0, 0], intensity = 1 }, { type = 'directional', \
     direction = [0, -1, 0], irradiance = 1 }, { type = 'spot', position = [0, 1, 0], at = [0, 0, 0], \
     intensity = [1, 2, 3], angle_deg = 180, softness = 1 }, { type = 'rectangle', center = [0, 0, 0], \
     edge_u = [1, 0, 0], edge_v = [0, 1, 0], radiance = 1 }, { type = 'disc', center = [0, 0, 0], \
     normal = [0, 1, 0], radius = 1, radiance = 1 }, { type = 'sphere', center = [0, 0, 0], radius = 1, \
     radiance = 1 }, { type = 'mesh', file = 'mesh.obj', radiance = 1, transform = [{ scale = 2 }] }, \
     { type = 'environment', radiance = 0.5, scale = 2, rotate_deg = 90 }, { type = 'environment', \
     file = 'sky.hdr' }]",
];

/// Texts that both refuse.
const BAD: &[&str] = &[
    "shapes = {}",
    "materials = []",
    "camera = 3",
    "colour = 1",
    "include = 'a.toml'",
    "[camera]\nvfov_deg = 180",
    "[camera]\nfrom = [0, 1]",
    "[camera]\nfrom = [0, 1, '2']",
    "[camera]\ntype = 'fisheye'",
    "[camera]\nvfov = 50",
    "[camera]\nkeys = [{ from = [0, 1, 0] }, { time_s = 1 }]",
    "[camera]\nshutter_close_s = '1/48'",
    "[[shapes]]\ntype = 'sphere'\nkeys = [{ time_s = 0, transform = {} }, { time_s = 1 }]",
    "[film]\nwidth = 0",
    "[film]\nwidth = 1.5",
    "[film]\nwidth = 65537",
    "[film]\nfilter = 'cubic'",
    "[film]\nfilter_radius = 0",
    "[render]\nseed = -1",
    "[render]\nspp = true",
    "[render]\nmin_throughput = 1.5",
    "[render]\nsampler = 'halton'",
    "[materials]\na = {}",
    "[materials]\na = { type = 'glass' }",
    "[materials]\na = { type = 'diffuse', reflectance = 1.1 }",
    "[materials]\na = { type = 'diffuse', reflectance = [1, 1] }",
    "[materials]\na = { type = 'diffuse', reflectance = [1, 1, -1] }",
    "[materials]\na = { type = 'diffuse', reflectance = { checker = [0, 2] } }",
    "[materials]\na = { type = 'diffuse', reflectance = { chequer = [0, 1] } }",
    "[materials]\na = { type = 'diffuse', radius = 1 }",
    "[materials]\na = { type = 'conductor' }",
    "[materials]\na = { type = 'conductor', eta = 1 }",
    "[materials]\na = { type = 'conductor', eta = 0, k = 1 }",
    "[materials]\na = { type = 'conductor', metal = 'Au', eta = 1, k = 1 }",
    "[materials]\na = { type = 'dielectric', priority = 0.5 }",
    "[materials]\na = { type = 'emission' }",
    "[[shapes]]\ntype = 'instance'",
    "[[shapes]]\ntype = 'mesh'\nfile = ''",
    "[[shapes]]\ntype = 'mesh'\nfile = 'mesh.obj'\ntransform = [{}]",
    "[[shapes]]\ntype = 'mesh'\nfile = 'mesh.obj'\ntransform = [{ scale = 1, translate = [0, 0, 0] }]",
    "[[shapes]]\ntype = 'mesh'\nfile = 'mesh.obj'\ntransform = [{ rotate_deg = 1 }]",
    "[[shapes]]\ntype = 'mesh'\nfile = 'mesh.obj'\ntransform = [{ matrix = [1, 2, 3] }]",
    "[[shapes]]\ntype = 'cylinder'\nradius = 0",
    "[[shapes]]\ntype = 'cone'\nend_radius = -1",
    "[[shapes]]\ntype = 'torus'\naxis = [0, 0]",
    "[[shapes]]\ntype = 'torus'\nradius = 1",
    "[[shapes]]\ntype = 'height_field'",
    "[[shapes]]\ntype = 'height_field'\nfile = 'hills.png'\nsize = [1, 2, 3]",
    "[[shapes]]\ntype = 'height_field'\nfile = 'hills.png'\nnormals = 'file'",
    "[[lights]]\ntype = 'point'\nposition = [0, 0, 0]",
    "[[lights]]\ntype = 'environment'",
    "[[lights]]\ntype = 'environment'\nradiance = 1\nfile = 'sky.hdr'",
    "[[lights]]\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = -1\nradiance = 1",
];

/// A folder with the files that the texts name.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("a temporary directory");
    fs::write(dir.path().join("mesh.obj"), "").expect("written");
    fs::write(dir.path().join("sky.hdr"), "").expect("written");
    fs::write(dir.path().join("hills.png"), "").expect("written");
    dir
}

#[test]
fn schema_and_loader_agree() {
    let dir = folder();
    for text in GOOD {
        let errors = faults_of(text);
        assert!(errors.is_empty(), "the schema refuses\n{text}\n{}", errors.join("\n"));
        if let Err(error) = load(dir.path(), text) {
            panic!("the loader refuses\n{text}\n{error}");
        }
    }
    for text in BAD {
        assert!(!faults_of(text).is_empty(), "the schema accepts\n{text}");
        assert!(load(dir.path(), text).is_err(), "the loader accepts\n{text}");
    }
}

/// A description written out and read again is the same, places aside, and so says the schema.
#[test]
fn descriptions_survive_being_written() {
    let dir = folder();
    for text in GOOD {
        let first = load(dir.path(), text).expect("good").description.to_json();
        let written = toml::to_string(&first).expect("JSON without nulls is TOML");
        assert_eq!(faults_of(&written), [""; 0], "by the schema:\n{written}");
        let second = load(dir.path(), &written).unwrap_or_else(|error| panic!("{error}\nof\n{written}"));
        assert_eq!(second.description.to_json(), first, "of\n{text}");
    }
}
