//! A scene as an ordered list of draws: which triangles, in which order, with what state.

use std::sync::Arc;

use glam::{DAffine3, DMat4, DVec3};
use wgpu_types::{FrontFace, PrimitiveState};

use super::description::{Object, Order, Scene};
use super::material::{Keywords, Material, Pass, Shader};
use super::mesh::MeshVertex;
use super::number::{f64_to_f32, i64_to_f64};
use super::queue::{SortKey, drawing_order};
use super::raster::{RasterState, Vertex};
use crate::format::DepthFormat;
use crate::state::MergerState;

/// Interpolated values of a scene's vertices: texture coordinates (2), world normal (3), world position (3).
pub const VARYINGS: usize = 8;

/// A vertex after the vertex shader: what a real driver's rasteriser would be given.
pub type SceneVertex = Vertex<VARYINGS>;

/// One draw call.
#[derive(Clone, Debug)]
pub struct Draw {
    /// Name of the object.
    pub object: String,
    /// Name of the pass.
    pub pass: String,
    /// What decided its place in the order.
    pub key: SortKey,
    /// The material, as this draw sees it.
    pub material: Arc<Material>,
    /// What the fragment shader computes.
    pub shader: Shader,
    /// What it needs for that.
    pub keywords: Keywords,
    /// Index of the light a [`Shader::Light`] pass adds.
    pub light: usize,
    /// State of the output merger.
    pub state: MergerState,
    /// State of the rasteriser.
    pub raster: RasterState,
    /// The triangles in clip space, in order.
    pub triangles: Arc<Vec<[SceneVertex; 3]>>,
}

/// An object with what the drawing order needs to know.
pub(super) struct Item {
    pub(super) name: String,
    pub(super) key: SortKey,
    pub(super) material: Arc<Material>,
    pub(super) passes: Vec<Pass>,
    pub(super) polygons: Vec<Polygon>,
    /// Whether the transform mirrors: front faces then turn the other way.
    pub(super) mirrored: bool,
}

/// A convex planar face in world space.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polygon(pub(super) Vec<MeshVertex>);

impl Scene {
    /// The draws in order: objects by queue and distance, the passes of an object one after the other.
    #[must_use]
    pub fn draws(&self) -> Vec<Draw> {
        let items: Vec<Item> = self.objects.iter().filter_map(|object| self.item(object)).collect();
        let ordered = match self.order {
            Order::Listed => items,
            Order::Queue => sort(items),
            Order::Split => super::split::split(sort(items), &self.camera),
        };
        let extent = self.target.extent;
        let aspect = i64_to_f64(i64::from(extent.width)) / i64_to_f64(i64::from(extent.height));
        let matrix = self.camera.view_projection(aspect);
        ordered.iter().flat_map(|item| self.item_draws(item, &matrix)).collect()
    }

    /// An object in world space with its material and passes; `None` where replacement shading leaves it out.
    fn item(&self, object: &Object) -> Option<Item> {
        let mut material = self.materials[object.material].clone();
        let mut passes = material.passes();
        if let Some(replacement) = &self.replacement {
            if material.render_type() == replacement.render_type {
                let [r, g, b] = replacement.color;
                material.tint = [r, g, b, material.tint[3]];
                passes =
                    vec![Pass { shader: Shader::Flat, name: "replacement".to_owned(), ..Pass::base(material.mode) }];
            } else if !replacement.keep_others {
                return None;
            }
        }
        let mesh = &self.meshes[object.mesh];
        let vertices: Vec<_> = mesh.vertices.iter().map(|vertex| to_world(vertex, &object.transform)).collect();
        let polygon = |face: &Vec<u32>| Polygon(face.iter().map(|&i| vertices[i as usize]).collect());
        Some(Item {
            name: object.name.clone(),
            key: self.sort_key(object),
            material: Arc::new(material),
            passes,
            polygons: mesh.faces.iter().map(polygon).collect(),
            mirrored: object.transform.matrix3.determinant() < 0.0,
        })
    }

