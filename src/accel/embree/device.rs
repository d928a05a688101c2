//! The device: configuration, errors, memory in use, and what the library can do.

use super::error::{EmbreeError, ErrorLog};
use crate::math::lanes::VARIABLE;
use embree4_sys as sys;
use std::ffi::{CString, c_void};
use std::fmt;
use std::num::NonZeroU32;
use std::ptr::NonNull;
use std::sync::Arc;
use std::sync::atomic::{AtomicIsize, Ordering};

/// Instruction sets that Embree has kernels for, weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Isa {
    /// SSE2.
    Sse2,
    /// SSE4.2.
    Sse42,
    /// AVX.
    Avx,
    /// AVX2.
    Avx2,
    /// AVX-512 as in server processors since 2017.
    Avx512,
}

impl Isa {
    /// The strongest this processor has; `None` on another architecture.
    #[must_use]
    pub fn of_processor() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        {
            let found = [
                (Self::Avx512, is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512vl")),
                (Self::Avx2, is_x86_feature_detected!("avx2")),
                (Self::Avx, is_x86_feature_detected!("avx")),
                (Self::Sse42, is_x86_feature_detected!("sse4.2")),
            ];
            Some(found.into_iter().find(|(_, has)| *has).map_or(Self::Sse2, |(isa, _)| isa))
        }
        #[cfg(not(target_arch = "x86_64"))]
        None
    }

    /// What the environment holds Embree to, so that a machine can stand for a weaker one: AVX2 where [`VARIABLE`] asks for `avx2`,
    /// SSE4.2 where it asks for `portable`.
    #[must_use]
    pub fn from_env() -> Option<Self> {
        Self::beside(&std::env::var(VARIABLE).ok()?)
    }

    /// What goes with our own kernels of that name.
    fn beside(level: &str) -> Option<Self> {
        match level {
            "avx2" => Some(Self::Avx2),
            "portable" => Some(Self::Sse42),
            _ => None,
        }
    }

    /// The name in Embree's configuration.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sse2 => "sse2",
            Self::Sse42 => "sse4.2",
            Self::Avx => "avx",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

/// What a device may use. The default is all of the machine.
///
/// Configuration files that Embree would read from the program's and the user's folders are ignored: a picture must
/// not depend on them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Config {
    /// Threads that build hierarchies; all processors if absent. Queries run on their callers' threads.
    pub threads: Option<NonZeroU32>,
    /// The strongest instruction set to use; the processor's if absent.
    pub max_isa: Option<Isa>,
    /// Whether to ask for huge pages; left to Embree if absent.
    pub huge_pages: Option<bool>,
}

impl Config {
    /// All of the machine that the environment allows (see [`Isa::from_env`]).
    #[must_use]
    pub fn from_env() -> Self {
        Self { max_isa: Isa::from_env(), ..Self::default() }
    }
}

impl fmt::Display for Config {
    /// Embree's configuration string.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ignore_config_files=1")?;
        if let Some(threads) = self.threads {
            write!(f, ",threads={threads}")?;
        }
        if let Some(isa) = self.max_isa {
            write!(f, ",max_isa={}", isa.name())?;
        }
        if let Some(huge) = self.huge_pages {
            write!(f, ",hugepages={}", u8::from(huge))?;
        }
        Ok(())
    }
}

/// A handle to Embree, from which scenes and geometries are made; cheap to clone.
#[derive(Clone, Debug)]
pub struct Device(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    raw: NonNull<sys::RTCDeviceTy>,
    config: Config,
    /// The library keeps pointers to this and to `bytes`: both stay where the `Arc` put them.
    errors: ErrorLog,
    bytes: AtomicIsize,
}

// SAFETY: a device is only read after its construction but for the making of objects, and that may happen on several
// threads: "A thread reaching a not-yet-constructed sub-scene of a two-level scene can generate the sub-scene
// geometry and call rtcJoinCommitScene", "it is possible to commit many small scenes in parallel" (manual,
// rtcJoinCommitScene). Nothing in it belongs to the thread that made it.
unsafe impl Send for Inner {}
// SAFETY: as above; errors and byte count are synchronised by themselves.
unsafe impl Sync for Inner {}

impl Drop for Inner {
    fn drop(&mut self) {
        // SAFETY: the handle holds one reference of its own, given up here; objects hold theirs ("All objects created
        // from the device hold a reference to the device"), and ours are dropped before their `Device`.
        unsafe { sys::rtcReleaseDevice(self.raw.as_ptr()) };
    }
}

impl Device {
    /// A new device. Fails if the processor lacks what the library was built for.
    pub fn new(config: Config) -> Result<Self, EmbreeError> {
        let text = CString::new(config.to_string()).expect("a configuration has no zero byte");
        // SAFETY: the string is zero-terminated and is read during the call only.
        let raw = unsafe { sys::rtcNewDevice(text.as_ptr()) };
        let raw = NonNull::new(raw).ok_or_else(EmbreeError::of_device_creation)?;
        let inner = Arc::new(Inner { raw, config, errors: ErrorLog::default(), bytes: AtomicIsize::new(0) });
        let errors = (&raw const inner.errors).cast_mut().cast::<c_void>();
        // SAFETY: `record` gets the log it expects, which lives in the `Arc` until after the device is released.
        unsafe { sys::rtcSetDeviceErrorFunction(raw.as_ptr(), Some(ErrorLog::record), errors) };
        let bytes = (&raw const inner.bytes).cast_mut().cast::<c_void>();
        // SAFETY: `count_bytes` gets the counter it expects, which lives as long as the log.
        unsafe { sys::rtcSetDeviceMemoryMonitorFunction(raw.as_ptr(), Some(count_bytes), bytes) };
        let device = Self(inner);
        device.check()?;
        Ok(device)
    }

