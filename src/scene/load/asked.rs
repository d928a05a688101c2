//! How large a picture a scene asks for.

use crate::scene::Description;
use crate::scene::load::node::Node;
use crate::scene::load::report::Report;
use crate::scene::load::source::Spot;
use crate::trust::{Limit, Limits};

/// Reports a picture of more pixels or samples than are allowed, where the scene says so.
pub(super) fn check(tree: &Node, description: &Description, limits: &Limits, report: &mut Report) {
    let [width, height] = [description.film.width, description.film.height].map(u64::from);
    let pixels = width * height;
    if let Err(excess) = limits.check(Limit::Pixels, pixels) {
        let what = format!("a picture of {width} by {height} pixels is too large: {excess}");
        let spot = spot(tree, [("film", "height"), ("film", "width")]);
        report.error(spot, what, excess.remedy());
        return;
    }
    let spp = u64::from(description.render.spp());
    if let Err(excess) = limits.check(Limit::Samples, pixels.saturating_mul(spp)) {
        let what = format!("{spp} samples of {width} by {height} pixels are too many: {excess}");
        report.error(spot(tree, [("render", "spp"), ("film", "height")]), what, excess.remedy());
    }
}

/// Where the first of some keys stands; the scene itself where none does.
fn spot<'a>(tree: &'a Node, keys: [(&str, &str); 2]) -> &'a Spot {
    let find = |(table, key): (&str, &str)| Some(&tree.get(table)?.get(key)?.spot);
    keys.into_iter().find_map(find).unwrap_or(&tree.spot)
}
