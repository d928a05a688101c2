//! Sizes, alignments and field offsets of the bindings against a C compiler's, from the same headers.
//!
//! Skipped with a line where no C compiler is.

#![expect(unsafe_code, reason = "one device is made and released")]

use embree4_sys::*;
use std::error::Error;
use std::fmt::Write as _;
use std::mem::{align_of, offset_of, size_of};
use std::path::PathBuf;
use std::process::Command;

/// Lists, for each structure, its size, alignment and field offsets: the C expression, and our value of it.
macro_rules! quantities {
    ($($type:ident { $($field:ident),* $(,)? })+) => {{
        let mut all: Vec<(String, usize)> = Vec::new();
        $(
            let name = stringify!($type);
            all.push((format!("sizeof(struct {name})"), size_of::<$type>()));
            all.push((format!("_Alignof(struct {name})"), align_of::<$type>()));
            $(all.push((format!("offsetof(struct {name}, {})", stringify!($field)), offset_of!($type, $field)));)*
        )+
        all
    }};
}

#[rustfmt::skip]
fn quantities() -> Vec<(String, usize)> {
    quantities! {
        RTCRay { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags }
        RTCRay4 { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags }
        RTCRay8 { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags }
        RTCRay16 { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags }
        RTCHit { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID, instPrimID }
        RTCHit4 { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID, instPrimID }
        RTCHit8 { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID, instPrimID }
        RTCHit16 { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID, instPrimID }
        RTCRayHit { ray, hit }
        RTCRayHit4 { ray, hit }
        RTCRayHit8 { ray, hit }
        RTCRayHit16 { ray, hit }
        RTCBounds { lower_x, lower_y, lower_z, upper_x, upper_y, upper_z }
        RTCRayQueryContext { instID, instPrimID }
        RTCIntersectArguments { flags, feature_mask, context, filter, intersect }
        RTCOccludedArguments { flags, feature_mask, context, filter, occluded }
        RTCFilterFunctionNArguments { valid, geometryUserPtr, context, ray, hit, N }
        RTCBoundsFunctionArguments { geometryUserPtr, primID, timeStep, bounds_o }
        RTCIntersectFunctionNArguments { valid, geometryUserPtr, primID, context, rayhit, N, geomID }
        RTCOccludedFunctionNArguments { valid, geometryUserPtr, primID, context, ray, N, geomID }
        RTCQuaternionDecomposition { scale_x, skew_xy, shift_x, quaternion_r, translation_x }
    }
}

/// The same quantities and the inline initialisers' values as a C program that prints one number a line.
fn program(expressions: &[(String, usize)]) -> String {
    let mut source = String::from(
        "#include <embree4/rtcore.h>\n#include <stddef.h>\n#include <stdio.h>\nint main(void) {\n\
         struct RTCIntersectArguments i; struct RTCOccludedArguments o; struct RTCRayQueryContext c;\n\
         rtcInitIntersectArguments(&i); rtcInitOccludedArguments(&o); rtcInitRayQueryContext(&c);\n",
    );
    for (expression, _) in expressions {
        let _ = writeln!(source, "printf(\"%zu\\n\", (size_t)({expression}));");
    }
    source + "return 0; }\n"
}

#[test]
fn layouts_are_those_of_a_c_compiler() -> Result<(), Box<dyn Error>> {
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    if Command::new(&compiler).arg("--version").output().is_err() {
        println!("skipped: no C compiler `{compiler}` here");
        return Ok(());
    }
    let (intersect, occluded) = (rtcInitIntersectArguments(), rtcInitOccludedArguments());
    let context = rtcInitRayQueryContext();
    let mut expected = quantities();
    expected.extend([
        ("(unsigned)i.flags".to_owned(), usize::try_from(intersect.flags)?),
        ("(unsigned)i.feature_mask".to_owned(), usize::try_from(intersect.feature_mask)?),
        ("(unsigned)o.flags".to_owned(), usize::try_from(occluded.flags)?),
        ("(unsigned)o.feature_mask".to_owned(), usize::try_from(occluded.feature_mask)?),
        ("!i.context && !i.filter && !i.intersect && !o.context && !o.filter && !o.occluded".to_owned(), 1),
        ("c.instID[0]".to_owned(), usize::try_from(context.instID[0])?),
        ("c.instPrimID[0]".to_owned(), usize::try_from(context.instPrimID[0])?),
        ("RTC_INVALID_GEOMETRY_ID".to_owned(), usize::try_from(RTC_INVALID_GEOMETRY_ID)?),
    ]);

    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (source, binary) = (dir.join("layout.c"), dir.join("layout"));
    std::fs::write(&source, program(&expected))?;
    let compiled = Command::new(&compiler)
        .arg(concat!("-I", env!("EMBREE4_SYS_INCLUDE")))
        .args(["-std=c11", "-Wno-attributes", "-o"])
        .args([&binary, &source])
        .output()?;
    assert!(compiled.status.success(), "{compiler}: {}", String::from_utf8_lossy(&compiled.stderr));

    let output = String::from_utf8(Command::new(&binary).output()?.stdout)?;
    assert_eq!(output.lines().count(), expected.len(), "the C program printed {output}");
    for (line, (expression, ours)) in output.lines().zip(&expected) {
        assert_eq!(line.parse::<usize>()?, *ours, "{expression}");
    }
    println!("{} quantities agree with {compiler}", expected.len());
    Ok(())
}

#[test]
fn the_library_linked_is_of_the_headers_major_version() {
    // SAFETY: a null configuration is documented to mean the defaults.
    let device = unsafe { rtcNewDevice(std::ptr::null()) };
    assert!(!device.is_null(), "no device");
    // SAFETY: the device was created above and is not released yet.
    let version = unsafe { rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR) };
    // SAFETY: as above; this gives back the only reference.
    unsafe { rtcReleaseDevice(device) };
    assert_eq!(version, 4, "version of the library");
}
