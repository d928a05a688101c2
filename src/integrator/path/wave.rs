//! Paths of a batch side by side, one array per component.

use crate::accel::{Packet, RayPacket};
use crate::geometry::{Hit, Ray};
use crate::integrator::Radiance;
use crate::integrator::cone::Cone;
use crate::material::Media;
use crate::math::lanes::{Bits, IntLanes, Isa, Lanes, MaskLanes, WIDEST, Wrapping};
use crate::math::{Rgb, Vec3};

/// Numbers side by side, with room behind the last one, so that the widest lanes can be loaded and stored anywhere. Loads beyond the
/// end see what was there before.
#[derive(Debug, Default)]
pub(super) struct Column<T = f32>(Vec<T>);

impl<T: Copy + Default> Column<T> {
    /// Makes room for `len` entries.
    fn reserve(&mut self, len: usize) {
        if self.0.len() < len + WIDEST {
            self.0.resize(len + WIDEST, T::default());
        }
    }

    /// All entries, and what lies behind them.
    #[inline(always)]
    pub(super) fn all(&self) -> &[T] {
        &self.0
    }
}

impl Column {
    #[inline(always)]
    pub(super) fn load<S: Isa>(&self, isa: S, at: usize) -> S::F {
        isa.load(&self.0[at..])
    }

    #[inline(always)]
    pub(super) fn store<F: Lanes>(&mut self, at: usize, value: F) {
        value.store(&mut self.0[at..]);
    }
}

impl Column<u32> {
    #[inline(always)]
    pub(super) fn load<S: Isa>(&self, isa: S, at: usize) -> S::I {
        isa.load_u32(&self.0[at..])
    }

    #[inline(always)]
    pub(super) fn store<I: IntLanes>(&mut self, at: usize, value: I) {
        value.store(&mut self.0[at..]);
    }
}

/// Three columns.
#[derive(Debug, Default)]
pub(super) struct Columns3([Column; 3]);

impl Columns3 {
    fn reserve(&mut self, len: usize) {
        self.0.iter_mut().for_each(|column| column.reserve(len));
    }

    #[inline(always)]
    pub(super) fn vector<S: Isa>(&self, isa: S, at: usize) -> Vec3<S::F> {
        let [x, y, z] = &self.0;
        Vec3::new(x.load(isa, at), y.load(isa, at), z.load(isa, at))
    }

    #[inline(always)]
    pub(super) fn color<S: Isa>(&self, isa: S, at: usize) -> Rgb<S::F> {
        let Vec3 { x, y, z } = self.vector(isa, at);
        Rgb::new(x, y, z)
    }

    /// Packs the lanes of the mask to `at` and on.
    #[inline(always)]
    pub(super) fn pack<F: Lanes>(&mut self, at: usize, mask: F::Mask, v: Vec3<F>) {
        let [x, y, z] = &mut self.0;
        x.store(at, v.x.compress(mask));
        y.store(at, v.y.compress(mask));
        z.store(at, v.z.compress(mask));
    }

    /// All lanes, to `at` and on.
    #[inline(always)]
    fn store<F: Lanes>(&mut self, at: usize, v: Vec3<F>) {
        let [x, y, z] = &mut self.0;
        x.store(at, v.x);
        y.store(at, v.y);
        z.store(at, v.z);
    }

    fn set(&mut self, i: usize, values: [f32; 3]) {
        self.0.iter_mut().zip(values).for_each(|(column, value)| column.0[i] = value);
    }

    pub(super) fn scale(&mut self, i: usize, by: [f32; 3]) {
        self.0.iter_mut().zip(by).for_each(|(column, factor)| column.0[i] *= factor);
    }

    pub(super) fn get(&self, i: usize) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.0[axis].0[i])
    }
}

/// Rays, and whose they are.
#[derive(Debug, Default)]
pub(super) struct Rays {
    pub(super) o: Columns3,
    pub(super) d: Columns3,
    pub(super) time: Column,
    /// Number of the sample in the batch.
    pub(super) slot: Column<u32>,
    pub(super) len: usize,
}

