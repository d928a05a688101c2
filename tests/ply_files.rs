//! PLY files give the triangles and messages that they should, in digits and in bytes alike.

use glam::{Vec2, Vec3};
use specula::scene::description::Normals;
use specula::scene::load::{LoadedMesh, load_mesh};
use std::fs;
use std::path::Path;

/// Warnings or errors of a file of these bytes.
fn messages(bytes: &[u8]) -> Vec<String> {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.ply");
    fs::write(&path, bytes).expect("written");
    let folder = format!("{}/", dir.path().display());
    match load_mesh(&path, Normals::File) {
        Ok(loaded) => {
            loaded.warnings.iter().map(|problem| format!("warning: {problem}").replace(&folder, "")).collect()
        }
        Err(error) => error.to_string().lines().map(|line| line.replace(&folder, "")).collect(),
    }
}

fn load(bytes: &[u8]) -> LoadedMesh {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.PLY");
    fs::write(&path, bytes).expect("written");
    load_mesh(&path, Normals::File)
        .unwrap_or_else(|error| panic!("{error}\nof\n{}", String::from_utf8_lossy(bytes)))
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Order {
    Digits,
    Little,
    Big,
}

const ORDERS: [Order; 3] = [Order::Digits, Order::Little, Order::Big];

/// Numbers of types, written one after the other.
struct Writer {
    order: Order,
    bytes: Vec<u8>,
}

impl Writer {
    fn new(order: Order, elements: &str) -> Self {
        let format = match order {
            Order::Digits => "ascii",
            Order::Little => "binary_little_endian",
            Order::Big => "binary_big_endian",
        };
        Self { order, bytes: format!("ply\nformat {format} 1.0\n{elements}end_header\n").into() }
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the numbers of tests fit")]
    fn number(&mut self, kind: &str, number: f64) {
        if self.order == Order::Digits {
            return self.bytes.extend(format!("{number} ").as_bytes());
        }
        let mut bytes = match kind {
            "char" | "int8" => (number as i8).to_be_bytes().to_vec(),
            "uchar" | "uint8" => (number as u8).to_be_bytes().to_vec(),
            "short" | "int16" => (number as i16).to_be_bytes().to_vec(),
            "ushort" | "uint16" => (number as u16).to_be_bytes().to_vec(),
            "int" | "int32" => (number as i32).to_be_bytes().to_vec(),
            "uint" | "uint32" => (number as u32).to_be_bytes().to_vec(),
            "int64" => (number as i64).to_be_bytes().to_vec(),
            "uint64" => (number as u64).to_be_bytes().to_vec(),
            "float" | "float32" => (number as f32).to_be_bytes().to_vec(),
            "double" | "float64" => number.to_be_bytes().to_vec(),
            _ => panic!("no type {kind}"),
        };
        if self.order == Order::Little {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
    }

    fn numbers(&mut self, kind: &str, numbers: &[f64]) {
        numbers.iter().for_each(|&number| self.number(kind, number));
    }

    fn list(&mut self, length: &str, kind: &str, numbers: &[f64]) {
        self.number(length, f64::from(u32::try_from(numbers.len()).expect("few")));
        self.numbers(kind, numbers);
    }

    fn end_entry(&mut self) {
        if self.order == Order::Digits {
            self.bytes.push(b'\n');
        }
    }
}

const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];

/// A square of one polygon, with everything that files have besides.
fn square(order: Order, real: &str, length: &str, index: &str) -> Vec<u8> {
    let mut writer = Writer::new(
        order,
        &format!(
            "comment made by hand\nobj_info none\nelement camera 1\nproperty {real} view\n\
             property list {length} {index} frames\nelement nothing 7\nelement vertex 4\nproperty uchar red\n\
             property {real} x\nproperty {real} y\nproperty {real} z\nproperty list uchar char tags\n\
             property {real} s\nproperty {real} t\nproperty {real} nx\nproperty {real} ny\nproperty {real} nz\n\
             element face 1\nproperty int flags\nproperty list {length} {index} vertex_index\nelement edge 1\n\
             property int vertex1\nproperty int vertex2\n"
        ),
    );
    writer.number(real, 0.5);
    writer.list(length, index, &[1.0, 2.0]);
    writer.end_entry();
    for (i, p) in SQUARE.iter().enumerate() {
        writer.number("uchar", 255.0);
        writer.numbers(real, p);
        writer.list("uchar", "char", &[-1.0, 1.0][..i % 3]);
        writer.numbers(real, &[p[0] * 0.5, p[1] * 0.5, 0.0, 0.0, 1.0]);
        writer.end_entry();
    }
    writer.number("int", -7.0);
    writer.list(length, index, &[0.0, 1.0, 2.0, 3.0]);
    writer.end_entry();
    writer.numbers("int", &[0.0, 1.0]);
    writer.bytes
}

#[test]
fn all_types_and_orders_give_the_same_mesh() {
    let reals = ["float", "float32", "double", "float64", "short", "int16"];
    let wholes = [
        "char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16", "int", "int32", "uint",
        "uint32", "int64", "uint64", "float", "double",
    ];
    for order in ORDERS {
        for real in reals {
            // Half a metre is no whole number, but the square has whole corners.
            for length in wholes {
                for index in wholes {
                    let name = format!("{order:?}, {real}, list {length} {index}");
                    let LoadedMesh { mesh, materials, warnings, .. } =
                        load(&square(order, real, length, index));
                    assert!(warnings.is_empty() && materials.is_empty(), "{name}: {warnings:?}");
                    assert_eq!(mesh.triangles().as_ref(), [[0, 1, 2], [0, 2, 3]], "{name}: triangles");
                    let corner = Vec3::new(2.0, 2.0, 0.0);
                    assert_eq!(mesh.positions()[2], corner, "{name}: position");
                    assert_eq!(mesh.corner_normals(1), Some([Vec3::Z; 3]), "{name}: normals");
                    let uvs = Some([Vec2::ZERO, Vec2::ONE, Vec2::Y]);
                    assert_eq!(mesh.corner_uvs(1), uvs, "{name}: uv");
                }
            }
        }
    }
}

#[test]
fn strips_turn_by_turns_and_start_anew() {
    for order in ORDERS {
        let mut writer = Writer::new(
            order,
            "element tristrips 2\nproperty list int int vertex_indices\nelement vertex 6\nproperty float x\n\
             property float y\nproperty float z\n",
        );
        writer.list("int", "int", &[0.0, 1.0, 2.0, 3.0, -1.0, 3.0, 2.0, 5.0, 5.0, 4.0, -1.0, 1.0]);
        writer.end_entry();
        writer.list("int", "int", &[4.0, 3.0, 5.0]);
        writer.end_entry();
        for i in 0..6 {
            writer.numbers("float", &[f64::from(i % 2), f64::from(i / 2), f64::from(i * i)]);
            writer.end_entry();
        }
        let LoadedMesh { mesh, warnings, .. } = load(&writer.bytes);
        let expected = [[0, 1, 2], [2, 1, 3], [3, 2, 5], [4, 3, 5]];
        assert_eq!(mesh.triangles().as_ref(), expected, "{order:?}: stitches make no triangles");
        assert!(warnings.is_empty(), "{order:?}: {warnings:?}");
    }
}

#[test]
fn names_of_surface_parameters() {
    for [u, v] in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]] {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property float {u}\nproperty float {v}\nelement face 1\nproperty list uchar int vertex_indices\n\
             end_header\n0 0 0 0.5 1\n1 0 0 0 1\n0 1 0 1 1\n3 0 1 2\n"
        );
        let uvs = load(text.as_bytes()).mesh.corner_uvs(0);
        assert_eq!(uvs, Some([Vec2::new(0.5, 1.0), Vec2::Y, Vec2::ONE]), "{u} {v}");
    }
}

