//! The driver with 128-bit vectors, in a process of its own: the driver reads its environment when it is loaded.

use assert_cmd::Command;

use crate::harness::llvmpipe;

/// The command under narrow vectors.
fn narrow(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("outmerge").expect("the command is built");
    command.env("LP_NATIVE_VECTOR_WIDTH", "128").env("MESA_SHADER_CACHE_DISABLE", "true").args(arguments);
    command
}

#[test]
fn narrow_vectors_give_the_bytes_of_the_128_bit_model() {
    if llvmpipe().is_none() {
        return;
    }
    // Random states on every format, sampled stores, and one factor's equal-alpha states.
    for only in ["random", "store/", "rgba8unorm/src1-alpha/"] {
        let sweep = ["conform", "--adapter", "llvmpipe", "--model", "llvmpipe:128", "--only", only, "--json"];
        let output = narrow(&sweep).output().expect("runs");
        let text = String::from_utf8_lossy(&output.stdout);
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{only}: {text} {complaint}");
        assert!(text.contains("128 bits"), "{only}: the adapter says how wide its vectors are");
    }
}

#[test]
fn the_256_bit_model_does_not_fit_narrow_vectors() {
    if llvmpipe().is_none() {
        return;
    }
    let sweep = ["conform", "--adapter", "llvmpipe", "--model", "llvmpipe:width=256", "--only", "store/rgba8unorm/"];
    let output = narrow(&sweep).output().expect("runs");
    assert_eq!(output.status.code(), Some(1), "a finding: {}", String::from_utf8_lossy(&output.stdout));
}
