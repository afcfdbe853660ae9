//! A mesh as the card takes it: made once, off the UI thread.

use std::ops::Deref;
use std::sync::Arc;

use firstbounce_core::Mesh;
use firstbounce_core::image::colour::srgb_from_linear;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::Bounds;

/// A vertex on the card. Positions are relative to the centre of the geometry.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    position: [f32; 3],
    /// Signed, 32767 for 1; the fourth fills up.
    normal: [i16; 4],
    /// sRGB-encoded; the fourth is 255 where the mesh has colours.
    colour: [u8; 4],
}

/// A mesh as the card takes it.
pub struct Geometry {
    pub(super) vertices: Vec<Vertex>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Every edge once.
    pub(super) edges: Vec<[u32; 2]>,
    /// Origin of the vertices.
    pub(super) centre: Point3<f64>,
    /// Around all of it.
    pub bounds: Bounds,
    /// Whether the vertices have colours of their own.
    pub has_colours: bool,
    /// The mean length of an edge.
    pub edge_length: f64,
}

impl Geometry {
    /// Takes a mesh; `None` for one without vertices. Normals that it lacks are computed from its triangles.
    pub fn new(mesh: &Mesh) -> Option<Self> {
        let (low, high) = mesh.bounds()?;
        let bounds = Bounds::new(low.cast(), high.cast());
        let computed = if mesh.normals.is_empty() { mesh.area_weighted_normals() } else { Vec::new() };
        let normals = if mesh.normals.is_empty() { &computed } else { &mesh.normals };
        let edges = edges(&mesh.triangles);
        let vertex = |(index, position): (usize, &Point3<f32>)| Vertex {
            position: (position.cast::<f64>() - bounds.centre()).cast::<f32>().into(),
            normal: packed(normals.get(index).copied().unwrap_or_else(Vector3::z)),
            colour: mesh.colours.get(index).map_or([0; 4], |colour| {
                let [r, g, b] = colour.map(|channel| (255.0 * srgb_from_linear(channel.clamp(0.0, 1.0))).round() as u8);
                [r, g, b, 255]
            }),
        };
        Some(Self {
            vertices: mesh.positions.par_iter().enumerate().map(vertex).collect(),
            edge_length: edge_length(mesh, &edges),
            edges,
            triangles: mesh.triangles.clone(),
            centre: bounds.centre(),
            bounds,
            has_colours: !mesh.colours.is_empty(),
        })
    }

    /// How many vertices there are.
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }
}

fn packed(normal: Vector3<f32>) -> [i16; 4] {
    let unit = normal.try_normalize(0.0).unwrap_or_else(Vector3::z);
    let [x, y, z] = <[f32; 3]>::from(unit).map(|component| (32767.0 * component).round() as i16);
    [x, y, z, 0]
}

fn edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = triangles
        .par_iter()
        .flat_map_iter(|&[a, b, c]| [(a, b), (b, c), (c, a)].map(|(from, to)| [from.min(to), from.max(to)]))
        .collect();
    edges.par_sort_unstable();
    edges.dedup();
    edges
}

fn edge_length(mesh: &Mesh, edges: &[[u32; 2]]) -> f64 {
    let at = |vertex: u32| mesh.positions.get(vertex as usize).copied().unwrap_or_default();
    let sum: f64 = edges.par_iter().map(|&[a, b]| f64::from((at(a) - at(b)).norm())).sum();
    sum / edges.len().max(1) as f64
}

/// Something shared that is equal to itself alone: comparing it is comparing its address.
#[derive(Debug)]
pub struct Shared<T>(pub Arc<T>);

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<T> PartialEq for Shared<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl<T> Deref for Shared<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}
