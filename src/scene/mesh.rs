//! Meshes: convex planar faces with normals and texture coordinates.

use glam::{DVec2, DVec3};

/// Vertices a mesh may have.
pub const MAX_VERTICES: usize = 1 << 20;

/// A vertex in object space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshVertex {
    /// Position.
    pub position: DVec3,
    /// Outward normal, unit length.
    pub normal: DVec3,
    /// Texture coordinates, (0, 0) at the image's top left corner.
    pub uv: DVec2,
}

/// A mesh in object space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The vertices.
    pub vertices: Vec<MeshVertex>,
    /// Convex planar polygons, counter-clockwise seen from outside, as indices below `vertices.len()`.
    pub faces: Vec<Vec<u32>>,
}

impl Mesh {
    /// A unit square in the xy plane around the origin, facing +z.
    #[must_use]
    pub fn quad() -> Self {
        let mut mesh = Self::default();
        mesh.push_square(DVec3::ZERO, DVec3::X * 0.5, DVec3::Y * 0.5);
        mesh
    }

    /// A unit cube around the origin, each face with the whole texture.
    #[must_use]
    pub fn cube() -> Self {
        let mut mesh = Self::default();
        for (normal, right) in [
            (DVec3::Z, DVec3::X),
            (DVec3::NEG_Z, DVec3::NEG_X),
            (DVec3::X, DVec3::NEG_Z),
            (DVec3::NEG_X, DVec3::Z),
            (DVec3::Y, DVec3::X),
            (DVec3::NEG_Y, DVec3::X),
        ] {
            mesh.push_square(normal * 0.5, right * 0.5, normal.cross(right) * 0.5);
        }
        mesh
    }

    /// A sphere of diameter 1 around the origin: `segments` around the y axis, half as many rings; at least 4.
    #[must_use]
    pub fn sphere(segments: u32) -> Self {
        let segments = segments.max(4);
        let rings = segments / 2;
        let mut mesh = Self::default();
        for ring in 0..=rings {
            let v = f64::from(ring) / f64::from(rings);
            // Exact poles and an exact seam: the surface must close.
            let (ring_radius, y) = match ring {
                0 => (0.0, 1.0),
                _ if ring == rings => (0.0, -1.0),
                _ => (v * std::f64::consts::PI).sin_cos(),
            };
            for segment in 0..=segments {
                let u = f64::from(segment) / f64::from(segments);
                let turn = f64::from(segment % segments) / f64::from(segments);
                let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
                let normal = DVec3::new(ring_radius * sin, y, ring_radius * cos);
                mesh.vertices.push(MeshVertex { position: normal * 0.5, normal, uv: DVec2::new(u, v) });
            }
        }
        let row = segments + 1;
        for ring in 0..rings {
            for segment in 0..segments {
                let [a, b] = [ring * row + segment, ring * row + segment + 1];
                let [c, d] = [a + row, b + row];
                // Triangles, since the four corners need not be planar; at the poles one of them has no area.
                if ring > 0 {
                    mesh.faces.push(vec![a, c, b]);
                }
                if ring + 1 < rings {
                    mesh.faces.push(vec![b, c, d]);
                }
            }
        }
        mesh
    }

    /// A square given by its middle and the ways to its right and upper sides.
    fn push_square(&mut self, middle: DVec3, right: DVec3, up: DVec3) {
        let normal = right.cross(up).normalize();
        let start = u32::try_from(self.vertices.len()).unwrap_or(u32::MAX);
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let uv = DVec2::new((x + 1.0) / 2.0, (1.0 - y) / 2.0);
            self.vertices.push(MeshVertex { position: middle + right * x + up * y, normal, uv });
        }
        self.faces.push((start..start + 4).collect());
    }

    /// A triangle by position, normal and texture coordinates; missing normals are the triangle's own, and one without
    /// area is left out.
    #[cfg(feature = "meshes")]
    pub(super) fn push_triangle(&mut self, corners: [(DVec3, Option<DVec3>, DVec2); 3]) {
        let [a, b, c] = corners.map(|(position, ..)| position);
        let Some(across) = (b - a).cross(c - a).try_normalize() else { return };
        let start = u32::try_from(self.vertices.len()).unwrap_or(u32::MAX);
        for (position, normal, uv) in corners {
            self.vertices.push(MeshVertex { position, normal: normal.unwrap_or(across), uv });
        }
        self.faces.push(vec![start, start + 1, start + 2]);
    }

    /// The faces as triangles, fanned from each face's first vertex.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.faces.iter().flat_map(|face| {
            let (first, rest) = face.split_first().map_or((0, [].as_slice()), |(first, rest)| (*first, rest));
            rest.windows(2).map(move |pair| [first, pair[0], pair[1]])
        })
    }

    /// Middle of the bounding box: what sorting takes for the place of the object.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        let positions = || self.vertices.iter().map(|vertex| vertex.position);
        match (positions().reduce(DVec3::min), positions().reduce(DVec3::max)) {
            (Some(min), Some(max)) => (min + max) / 2.0,
            _ => DVec3::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_planar_and_counter_clockwise_seen_from_outside() {
        for (name, mesh) in [("quad", Mesh::quad()), ("cube", Mesh::cube()), ("sphere", Mesh::sphere(12))] {
            for [a, b, c] in mesh.triangles() {
                let [a, b, c] = [a, b, c].map(|i| mesh.vertices[i as usize]);
                let across = (b.position - a.position).cross(c.position - a.position);
                assert!(across.dot(a.normal + b.normal + c.normal) > 0.0, "{name}: {a:?} {b:?} {c:?}");
            }
            assert!(mesh.centre().length() < 1e-12, "{name} lies around the origin");
        }
    }

    #[test]
    fn closed_meshes_use_every_edge_once_in_each_direction() {
        for (name, mesh) in [("cube", Mesh::cube()), ("sphere", Mesh::sphere(8))] {
            let key = |i: u32| mesh.vertices[i as usize].position.to_array().map(|x| (x + 0.0).to_bits());
            let mut edges = std::collections::BTreeMap::new();
            for face in &mesh.faces {
                for i in 0..face.len() {
                    *edges.entry((key(face[i]), key(face[(i + 1) % face.len()]))).or_insert(0) += 1;
                }
            }
            for ((from, to), count) in &edges {
                assert_eq!(*count, 1, "{name}: edge {from:?} to {to:?}");
                assert!(edges.contains_key(&(*to, *from)), "{name}: {from:?} to {to:?} is a border");
            }
        }
    }
}
