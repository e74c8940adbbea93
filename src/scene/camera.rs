//! Cameras: where a scene is seen from, and the matrices that follow.
//!
//! Right-handed world, looking along -z in view space; clip space as WebGPU has it: `-w <= x, y <= w`, y up,
//! `0 <= z <= w`. Matrices are binary64, so that clip positions, rounded to binary32 once, do not depend on the
//! machine's float unit.

use glam::dcamera::rh::proj::directx;
use glam::dcamera::rh::view;
use glam::{DMat4, DVec3};

/// What a camera's view volume looks like. Distances in world units, `0 < near < far`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Things shrink with distance.
    Perspective {
        /// Vertical opening angle in degrees, between 0 and 180.
        fov_y: f64,
    },
    /// Things keep their size.
    Orthographic {
        /// Height of the view volume in world units.
        height: f64,
    },
}

/// A camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Its position.
    pub eye: DVec3,
    /// What it looks at; not `eye`.
    pub target: DVec3,
    /// A direction that appears upright; not along the view direction.
    pub up: DVec3,
    /// Its view volume.
    pub projection: Projection,
    /// Distance of the near plane.
    pub near: f64,
    /// Distance of the far plane.
    pub far: f64,
    /// Whether depth runs from 1 at the near plane to 0 at the far plane.
    pub reversed: bool,
}

impl Camera {
    /// World space to clip space for a target of `width / height = aspect`.
    #[must_use]
    pub fn view_projection(&self, aspect: f64) -> DMat4 {
        // Swapped planes reverse depth.
        let (near, far) = if self.reversed { (self.far, self.near) } else { (self.near, self.far) };
        let projection = match self.projection {
            Projection::Perspective { fov_y } => directx::perspective(fov_y.to_radians(), aspect, near, far),
            Projection::Orthographic { height } => {
                let (x, y) = (height * aspect / 2.0, height / 2.0);
                directx::orthographic(-x, x, -y, y, near, far)
            }
        };
        projection * view::look_at_mat4(self.eye, self.target, self.up.normalize())
    }

    /// The key transparent objects are sorted by: squared distance from the eye, or depth along the view direction
    /// for an orthographic camera, to which all distances look alike.
    #[must_use]
    pub fn sort_key(&self, centre: DVec3) -> f64 {
        match self.projection {
            Projection::Perspective { .. } => centre.distance_squared(self.eye),
            Projection::Orthographic { .. } => (centre - self.eye).dot((self.target - self.eye).normalize()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(projection: Projection, reversed: bool) -> Camera {
        let (eye, target) = (DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO);
        Camera { eye, target, up: DVec3::Y, projection, near: 1.0, far: 9.0, reversed }
    }

    #[test]
    fn near_and_far_planes_reach_the_ends_of_the_depth_range() {
        for projection in [Projection::Perspective { fov_y: 60.0 }, Projection::Orthographic { height: 2.0 }] {
            for (reversed, ends) in [(false, [0.0, 1.0]), (true, [1.0, 0.0])] {
                let matrix = camera(projection, reversed).view_projection(1.0);
                for (z, depth) in [4.0, -4.0].into_iter().zip(ends) {
                    let got = matrix.project_point3(DVec3::new(0.0, 0.0, z)).z;
                    assert!((got - depth).abs() < 1e-12, "{projection:?}, reversed {reversed}: z {z} at depth {got}");
                }
            }
        }
    }

    #[test]
    fn the_vertical_opening_angle_reaches_the_upper_edge() {
        let matrix = camera(Projection::Perspective { fov_y: 90.0 }, false).view_projection(2.0);
        let corner = matrix.project_point3(DVec3::new(10.0, 5.0, 0.0));
        assert!((corner.x - 1.0).abs() < 1e-12 && (corner.y - 1.0).abs() < 1e-12, "corner at {corner}");
    }

    #[test]
    fn sort_key_grows_with_distance_or_depth() {
        let (near, far) = (DVec3::new(0.0, 0.0, 1.0), DVec3::new(3.0, 0.0, 0.0));
        for projection in [Projection::Perspective { fov_y: 60.0 }, Projection::Orthographic { height: 2.0 }] {
            let camera = camera(projection, false);
            assert!(camera.sort_key(near) < camera.sort_key(far), "{projection:?}");
        }
    }
}
