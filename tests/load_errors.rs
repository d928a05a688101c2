//! Every bad scene file gives its messages, all of them, each with its place and a remedy.
//!
//! A case is a set of small files, the first of which is loaded, and the exact messages it must give.

use specula::scene;
use std::fs;
use std::path::Path;

struct Case {
    name: &'static str,
    /// The file that is loaded, `scene.toml`.
    text: &'static str,
    /// Files beside it.
    more: &'static [(&'static str, &'static str)],
    overrides: &'static [&'static str],
    messages: &'static [&'static str],
}

/// A single file without overrides.
const fn file(name: &'static str, text: &'static str, messages: &'static [&'static str]) -> Case {
    Case { name, text, more: &[], overrides: &[], messages }
}

const CASES: &[Case] = &[
    file(
        "several at once, from top to bottom",
        "[camera]\nfrom = [0, 1]\nvfov = 40\n[film]\nwidth = 0\nfilter = 'mitchel'\n[[shapes]]\ntype = 'sphere'\n\
         radius = -1\nmaterial = 'glas'\n[materials.glass]\ntype = 'dielectic'\n",
        &[
            "scene.toml:2:8: `from` is an array of two; it must be three numbers [x, y, z] in m",
            "scene.toml:3:1: unknown key `vfov`; did you mean `vfov_deg`?",
            "scene.toml:5:9: `width` is 0; it must be an integer from 1 to 65536 pixels",
            "scene.toml:6:10: `filter` is `mitchel`; did you mean `mitchell`?",
            "scene.toml:9:10: `radius` is -1; it must be a number above 0 m",
            "scene.toml:10:12: unknown material `glas`; did you mean `glass`?",
            "scene.toml:12:8: unknown type `dielectic`; did you mean `dielectric`?",
        ],
    ),
    file(
        "materials that nothing is made of",
        "[materials]\nice = { type = 'dielectric' }\nlit = { type = 'diffuse', emission = 1 }\n\
         dark = { type = 'diffuse', emission = [0, 0, 0] }\nmetal = { type = 'conductor', metal = 'Xx' }\n\
         two = { type = 'mix', parts = [{ material = 'ice' }, { material = 'ice', weight = 0 }] }\n\
         lamp = { type = 'mix', parts = [{ material = 'lit' }, { material = 'dark' }] }\n\
         both = { type = 'diffuse', normal_map = { file = 'a.png' }, bump = { file = 'a.png' } }\n",
        &[
            "scene.toml:5:39: unknown metal `Xx`; known are Ag, Al, Au, Cr, Cu, Fe, Ni, Pt, Ti, W, silver, aluminium, aluminum, gold, chromium, copper, iron, nickel, platinum, titanium, tungsten",
            "scene.toml:6:1: `two` would be the surface of two bodies; let one part at most be a `dielectric`",
            "scene.toml:7:46: `lit` shines, which a part of a mix cannot; give the mix a key `emission` instead",
            "scene.toml:8:68: `bump` beside `normal_map`; give one of them",
        ],
    ),
    file(
        "an empty file",
        "",
        &[
            "warning: there is no shape: the picture will be empty; add `[[shapes]]`",
            "warning: there is no light: the picture will be black; add `[[lights]]`",
        ],
    ),
    file(
        "a file of white space, with a byte order mark",
        "\u{feff}\r\n\r\n# nothing\r\n",
        &[
            "warning: there is no shape: the picture will be empty; add `[[shapes]]`",
            "warning: there is no light: the picture will be black; add `[[lights]]`",
        ],
    ),
    file(
        "lines that end in CRLF, behind a byte order mark",
        "\u{feff}[film]\r\nwidth = 1\r\nheigth = 2\r\n",
        &["scene.toml:3:1: unknown key `heigth`; did you mean `height`?"],
    ),
    file(
        "columns count characters",
        "materials.'Größe' = { type = 'matt' }",
        &[
            "scene.toml:1:30: unknown type `matt`; it must be `diffuse`, `oren_nayar`, `mirror`, `conductor`, `dielectric`, `thin_dielectric`, `glossy`, `phong`, `jitter`, `glazed`, `schlick`, `mix` or `emission`",
        ],
    ),
    file(
        "syntax",
        "[camera\nfrom = [0, 1\n",
        &["scene.toml:1:8: unclosed table; expected `]`", "scene.toml:2:13: unclosed array; expected `]`"],
    ),
    file(
        "several syntax errors hide the rest",
        "a = \nb = 1 2\n[film]\nwidth = 0\n",
        &[
            "scene.toml:1:5: string values must be quoted; expected literal string",
            "scene.toml:2:5: string values must be quoted; expected literal string",
        ],
    ),
    file(
        "a key given twice",
        "[film]\nwidth = 1\nwidth = 2\n",
        &["scene.toml:3:1: duplicate key; it stands further up already; remove one of them"],
    ),
    file(
        "a table given twice",
        "[film]\nwidth = 1\n[render]\n[film]\n",
        &["scene.toml:4:2: duplicate key; it stands further up already; remove one of them"],
    ),
    file(
        "unknown tables",
        "[camra]\n[xyz]\n",
        &[
            "scene.toml:1:2: unknown key `camra`; did you mean `camera`?",
            "scene.toml:2:2: unknown key `xyz`; known are `include`, `camera`, `film`, `render`, `materials`, `shapes` and `lights`",
        ],
    ),
    file(
        "tables that are none",
        "camera = 3\nmaterials = []\nshapes = {}\nlights = [1]\n",
        &[
            "scene.toml:1:10: `camera` is an integer; it must be a table",
            "scene.toml:2:13: `materials` is an array; it must be a table with a name for each entry",
            "scene.toml:3:10: `shapes` is a table; it must be an array, each entry a table",
            "scene.toml:4:11: `lights` is an integer; it must be a table",
        ],
    ),
    file(
        "wrong types",
        "[film]\nwidth = '1'\nheight = 2.0\nfilter = 3\nexposure_ev = true\ntone = 1979-05-27\n",
        &[
            "scene.toml:2:9: `width` is a string; it must be an integer from 1 to 65536 pixels",
            "scene.toml:3:10: `height` is 2.0, a float; it must be an integer from 1 to 65536 pixels",
            "scene.toml:4:10: `filter` is an integer; it must be `box`, `tent`, `gaussian` or `mitchell`",
            "scene.toml:5:15: `exposure_ev` is a boolean; it must be a number from -100 to 100 stops",
            "scene.toml:6:8: `tone` is a date; it must be `clip` or `filmic`",
        ],
    ),
    file(
        "numbers that are none",
        "[camera]\nvfov_deg = nan\nfrom = [inf, -inf, 1e39]\nat = [1e400, 0, 0]\n",
        &[
            "scene.toml:2:12: `vfov_deg` is NaN; it must be a number above 0 and below 180 degrees",
            "scene.toml:3:9: `from` is inf; it must be a number in m",
            "scene.toml:3:14: `from` is -inf; it must be a number in m",
            "scene.toml:3:20: `from` is 1e39, too large for single precision; it must be a number in m",
            "scene.toml:4:7: `at` is inf; it must be a number in m",
        ],
    ),
    file(
        "numbers beyond their range",
        "[camera]\nvfov_deg = 180\n[render]\nspp = 99999999999999999999999999999999999999999999\nseed = -1\n\
         max_depth = 4294967296\nmin_throughput = 1.5\n[film]\nfilter_radius = 1e-50\n",
        &[
            "scene.toml:2:12: `vfov_deg` is 180; it must be a number above 0 and below 180 degrees",
            "scene.toml:4:7: `spp` is inf, a float; it must be an integer from 1 to 16777216",
            "scene.toml:5:8: `seed` is -1; it must be an integer from 0 to 18446744073709551615",
            "scene.toml:6:13: `max_depth` is 4294967296; it must be an integer from 1 to 65536",
            "scene.toml:7:18: `min_throughput` is 1.5; it must be a number from 0 to 1",
            "scene.toml:9:17: `filter_radius` is 1e-50; it must be a number above 0 and at most 16 pixels",
        ],
    ),
    file(
        "a camera that looks nowhere",
        "[camera]\nfrom = [0, 0, 0]\nat = [0, 0, 0]\n",
        &["scene.toml:3:6: `at` is where the camera stands; give another point to look at"],
    ),
    file(
        "a camera that looks nearly nowhere",
        "[camera]\nfrom = [0, 0, 0]\nat = [0, 0, 1e-50]\n",
        &["scene.toml:3:6: `at` is where the camera stands; give another point to look at"],
    ),
    file(
        "a camera that looks too near or too far",
        "[camera]\nfrom = [0, 0, 0]\nat = [0, 0, 1e-30]\nshutter_close_s = 1\nkeys = [{ time_s = 0 }, { time_s = 1, at = [0, 0, 1e30] }]\n",
        &[
            "scene.toml:3:6: `at` is too near to the camera, or too far away, for single precision; give another point to look at",
            "scene.toml:5:9: `at` is too near to the camera, or too far away, for single precision; give another point to look at",
            "scene.toml:5:44: `at` is too near to the camera, or too far away, for single precision; give another point to look at",
        ],
    ),
    Case {
        name: "mirrored reliefs",
        text: "[materials]\na = { type = 'diffuse', bump = { file = 'a.png', repeat = [1, -2] } }\n\
               b = { type = 'diffuse', normal_map = { file = 'a.png', repeat = [0, 1] } }\n\
               c = { type = 'diffuse', reflectance = { file = 'a.png', repeat = [1, -2] } }\n",
        more: &[("a.png", "")],
        overrides: &[],
        messages: &[
            "scene.toml:2:59: `repeat` of a relief is not above 0; give positive numbers",
            "scene.toml:3:65: `repeat` of a relief is not above 0; give positive numbers",
        ],
    },
    file(
        "a spot that aims nearly nowhere",
        "[[lights]]\ntype = 'spot'\nintensity = 1\nposition = [0, 0, 0]\nat = [0, 0, 1e-50]\n",
        &["scene.toml:5:6: `at` is where the light stands; give another point to aim at"],
    ),
    file(
        "a camera that looks up",
        "[camera]\nfrom = [0, 0, 0]\nat = [0, 2, 0]\n",
        &["scene.toml:1:1: `up` points along the view; give another direction"],
    ),
    file(
        "a camera without an up",
        "[camera]\nup = [0, 0, -0.0]\n",
        &["scene.toml:2:6: `up` is zero; it must be three numbers [x, y, z], not all zero"],
    ),
    file(
        "an unknown kind of camera",
        "[camera]\ntype = 'perspectiv'\nfrom = 1\n",
        &["scene.toml:2:8: unknown type `perspectiv`; did you mean `perspective`?"],
    ),
    file(
        "materials",
        "[materials]\na = { reflectance = 1 }\nb = { type = 3 }\nc = { type = 'glossy', exponent = -1, shine = 2 }\n\
         d = { type = 'diffuse', reflectance = 'red' }\ne = { type = 'diffuse', reflectance = [1, 2, 0.5] }\n\
         f = { type = 'diffuse', reflectance = { checker = [0, 1, 0], repeat = [0, 1] } }\ng = 1\n\
         h = { type = 'emission' }\ni = { type = 'mirror', radiance = 1 }\n",
        &[
            "scene.toml:2:5: missing key `type`; it must be `diffuse`, `oren_nayar`, `mirror`, `conductor`, `dielectric`, `thin_dielectric`, `glossy`, `phong`, `jitter`, `glazed`, `schlick`, `mix` or `emission`",
            "scene.toml:3:14: `type` is an integer; it must be `diffuse`, `oren_nayar`, `mirror`, `conductor`, `dielectric`, `thin_dielectric`, `glossy`, `phong`, `jitter`, `glazed`, `schlick`, `mix` or `emission`",
            "scene.toml:4:35: `exponent` is -1; it must be a number from 0 to 1e9",
            "scene.toml:4:39: unknown key `shine`; known are `emission`, `normal_map`, `bump`, `opacity`, `type`, `exponent`, `reflectance`, `diffuse` and `below`",
            "scene.toml:5:39: `reflectance` is a string; it must be a colour: one number or [r, g, b], each from 0 to 1, or a texture { file = \"..\" } or { checker = [.., ..] }",
            "scene.toml:6:43: `reflectance` is 2; it must be a number from 0 to 1",
            "scene.toml:7:51: `checker` is an array of three; it must be an array of two, each a colour: one number or [r, g, b], each from 0 to 1",
            "scene.toml:7:72: `repeat` is 0; it must be a number above 0 and at most 1e6",
            "scene.toml:8:5: `g` is an integer; it must be a table",
            "scene.toml:9:5: missing key `radiance`; give a colour: one number or [r, g, b], each from 0 to 1e20 W/(sr m^2), or a texture { file = \"..\" } or { checker = [.., ..] }",
            "scene.toml:10:24: `radiance` does not go with type `mirror`; it belongs to type `emission`",
        ],
    ),
    file(
        "how surfaces reflect",
        "[render]\nfresnel = 'exakt'\n[materials]\na = { type = 'dielectric', alpha = [0.1, 0.2, 0.3] }\n\
         b = { type = 'dielectric', alpha = [0.1, 2] }\nc = { type = 'glossy', below = 'above' }\n\
         d = { type = 'diffuse', fresnel = 'exact' }\n",
        &[
            "scene.toml:2:11: `fresnel` is `exakt`; did you mean `exact`?",
            "scene.toml:4:36: `alpha` is an array of three; it must be a number or two numbers [x, y] from 0 to 1",
            "scene.toml:5:42: `alpha` is 2; it must be a number from 0 to 1",
            "scene.toml:6:32: `below` is `above`; it must be `through_r`, `discard` or `rejection`",
            "scene.toml:7:25: `fresnel` does not go with type `diffuse`; it belongs to type `conductor`, type `dielectric`, \
             type `thin_dielectric` or type `glazed`",
        ],
    ),
    file(
        "conductors",
        "[materials]\na = { type = 'conductor' }\nb = { type = 'conductor', metal = 'Au', eta = 1 }\n\
         c = { type = 'conductor', eta = 1 }\nd = { type = 'conductor', metl = 'Au' }\n\
         e = { type = 'conductor', metal = '' }\nf = { type = 'conductor', metal = 'Au', ior = 1 }\n",
        &[
            "scene.toml:2:5: one of the keys `metal`, `eta` or `reflectance` is needed",
            "scene.toml:3:41: `eta` does not go with `metal`; remove one of them",
            "scene.toml:4:5: missing key `k`; give a colour: one number or [r, g, b], each above 0 and at most 1e6",
            "scene.toml:5:27: unknown key `metl`; did you mean `metal`?",
            "scene.toml:6:35: `metal` is empty; it must be a string with at least one character",
            "scene.toml:7:41: `ior` does not go with type `conductor`; it belongs to type `dielectric`, type `thin_dielectric` or type `glazed`",
        ],
    ),
    file(
        "every number of a material has a range",
        "[materials]\na = { type = 'diffuse', emission = 1e21, reflectance = -0.1 }\n\
         b = { type = 'oren_nayar', roughness = 1.01 }\nc = { type = 'mirror', reflectance = [1, 1.5, 0] }\n\
         d = { type = 'conductor', eta = 1e-4, k = 2e6 }\ne = { type = 'conductor', eta = [1, 1e4, 1], k = 0 }\n\
         f = { type = 'conductor', reflectance = 2, edge_tint = -1, rotate_deg = 1e6 }\n\
         g = { type = 'dielectric', ior = 0.9, absorption = 1e10, alpha = -0.1, priority = 3e9 }\n\
         h = { type = 'thin_dielectric', ior = 11, transmittance = 1.1 }\n\
         i = { type = 'glossy', exponent = 1e10, reflectance = 1.1, diffuse = -1 }\n\
         j = { type = 'phong', exponent = -1 }\nk = { type = 'jitter', exponent = 2e9, diffuse = 2 }\n\
         l = { type = 'glazed', ior = 0.99, reflectance = 2 }\n\
         m = { type = 'schlick', color = 2, roughness = -1, isotropy = 0 }\n\
         n = { type = 'mix', parts = [{ material = 'a', weight = 1.5 }] }\n\
         o = { type = 'emission', radiance = [1, -1, 1] }\n\
         p = { type = 'diffuse', reflectance = { checker = [0, 1], repeat = [1, 1e7] } }\n",
        &[
            "scene.toml:2:36: `emission` is 1000000000000000000000; it must be a number from 0 to 1e20 W/(sr m^2)",
            "scene.toml:2:56: `reflectance` is -0.1; it must be a number from 0 to 1",
            "scene.toml:3:40: `roughness` is 1.01; it must be a number from 0 to 1",
            "scene.toml:4:42: `reflectance` is 1.5; it must be a number from 0 to 1",
            "scene.toml:5:33: `eta` is 0.0001; it must be a number from 0.001 to 1000",
            "scene.toml:5:43: `k` is 2000000; it must be a number above 0 and at most 1e6",
            "scene.toml:6:37: `eta` is 10000; it must be a number from 0.001 to 1000",
            "scene.toml:6:50: `k` is 0; it must be a number above 0 and at most 1e6",
            "scene.toml:7:41: `reflectance` is 2; it must be a number from 0 to 1",
            "scene.toml:7:56: `edge_tint` is -1; it must be a number from 0 to 1",
            "scene.toml:7:73: `rotate_deg` is 1000000; it must be a number from -36000 to 36000 degrees",
            "scene.toml:8:34: `ior` is 0.9; it must be a number from 1 to 10",
            "scene.toml:8:52: `absorption` is 10000000000; it must be a number from 0 to 1e9 1/m",
            "scene.toml:8:66: `alpha` is -0.1; it must be a number from 0 to 1",
            "scene.toml:8:83: `priority` is 3000000000.0, a float; it must be an integer from -2147483648 to 2147483647",
            "scene.toml:9:39: `ior` is 11; it must be a number from 1 to 10",
            "scene.toml:9:59: `transmittance` is 1.1; it must be a number from 0 to 1",
            "scene.toml:10:35: `exponent` is 10000000000; it must be a number from 0 to 1e9",
            "scene.toml:10:55: `reflectance` is 1.1; it must be a number from 0 to 1",
            "scene.toml:10:70: `diffuse` is -1; it must be a number from 0 to 1",
            "scene.toml:11:34: `exponent` is -1; it must be a number from 0 to 1e9",
            "scene.toml:12:35: `exponent` is 2000000000; it must be a number from 0 to 1e9",
            "scene.toml:12:50: `diffuse` is 2; it must be a number from 0 to 1",
            "scene.toml:13:30: `ior` is 0.99; it must be a number from 1 to 10",
            "scene.toml:13:50: `reflectance` is 2; it must be a number from 0 to 1",
            "scene.toml:14:33: `color` is 2; it must be a number from 0 to 1",
            "scene.toml:14:48: `roughness` is -1; it must be a number from 0 to 1",
            "scene.toml:14:63: `isotropy` is 0; it must be a number from 0.0001 to 1",
            "scene.toml:15:57: `weight` is 1.5; it must be a number from 0 to 1",
            "scene.toml:16:41: `radiance` is -1; it must be a number from 0 to 1e20 W/(sr m^2)",
            "scene.toml:17:72: `repeat` is 10000000; it must be a number above 0 and at most 1e6",
        ],
    ),
    file(
        "shapes",
        "[materials.m]\ntype = 'mirror'\n[[shapes]]\nmaterial = 'm'\n[[shapes]]\ntype = 'sphere'\n[[shapes]]\n\
         type = 'box'\nmin = [0, 0, 0]\nmax = [1, 0, 1]\nmaterial = 'm'\nradius = 2\n[[shapes]]\ntype = 'rectangle'\n\
         edge_u = [1, 0, 0]\nedge_v = [-2, 0, 0]\nmaterial = 'm'\n[[shapes]]\ntype = 'disc'\nnormal = [0, 0, 0]\n\
         material = 'n'\n",
        &[
            "scene.toml:3:1: missing key `type`; it must be `mesh`, `sphere`, `disc`, `rectangle`, `box`, `cylinder`, `cone`, `torus`, `height_field` or `instance`",
            "scene.toml:5:1: missing key `material`; known are `m`",
            "scene.toml:10:7: `max` is not above `min` on every axis; give the lower corner as `min`",
            "scene.toml:12:1: `radius` does not go with type `box`; it belongs to type `sphere`, type `disc`, type `cylinder` or type `cone`",
            "scene.toml:16:10: `edge_v` is parallel to `edge_u`; give edges that span an area",
            "scene.toml:20:10: `normal` is zero; it must be three numbers [x, y, z], not all zero",
            "scene.toml:21:12: unknown material `n`; known are `m`",
        ],
    ),
    file(
        "round bodies",
        "[materials.m]\ntype = 'mirror'\n[[shapes]]\ntype = 'cylinder'\nfrom = [0, 1, 0]\nradius = 0\ncaps = 1\n\
         [[shapes]]\ntype = 'cylinder'\nfrom = [0, 1, 0]\nmaterial = 'm'\n[[shapes]]\ntype = 'cone'\nto = [0, 0, 0]\n\
         material = 'm'\n[[shapes]]\ntype = 'cone'\nend_radius = -1\nmaterial = 'm'\n[[shapes]]\ntype = 'torus'\n\
         minor_radius = 1\nmaterial = 'm'\n[[shapes]]\ntype = 'torus'\nmajor_radius = 0.1\nmaterial = 'm'\n[[shapes]]\n\
         type = 'torus'\naxis = [0, 0, 0]\nmajor_radius = 0\n",
        &[
            "scene.toml:3:1: missing key `material`; known are `m`",
            "scene.toml:6:10: `radius` is 0; it must be a number above 0 m",
            "scene.toml:7:8: `caps` is an integer; it must be `true` or `false`",
            "scene.toml:8:1: `to` is where the axis starts; give another point as its other end",
            "scene.toml:14:6: `to` is where the axis starts; give another point as its other end",
            "scene.toml:18:14: `end_radius` is -1; it must be a number of at least 0 m",
            "scene.toml:22:16: `minor_radius` is not below `major_radius`; a ring needs a hole; give a thinner tube or a larger `major_radius`",
            "scene.toml:24:1: `minor_radius` is not below `major_radius`; a ring needs a hole; give a thinner tube or a larger `major_radius`",
            "scene.toml:28:1: missing key `material`; known are `m`",
            "scene.toml:30:8: `axis` is zero; it must be three numbers [x, y, z], not all zero",
            "scene.toml:31:16: `major_radius` is 0; it must be a number above 0 m",
        ],
    ),
    file(
        "height fields",
        "[materials.m]\ntype = 'mirror'\n[[shapes]]\ntype = 'height_field'\nsize = [1, 0]\nheight = 1\n\
         normals = 'file'\n[[shapes]]\ntype = 'height_field'\nfile = 'hills.png'\nmaterial = 'm'\n[[shapes]]\n\
         type = 'height_field'\nfile = 'scene.toml'\nmaterial = 'm'\n",
        &[
            "scene.toml:3:1: missing key `file`; give a file (.png, .exr or .hdr)",
            "scene.toml:3:1: missing key `material`; known are `m`",
            "scene.toml:5:12: `size` is 0; it must be a number above 0 m",
            "scene.toml:6:10: `height` is an integer; it must be an array of two, each a number in m",
            "scene.toml:7:11: `normals` is `file`; it must be `smooth` or `flat`",
            "scene.toml:10:8: no such file `hills.png`; paths are relative to the file that names them",
            "scene.toml:14:8: `scene.toml` is of an unknown format; it must end in .png, .exr or .hdr",
        ],
    ),
    file(
        "transforms",
        "[[shapes]]\ntype = 'mesh'\nfile = 'a.obj'\ntransform = [{ scale = 0 }, { scal = 1 }, { rotate_deg = 1 }, \
         { translate = [1, 2] },\n { matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1] }, {}, \
         { matrix = [1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] },\n { scale = 1, fit = 2 }, { fit = 0 }]\n",
        &[
            "scene.toml:4:24: `scale` is zero; give factors other than zero",
            "scene.toml:4:31: unknown key `scal`; did you mean `scale`?",
            "scene.toml:4:43: missing key `axis`; give three numbers [x, y, z], not all zero",
            "scene.toml:4:77: `translate` is an array of two; it must be three numbers [x, y, z] in m",
            "scene.toml:5:13: `matrix` is not affine; give the matrix row by row; the last row must be 0, 0, 0, 1",
            "scene.toml:5:65: one of the keys `scale`, `rotate_deg`, `translate`, `matrix` or `fit` is needed",
            "scene.toml:5:80: `matrix` has no inverse; give one whose determinant is not zero",
            "scene.toml:6:15: `fit` does not go with `scale`; remove one of them",
            "scene.toml:6:34: `fit` is 0; it must be a number above 0 m",
        ],
    ),
    file(
        "lights",
        "[[lights]]\ntype = 'spot'\nposition = [0, 0, 0]\nat = [0, 0, 0]\nintensity = -1\n[[lights]]\n\
         type = 'environment'\n[[lights]]\ntype = 'environment'\nradiance = 1\nfile = 'a.obj'\n[[lights]]\n\
         type = 'point'\nposition = [0, 0, 0]\nintensity = 1\nradius = 1\n",
        &[
            "scene.toml:5:13: `intensity` is -1; it must be a number from 0 to 1e20 W/sr",
            "scene.toml:6:1: one of the keys `file` or `radiance` is needed",
            "scene.toml:10:1: `radiance` does not go with `file`; remove one of them",
            "scene.toml:11:8: `a.obj` is of an unknown format; it must end in .hdr or .exr",
            "scene.toml:16:1: `radius` does not go with type `point`; it belongs to type `disc` or type `sphere`",
        ],
    ),
    file(
        "names",
        "[[shapes]]\ntype = 'instance'\nof = 'buny'\n[[shapes]]\nname = 'bunny'\ntype = 'mesh'\nfile = 'a.obj'\n\
         [[shapes]]\nname = 'bunny'\ntype = 'sphere'\nmaterial = 'gold'\n",
        &[
            "scene.toml:3:6: unknown shape `buny`; did you mean `bunny`?",
            "scene.toml:9:8: a shape named `bunny` is there already at scene.toml:5:8; give one of them another name",
            "scene.toml:11:12: unknown material `gold`; there is no material; define it first",
        ],
    ),
    file(
        "instances of themselves",
        "[[shapes]]\nname = 'a'\ntype = 'instance'\nof = 'b'\n[[shapes]]\nname = 'b'\ntype = 'instance'\nof = 'c'\n\
         [[shapes]]\nname = 'c'\ntype = 'instance'\nof = 'b'\n[[shapes]]\nname = 'd'\ntype = 'instance'\nof = 'd'\n",
        &[
            "scene.toml:12:6: shape `b` is an instance of itself, by `c` and `b`; make one of them a shape of its own",
            "scene.toml:16:6: shape `d` is an instance of itself, by `d`; make one of them a shape of its own",
        ],
    ),
    file(
        "files",
        "[[shapes]]\ntype = 'mesh'\nfile = 'b.obj'\n[[shapes]]\ntype = 'mesh'\nfile = 'scene.toml'\n[[shapes]]\n\
         type = 'mesh'\nfile = '.'\n[[shapes]]\ntype = 'mesh'\nfile = ''\n[[lights]]\ntype = 'environment'\n\
         file = 'there/is/none.hdr'\n",
        &[
            "scene.toml:3:8: no such file `b.obj`; did you mean `a.obj`?",
            "scene.toml:6:8: `scene.toml` is of an unknown format; it must end in .obj or .ply",
            "scene.toml:9:8: `.` is a directory; name a file in it",
            "scene.toml:12:8: `file` is empty; it must be a file (.obj or .ply)",
            "scene.toml:15:8: no such file `there/is/none.hdr`; paths are relative to the file that names them",
        ],
    ),
    Case {
        name: "what includes do",
        text: "include = ['b.toml', 'c.toml']\n[materials.x]\ntype = 'mirror'\n[film]\nwidth = 0\n",
        more: &[
            ("b.toml", "[materials.x]\ntype = 'diffuse'\n[film]\nwidth = -1\nheight = 0\n"),
            ("c.toml", "include = ['b.toml', 'd.toml']\n[[shapes]]\ntype = 'sphere'\nmaterial = 'y'\n"),
        ],
        overrides: &[],
        messages: &[
            "scene.toml:2:12: material `x` is defined already at b.toml:1:12; give one of them another name",
            "scene.toml:5:9: `width` is 0; it must be an integer from 1 to 65536 pixels",
            "b.toml:5:10: `height` is 0; it must be an integer from 1 to 65536 pixels",
            "c.toml:1:22: no such file `d.toml`; did you mean `b.toml`?",
        ],
    },
    Case {
        name: "files that include each other",
        text: "include = ['b.toml']\n[film]\nwidth = 0\n",
        more: &[
            ("b.toml", "\ninclude = ['c.toml']\n"),
            ("c.toml", "include = [\n  'b.toml',\n  'scene.toml',\n  3,\n  'a.obj'\n]\n"),
        ],
        overrides: &[],
        messages: &[
            "scene.toml:3:9: `width` is 0; it must be an integer from 1 to 65536 pixels",
            "c.toml:2:3: `b.toml` includes itself, by b.toml:2:12 and c.toml:2:3; remove one of these includes",
            "c.toml:3:3: `scene.toml` includes itself, by scene.toml:1:12, b.toml:2:12 and c.toml:3:3; remove one of these includes",
            "c.toml:4:3: `include` is an integer; it must be a file (.toml)",
            "c.toml:5:3: `a.obj` is of an unknown format; it must end in .toml",
        ],
    },
    file(
        "a file that includes itself",
        "include = ['scene.toml']\n",
        &["scene.toml:1:12: `scene.toml` includes itself, by scene.toml:1:12; remove one of these includes"],
    ),
    Case {
        name: "an included file that is no TOML",
        text: "include = ['b.toml']\n[[shapes]]\ntype = 'sphere'\nmaterial = 'unknown'\n",
        more: &[("b.toml", "x = [\n")],
        overrides: &[],
        messages: &["b.toml:1:6: unclosed array; expected `]`"],
    },
    Case {
        name: "overrides",
        text: "[[shapes]]\nname = 'model'\ntype = 'mesh'\nfile = 'a.obj'\n",
        more: &[],
        overrides: &[
            "render.sp=4",
            "render.spp=many",
            "render.spp.x=1",
            "film.width",
            "=1",
            "film..width=1",
            "shapes.modl.file=b.obj",
            "shapes.1.file=b.obj",
            "lights.0.radiance=1",
            "shapes.model.file=no.obj",
            "shapes.model.normals=rough",
            "include=['a.toml']",
            "materials.\"a.b\".type=glass",
        ],
        messages: &[
            "command line: in `render.sp=4`: unknown key `sp`; did you mean `spp`?",
            "command line: in `render.spp=many`: `spp` is a string; it must be an integer from 1 to 16777216",
            "command line: in `render.spp.x=1`: `x` leads into a string; only tables and arrays have something inside",
            "command line: in `film.width`: this is no override; write key=value, the key as a dotted path",
            "command line: in `=1`: the path has an empty part; write key=value, the key as a dotted path",
            "command line: in `film..width=1`: the path has an empty part; write key=value, the key as a dotted path",
            "command line: in `shapes.modl.file=b.obj`: there is no entry named `modl`; did you mean `model`?",
            "command line: in `shapes.1.file=b.obj`: there is no entry 1; entries count from 0, and there are one of them",
            "command line: in `lights.0.radiance=1`: there is no entry 0; entries count from 0, and there are no of them",
            "command line: in `shapes.model.file=no.obj`: no such file `no.obj`; paths are relative to the file that names them",
            "command line: in `shapes.model.normals=rough`: `normals` is `rough`; it must be `file`, `smooth` or `flat`",
            "command line: in `include=['a.toml']`: `include` cannot be overridden; name another scene file",
            "command line: in `materials.\"a.b\".type=glass`: unknown type `glass`; it must be `diffuse`, `oren_nayar`, `mirror`, `conductor`, `dielectric`, `thin_dielectric`, `glossy`, `phong`, `jitter`, `glazed`, `schlick`, `mix` or `emission`",
        ],
    },
    file(
        "a scene of nothing, without a light",
        "[render]\nspp = 4\n",
        &[
            "warning: there is no shape: the picture will be empty; add `[[shapes]]`",
            "warning: there is no light: the picture will be black; add `[[lights]]`",
        ],
    ),
    file(
        "a hidden shape that nothing shows",
        "[materials.m]\ntype = 'emission'\nradiance = 1\n[[shapes]]\nname = 'a'\ntype = 'sphere'\nmaterial = 'm'\n\
         hidden = true\n",
        &[
            "warning: scene.toml:4:1: this shape is hidden and has no instance; add an instance of it, or remove `hidden`",
        ],
    ),
];

