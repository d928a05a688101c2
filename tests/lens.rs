//! The thin lens against optics: sizes of blur discs, the plane in focus, the area of the iris, and no lens at all.
//! Significance: see `support/estimates.rs`.

#[path = "support/estimates.rs"]
mod estimates;
#[path = "support/statistics.rs"]
mod statistics;
#[path = "support/scene.rs"]
mod support;

use estimates::{Estimate, LIMIT};
use glam::{DVec2, Vec2};
use specula::accel::{Accel, Brute};
use specula::sampling::{Dim, Sampler, SamplerKind, Vertex};
use specula::scene::{self, Scene};
use statistics::chi_square_tail;
use std::f64::consts::PI;
use support::scene_of;

/// The lens of the table: 50 mm, f/2, focused at 2 m, in metres.
const FOCAL: f64 = 0.05;
const RADIUS: f64 = FOCAL / 4.0;
const FOCUS: f64 = 2.0;

/// Half the width of the film, seen from one metre behind it.
const REACH: f64 = 0.015;

/// A shining disc at `depth` seen under the same angle from every depth, through that lens.
fn scene_with(depth: f64, apparent: f64, iris: &str) -> Scene {
    scene_of(&format!(
        r#"
        [film]
        width = 100
        height = 100
        [camera]
        from = [0.0, 0.0, 0.0]
        at = [0.0, 0.0, -1.0]
        vfov_deg = {vfov:?}
        lens_radius = {RADIUS:?}
        focus_distance = {FOCUS:?}
        {iris}
        [materials.light]
        type = "emission"
        radiance = 1.0
        [[shapes]]
        type = "disc"
        center = [0.0, 0.0, {depth:?}]
        normal = [0.0, 0.0, 1.0]
        radius = {radius:?}
        material = "light"
        "#,
        vfov = 2.0 * REACH.atan().to_degrees(),
        depth = -depth,
        radius = apparent * depth,
    ))
}

/// Film points, as tangents of their angles to the axis, of those of `rays` rays that meet the disc.
fn blur(scene: &Scene, rays: u32) -> Vec<DVec2> {
    let accel = Brute::new(scene.world.clone());
    let hits = (0..rays).filter_map(|index| {
        let sampler = SamplerKind::Independent.start(3, [0_u32, 0], index);
        let film = sampler.get_2d(Dim::Film, Vertex::ROOT).map(|u| u * 100.0);
        let ray = scene.camera.ray(film, sampler.get_2d(Dim::Lens, Vertex::ROOT), 0.0);
        accel.intersect(&ray).map(|_| (Vec2::from(film).as_dvec2() / 50.0 - 1.0) * REACH)
    });
    hits.collect()
}

#[test]
fn blur_discs_have_the_diameters_of_the_table() {
    // Depth in metres, diameter on the sensor in millimetres.
    for (depth, printed) in
        [(1.0, 0.641_026), (1.5, 0.213_675), (2.0, 0.0), (4.0, 0.320_513), (1e6, 0.641_026)]
    {
        let image_distance = FOCAL * FOCUS / (FOCUS - FOCAL);
        let diameter = 2.0 * RADIUS * f64::abs(depth - FOCUS) / depth * FOCAL / (FOCUS - FOCAL);
        assert!((diameter * 1e3 - printed).abs() < 2e-6, "table {printed}, {diameter}");
        let apparent = 0.002;
        let found = blur(&scene_with(depth, apparent, ""), 2_000_000);
        // The picture of a disc is the disc convolved with that of a point; second and fourth moments of both are those of
        // uniform discs.
        let (a2, b2) = ((diameter / image_distance / 2.0).powi(2), f64::powi(apparent, 2));
        let second = Estimate::of(found.iter().map(|p| p.length_squared()));
        let fourth = Estimate::of(found.iter().map(|p| p.length_squared().powi(2)));
        let off = [
            second.off((a2 + b2) / 2.0),
            fourth.off((a2 * a2 + b2 * b2) / 3.0 + a2 * b2),
            Estimate::of(found.iter().map(|p| p.x)).mean.abs() / (second.mean / found.len() as f64).sqrt(),
        ];
        assert!(off.into_iter().all(|off| off < LIMIT), "depth {depth}: {off:?} standard errors");
        assert!(second.error < 0.01 * second.mean, "depth {depth}: too noisy to tell, {second:?}");
    }
}