impl Rays {
    fn reserve(&mut self, len: usize) {
        self.o.reserve(len);
        self.d.reserve(len);
        self.time.reserve(len);
        self.slot.reserve(len);
    }

    fn set(&mut self, at: usize, ray: &Ray, slot: u32) {
        self.o.set(at, ray.o.into());
        self.d.set(at, ray.d.into());
        self.time.0[at] = ray.time;
        self.slot.0[at] = slot;
    }

    /// One ray, to the end of the world.
    pub(super) fn get(&self, at: usize) -> Ray {
        Ray::new(self.o.get(at).into(), self.d.get(at).into()).at_time(self.time.0[at])
    }

    /// All lanes, to `at` and on.
    #[inline(always)]
    fn store<F: Lanes>(&mut self, at: usize, (o, d, time, slot): (Vec3<F>, Vec3<F>, F, F::Int)) {
        self.o.store(at, o);
        self.d.store(at, d);
        self.time.store(at, time);
        self.slot.store(at, slot);
    }

    /// Packs the lanes of the mask to `at` and on.
    #[inline(always)]
    pub(super) fn pack<F: Lanes>(
        &mut self,
        at: usize,
        mask: F::Mask,
        (o, d, time, slot): (Vec3<F>, Vec3<F>, F, F::Int),
    ) {
        self.o.pack(at, mask, o);
        self.d.pack(at, mask, d);
        self.time.store(at, time.compress(mask));
        self.slot.store(at, slot.compress(mask));
    }

    /// `N` rays from `at` on.
    #[inline]
    fn fill<const N: usize>(&self, at: usize, packet: &mut RayPacket<N>) {
        let of = at..at + N;
        packet.o_x.copy_from_slice(&self.o.0[0].0[of.clone()]);
        packet.o_y.copy_from_slice(&self.o.0[1].0[of.clone()]);
        packet.o_z.copy_from_slice(&self.o.0[2].0[of.clone()]);
        packet.d_x.copy_from_slice(&self.d.0[0].0[of.clone()]);
        packet.d_y.copy_from_slice(&self.d.0[1].0[of.clone()]);
        packet.d_z.copy_from_slice(&self.d.0[2].0[of.clone()]);
        packet.time.copy_from_slice(&self.time.0[of]);
        packet.t_min = [0.0; N];
        packet.mask = [u32::MAX; N];
    }
}

/// Paths that go on.
#[derive(Debug, Default)]
pub(super) struct Paths {
    pub(super) rays: Rays,
    /// What radiance along the ray is multiplied by on its way to the camera.
    pub(super) beta: Columns3,
    /// Density of the ray's direction; 0 where lights are not asked for the same.
    pub(super) pdf: Column,
    /// The shading normal where the ray left; unused where the choice of lights knows no normals.
    pub(super) normal: Columns3,
    /// Width and spread of the cone about the ray, from the second edge on; unused where no surface shows a picture.
    cone: [Column; 2],
}

impl Paths {
    fn reserve(&mut self, len: usize) {
        self.rays.reserve(len);
        self.beta.reserve(len);
        self.pdf.reserve(len);
        self.normal.reserve(len);
        self.cone.iter_mut().for_each(|column| column.reserve(len));
    }

    /// The cones about the rays of a chunk.
    #[inline(always)]
    pub(super) fn cone<S: Isa>(&self, isa: S, at: usize) -> Cone<S::F> {
        let [width, spread] = &self.cone;
        Cone { width: width.load(isa, at), spread: spread.load(isa, at) }
    }

    /// Packs the cones of the lanes of the mask to `at` and on.
    #[inline(always)]
    pub(super) fn widen<F: Lanes>(&mut self, at: usize, mask: F::Mask, cone: Cone<F>) {
        let [width, spread] = &mut self.cone;
        width.store(at, cone.width.compress(mask));
        spread.store(at, cone.spread.compress(mask));
    }

    /// What a medium leaves of the light of path `i`.
    pub(super) fn absorb(&mut self, i: usize, left: Rgb<f32>) {
        self.beta.scale(i, [left.r, left.g, left.b]);
    }

    /// What path `i` meets counts in full.
    pub(super) fn forget_density(&mut self, i: usize) {
        self.pdf.0[i] = 0.0;
    }

