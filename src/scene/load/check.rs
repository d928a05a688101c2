//! What the keys of one table must satisfy together.

use crate::bsdf::MOST_PARTS;
use crate::camera::Viewpoint;
use crate::material::conductors;
use crate::scene::description::{
    Bump, Camera, CameraKey, Form, Lie, Light, Material, NormalMap, Optics, Scattering, Shape, Step,
};
use crate::scene::load::decode::Fields;
use crate::scene::track;
use glam::{DMat3, DVec3, DVec4, Vec3};
use std::f32::consts::PI;

/// Sine of the least angle between directions that count as different. Smaller accepts frames whose axes are mostly
/// rounding error; larger refuses views that are meant.
const PARALLEL: f64 = 1e-5;

/// Whether two vectors span no area, be it because one of them has no length.
fn parallel(a: Vec3, b: Vec3) -> bool {
    // Double precision holds the squares of all that single precision holds.
    let [a, b] = [a, b].map(Vec3::as_dvec3);
    let span = a.cross(b).length();
    span <= PARALLEL * a.length() * b.length()
}

/// A camera looks somewhere at every key, knows what is up there, and how it turns to the next; its iris spans an area, its
/// shutter opens before it closes.
pub(crate) fn camera(camera: &Camera, fields: &mut Fields<'_>) {
    let Camera::Perspective { from, at, up, blades, shutter_open_s, shutter_close_s, keys, .. } = camera;
    if let Some((key, what, remedy)) = view_fault((*from, *at, *up)) {
        fields.problem(key, what, remedy);
    }
    if (1..3).contains(blades) {
        let what = format!("an iris of {blades} `blades` has no area");
        fields.problem("blades", what, "give 3 or more, or 0 for a round one");
    }
    if shutter_close_s < shutter_open_s {
        let what =
            format!("`shutter_close_s` is {shutter_close_s}, before the shutter opens at {shutter_open_s}");
        let remedy = "give a later moment, or the same one for a picture of one moment";
        fields.problem("shutter_close_s", what, remedy);
    }
    times(keys, |key| key.time_s, fields);
    if !fields.is_whole("keys", keys) {
        return;
    }
    let view = |key: &CameraKey| (key.from.unwrap_or(*from), key.at.unwrap_or(*at), key.up.unwrap_or(*up));
    for (i, key) in keys.iter().enumerate() {
        if let Some((name, what, remedy)) = view_fault(view(key)) {
            fields.problem_in(("keys", i, name), what, remedy);
        }
    }
    let turned = |key: &CameraKey| {
        let (from, at, up) = view(key);
        let up = up.as_dvec3().normalize().as_vec3();
        Viewpoint::new([Vec3::ZERO, (at - from).as_vec3(), up], 1.0).rotation
    };
    for (i, pair) in keys.windows(2).enumerate() {
        let sound = pair.iter().all(|key| view_fault(view(key)).is_none());
        if sound && PI - turned(&pair[0]).angle_between(turned(&pair[1])) < UNDECIDED {
            let what =
                "the camera is turned by half a turn from the key before, and which way round is not said";
            fields.problem_in(("keys", i + 1, "at"), what, "add a key in between");
        }
    }
}

/// Where a camera stands, where it looks, and what is up.
type View = (DVec3, DVec3, Vec3);

/// What is wrong with where a camera stands, where it looks and what is up: the key that says so, and what to do.
fn view_fault((from, at, up): View) -> Option<(&'static str, &'static str, &'static str)> {
    let view = (at - from).as_vec3();
    if view == Vec3::ZERO {
        return Some(("at", "`at` is where the camera stands", "give another point to look at"));
    }
    if !view.length().is_normal() {
        let what = "`at` is too near to the camera, or too far away, for single precision";
        return Some(("at", what, "give another point to look at"));
    }
    parallel(view, up).then_some(("up", "`up` points along the view", "give another direction"))
}

/// The least angle that the turn of a camera may lack of half a turn: less, and rounding chooses the way round.
const UNDECIDED: f32 = 1e-3;

/// The keys of a shape lead from one to the next.
pub(crate) fn shape(shape: &Shape, fields: &mut Fields<'_>) {
    let keys = &shape.keys;
    times(keys, |key| key.time_s, fields);
    if !fields.is_whole("keys", keys) {
        return;
    }
    let single = keys.iter().map(|key| track::fault_of_one(key)).enumerate();
    let between = keys.windows(2).map(|pair| match pair {
        [from, to] if [from, to].iter().all(|key| track::fault_of_one(key).is_none()) => {
            track::fault(from, to)
        }
        _ => None,
    });
    for (i, fault) in single.chain((1..).zip(between)) {
        if let Some((what, remedy)) = fault {
            fields.problem_in(("keys", i, "transform"), what, remedy);
        }
    }
}

