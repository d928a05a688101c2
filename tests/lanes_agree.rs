//! Shading at every width gives what one lane gives.
//!
//! Not bit for bit: where the hardware fuses, `mul_add` rounds once instead of twice, and whatever cancels afterwards
//! shows the difference. Each quantity therefore states the relative error it is held to and why that is not zero.
//! Instruction sets that the machine lacks are skipped with a printed line.

#[path = "support/random.rs"]
mod random;

use random::Random;
use specula::bsdf::microfacet::{Beckmann, Distribution, Ggx};
use specula::bsdf::{
    Below, Branch, BsdfSample, Conductor, Dielectric, Diffuse, FresnelModel, Glass, Glazed, Glossy, Jitter,
    Metal, Mirror, OrenNayar, Phong, PhongScale, RoughConductor, RoughDielectric, Schlick, ThinDielectric,
    fresnel,
};
use specula::image::Image;
use specula::light::{
    Area, Directional, DiscArea, Environment, EnvironmentMap, Light, LightSample, MeshArea, Point,
    RectangleArea, Reference, SphereLight, Spot, spot_cosines,
};
use specula::math::lanes::{Isa, Kernel, Lanes, Level};
use specula::math::{Frame, Rgb, Vec3};

/// Numbers for one lane.
type Input = [f32; 8];

/// What is computed: a name, a bound on the error relative to the magnitude `scale` (or to the value, where that is
/// greater), and a value for each input. NaN stands for what is not valid.
#[derive(Debug)]
struct Column {
    name: String,
    bound: f32,
    scale: f32,
    values: Vec<f32>,
}

/// Collects the values of all lanes. What is not arithmetic stays out of line: kernels are compiled in one piece.
#[derive(Default)]
struct Table {
    columns: Vec<Column>,
    next: usize,
}

impl Table {
    #[inline(never)]
    fn append(&mut self, [who, what]: [&str; 2], [bound, scale]: [f32; 2], values: &[f32]) {
        if self.next == self.columns.len() {
            self.columns.push(Column { name: format!("{who}: {what}"), bound, scale, values: Vec::new() });
        }
        self.columns[self.next].values.extend_from_slice(values);
        self.next += 1;
    }

    #[inline(always)]
    fn put<F: Lanes>(&mut self, name: [&str; 2], bound: [f32; 2], value: F) {
        let mut row = [0.0; 16];
        value.store(&mut row);
        self.append(name, bound, &row[..F::WIDTH]);
    }

    #[inline(always)]
    fn put_all<F: Lanes>(&mut self, name: [&str; 2], bound: [f32; 2], valid: F::Mask, values: [F; 3]) {
        for x in values {
            self.put(name, bound, F::select(valid, x, x.splat(f32::NAN)));
        }
    }

    /// `bound` is on the direction, the density (of 0.01 at least: near the horizon cosines are differences) and the weight.
    #[inline(always)]
    fn put_sample<F: Lanes>(&mut self, who: &str, bound: [f32; 3], sample: BsdfSample<F>) {
        let BsdfSample { wi, weight, pdf, valid } = sample;
        self.put_all([who, "direction"], [bound[0], 1.0], valid, [wi.x, wi.y, wi.z]);
        self.put_all([who, "sampled density"], [bound[1], 0.01], valid, [pdf; 3]);
        self.put_all([who, "weight"], [bound[2], 1.0], valid, [weight.r; 3]);
    }

    #[inline(always)]
    fn put_branch<F: Lanes>(&mut self, who: &str, bound: f32, branch: Branch<F>) {
        let Branch { wi, weight, radiance_scale, valid, .. } = branch;
        self.put_all([who, "direction"], [bound, 1.0], valid, [wi.x, wi.y, wi.z]);
        self.put_all([who, "weight"], [bound, 1.0], valid, [weight.r, weight.g, weight.b]);
        self.put([who, "scale"], [1e-6, 0.0], radiance_scale);
    }

