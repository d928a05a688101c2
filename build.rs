//! Lets every program of this package find the Embree library without environment variables, and tells the crate how it is
//! built.
//!
//! The paths come from `embree4-sys`. An absolute rpath serves the binary, tests, benches and `cargo install`;
//! `$ORIGIN/../lib` and `$ORIGIN` come first for a copy that was packed together with its libraries.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-link-arg=-Wl,-rpath,$ORIGIN/../lib:$ORIGIN");
    // Empty where the dynamic loader knows the directory by itself.
    if let Some(dir) = env::var("DEP_EMBREE4_RPATH").ok().filter(|dir| !dir.is_empty()) {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{dir}");
    }
    let told = |name: &str| env::var(name).unwrap_or_default();
    println!("cargo::rustc-env=SPECULA_TARGET={}", told("TARGET"));
    println!("cargo::rustc-env=SPECULA_OPT_LEVEL={}", told("OPT_LEVEL"));
    // Cargo separates them so that they may hold blanks.
    println!("cargo::rustc-env=SPECULA_RUSTFLAGS={}", told("CARGO_ENCODED_RUSTFLAGS").replace('\x1f', " "));
    println!("cargo::rustc-env=SPECULA_RUSTC={}", compiler());
}

/// What the compiler says of itself.
fn compiler() -> String {
    let program = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(program).arg("--version").output();
    output.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned()).unwrap_or_default()
}
