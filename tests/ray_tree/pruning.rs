//! What cutting ray trees takes from pictures, predicted and measured, over depth and least throughput: a ball of glass in white light,
//! and two mirrors that face each other. `cargo test --test ray_tree pruning -- --nocapture` prints the tables of
//! `benches/record/pruning.md`.

use crate::support::scene_of;
use crate::tree::{BALL_IN_FURNACE, at_angle, fresnel, mirrors, trace, whitted};
use glam::Vec3;
use specula::geometry::Ray;

/// Interfaces that a path may meet.
const INTERFACES: [u32; 6] = [2, 3, 4, 8, 16, 64];

/// Least throughputs.
const LEAST: [f64; 5] = [0.0, 1e-4, 1e-3, 1e-2, 1e-1];

/// Rings of equal area that the disc of the ball is looked at in.
const RINGS: u16 = 1000;

/// What is lost of a radiance of 1 behind a ball of this reflectance: whatever would carry less than `eps`, and what is still inside after
/// so many interfaces. Without `eps` that is (1 - R) R^(interfaces - 1).
fn lost_in_ball(r: f64, interfaces: u32, eps: f64) -> f64 {
    let cut = |carried: f64| if carried < eps { carried } else { 0.0 };
    let mut inside = 1.0 - r;
    let mut lost = cut(r) + cut(inside);
    for _ in 2..=interfaces {
        if inside < eps {
            return lost;
        }
        lost += cut(inside * (1.0 - r));
        inside *= r;
        lost += cut(inside);
    }
    if inside < eps { lost } else { lost + inside }
}

/// The most that can be lost: eps / (1 - R) by throughput, and the mirrored ray if that is faint; by depth as above.
fn bound_of_ball(r: f64, interfaces: u32, eps: f64) -> f64 {
    let by_depth = (1.0 - r) * r.powi(interfaces.cast_signed() - 1);
    let by_throughput = if eps > 0.0 { eps / (1.0 - r) + if r < eps { r } else { 0.0 } } else { 0.0 };
    by_depth + by_throughput
}

/// Sines of the angles at which rays meet the rings of the ball.
fn rings() -> impl Iterator<Item = f64> {
    (0..RINGS).map(|i| ((f64::from(i) + 0.5) / f64::from(RINGS)).sqrt())
}

#[test]
fn a_ball_lacks_what_is_predicted_over_depth_and_throughput() {
    let scene = scene_of(BALL_IN_FURNACE);
    println!("| interfaces | least throughput | predicted | measured | bound | rays |");
    println!("|---|---|---|---|---|---|");
    for interfaces in INTERFACES {
        for eps in LEAST {
            #[expect(clippy::cast_possible_truncation, reason = "a knob")]
            let tree = whitted(interfaces + 1, eps as f32);
            let (mut predicted, mut measured, mut bound, mut rays) = (0.0, 0.0, 0.0, 0);
            for sin in rings() {
                let angle = sin.asin().to_degrees();
                let r = fresnel(angle, 1.5);
                let (found, counters) = trace(&scene, tree, at_angle(angle), 0);
                predicted += lost_in_ball(r, interfaces, eps);
                bound += bound_of_ball(r, interfaces, eps);
                measured += 1.0 - f64::from(found.color.g);
                rays += counters.rays();
            }
            let n = f64::from(RINGS);
            let [predicted, measured, bound] = [predicted / n, measured / n, bound / n];
            #[expect(clippy::cast_precision_loss, reason = "a mean")]
            let rays = rays as f64 / n;
            println!(
                "| {interfaces} | {eps:e} | {predicted:.3e} | {measured:.3e} | {bound:.3e} | {rays:.1} |"
            );
            // Rings whose ways carry just about the limit fall to either side: of a thousand, one or two.
            let allowed = 0.01 * predicted + 2e-6 + 2e-3 * eps;
            assert!((measured - predicted).abs() < allowed, "{interfaces} {eps}: {measured} for {predicted}");
            assert!(measured < bound + 1e-6, "{interfaces} {eps}: {measured} exceeds {bound}");
        }
    }
}

#[test]
fn one_ray_lacks_what_is_predicted_to_rounding() {
    let scene = scene_of(BALL_IN_FURNACE);
    for angle in [0.0, 45.0, 60.0, 75.0, 80.0] {
        for interfaces in INTERFACES {
            for eps in LEAST {
                let r = fresnel(angle, 1.5);
                #[expect(clippy::cast_possible_truncation, reason = "a knob")]
                let tree = whitted(interfaces + 1, eps as f32);
                let (found, _) = trace(&scene, tree, at_angle(angle), 0);
                let deficit = 1.0 - f64::from(found.color.g);
                let predicted = lost_in_ball(r, interfaces, eps);
                let allowed = 4e-6 + 1e-3 * predicted;
                assert!(
                    (deficit - predicted).abs() < allowed,
                    "{angle} {interfaces} {eps}: {deficit} {predicted}"
                );
            }
        }
    }
}

/// Of 1 / (1 - k), what walls of reflectance `k` lose that are seen `depth` times at most, and none that would carry less than `eps`.
fn lost_between_mirrors(k: f64, depth: u32, eps: f64) -> f64 {
    let seen = (1..depth).find(|walls| k.powi(walls.cast_signed()) < eps).unwrap_or(depth);
    k.powi(seen.cast_signed()) / (1.0 - k)
}

#[test]
fn mirrors_lack_what_is_predicted_over_depth_and_throughput() {
    println!("| reflectance | depth | least throughput | predicted | measured |");
    println!("|---|---|---|---|---|");
    for k in [0.8, 0.9, 0.99] {
        let scene = scene_of(&mirrors(k));
        let ray = Ray::new(Vec3::new(0.01, 0.02, 0.0), Vec3::Z);
        for depth in [5, 20, 50, 200, 1000] {
            for eps in LEAST {
                #[expect(clippy::cast_possible_truncation, reason = "a knob")]
                let (found, _) = trace(&scene, whitted(depth, eps as f32), ray, 0);
                let total = 1.0 / (1.0 - k);
                let measured = total - f64::from(found.color.g);
                let predicted = lost_between_mirrors(k, depth, eps);
                println!("| {k} | {depth} | {eps:e} | {predicted:.3e} | {measured:.3e} |");
                let allowed = 1e-3 * predicted + 4e-6 * total;
                assert!(
                    (measured - predicted).abs() < allowed,
                    "{k} {depth} {eps}: {measured} for {predicted}"
                );
            }
        }
    }
}
