//! What tells one description from another.

use crate::scene::Description;
use serde_json::Value;
use std::path::Path;
use xxhash_rust::xxh3::xxh3_128;

/// 32 hexadecimal digits that are the same for what says the same: values count, written or by default, not how they are written
/// or spread over files. Files of meshes and pictures count by their names, as seen from `folder`, not by what they hold. Another
/// version of the program, with other keys, may give other digits. By XXH3 of 128 bits (Collet 2019) of the description in JSON.
#[must_use]
pub fn fingerprint(description: &Description, folder: &Path) -> String {
    digits(&related(description, folder))
}

/// 32 hexadecimal digits of a document, keys in their order.
pub(crate) fn digits(json: &Value) -> String {
    format!("{:032x}", xxh3_128(json.to_string().as_bytes()))
}

/// The description in JSON, files named as seen from `folder`.
pub(super) fn related(description: &Description, folder: &Path) -> Value {
    let mut json = description.to_json();
    relate(&mut json, folder);
    json
}

/// Leaves `folder` out of the names of files, so that it does not matter where the program runs.
fn relate(json: &mut Value, folder: &Path) {
    match json {
        Value::String(text) => {
            if let Ok(rest) = Path::new(&*text).strip_prefix(folder) {
                *text = rest.to_string_lossy().into_owned();
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| relate(item, folder)),
        Value::Object(entries) => entries.values_mut().for_each(|entry| relate(entry, folder)),
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;

    #[test]
    fn values_count_and_not_how_or_where_they_are_written() {
        let digits = |place: &str, text: &str, overrides: &[String]| {
            let folder = tempfile::tempdir().expect("a folder");
            let folder = folder.path().join(place);
            std::fs::create_dir_all(&folder).expect("made");
            std::fs::write(folder.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
            let path = folder.join("scene.toml");
            std::fs::write(&path, text).expect("written");
            let loaded = load(&path, overrides).unwrap_or_else(|error| panic!("{error}"));
            fingerprint(&loaded.description, &folder)
        };
        let mesh = "[[lights]]\ntype = 'mesh'\nfile = 'a.obj'\nradiance = 1\n";
        let one = digits("", &format!("{mesh}[render]\nspp = 4"), &[]);
        assert_eq!(one.len(), 32, "{one}");
        let two = format!("render = {{ spp = 0x4, seed = 0 }} # a comment\n{}", mesh.replace('1', "1.0"));
        assert_eq!(one, digits("some/where", &two, &[]), "the same, elsewhere and in other words");
        assert_eq!(one, digits("", mesh, &["render.spp=4".to_owned()]), "the same by an override");
        assert_ne!(one, digits("", mesh, &["render.spp=5".to_owned()]), "another");
    }
}
