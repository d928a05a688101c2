#![no_main]

#[path = "../loaders.rs"]
mod loaders;

libfuzzer_sys::fuzz_target!(|data: &[u8]| loaders::obj(data));
