//! Meshes on the card: sent once, for as long as they are in use.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::{Arc, Weak};

use eframe::wgpu;
use wgpu::util::DeviceExt;

use super::geometry::{Geometry, Shared};

/// A mesh on the card.
#[derive(Clone)]
pub struct OnCard {
    pub vertices: wgpu::Buffer,
    pub triangles: wgpu::Buffer,
    /// Sent when they are first drawn.
    pub edges: Option<wgpu::Buffer>,
}

/// All that was sent.
#[derive(Default)]
pub struct Buffers {
    meshes: HashMap<usize, (Weak<Geometry>, OnCard)>,
    values: HashMap<usize, (Weak<Vec<f32>>, wgpu::Buffer)>,
}

impl Buffers {
    /// Drops what is no longer in use.
    pub fn tidy(&mut self) {
        self.meshes.retain(|_, (mesh, _)| mesh.strong_count() > 0);
        self.values.retain(|_, (values, _)| values.strong_count() > 0);
    }

    /// The mesh on the card; `None` where the card has no buffer of that size.
    pub fn mesh(&mut self, device: &wgpu::Device, mesh: &Shared<Geometry>, edges: bool) -> Option<OnCard> {
        let key = Arc::as_ptr(&mesh.0) as usize;
        let index = wgpu::BufferUsages::INDEX;
        let (_, on_card) = match self.meshes.entry(key) {
            Entry::Occupied(there) => there.into_mut(),
            Entry::Vacant(place) => {
                let vertices = send(device, bytemuck::cast_slice(&mesh.vertices), wgpu::BufferUsages::VERTEX)?;
                let triangles = send(device, bytemuck::cast_slice(&mesh.triangles), index)?;
                place.insert((Arc::downgrade(&mesh.0), OnCard { vertices, triangles, edges: None }))
            }
        };
        if edges && on_card.edges.is_none() {
            on_card.edges = send(device, bytemuck::cast_slice(&mesh.edges), index);
        }
        Some(on_card.clone())
    }

    /// The values on the card.
    pub fn values(&mut self, device: &wgpu::Device, values: &Shared<Vec<f32>>) -> Option<wgpu::Buffer> {
        let key = Arc::as_ptr(&values.0) as usize;
        if let Some((_, buffer)) = self.values.get(&key) {
            return Some(buffer.clone());
        }
        // NaN does not survive every card; the shader knows huge numbers.
        let told: Vec<f32> = values.iter().map(|value| if value.is_nan() { 1e30 } else { *value }).collect();
        let buffer = send(device, bytemuck::cast_slice(&told), wgpu::BufferUsages::VERTEX)?;
        self.values.insert(key, (Arc::downgrade(&values.0), buffer.clone()));
        Some(buffer)
    }
}

fn send(device: &wgpu::Device, contents: &[u8], usage: wgpu::BufferUsages) -> Option<wgpu::Buffer> {
    let fits = !contents.is_empty() && contents.len() as u64 <= device.limits().max_buffer_size;
    fits.then(|| device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("mesh"), contents, usage }))
}