    /// `N` rays from `at` on, to the ends of the world.
    #[inline]
    pub(super) fn packet<const N: usize>(&self, at: usize, packet: &mut Packet<N>) {
        self.rays.fill(at, &mut packet.ray);
        packet.ray.t_max = [f32::INFINITY; N];
    }
}

/// Rays towards lights, and the light that they carry.
#[derive(Debug, Default)]
pub(super) struct Shadows {
    pub(super) rays: Rays,
    pub(super) end: Column,
    pub(super) light: Columns3,
    /// How many have been dimmed by the medium they start in.
    pub(super) absorbed: usize,
}

impl Shadows {
    fn reserve(&mut self, len: usize) {
        self.rays.reserve(len);
        self.end.reserve(len);
        self.light.reserve(len);
    }

    /// Adds a ray by itself.
    pub(super) fn push(&mut self, ray: &Ray, slot: u32, light: Rgb<f32>) {
        let at = self.rays.len;
        self.rays.set(at, ray, slot);
        self.end.0[at] = ray.t_max;
        self.light.set(at, [light.r, light.g, light.b]);
        self.rays.len += 1;
    }

    /// `N` rays from `at` on.
    #[inline]
    pub(super) fn packet<const N: usize>(&self, at: usize, packet: &mut RayPacket<N>) {
        self.rays.fill(at, packet);
        packet.t_max.copy_from_slice(&self.end.0[at..at + N]);
    }
}

/// Rays that must be free for others to count: to where those start from a smooth surface that a mesh stands for.
#[derive(Debug, Default)]
pub(super) struct Guards(pub(super) Vec<(Ray, Guarded)>);

/// Whose way it is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Guarded {
    /// That of a path, by its place.
    Path(usize),
    /// That of a ray towards a light, by its place.
    Shadow(usize),
}

/// What is known of each path of a batch.
#[derive(Debug, Default)]
pub(super) struct Slots {
    pub(super) pixel: [Column<u32>; 2],
    pub(super) index: Column<u32>,
    /// What the path has brought home.
    pub(super) sum: Vec<Rgb<f32>>,
    /// What of it came by few edges; empty where nobody wants to know.
    pub(super) direct: Vec<Rgb<f32>>,
    /// Whether it met a surface.
    pub(super) met: Vec<bool>,
    /// What the path is inside of; empty where the scene has no media.
    pub(super) media: Vec<Media>,
    /// The most luminance that one piece of light may bring now, if there is a limit.
    pub(super) limit: Option<f32>,
    /// Luminance beyond it.
    pub(super) clamped: f64,
}

impl Slots {
    /// A coordinate of the pixels of samples.
    #[inline(always)]
    pub(super) fn pixel_of<S: Isa>(&self, isa: S, axis: usize, slots: S::I) -> S::I {
        isa.gather_u32(self.pixel[axis].all(), slots)
    }

    /// Notes that the samples of the lanes that are set have met a surface.
    #[inline(always)]
    pub(super) fn meet<I: IntLanes>(&mut self, mask: I::Mask, slots: I) {
        for lane in Bits(mask.bits()) {
            self.met[slots.extract(lane) as usize] = true;
        }
    }

    /// Adds light to the samples of the lanes that are set.
    #[inline(always)]
    pub(super) fn add<F: Lanes>(&mut self, mask: F::Mask, slots: F::Int, light: Rgb<F>) {
        let mut rows = [[0.0; WIDEST]; 3];
        let mut names = [0; WIDEST];
        light.r.store(&mut rows[0]);
        light.g.store(&mut rows[1]);
        light.b.store(&mut rows[2]);
        slots.store(&mut names);
        for lane in Bits(mask.bits()) {
            self.bring(names[lane], Rgb::new(rows[0][lane], rows[1][lane], rows[2][lane]));
        }
    }

    /// Adds light to a sample, as much as the limit allows.
    #[inline]
    pub(super) fn bring(&mut self, name: u32, light: Rgb<f32>) {
        let light = match self.limit {
            Some(limit) if light.luminance() > limit => self.cut(light, limit),
            _ => light,
        };
        self.sum[name as usize] += light;
    }