const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                      element face 1\nproperty list uchar int vertex_indices\nend_header\n";

#[test]
fn headers_and_bodies_in_odd_shapes_are_read() {
    let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
    let whole = format!("{HEADER}{body}");
    for (name, text) in [
        ("no end of line at the end", whole.clone()),
        ("lines of Windows", whole.replace('\n', "\r\n")),
        ("lines of the old Macintosh", whole.replace('\n', "\r")),
        ("empty lines and spaces", whole.replace('\n', " \t\n\n  ")),
        ("a byte order mark", format!("\u{feff}{whole}")),
        ("an empty line first", format!("\n{whole}")),
        ("entries over several lines", whole.replace("1 0 0", "1\n0\n0")),
        ("numbers in other forms", whole.replace("1 0 0", "+1.e0 -0 .0E+5")),
        ("lengths with a point", whole.replace("3 0 1 2", "3.0 0 1 2.0")),
    ] {
        let LoadedMesh { mesh, warnings, .. } = load(text.as_bytes());
        assert_eq!(mesh.corners(0), [Vec3::ZERO, Vec3::X, Vec3::Y], "{name}");
        assert!(warnings.is_empty(), "{name}: {warnings:?}");
    }
}

/// Data may start with the bytes of line ends.
#[test]
fn data_in_bytes_starts_right_after_its_header() {
    for end in ["\n", "\r\n", "\r"] {
        let mut writer = Writer::new(
            Order::Little,
            "element vertex 3\nproperty uchar x\nproperty uchar y\nproperty uchar z\nelement face 1\n\
             property list uchar uchar vertex_indices\n",
        );
        writer.bytes = String::from_utf8(writer.bytes).expect("text").replace('\n', end).into();
        writer.bytes.extend([10, 13, 10, 13, 10, 10, 32, 10, 13, 3, 0, 1, 2]);
        let mesh = load(&writer.bytes).mesh;
        assert_eq!(mesh.positions()[0], Vec3::new(10.0, 13.0, 10.0), "{end:?}");
        assert_eq!(mesh.positions()[2], Vec3::new(32.0, 10.0, 13.0), "{end:?}");
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table")]
fn faults_of_headers_name_their_lines() {
    let ply = "this is no PLY file; its first line must be `ply`";
    let properties = "property float x\nproperty float y\nproperty float z\n";
    let of = |header: &str| messages(format!("ply\nformat ascii 1.0\n{header}").as_bytes());
    let cases = [
        (messages(b""), format!("a.ply:1: {ply}")),
        (messages(b"\n\nplyx\n"), format!("a.ply:3: {ply}")),
        (messages(b"ply\n"), "a.ply:1: the file ends in its header; end the header by `end_header`".into()),
        (messages(b"ply\nend_header\n"), "a.ply:2: the header names no format; write `format ascii 1.0`".into()),
        (
            messages(b"ply\nformat binary 1.0\nend_header\n"),
            "a.ply:2: unknown format `binary`; it must be `ascii`, `binary_little_endian` or `binary_big_endian`"
                .into(),
        ),
        (of("element vertex\n"), "a.ply:3: this declares no element; write `element NAME COUNT`".into()),
        (
            of("element vertex -1\n"),
            "a.ply:3: `-1` is no number of entries; give a whole number from 0".into(),
        ),
        (
            of("element vertex 1\nelement vertex 1\n"),
            "a.ply:4: element `vertex` is declared already in line 3; remove one of them".into(),
        ),
        (
            of("property float x\n"),
            "a.ply:3: property `x` belongs to no element; declare an element first".into(),
        ),
        (
            of("element vertex 1\nproperty real x\n"),
            "a.ply:4: unknown type `real`; known are char, uchar, short, ushort, int, uint, float, double, and int8 \
             to float64"
                .into(),
        ),
        (
            of("element vertex 1\nproperty list int x\nproperty x\n"),
            "a.ply:4: this declares no property; write `property TYPE NAME` or `property list TYPE TYPE NAME`".into(),
        ),
        (
            of("element vertex 1\nproperty int x\nproperty int x\n"),
            "a.ply:5: element `vertex` has a property `x` already; remove one of them".into(),
        ),
        (
            of("element vertex 1\nproprety int x\n"),
            "a.ply:4: `proprety int x` has no meaning in a PLY header; write `format`, `comment`, `obj_info`, \
             `element`, `property` or `end_header`"
                .into(),
        ),
        (
            of("element vertex 1\nproperty int x\nproperty int y\nend_header\n1 1\n"),
            "a.ply:3: element `vertex` has no position; give it the properties x, y and z".into(),
        ),
        (
            of(&format!("element vertex 0\n{properties}element face 1\nproperty int vertex_indices\nend_header\n1\n")),
            "a.ply:7: element `face` has no list of corners; give it the property `list uchar int vertex_indices`"
                .into(),
        ),
        (
            of(&format!("element vertex 1\n{properties}end_header\n1 1 1\n")),
            "a.ply:3: there is no triangle in this file, only vertices, 1 in all; name a file with faces".into(),
        ),
    ];
    for (found, expected) in cases {
        assert_eq!(found, [expected], "the one message");
    }
}

#[test]
fn faults_of_data_in_digits_name_their_lines() {
    let of = |body: &str| messages(format!("{HEADER}{body}").as_bytes());
    let copy = "get a complete copy of the file";
    let cases = [
        ("0 0 0\n1 0 x\n0 1 0\n3 0 1 2", "a.ply:11: vertex 1: `x` is not a number; give a number like -1.5e3".into()),
        (
            "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2",
            "a.ply:11: vertex 1: NaN is not finite in single precision; give a finite coordinate".into(),
        ),
        (
            "0 0 0\n1 0 0\n0 -1e39 0\n3 0 1 2",
            "a.ply:12: vertex 2: -1e39 is not finite in single precision; give a finite coordinate".into(),
        ),
        (
            "0 0 0\n1 0 0\n0 2e18 0\n3 0 1 2",
            "a.ply:12: vertex 2: coordinate 2e18 is farther than 1e18 from zero; scale the model down".into(),
        ),
        (
            "0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2",
            "a.ply:10: vertex 0: `9` follows what the header says of a vertex; give each entry a line of its own, \
             with one number for each property"
                .into(),
        ),
        (
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 3",
            "a.ply:13: face 0: index 3 names no vertex, there are 3; indices count from 0".into(),
        ),
        (
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1",
            "a.ply:13: face 0: index -1 names no vertex, there are 3; indices count from 0".into(),
        ),
        (
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5",
            "a.ply:13: face 0: index 1.5 names no vertex, there are 3; indices count from 0".into(),
        ),
        (
            "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2",
            "a.ply:13: face 0: -3 is no length of a list; give a whole number from 0".into(),
        ),
        (
            "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2",
            format!("a.ply:13: face 0: a list of 4000000000 numbers is begun, but the file holds 3 more at most; {copy}"),
        ),
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1", format!("a.ply:13: face 0: a list of 3 numbers is begun, but the file holds 2 more at most; {copy}")),
        ("0 0 0\n1 0 0\n0", format!("a.ply:12: vertex 2: the file ends here; {copy}")),
        ("", format!("a.ply:10: vertex 0: the file ends here; {copy}")),
    ];
    for (body, expected) in cases {
        assert_eq!(of(body), [expected], "{body}");
    }
}

#[test]
fn faults_of_data_in_bytes_name_entry_and_byte() {
    let header = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                  property list uint int vertex_indices\nelement more 2\nproperty int a\n";
    let whole = |position: f64, length: f64, index: f64| {
        let mut writer = Writer::new(Order::Big, header);
        let start = writer.bytes.len();
        writer.numbers("float", &[0.0, 0.0, 0.0, position, 0.0, 0.0, 0.0, 1.0, 0.0]);
        writer.number("uint", length);
        writer.numbers("int", &[0.0, 1.0, index, 1.0, 2.0]);
        (writer.bytes, start)
    };
    let (good, start) = whole(1.0, 3.0, 2.0);
    assert_eq!(messages(&good), Vec::<String>::new(), "good");
    let copy = "get a complete copy of the file";
    let cases = [
        (
            whole(f64::INFINITY, 3.0, 2.0).0,
            format!(
                "vertex 1, at byte {}: inf is not finite in single precision; give a finite coordinate",
                start + 12
            ),
        ),
        (
            whole(-1e20, 3.0, 2.0).0,
            format!(
                "vertex 1, at byte {}: coordinate -1e20 is farther than 1e18 from zero; scale the model down",
                start + 12
            ),
        ),
        (
            whole(1.0, 4_294_967_295.0, 2.0).0,
            format!(
                "face 0, at byte {}: a list of 4294967295 numbers is begun, but the file holds 5 more at most; {copy}",
                start + 36
            ),
        ),
        (
            whole(1.0, 3.0, 7.0).0,
            format!(
                "face 0, at byte {}: index 7 names no vertex, there are 3; indices count from 0",
                start + 48
            ),
        ),
        (
            good[..start + 18].to_vec(),
            format!("vertex 1, at byte {}: the file ends here; {copy}", start + 16),
        ),
        (
            good[..good.len() - 3].to_vec(),
            format!("more 1, at byte {}: the file ends here; {copy}", good.len() - 3),
        ),
    ];
    for (bytes, expected) in cases {
        assert_eq!(messages(&bytes), [format!("a.ply: {expected}")], "the one message");
    }
}

/// Counts that lie must not cost the memory they promise.
#[test]
fn lying_counts_are_found_out() {
    for order in ORDERS {
        let mut writer = Writer::new(
            order,
            "element vertex 18446744073709551615\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1999999999\nproperty list uchar int vertex_indices\n",
        );
        for _ in 0..2 {
            writer.numbers("float", &[0.0; 3]);
            writer.end_entry();
        }
        let found = messages(&writer.bytes);
        assert!(found.len() == 1 && found[0].contains("the file ends here"), "{order:?}: {found:?}");
        let mut writer = Writer::new(order, "element odd 18446744073709551615\nproperty double a\n");
        writer.number("double", 1.0);
        let found = messages(&writer.bytes);
        assert!(found.len() == 1 && found[0].contains("odd 1"), "{order:?}: {found:?}");
    }
}

#[test]
fn what_is_left_out_is_told() {
    let text = "ply\nformat ascii 1.0\nCreated by hand\nelement vertex 4\nproperty float x\nproperty float y\n\
                property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 4\n\
                property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
                0 0 0 0 0 1\n1 0 0 0 nan 1\n0 1 0 0 0 1\n1 1 0 0 0 1\n3 0 1 2 6 0 0 1 0 0 1\n2 0 1 0\n0 0\n\
                4 0 0 1 1 0\nmore\n";
    let expected = [
        "warning: a.ply:3: `Created by hand` has no meaning in a PLY header and is ignored",
        "warning: a.ply:11: surface parameters of corners (`texcoord`) are ignored; give them to the vertices",
        "warning: a.ply: faces with fewer than three corners are ignored, 2 in all",
        "warning: a.ply: normals that are not finite are ignored, 1 in all",
        "warning: a.ply: bytes after the last element are ignored, 4 in all",
        "warning: a.ply: triangles without area are left out, 2 in all",
    ];
    assert_eq!(messages(text.as_bytes()), expected, "warnings");
    let mesh = load(text.as_bytes()).mesh;
    assert_eq!(mesh.corner_normals(0), Some([Vec3::Z, Vec3::ZERO, Vec3::Z]), "zero falls back");
}

#[test]
fn other_names_are_no_meshes() {
    let found = load_mesh(Path::new("a.stl"), Normals::File).map_err(|error| error.to_string());
    let expected = "a.stl: this is no mesh of a known format; its name must end in .obj or .ply";
    assert_eq!(found, Err(expected.into()), "by extension");
}
