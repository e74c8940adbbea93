//! The floor: bytes read, added and written.

#[cfg(target_arch = "x86_64")]
use outmerge::kernel::Isa;

fn plain(src: &[u8], dst: &mut [u8]) {
    for (d, s) in dst.iter_mut().zip(src) {
        *d = d.saturating_add(*s);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn avx2(src: &[u8], dst: &mut [u8]) {
    plain(src, dst);
}

/// dst = dst + src, saturated, on 256-bit vectors where the machine has them.
pub fn add(src: &[u8], dst: &mut [u8]) {
    #[cfg(target_arch = "x86_64")]
    if Isa::Avx2.available() {
        #[expect(unsafe_code, reason = "the processor has AVX2: asked just before")]
        return unsafe { avx2(src, dst) };
    }
    plain(src, dst);
}
