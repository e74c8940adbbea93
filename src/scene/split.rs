//! Splitting blended faces where they cross, so that a drawing order exists: a binary space partition.
//!
//! Two faces that cross, or three that overlap in a ring, have no right order as a whole; their parts on either side of
//! each other's planes do. Source: Fuchs, Kedem and Naylor, *On Visible Surface Generation by A Priori Tree Structures*,
//! 1980.

use glam::DVec3;

use super::camera::{Camera, Projection};
use super::draw::{Item, Polygon};
use super::mesh::MeshVertex;

/// Faces a split scene may have before splitting: the tree may grow with the square of it.
const MAX_FACES: usize = 4096;

/// Distance below which a point lies on a plane, relative to the largest coordinate.
const ON_PLANE: f64 = 1e-9;

/// A face and the index of its item.
struct Part {
    item: usize,
    face: Polygon,
}

/// A plane of the tree with the faces in it, and what lies on either side.
struct Node {
    origin: DVec3,
    normal: DVec3,
    on: Vec<Part>,
    behind: Vec<Part>,
    front: Vec<Part>,
}

/// The items with all blended ones replaced by parts, back to front; the others stay as they are, first.
///
/// Scenes with more than [`MAX_FACES`] blended faces are returned unsplit.
pub(super) fn split(items: Vec<Item>, camera: &Camera) -> Vec<Item> {
    let (blended, mut drawn): (Vec<_>, Vec<_>) = items.into_iter().partition(|item| item.key.queue.is_transparent());
    let parts = |(item, contents): (usize, &Item)| {
        contents.polygons.iter().map(|face| Part { item, face: face.clone() }).collect::<Vec<_>>()
    };
    let parts: Vec<Part> = blended.iter().enumerate().flat_map(parts).collect();
    if parts.len() > MAX_FACES {
        drawn.extend(blended);
        return drawn;
    }
    let mut count = vec![0; blended.len()];
    for part in back_to_front(parts, camera) {
        let item = &blended[part.item];
        count[part.item] += 1;
        drawn.push(Item {
            name: format!("{} part {}", item.name, count[part.item]),
            key: item.key,
            material: item.material.clone(),
            passes: item.passes.clone(),
            polygons: vec![part.face],
            mirrored: item.mirrored,
        });
    }
    drawn
}

/// The parts of all faces, each behind none that comes before it. Depth-first, without recursion.
fn back_to_front(parts: Vec<Part>, camera: &Camera) -> Vec<Part> {
    enum Step {
        Divide(Vec<Part>),
        Emit(Vec<Part>),
    }
    let (mut steps, mut drawn) = (vec![Step::Divide(parts)], Vec::new());
    while let Some(step) = steps.pop() {
        match step {
            Step::Emit(parts) => drawn.extend(parts),
            Step::Divide(parts) => {
                let Some(node) = Node::new(parts) else { continue };
                let (far, near) =
                    if node.faces(camera) { (node.behind, node.front) } else { (node.front, node.behind) };
                steps.extend([Step::Divide(near), Step::Emit(node.on), Step::Divide(far)]);
            }
        }
    }
    drawn
}

impl Node {
    /// Divides all parts by the plane of the first; `None` without parts.
    fn new(parts: Vec<Part>) -> Option<Self> {
        let first = parts.first()?;
        let [a, b, c] = std::array::from_fn(|i| first.face.0.get(i).map_or(DVec3::ZERO, |vertex| vertex.position));
        let normal = (b - a).cross(c - a).try_normalize();
        let mut node = Self {
            origin: a,
            normal: normal.unwrap_or(DVec3::Z),
            on: Vec::new(),
            behind: Vec::new(),
            front: Vec::new(),
        };
        let mut parts = parts.into_iter();
        // The dividing face lies in its plane whatever rounding says: every step uses up at least one.
        node.on.extend(parts.next());
        parts.for_each(|part| node.place(part));
        Some(node)
    }

    /// Whether the camera sees the front side of the plane.
    fn faces(&self, camera: &Camera) -> bool {
        match camera.projection {
            Projection::Perspective { .. } => (camera.eye - self.origin).dot(self.normal) > 0.0,
            Projection::Orthographic { .. } => (camera.eye - camera.target).dot(self.normal) > 0.0,
        }
    }

    /// Puts a part on its side of the plane, or cuts it.
    fn place(&mut self, part: Part) {
        let size = part.face.0.iter().map(|vertex| vertex.position.abs().max_element()).fold(1.0, f64::max);
        let distance = |vertex: &MeshVertex| {
            let d = (vertex.position - self.origin).dot(self.normal);
            if d.abs() <= ON_PLANE * size { 0.0 } else { d }
        };
        let distances: Vec<f64> = part.face.0.iter().map(distance).collect();
        match (distances.iter().any(|&d| d < 0.0), distances.iter().any(|&d| d > 0.0)) {
            (false, false) => self.on.push(part),
            (true, false) => self.behind.push(part),
            (false, true) => self.front.push(part),
            (true, true) => {
                let [behind, front] = cut(&part.face, &distances);
                self.behind.push(Part { item: part.item, face: behind });
                self.front.push(Part { item: part.item, face: front });
            }
        }
    }
}

/// The parts of a convex face with negative and with positive distances; both get the same new vertices.
fn cut(face: &Polygon, distances: &[f64]) -> [Polygon; 2] {
    let mut sides = [Polygon(Vec::new()), Polygon(Vec::new())];
    for (i, vertex) in face.0.iter().enumerate() {
        let j = (i + 1) % face.0.len();
        let (here, there) = (distances[i], distances[j]);
        if here <= 0.0 {
            sides[0].0.push(*vertex);
        }
        if here >= 0.0 {
            sides[1].0.push(*vertex);
        }
        if here * there < 0.0 {
            // From the negative end, whichever way the edge runs.
            let (from, to, t) = if here < 0.0 {
                (vertex, &face.0[j], here / (here - there))
            } else {
                (&face.0[j], vertex, there / (there - here))
            };
            let between = MeshVertex {
                position: from.position.lerp(to.position, t),
                normal: from.normal.lerp(to.normal, t),
                uv: from.uv.lerp(to.uv, t),
            };
            sides.iter_mut().for_each(|side| side.0.push(between));
        }
    }
    sides
}
