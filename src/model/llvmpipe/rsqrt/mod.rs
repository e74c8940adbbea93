//! The processor's reciprocal square root estimate (x86 `RSQRTPS`), which the driver's sRGB encode is built on.
//!
//! The instruction's results are the maker's choice within 1.5 * 2^-12. An [`Estimate`] is either this machine's own, by
//! executing the instruction, or a recorded table:
//!
//! | name | processor | steps over [1, 4) that differ |
//! |---|---|---|
//! | `host` | the machine that runs the model, x86-64 | as it is |
//! | `intel-xeon` | Intel Xeon, family 6 model 207 (Sapphire or Emerald Rapids) | 2048 |
//! | `amd-zen5` | AMD EPYC, family 26 (Zen 5) and family 25 model 17 (Zen 4) | 8192 |
//!
//! The recorded form is a text: lines that begin with `#` are comments; then 8192 numbers of three hexadecimal digits, one for
//! each 2048 consecutive binary32 numbers from 1 to 4. Each is the top twelve mantissa bits of the result, whose other bits
//! are 0 and whose exponent is that of [0.5, 1). `outmerge estimate -o FILE` writes the running machine's. To add it: the file
//! beside this one, a variant of [`Estimate`], a row above.

use std::sync::LazyLock;

#[cfg(target_arch = "x86_64")]
use crate::kernel::simd::reciprocal_square_root_estimate as by_instruction;

/// Numbers of a table: its steps over [1, 4).
pub const STEPS: usize = 8192;

/// Consecutive binary32 numbers of one step.
pub const STEP: u32 = 1 << STEP_BITS;

/// Low mantissa bits that no recorded processor looks at.
const STEP_BITS: u32 = 11;

/// Whose reciprocal square root estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Estimate {
    /// This machine's: the instruction is executed.
    #[cfg(target_arch = "x86_64")]
    Host,
    /// Intel Xeon, family 6 model 207.
    IntelXeon,
    /// AMD EPYC, family 26 (Zen 5) and family 25 model 17 (Zen 4).
    AmdZen5,
}

/// `intel-xeon`: a recorded table, so that results do not depend on the machine that computes them.
impl Default for Estimate {
    fn default() -> Self {
        Self::IntelXeon
    }
}

/// A name that is no estimate's, or not on this machine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EstimateError {
    /// No such name.
    #[error("unknown estimate `rsqrt={0}`; use one of: host, intel-xeon, amd-zen5")]
    Unknown(String),
    /// The machine has no such instruction.
    #[error(
        "`rsqrt=host` executes an x86-64 instruction, which this machine lacks; name a recorded table: intel-xeon, amd-zen5"
    )]
    NoHost,
}

impl Estimate {
    /// The recorded ones.
    pub const RECORDED: [Self; 2] = [Self::IntelXeon, Self::AmdZen5];

    /// The name after `rsqrt=`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Host => "host",
            Self::IntelXeon => "intel-xeon",
            Self::AmdZen5 => "amd-zen5",
        }
    }

    /// The processor, in words.
    #[must_use]
    pub const fn processor(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Host => "the processor that runs this program",
            Self::IntelXeon => "Intel Xeon, family 6 model 207 (Sapphire or Emerald Rapids)",
            Self::AmdZen5 => "AMD EPYC, family 26 (Zen 5) and family 25 model 17 (Zen 4)",
        }
    }

    /// This machine's, if it has the instruction.
    #[must_use]
    pub const fn host() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        return Some(Self::Host);
        #[cfg(not(target_arch = "x86_64"))]
        return None;
    }

    /// The estimate of this name.
    ///
    /// # Errors
    /// [`EstimateError`].
    pub fn from_name(name: &str) -> Result<Self, EstimateError> {
        if name == "host" {
            return Self::host().ok_or(EstimateError::NoHost);
        }
        let found = Self::RECORDED.into_iter().find(|estimate| estimate.name() == name);
        found.ok_or_else(|| EstimateError::Unknown(name.to_owned()))
    }

    /// 1 / sqrt(x) as the processor estimates it, for positive normal x; infinity for 0 and denormals.
    #[must_use]
    pub fn rsqrt(self, x: f32) -> f32 {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Host => by_instruction(x),
            recorded => by_table(recorded.table(), x),
        }
    }

    /// The top twelve mantissa bits of the result for each step of [1, 4).
    ///
    /// Of the host the table is measured at the start of each step; see [`Recording`] for whether that is all of it.
    #[must_use]
    pub fn table(self) -> &'static [u16; STEPS] {
        #[cfg(target_arch = "x86_64")]
        static HOST: LazyLock<Table> =
            LazyLock::new(|| std::array::from_fn(|step| top_bits(by_instruction(step_start(step)))));
        static INTEL_XEON: LazyLock<Table> = LazyLock::new(|| recorded(include_str!("intel-xeon.txt")));
        static AMD_ZEN5: LazyLock<Table> = LazyLock::new(|| recorded(include_str!("amd-zen5.txt")));
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Host => &HOST,
            Self::IntelXeon => &INTEL_XEON,
            Self::AmdZen5 => &AMD_ZEN5,
        }
    }
}

type Table = [u16; STEPS];

/// The number at which a step begins.
fn step_start(step: usize) -> f32 {
    f32::from_bits(1.0_f32.to_bits() + u32::try_from(step).expect("8192 steps") * STEP)
}