/// Messages of loading a case in a directory of its own; paths in them are relative to it.
fn messages(case: &Case) -> Vec<String> {
    let dir = tempfile::tempdir().expect("a temporary directory");
    fs::write(dir.path().join("a.obj"), "").expect("written");
    for (name, text) in case.more.iter().chain(&[("scene.toml", case.text)]) {
        fs::write(dir.path().join(name), text).expect("written");
    }
    let overrides: Vec<String> = case.overrides.iter().map(|&text| text.into()).collect();
    messages_of(&dir.path().join("scene.toml"), &overrides)
}

/// Errors, or warnings marked as such.
fn messages_of(path: &Path, overrides: &[String]) -> Vec<String> {
    let dir = format!("{}/", path.parent().expect("a directory").display());
    let lines = |shown: String| shown.lines().map(|line| line.replace(&dir, "")).collect::<Vec<_>>();
    match scene::load(path, overrides) {
        Ok(loaded) => {
            loaded.warnings.iter().flat_map(|warning| lines(format!("warning: {warning}"))).collect()
        }
        Err(error) => lines(error.to_string()),
    }
}

#[test]
fn each_case_gives_its_messages() {
    for case in CASES {
        assert_eq!(messages(case), case.messages, "{}", case.name);
    }
}

/// What is no text, or no file.
#[test]
fn what_cannot_be_read_is_told() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let written = |name: &str, bytes: &[u8]| {
        let path = dir.path().join(name);
        fs::write(&path, bytes).expect("written");
        messages_of(&path, &[])
    };
    let found = written("latin1.toml", b"# nothing\n# Gr\xf6\xdfe\n");
    assert_eq!(found, ["latin1.toml:2:5: the file is not UTF-8 from here on; save it as UTF-8"], "Latin-1");
    let found = written("utf16.toml", b"\xff\xfe[\0f\0]\0");
    assert_eq!(found, ["utf16.toml:1:1: the file is not UTF-8 from here on; save it as UTF-8"], "UTF-16");
    let found = written("nul.toml", b"\0");
    assert!(!found.is_empty() && found.iter().all(|message| message.starts_with("nul.toml:1:")), "{found:?}");
    let found = messages_of(dir.path(), &[]);
    assert!(found.len() == 1 && found[0].ends_with("is a directory; name a file in it"), "{found:?}");
    let found = messages_of(&dir.path().join("latin2.toml"), &[]);
    assert_eq!(found, ["latin2.toml: no such file `latin2.toml`; did you mean `latin1.toml`?"], "no file");
}

