//! Laws of the tree of lights: it chooses each emitter with the probability that it says, never leaves out one that shines, and is the
//! same at every width.

#[path = "support/random.rs"]
mod random;

use glam::Vec3 as Point3;
use random::Random;
use specula::light::tree::Leaf;
use specula::light::{
    Area, Directional, DiscArea, Light, LightId, LightTree, MeshArea, Point, RectangleArea, Reference,
    SphereLight, Spot, spot_versines,
};
use specula::math::lanes::{Isa, Kernel, Lanes, Level};
use specula::math::{Rgb, Vec3};

fn point(random: &mut Random, size: f32) -> Point3 {
    (Point3::from(random.triple()) * 2.0 - 1.0) * size
}

/// Lights of every kind that is somewhere, and one that is not.
fn lights() -> Vec<Light> {
    let mut random = Random::new(1);
    let mut all = Vec::new();
    for i in 0..60_u16 {
        let center = point(&mut random, 10.0);
        let normal = Point3::from(random.direction());
        let (x, y) = normal.any_orthonormal_pair();
        let size = random.logarithmic(0.01, 2.0);
        let radiance = Rgb::gray(random.logarithmic(0.1, 100.0));
        let two_sided = i % 4 == 0;
        let position = Vec3::from(center);
        let [versine_outer, versine_inner] = spot_versines(random.unit() * 3.0, random.unit());
        let axis = Vec3::from(normal);
        all.push(match i % 6 {
            0 | 5 => {
                let surface = RectangleArea::new(center, x * size, y * size * 0.3);
                Light::Rectangle(Area { surface, radiance, two_sided })
            }
            1 => Light::Disc(Area { surface: DiscArea::new(center, normal, size), radiance, two_sided }),
            2 => Light::Sphere(SphereLight { center: position, radius: size, radiance, two_sided: false }),
            3 => Light::Point(Point { position, intensity: radiance }),
            _ => Light::Spot(Spot { position, axis, intensity: radiance, versine_outer, versine_inner }),
        });
    }
    for count in [3_u16, 40] {
        let triangles = (0..count).map(|_| {
            let a = point(&mut random, 3.0);
            [a, a + point(&mut random, 0.5), a + point(&mut random, 0.5)]
        });
        let mut triangles: Vec<_> = triangles.collect();
        // One of no area, and one that is far off.
        triangles[1] = [Point3::ONE; 3];
        let surface = MeshArea::new(triangles).expect("has area");
        all.push(Light::Mesh(Area { surface, radiance: Rgb::gray(3.0), two_sided: false }));
    }
    all.push(Light::Directional(Directional {
        direction: Vec3::new(0.0, -1.0, 0.0),
        irradiance: Rgb::WHITE,
    }));
    all
}

fn tree_of(lights: &[Light]) -> LightTree {
    LightTree::new((0..).map(LightId).zip(lights)).expect("emitters")
}

/// Reference points near and far, among the lights, on them and beside them.
fn references(count: usize) -> Vec<Reference<f32>> {
    let mut random = Random::new(2);
    let mut all: Vec<_> = (0..count)
        .map(|i| {
            let size = [1.0, 12.0, 40.0, 1e4][i % 4];
            Reference { p: point(&mut random, size).into(), n: random.direction() }
        })
        .collect();
    for light in lights() {
        if let Light::Point(light) = light {
            all.push(Reference { p: light.position, n: random.direction() });
        }
    }
    all
}

#[test]
fn leaves_are_all_emitters() {
    let lights = lights();
    let tree = tree_of(&lights);
    // Sixty, a mesh of few triangles, 39 triangles of that of many; nothing at infinity.
    assert_eq!(tree.leaves().len(), 60 + 1 + 39, "{:?}", tree.leaves());
    assert_eq!(LightTree::count(&lights), 100, "counted beforehand");
    let split: Vec<_> = (0..63).filter(|&id| tree.is_split(LightId(id))).collect();
    assert_eq!(split, [61], "only the large mesh");
    assert!(LightTree::new([(LightId(0), &lights[62])]).is_none(), "nothing to choose from");
    let at = references(1)[0];
    for leaf in [Leaf { light: LightId(62), part: None }, Leaf { light: LightId(61), part: Some(1) }] {
        assert!(tree.probability(at, leaf).to_bits() == 0, "{leaf:?} is not in the tree");
    }
}

#[test]
fn probabilities_add_up_and_are_those_of_the_draws() {
    let lights = lights();
    let tree = tree_of(&lights);
    let (mut nothing, mut points) = (0.0, 0.0);
    for at in references(60) {
        let all: f64 = tree.leaves().iter().map(|&leaf| f64::from(tree.probability(at, leaf))).sum();
        assert!(all < 1.0 + 1e-4, "{at:?}: {all}");
        // Numbers at equal steps: how many lead to a leaf is its probability to within the ends of its piece.
        let steps = 1_u16 << 12;
        // A group may seem to matter of which no part does: the walk ends there, with nothing.
        let (mut counts, mut none) = (vec![0.0_f64; tree.leaves().len()], 0.0);
        for i in 0..steps {
            let drawn = tree.sample(at, (f32::from(i) + 0.5) / f32::from(steps));
            if drawn.probability > 0.0 {
                counts[drawn.leaf as usize] += 1.0 / f64::from(steps);
                let told = tree.probability(at, tree.leaves()[drawn.leaf as usize]);
                assert!((told / drawn.probability - 1.0).abs() < 1e-5, "{told} for {drawn:?}");
            } else {
                none += 1.0 / f64::from(steps);
            }
        }
        let pieces = 100.0 / f64::from(steps);
        assert!((all + none - 1.0).abs() < 1e-4 + pieces, "{at:?}: {all} of leaves, {none} of nothing");
        if all > 0.0 {
            (nothing, points) = (nothing + none, points + 1.0);
        }
        for (count, &leaf) in counts.iter().zip(tree.leaves()) {
            let told = f64::from(tree.probability(at, leaf));
            assert!((count - told).abs() <= 1.5 / f64::from(steps), "{leaf:?}: {count}, not {told}");
        }
    }
    assert!(nothing < 0.2 * points, "{nothing} of {points} draws in vain");
}

