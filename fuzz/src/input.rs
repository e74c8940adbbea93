//! Bytes as a stream of choices; at their end everything is zero.

/// What is left of the fuzzer's bytes.
pub struct Input<'a>(&'a [u8]);

impl<'a> Input<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn byte(&mut self) -> u8 {
        let [byte] = self.array();
        byte
    }

    pub fn bool(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    pub fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.array())
    }

    /// One of a list, by one byte.
    pub fn pick<T: Clone>(&mut self, list: &[T]) -> T {
        list[usize::from(self.byte()) % list.len()].clone()
    }

    /// A number: one of those that matter, a code of 8 bits, or any bit pattern.
    pub fn number(&mut self) -> f32 {
        const SPECIAL: [f32; 16] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.5,
            2.0,
            1e-40,
            -1e-40,
            1e-5,
            65504.0,
            65520.0,
            1e30,
            f32::MAX,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ];
        match self.byte() {
            kind @ 0..=63 => SPECIAL[usize::from(kind) % SPECIAL.len()],
            64..=127 => f32::from(self.byte()) / 255.0,
            128..=159 => f32::from(self.byte()) / 256.0,
            _ => f32::from_bits(self.u32()),
        }
    }

    pub fn color(&mut self) -> [f32; 4] {
        std::array::from_fn(|_| self.number())
    }

    /// The next N bytes, zeros where there are none.
    pub fn array<const N: usize>(&mut self) -> [u8; N] {
        let taken = N.min(self.0.len());
        let (head, rest) = self.0.split_at(taken);
        let mut bytes = [0; N];
        bytes[..taken].copy_from_slice(head);
        self.0 = rest;
        bytes
    }
}