/// The top twelve mantissa bits of a number.
fn top_bits(x: f32) -> u16 {
    u16::try_from(x.to_bits() >> STEP_BITS & 0xfff).expect("twelve bits")
}

fn by_table(table: &Table, x: f32) -> f32 {
    if x < f32::MIN_POSITIVE {
        return f32::INFINITY;
    }
    let bits = x.to_bits();
    let exponent = (bits >> 23).cast_signed() - 127;
    // x = m * 4^e with m in [1, 4): the step is given by the exponent's last bit and the top twelve of the mantissa.
    let (half_exponent, odd) = (exponent.div_euclid(2), exponent.rem_euclid(2).unsigned_abs());
    let step = (odd << 12 | (bits >> STEP_BITS) & 0xfff) as usize;
    // Results for [1, 4) lie in [0.5, 1); then scale by 2^-e.
    let result_exponent = (126 - half_exponent).unsigned_abs();
    f32::from_bits(result_exponent << 23 | u32::from(table[step]) << STEP_BITS)
}

/// A table in the recorded form.
fn recorded(text: &str) -> Table {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let numbers = lines.flat_map(str::split_whitespace).map(|digits| u16::from_str_radix(digits, 16));
    let numbers: Vec<u16> = numbers.collect::<Result<_, _>>().expect("the project's own files are hexadecimal");
    numbers.try_into().expect("the project's own files have 8192 numbers")
}

/// What this machine's instruction answers, checked on every number of [1, 4).
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recording {
    /// The results at the start of each step.
    pub table: Box<[u16; STEPS]>,
    /// Numbers of [1, 4) whose result is not that of their step: then the recorded form cannot hold this processor.
    pub outside: u32,
}

#[cfg(target_arch = "x86_64")]
impl Recording {
    /// Executes the instruction on all 2^24 numbers of [1, 4).
    #[must_use]
    pub fn of_this_machine() -> Self {
        let table = Box::new(*Estimate::Host.table());
        let numbers = (0..STEP << 13).map(|i| f32::from_bits(1.0_f32.to_bits() + i));
        let differs = |x: &f32| by_instruction(*x).to_bits() != by_table(&table, *x).to_bits();
        let outside = u32::try_from(numbers.filter(differs).count()).unwrap_or(u32::MAX);
        Self { table, outside }
    }

    /// The recorded estimate with the same table.
    #[must_use]
    pub fn known_as(&self) -> Option<Estimate> {
        Estimate::RECORDED.into_iter().find(|known| self.outside == 0 && known.table() == self.table.as_ref())
    }

    /// The recorded form, under comment lines.
    #[must_use]
    pub fn to_text(&self, comments: &[String]) -> String {
        let comments: String = comments.iter().map(|line| format!("# {line}\n")).collect();
        let row = |row: &[u16]| {
            let digits: Vec<String> = row.iter().map(|bits| format!("{bits:03x}")).collect();
            digits.join(" ") + "\n"
        };
        comments + &self.table.chunks(16).map(row).collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> impl Iterator<Item = Estimate> {
        Estimate::RECORDED.into_iter().chain(Estimate::host())
    }

    #[test]
    fn every_step_answers_with_its_number() {
        for estimate in Estimate::RECORDED {
            for (step, bits) in estimate.table().iter().enumerate() {
                let [first, last] = [0, STEP - 1].map(|offset| f32::from_bits(step_start(step).to_bits() + offset));
                assert_eq!([first, last].map(|x| top_bits(estimate.rsqrt(x))), [*bits; 2], "{estimate:?}: step {step}");
            }
        }
    }

    #[test]
    fn estimates_are_within_the_architecture_s_bound() {
        for estimate in all() {
            for bits in (0x0080_0000..0x7f80_0000_u32).step_by(9973) {
                let x = f32::from_bits(bits);
                let relative = f64::from(estimate.rsqrt(x)) * f64::from(x).sqrt() - 1.0;
                assert!(relative.abs() <= 1.5 / 4096.0, "{estimate:?}: {x}: {relative}");
            }
            assert_eq!(estimate.rsqrt(0.0), f32::INFINITY, "{estimate:?}");
        }
    }

    #[test]
    fn names_select_estimates() {
        for estimate in all() {
            assert_eq!(Estimate::from_name(estimate.name()), Ok(estimate));
        }
        assert!(Estimate::from_name("via").is_err_and(|error| error.to_string().contains("intel-xeon")));
    }

    #[test]
    fn recorded_processors_differ() {
        let steps = Estimate::IntelXeon.table().iter().zip(Estimate::AmdZen5.table());
        assert_eq!(steps.filter(|(a, b)| a != b).count(), 4357, "steps of 8192");
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn what_is_written_is_what_is_read_and_scales_with_even_powers_of_two() {
        let recording = Recording::of_this_machine();
        assert_eq!(recording.outside, 0, "this machine's processor fits the recorded form");
        assert_eq!(recorded(&recording.to_text(&["made by a test".to_owned()])), *recording.table);
        for bits in (f32::MIN_POSITIVE.to_bits()..f32::INFINITY.to_bits()).step_by(1021) {
            let x = f32::from_bits(bits);
            assert_eq!(by_instruction(x).to_bits(), by_table(&recording.table, x).to_bits(), "{x:e}");
        }
    }
}