    #[inline(always)]
    fn put_light<F: Lanes>(&mut self, who: &str, at: Reference<F>, sample: LightSample<F>) {
        let LightSample { wi, p, li, pdf, valid } = sample;
        let way = p - at.p;
        // At the rim of the sphere the chord vanishes as the root of what 1e-7 is lost of.
        let reach = if who == "sphere" { 2e-3 } else { 1e-5 };
        // Squares of distances and quotients by cosines: 1e-7 beside a cosine of 1e-3 is 1e-4.
        let bound = 3e-4;
        self.put_all([who, "direction"], [1e-5, 1.0], valid, [wi.x, wi.y, wi.z]);
        self.put_all([who, "way"], [reach, 1.0], valid, [way.x, way.y, way.z]);
        self.put_all([who, "density"], [bound, 0.0], valid, [pdf; 3]);
        self.put_all([who, "radiance"], [bound, 0.1], valid, [li.r; 3]);
    }
}

/// One part for each input.
struct Shade<'a, const PART: usize> {
    inputs: &'a [Input],
    lights: &'a [(&'static str, Light)],
}

impl<S: Isa, const PART: usize> Kernel<S> for Shade<'_, PART> {
    type Output = Vec<Column>;
    #[inline(always)]
    fn run(self, isa: S) -> Self::Output {
        let mut table = Table::default();
        for some in self.inputs.chunks_exact(S::WIDTH) {
            let input: [S::F; 8] = std::array::from_fn(|k| isa.per_lane(|i| some[i][k]));
            table.next = 0;
            match PART {
                0 => smooth(&mut table, input),
                1 => rough(&mut table, input),
                2 => glossy(&mut table, input),
                3 => frosted(&mut table, input),
                _ => illumination(&mut table, input, self.lights),
            }
        }
        table.columns
    }
}

/// The viewer of an input.
#[inline(always)]
fn viewer<F: Lanes>([c, turn, ..]: [F; 8]) -> Vec3<F> {
    let sin = (-c.square() + 1.0).max(0.0).sqrt();
    let (s, t) = turn.sin_cos_turns();
    Vec3::new(t * sin, s * sin, c)
}

/// Reflectances, mirrors, glass.
#[inline(always)]
fn smooth<F: Lanes>(table: &mut Table, input: [F; 8]) {
    let [c, _, u, v, eta, k, ..] = input;
    let wo = viewer(input);
    // c^2 + d cancels to 1e-7 near the critical angle, of which the root is 3e-4; towards a denser medium it does not.
    let at = fresnel::dielectric(c, eta);
    table.put(["Fresnel", "dielectric"], [1e-3, 1.0], at.reflectance);
    table.put(["Fresnel", "cosine within"], [1e-3, 1.0], at.cos_t);
    table.put(["Fresnel", "denser"], [2e-6, 1.0], fresnel::dielectric(c, eta.max(1.4)).reflectance);
    table.put(["Fresnel", "Schlick"], [1e-6, 1.0], fresnel::schlick(c, fresnel::normal_incidence(eta)));
    for (who, model) in MODELS {
        table.put([who, "glass"], [1e-3, 1.0], Glass::new(model, eta).at(c).reflectance);
        let metal = Metal::new(model, Rgb::gray(eta), Rgb::gray(k));
        table.put([who, "metal"], [1e-5, 1.0], metal.at(c).g);
    }
    for branch in (Dielectric { glass: Glass::exact(eta) }).branches(wo) {
        table.put_branch("dielectric", 1e-3, branch);
    }
    let pane = ThinDielectric { glass: Glass::exact(eta.max(1.1)), transmittance: Rgb::gray(v) };
    for branch in pane.branches(wo) {
        table.put_branch("pane", 2e-6, branch);
    }
    table.put_branch("mirror", 1e-6, Mirror { reflectance: Rgb::gray(u) }.branch(wo));
    // (eta - k)(eta + k) - s^2 cancels where both are near one.
    table.put_branch("conductor", 1e-5, Conductor { metal: exact_metal(eta, k) }.branch(wo));
    let glazed = Glazed { glass: Glass::exact(eta.max(1.4)), inside: Rgb::gray(v) };
    table.put_branch("glazed", 2e-6, glazed.branch(wo));
    table.put(["glazed", "value"], [2e-6, 1.0], glazed.diffuse(wo, another(input)).r);
}

/// The knob.
const MODELS: [(&str, FresnelModel); 4] = [
    ("exact", FresnelModel::Exact),
    ("Schlick", FresnelModel::Schlick),
    ("edge term", FresnelModel::F82),
    ("constant", FresnelModel::Constant),
];

