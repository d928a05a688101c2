//! What is asked of a scene's surfaces at every vertex, in tables for lanes.

use crate::geometry::PlacementId;
use crate::material::{Material, Scattering};
use crate::math::Rgb;
use crate::math::lanes::{Bits, Compare, IntLanes, Isa, MaskLanes, WIDEST};
use crate::scene::Scene;
use crate::scene::needs::capability::Capability;
use crate::texture::Texture;

/// Stands for a shape whose primitives are of several materials.
const SEVERAL: u32 = u32::MAX;

/// Materials by placement, and which of them shine.
#[derive(Debug)]
pub(super) struct Surfaces {
    materials: Vec<u32>,
    /// By material: 1 where it shines, else 0.
    shines: Vec<u32>,
    /// By material: the first that scatters alike but for its colour.
    alike: Vec<u32>,
    /// By material: the colour of matt ones.
    colors: Vec<[f32; 3]>,
    /// Whether any changes over its surface.
    pub(super) textured: bool,
    /// Whether any has a relief.
    pub(super) reliefs: bool,
    /// Whether any leaves a choice of ways on.
    pub(super) choices: bool,
    /// Whether media are followed.
    pub(super) media: bool,
    /// Whether any bounds a medium, which may hide others.
    pub(super) hides: bool,
    /// Whether any of these absorbs light.
    pub(super) absorbs: bool,
    /// Whether any is not the same in all directions.
    pub(super) turns: bool,
}

impl Surfaces {
    pub(super) fn of(scene: &Scene) -> Self {
        let placements = (0..).map(PlacementId).take(scene.world.placements.len());
        let materials = placements.map(|id| scene.only_material_of(id).map_or(SEVERAL, |id| id.0)).collect();
        let shines = scene.materials.iter().map(|material| u32::from(material.emission.is_some())).collect();
        let alike = (0..).zip(&scene.materials).map(|(id, material)| {
            let matt = flat_color(material)
                .and_then(|_| scene.materials.iter().position(|m| flat_color(m).is_some()));
            #[expect(clippy::cast_possible_truncation, reason = "materials are numbered by u32")]
            matt.map_or(id, |first| first as u32)
        });
        let alike = alike.collect();
        let color = |material: &Material| flat_color(material).unwrap_or(Rgb::BLACK);
        let colors = scene.materials.iter().map(color).map(|Rgb { r, g, b }| [r, g, b]).collect();
        Self {
            materials,
            shines,
            alike,
            colors,
            textured: scene.uses(Capability::Textures),
            reliefs: scene.uses(Capability::Reliefs),
            choices: scene.uses(Capability::LobeChoice),
            media: scene.has_media(),
            hides: scene.requires(Capability::Media),
            absorbs: scene.uses(Capability::Absorption),
            turns: scene.uses(Capability::Anisotropy),
        }
    }

    /// The material of each lane of the mask; unspecified in the others.
    #[inline(always)]
    pub(super) fn materials<S: Isa>(
        &self,
        isa: S,
        scene: &Scene,
        (placements, prims): (S::I, S::I),
        mask: S::M,
    ) -> S::I {
        let found = isa.gather_u32(&self.materials, placements);
        let open = Compare::<u32>::eq(found, SEVERAL) & mask;
        if open.none() {
            return found;
        }
        let (mut names, mut rows) = ([0; WIDEST], [[0; WIDEST]; 2]);
        found.store(&mut names);
        placements.store(&mut rows[0]);
        prims.store(&mut rows[1]);
        by_primitive(scene, &rows, Bits(open.bits()), &mut names);
        isa.load_u32(&names)
    }

    /// The first materials that scatter as these do, but for their colour.
    #[inline(always)]
    pub(super) fn alike<S: Isa>(&self, isa: S, materials: S::I) -> S::I {
        isa.gather_u32(&self.alike, materials)
    }

    /// What matt surfaces of one colour all over reflect.
    #[inline(always)]
    pub(super) fn colors<S: Isa>(&self, isa: S, materials: S::I) -> Rgb<S::F> {
        let [r, g, b] = isa.gather_rows(&self.colors, materials);
        Rgb::new(r, g, b)
    }

    /// Whether the materials shine.
    #[inline(always)]
    pub(super) fn shine<S: Isa>(&self, isa: S, materials: S::I) -> S::M {
        Compare::<u32>::ne(isa.gather_u32(&self.shines, materials), 0)
    }
}

/// What a matt surface reflects that is of one colour all over.
fn flat_color(material: &Material) -> Option<Rgb<f32>> {
    match &material.scattering {
        Scattering::Diffuse { reflectance: Texture::Constant(color) } => Some(*color),
        _ => None,
    }
}

/// Out of line: scalar work, the same for all instruction sets.
#[inline(never)]
fn by_primitive(
    scene: &Scene,
    [placements, prims]: &[[u32; WIDEST]; 2],
    open: Bits,
    names: &mut [u32; WIDEST],
) {
    for lane in open {
        names[lane] = scene.material_of(PlacementId(placements[lane]), prims[lane]).0;
    }
}