#[test]
fn an_iris_is_filled_alike_and_has_the_area_of_its_polygon() {
    const CELLS: usize = 24;
    for (blades, turn) in [(0_u32, 0.0), (3, 0.0), (4, 45.0), (5, 10.0), (8, -20.0)] {
        let iris = format!("blades = {blades}\nblade_rotation_deg = {turn:?}");
        let scene = scene_with(1.0, 0.1, &iris);
        let corners = if blades == 0 { 4096.0 } else { f64::from(blades) };
        let area = corners / 2.0 * (2.0 * PI / corners).sin();
        let is_inside = |p: DVec2| {
            let sector = 2.0 * PI / corners;
            let angle = (p.to_angle() - (PI / 2.0 + f64::to_radians(turn))).rem_euclid(sector) - sector / 2.0;
            p.length() * angle.cos() <= (sector / 2.0).cos()
        };
        let n = 400_000_u32;
        let mut counts = vec![0.0; CELLS * CELLS];
        for index in 0..n {
            let sampler = SamplerKind::Independent.start(11, [0_u32, 0], index);
            let ray = scene.camera.ray([30.0, 70.0], sampler.get_2d(Dim::Lens, Vertex::ROOT), 0.0);
            let p = ray.o.truncate().as_dvec2() / RADIUS;
            assert!(is_inside(p * (1.0 - 1e-6)), "{blades} blades: {p} is outside");
            let cell = ((p + 1.0) / 2.0 * CELLS as f64).min(DVec2::splat(CELLS as f64 - 0.5));
            let cell = cell.as_usizevec2();
            counts[cell.y * CELLS + cell.x] += 1.0;
        }
        let corner = |i: usize, j: usize| DVec2::new(i as f64, j as f64) * 2.0 / CELLS as f64 - 1.0;
        let whole = |cell: usize| {
            let (i, j) = (cell % CELLS, cell / CELLS);
            [[0, 0], [1, 0], [0, 1], [1, 1]].into_iter().all(|[x, y]| is_inside(corner(i + x, j + y)))
        };
        // Cells within the iris, each of the same share of its area, and the rest together.
        let cells: Vec<usize> = (0..CELLS * CELLS).filter(|&cell| whole(cell)).collect();
        let share = (2.0 / CELLS as f64).powi(2) / area;
        let expected = f64::from(n) * share;
        let rest = f64::from(n) * (1.0 - share * cells.len() as f64);
        let inside: f64 = cells.iter().map(|&cell| counts[cell]).sum();
        let chi2 = cells.iter().map(|&cell| (counts[cell] - expected).powi(2) / expected).sum::<f64>()
            + (f64::from(n) - inside - rest).powi(2) / rest;
        assert!(
            cells.len() > 100 && rest > 100.0,
            "{blades} blades: {} cells, {rest} beside them",
            cells.len()
        );
        let p = chi_square_tail(chi2, cells.len());
        assert!(p > 5e-6, "{blades} blades: chi^2 {chi2} of {} cells, p = {p}", cells.len());
    }
}

/// Balls and a wall, with a row of bright discs at `depth` before a camera with that lens.
fn row(depth: f64, camera: &str) -> Scene {
    let discs: String = [-0.5, 0.0, 0.5]
        .map(|x| {
            format!(
                "[[shapes]]\ntype = 'disc'\ncenter = [{x:?}, 0, {z:?}]\nnormal = [0, 0, 1]\nradius = 0.2\nmaterial = 'light'\n",
                z = -depth
            )
        })
        .concat();
    scene_of(&format!(
        "[film]\nwidth = 96\nheight = 40\n[render]\nspp = 8\nbackend = 'brute'\n[camera]\nfrom = [0, 0, 0]\nat = [0, 0, -1]\n\
         vfov_deg = 40\n{camera}\n[materials.light]\ntype = 'emission'\nradiance = 1\n{discs}"
    ))
}

