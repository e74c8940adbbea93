//! Contenders measured in turn.

use std::hint::black_box;
use std::time::Instant;

/// The least time a case of one size takes, and the least number of rounds.
const SECONDS: f64 = 0.35;
const ROUNDS: usize = 5;

/// Merges source bytes into target bytes.
type Run<'a> = Box<dyn FnMut(&[u8], &mut [u8]) + 'a>;

/// Somebody who merges `src` into `dst`.
pub struct Contender<'a> {
    pub name: String,
    pub run: Run<'a>,
}

impl<'a> Contender<'a> {
    pub fn new(name: impl Into<String>, run: impl FnMut(&[u8], &mut [u8]) + 'a) -> Self {
        Self { name: name.into(), run: Box::new(run) }
    }
}

/// Nanoseconds of each contender's best run. Every run begins with the bytes of `before`, copied outside the time.
pub fn measure(contenders: &mut [Contender<'_>], src: &[u8], before: &[u8]) -> Vec<f64> {
    let mut dst = before.to_vec();
    let mut best = vec![f64::INFINITY; contenders.len()];
    let start = Instant::now();
    let mut rounds = 0;
    while rounds < ROUNDS || start.elapsed().as_secs_f64() < SECONDS {
        for (contender, best) in contenders.iter_mut().zip(&mut best) {
            dst.copy_from_slice(before);
            let run = Instant::now();
            (contender.run)(black_box(src), black_box(&mut dst));
            *best = best.min(run.elapsed().as_secs_f64() * 1e9);
        }
        rounds += 1;
    }
    best
}

/// The percentage of pixels that differ from `exact`.
pub fn wrong(contender: &mut Contender<'_>, src: &[u8], before: &[u8], exact: &[u8], texel: usize) -> f64 {
    let mut dst = before.to_vec();
    (contender.run)(src, &mut dst);
    let differing = dst.chunks_exact(texel).zip(exact.chunks_exact(texel)).filter(|(a, b)| a != b).count();
    100.0 * differing as f64 / (dst.len() / texel) as f64
}
