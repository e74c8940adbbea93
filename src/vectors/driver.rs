//! Which driver stored something: name and version, compiler, vector width, processor, and the library where the driver tells no
//! version.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::line::LineError;
use crate::processor::Processor;

/// What a driver's bytes depend on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriverRecord {
    /// The adapter's name, e.g. `llvmpipe (LLVM 15.0.6, 256 bits)`.
    pub adapter: String,
    /// The driver's name.
    pub driver: String,
    /// What the driver says of its version; empty where it says nothing.
    pub version: String,
    /// LLVM's version, where the driver compiles with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub llvm: Option<String>,
    /// Bits of the vectors it compiles for, where it says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vector_bits: Option<u32>,
    /// The processor of the machine.
    pub processor: Processor,
    /// The driver's library, where the driver reports no version of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub library: Option<Library>,
    /// That no model was proven on this version, and what it is compared with instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
}

/// A driver's library.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Library {
    /// Its file name.
    pub name: String,
    /// SHA-256 of the file, in hex.
    pub sha256: String,
    /// The build it is, if it is one of those that were tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known_as: Option<String>,
}

impl fmt::Display for DriverRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.driver)?;
        if !self.version.is_empty() {
            write!(f, " {}", self.version)?;
        }
        if let Some(llvm) = self.llvm.as_ref().filter(|llvm| !self.version.contains(llvm.as_str())) {
            write!(f, ", LLVM {llvm}")?;
        }
        if let Some(bits) = self.vector_bits {
            write!(f, ", {bits}-bit vectors")?;
        }
        write!(f, ", on {}", self.processor)?;
        if let Some(library) = &self.library {
            let build = library.known_as.as_deref().unwrap_or("a build not tried before");
            write!(f, ", {} sha256 {} ({build})", library.name, library.sha256)?;
        }
        Ok(())
    }
}

/// The line that begins a recorded vector file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDriver {
    kind: String,
    driver: DriverRecord,
}

impl DriverRecord {
    /// Parses a line of kind `driver`.
    ///
    /// # Errors
    /// [`LineError`].
    pub fn parse(text: &str) -> Result<Self, LineError> {
        let raw: RawDriver = serde_json::from_str(text)?;
        if raw.kind == "driver" { Ok(raw.driver) } else { Err(LineError::Kind(raw.kind)) }
    }

    /// The line as JSON, without a line break.
    ///
    /// # Panics
    /// Never: the object has string keys only.
    #[must_use]
    pub fn to_json(&self) -> String {
        let raw = RawDriver { kind: "driver".to_owned(), driver: self.clone() };
        serde_json::to_string(&raw).expect("plain strings and numbers serialise")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> DriverRecord {
        DriverRecord {
            adapter: "llvmpipe (LLVM 15.0.6, 256 bits)".to_owned(),
            driver: "llvmpipe".to_owned(),
            version: "Mesa 22.3.6 (LLVM 15.0.6)".to_owned(),
            llvm: Some("15.0.6".to_owned()),
            vector_bits: Some(256),
            processor: Processor {
                vendor: "AuthenticAMD".to_owned(),
                family: 26,
                model: 2,
                name: "AMD EPYC".to_owned(),
            },
            library: None,
            warning: None,
        }
    }

    #[test]
    fn a_record_is_a_line_and_back() {
        let record = record();
        let line = record.to_json();
        assert!(line.starts_with(r#"{"kind":"driver","driver":{"#), "{line}");
        assert_eq!(DriverRecord::parse(&line).expect("its own line"), record);
        assert!(DriverRecord::parse(&line.replace("\"llvm\"", "\"clang\"")).is_err(), "unknown members are refused");
    }

    #[test]
    fn it_is_told_in_one_line() {
        let text = "llvmpipe Mesa 22.3.6 (LLVM 15.0.6), 256-bit vectors, on AuthenticAMD family 26 model 2 (AMD EPYC)";
        assert_eq!(record().to_string(), text);
        let library = Library { name: "libvk_swiftshader.so".to_owned(), sha256: "ab".to_owned(), known_as: None };
        let unknown = DriverRecord { library: Some(library), ..record() };
        assert!(unknown.to_string().ends_with("libvk_swiftshader.so sha256 ab (a build not tried before)"));
    }
}
