//! What can go wrong, and how Embree's own reports reach us.

use embree4_sys as sys;
use std::ffi::{CStr, c_char, c_void};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, ThreadId};

/// Why something was not built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EmbreeError {
    /// The caller's progress function asked to stop.
    #[error("the build of the hierarchy was cancelled")]
    Cancelled,
    /// Embree ran out of memory.
    #[error("embree is out of memory: {0}")]
    OutOfMemory(String),
    /// Anything else that Embree reports, in its own words.
    #[error("embree: {0}")]
    Library(String),
    /// A triangle that names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {count}")]
    Index {
        /// Which triangle, from 0.
        triangle: usize,
        /// The index it holds, from 0.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// An instance of a scene that itself has instances.
    #[error("instances of instances are not supported: place the inner shapes directly")]
    NestedInstance,
    /// A filter on an instance.
    #[error("instances take no filter: give it to the shape that is placed")]
    FilteredInstance,
    /// Objects of two devices put together.
    #[error("objects of different embree devices cannot be combined")]
    OtherDevice,
    /// A geometry number used twice in a scene.
    #[error("geometry number {0} is taken")]
    GeometryNumber(u32),
}

impl EmbreeError {
    fn from_library(code: sys::RTCError, message: String) -> Self {
        match code {
            sys::RTC_ERROR_CANCELLED => Self::Cancelled,
            sys::RTC_ERROR_OUT_OF_MEMORY => Self::OutOfMemory(message),
            _ => Self::Library(message),
        }
    }

    /// Why the last [`super::Device::new`] on this thread failed.
    pub(super) fn of_device_creation() -> Self {
        // SAFETY: the manual: "To detect the error code of a such a failed device construction, pass NULL".
        let code = unsafe { sys::rtcGetDeviceError(std::ptr::null_mut()) };
        // SAFETY: the header offers this call with no device for just this case.
        let message = unsafe { sys::rtcGetDeviceLastErrorMessage(std::ptr::null_mut()) };
        Self::from_library(code, owned(message))
    }
}

/// Errors reported to a device's callback and not yet asked for.
///
/// The callback runs on the thread whose call failed ("Each thread has its own error code per device"), so errors
/// are kept by thread: one thread's failed build is not another's.
#[derive(Debug, Default)]
pub(super) struct ErrorLog(Mutex<Vec<(ThreadId, EmbreeError)>>);

impl ErrorLog {
    /// The first error of this thread since the last call, if any; later ones are consequences and are dropped.
    pub(super) fn take(&self) -> Result<(), EmbreeError> {
        let mut log = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let own = thread::current().id();
        let first = log.iter().find(|(id, _)| *id == own).map(|(_, error)| error.clone());
        log.retain(|(id, _)| *id != own);
        first.map_or(Ok(()), Err)
    }

    fn push(&self, error: EmbreeError) {
        let mut log = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        log.push((thread::current().id(), error));
    }

    /// The callback to register together with a pointer to the log.
    ///
    /// # Safety
    /// `log` points to an `ErrorLog` that outlives the device; `message` is null or a C string.
    pub(super) unsafe extern "C" fn record(log: *mut c_void, code: sys::RTCError, message: *const c_char) {
        // SAFETY: the caller's promise.
        let log = unsafe { &*log.cast::<Self>() };
        log.push(EmbreeError::from_library(code, owned(message)));
    }
}

/// A copy of a C string; of null, a word.
fn owned(message: *const c_char) -> String {
    if message.is_null() {
        return "no reason given".to_owned();
    }
    // SAFETY: Embree passes zero-terminated strings that live for the duration of the call.
    unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned()
}
