//! Which adapters there are, choosing one by name, and the environment a comparison needs.
//!
//! Adapters are Vulkan's, or OpenGL's with [`GL_PREFIX`] before the name. OpenGL has no second source here and cannot read
//! depth back; what it lacks is left out by name.
//!
//! Mesa's disk cache of compiled shaders ignores the vector width (`LP_NATIVE_VECTOR_WIDTH`), which changes results, so
//! a comparison runs with the cache off. The driver reads the variable when it is loaded and this crate has no unsafe
//! code to set it in its own process: [`reexec_without_shader_cache`] starts the program again instead.

use std::time::Duration;

use wgpu::{Backends, Features};

use crate::model::llvmpipe::{Estimate, Generation, Llvmpipe, VectorWidth};
use crate::model::registry::Drivers;
use crate::model::swiftshader::{self, SwiftShader};
use crate::processor::Processor;
use crate::vectors::DriverRecord;

/// The variable that turns Mesa's shader cache off.
pub const SHADER_CACHE_VARIABLE: &str = "MESA_SHADER_CACHE_DISABLE";

/// The variable that narrows llvmpipe's vectors, in bits.
pub const VECTOR_WIDTH_VARIABLE: &str = "LP_NATIVE_VECTOR_WIDTH";

/// A device that cannot be opened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OpenError {
    /// No loader, no driver, or a driver without devices.
    #[error(
        "no {api} adapter: {reason}; install a driver (software: Debian's mesa-vulkan-drivers) or point VK_DRIVER_FILES at its ICD file"
    )]
    NoAdapter {
        /// `Vulkan` or `OpenGL`.
        api: &'static str,
        /// What wgpu says of each backend.
        reason: String,
    },
    /// There are adapters, but none of this name.
    #[error("no {api} adapter whose name or driver contains `{name}`; there are: {}", found.join("; "))]
    NoSuchAdapter {
        /// `Vulkan` or `OpenGL`.
        api: &'static str,
        /// The asked part of a name.
        name: String,
        /// The adapters there are.
        found: Vec<String>,
    },
    /// OpenGL was asked for, and this build has none.
    #[error("adapter `{0}`: this build drives Vulkan alone; build with the feature `gl`")]
    NoOpenGl(String),
    /// The adapter lacks a required feature.
    #[error(
        "adapter `{adapter}` lacks the feature {features}; choose another adapter or leave out the states that need it"
    )]
    MissingFeatures {
        /// The adapter's name.
        adapter: String,
        /// The features, as wgpu names them.
        features: String,
    },
    /// Mesa's shader cache is on.
    #[error(
        "Mesa's shader cache is on, and it mixes results of different vector widths; set {SHADER_CACHE_VARIABLE}=true, or pass --allow-shader-cache"
    )]
    ShaderCache,
    /// The driver refused to open the device.
    #[error("adapter `{adapter}` cannot be opened: {reason}")]
    Refused {
        /// The adapter's name.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
}

/// How to open a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenOptions {
    /// Part of the adapter's name or driver, case ignored; `None` takes the first adapter. [`GL_PREFIX`] before it looks
    /// among OpenGL's.
    pub adapter: Option<String>,
    /// Features to insist on; others that states may need are taken when present.
    pub required_features: Features,
    /// Features to do without even where the adapter has them: a poorer device, to see what is then left out.
    pub declined_features: Features,
    /// Accept Mesa's shader cache (see the module's page).
    pub allow_shader_cache: bool,
    /// Longest wait for one submission before the device counts as hung.
    pub timeout: Duration,
}

impl Default for OpenOptions {
    fn default() -> Self {
        Self {
            adapter: None,
            required_features: Features::empty(),
            declined_features: Features::empty(),
            allow_shader_cache: false,
            timeout: Duration::from_secs(60),
        }
    }
}

/// What identifies an adapter in a report.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
pub struct AdapterReport {
    /// The device's name, e.g. `llvmpipe (LLVM 15.0.6, 256 bits)`.
    pub name: String,
    /// The driver's name; where it does not tell, the API's.
    pub driver: String,
    /// The driver's version.
    pub driver_info: String,
    /// Kind of device, e.g. `Cpu`.
    pub device_type: String,
    /// Width of llvmpipe's vectors as forced by [`VECTOR_WIDTH_VARIABLE`]; `None` when the driver chooses.
    pub native_vector_width: Option<String>,
    /// Whether Mesa's shader cache is off.
    pub shader_cache_disabled: bool,
}

impl AdapterReport {
    /// Describes an adapter in this process's environment.
    #[must_use]
    pub fn of(info: &wgpu::AdapterInfo) -> Self {
        Self {
            name: info.name.clone(),
            driver: if info.driver.is_empty() { info.backend.to_string() } else { info.driver.clone() },
            driver_info: info.driver_info.clone(),
            device_type: format!("{:?}", info.device_type),
            native_vector_width: std::env::var(VECTOR_WIDTH_VARIABLE).ok(),
            shader_cache_disabled: shader_cache_disabled(),
        }
    }

