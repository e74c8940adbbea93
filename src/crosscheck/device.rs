//! An open device whose faults come back as errors: lost device, failed validation, lack of memory, hung driver.
//!
//! wgpu reports most faults through callbacks, by default as panics. Here the callbacks only note the fault, and
//! [`Device::finish`] turns it into a [`DeviceError`] at the next wait.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use wgpu::{Features, PollType, SubmissionIndex};

use super::adapter::{AdapterReport, Adapters, GL_PREFIX, OpenError, OpenOptions, shader_cache_disabled};
use crate::format::ColorFormat;

/// Features that some state or format needs, taken whenever the adapter has them.
const USEFUL_FEATURES: Features = Features::TEXTURE_FORMAT_16BIT_NORM
    .union(Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
    .union(Features::RG11B10UFLOAT_RENDERABLE)
    .union(Features::FLOAT32_BLENDABLE)
    .union(Features::DUAL_SOURCE_BLENDING)
    .union(Features::DEPTH_CLIP_CONTROL)
    .union(Features::DEPTH32FLOAT_STENCIL8);

/// A fault of an open device.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeviceError {
    /// The device went away.
    #[error("the device was lost: {0}; open it again")]
    Lost(String),
    /// The driver did not finish in time.
    #[error("the driver did not finish within {0:?}; give it longer, or take it for hung and end the program")]
    Timeout(Duration),
    /// Host or device memory ran out.
    #[error("the device ran out of memory: {0}; use smaller batches")]
    OutOfMemory(String),
    /// wgpu refused a call.
    #[error("wgpu refused: {0}")]
    Validation(String),
    /// The driver failed for another reason.
    #[error("the driver failed: {0}")]
    Internal(String),
}

impl DeviceError {
    /// Whether the device is of no use afterwards. Anything else concerns only what was asked last.
    #[must_use]
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Lost(_) | Self::Timeout(_))
    }
}

/// The first fault since the last look.
#[derive(Clone, Debug, Default)]
struct Faults(Arc<Mutex<Option<DeviceError>>>);

impl Faults {
    fn note(&self, fault: DeviceError) {
        let mut slot = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*slot {
            Some(known) if known.is_final() || !fault.is_final() => {}
            _ => *slot = Some(fault),
        }
    }

    fn take(&self) -> Result<(), DeviceError> {
        let mut slot = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*slot {
            // Every later use fails the same way.
            Some(fault) if fault.is_final() => Err(fault.clone()),
            Some(_) => slot.take().map_or(Ok(()), Err),
            None => Ok(()),
        }
    }
}

/// An open device.
#[derive(Debug)]
pub struct Device {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    adapter: wgpu::Adapter,
    report: AdapterReport,
    faults: Faults,
    timeout: Duration,
}