    /// The configuration it was made with.
    #[must_use]
    pub fn config(&self) -> Config {
        self.0.config
    }

    /// Bytes that Embree holds for this device's hierarchies and buffers; arrays shared with it do not count.
    #[must_use]
    pub fn bytes(&self) -> usize {
        usize::try_from(self.0.bytes.load(Ordering::Relaxed)).unwrap_or(0)
    }

    /// The library's version, such as `4.4.0`.
    #[must_use]
    pub fn version(&self) -> String {
        let part = |property| self.property(property);
        format!(
            "{}.{}.{}",
            part(sys::RTC_DEVICE_PROPERTY_VERSION_MAJOR),
            part(sys::RTC_DEVICE_PROPERTY_VERSION_MINOR),
            part(sys::RTC_DEVICE_PROPERTY_VERSION_PATCH)
        )
    }

    /// Whether packets of `width` rays have kernels of their own; others fall to single rays inside Embree.
    #[must_use]
    pub fn is_native_width(&self, width: usize) -> bool {
        let property = match width {
            1 => return true,
            4 => sys::RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED,
            8 => sys::RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED,
            16 => sys::RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED,
            _ => return false,
        };
        self.property(property) != 0
    }

    /// The widest packets with kernels of their own: 16, 8, 4 or 1.
    #[must_use]
    pub fn native_width(&self) -> usize {
        [16, 8, 4].into_iter().find(|&width| self.is_native_width(width)).unwrap_or(1)
    }

    /// The instruction set in use, as far as it can be told: the processor's best within the configuration, and what
    /// the native widths confirm. `None` on another architecture.
    #[must_use]
    pub fn isa(&self) -> Option<Isa> {
        let own = Isa::of_processor()?;
        let allowed = self.0.config.max_isa.map_or(own, |max| own.min(max));
        let confirmed = match self.native_width() {
            16 => Isa::Avx512,
            8 => Isa::Avx2,
            _ => Isa::Sse42,
        };
        Some(allowed.min(confirmed))
    }

    /// The first error this thread's calls have met since the last time, if any.
    pub(super) fn check(&self) -> Result<(), EmbreeError> {
        self.0.errors.take()
    }

    /// The handle, valid for as long as `self`.
    pub(super) fn raw(&self) -> sys::RTCDevice {
        self.0.raw.as_ptr()
    }

    /// Whether both are handles to one device.
    pub(super) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    fn property(&self, property: sys::RTCDeviceProperty) -> isize {
        // SAFETY: the device lives as long as `self`, and an unknown property is an error, not undefined.
        unsafe { sys::rtcGetDeviceProperty(self.raw(), property) }
    }
}

/// Embree's memory monitor: "The application can track the current memory usage of the Embree device by atomically
/// accumulating the bytes input parameter".
///
/// # Safety
/// `counter` points to an `AtomicIsize` that outlives the device.
unsafe extern "C" fn count_bytes(counter: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: the caller's promise.
    let counter = unsafe { &*counter.cast::<AtomicIsize>() };
    counter.fetch_add(bytes, Ordering::Relaxed);
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::Level;

    #[test]
    fn the_configuration_is_written_as_embree_reads_it() {
        let config =
            Config { threads: NonZeroU32::new(2), max_isa: Some(Isa::Avx2), huge_pages: Some(false) };
        assert_eq!(config.to_string(), "ignore_config_files=1,threads=2,max_isa=avx2,hugepages=0", "text");
        assert_eq!(Config::default().to_string(), "ignore_config_files=1", "text of the default");
    }

    #[test]
    fn a_device_knows_itself() {
        let device = Device::new(Config::default()).expect("device");
        assert!(device.version().starts_with("4."), "version {}", device.version());
        assert!(device.is_native_width(device.native_width()), "native width is native");
        assert!(!device.is_native_width(5), "no packets of five");
        println!("Embree {} with {:?}, width {}", device.version(), device.isa(), device.native_width());
    }

    #[test]
    fn embree_goes_with_our_own_kernels() {
        for level in Level::available() {
            let held = Isa::beside(level.name());
            let weaker = held.is_some_and(|isa| isa <= Isa::Avx2);
            assert_eq!(weaker, ["avx2", "portable"].contains(&level.name()), "{held:?} with {level:?}");
        }
    }

    #[test]
    fn a_weaker_instruction_set_can_be_asked_for() {
        if Isa::of_processor().is_none() {
            println!("skipped: not an x86-64 processor");
            return;
        }
        let device = Device::new(Config { max_isa: Some(Isa::Sse2), ..Config::default() }).expect("device");
        assert_eq!(device.native_width(), 4, "SSE2 has packets of four");
        assert!(device.isa() <= Some(Isa::Sse42), "capped, but is {:?}", device.isa());
    }
}
