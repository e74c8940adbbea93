//! Kernels against a streaming kernel and other libraries, in one process: `cargo bench --all-features --bench kernel`.
//!
//! With words after `--`, only the cases whose name holds one of them: `cargo bench --all-features --bench kernel -- srgb`.
//!
//! The streaming kernel adds bytes with saturation: it reads source and target and writes the target (12 bytes a pixel for
//! 8-bit formats, 24 for half floats) and computes next to nothing, so it is as fast as memory. "Of stream" is its time
//! over a contender's: 1 means that merging is free beside moving the bytes. All contenders of a case run in turn, again
//! and again, on the same bytes and one thread, and each time is the least of its runs. "Ours" is a contender's time over
//! that of the first kernel of the case.
//!
//! 64^2 stays in the first-level cache: the time there is arithmetic alone, so (streaming kernel's time) / (time at 64^2)
//! bounds "of stream" from above at every size. Where the figures aimed at are missed, that bound is the reason:
//! docs/performance.md has them side by side. Two operands, two factors and a constant that differ between color and alpha
//! take three products more than over; an exact half takes as long to be proven as to be blended; an sRGB texel takes
//! eight table look-ups; and five times pixman's OVER would be more than twice as fast as memory.
//!
//! "Wrong" is the share of pixels that are not the correctly rounded ones, which the `exact` kernel gives: how a model or
//! a library departs from exact arithmetic.

mod cases;
#[cfg(feature = "gpu")]
mod driver;
mod layers;
mod measure;
mod peers;
mod pixman;
mod stream;

use outmerge::kernel::Isa;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let wanted = |name: &str| words.is_empty() || words.iter().any(|word| name.contains(word.as_str()));
    for isa in Isa::ALL.into_iter().filter(|isa| !isa.available()) {
        println!("not run: {isa:?}, which this machine has not");
    }
    let pixman = pixman::Pixman::open();
    if let Err(reason) = &pixman {
        println!("not run: pixman: {reason}");
    }
    cases::run(pixman.as_ref().ok(), &wanted);
    if wanted("reference") {
        cases::reference();
    }
    if wanted("layers") {
        layers::run();
    }
    if wanted("driver") {
        #[cfg(feature = "gpu")]
        driver::run();
        #[cfg(not(feature = "gpu"))]
        println!("\nnot run: lavapipe: built without the feature `gpu`");
    }
}
