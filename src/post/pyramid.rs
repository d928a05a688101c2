//! Smaller pictures of each reflector: pixels of nothing but it, summed two by two.
//!
//! A texel holds means over those of its pixels that show the reflector, and how many they are, so that no other reflector gets into it; rays that
//! end and rays that do not have texels of their own, since places and directions have no common mean. Faces that are turned too far against each other
//! to be mixed by the filter have none in common: such texels are left out. What is lost is detail of weights within a texel, and where near and far things are in one, what is between them.

use super::field::{Field, Values};
use super::gbuffer::GBuffer;
use std::collections::{BTreeMap, BTreeSet};

/// Smaller pictures by what is mixed in them.
#[derive(Debug, Default)]
pub(super) struct Pyramid {
    chains: BTreeMap<Key, [Vec<Field>; 2]>,
}

/// What is mixed in a texel. A reflector with lobes of several widths has pictures for each, so that none depends on which others are seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    /// Number of the reflector.
    id: u32,
    /// Bits of the square of the chord between normals beyond which pixels are of different faces.
    apart: u32,
}

impl Key {
    /// Pixels of a reflector, unless their normals are apart by a chord whose square is more than this.
    pub(super) fn new(id: u32, apart: f32) -> Self {
        Self { id, apart: apart.to_bits() }
    }

    fn apart(self) -> f32 {
        f32::from_bits(self.apart)
    }
}

/// Pixels of a kind: the least and the greatest column and row, the latter excluded.
type Extent = [[u32; 2]; 2];

impl Pyramid {
    /// Of what is listed, with how often it is halved.
    pub(super) fn of(g: &GBuffer, field: &Field, depths: &BTreeMap<Key, u32>) -> Self {
        let extents = extents(g, field, &depths.keys().map(|key| key.id).collect());
        let chains = depths.iter().map(|(&key, &halvings)| {
            let chain = |ends| {
                let extent = extents.get(&(key.id, ends));
                extent.map_or_else(Vec::new, |&extent| chain(field, (key, ends), extent, halvings))
            };
            (key, [false, true].map(chain))
        });
        Self { chains: chains.collect() }
    }

    /// The pictures of what is halved `level` times; none of what is not.
    pub(super) fn fields(&self, key: Key, level: u32) -> impl Iterator<Item = &Field> {
        let chains = level.checked_sub(1).and_then(|index| Some((index, self.chains.get(&key)?)));
        chains
            .into_iter()
            .flat_map(|(index, chains)| chains.iter().filter_map(move |it| it.get(index as usize)))
    }
}

/// Where the pixels of reflectors are, those whose rays end apart from the others.
fn extents(g: &GBuffer, field: &Field, ids: &BTreeSet<u32>) -> BTreeMap<(u32, bool), Extent> {
    let mut extents: BTreeMap<(u32, bool), Extent> = BTreeMap::new();
    for y in g.window.y0..g.window.y1 {
        for x in g.window.x0..g.window.x1 {
            let Values { id, h, .. } = field.values([x, y]);
            if id == 0 || !ids.contains(&id) {
                continue;
            }
            let [low, high] = extents.entry((id, h > 0.0)).or_insert([[x, y], [x + 1, y + 1]]);
            *low = [low[0].min(x), low[1].min(y)];
            *high = [high[0].max(x + 1), high[1].max(y + 1)];
        }
    }
    extents
}

/// A picture halved once, twice, and so on.
fn chain(field: &Field, of: (Key, bool), extent: Extent, halvings: u32) -> Vec<Field> {
    let mut chain: Vec<Field> = Vec::new();
    let mut extent = extent;
    for _ in 0..halvings {
        extent = [extent[0].map(|x| x / 2), extent[1].map(|x| x.div_ceil(2))];
        let halved = halved(chain.last().unwrap_or(field), of, extent);
        chain.push(halved);
    }
    chain
}

fn halved(finer: &Field, of: (Key, bool), extent: Extent) -> Field {
    Field::of_texels(extent, !finer.area[0].is_empty(), |at| mean(finer, of, at))
}