#[inline(always)]
fn exact_metal<F: Lanes>(eta: F, k: F) -> Metal<F> {
    Metal::new(FresnelModel::Exact, Rgb::gray(eta), Rgb::gray(k))
}

/// A light's direction that is not sampled.
#[inline(always)]
fn another<F: Lanes>([_, _, u, v, _, _, x, y]: [F; 8]) -> Vec3<F> {
    viewer([x.abs(), y, u, v, u, v, u, v])
}

/// Matt surfaces and rough metals.
#[inline(always)]
fn rough<F: Lanes>(table: &mut Table, input: [F; 8]) {
    let [_, _, u, v, eta, k, x, y] = input;
    let (wo, wi) = (viewer(input), another(input));
    let diffuse = Diffuse { reflectance: Rgb::gray(k.min(1.0)) };
    table.put_sample("diffuse", [1e-6, 1e-6, 0.0], diffuse.sample(wo, [u, v]));
    table.put(["diffuse", "density"], [1e-6, 0.0], diffuse.pdf(wo, wi));
    table.put(["diffuse", "value"], [1e-6, 0.0], diffuse.eval(wo, wi).r);
    let clay = OrenNayar { reflectance: Rgb::gray(k.min(1.0)), roughness: x.abs() };
    // Beside grazing the quotient of the cosines is known to 1e-7 of 1e-3.
    table.put_sample("Oren-Nayar", [1e-6, 1e-6, 3e-4], clay.sample(wo, [u, v]));
    table.put(["Oren-Nayar", "value"], [3e-4, 1e-3], clay.eval(wo, wi).r);
    for (who, ax, ay) in [("metal 0.01", 0.01, 0.01), ("metal 0.1 0.4", 0.1, 0.4), ("metal 1", 1.0, 1.0)] {
        for gaussian in [false, true] {
            let facets = distribution(eta, [ax, ay], gaussian);
            let metal = RoughConductor { metal: exact_metal(eta, k + 0.5), facets };
            // Half vectors are rounded to 1e-7, which counts relative to the roughness.
            let bound = 2e-5 + 3e-6 / ax;
            // Where both directions graze the weight is a quotient of their cosines, of 1e-3 and known to 1e-7.
            table.put_sample(who, [2e-5, bound, 3e-4], metal.sample(wo, [u, v]));
            table.put([who, "density"], [bound, 1e-3], metal.pdf(wo, wi));
            table.put([who, "value"], [bound, 1e-3], metal.eval(wo, wi).r);
        }
    }
    let surface = Schlick::new(Rgb::gray(y.abs()), x.abs() * 0.9 + 0.05, eta.splat(0.7));
    table.put_sample("Schlick", [2e-5, 1e-4, 3e-4], surface.sample(wo, [u, v]));
    table.put(["Schlick", "value"], [1e-4, 1e-3], surface.eval(wo, wi).r + surface.diffuse(wo, wi).r);
    table.put(["Schlick", "mirror"], [1e-5, 1.0], surface.branch(wo).weight.r);
}

#[inline(always)]
fn distribution<F: Lanes>(like: F, [x, y]: [f32; 2], gaussian: bool) -> Distribution<F> {
    let (alpha_x, alpha_y) = (like.splat(x), like.splat(y));
    if gaussian {
        Distribution::Beckmann(Beckmann { alpha_x, alpha_y })
    } else {
        Distribution::Ggx(Ggx { alpha_x, alpha_y })
    }
}

