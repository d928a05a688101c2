//! What surfaces are made of.

use super::{
    Below, Bump, Fresnel, Located, NormalMap, PerTangent, PhongScale, Roughness, ScalarTexture, Texture,
};
use crate::math::Rgb;
use crate::scene::load::check;
use crate::scene::record::{choice, record, tagged, words};

choice! {
    /// How the normals of microfacets are spread.
    pub enum Distribution {
        /// Long tails, as most real surfaces have.
        "ggx" => Ggx,
        /// Gaussian slopes, no tails.
        "beckmann" => Beckmann,
    }
}

words! {
    Below {
        /// They are turned by half a turn about the mirror direction: nothing is lost.
        "through_r" => ThroughR,
        /// They count as black: the rim darkens.
        "discard" => Discard,
        /// Others are drawn instead: the lobe cut off at the surface and brought back to 1. Slower.
        "rejection" => Rejection,
    }
}

words! {
    PhongScale {
        /// (e + 2) / (2 pi), the modified Phong model: darkens with the angle, to its cosine where it is sharp.
        "modified" => Modified,
        /// (e + 2) / (2 pi) over the greater cosine: a mirror where it is sharp.
        "max_cosine" => MaxCosine,
    }
}

record! {
    /// What a surface is made of.
    pub struct Material checked by check::material {
        /// Radiance it gives off besides, on the side of its normals; a picture or a pattern on meshes and rectangles only.
        emission: Texture = Texture::gray(0.0), unit("W/(sr m^2)"), min(0.0), max(1e20);
        /// A relief by a picture of normals; on meshes with texture coordinates and on spheres.
        normal_map: Option<NormalMap>;
        /// A relief by a picture of heights, likewise; instead of `normal_map`.
        bump: Option<Bump>;
        /// Holes: where this is below 0.5 there is no surface. For materials that do not shine.
        opacity: Option<ScalarTexture>;
        ..scattering: Scattering, "What it does with light.";
    }
}

impl From<Scattering> for Material {
    fn from(scattering: Scattering) -> Self {
        Self { emission: Texture::gray(0.0), normal_map: None, bump: None, opacity: None, scattering }
    }
}

tagged! {
    /// What a surface does with light.
    pub enum Scattering by tag() checked by check::scattering {
        /// A matt surface.
        "diffuse" => Diffuse {
            /// The part of the light that is reflected, per channel.
            reflectance: Texture = Texture::gray(0.5), min(0.0), max(1.0);
        }
        /// A rough matt surface, such as plaster or clay.
        "oren_nayar" => OrenNayar {
            /// The part of the light that each slope reflects, per channel.
            reflectance: Texture = Texture::gray(0.5), min(0.0), max(1.0);
            /// From 0, the same as `diffuse`, to 1.
            roughness: f32 = 0.5, min(0.0), max(1.0);
        }
        /// An ideal mirror, the same at all angles.
        "mirror" => Mirror {
            /// The part of the light that is reflected, per channel.
            reflectance: Texture = Texture::gray(1.0), min(0.0), max(1.0);
        }
        /// A metal.
        "conductor" => Conductor {
            /// Width of the distribution of facets, one number or one along each tangent, or a picture; 0 is a mirror. Tangents follow the
            /// texture coordinates of a mesh, and run around the y axis where there are none.
            alpha: Roughness = Roughness::Constant(PerTangent([0.0; 2])), min(0.0), max(1.0);
            /// How the normals of the facets are spread.
            distribution: Distribution = Distribution::Ggx;
            /// Turns the tangents about the normal, counter-clockwise seen from outside; for two widths.
            rotate_deg: f32 = 0.0, unit("degrees"), min(-36000.0), max(36000.0);
            /// How reflectance depends on the angle; absent: as the table `render` says.
            fresnel: Option<Fresnel>;
            ..optics: Optics, "How much it reflects at which angle.";
        }
        /// A clear body, such as glass or water, polished or frosted.
        "dielectric" => Dielectric {
            /// Index of refraction against that of air; 1 is invisible.
            ior: f32 = 1.5, min(1.0), max(10.0);
            /// What is absorbed on the way through, per channel: light falls to 1/e over 1/absorption metres.
            absorption: Rgb<f32> = Rgb::gray(0.0), unit("1/m"), min(0.0), max(1e9);
            /// Where bodies overlap, the one of the highest priority is there.
            priority: i32 = 0;
            /// Width of the distribution of facets, one number or one along each tangent, or a picture; 0 is polished. Tangents follow the
            /// texture coordinates of a mesh, and run around the y axis where there are none.
            alpha: Roughness = Roughness::Constant(PerTangent([0.0; 2])), min(0.0), max(1.0);
            /// How the normals of the facets are spread.
            distribution: Distribution = Distribution::Ggx;
            /// Turns the tangents about the normal, counter-clockwise seen from outside; for two widths.
            rotate_deg: f32 = 0.0, unit("degrees"), min(-36000.0), max(36000.0);
            /// How reflectance depends on the angle; absent: as the table `render` says.
            fresnel: Option<Fresnel>;
        }
        /// A clear sheet without thickness, such as a window pane: what goes through is not bent.
        "thin_dielectric" => ThinDielectric {
            /// Index of refraction against that of air; 1 is invisible but for its transmittance.
            ior: f32 = 1.5, min(1.0), max(10.0);
            /// What is left of light that crosses the sheet once straight on, per channel.
            transmittance: Rgb<f32> = Rgb::gray(1.0), min(0.0), max(1.0);
            /// How reflectance depends on the angle; absent: as the table `render` says.
            fresnel: Option<Fresnel>;
        }
        /// A coloured base under a Phong lobe.
        "glossy" => Glossy {
            /// Exponent of the lobe; larger is sharper.
            exponent: f32 = 100.0, min(0.0), max(1e9);
            /// The part of the light that the lobe reflects, per channel.
            reflectance: Rgb<f32> = Rgb::gray(0.8), min(0.0), max(1.0);
            /// The part of the light that the base reflects, per channel.
            diffuse: Texture = Texture::gray(0.0), min(0.0), max(1.0);
            /// What becomes of directions of the lobe that fall below the surface.
            below: Below = Below::ThroughR;
        }
        /// A coloured base under a Phong lobe that obeys reciprocity and darkens towards grazing.
        "phong" => Phong {
            /// Exponent of the lobe; larger is sharper.
            exponent: f32 = 100.0, min(0.0), max(1e9);
            /// The part of the light that the lobe reflects at most, per channel.
            reflectance: Rgb<f32> = Rgb::gray(0.8), min(0.0), max(1.0);
            /// The part of the light that the base reflects, per channel.
            diffuse: Texture = Texture::gray(0.0), min(0.0), max(1.0);
            /// What the lobe is multiplied by.
            scale: PhongScale = PhongScale::MaxCosine;
        }
        /// A coloured base under a mirror whose normal trembles.
        "jitter" => Jitter {
            /// Exponent of the distribution of normals; four times that of a lobe of `glossy` is as sharp.
            exponent: f32 = 400.0, min(0.0), max(1e9);
            /// The part of the light that the mirror reflects, per channel.
            reflectance: Rgb<f32> = Rgb::gray(0.8), min(0.0), max(1.0);
            /// The part of the light that the base reflects, per channel.
            diffuse: Texture = Texture::gray(0.0), min(0.0), max(1.0);
        }
        /// A matt base under a smooth clear coat, such as glazed ceramic.
        "glazed" => Glazed {
            /// Index of refraction of the coat.
            ior: f32 = 1.5, min(1.0), max(10.0);
            /// The part of the light that the base reflects, per channel.
            reflectance: Texture = Texture::gray(0.5), min(0.0), max(1.0);
            /// How the reflectance of the coat depends on the angle; absent: as the table `render` says.
            fresnel: Option<Fresnel>;
        }
        /// A surface between matt and mirror by one number, after Schlick.
        "schlick" => Schlick {
            /// Colour straight on, per channel; whiter towards grazing.
            color: Rgb<f32> = Rgb::gray(0.8), min(0.0), max(1.0);
            /// From 0, a mirror, to 1, matt; part of the light is lost between, half of it at 0.5.
            roughness: f32 = 0.2, min(0.0), max(1.0);
            /// 1 is the same in all directions; less is brushed along the first tangent of `conductor`.
            isotropy: f32 = 1.0, min(1e-4), max(1.0);
        }
        /// Other materials in one place, each with its share of the light.
        "mix" => Mix {
            /// One to four parts, whose weights add up to at most 1.
            parts: Vec<MixPart>;
        }
        /// A surface that shines and reflects nothing.
        "emission" => Emission {
            /// What it emits in every direction; a picture or a pattern on meshes and rectangles only.
            radiance: Texture, unit("W/(sr m^2)"), min(0.0), max(1e20);
            /// Whether it shines on both sides, not only on that of its normals.
            two_sided: bool = false;
        }
    }
}

