//! Building: emitters are cut in two where the halves are least likely to be looked at in vain.

use super::bounds::Bounds;
use super::{DEEPEST, LEAF, Leaf, LightTree};
use glam::Vec3;

/// The most emitters: their nodes are numbered by lanes.
const MOST: usize = 1 << 26;

/// Groups between which a cut is looked for, along each axis.
const BINS: usize = 12;

/// A node whose emitters are known and which is to be made.
struct Task {
    /// Where in the arrays.
    node: usize,
    /// Which emitters.
    from: usize,
    to: usize,
    /// The turns from the root, and how many.
    turns: u64,
    depth: u32,
}

/// The tree over these emitters.
pub(super) fn build(mut emitters: Vec<(Leaf, Bounds)>) -> Option<LightTree> {
    if emitters.is_empty() || emitters.len() > MOST {
        return None;
    }
    let nodes = 2 * emitters.len() - 1;
    let mut tree = LightTree {
        rows: vec![[0.0; 3]; nodes * super::ROWS as usize],
        links: vec![LEAF; nodes],
        leaves: Vec::with_capacity(emitters.len()),
        turns: Vec::with_capacity(emitters.len()),
        places: Vec::new(),
    };
    let mut tasks = vec![Task { node: 0, from: 0, to: emitters.len(), turns: 0, depth: 0 }];
    let mut free = 1;
    while let Some(Task { node, from, to, turns, depth }) = tasks.pop() {
        let own = &mut emitters[from..to];
        let Some(bounds) = own.iter().map(|(_, bounds)| *bounds).reduce(Bounds::join) else { continue };
        tree.set(node, &bounds);
        if let [(leaf, _)] = own {
            let number = small(tree.leaves.len());
            tree.links[node] = LEAF | number;
            tree.note(*leaf, number);
            tree.leaves.push(*leaf);
            tree.turns.push(turns | 1 << depth);
            continue;
        }
        let middle = from + cut(own, &bounds, DEEPEST - depth - 1);
        tree.links[node] = small(free);
        let child = |node, from, to, turn: u64| {
            let turns = turns | turn << depth;
            Task { node, from, to, turns, depth: depth + 1 }
        };
        tasks.push(child(free, from, middle, 0));
        tasks.push(child(free + 1, middle, to, 1));
        free += 2;
    }
    Some(tree)
}

/// A number of a node or leaf.
#[expect(clippy::cast_possible_truncation, reason = "there are fewer than 2^28")]
fn small(number: usize) -> u32 {
    number as u32
}

impl LightTree {
    fn set(&mut self, node: usize, bounds: &Bounds) {
        let rows = &mut self.rows[node * super::ROWS as usize..][..super::ROWS as usize];
        let radius = bounds.aabb.radius();
        let (sin, cos) = bounds.spread.sin_cos();
        // Light may go a little further than rounding lets it.
        let reach = bounds.reach.cos() - 1e-3;
        rows[0] = bounds.aabb.center().to_array();
        rows[1] = bounds.axis.to_array();
        rows[2] = [bounds.intensity, radius * radius, cos];
        rows[3] = [sin.max(0.0), reach, 0.0];
    }
}

/// Sorts the emitters into two parts; how many are in the first. Neither has more than `levels` levels can hold.
fn cut(own: &mut [(Leaf, Bounds)], all: &Bounds, levels: u32) -> usize {
    let count = own.len();
    let most = 1_usize.checked_shl(levels).unwrap_or(usize::MAX);
    let centers = own.iter().map(|(_, bounds)| bounds.aabb.center());
    let (least, greatest) =
        centers.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    let extent = greatest - least;
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in 0..3 {
        if extent[axis] <= 0.0 {
            continue;
        }
        let mut bins = [None::<Bounds>; BINS];
        let mut counts = [0; BINS];
        for (_, bounds) in own.iter() {
            let bin = bin_of(bounds, axis, (least, extent));
            bins[bin] = Some(bins[bin].map_or(*bounds, |all| all.join(*bounds)));
            counts[bin] += 1;
        }
        let size = all.aabb.size();
        let ratio = size.max_element() / size[axis].max(size.max_element() * 1e-6);
        for split in 1..BINS {
            let first: usize = counts[..split].iter().sum();
            if first == 0 || first == count || first.max(count - first) > most {
                continue;
            }
            let cost = |bins: &[Option<Bounds>]| {
                let joined = bins.iter().flatten().copied().reduce(Bounds::join);
                joined.map_or(0.0, |bounds| bounds.cost(ratio))
            };
            let cost = cost(&bins[..split]) + cost(&bins[split..]);
            if best.is_none_or(|(least, _, _)| cost < least) {
                best = Some((cost, axis, split));
            }
        }
    }
    match best {
        Some((_, axis, split)) => {
            let is_first = |(_, bounds): &(Leaf, Bounds)| bin_of(bounds, axis, (least, extent)) < split;
            // In their order, so that the tree depends on nothing else.
            own.sort_by_key(|emitter| !is_first(emitter));
            own.iter().take_while(|emitter| is_first(emitter)).count()
        }
        None => count / 2,
    }
}

/// In which bin along an axis the middle of an emitter is.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the bins")]
fn bin_of(bounds: &Bounds, axis: usize, (least, extent): (Vec3, Vec3)) -> usize {
    let place = (bounds.aabb.center()[axis] - least[axis]) / extent[axis];
    ((place * BINS as f32) as usize).min(BINS - 1)
}
