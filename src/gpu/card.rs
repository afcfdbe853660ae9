//! Drawings on the graphics card, with everything they read.

use eframe::wgpu;
use wgpu::util::DeviceExt;

use super::drawing::Drawing;
use super::shader::{CanvasShader, Output};
use super::textures::{OnCard, Resolution, Textures};
use super::transfer::Wake;
use super::uniforms::Uniforms;
use super::{ColourMap, MAX_PLANES};

/// A drawing with everything it needs on the card.
pub struct Bound {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    /// How much of the picture the card has.
    pub resolution: Resolution,
}

impl Bound {
    /// Draws over the whole viewport of the pass.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// The canvas on one graphics card: shader, colour maps and the textures of all planes.
pub struct CanvasGpu {
    device: wgpu::Device,
    shader: CanvasShader,
    colour_maps: wgpu::TextureView,
    /// Placeholders for the planes and marks that a drawing does not use.
    no_plane: wgpu::TextureView,
    no_marks: wgpu::TextureView,
    textures: Textures,
}

impl CanvasGpu {
    /// For targets of the given format, which must not encode by itself.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue, target: wgpu::TextureFormat, output: Output) -> Self {
        let max_side = device.limits().max_texture_dimension_2d as usize;
        Self::with_max_side(device, queue, target, output, max_side)
    }

    /// As if the card had no textures wider or higher than `max_side` pixels.
    pub fn with_max_side(
        device: wgpu::Device,
        queue: wgpu::Queue,
        target: wgpu::TextureFormat,
        output: Output,
        max_side: usize,
    ) -> Self {
        let shader = CanvasShader::new(&device, target, output);
        let maps: Vec<u8> =
            ColourMap::ALL.iter().flat_map(|map| map.table()).flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        let colour_maps = small_texture(&device, &queue, wgpu::TextureFormat::Rgba8Unorm, (256, 4), &maps);
        let no_plane = small_texture(&device, &queue, wgpu::TextureFormat::R32Float, (1, 1), &[0; 4]);
        let no_marks = small_texture(&device, &queue, wgpu::TextureFormat::R8Uint, (1, 1), &[0]);
        let textures = Textures::new(device.clone(), queue, max_side);
        Self { device, shader, colour_maps, no_plane, no_marks, textures }
    }

    /// Begins a frame: what its drawings may send to the card together is limited.
    pub fn begin_frame(&mut self) {
        self.textures.begin_frame();
    }

    /// Gathers what a drawing reads, and begins the upload of planes that the card does not have. `None` until there is
    /// something to see; `wake` is called, from any thread, when there is more.
    pub fn bind(&mut self, drawing: &Drawing<'_>, wake: &Wake) -> Option<Bound> {
        let source = drawing.source;
        let size = source.size();
        if size.0 == 0 || size.1 == 0 {
            return None;
        }
        let planes: Vec<_> = source.planes.iter().map(|plane| self.textures.plane(plane, wake)).collect();
        let marks = source.marks.as_ref().map(|marks| self.textures.marks(marks, wake));
        let mask = source.mask.as_ref().map(|mask| self.textures.marks(mask, wake));

        let all = || planes.iter().chain(&marks).chain(&mask);
        let dropped = all().map(|on_card| on_card.texture.dropped).max()?;
        let finest = all().map(|on_card| on_card.finest).collect::<Option<Vec<_>>>()?.into_iter().max()?;
        let is_current = all().all(|on_card| on_card.is_current);
        let sampling = drawing.placement.sampling(size, finest);
        let uniforms = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("canvas"),
            contents: bytemuck::bytes_of(&Uniforms::new(drawing, sampling, dropped)),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let resolution = Resolution { divisor: 1 << dropped, loading: finest > dropped || !is_current };
        let group = self.bind_group(&uniforms, &planes, marks.as_ref(), mask.as_ref());
        Some(Bound { pipeline: self.shader.pipeline(&self.device, drawing), group, resolution })
    }

    fn bind_group(
        &self,
        uniforms: &wgpu::Buffer,
        planes: &[OnCard],
        marks: Option<&OnCard>,
        mask: Option<&OnCard>,
    ) -> wgpu::BindGroup {
        let marks = marks.map_or(&self.no_marks, |on_card| &on_card.texture.view);
        let mask = mask.map_or(&self.no_marks, |on_card| &on_card.texture.view);
        let planes =
            (0..MAX_PLANES).map(|slot| planes.get(slot).map_or(&self.no_plane, |on_card| &on_card.texture.view));
        let views = [&self.colour_maps, marks, mask].into_iter().chain(planes).map(wgpu::BindingResource::TextureView);
        let resources = std::iter::once(uniforms.as_entire_binding()).chain(views);
        let entries: Vec<_> =
            resources.zip(0..).map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource }).collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("canvas"),
            layout: &self.shader.layout,
            entries: &entries,
        })
    }
}

fn small_texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    format: wgpu::TextureFormat,
    (width, height): (u32, u32),
    texels: &[u8],
) -> wgpu::TextureView {
    let descriptor = wgpu::TextureDescriptor {
        label: Some("canvas table"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let texture = device.create_texture_with_data(queue, &descriptor, wgpu::util::TextureDataOrder::LayerMajor, texels);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