record! {
    /// A part of a mix.
    pub struct MixPart {
        /// Name of the material; neither a mix nor a light. Its relief and holes do not count: a mix has its own.
        material: Located<String>;
        /// Its share of the light, per channel.
        weight: Rgb<f32> = Rgb::gray(0.5), min(0.0), max(1.0);
    }
}

impl Scattering {
    /// Polished clear glass of this index.
    #[must_use]
    pub const fn glass(ior: f32) -> Self {
        Self::Dielectric {
            ior,
            absorption: Rgb::BLACK,
            priority: 0,
            alpha: Roughness::Constant(PerTangent([0.0; 2])),
            distribution: Distribution::Ggx,
            rotate_deg: 0.0,
            fresnel: None,
        }
    }

    /// A metal with facets of this width, alike in all directions.
    #[must_use]
    pub const fn metal(alpha: f32, optics: Optics) -> Self {
        let distribution = Distribution::Ggx;
        Self::Conductor {
            alpha: Roughness::Constant(PerTangent([alpha; 2])),
            distribution,
            rotate_deg: 0.0,
            fresnel: None,
            optics,
        }
    }

    /// A coat of this index over a base.
    #[must_use]
    pub const fn glazed(ior: f32, reflectance: Texture) -> Self {
        Self::Glazed { ior, reflectance, fresnel: None }
    }

    /// A Phong lobe over a base.
    #[must_use]
    pub const fn glossy(exponent: f32, reflectance: Rgb<f32>, diffuse: Texture) -> Self {
        Self::Glossy { exponent, reflectance, diffuse, below: Below::ThroughR }
    }
}

tagged! {
    /// How much a metal reflects at which angle.
    pub enum Optics by key() checked by check::optics {
        /// A metal whose optical constants are known by name.
        "metal" => Metal {
            /// Symbol of the element.
            metal: Located<String>;
        }
        /// A complex index of refraction, per channel.
        "eta" => Index {
            /// Real part of the index of refraction.
            eta: Rgb<f32>, min(1e-3), max(1e3);
            /// Imaginary part of the index of refraction.
            k: Rgb<f32>, above(0.0), max(1e6);
        }
        /// Two colours, from which an index of refraction is derived.
        "reflectance" => Artist {
            /// Reflectance seen straight on.
            reflectance: Rgb<f32>, min(0.0), max(1.0);
            /// Tint towards grazing angles.
            edge_tint: Rgb<f32> = Rgb::gray(1.0), min(0.0), max(1.0);
        }
    }
}
