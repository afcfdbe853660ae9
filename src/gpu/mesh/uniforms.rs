//! The numbers that the shader gets with every layer.

use nalgebra::Matrix4;

use super::scene::{LayerDrawing, Scene, Shading};
use crate::gpu::ColourMap;

/// Mirrors `struct Layer` of `mesh.wgsl`, field by field.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Uniforms {
    clip_from_local: [[f32; 4]; 4],
    world_from_local: [[f32; 4]; 4],
    view_from_world: [[f32; 4]; 4],
    eye: [f32; 4],
    lamp: [f32; 4],
    base: [f32; 4],
    line: [f32; 4],
    plane: [f32; 4],
    plane_colour: [f32; 4],
    range: [f32; 2],
    map: u32,
    shading: u32,
}

impl Uniforms {
    /// Of one layer of a scene. Matrices are multiplied in f64: a mesh far from the origin does not tremble.
    pub fn new(scene: &Scene, layer: &LayerDrawing) -> Self {
        let to_centre = nalgebra::Translation3::from(layer.geometry.centre.coords);
        let world_from_local = (layer.world_from_mesh * to_centre).to_homogeneous();
        let axes = scene.frame.axes();
        let view = Matrix4::from_fn(|row, column| match (axes.get(row), column) {
            (Some(axis), 0..3) => axis[column],
            _ => f64::from(u8::from(row == column)),
        });
        let (range, map) = match layer.shading {
            Shading::Height(range) => (range, ColourMap::Viridis),
            Shading::Distance(largest) => ([-largest, largest], ColourMap::Signed),
            _ => ([0.0, 1.0], ColourMap::Grey),
        };
        let opaque = |colour: [f32; 3], fourth: f32| [colour[0], colour[1], colour[2], fourth];
        let (plane, plane_colour) = scene.plane.map_or(([0.0; 4], [0.0; 4]), |plane| {
            let [x, y, z] = plane.normal.map(|component| component as f32);
            ([x, y, z, plane.offset as f32], opaque(plane.colour, plane.half_width_px))
        });
        Self {
            clip_from_local: single(&(scene.frame.clip_from_world() * world_from_local)),
            world_from_local: single(&world_from_local),
            view_from_world: single(&view),
            eye: scene.frame.eye().map(|component| component as f32),
            lamp: match layer.shading {
                Shading::Lamp(lamp) => lamp,
                _ => [0.0, 0.0, 1.0, 0.0],
            },
            base: layer.base.map_or([0.0; 4], |colour| opaque(colour, 1.0)),
            line: layer.wire.unwrap_or_default(),
            plane,
            plane_colour,
            range,
            map: map as u32,
            shading: layer.shading.number(),
        }
    }
}

fn single(matrix: &Matrix4<f64>) -> [[f32; 4]; 4] {
    matrix.cast::<f32>().into()
}