/// Nesting of any depth is an error, not a stack overflow.
#[test]
fn deep_nesting_is_refused() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("scene.toml");
    for text in [
        format!("a = {}", "[".repeat(10_000)),
        format!("a = {}", "{b=".repeat(10_000)),
        format!("{}a = 1", "a.".repeat(10_000)),
        format!("[{}a]", "a.".repeat(10_000)),
    ] {
        fs::write(&path, &text).expect("written");
        assert!(!messages_of(&path, &[]).is_empty(), "accepted: {}...", &text[..20]);
    }
    fs::write(&path, "").expect("written");
    let long = format!("{}a=1", "a.".repeat(1000));
    assert_eq!(messages_of(&path, &[long]).len(), 1, "a long path on the command line");
}

/// A chain of includes that is too long.
#[test]
fn includes_end_somewhere() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    for i in 0..100 {
        let text = format!("include = ['{}.toml']\n", i + 1);
        fs::write(dir.path().join(format!("{i}.toml")), text).expect("written");
    }
    let found = messages_of(&dir.path().join("0.toml"), &[]);
    let expected = "31.toml:1:12: files include each other more than 32 deep; \
        include files directly, or allow more by `--limits include_depth=33`";
    assert_eq!(found, [expected], "told once");
}

/// Random damage to a good file gives messages or a scene, never a panic, and each message names the file.
#[test]
fn damage_never_panics() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("scene.toml");
    fs::write(dir.path().join("a.obj"), "").expect("written");
    let whole: String = CASES.iter().map(|case| case.text).collect::<Vec<_>>().join("\n");
    let mut state = 1_u64;
    let mut random = |below: usize| {
        // Knuth's multiplicative generator (1997, The Art of Computer Programming 2, section 3.3.4).
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).expect("31 bits") % below
    };
    for _ in 0..1000 {
        let start = random(whole.len());
        let mut bytes = whole.as_bytes()[start..(start + 1 + random(400)).min(whole.len())].to_vec();
        for _ in 0..random(4) {
            let at = random(bytes.len());
            match random(3) {
                0 => bytes[at] = b"[]{}=.,'\"\n\\#0-e\xff\0"[random(17)],
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, b"[]{}=.,'\"\n1a "[random(13)]),
            }
            bytes.push(b'\n');
        }
        fs::write(&path, &bytes).expect("written");
        for message in messages_of(&path, &[]) {
            let named = message.starts_with("scene.toml") || message.starts_with("warning: ");
            assert!(named, "{message}\nof\n{}", String::from_utf8_lossy(&bytes));
        }
    }
}
