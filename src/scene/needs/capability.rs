//! What a renderer can do and a scene may not need.

/// Something that costs time or memory where a scene asks for it, and nothing where not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Capability {
    /// Triangles of meshes.
    Triangles,
    /// Spheres.
    Spheres,
    /// Discs.
    Discs,
    /// Shapes that find their own hits.
    Surfaces,
    /// Shapes placed by a map that stays.
    Instances,
    /// Shapes placed by a map that changes while the shutter is open.
    MovingPoses,
    /// Shapes that change by themselves while the shutter is open.
    MovingVertices,
    /// Shapes that some rays do not see.
    Masks,
    /// Shapes of which not all hits count.
    CutOuts,
    /// Normals that differ from those of the triangles.
    ShadingNormals,
    /// Surface parameters from files.
    SurfaceParameters,
    /// Materials with a mirrored ray.
    Mirrors,
    /// Materials that let light through.
    Refraction,
    /// Materials with a lobe.
    GlossyLobes,
    /// Pictures on surfaces.
    ImageTextures,
    /// Lights of a single point or direction.
    PointLights,
    /// Lights with a surface.
    AreaLights,
    /// Light from infinity.
    Environment,
    /// A camera that moves while the shutter is open.
    MovingCamera,
    /// A camera whose rays leave from more than one point.
    Lens,
}

impl Capability {
    /// All of them: shapes first, then materials, then lights, then the camera.
    pub const ALL: [Self; 20] = [
        Self::Triangles,
        Self::Spheres,
        Self::Discs,
        Self::Surfaces,
        Self::Instances,
        Self::MovingPoses,
        Self::MovingVertices,
        Self::Masks,
        Self::CutOuts,
        Self::ShadingNormals,
        Self::SurfaceParameters,
        Self::Mirrors,
        Self::Refraction,
        Self::GlossyLobes,
        Self::ImageTextures,
        Self::PointLights,
        Self::AreaLights,
        Self::Environment,
        Self::MovingCamera,
        Self::Lens,
    ];

    /// The kinds of geometry among them.
    pub const GEOMETRIES: [Self; 4] = [Self::Triangles, Self::Spheres, Self::Discs, Self::Surfaces];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.texts()[0]
    }

    /// What it takes where a scene asks for it.
    #[must_use]
    pub fn takes(self) -> &'static str {
        self.texts()[1]
    }

    /// What is left out where a scene does not ask for it.
    #[must_use]
    pub fn spares(self) -> &'static str {
        self.texts()[2]
    }

    fn texts(self) -> [&'static str; 3] {
        match self {
            Self::Triangles => ["triangles", "triangle geometry", "no triangle geometry"],
            Self::Spheres => ["spheres", "sphere geometry", "no sphere geometry"],
            Self::Discs => ["discs", "disc geometry", "no disc geometry"],
            Self::Surfaces => ["surfaces", "a call of the shape for every candidate", "no calls of shapes"],
            Self::Instances => [
                "instances",
                "a second level of hierarchy, rays carried into it",
                "what stands still was moved to its place once",
            ],
            Self::MovingPoses => [
                "moving shapes",
                "a transform per key, a random moment per sample",
                "one moment: no key is interpolated",
            ],
            Self::MovingVertices => {
                ["moving vertices", "a vertex buffer per key", "one vertex buffer per mesh"]
            }
            Self::Masks => ["masks", "a mask per geometry", "every ray sees everything"],
            Self::CutOuts => ["cut-outs", "a filter function per hit", "no filter function"],
            Self::ShadingNormals => {
                ["shading normals", "12 bytes per vertex, interpolated", "the triangles' own normals"]
            }
            Self::SurfaceParameters => {
                ["surface parameters", "8 bytes per vertex, interpolated", "barycentric parameters"]
            }
            Self::Mirrors => ["mirrors", "a mirrored ray per hit", "no mirrored rays"],
            Self::Refraction => [
                "refraction",
                "two rays per hit, a stack of media; shadow rays look for glass",
                "no stack of media; shadow rays end at the first hit",
            ],
            Self::GlossyLobes => {
                ["glossy lobes", "a sampled ray per hit, weighed against lights", "no rays for lobes"]
            }
            Self::ImageTextures => {
                ["image textures", "pictures at all sizes, a cone about every ray", "no widths of rays"]
            }
            Self::PointLights => ["point lights", "a shadow ray each", "none"],
            Self::AreaLights => {
                ["area lights", "a shadow ray each, two random numbers", "no points drawn on lights"]
            }
            Self::MovingCamera => {
                ["moving camera", "a viewpoint between keys for every sample", "one viewpoint"]
            }
            Self::Lens => {
                ["lens", "a point of the lens for every sample, two random numbers", "one point of view"]
            }
            Self::Environment => ["environment", "a table of directions", "rays that leave see nothing"],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_capability_has_a_name_of_its_own() {
        let names: std::collections::BTreeSet<&str> =
            Capability::ALL.into_iter().map(Capability::name).collect();
        assert_eq!(names.len(), Capability::ALL.len(), "{names:?}");
        let texts = Capability::ALL.into_iter().flat_map(Capability::texts);
        assert_eq!(texts.filter(|text| text.contains("Embree")).count(), 0, "there are other backends");
    }
}