/// The mean of four texels, as far as they are of the reflector; nothing if any two of them are of faces that do not mix.
fn mean(finer: &Field, (key, ends): (Key, bool), [x, y]: [u32; 2]) -> Values {
    let mut sum = Values::default();
    let (mut normals, mut count) = ([[0.0; 3]; 4], 0);
    let add = |to: &mut [f32; 3], from: [f32; 3], by: f32| {
        to.iter_mut().zip(from).for_each(|(to, from)| *to += by * from);
    };
    for [x, y] in [[2 * x, 2 * y], [2 * x + 1, 2 * y], [2 * x, 2 * y + 1], [2 * x + 1, 2 * y + 1]] {
        let texel = finer.values([x, y]);
        if texel.id != key.id || (texel.h > 0.0) != ends {
            continue;
        }
        if normals[..count].iter().any(|&n| chord2(n, texel.n) > key.apart()) {
            return Values::default();
        }
        normals[count] = texel.n;
        count += 1;
        sum.m += texel.m;
        add(&mut sum.b, texel.b, texel.m);
        add(&mut sum.l, texel.l, texel.m);
        add(&mut sum.n, texel.n, texel.m);
        add(&mut sum.area, texel.area, 1.0);
    }
    if sum.m <= 0.0 {
        return sum;
    }
    let scaled = |v: [f32; 3], by: f32| v.map(|x| x * by);
    let length = sum.n.iter().map(|x| x * x).sum::<f32>().sqrt();
    Values {
        b: scaled(sum.b, sum.m.recip()),
        h: f32::from(u8::from(ends)),
        l: scaled(sum.l, sum.m.recip()),
        n: scaled(sum.n, length.max(1e-30).recip()),
        id: key.id,
        ..sum
    }
}

/// The square of the chord between two normals.
fn chord2(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::super::gbuffer::{End, Mirror, Texel};
    use super::*;
    use crate::image::Window;
    use glam::Vec3;

    /// A texel of so many pixels whose normal is off by a chord.
    fn texel(chord: f32, m: f32) -> Values {
        let angle = 2.0 * (chord / 2.0).asin();
        Values {
            b: [0.0, 0.0, 1.0],
            h: 1.0,
            l: [1.0; 3],
            n: [angle.sin(), 0.0, angle.cos()],
            m,
            id: 1,
            ..Values::default()
        }
    }

    /// Whether four texels have a mean where normals are apart beyond a chord of 0.2.
    fn is_mixed(texels: [Values; 4]) -> bool {
        let of = |[x, y]: [u32; 2]| texels[(2 * y + x) as usize];
        let field = Field::of_texels([[0, 0], [2, 2]], false, of);
        mean(&field, (Key::new(1, 0.2 * 0.2), true), [0, 0]).id == 1
    }

    #[test]
    fn no_texel_has_normals_that_are_apart() {
        assert!(is_mixed([texel(0.0, 4.0); 4]), "a face");
        // One of four, also where it has a sixteenth of the pixels that each of the others has.
        for (at, m) in [(0, 4.0), (1, 4.0), (2, 4.0), (3, 4.0), (0, 0.25), (3, 0.25)] {
            for (chord, mixes) in [(0.199, true), (0.201, false), (0.225, false), (1.4, false)] {
                let mut texels = [texel(0.0, 4.0); 4];
                texels[at] = texel(chord, m);
                assert_eq!(is_mixed(texels), mixes, "{at} of {m} by {chord}");
            }
        }
        // Each is near the first, but not near each other.
        let bent = [texel(0.0, 4.0), texel(0.15, 4.0), texel(-0.15, 4.0), texel(0.0, 4.0)];
        assert!(!is_mixed(bent), "bent both ways");
    }

    /// A flat mirror seen from above; what it mirrors, a metre away, goes back on itself from column 12 on. Pixel (5, 5) has no neighbours.
    fn folded() -> GBuffer {
        let texel = |x: u32, y: u32| {
            let (column, row) = (x as f32, y as f32);
            let a = Vec3::new(column - 8.0, 8.0 - row, 0.0) * 0.01;
            let b = Vec3::new(-0.02 * (column - 12.1).abs(), 0.02 * (8.0 - row), 1.0);
            let mirror = Mirror {
                radiance: [1.0; 3],
                factor: [1.0; 3],
                a,
                normal: Vec3::Z,
                end: End::At(b),
                s: 1.0,
                reflector: if x.abs_diff(5) + y.abs_diff(5) == 1 { 2 } else { 1 },
                exponent: 50.0,
                strength: 1.0,
                hit: 1,
            };
            Texel { mirror: Some(mirror), alpha: 1.0, ..Texel::default() }
        };
        let texels = (0..16).flat_map(|y| (0..16).map(move |x| texel(x, y))).collect();
        GBuffer { full: [16; 2], window: Window::whole(16, 16), scale: 100.0, weight: 1.0, texels }
    }

    #[test]
    fn areas_of_pixels_add_up() {
        let field = Field::of(&folded(), true);
        for [x, y] in (0..8).flat_map(|y| (0..8).map(move |x| [x, y])) {
            let pixels = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| field.values([2 * x + i, 2 * y + j]));
            let own = pixels.iter().filter(|pixel| pixel.id == 1);
            let wanted = own.map(|pixel| pixel.area[2].abs()).sum::<f32>();
            let found = mean(&field, (Key::new(1, 0.04), true), [x, y]).area[2];
            assert!(wanted > 0.0, "an area of each pixel");
            assert!((found.abs() / wanted - 1.0).abs() < 1e-5, "{x} {y}: {found}, not {wanted}");
        }
    }
}
