//! Mesh files with random damage give a mesh or messages, never a panic.

use specula::scene::description::Normals;
use specula::scene::load::load_mesh;
use std::fs;

const ELEMENTS: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float nz\n\
                        element face 1\nproperty list uchar int vertex_indices\nelement tristrips 1\n\
                        property list uchar int vertex_indices\nend_header\n";

/// A square as a polygon and half of it as a strip, in bytes.
fn plys(real: fn(f32) -> [u8; 4], whole: fn(i32) -> [u8; 4], order: &str) -> Vec<u8> {
    let mut bytes = format!("ply\nformat binary_{order}_endian 1.0\n{ELEMENTS}").into_bytes();
    for p in [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [1.0, 1.0, 0.0, 1.0]] {
        bytes.extend(p.into_iter().flat_map(real));
    }
    for list in [[0, 1, 3, 2], [0, 1, 2, -1]] {
        bytes.push(4);
        bytes.extend(list.into_iter().flat_map(whole));
    }
    bytes
}

/// Knuth's multiplicative generator (1997, The Art of Computer Programming 2, section 3.3.4).
fn random(state: &mut u64, below: usize) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    usize::try_from(*state >> 33).expect("31 bits") % below
}

/// A file with some bytes changed, or cut off.
fn damaged(bytes: &[u8], state: &mut u64) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if random(state, 3) == 0 {
        bytes.truncate(random(state, bytes.len()));
    }
    for _ in 0..random(state, 6) {
        if bytes.is_empty() {
            break;
        }
        let at = random(state, bytes.len());
        match random(state, 5) {
            0 => bytes[at] = b"0123456789-+.e/# \n\r\\fv\xff\0"[random(state, 24)],
            1 => bytes[at] = u8::try_from(random(state, 256)).expect("a byte"),
            2 => drop(bytes.remove(at)),
            3 => bytes.insert(at, b"0123456789-+.e/# \n\r\\\xff"[random(state, 21)]),
            // A piece once more.
            _ => {
                let piece = bytes[at..(at + random(state, 40)).min(bytes.len())].to_vec();
                let to = random(state, bytes.len());
                bytes.splice(to..to, piece);
            }
        }
    }
    bytes
}

/// Random damage gives a mesh or messages that name the file, never a panic.
#[test]
fn damage_never_panics() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let mtl = "newmtl red\nKd 1 0 0\nPr 0.5\nmap_Kd a.png\nnewmtl\nd 0.5\nillum 7\n";
    let obj = "mtllib a.mtl\nv 0 0 0 1\nv 1e0 0 0\nv 0 1 0\nv 1 .5 -0\nvt 0 0\nvt 1\nvn 0 0 1\nusemtl red\ng a b\n\
               s 1\nf 1/1/1 2/2/1 3//1\nusemtl blue\nf -1 -2 \\\n -3 -4 1\nf 1 2 3 4 2 1 3\nl 1 2\np 1\n# end\n";
    fs::write(dir.path().join("a.mtl"), mtl).expect("written");
    let wholes = [
        ("a.obj", obj.into()),
        ("a.ply", plys(f32::to_le_bytes, i32::to_le_bytes, "little")),
        ("a.ply", plys(f32::to_be_bytes, i32::to_be_bytes, "big")),
        (
            "a.ply",
            format!(
                "ply\nformat ascii 1.0\n{ELEMENTS}0 0 0 1\n1 0 0 1\n0 1 0 1\n1 1 0 1\n4 0 1 3 2\n4 0 1 2 -1\n"
            )
            .into(),
        ),
    ];
    let mut state = 1;
    let mut loaded = 0;
    for round in 0..5000 {
        let (name, whole) = &wholes[round % wholes.len()];
        let path = dir.path().join(name);
        let bytes = damaged(whole, &mut state);
        fs::write(&path, &bytes).expect("written");
        let normals = Normals::ALL[round / wholes.len() % 3];
        match load_mesh(&path, normals) {
            Ok(_) => loaded += 1,
            Err(error) => {
                let message = error.to_string();
                let named = message.lines().all(|line| line.starts_with(&path.display().to_string()));
                assert!(named, "{message}\nof\n{}", String::from_utf8_lossy(&bytes));
            }
        }
    }
    assert!(loaded > 500, "only {loaded} of 5000 were read");
    for round in 0..500 {
        fs::write(dir.path().join("a.obj"), obj).expect("written");
        fs::write(dir.path().join("a.mtl"), damaged(mtl.as_bytes(), &mut state)).expect("written");
        let found = load_mesh(&dir.path().join("a.obj"), Normals::File);
        assert!(found.is_ok(), "round {round}: damage to materials stopped it: {found:?}");
    }
}
