//! A scene of all kinds of light paths.

#![allow(dead_code, reason = "each program uses a part")]

/// A ball of rough copper and one of glass in a room with a lamp.
pub(crate) fn room(settings: &str) -> String {
    format!(
        r#"
        [camera]
        from = [0.0, 1.0, 4.0]
        at = [0.0, 0.8, 0.0]
        vfov_deg = 50.0
        [film]
        width = 37
        height = 21
        [render]
        {settings}
        [materials.copper]
        type = "conductor"
        metal = "Cu"
        alpha = 0.2
        [materials.glass]
        type = "dielectric"
        [materials.wall]
        type = "diffuse"
        reflectance = [0.7, 0.6, 0.5]
        [[shapes]]
        type = "sphere"
        center = [-0.7, 0.5, 0.0]
        radius = 0.5
        material = "copper"
        [[shapes]]
        type = "sphere"
        center = [0.7, 0.5, 0.3]
        radius = 0.5
        material = "glass"
        [[shapes]]
        type = "rectangle"
        edge_u = [4.0, 0.0, 0.0]
        edge_v = [0.0, 0.0, -4.0]
        material = "wall"
        [[lights]]
        type = "rectangle"
        center = [0.0, 3.0, 0.0]
        edge_u = [0.5, 0.0, 0.0]
        edge_v = [0.0, 0.0, 0.5]
        radiance = 9.0
        "#
    )
}

/// The same with a ball whose reflections are filtered.
pub(crate) fn fuzzy_room(settings: &str) -> String {
    let copper = "type = \"conductor\"\n        metal = \"Cu\"\n        alpha = 0.2";
    let text = room(&format!("{settings}\n        glossy = \"two-pass\""));
    assert!(text.contains(copper), "the ball");
    text.replace(copper, "type = \"glossy\"\n        exponent = 60\n        reflectance = 0.8")
}
