//! Bodies on a floor under a lamp.

#![allow(dead_code, reason = "each program uses a part")]

/// A scene of all kinds of light paths: a ball of rough copper and one of glass.
pub(crate) fn room(settings: &str) -> String {
    let head = "
        from = [0.0, 1.0, 4.0]
        at = [0.0, 0.8, 0.0]
        vfov_deg = 50.0
        [film]";
    let bodies = r#"
        [materials.copper]
        type = "conductor"
        metal = "Cu"
        alpha = 0.2
        [materials.glass]
        type = "dielectric"
        [[shapes]]
        type = "sphere"
        center = [-0.7, 0.5, 0.0]
        radius = 0.5
        material = "copper"
        [[shapes]]
        type = "sphere"
        center = [0.7, 0.5, 0.3]
        radius = 0.5
        material = "glass""#;
    let lamp = "
        center = [0.0, 3.0, 0.0]
        edge_u = [0.5, 0.0, 0.0]
        edge_v = [0.0, 0.0, 0.5]
        radiance = 9.0";
    scene(head, settings, bodies, ("[0.7, 0.6, 0.5]", 4.0), lamp)
}

/// The same with a ball whose reflections are filtered.
pub(crate) fn fuzzy_room(settings: &str) -> String {
    let copper = "type = \"conductor\"\n        metal = \"Cu\"\n        alpha = 0.2";
    let text = room(&format!("{settings}\n        glossy = \"two-pass\""));
    assert!(text.contains(copper), "the ball");
    text.replace(copper, "type = \"glossy\"\n        exponent = 60\n        reflectance = 0.8")
}

/// A scene whose noise behaves, a fuzzy ball in a corner of bright walls: much of the light has bounced, and none of it is rare.
pub(crate) fn corner(settings: &str) -> String {
    let head = r#"
        from = [1.0, 1.2, 3.0]
        at = [-0.2, 0.6, 0.0]
        vfov_deg = 45.0
        [film]
        filter = "box""#;
    let bodies = r#"
        [materials.ball]
        type = "glossy"
        exponent = 20.0
        [[shapes]]
        type = "rectangle"
        center = [0.0, 0.0, -1.0]
        edge_u = [9.0, 0.0, 0.0]
        edge_v = [0.0, 9.0, 0.0]
        material = "wall"
        [[shapes]]
        type = "sphere"
        center = [0.0, 0.5, 0.0]
        radius = 0.5
        material = "ball""#;
    let lamp = "
        center = [0.0, 3.0, 1.0]
        edge_u = [1.0, 0.0, 0.0]
        edge_v = [0.0, 0.0, 1.0]
        radiance = 4.0";
    scene(head, settings, bodies, ("[0.8, 0.7, 0.6]", 9.0), lamp)
}

/// Where it is seen from, bodies, the floor by its colour and half its side, the lamp.
fn scene(head: &str, settings: &str, bodies: &str, (wall, floor): (&str, f32), lamp: &str) -> String {
    format!(
        r#"
        [camera]{head}
        width = 37
        height = 21
        [render]
        {settings}{bodies}
        [materials.wall]
        type = "diffuse"
        reflectance = {wall}
        [[shapes]]
        type = "rectangle"
        edge_u = [{floor:?}, 0.0, 0.0]
        edge_v = [0.0, 0.0, -{floor:?}]
        material = "wall"
        [[lights]]
        type = "rectangle"{lamp}
        "#
    )
}