    /// Mesa's version, of `Mesa 22.3.6 (LLVM 15.0.6)`.
    #[must_use]
    pub fn mesa_version(&self) -> Option<[u32; 3]> {
        let (_, rest) = self.driver_info.split_once("Mesa ")?;
        let text = rest.split(|c: char| c != '.' && !c.is_ascii_digit()).next()?;
        let mut numbers = text.split('.').map(|part| part.parse().ok());
        let mut next = || numbers.next().flatten();
        let (major, minor) = (next()?, next()?);
        Some([major, minor, next().unwrap_or(0)])
    }

    /// The width of llvmpipe's vectors, of `llvmpipe (LLVM 15.0.6, 256 bits)`.
    #[must_use]
    pub fn vector_width(&self) -> Option<VectorWidth> {
        let (_, rest) = self.name.split_once("llvmpipe")?;
        if rest.contains("128 bits") { Some(VectorWidth::Bits128) } else { Some(VectorWidth::Bits256) }
    }

    /// What plain names of drivers mean against this adapter: its own version, vectors and processor.
    ///
    /// A llvmpipe of a version that was not proven counts as the nearest older generation; [`warning`](Self::warning) says so.
    #[must_use]
    pub fn drivers(&self) -> Drivers {
        let newest = Llvmpipe::default();
        let llvmpipe = match self.vector_width() {
            None => newest,
            Some(vector_width) => Llvmpipe {
                generation: self.mesa_version().map_or(newest.generation, |version| Generation::of_version(version).0),
                vector_width,
                estimate: Estimate::host().unwrap_or(newest.estimate),
            },
        };
        Drivers { llvmpipe, swiftshader: self.swiftshader() }
    }

    /// The SwiftShader that this adapter's library is, if it is a known build; else the present one.
    fn swiftshader(&self) -> SwiftShader {
        let build = if self.name.contains("SwiftShader") { super::library::of_adapter(self) } else { None };
        let version = build.and_then(|library| library.known_as).and_then(|name| {
            let digits = name.strip_prefix("Chromium ")?.split(|c: char| !c.is_ascii_digit()).next()?.to_owned();
            swiftshader::Generation::from_parameter(&format!("chromium={digits}")).ok()
        });
        version.map_or_else(SwiftShader::default, |generation| SwiftShader { generation })
    }

    /// What to tell the user of a driver whose version no model was proven on.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        self.vector_width()?;
        let version = self.mesa_version()?;
        let (generation, footing) = Generation::of_version(version);
        footing.warning(version, generation)
    }

    /// The version of LLVM, of `Mesa 22.3.6 (LLVM 15.0.6)`.
    fn llvm_version(&self) -> Option<String> {
        let (_, rest) = self.driver_info.split_once("LLVM ").or_else(|| self.name.split_once("LLVM "))?;
        rest.split([')', ',']).next().map(str::to_owned)
    }

    /// What this adapter's bytes depend on, to be kept with results.
    #[must_use]
    pub fn record(&self) -> DriverRecord {
        let bits = self.vector_width().map(|width| match width {
            VectorWidth::Bits256 => 256,
            VectorWidth::Bits128 => 128,
        });
        DriverRecord {
            adapter: self.name.clone(),
            driver: self.driver.clone(),
            version: self.driver_info.clone(),
            llvm: self.llvm_version(),
            vector_bits: bits,
            processor: Processor::of_this_machine(),
            // Mesa tells its version; a driver that tells none is known by its file alone.
            library: if self.is_mesa() { None } else { super::library::of_adapter(self) },
            warning: self.warning(),
        }
    }

    /// Whether the driver is one of Mesa's, which share the shader cache.
    #[must_use]
    pub fn is_mesa(&self) -> bool {
        self.driver_info.contains("Mesa")
    }
}

impl std::fmt::Display for AdapterReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} [{}, {}, {}]", self.name, self.device_type, self.driver, self.driver_info)
    }
}

/// What a wanted adapter's name begins with when it is to be driven through OpenGL (feature `gl`).
pub const GL_PREFIX: &str = "gl:";

/// An instance of Vulkan or OpenGL: the way to adapters.
#[derive(Debug)]
pub struct Adapters {
    api: &'static str,
    instance: wgpu::Instance,
    found: Vec<wgpu::Adapter>,
}

impl Adapters {
    /// Asks the Vulkan loader for all adapters; there may be none.
    #[must_use]
    pub fn enumerate() -> Self {
        Self::through("Vulkan", Backends::VULKAN)
    }

    /// Asks EGL for OpenGL's adapters; there may be none.
    #[cfg(feature = "gl")]
    #[must_use]
    pub fn enumerate_gl() -> Self {
        Self::through("OpenGL", Backends::GL)
    }

