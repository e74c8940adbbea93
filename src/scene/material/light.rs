//! Light: ambient, Lambert, a specular highlight, and the metallic workflow.
//!
//! binary32 with sums, products, quotients and square roots only, left to right as written: a GPU that does the same
//! gets the same bits.

use glam::Vec3;

/// Reflectivity of a dielectric seen head-on.
pub const DIELECTRIC_SPECULAR: f32 = 0.04;

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// From infinitely far away.
    Directional {
        /// Towards the light, unit length.
        toward: Vec3,
        /// Linear RGB.
        color: Vec3,
    },
    /// From a point; falls off as `max(1 - d^2 / range^2, 0)^2`.
    Point {
        /// Where it is, in world space.
        position: Vec3,
        /// Linear RGB.
        color: Vec3,
        /// Distance at which it ends, world units.
        range: f32,
    },
}

/// All light of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lighting {
    /// Light from everywhere, linear RGB.
    pub ambient: Vec3,
    /// The lights; the first is the main light, which base passes use.
    pub lights: Vec<Light>,
}

/// A surface point that is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LitPoint {
    /// World position.
    pub(super) position: Vec3,
    /// Unit normal, towards the viewer's side.
    pub(super) normal: Vec3,
    /// Unit vector to the viewer.
    pub(super) view: Vec3,
    /// `(1 - smoothness)^2`, the GGX roughness before squaring.
    pub(super) roughness: f32,
}

impl Light {
    /// Diffuse and specular light that leaves the point towards the viewer, for a white surface.
    pub(super) fn reflect(&self, point: &LitPoint) -> [Vec3; 2] {
        let (toward, radiance) = match *self {
            Self::Directional { toward, color } => (toward, color),
            Self::Point { position, color, range } => {
                let offset = position - point.position;
                let squared = offset.dot(offset);
                let fall = (1.0 - squared / (range * range)).max(0.0);
                (offset.try_normalize().unwrap_or(point.normal), color * (fall * fall))
            }
        };
        let lambert = point.normal.dot(toward).max(0.0);
        let diffuse = radiance * lambert;
        [diffuse, diffuse * specular(point, toward)]
    }
}

/// A highlight that needs no power function: GGX with the visibility term folded into one quotient,
/// `r^2 / (4 ((n.h)^2 (r^2 - 1) + 1)^2 max(0.1, (l.h)^2) (r + 1/2))`. Source: Karis and others, *Optimizing PBR*,
/// SIGGRAPH 2015, the mobile approximation.
fn specular(point: &LitPoint, toward: Vec3) -> f32 {
    let half = (toward + point.view).try_normalize().unwrap_or(point.normal);
    let n_h = point.normal.dot(half).max(0.0);
    let l_h = toward.dot(half).max(0.0);
    let r = point.roughness.max(0.002);
    let spread = n_h * n_h * (r * r - 1.0) + 1.0;
    r * r / (4.0 * spread * spread * (l_h * l_h).max(0.1) * (r + 0.5))
}

/// What the metallic workflow makes of an albedo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reflectance {
    /// Diffuse albedo.
    pub(super) diffuse: Vec3,
    /// Specular color.
    pub(super) specular: Vec3,
}

/// The share of light that is not reflected, whatever the albedo: 0.96 for dielectrics, 0 for metals.
pub(super) fn one_minus_reflectivity(metallic: f32) -> f32 {
    (1.0 - DIELECTRIC_SPECULAR) * (1.0 - metallic)
}

/// Splits an albedo: metals reflect their color and diffuse nothing, dielectrics reflect 4 %.
pub(super) fn diffuse_and_specular_from_metallic(albedo: Vec3, metallic: f32) -> Reflectance {
    let dielectric = Vec3::splat(DIELECTRIC_SPECULAR);
    Reflectance {
        diffuse: albedo * one_minus_reflectivity(metallic),
        specular: dielectric + (albedo - dielectric) * metallic,
    }
}
