#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| selfneg_fuzz::trace(input));