/// Frosted glass.
#[inline(always)]
fn frosted<F: Lanes>(table: &mut Table, input: [F; 8]) {
    let [_, _, u, v, eta, ..] = input;
    let (wo, wi) = (viewer(input), another(input));
    for (who, ax, ay) in [("glass 0.05", 0.05, 0.05), ("glass 0.1 0.4", 0.1, 0.4), ("glass 0.7", 0.7, 0.7)] {
        for gaussian in [false, true] {
            // Nearer to 1 the refracting facet is a difference of nearly equal directions.
            let glass = Glass::exact(eta.max(1.3));
            let lobe = RoughDielectric { glass, facets: distribution(eta, [ax, ay], gaussian) };
            let bound = 1e-4 + 1e-5 / ax;
            // Gaussian slopes are found within 2e-7 of their distribution: in its tails that is much of a slope, and at its
            // lower end, where it begins like a square, the root of it.
            let [reach, density] = if gaussian { [3e-4, 10.0 * bound] } else { [2e-5, bound] };
            let numbers = if gaussian { [u.clamp(1e-3, 0.999), v] } else { [u, v] };
            for sample in lobe.sample(wo, numbers) {
                table.put_sample(who, [reach, density, 3e-4], sample);
            }
            for wi in [wi, -wi] {
                table.put([who, "density"], [bound, 1e-3], lobe.pdf(wo, wi));
                table.put([who, "value"], [bound, 1e-3], lobe.eval(wo, wi).r);
            }
        }
    }
}

/// Fuzzy mirrors.
#[inline(always)]
fn glossy<F: Lanes>(table: &mut Table, input: [F; 8]) {
    let [_, _, u, v, eta, ..] = input;
    let (wo, wi) = (viewer(input), another(input));
    let names = ["glossy 0", "glossy 1", "glossy 100", "glossy 1e6", "glossy 1e9"];
    for (who, exponent) in names.into_iter().zip([0.0_f32, 1.0, 100.0, 1e6, 1e9]) {
        let lobe = Glossy::new(Rgb::gray(u), eta.splat(exponent));
        // The chord between unit vectors is rounded to 1e-7 and counts by e times itself: up to 8 / sqrt(e) long.
        let bound = 1e-5 + 2e-6 * exponent.sqrt();
        table.put_sample(who, [2e-6, bound, 0.0], lobe.sample(wo, [u, v]));
        // Near the horizon of the lobe cosines are differences.
        table.put([who, "density"], [bound, 0.01], lobe.pdf(wo, wi));
        table.put([who, "value times cosine"], [bound, 0.01], lobe.eval(wo, wi).r * wi.z);
        for below in [Below::Discard, Below::Rejection] {
            let lobe = Glossy { below, ..lobe };
            table.put_sample(who, [2e-6, bound, 0.0], lobe.sample(wo, [u, v]));
            table.put([who, "density"], [bound, 0.01], lobe.pdf(wo, wi));
        }
        for scale in [PhongScale::Modified, PhongScale::MaxCosine] {
            let lobe = Phong { reflectance: Rgb::gray(u), exponent: eta.splat(exponent), scale };
            table.put_sample(who, [2e-6, bound, 1e-4], lobe.sample(wo, [u, v]));
            table.put([who, "value times cosine"], [bound, 0.01], lobe.eval(wo, wi).r * wi.z);
        }
        let lobe = Jitter { reflectance: Rgb::gray(u), exponent: eta.splat(exponent) };
        table.put_sample(who, [2e-6, 10.0 * bound, 0.0], lobe.sample(wo, [u, v]));
        table.put([who, "density"], [10.0 * bound, 0.01], lobe.pdf(wo, wi));
    }
}