    fn through(api: &'static str, backends: Backends) -> Self {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            // Validation layers change nothing in the bytes and cost time; software drivers may lack certification.
            flags: wgpu::InstanceFlags::ALLOW_UNDERLYING_NONCOMPLIANT_ADAPTER,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let found = pollster::block_on(instance.enumerate_adapters(backends));
        Self { api, instance, found }
    }

    /// What there is, in the loader's order.
    #[must_use]
    pub fn reports(&self) -> Vec<AdapterReport> {
        self.found.iter().map(|adapter| AdapterReport::of(&adapter.get_info())).collect()
    }

    /// The first adapter whose name or driver contains `name`, case ignored; the first of all for `None`.
    ///
    /// # Errors
    /// [`OpenError::NoAdapter`] when there is none at all, [`OpenError::NoSuchAdapter`] when none has that name.
    pub fn choose(&self, name: Option<&str>) -> Result<&wgpu::Adapter, OpenError> {
        let Some(first) = self.found.first() else {
            return Err(OpenError::NoAdapter { api: self.api, reason: self.why_none() });
        };
        let Some(name) = name else { return Ok(first) };
        let wanted = name.to_lowercase();
        let matches = |adapter: &&wgpu::Adapter| {
            let info = adapter.get_info();
            [info.name, info.driver, info.driver_info].iter().any(|text| text.to_lowercase().contains(&wanted))
        };
        self.found.iter().find(matches).ok_or_else(|| OpenError::NoSuchAdapter {
            api: self.api,
            name: name.to_owned(),
            found: self.reports().iter().map(ToString::to_string).collect(),
        })
    }

    /// wgpu's own words for an empty list: loader missing, driver missing, no device.
    fn why_none(&self) -> String {
        match pollster::block_on(self.instance.request_adapter(&wgpu::RequestAdapterOptions::default())) {
            Ok(_) => "the list of adapters is empty".to_owned(),
            Err(error) => error.to_string(),
        }
    }
}

/// Whether the environment turns Mesa's shader cache off.
#[must_use]
pub fn shader_cache_disabled() -> bool {
    let value = std::env::var(SHADER_CACHE_VARIABLE).unwrap_or_default().to_lowercase();
    matches!(value.as_str(), "1" | "true" | "y" | "yes")
}

/// Starts this program again, same arguments, with Mesa's shader cache off; returns only when it is off already.
///
/// On Unix the new program replaces this one; elsewhere it runs as a child and this process exits with its code.
///
/// # Errors
/// When the program cannot be started again.
pub fn reexec_without_shader_cache() -> std::io::Result<()> {
    if shader_cache_disabled() {
        return Ok(());
    }
    let mut again = std::process::Command::new(std::env::current_exe()?);
    again.args(std::env::args_os().skip(1)).env(SHADER_CACHE_VARIABLE, "true");
    #[cfg(unix)]
    {
        // `exec` returns only on failure.
        Err(std::os::unix::process::CommandExt::exec(&mut again))
    }
    #[cfg(not(unix))]
    {
        let status = again.status()?;
        std::process::exit(status.code().unwrap_or(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(name: &str, driver_info: &str) -> AdapterReport {
        AdapterReport {
            name: name.to_owned(),
            driver: "llvmpipe".to_owned(),
            driver_info: driver_info.to_owned(),
            device_type: "Cpu".to_owned(),
            native_vector_width: None,
            shader_cache_disabled: true,
        }
    }

    #[test]
    fn a_llvmpipe_stands_for_its_own_generation_and_width() {
        for (name, info, generation, vector_width, warns) in [
            ("llvmpipe (LLVM 15.0.6, 256 bits)", "Mesa 22.3.6 (LLVM 15.0.6)", "22.3", VectorWidth::Bits256, false),
            ("llvmpipe (LLVM 22.1.8, 128 bits)", "Mesa 26.2.6-1 (LLVM 22.1.8)", "26.1", VectorWidth::Bits128, false),
            ("llvmpipe (LLVM 20.1, 256 bits)", "Mesa 27.0.0-devel (git-1)", "26.1", VectorWidth::Bits256, true),
            ("llvmpipe (LLVM 17, 256 bits)", "Mesa 24.1", "22.3", VectorWidth::Bits256, true),
        ] {
            let report = report(name, info);
            let llvmpipe = report.drivers().llvmpipe;
            assert_eq!(llvmpipe.generation.facts().name, generation, "{info}");
            assert_eq!(llvmpipe.vector_width, vector_width, "{name}");
            assert_eq!(Some(llvmpipe.estimate), Estimate::host().or(Some(Estimate::default())), "this machine's");
            assert_eq!(report.warning().is_some(), warns, "{info}");
        }
        assert_eq!(report("GeForce", "555.1").drivers(), Drivers::default(), "another driver");
        assert_eq!(report("GeForce", "555.1").warning(), None, "nothing is claimed of it");
    }
}