/// Keys are none, or two or more in the order of time.
fn times<T>(keys: &[T], time_s: impl Fn(&T) -> f64, fields: &mut Fields<'_>) {
    if !fields.is_whole("keys", keys) {
        return;
    }
    if keys.len() == 1 {
        fields.problem("keys", track::ONE.0, track::ONE.1);
    }
    for (i, pair) in keys.windows(2).enumerate() {
        let [before, here] = [&pair[0], &pair[1]].map(&time_s);
        if here <= before {
            let what = format!("`time_s` is {here}, not after {before} of the key before");
            fields.problem_in(("keys", i + 1, "time_s"), what, "put the keys in the order of time");
        }
    }
}

/// Edges span an area, boxes have corners in order, axes have two ends, rings have a hole.
pub(crate) fn form(form: &Form, fields: &mut Fields<'_>) {
    match *form {
        Form::Rectangle { edge_u, edge_v, .. } => edges(edge_u, edge_v, fields),
        Form::Box { min, max } if !min.cmplt(max).all() => {
            fields.problem("max", "`max` is not above `min` on every axis", "give the lower corner as `min`");
        }
        Form::Cylinder { from, to, .. } | Form::Cone { from, to, .. } if from == to => {
            fields.problem("to", "`to` is where the axis starts", "give another point as its other end");
        }
        Form::Torus { major_radius, minor_radius, .. } if minor_radius >= major_radius => {
            let remedy = "a ring needs a hole; give a thinner tube or a larger `major_radius`";
            fields.problem("minor_radius", "`minor_radius` is not below `major_radius`", remedy);
        }
        _ => {}
    }
}

/// Normals are not mirrored.
pub(crate) fn normal_map(normals: &NormalMap, fields: &mut Fields<'_>) {
    unmirrored(&normals.lie, fields);
}

/// Heights are not mirrored.
pub(crate) fn bump(heights: &Bump, fields: &mut Fields<'_>) {
    unmirrored(&heights.lie, fields);
}

fn unmirrored(lie: &Lie, fields: &mut Fields<'_>) {
    if lie.repeat.iter().any(|&times| times <= 0.0) {
        fields.problem("repeat", "`repeat` of a relief is not above 0", "give positive numbers");
    }
}

/// A surface has one relief at most.
pub(crate) fn material(material: &Material, fields: &mut Fields<'_>) {
    if material.normal_map.is_some() && material.bump.is_some() {
        fields.problem("bump", "`bump` beside `normal_map`", "give one of them");
    }
}

/// Metals are known by name.
pub(crate) fn optics(optics: &Optics, fields: &mut Fields<'_>) {
    let Optics::Metal { metal } = optics else { return };
    if conductors::named(metal).is_none() {
        let remedy = format!("known are {}", conductors::NAMES.join(", "));
        fields.problem("metal", format!("unknown metal `{}`", metal.value), remedy);
    }
}

/// Mixes have parts, and make no light.
pub(crate) fn scattering(scattering: &Scattering, fields: &mut Fields<'_>) {
    let Scattering::Mix { parts } = scattering else { return };
    if !fields.is_whole("parts", parts) {
        return;
    }
    let remedy = format!("give one to {MOST_PARTS}");
    if parts.is_empty() {
        fields.problem("parts", "`parts` is empty", &remedy);
    } else if parts.len() > MOST_PARTS {
        fields.problem("parts", "`parts` has too many entries", &remedy);
    }
    let sum = parts.iter().fold([0.0; 3], |[r, g, b], part| {
        let weight = part.weight;
        [r + weight.r, g + weight.g, b + weight.b]
    });
    if sum.iter().any(|total| *total > 1.0 + 1e-5) {
        fields.problem("parts", "the weights of `parts` add up to more than 1", "give them smaller weights");
    }
}

/// Edges span an area, spots aim somewhere.
pub(crate) fn light(light: &Light, fields: &mut Fields<'_>) {
    match *light {
        Light::Rectangle { edge_u, edge_v, .. } => edges(edge_u, edge_v, fields),
        Light::Spot { position, at, .. } if (at - position).as_vec3() == Vec3::ZERO => {
            fields.problem("at", "`at` is where the light stands", "give another point to aim at");
        }
        _ => {}
    }
}

fn edges(edge_u: Vec3, edge_v: Vec3, fields: &mut Fields<'_>) {
    if parallel(edge_u, edge_v) {
        fields.problem("edge_v", "`edge_v` is parallel to `edge_u`", "give edges that span an area");
    }
}

/// Steps can be undone.
pub(crate) fn step(step: &Step, fields: &mut Fields<'_>) {
    match *step {
        Step::Scale { scale } if scale.0.as_vec3().cmpeq(Vec3::ZERO).any() => {
            fields.problem("scale", "`scale` is zero", "give factors other than zero");
        }
        Step::Matrix { matrix: [a, b, c, _, d, e, f, _, g, h, i, _, last @ ..] } => {
            let linear = DMat3::from_cols_array(&[a, d, g, b, e, h, c, f, i]);
            if DVec4::from(last) != DVec4::W {
                let remedy = "give the matrix row by row; the last row must be 0, 0, 0, 1";
                fields.problem("matrix", "`matrix` is not affine", remedy);
            } else if linear.determinant() == 0.0 {
                fields.problem("matrix", "`matrix` has no inverse", "give one whose determinant is not zero");
            }
        }
        _ => {}
    }
}
