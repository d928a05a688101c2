//! A scene whose noise behaves: no light in it is rare.

/// A corner of bright walls with a fuzzy ball under a lamp: much of the light has bounced, and none of it is rare.
const CORNER: &str = "
[camera]
from = [1.0, 1.2, 3.0]
at = [-0.2, 0.6, 0.0]
vfov_deg = 45.0
[film]
width = 37
height = 21
filter = 'box'
[materials.wall]
type = 'diffuse'
reflectance = [0.8, 0.7, 0.6]
[materials.ball]
type = 'glossy'
exponent = 20.0
[[shapes]]
type = 'rectangle'
edge_u = [9.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -9.0]
material = 'wall'
[[shapes]]
type = 'rectangle'
center = [0.0, 0.0, -1.0]
edge_u = [9.0, 0.0, 0.0]
edge_v = [0.0, 9.0, 0.0]
material = 'wall'
[[shapes]]
type = 'sphere'
center = [0.0, 0.5, 0.0]
radius = 0.5
material = 'ball'
[[lights]]
type = 'rectangle'
center = [0.0, 3.0, 1.0]
edge_u = [1.0, 0.0, 0.0]
edge_v = [0.0, 0.0, 1.0]
radiance = 4.0
";

/// That scene, with these settings of `render`.
pub(crate) fn corner(settings: &str) -> String {
    format!("{CORNER}\n[render]\n{settings}\n")
}
