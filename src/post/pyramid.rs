//! Smaller pictures of each reflector: pixels of nothing but it, summed two by two.
//!
//! A texel holds means over those of its pixels that show the reflector, and how many they are, so that no other reflector gets into it; rays that
//! end and rays that do not have texels of their own, since places and directions have no common mean. Faces that are turned too far against each other
//! to be mixed by the filter have none in common: such texels are left out. What is lost is detail of weights within a texel, and where near and far things are in one, what is between them.

use super::field::{Field, Values};
use super::gbuffer::GBuffer;
use std::collections::BTreeMap;

/// Smaller pictures by reflector.
#[derive(Debug, Default)]
pub(super) struct Pyramid {
    chains: BTreeMap<u32, [Vec<Field>; 2]>,
}

/// How a reflector is halved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Depth {
    /// How often.
    pub(super) halvings: u32,
    /// The square of the chord between normals beyond which pixels are of different faces.
    pub(super) apart: f32,
}

/// Pixels of a kind: the least and the greatest column and row, the latter excluded.
type Extent = [[u32; 2]; 2];

impl Pyramid {
    /// Of the reflectors that are listed.
    pub(super) fn of(g: &GBuffer, field: &Field, depths: &BTreeMap<u32, Depth>) -> Self {
        let mut extents: BTreeMap<(u32, bool), Extent> = BTreeMap::new();
        for y in g.window.y0..g.window.y1 {
            for x in g.window.x0..g.window.x1 {
                let Values { id, h, .. } = field.values([x, y]);
                let ends = h > 0.0;
                if id == 0 || !depths.contains_key(&id) {
                    continue;
                }
                let [low, high] = extents.entry((id, ends)).or_insert([[x, y], [x + 1, y + 1]]);
                *low = [low[0].min(x), low[1].min(y)];
                *high = [high[0].max(x + 1), high[1].max(y + 1)];
            }
        }
        let made: Vec<_> = extents
            .into_iter()
            .map(|((id, ends), extent)| (id, ends, chain(field, (id, ends), extent, depths[&id])))
            .collect();
        let mut chains: BTreeMap<u32, [Vec<Field>; 2]> = BTreeMap::new();
        for (id, ends, chain) in made {
            chains.entry(id).or_default()[usize::from(ends)] = chain;
        }
        Self { chains }
    }

    /// The pictures of a reflector that is halved `level` times; none of one that is not.
    pub(super) fn fields(&self, id: u32, level: u32) -> impl Iterator<Item = &Field> {
        let chains = level.checked_sub(1).and_then(|index| Some((index, self.chains.get(&id)?)));
        chains
            .into_iter()
            .flat_map(|(index, chains)| chains.iter().filter_map(move |it| it.get(index as usize)))
    }
}

/// A picture halved once, twice, and so on.
fn chain(field: &Field, key: (u32, bool), extent: Extent, depth: Depth) -> Vec<Field> {
    let mut chain: Vec<Field> = Vec::new();
    let mut extent = extent;
    for _ in 0..depth.halvings {
        extent = [extent[0].map(|x| x / 2), extent[1].map(|x| x.div_ceil(2))];
        let halved = halved(chain.last().unwrap_or(field), (key, depth.apart), extent);
        chain.push(halved);
    }
    chain
}

fn halved(finer: &Field, key: ((u32, bool), f32), extent: Extent) -> Field {
    Field::of_texels(extent, !finer.area[0].is_empty(), |at| mean(finer, key, at))
}

/// The mean of four texels, as far as they are of the reflector; nothing if they are of faces that do not mix.
fn mean(finer: &Field, ((id, ends), apart): ((u32, bool), f32), [x, y]: [u32; 2]) -> Values {
    let mut sum = Values::default();
    let add = |to: &mut [f32; 3], from: [f32; 3], by: f32| {
        to.iter_mut().zip(from).for_each(|(to, from)| *to += by * from);
    };
    for [x, y] in [[2 * x, 2 * y], [2 * x + 1, 2 * y], [2 * x, 2 * y + 1], [2 * x + 1, 2 * y + 1]] {
        let texel = finer.values([x, y]);
        if texel.id != id || (texel.h > 0.0) != ends {
            continue;
        }
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
    // The mean of two unit normals has the cosine of half the angle between them for its length, of which the chord is twice the sine; rounding
    // takes a little from those that are equal.
    if 4.0 * (1.0 - (length / sum.m).powi(2)) > apart + 1e-5 {
        return Values::default();
    }
    Values {
        b: scaled(sum.b, sum.m.recip()),
        h: f32::from(u8::from(ends)),
        l: scaled(sum.l, sum.m.recip()),
        n: scaled(sum.n, length.max(1e-30).recip()),
        id,
        ..sum
    }
}
