//! The two-pass filter: what a megapixel costs, and what it gets for it beside rays within lobes and trembling normals.
//!
//! `cargo bench --bench fuzzy -- speed [radius]` prints CPU seconds for a megapixel by radius and by what is done to be quick, with the error that
//! each adds, and by the clock what threads and lanes gain; `-- scenes [part of a name [rays]]` prints errors and times of the contenders in each scene, and
//! draws them in `record/fuzzy.svg` if it is all scenes (`fuzzy` is a part of every name). References, of 4096 rays a pixel if nothing else is said, are kept in
//! `target/fuzzy`; `-- references` with the same words makes them beforehand.

#![expect(clippy::print_stdout, reason = "a bench prints its results")]

#[path = "../../tests/support/first_passes.rs"]
#[expect(dead_code, reason = "the tests use the rest")]
mod first_passes;
#[path = "../support/loglog.rs"]
mod loglog;
#[path = "../support/pictures.rs"]
mod pictures;

#[path = "../../tests/support/masks.rs"]
mod masks;
mod scenes;
mod speed;
mod versus;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    // Under `cargo test` it only shows that it runs.
    let is_bench = words.iter().any(|word| word == "--bench");
    let mut names = words.iter().filter(|word| !word.starts_with("--"));
    let (what, part) = (names.next().map(String::as_str), names.next().map_or("", String::as_str));
    if what.is_none_or(|what| what == "speed") {
        speed::table(is_bench, part);
    }
    let rays = names.next().and_then(|word| word.parse().ok()).unwrap_or(scenes::REFERENCE);
    if is_bench && what == Some("references") {
        scenes::references(rays, part)?;
    }
    if what.is_none_or(|what| what == "scenes") {
        scenes::tables(if is_bench { Some(rays) } else { None }, part)?;
    }
    Ok(())
}
