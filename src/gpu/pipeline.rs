//! The shader on the graphics card, with everything it reads.

use eframe::wgpu;
use wgpu::util::DeviceExt;

use super::drawing::Drawing;
use super::textures::{OnCard, Resolution, Textures, Wake};
use super::uniforms::Uniforms;
use super::{ColourMap, MAX_PLANES};

/// What the shader writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Colours in gamma space, for the window.
    Colours,
    /// The numbers behind the colours, and 1 where there are any, for a float target.
    Values,
}

/// The canvas on one graphics card: shader, colour maps and the textures of all planes.
pub struct CanvasGpu {
    device: wgpu::Device,
    pipeline: wgpu::RenderPipeline,
    colour_maps: wgpu::TextureView,
    /// Stand in for the planes and marks that a drawing does not use.
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
        let pipeline = pipeline(&device, target, output);
        let maps: Vec<u8> =
            ColourMap::ALL.iter().flat_map(|map| map.table()).flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        let colour_maps = small_texture(&device, &queue, wgpu::TextureFormat::Rgba8Unorm, (256, 4), &maps);
        let no_plane = small_texture(&device, &queue, wgpu::TextureFormat::R32Float, (1, 1), &[0; 4]);
        let no_marks = small_texture(&device, &queue, wgpu::TextureFormat::R8Uint, (1, 1), &[0]);
        let textures = Textures::new(device.clone(), queue, max_side);
        Self { device, pipeline, colour_maps, no_plane, no_marks, textures }
    }

    /// Gathers what a drawing reads, and begins the upload of planes that the card does not have. `None` until there is
    /// something to see; `wake` is called, from any thread, when there is more.
    pub fn bind(&mut self, drawing: &Drawing<'_>, wake: &Wake) -> Option<(wgpu::BindGroup, Resolution)> {
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
        let finest = all().map(|on_card| on_card.texture.finest()).collect::<Option<Vec<_>>>()?.into_iter().max()?;
        let is_current = all().all(|on_card| on_card.is_current);
        let sampling = drawing.placement.sampling(size, finest);
        let uniforms = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("canvas"),
            contents: bytemuck::bytes_of(&Uniforms::new(drawing, sampling, dropped)),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let resolution = Resolution { divisor: 1 << dropped, loading: finest > dropped || !is_current };
        Some((self.bind_group(&uniforms, &planes, marks.as_ref(), mask.as_ref()), resolution))
    }

    /// Draws what `bind` gathered over the whole viewport of the pass.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bound, &[]);
        pass.draw(0..3, 0..1);
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
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &entries,
        })
    }
}

fn pipeline(device: &wgpu::Device, target: wgpu::TextureFormat, output: Output) -> wgpu::RenderPipeline {
    let shader = device.create_shader_module(wgpu::include_wgsl!("canvas.wgsl"));
    let layout = bind_group_layout(device);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("canvas"),
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let entry_point = match output {
        Output::Colours => "show_colours",
        Output::Values => "show_values",
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("canvas"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("cover"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(target.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Binding 0 is the uniforms, 1 the colour maps, 2 the marks, 3 the mask, and from 4 on the planes. Spelt out, because the
/// numbers' shader reads fewer of them.
fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let texture = |sample_type| wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let uniforms = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let unfiltered = texture(wgpu::TextureSampleType::Float { filterable: false });
    let bytes = texture(wgpu::TextureSampleType::Uint);
    let entries: Vec<_> = [uniforms, unfiltered, bytes, bytes]
        .into_iter()
        .chain([unfiltered; MAX_PLANES])
        .zip(0..)
        .map(|(ty, binding)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("canvas"), entries: &entries })
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
