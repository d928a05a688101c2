//! Lights.

use super::{Located, Step};
use crate::math::Rgb;
use crate::scene::load::EXTENSIONS;
use crate::scene::load::check;
use crate::scene::record::tagged;
use glam::{DVec3, Vec3};
use std::path::PathBuf;

tagged! {
    /// A light.
    pub enum Light by tag() checked by check::light {
        /// A point that shines alike in all directions.
        "point" => Point {
            /// Where it is.
            position: DVec3, unit("m");
            /// Power per solid angle.
            intensity: Rgb<f32>, unit("W/sr"), min(0.0), max(1e20);
        }
        /// A point that shines into a cone.
        "spot" => Spot {
            /// Where it is.
            position: DVec3, unit("m");
            /// The point it aims at.
            at: DVec3, unit("m");
            /// Power per solid angle in the middle of the cone.
            intensity: Rgb<f32>, unit("W/sr"), min(0.0), max(1e20);
            /// Angle between the axis and the rim of the cone.
            angle_deg: f32 = 30.0, unit("degrees"), above(0.0), max(180.0);
            /// The outer part of the angle over which the light fades to nothing.
            softness: f32 = 0.1, min(0.0), max(1.0);
        }
        /// Parallel light from infinitely far away.
        "directional" => Directional {
            /// Where the light travels; any length.
            direction: Vec3, nonzero();
            /// Power per area on a surface that faces the light.
            irradiance: Rgb<f32>, unit("W/m^2"), min(0.0), max(1e20);
        }
        /// A flat parallelogram that shines along `edge_u` x `edge_v`.
        "rectangle" => Rectangle {
            /// Centre.
            center: DVec3, unit("m");
            /// From the centre to the middle of one side.
            edge_u: Vec3, unit("m"), nonzero();
            /// From the centre to the middle of the next side.
            edge_v: Vec3, unit("m"), nonzero();
            /// What it emits in every direction of its bright side.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
        }
        /// A flat round disc that shines along its normal.
        "disc" => Disc {
            /// Centre.
            center: DVec3, unit("m");
            /// The bright side; any length.
            normal: Vec3, nonzero();
            /// Radius.
            radius: f32, unit("m"), above(0.0);
            /// What it emits in every direction of its bright side.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
        }
        /// A sphere that shines outwards.
        "sphere" => Sphere {
            /// Centre.
            center: DVec3, unit("m");
            /// Radius.
            radius: f32, unit("m"), above(0.0);
            /// What it emits in every direction.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
        }
        /// Triangles from a file that shine on the side their normals point to.
        "mesh" => Mesh {
            /// An OBJ or PLY file.
            file: Located<PathBuf>, file(EXTENSIONS);
            /// What they emit in every direction of their bright side.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
            /// Steps that carry the mesh to its place, in the order written.
            transform: Vec<Located<Step>> = vec![];
        }
        /// Light from all around, infinitely far away.
        "environment" => Environment {
            /// A factor on all of it.
            scale: f32 = 1.0, min(0.0);
            /// Turns it about +Y, counter-clockwise seen from above.
            rotate_deg: f32 = 0.0, unit("degrees");
            ..sky: Sky, "What arrives from where.";
        }
    }
}

tagged! {
    /// What an environment shows.
    pub enum Sky by key() {
        /// A picture of all directions, longitude by latitude.
        "file" => File {
            /// An HDR or EXR file.
            file: Located<PathBuf>, file(&["hdr", "exr"]);
        }
        /// The same from everywhere.
        "radiance" => Constant {
            /// What arrives.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
        }
    }
}