#[test]
fn what_shines_can_be_drawn() {
    let lights = lights();
    let tree = tree_of(&lights);
    let mut random = Random::new(3);
    let (mut impossible, mut shining) = (0, 0);
    for at in references(400) {
        for &leaf in tree.leaves() {
            let told = tree.probability(at, leaf);
            let light = &lights[leaf.light.index()];
            for _ in 0..4 {
                let sample = light.sample_part(at, leaf.part, random.pair());
                // Grazing by less than rounding may count as behind.
                let is_clear = sample.valid && sample.wi.dot(at.n) > 1e-3 && sample.li.g > 1e-3;
                shining += u32::from(is_clear);
                assert!(!is_clear || told > 0.0, "{leaf:?} shines on {at:?}: {sample:?}");
            }
            impossible += u32::from(told <= 0.0);
        }
    }
    assert!(shining > 10_000 && impossible > 10_000, "{shining} samples shine, {impossible} are ruled out");
}

#[test]
fn nearby_and_bright_lights_are_preferred() {
    let square = |x: f32, radiance: f32| {
        let surface = RectangleArea::new(Point3::new(x, 1.0, 0.0), Point3::X * 0.01, Point3::Z * 0.01);
        Light::Rectangle(Area { surface, radiance: Rgb::gray(radiance), two_sided: false })
    };
    let lights: Vec<_> = (0..256_u16).map(|i| square(f32::from(i), 1.0)).collect();
    let tree = tree_of(&lights);
    let at = Reference { p: Vec3::new(100.0, 0.0, 0.0), n: Vec3::new(0.0, 1.0, 0.0) };
    let of = |i: u32| tree.probability(at, Leaf { light: LightId(i), part: None });
    // What they bring falls with the fourth power of distance.
    assert!(
        of(100) > 0.3 && of(100) > 1.5 * of(102) && of(102) > 10.0 * of(200),
        "{} {} {}",
        of(100),
        of(102),
        of(200)
    );
    // From above all are dark.
    let above = Reference { p: Vec3::new(100.0, 2.0, 0.0), n: Vec3::new(0.0, -1.0, 0.0) };
    assert!(tree.sample(above, 0.3).probability.to_bits() == 0, "{:?}", tree.sample(above, 0.3));
}

/// What a tree draws for many points, over lanes.
struct Draws<'a> {
    tree: &'a LightTree,
    points: &'a [Reference<f32>],
    numbers: &'a [f32],
}

impl<S: Isa> Kernel<S> for Draws<'_> {
    type Output = Vec<(u32, f32)>;
    #[inline(always)]
    fn run(self, isa: S) -> Vec<(u32, f32)> {
        let mut all = Vec::new();
        for (points, numbers) in self.points.chunks_exact(16).zip(self.numbers.chunks_exact(16)) {
            for at in (0..16).step_by(S::WIDTH) {
                let mut rows = [[0.0; 16]; 6];
                for lane in 0..S::WIDTH {
                    let Reference { p, n } = points[at + lane];
                    for (row, value) in rows.iter_mut().zip([p.x, p.y, p.z, n.x, n.y, n.z]) {
                        row[lane] = value;
                    }
                }
                let [a, b, c, d, e, f] = rows.map(|row| isa.load(&row));
                let reference = Reference { p: Vec3::new(a, b, c), n: Vec3::new(d, e, f) };
                let drawn = self.tree.sample(reference, isa.load(&numbers[at..]));
                let (mut leaves, mut chances) = ([0; 16], [0.0; 16]);
                specula::math::lanes::IntLanes::store(drawn.leaf, &mut leaves);
                drawn.probability.store(&mut chances);
                all.extend(leaves.into_iter().zip(chances).take(S::WIDTH));
            }
        }
        all
    }
}

#[test]
fn all_widths_draw_alike() {
    let lights = lights();
    let tree = tree_of(&lights);
    let points = references(4096);
    let points = &points[..4096];
    let mut random = Random::new(4);
    let numbers: Vec<_> = (0..4096 + 16).map(|_| random.unit()).collect();
    let expected: Vec<_> = points.iter().zip(&numbers).map(|(&at, &u)| tree.sample(at, u)).collect();
    for level in Level::available() {
        let found = level.run(Draws { tree: &tree, points, numbers: &numbers });
        assert_eq!(found.len(), 4096, "{}", level.name());
        let mut differing = 0;
        for ((leaf, chance), expected) in found.iter().zip(&expected) {
            // A number within rounding of the border between two leaves may lead to either.
            let same = *leaf == expected.leaf && (chance - expected.probability).abs() <= 1e-4 * chance;
            differing += u32::from(!same && (*chance > 0.0 || expected.probability > 0.0));
        }
        assert!(differing <= 8, "{}: {differing} of 4096 differ", level.name());
    }
}