/// Lights above a plane.
#[inline(always)]
fn illumination<F: Lanes>(table: &mut Table, input: [F; 8], lights: &[(&'static str, Light)]) {
    let [_, _, u, v, _, k, x, y] = input;
    let up = Vec3::new(y.splat(0.0), y.splat(1.0), y.splat(0.0));
    let at =
        Reference { p: Vec3::new(x * 3.0, y * 3.0, k.min(2.0)), n: Frame::about(up).to_world(viewer(input)) };
    for (who, light) in lights {
        table.put_light(who, at, light.sample(at, [u, v]));
    }
}

fn lights() -> Vec<(&'static str, Light)> {
    use glam::Vec3 as P;
    let radiance = Rgb::gray(2.0);
    let rectangle = RectangleArea::new(P::new(0.5, 4.0, 0.0), P::X * 0.5, P::Z);
    let mesh =
        MeshArea::new(vec![[P::Y * 5.0, P::new(1.0, 5.0, 0.0), P::new(0.0, 5.0, 2.0)]]).expect("has area");
    let pixels = (0..128_u16).map(|i| Rgb::gray(f32::from(i % 13))).collect();
    let picture =
        EnvironmentMap::new(Image::from_pixels(16, 8, pixels).expect("fits"), 1.0, 0.3).expect("shines");
    let position = Vec3::new(0.0, 4.0, 1.0);
    let [cos_outer, cos_inner] = spot_cosines(0.9, 0.5);
    let axis = Vec3::new(0.0, -1.0, 0.0);
    vec![
        ("rectangle", Light::Rectangle(Area { surface: rectangle, radiance, two_sided: true })),
        (
            "disc",
            Light::Disc(Area {
                surface: DiscArea::new(P::Y * 5.0, P::NEG_Y, 1.0),
                radiance,
                two_sided: false,
            }),
        ),
        ("mesh", Light::Mesh(Area { surface: mesh, radiance, two_sided: true })),
        ("sphere", Light::Sphere(SphereLight { center: position, radius: 0.5, radiance })),
        ("point", Light::Point(Point { position, intensity: radiance })),
        ("spot", Light::Spot(Spot { position, axis, intensity: radiance, cos_outer, cos_inner })),
        ("sun", Light::Directional(Directional { direction: axis, irradiance: radiance })),
        ("sky", Light::Environment(Environment::Constant(radiance))),
        ("picture", Light::Environment(Environment::Map(Box::new(picture)))),
    ]
}

/// Random inputs, and every eighth with something at an end of its range: a whole number of blocks of any width.
fn inputs() -> Vec<Input> {
    const LAST: f32 = 1.0 - f32::EPSILON / 2.0;
    let mut random = Random::new(1);
    let make = |i: usize| {
        let [c, turn, u] = random.triple();
        let [v, x, y] = random.triple();
        let (eta, k) = (random.logarithmic(0.3, 4.0), random.logarithmic(0.01, 100.0));
        let mut input = [c.max(1e-3), turn, u, v, eta, k, x * 2.0 - 1.0, y * 2.0 - 1.0];
        if i.is_multiple_of(8) {
            let ends = [
                [1e-3, 1.0],
                [0.0, LAST],
                [0.0, LAST],
                [0.0, LAST],
                [1.0, 1.5],
                [0.0, 1e6],
                [0.0, 1.0],
                [0.0, 1.0],
            ];
            let which = i / 8 % 8;
            input[which] = ends[which][i / 64 % 2];
        }
        input
    };
    (0..8192).map(make).collect()
}

/// Compares all columns; a decision near its threshold may fall either way, but seldom.
fn compare(name: &str, found: &[Column], expected: &[Column]) {
    assert_eq!(found.len(), expected.len(), "{name}: columns");
    for (wide, narrow) in found.iter().zip(expected) {
        let (mut flips, mut valid) = (0, 0);
        for (lane, (&a, &b)) in wide.values.iter().zip(&narrow.values).enumerate() {
            if a.is_nan() != b.is_nan() {
                flips += 1;
            } else if !a.is_nan() {
                valid += 1;
                let bound = wide.bound * b.abs().max(wide.scale);
                assert!((a - b).abs() <= bound, "{name}: {}, input {lane}: {a:e}, not {b:e}", wide.name);
            }
        }
        assert!(flips <= 4, "{name}: {}: {flips} decisions differ", wide.name);
        assert!(valid > 400, "{name}: {}: only {valid} valid", wide.name);
    }
}

#[expect(clippy::print_stdout, reason = "says what was not tested")]
fn agree<const PART: usize>() {
    let (inputs, lights) = (inputs(), lights());
    let shade = || Shade::<PART> { inputs: &inputs, lights: &lights };
    let expected = Level::named("scalar").expect("always there").run(shade());
    for level in Level::available() {
        compare(level.name(), &level.run(shade()), &expected);
    }
    for name in ["avx2", "avx512"] {
        if Level::named(name).is_err() {
            println!("skipped: this machine has no {name}");
        }
    }
}

#[test]
fn smooth_surfaces_are_the_same_at_every_width() {
    agree::<0>();
}

#[test]
fn rough_surfaces_are_the_same_at_every_width() {
    agree::<1>();
}

#[test]
fn glossy_surfaces_are_the_same_at_every_width() {
    agree::<2>();
}

#[test]
fn frosted_glass_is_the_same_at_every_width() {
    agree::<3>();
}

#[test]
fn lights_are_the_same_at_every_width() {
    agree::<4>();
}
