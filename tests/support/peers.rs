//! Scenes that other renderers have rendered, `peer-scenes` of the data, from their own description to a scene file.

use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

/// A scene file with this table `render`, for a picture of so many pixels along each side.
///
/// # Panics
/// If the description is not as its README says.
pub(crate) fn scene_file(folder: &Path, name: &str, render: &str, size: u32) -> String {
    let text = std::fs::read_to_string(folder.join(name).join("scene.json")).expect("a description");
    let scene: Value = serde_json::from_str(&text).expect("JSON");
    let camera = &scene["camera"];
    let mut file = format!(
        "[camera]\nfrom = {}\nat = {}\nup = {}\nvfov_deg = {:?}\n[film]\nwidth = {size}\nheight = {size}\n\
         filter = \"box\"\n[render]\nmax_depth = {}\n{render}\n",
        numbers(&camera["origin"]),
        numbers(&camera["target"]),
        numbers(&camera["up"]),
        camera["vfov"].as_f64().expect("an angle"),
        scene["max_depth"],
    );
    for shape in scene["shapes"].as_array().expect("shapes") {
        let material = &shape["material"];
        let mesh = folder.join(name).join(shape["obj"].as_str().expect("a file"));
        let place = format!("type = \"mesh\"\nfile = {mesh:?}\n");
        let own = shape["name"].as_str().expect("a name");
        let surface = match material["type"].as_str() {
            Some("emitter") => {
                let radiance = numbers(&material["radiance"]);
                write!(file, "[[lights]]\n{place}radiance = {radiance}\n").expect("a string");
                continue;
            }
            Some("diffuse") => format!("type = \"diffuse\"\nreflectance = {}", numbers(&material["albedo"])),
            _ => format!(
                "type = \"conductor\"\neta = {}\nk = {}\nalpha = {:?}",
                numbers(&material["eta"]),
                numbers(&material["k"]),
                material["alpha"].as_f64().expect("a roughness"),
            ),
        };
        write!(
            file,
            "[materials.{own}]\n{surface}\n[[shapes]]\n{place}normals = \"flat\"\nmaterial = \"{own}\"\n"
        )
        .expect("a string");
    }
    if !scene["environment"].is_null() {
        let radiance = numbers(&scene["environment"]);
        write!(file, "[[lights]]\ntype = \"environment\"\nradiance = {radiance}\n").expect("a string");
    }
    file
}

/// An array of numbers in TOML, which wants a point or none in all of them.
fn numbers(array: &Value) -> String {
    let numbers: Option<Vec<f64>> = array.as_array().expect("numbers").iter().map(Value::as_f64).collect();
    format!("{:?}", numbers.expect("numbers"))
}