    /// The light as bright as allowed.
    #[inline(never)]
    fn cut(&mut self, light: Rgb<f32>, limit: f32) -> Rgb<f32> {
        let luminance = light.luminance();
        if !luminance.is_finite() {
            // To be found and counted with the sample.
            return light;
        }
        self.clamped += f64::from(luminance - limit);
        light.scale(limit / luminance)
    }

    /// Luminance of all samples that have any.
    pub(super) fn luminance(&self) -> f64 {
        self.sum.iter().map(|light| f64::from(light.luminance())).filter(|light| light.is_finite()).sum()
    }
}

/// A batch of camera samples on their way. Memory is kept from batch to batch.
#[derive(Debug, Default)]
pub struct Wave {
    /// Paths of a sample, one after the other.
    pub(super) ways: usize,
    /// What the camera rays have met; empty where each is that of one path.
    pub(super) seen: Vec<Option<Hit>>,
    pub(super) paths: Paths,
    pub(super) shadows: Shadows,
    pub(super) guards: Guards,
    pub(super) slots: Slots,
}

impl Wave {
    /// Forgets the samples of the last batch and makes room for `len` paths, so many of each sample.
    pub fn clear(&mut self, len: usize, ways: usize) {
        self.ways = ways;
        self.paths.reserve(len);
        // Towards a light, and at the last vertex also towards the environment.
        self.shadows.reserve(2 * len);
        for column in self.slots.pixel.iter_mut().chain([&mut self.slots.index]) {
            column.reserve(len);
        }
        self.slots.sum.clear();
        self.slots.direct.clear();
        self.slots.met.clear();
        self.slots.media.clear();
        self.slots.clamped = 0.0;
        self.paths.rays.len = 0;
    }

    /// Adds the first `count` paths of the lanes: pixels and indices, and their camera rays. They start in no medium.
    #[inline(always)]
    pub fn begin<S: Isa>(
        &mut self,
        isa: S,
        count: usize,
        (pixel, index): ([S::I; 2], S::I),
        (o, d, time): (Vec3<S::F>, Vec3<S::F>, S::F),
    ) {
        let Self { paths, slots, .. } = self;
        let at = paths.rays.len;
        let slot = Wrapping::<u32>::wrapping_add(isa.iota(), u32::try_from(at).unwrap_or(u32::MAX));
        paths.rays.store(at, (o, d, time, slot));
        let one = isa.splat(1.0);
        paths.beta.store(at, Vec3::new(one, one, one));
        paths.pdf.store(at, isa.splat(0.0));
        slots.pixel[0].store(at, pixel[0]);
        slots.pixel[1].store(at, pixel[1]);
        slots.index.store(at, index);
        paths.rays.len += count;
        slots.sum.resize(paths.rays.len, Rgb::BLACK);
        slots.met.resize(paths.rays.len, false);
    }

    /// Says what the camera rays start in, by their moments.
    pub fn set_media(&mut self, media_at: impl Fn(f32) -> Media) {
        let times = &self.paths.rays.time.all()[..self.paths.rays.len];
        self.slots.media.clear();
        self.slots.media.extend(times.iter().map(|&time| media_at(time)));
    }

    /// How many samples there are, on their way or at home.
    #[must_use]
    pub fn len(&self) -> usize {
        self.slots.sum.len() / self.ways.max(1)
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.slots.sum.is_empty()
    }

    /// What sample number `i` of the batch has brought home.
    #[must_use]
    pub fn radiance(&self, i: usize) -> Radiance {
        let first = i * self.ways;
        let mean = |all: &[Rgb<f32>]| match &all[first..first + self.ways] {
            [only] => *only,
            several => {
                several.iter().fold(Rgb::BLACK, |sum, &light| sum + light).scale(1.0 / self.ways as f32)
            }
        };
        let color = mean(&self.slots.sum);
        let direct = if self.slots.direct.is_empty() { color } else { mean(&self.slots.direct) };
        Radiance { color, direct, alpha: if self.slots.met[first] { 1.0 } else { 0.0 } }
    }
}
