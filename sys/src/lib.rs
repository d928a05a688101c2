//! Raw bindings to Embree 4, generated from the headers of the library that will be linked.
//!
//! Nothing here is safe or convenient; names and meanings are those of Embree's own manual. The ray structures are
//! asserted at compile time to have the layout that callers rely on: a misaligned ray is a crash, not an error.
//! What the headers define as inline functions and casts, which bindgen passes over, is in [`inline`].
//!
//! `sys/setup.sh` gets Embree onto a machine; `build.rs` says where it is looked for.

#![expect(unsafe_code, reason = "declarations of a C library")]

mod bindings {
    #![expect(missing_docs, reason = "generated; Embree's manual documents each name")]
    #![allow(
        non_camel_case_types,
        non_snake_case,
        non_upper_case_globals,
        reason = "generated; C's own names"
    )]
    #![allow(clippy::all, clippy::multiple_unsafe_ops_per_block, clippy::use_self, reason = "generated")]

    include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
}

pub mod inline;
mod layout;

pub use bindings::*;
pub use inline::*;
