//! Holes in shapes whose materials have them.

use crate::geometry::{PlacementId, ShapeId};
use crate::material::CutOut;
use crate::scene::build::{Builder, number};
use crate::texture::Scalar;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The opacity of each group, and the shape that has such holes.
type Kind = (Vec<Option<Scalar>>, ShapeId);

impl Builder {
    /// Gives shapes their filters. A filter belongs to a shape: where placements of one differ in their holes, there is a shape for
    /// each kind.
    pub(super) fn cut_holes(&mut self) {
        if self.materials.iter().all(|material| material.opacity.is_none()) {
            return;
        }
        let mut known: BTreeMap<ShapeId, Vec<Kind>> = BTreeMap::new();
        for id in (0..number(self.surfaces.len())).map(PlacementId) {
            let materials = &self.surfaces[id.index()].materials;
            let opacities: Vec<Option<Scalar>> =
                materials.iter().map(|id| self.materials[id.index()].opacity.clone()).collect();
            let shape = self.world.placements[id.index()].shape;
            let kinds = known.entry(shape).or_default();
            if let Some((_, own)) = kinds.iter().find(|(holes, _)| *holes == opacities) {
                self.world.placements[id.index()].shape = *own;
                continue;
            }
            let form = self.world.shapes[shape.index()].clone();
            let own = if kinds.is_empty() { shape } else { self.world.add_shape(form.clone()) };
            kinds.push((opacities.clone(), own));
            self.world.placements[id.index()].shape = own;
            if opacities.iter().any(Option::is_some) {
                self.world.filters.insert(own, Arc::new(CutOut::new(form, opacities)));
            }
        }
    }
}
