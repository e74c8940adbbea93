//! The processor that runs this program: software drivers' bytes depend on it.

use std::fmt;

/// What identifies a processor.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "json", serde(deny_unknown_fields))]
pub struct Processor {
    /// The maker as the processor names it, e.g. `AuthenticAMD`; elsewhere than on x86-64, the architecture.
    pub vendor: String,
    /// The family, extended part included; 0 where it is not known.
    pub family: u32,
    /// The model, extended part included; 0 where it is not known.
    pub model: u32,
    /// The name for people, where there is one.
    pub name: String,
}

impl Processor {
    /// Asks the processor (CPUID).
    #[cfg(all(target_arch = "x86_64", any(feature = "cli", feature = "gpu")))]
    #[must_use]
    pub fn of_this_machine() -> Self {
        let cpuid = raw_cpuid::CpuId::new();
        let vendor = cpuid.get_vendor_info().map(|vendor| vendor.as_str().to_owned());
        let features = cpuid.get_feature_info();
        let name = cpuid.get_processor_brand_string().map(|name| name.as_str().trim().to_owned());
        Self {
            vendor: vendor.unwrap_or_else(|| "x86_64".to_owned()),
            family: features.as_ref().map_or(0, |features| features.family_id().into()),
            model: features.as_ref().map_or(0, |features| features.model_id().into()),
            name: name.unwrap_or_default(),
        }
    }

    /// Elsewhere than on x86-64 only the architecture is known.
    #[cfg(all(not(target_arch = "x86_64"), any(feature = "cli", feature = "gpu")))]
    #[must_use]
    pub fn of_this_machine() -> Self {
        Self { vendor: std::env::consts::ARCH.to_owned(), family: 0, model: 0, name: String::new() }
    }
}

impl fmt::Display for Processor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.vendor)?;
        if self.family > 0 {
            write!(f, " family {} model {}", self.family, self.model)?;
        }
        if self.name.is_empty() { Ok(()) } else { write!(f, " ({})", self.name) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(any(feature = "cli", feature = "gpu"))]
    #[test]
    fn this_machine_s_processor_has_a_maker_and_on_x86_64_a_family() {
        let processor = Processor::of_this_machine();
        assert!(!processor.vendor.is_empty(), "{processor}");
        assert_eq!(processor.family > 0, cfg!(target_arch = "x86_64"), "{processor}");
    }

    #[test]
    fn it_is_written_in_one_line() {
        let processor =
            Processor { vendor: "AuthenticAMD".to_owned(), family: 26, model: 2, name: "AMD EPYC".to_owned() };
        assert_eq!(processor.to_string(), "AuthenticAMD family 26 model 2 (AMD EPYC)");
    }
}