impl Device {
    /// Opens the adapter that `options` ask for, with every feature of use to a replay that it has.
    ///
    /// # Errors
    /// [`OpenError`], saying what is missing and what there is.
    pub fn open(options: &OpenOptions) -> Result<Self, OpenError> {
        let name = options.adapter.as_deref();
        let (adapters, name) = match name.and_then(|name| name.strip_prefix(GL_PREFIX)) {
            #[cfg(feature = "gl")]
            Some(name) => (Adapters::enumerate_gl(), Some(name).filter(|name| !name.is_empty())),
            #[cfg(not(feature = "gl"))]
            Some(_) => return Err(OpenError::NoOpenGl(name.unwrap_or_default().to_owned())),
            None => (Adapters::enumerate(), name),
        };
        let adapter = adapters.choose(name)?.clone();
        let report = AdapterReport::of(&adapter.get_info());
        if report.is_mesa() && !options.allow_shader_cache && !shader_cache_disabled() {
            return Err(OpenError::ShaderCache);
        }
        let missing = options.required_features - adapter.features();
        if !missing.is_empty() {
            return Err(OpenError::MissingFeatures { adapter: report.name, features: feature_names(missing) });
        }
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("outmerge"),
            required_features: options.required_features
                | ((adapter.features() & USEFUL_FEATURES) - options.declined_features),
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        });
        let (device, queue) = pollster::block_on(request)
            .map_err(|error| OpenError::Refused { adapter: report.name.clone(), reason: error.to_string() })?;

        let faults = Faults::default();
        let note = faults.clone();
        device.on_uncaptured_error(Arc::new(move |error| {
            note.note(match error {
                wgpu::Error::OutOfMemory { source } => DeviceError::OutOfMemory(source.to_string()),
                wgpu::Error::Validation { description, .. } => DeviceError::Validation(description),
                wgpu::Error::Internal { description, .. } => DeviceError::Internal(description),
            });
        }));
        let note = faults.clone();
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                note.note(DeviceError::Lost(message));
            }
        });
        Ok(Self { device, queue, adapter, report, faults, timeout: options.timeout })
    }

    /// What identifies the adapter.
    #[must_use]
    pub fn report(&self) -> &AdapterReport {
        &self.report
    }

    /// The features the device was opened with.
    #[must_use]
    pub fn features(&self) -> Features {
        self.device.features()
    }

    /// Whether the adapter draws to targets of this format.
    #[must_use]
    pub fn renders(&self, format: wgpu::TextureFormat) -> bool {
        self.usages(format).contains(wgpu::TextureUsages::RENDER_ATTACHMENT)
    }

    /// Whether the adapter blends in targets of this format.
    #[must_use]
    pub fn blends(&self, format: ColorFormat) -> bool {
        let format = format.texture_format();
        let wanted = wgpu::TextureFormatFeatureFlags::BLENDABLE;
        self.renders(format) && self.adapter.get_texture_format_features(format).flags.contains(wanted)
    }

    /// Whether the adapter has a second blend source.
    #[must_use]
    pub fn has_second_source(&self) -> bool {
        self.features().contains(Features::DUAL_SOURCE_BLENDING)
    }

    /// The usages this device may give a texture of `format`.
    fn usages(&self, format: wgpu::TextureFormat) -> wgpu::TextureUsages {
        let features = self.device.features();
        if !features.contains(format.required_features()) {
            return wgpu::TextureUsages::empty();
        }
        if features.contains(Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES) {
            self.adapter.get_texture_format_features(format).allowed_usages
        } else {
            format.guaranteed_format_features(features).allowed_usages
        }
    }

    /// Longest wait for one submission.
    #[must_use]
    pub fn timeout(&self) -> Duration {
        self.timeout
    }

    /// Waits for a submission and reports the first fault since the last look.
    ///
    /// After a timeout the device is unusable, and its handles are kept for ever: to drop them would wait for the hung
    /// driver.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn finish(&self, submission: SubmissionIndex) -> Result<(), DeviceError> {
        self.check()?;
        let wait = PollType::Wait { submission_index: Some(submission), timeout: Some(self.timeout) };
        match self.device.poll(wait) {
            Ok(_) => self.check(),
            Err(wgpu::PollError::Timeout) => {
                self.faults.note(DeviceError::Timeout(self.timeout));
                std::mem::forget((self.device.clone(), self.queue.clone()));
                self.check()
            }
            Err(error) => Err(DeviceError::Internal(error.to_string())),
        }
    }

    /// Takes the device away, as a driver does that loses it: every later use fails with [`DeviceError::Lost`].
    pub fn lose(&self) {
        self.faults.note(DeviceError::Lost("it was taken away".to_owned()));
        self.device.destroy();
    }

    /// Reports the first fault since the last look, without waiting.
    ///
    /// # Errors
    /// [`DeviceError`].
    pub fn check(&self) -> Result<(), DeviceError> {
        self.faults.take()
    }
}

/// Names of features as wgpu's constants have them, comma separated.
#[must_use]
pub fn feature_names(features: Features) -> String {
    features.iter_names().map(|(name, _)| name).collect::<Vec<_>>().join(", ")
}