fn bits(scene: &Scene) -> Vec<u32> {
    support::bits(&support::film(scene)).concat()
}

#[test]
fn what_is_in_the_plane_in_focus_is_as_sharp_as_through_a_pinhole() {
    let differing = |depth: f64, camera: &str| {
        let (lens, pinhole) = (bits(&row(depth, camera)), bits(&row(depth, "")));
        lens.iter().zip(&pinhole).filter(|(a, b)| a != b).count() as f64 / lens.len() as f64
    };
    for camera in
        ["lens_radius = 0.1\nfocus_distance = 2", "lens_radius = 0.1\nfocus_distance = 2\nblades = 5"]
    {
        // The same film samples meet the same things, but for rounding at rims.
        let found = differing(2.0, camera);
        assert!(found < 2e-3, "{found} of the pixels differ in focus");
        let found = differing(1.5, camera);
        assert!(found > 0.03, "only {found} of the pixels differ out of focus");
    }
}

#[test]
fn no_radius_is_the_pinhole_bit_for_bit() {
    let pinhole = bits(&row(1.5, ""));
    let keys = "lens_radius = 0\nfocus_distance = 0.7\nblades = 6\nblade_rotation_deg = 30";
    assert!(bits(&row(1.5, keys)) == pinhole, "still");
    let moving = |focus: &str| {
        let keys = format!("keys = [{{ time_s = 0{focus} }}, {{ time_s = 1, from = [0.1, 0, 0] }}]");
        row(1.5, &format!("shutter_close_s = 1\n{keys}"))
    };
    assert!(bits(&moving(", focus_distance = 0.5")) == bits(&moving("")), "moving");
    let focus_only = "shutter_close_s = 1\nkeys = [{ time_s = 0 }, { time_s = 1, focus_distance = 9 }]";
    assert!(!row(1.5, focus_only).camera.is_moving(), "a focus without a lens moves nothing");
    assert!(row(1.5, &format!("lens_radius = 0.1\n{focus_only}")).camera.is_moving(), "with a lens it does");
}

#[test]
fn focus_is_where_the_camera_looks_unless_it_is_said() {
    let focus =
        |camera: &str, time| row(1.5, &format!("lens_radius = 0.1\n{camera}")).camera.pinhole(time).focus();
    let close = |found: f32, wanted: f32| (found - wanted).abs() < 1e-6;
    assert!(close(focus("", 0.0), 1.0), "through `at`");
    assert!(close(focus("focus_distance = 7.5", 0.0), 7.5), "as said");
    let keys =
        "shutter_close_s = 1\nkeys = [{ time_s = 0, at = [0, 0, -3] }, { time_s = 1, focus_distance = 5 }]";
    assert!(close(focus(keys, 0.0), 3.0), "through the key's `at`");
    assert!(close(focus(keys, 0.25), 3.5), "on the way");
    assert!(close(focus(&format!("focus_distance = 2\n{keys}"), 0.0), 2.0), "the camera's own");
    assert!(close(focus(&format!("focus_distance = 2\n{keys}"), 1.0), 5.0), "the key's");
}

#[test]
fn wrong_lenses_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    for (key, column, what) in [
        ("blades = 2", 10, "an iris of 2 `blades` has no area; give 3 or more, or 0 for a round one"),
        ("blades = -3", 10, "`blades` is -3; it must be an integer from 0 to 1000"),
        ("lens_radius = -1", 15, "`lens_radius` is -1; it must be a number of at least 0 m"),
        ("focus_distance = 0", 18, "`focus_distance` is 0; it must be a number above 0 m"),
    ] {
        std::fs::write(&path, format!("[camera]\n{key}\n")).expect("a scene");
        let error = scene::load(&path, &[]).expect_err("wrong").to_string();
        let line = format!("scene.toml:2:{column}: {what}");
        assert!(error.contains(&line), "{line} is not in\n{error}");
    }
}
