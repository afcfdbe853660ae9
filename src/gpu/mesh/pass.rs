//! Draws a scene into a texture of its own, with depth and several samples a pixel, and lays it into the window. egui's own
//! pass has neither.

use eframe::wgpu;
use wgpu::util::DeviceExt;

use super::buffers::Buffers;
use super::pipelines::{COLOUR, DEPTH, Pipelines};
use super::scene::{LayerDrawing, Scene};
use super::uniforms::Uniforms;
use crate::gpu::ColourMap;

/// Samples a pixel, where the card can.
const SAMPLES: u32 = 4;

/// The 3D view on one graphics card.
pub struct MeshGpu {
    device: wgpu::Device,
    pipelines: Pipelines,
    colour_maps: wgpu::TextureView,
    buffers: Buffers,
    samples: u32,
}

/// A picture that was drawn, and what it shows.
pub struct Picture {
    scene: Scene,
    /// What the window shows.
    pub colour: wgpu::Texture,
    resolved: wgpu::TextureView,
    sampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
}

/// A picture at its place in the window.
pub struct Laid {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
}

impl Laid {
    /// Draws over the whole viewport of the pass.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl MeshGpu {
    /// For windows of the given format, which must not encode by itself.
    pub fn new(
        adapter: &wgpu::Adapter,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        target: wgpu::TextureFormat,
    ) -> Self {
        let can = |format| adapter.get_texture_format_features(format).flags.sample_count_supported(SAMPLES);
        let samples = if can(COLOUR) && can(DEPTH) { SAMPLES } else { 1 };
        let maps: Vec<u8> =
            ColourMap::ALL.iter().flat_map(|map| map.table()).flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        let descriptor = texture("colour maps", COLOUR, [256, ColourMap::ALL.len() as u32], 1);
        let descriptor = wgpu::TextureDescriptor { usage: wgpu::TextureUsages::TEXTURE_BINDING, ..descriptor };
        let order = wgpu::util::TextureDataOrder::LayerMajor;
        let colour_maps = device.create_texture_with_data(queue, &descriptor, order, &maps);
        Self {
            device: device.clone(),
            pipelines: Pipelines::new(device, target, samples),
            colour_maps: colour_maps.create_view(&wgpu::TextureViewDescriptor::default()),
            buffers: Buffers::default(),
            samples,
        }
    }

    /// Makes `picture` show the scene; nothing is drawn where it does already. Whether something was.
    pub fn draw(&mut self, scene: &Scene, picture: &mut Option<Picture>, encoder: &mut wgpu::CommandEncoder) -> bool {
        if picture.as_ref().is_some_and(|picture| picture.scene == *scene) || scene.size_px.contains(&0) {
            return false;
        }
        self.buffers.tidy();
        let largest = self.device.limits().max_texture_dimension_2d;
        let size = scene.size_px.map(|side| side.min(largest));
        let kept = picture.take().filter(|picture| [picture.colour.width(), picture.colour.height()] == size);
        let mut kept = kept.unwrap_or_else(|| self.picture(scene, size));
        kept.scene = scene.clone();
        self.encode(&kept, encoder);
        *picture = Some(kept);
        true
    }

    /// The picture with its top left corner at `origin_px` of the window.
    pub fn lay(&self, picture: &Picture, origin_px: [f32; 2]) -> Laid {
        let place = [origin_px[0], origin_px[1], 0.0, 0.0];
        Laid { pipeline: self.pipelines.copy.clone(), group: self.group(bytemuck::bytes_of(&place), &picture.resolved) }
    }

    fn picture(&self, scene: &Scene, size: [u32; 2]) -> Picture {
        let attachment = |name, format, samples| self.device.create_texture(&texture(name, format, size, samples));
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC;
        let colour = texture("3D view", COLOUR, size, 1);
        let colour = self.device.create_texture(&wgpu::TextureDescriptor { usage, ..colour });
        Picture {
            scene: scene.clone(),
            resolved: view(&colour),
            sampled: (self.samples > 1).then(|| view(&attachment("3D samples", COLOUR, self.samples))),
            depth: view(&attachment("3D depth", DEPTH, self.samples)),
            colour,
        }
    }

    fn encode(&mut self, picture: &Picture, encoder: &mut wgpu::CommandEncoder) {
        let [r, g, b] = picture.scene.background.map(f64::from);
        let resolve = picture.sampled.as_ref().map(|_| &picture.resolved);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("3D view"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: picture.sampled.as_ref().unwrap_or(&picture.resolved),
                resolve_target: resolve,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                    store: wgpu::StoreOp::Store,
                },
                depth_slice: None,
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &picture.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        for layer in &picture.scene.layers {
            self.encode_layer(&mut pass, &picture.scene, layer);
        }
    }

    fn encode_layer(&mut self, pass: &mut wgpu::RenderPass<'_>, scene: &Scene, layer: &LayerDrawing) {
        let Some(mesh) = self.buffers.mesh(&self.device, &layer.geometry, layer.wire.is_some()) else { return };
        let fits = |values: &&super::Shared<Vec<f32>>| values.len() == layer.geometry.vertex_count();
        let values = layer.values.as_ref().filter(fits).and_then(|values| self.buffers.values(&self.device, values));
        let group = self.group(bytemuck::bytes_of(&Uniforms::new(scene, layer)), &self.colour_maps);
        pass.set_bind_group(0, &group, &[]);
        pass.set_vertex_buffer(0, mesh.vertices.slice(..));
        match &values {
            Some(values) => {
                pass.set_pipeline(&self.pipelines.surface_with_values);
                pass.set_vertex_buffer(1, values.slice(..));
            }
            None => pass.set_pipeline(&self.pipelines.surface),
        }
        pass.set_index_buffer(mesh.triangles.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..3 * layer.geometry.triangles.len() as u32, 0, 0..1);
        if let (Some(edges), Some(_)) = (&mesh.edges, layer.wire) {
            pass.set_pipeline(&self.pipelines.wire);
            pass.set_index_buffer(edges.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..2 * layer.geometry.edges.len() as u32, 0, 0..1);
        }
    }

    fn group(&self, uniforms: &[u8], view: &wgpu::TextureView) -> wgpu::BindGroup {
        let uniforms = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("mesh"),
            contents: uniforms,
            usage: wgpu::BufferUsages::UNIFORM,
        });
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("mesh"),
            layout: &self.pipelines.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(view) },
            ],
        })
    }
}

fn texture(
    label: &'static str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    sample_count: u32,
) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    }
}
