//! Surfaces, and how they are placed.

use super::{Located, PerAxis};
use crate::scene::load::EXTENSIONS;
use crate::scene::load::check;
use crate::scene::record::{choice, record, tagged};
use glam::{DVec3, Vec3};
use std::path::PathBuf;

record! {
    /// A surface, or a prototype of one.
    pub struct Shape checked by check::shape {
        /// A name, unlike those of all other shapes.
        name: Option<Located<String>>;
        /// Name of its material; may be absent where the file of a mesh brings materials.
        material: Option<Located<String>>;
        /// Steps that carry the shape to its place, in the order written.
        transform: Vec<Located<Step>> = vec![];
        /// Where it is carried from there at two or more moments, in the order of time; before the first and after the last
        /// it stands still.
        keys: Vec<Located<ShapeKey>> = vec![];
        /// Whether it is not seen itself, but only through its instances.
        hidden: bool = false;
        ..form: Form, "What it is.";
    }
}

record! {
    /// Where a moving shape is at one moment.
    ///
    /// Where the key before has steps of the same kinds in the same order, or none, each step goes from one to the other by
    /// itself, so that an angle from 0 to 720 degrees is two turns; else the shape turns on the shorter way.
    pub struct ShapeKey {
        /// When.
        time_s: f64, unit("s");
        /// Steps that carry the shape, after its own `transform`, in the order written; all but `fit`.
        transform: Vec<Located<Step>> = vec![];
    }
}

tagged! {
    /// The form of a surface.
    pub enum Form by tag() checked by check::form {
        /// Triangles from a file.
        "mesh" => Mesh {
            /// An OBJ or PLY file.
            file: Located<PathBuf>, file(EXTENSIONS);
            /// Where shading normals come from.
            normals: Normals = Normals::File;
            /// Smooth normals keep edges sharp whose triangles are turned by more against each other; 180 smooths over all.
            crease_deg: f32 = 180.0, unit("degrees"), min(0.0), max(180.0);
        }
        /// A sphere.
        "sphere" => Sphere {
            /// Centre.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// Radius.
            radius: f32 = 1.0, unit("m"), above(0.0);
        }
        /// A flat round disc.
        "disc" => Disc {
            /// Centre.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// The side that is outside; any length.
            normal: Vec3 = Vec3::Y, nonzero();
            /// Radius.
            radius: f32 = 1.0, unit("m"), above(0.0);
        }
        /// A flat parallelogram; its outside is that of `edge_u` x `edge_v`.
        "rectangle" => Rectangle {
            /// Centre.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// From the centre to the middle of one side.
            edge_u: Vec3, unit("m"), nonzero();
            /// From the centre to the middle of the next side.
            edge_v: Vec3, unit("m"), nonzero();
        }
        /// A box along the axes.
        "box" => Box {
            /// Its lowest corner.
            min: DVec3, unit("m");
            /// Its highest corner.
            max: DVec3, unit("m");
        }
        /// A cylinder.
        "cylinder" => Cylinder {
            /// Centre of its first end.
            from: DVec3 = DVec3::ZERO, unit("m");
            /// Centre of its second end.
            to: DVec3 = DVec3::Y, unit("m");
            /// Radius.
            radius: f32 = 1.0, unit("m"), above(0.0);
            /// Whether discs close its ends; a clear body needs them.
            caps: bool = true;
        }
        /// A cone, or what is left of one whose tip is cut off.
        "cone" => Cone {
            /// Centre of its base.
            from: DVec3 = DVec3::ZERO, unit("m");
            /// Its tip, or the centre of the end where that is cut off.
            to: DVec3 = DVec3::Y, unit("m");
            /// Radius of its base.
            radius: f32 = 1.0, unit("m"), above(0.0);
            /// Radius of its other end.
            end_radius: f32 = 0.0, unit("m"), min(0.0);
            /// Whether discs close its ends; a clear body needs them.
            caps: bool = true;
        }
        /// A ring with a hole.
        "torus" => Torus {
            /// Centre.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// The direction through the hole; any length.
            axis: Vec3 = Vec3::Y, nonzero();
            /// From the centre to the middle of the tube.
            major_radius: f32 = 1.0, unit("m"), above(0.0);
            /// Radius of the tube; below `major_radius`.
            minor_radius: f32 = 0.25, unit("m"), above(0.0);
        }
        /// Heights over a rectangle, from the brightness of a picture seen from above: its right is +x, its top -z.
        "height_field" => HeightField {
            /// A gray picture (PNG of 8 or 16 bits, EXR or HDR), 2 by 2 pixels at least; a height per pixel.
            file: Located<PathBuf>, file(&["png", "exr", "hdr"]);
            /// Centre of the rectangle, from which heights are counted.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// Edges of the rectangle along x and z, between the outermost heights.
            size: [f32; 2] = [1.0, 1.0], unit("m"), above(0.0);
            /// Heights of black (0) and of white (1); of what is beyond them in EXR and HDR files in proportion.
            height: [f32; 2] = [0.0, 1.0], unit("m");
            /// Where shading normals come from.
            normals: HeightNormals = HeightNormals::Smooth;
        }
        /// Another shape once more, with a transform of its own after that shape's.
        "instance" => Instance {
            /// Name of the other shape.
            of: Located<String>;
        }
    }
}

choice! {
    /// Where shading normals of a height field come from.
    pub enum HeightNormals {
        /// The slope between the neighbours of each height.
        "smooth" => Smooth,
        /// The triangles between heights.
        "flat" => Flat,
    }
}

choice! {
    /// Where shading normals come from.
    pub enum Normals {
        /// Those of the file; flat where it has none.
        "file" => File,
        /// Averaged over the triangles about each point.
        "smooth" => Smooth,
        /// Those of the triangles.
        "flat" => Flat,
    }
}

tagged! {
    /// A step of a transform.
    pub enum Step by key() checked by check::step {
        /// Scales about the origin.
        "scale" => Scale {
            /// A factor for all axes, or one for each; not zero.
            scale: PerAxis;
        }
        /// Turns about an axis through the origin, counter-clockwise seen from its tip.
        "rotate_deg" => Rotate {
            /// The angle.
            rotate_deg: f64, unit("degrees");
            /// The axis; any length.
            axis: DVec3, nonzero();
        }
        /// Moves.
        "translate" => Translate {
            /// By how much.
            translate: DVec3, unit("m");
        }
        /// Applies an affine matrix to column vectors.
        "matrix" => Matrix {
            /// Four rows of four numbers, one row after the other; the last is 0, 0, 0, 1.
            matrix: [f64; 16];
        }
        /// Scales and moves the shape so that it stands centred on the origin on the plane y = 0.
        "fit" => Fit {
            /// The longest edge that its bounding box shall have.
            fit: f64, unit("m"), above(0.0);
        }
    }
}
