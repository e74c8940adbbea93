#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| outmerge_fuzz::kernel::check(data));
