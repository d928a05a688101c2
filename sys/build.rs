//! Finds Embree 4, generates the bindings from its own headers, and passes its paths on.
//!
//! Looked for in this order: `EMBREE_DIR`, what `sys/setup.sh` fetched (`sys/.embree`), pkg-config, `/usr`,
//! `/usr/local`. Whatever goes wrong ends in one sentence that names the remedy.
//!
//! Dependents receive, as `links` metadata, `DEP_EMBREE4_INCLUDE`, `DEP_EMBREE4_LIBDIR`, `DEP_EMBREE4_VERSION` (of the
//! headers) and `DEP_EMBREE4_RPATH` (empty if the dynamic loader knows the directory by itself). Link arguments of
//! a build script do not reach dependents: a program must set the rpath in its own build script.

use std::env;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

const REMEDY: &str =
    "run sys/setup.sh, or set EMBREE_DIR to an installation of Embree 4 and LIBCLANG_PATH to libclang";

/// Where Embree is: the directories that hold `embree4/rtcore.h` and `libembree4.so`.
struct Embree {
    include: PathBuf,
    lib: PathBuf,
    version: String,
}

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=EMBREE_DIR");
    // Cargo would rerun this at every build for the sake of a path that does not exist.
    let built = build();
    if built.is_err() || Path::new(".embree").exists() {
        println!("cargo::rerun-if-changed=.embree");
    }
    if let Err(error) = built {
        println!("cargo::error={error}; {REMEDY}");
    }
}

fn build() -> Result<(), Box<dyn Error>> {
    let embree = find()?;
    println!("cargo::rerun-if-changed={}", embree.include.join("embree4").display());
    bind(&embree.include)?;

    let libdir = embree.lib.display();
    println!("cargo::rustc-link-search=native={libdir}");
    println!("cargo::rustc-link-lib=dylib=embree4");
    let rpath = if known_to_loader(&embree.lib) { String::new() } else { libdir.to_string() };
    if !rpath.is_empty() {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{rpath}");
    }
    println!("cargo::metadata=include={}", embree.include.display());
    println!("cargo::metadata=libdir={libdir}");
    println!("cargo::metadata=rpath={rpath}");
    println!("cargo::metadata=version={}", embree.version);
    println!("cargo::rustc-env=EMBREE4_SYS_INCLUDE={}", embree.include.display());
    Ok(())
}

fn find() -> Result<Embree, Box<dyn Error>> {
    if let Some(dir) = env::var_os("EMBREE_DIR").filter(|dir| !dir.is_empty()) {
        let dir = PathBuf::from(dir);
        return in_prefix(&dir)
            .unwrap_or_else(|| Err(format!("EMBREE_DIR={} holds no Embree 4", dir.display()).into()));
    }
    let fetched = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join(".embree");
    let places = [fetched, PathBuf::from("/usr"), PathBuf::from("/usr/local")];
    if let Some(found) = in_prefix(&places[0]) {
        return found;
    }
    if let Some(found) = by_pkg_config() {
        return found;
    }
    let found = places[1..].iter().find_map(|place| in_prefix(place));
    found.unwrap_or_else(|| Err("Embree 4 is not on this machine".into()))
}

/// The installation under one prefix; `None` if nothing of Embree 4 is there, an error if it is of no use.
fn in_prefix(prefix: &Path) -> Option<Result<Embree, Box<dyn Error>>> {
    let include = prefix.join("include");
    if !include.join("embree4/rtcore.h").is_file() {
        return None;
    }
    let arch = env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    let lib = ["lib".to_owned(), "lib64".to_owned(), format!("lib/{arch}-linux-gnu")]
        .iter()
        .map(|lib| prefix.join(lib))
        .find(|lib| ["libembree4.so", "libembree4.dylib"].iter().any(|name| lib.join(name).exists()))?;
    Some(checked(include, lib))
}

/// Embree as pkg-config knows it, should someone's packaging describe it there.
fn by_pkg_config() -> Option<Result<Embree, Box<dyn Error>>> {
    let mut config = pkg_config::Config::new();
    let library = config.cargo_metadata(false).atleast_version("4").probe("embree4").ok()?;
    let include = library.include_paths.into_iter().find(|dir| dir.join("embree4/rtcore.h").is_file())?;
    let lib = library.link_paths.into_iter().find(|dir| dir.join("libembree4.so").exists())?;
    Some(checked(include, lib))
}

fn checked(include: PathBuf, lib: PathBuf) -> Result<Embree, Box<dyn Error>> {
    let config = include.join("embree4/rtcore_config.h");
    let text = fs::read_to_string(&config).map_err(|error| format!("{}: {error}", config.display()))?;
    let version = text
        .lines()
        .find_map(|line| line.strip_prefix("#define RTC_VERSION_STRING "))
        .map(|quoted| quoted.trim().trim_matches('"').to_owned())
        .ok_or_else(|| format!("{} tells no version", config.display()))?;
    // Before 4.3 a hit had no `instPrimID`; 5 is not known.
    let minor = version.strip_prefix("4.").and_then(|rest| rest.split('.').next()?.parse::<u32>().ok());
    if minor.is_none_or(|minor| minor < 3) {
        return Err(format!("Embree {version} in {} is not 4.3 or a later 4", include.display()).into());
    }
    Ok(Embree { include: include.canonicalize()?, lib: lib.canonicalize()?, version })
}

/// True for the distribution's own library directories, which need no rpath.
fn known_to_loader(lib: &Path) -> bool {
    lib.starts_with("/lib") || (lib.starts_with("/usr/lib") && !lib.starts_with("/usr/local"))
}

/// Writes `bindings.rs`: everything the headers declare under `rtc*` and `RTC*`.
fn bind(include: &Path) -> Result<(), Box<dyn Error>> {
    // bindgen panics where libclang is missing altogether; asking first gives a sentence instead.
    let asked = std::panic::catch_unwind(bindgen::clang_version);
    if asked.is_err() {
        return Err("libclang, which generates the bindings, is not on this machine".into());
    }
    let bindings = bindgen::Builder::default()
        .header(include.join("embree4/rtcore.h").to_string_lossy())
        .clang_arg(format!("-I{}", include.display()))
        .allowlist_function("rtc.*")
        .allowlist_type("RTC.*")
        .allowlist_var("RTC.*")
        .prepend_enum_name(false)
        .layout_tests(false)
        .generate_comments(false)
        .rust_edition(bindgen::RustEdition::Edition2024)
        .generate()
        .map_err(|error| format!("bindgen could not read {}: {error}", include.display()))?;
    let out = Path::new(&env::var("OUT_DIR")?).join("bindings.rs");
    bindings.write_to_file(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    Ok(())
}