    fn item_draws(&self, item: &Item, matrix: &DMat4) -> Vec<Draw> {
        let triangles: Arc<Vec<_>> = Arc::new(item.polygons.iter().flat_map(|face| face.triangles(matrix)).collect());
        let further_lights = || 1..self.lighting.lights.len().max(1);
        let repeat = |pass: &Pass| if pass.shader == Shader::Light { further_lights() } else { 0..1 };
        let mut draws = Vec::new();
        for pass in &item.passes {
            draws.extend(repeat(pass).map(|light| self.draw(item, pass, light, Arc::clone(&triangles))));
        }
        draws
    }

    fn draw(&self, item: &Item, pass: &Pass, light: usize, triangles: Arc<Vec<[SceneVertex; 3]>>) -> Draw {
        let formats: Vec<_> = self.target.colors.iter().map(|color| color.format.texture_format()).collect();
        let depth = self.target.depth.map(|depth| depth.format);
        let mut state = pass.state.to_merger_state(&formats, depth);
        state.dynamic.blend_constant = pass.blend_constant;
        let front_face = if item.mirrored { FrontFace::Cw } else { FrontFace::Ccw };
        let raster = RasterState {
            extent: self.target.extent,
            depth_range: state.dynamic.depth_range,
            primitive: PrimitiveState { front_face, cull_mode: pass.state.cull, ..PrimitiveState::default() },
            bias: pass.state.depth_bias,
            depth: depth.and_then(|format| DepthFormat::new(format).ok()).and_then(DepthFormat::depth),
            subpixel_bits: self.target.subpixel_bits,
            rasteriser: self.target.rasteriser,
            guard_band: depth.is_none() && self.target.rasteriser.has_guard_band(self.target.single_format()),
        };
        Draw {
            object: item.name.clone(),
            pass: pass.name.clone(),
            key: item.key,
            keywords: Keywords::new(&item.material, pass, formats.len()),
            material: Arc::clone(&item.material),
            shader: pass.shader,
            light,
            state,
            raster,
            triangles,
        }
    }
}

fn sort(items: Vec<Item>) -> Vec<Item> {
    let keys: Vec<_> = items.iter().map(|item| item.key).collect();
    let mut items: Vec<_> = items.into_iter().map(Some).collect();
    drawing_order(&keys).into_iter().filter_map(|i| items[i].take()).collect()
}

fn to_world(vertex: &MeshVertex, transform: &DAffine3) -> MeshVertex {
    // Normals go with the inverse transpose; a mirrored object keeps its normals pointing outwards.
    let normal = transform.matrix3.inverse().transpose() * vertex.normal;
    MeshVertex {
        position: transform.transform_point3(vertex.position),
        normal: normal.try_normalize().unwrap_or(DVec3::Z),
        uv: vertex.uv,
    }
}

impl Polygon {
    /// The face fanned into triangles of clip space.
    fn triangles(&self, matrix: &DMat4) -> impl Iterator<Item = [SceneVertex; 3]> {
        let vertices: Vec<SceneVertex> = self.0.iter().map(|vertex| to_clip(vertex, matrix)).collect();
        (2..vertices.len()).map(move |i| [vertices[0], vertices[i - 1], vertices[i]])
    }
}

/// The vertex shader: binary64, every result rounded to binary32 once.
fn to_clip(vertex: &MeshVertex, matrix: &DMat4) -> SceneVertex {
    let (normal, position) = (vertex.normal, vertex.position);
    let varyings = [vertex.uv.x, vertex.uv.y, normal.x, normal.y, normal.z, position.x, position.y, position.z];
    SceneVertex {
        position: (*matrix * position.extend(1.0)).to_array().map(f64_to_f32),
        varyings: varyings.map(f64_to_f32),
    }
}
