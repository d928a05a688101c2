//! Lets every program of this package find the Embree library without environment variables.
//!
//! The paths come from `embree4-sys`. An absolute rpath serves the binary, tests, benches and `cargo install`;
//! `$ORIGIN/../lib` and `$ORIGIN` come first for a copy that was packed together with its libraries.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-link-arg=-Wl,-rpath,$ORIGIN/../lib:$ORIGIN");
    // Empty where the dynamic loader knows the directory by itself.
    if let Some(dir) = std::env::var("DEP_EMBREE4_RPATH").ok().filter(|dir| !dir.is_empty()) {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{dir}");
    }
}
