//! Limits on what an input may make this crate read or allocate, with defaults that ordinary inputs never meet.
//!
//! Every limit bounds memory: a scene file of a hundred bytes can name a texture of hundreds of megabytes. Sides are
//! bounded beside these by what the formats and the rasteriser can address: targets by
//! [`MAX_DIMENSION`](crate::target::MAX_DIMENSION), textures by `scene::texture::MAX_TEXTURE_SIZE`.

/// Limits on inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of a scene file: 4 MiB.
    pub scene_bytes: u64,
    /// Bytes of a mesh or model file: 64 MiB.
    pub import_bytes: u64,
    /// Bytes of an image file: 256 MiB.
    pub image_bytes: u64,
    /// Texels of an image to be measured: 2^24, 4096 x 4096.
    pub image_texels: u64,
    /// Bytes of all targets of a scene: 1 GiB.
    pub target_bytes: u64,
    /// Bytes of all textures of a scene in memory, mip levels included: 1 GiB.
    pub texture_bytes: u64,
    /// Vertices of all meshes of a scene: 2^22.
    pub vertices: u64,
    /// Objects of a scene, those of its models included: 4096.
    pub objects: u64,
    /// Passes of a material: 16.
    pub passes: u64,
    /// Lights, textures, meshes, materials and models of a scene, of each: 256.
    pub entries: u64,
    /// Bytes of a line of a vector file: 256 MiB.
    pub line_bytes: u64,
    /// Layers of a stack whose error is bounded: 10,000,000.
    pub layers: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            scene_bytes: 4 << 20,
            import_bytes: 64 << 20,
            image_bytes: 256 << 20,
            image_texels: 1 << 24,
            target_bytes: 1 << 30,
            texture_bytes: 1 << 30,
            vertices: 1 << 22,
            objects: 4096,
            passes: 16,
            entries: 256,
            line_bytes: 256 << 20,
            layers: 10_000_000,
        }
    }
}

/// A setting that sets no limit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LimitError {
    /// Not `NAME=VALUE`.
    #[error("`{0}` sets no limit; write NAME=VALUE, e.g. texture-bytes=4G")]
    Syntax(String),
    /// No limit has this name.
    #[error("there is no limit `{0}`; use {names}", names = Limits::NAMES.join(", "))]
    Name(String),
    /// The value is no number.
    #[error("`{0}` is not a whole number, with K, M or G for powers of 1024 if wanted")]
    Value(String),
}

impl Limits {
    /// The names [`Limits::set`] takes.
    pub const NAMES: [&str; 12] = [
        "scene-bytes",
        "import-bytes",
        "image-bytes",
        "image-texels",
        "target-bytes",
        "texture-bytes",
        "vertices",
        "objects",
        "passes",
        "entries",
        "line-bytes",
        "layers",
    ];

    /// The limits with their names, in [`Limits::NAMES`]'s order.
    #[must_use]
    pub fn values(&self) -> [(&'static str, u64); 12] {
        let mut copy = *self;
        Self::NAMES.map(|name| (name, copy.named(name).map_or(0, |value| *value)))
    }

    /// Sets one limit from `NAME=VALUE`; K, M and G after the number stand for powers of 1024.
    ///
    /// # Errors
    /// [`LimitError`].
    pub fn set(&mut self, setting: &str) -> Result<(), LimitError> {
        let (name, value) = setting.split_once('=').ok_or_else(|| LimitError::Syntax(setting.to_owned()))?;
        let limit = self.named(name.trim()).ok_or_else(|| LimitError::Name(name.to_owned()))?;
        *limit = number(value.trim()).ok_or_else(|| LimitError::Value(value.to_owned()))?;
        Ok(())
    }

    fn named(&mut self, name: &str) -> Option<&mut u64> {
        Some(match name {
            "scene-bytes" => &mut self.scene_bytes,
            "import-bytes" => &mut self.import_bytes,
            "image-bytes" => &mut self.image_bytes,
            "image-texels" => &mut self.image_texels,
            "target-bytes" => &mut self.target_bytes,
            "texture-bytes" => &mut self.texture_bytes,
            "vertices" => &mut self.vertices,
            "objects" => &mut self.objects,
            "passes" => &mut self.passes,
            "entries" => &mut self.entries,
            "line-bytes" => &mut self.line_bytes,
            "layers" => &mut self.layers,
            _ => return None,
        })
    }
}

/// `12`, `4K`, `512M`, `2G`.
fn number(text: &str) -> Option<u64> {
    let (digits, shift) = match text.char_indices().next_back()? {
        (at, 'K' | 'k') => (&text[..at], 10),
        (at, 'M' | 'm') => (&text[..at], 20),
        (at, 'G' | 'g') => (&text[..at], 30),
        _ => (text, 0),
    };
    digits.parse::<u64>().ok()?.checked_mul(1 << shift)
}

/// The bytes of a file, or `None` where it has more than `limit`.
#[cfg(feature = "scene")]
pub(crate) fn read_file(path: &std::path::Path, limit: u64) -> std::io::Result<Option<Vec<u8>>> {
    use std::io::Read;
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_limit_has_a_name_a_default_and_can_be_set() {
        let mut limits = Limits::default();
        for (name, default) in limits.values() {
            assert!(default > 0, "{name} has a default");
            assert_eq!(limits.set(&format!("{name}=3K")), Ok(()), "{name} can be set");
        }
        assert!(limits.values().iter().all(|(_, value)| *value == 3072), "all set: {limits:?}");
    }

    #[test]
    fn settings_that_set_nothing_say_what_to_write() {
        let mut limits = Limits::default();
        let mut message = |setting: &str| limits.set(setting).expect_err(setting).to_string();
        assert!(message("texture-bytes").contains("NAME=VALUE"), "no value");
        assert!(message("textures=1").contains("texture-bytes"), "the names are listed");
        for value in ["", "x", "-1", "1.5G", "99999999999G"] {
            assert!(message(&format!("vertices={value}")).contains("whole number"), "{value}");
        }
        assert_eq!(limits, Limits::default(), "nothing is set");
    }
}
