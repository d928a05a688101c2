//! The machine and the build that figures belong to.

use crate::math::lanes::Level;
use std::fs;
use std::path::Path;

/// What is known of where the program runs, and how it was built. What the system does not tell is absent.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// The processor's name.
    pub processor: String,
    /// Threads that the program may use at a time.
    pub processors: usize,
    /// Cores behind them.
    pub cores: Option<usize>,
    /// Clock at this moment, MHz.
    pub mhz: Option<f64>,
    /// The highest clock, MHz.
    pub max_mhz: Option<f64>,
    /// Sizes of the caches of a core as the system writes them: `L2 2048K`.
    pub caches: Vec<String>,
    /// Programs that wanted to run, averaged over the minute before.
    pub load: Option<f64>,
    /// Bytes of memory.
    pub memory: Option<u64>,
    /// Operating system and architecture.
    pub system: String,
    /// The instruction set that our own kernels use.
    pub isa: &'static str,
    /// How the program was built.
    pub build: Build,
}

/// How the program was built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Build {
    /// Version of Specula.
    pub version: &'static str,
    /// The commit that was named when it was built, by the variable `SPECULA_COMMIT`.
    pub commit: Option<&'static str>,
    /// The compiler.
    pub rustc: &'static str,
    /// What it was built for.
    pub target: &'static str,
    /// Level of optimisation.
    pub opt_level: &'static str,
    /// Flags beyond those of the package.
    pub rustflags: &'static str,
    /// Whether assertions for debugging are compiled in: figures are then worth nothing.
    pub debug_assertions: bool,
}

impl Build {
    /// Of this program.
    pub const THIS: Self = Self {
        version: env!("CARGO_PKG_VERSION"),
        commit: option_env!("SPECULA_COMMIT"),
        rustc: env!("SPECULA_RUSTC"),
        target: env!("SPECULA_TARGET"),
        opt_level: env!("SPECULA_OPT_LEVEL"),
        rustflags: env!("SPECULA_RUSTFLAGS"),
        debug_assertions: cfg!(debug_assertions),
    };
}

impl Machine {
    /// This one, now.
    #[must_use]
    pub fn here() -> Self {
        let info = read("/proc/cpuinfo");
        let level = Level::from_env().unwrap_or_else(|_| Level::best());
        Self {
            processor: field(&info, "model name").unwrap_or(std::env::consts::ARCH).to_owned(),
            processors: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            cores: cores(&info),
            mhz: field(&info, "cpu MHz").and_then(|text| text.parse().ok()),
            max_mhz: read("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq")
                .trim()
                .parse()
                .ok()
                .map(|khz: f64| khz * 1e-3),
            caches: caches(),
            load: load(),
            memory: bytes(&read("/proc/meminfo"), "MemTotal"),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            isa: level.name(),
            build: Build::THIS,
        }
    }

    /// The processor's name and number, on one line.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{} x {}", self.processor, self.processors)
    }
}

/// Programs that want to run, averaged over the last minute.
#[must_use]
pub fn load() -> Option<f64> {
    read("/proc/loadavg").split_whitespace().next()?.parse().ok()
}

/// A file of the system; empty where there is none.
fn read(path: &str) -> String {
    fs::read_to_string(path).unwrap_or_default()
}

/// The value of the first line `name : value`.
fn field<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    text.lines().find_map(|line| line.strip_prefix(name)?.trim_start().strip_prefix(':')).map(str::trim)
}

/// Different pairs of socket and core.
fn cores(info: &str) -> Option<usize> {
    let mut pairs: Vec<_> = info
        .split("\n\n")
        .filter_map(|block| Some((field(block, "physical id")?, field(block, "core id")?)))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    (!pairs.is_empty()).then_some(pairs.len())
}

/// The bytes of a line `name : number kB`, as Linux tells memory.
pub(crate) fn bytes(text: &str, name: &str) -> Option<u64> {
    let kibibytes: u64 = field(text, name)?.strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

fn caches() -> Vec<String> {
    let of = |index: u32| {
        let folder = Path::new("/sys/devices/system/cpu/cpu0/cache").join(format!("index{index}"));
        let word = |name: &str| Some(fs::read_to_string(folder.join(name)).ok()?.trim().to_owned());
        let kind = match word("type")?.as_str() {
            "Instruction" => "i",
            "Data" => "d",
            _ => "",
        };
        Some(format!("L{}{kind} {}", word("level")?, word("size")?))
    };
    (0..8).map_while(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_says_is_understood() {
        let info = "model name\t: Fast One\ncpu MHz\t\t: 2500.5\nphysical id\t: 0\ncore id\t\t: 0\n\n\
            model name\t: Fast One\nphysical id\t: 0\ncore id\t\t: 0\n\nphysical id\t: 0\ncore id\t\t: 1\n";
        assert_eq!(field(info, "model name"), Some("Fast One"), "name");
        assert_eq!(cores(info), Some(2), "three threads on two cores");
        assert_eq!(cores(""), None, "not told");
        let info = "MemFree:  1 kB\nMemTotal:       2 kB\n";
        assert_eq!(bytes(info, "MemTotal"), Some(2048), "memory");
        assert_eq!(bytes(info, "Mem"), None, "a beginning of a name");
    }

    #[test]
    fn this_machine_has_a_name_and_a_processor() {
        let here = Machine::here();
        assert!(!here.processor.is_empty() && here.processors > 0, "{here:?}");
        assert!(here.build.rustc.starts_with("rustc"), "{here:?}");
    }
}
