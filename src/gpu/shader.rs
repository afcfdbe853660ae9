//! The shader, made for what a drawing uses.

use std::collections::HashMap;

use eframe::wgpu;

use super::drawing::Drawing;
use super::{ColourMap, Kind, MAX_PLANES};

/// What the shader writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Colours in gamma space, for the window.
    Colours,
    /// The numbers behind the colours, and 1 where there are any, for a float target.
    Values,
}

/// What a drawing uses: the constants that `canvas.wgsl` calls `override`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Variant {
    plane_count: u32,
    kind: Kind,
    is_grey: bool,
    has_marks: bool,
    has_mask: bool,
}

impl Variant {
    fn of(drawing: &Drawing<'_>) -> Self {
        let source = drawing.source;
        Self {
            plane_count: source.planes.len() as u32,
            kind: source.kind(),
            is_grey: drawing.display.map == ColourMap::Grey,
            has_marks: source.marks.is_some(),
            has_mask: source.mask.is_some(),
        }
    }

    fn constants(self) -> [(&'static str, f64); 5] {
        [
            ("PLANE_COUNT", f64::from(self.plane_count)),
            ("KIND", f64::from(self.kind as u32)),
            ("IS_GREY", f64::from(self.is_grey)),
            ("HAS_MARKS", f64::from(self.has_marks)),
            ("HAS_MASK", f64::from(self.has_mask)),
        ]
    }
}

/// The pipelines made so far.
pub struct CanvasShader {
    module: wgpu::ShaderModule,
    /// Of the one bind group.
    pub layout: wgpu::BindGroupLayout,
    pipeline_layout: wgpu::PipelineLayout,
    target: wgpu::TextureFormat,
    output: Output,
    made: HashMap<Variant, wgpu::RenderPipeline>,
}

impl CanvasShader {
    /// For targets of the given format.
    pub fn new(device: &wgpu::Device, target: wgpu::TextureFormat, output: Output) -> Self {
        let layout = bind_group_layout(device);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("canvas"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(wgpu::include_wgsl!("canvas.wgsl"));
        Self { module, layout, pipeline_layout, target, output, made: HashMap::new() }
    }

    /// The pipeline for a drawing.
    pub fn pipeline(&mut self, device: &wgpu::Device, drawing: &Drawing<'_>) -> wgpu::RenderPipeline {
        let variant = Variant::of(drawing);
        if let Some(made) = self.made.get(&variant) {
            return made.clone();
        }
        let pipeline = self.make(device, variant);
        self.made.insert(variant, pipeline.clone());
        pipeline
    }

    fn make(&self, device: &wgpu::Device, variant: Variant) -> wgpu::RenderPipeline {
        let entry_point = match self.output {
            Output::Colours => "show_colours",
            Output::Values => "show_values",
        };
        let constants = variant.constants();
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("canvas"),
            layout: Some(&self.pipeline_layout),
            vertex: wgpu::VertexState {
                module: &self.module,
                entry_point: Some("cover"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &self.module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..wgpu::PipelineCompilationOptions::default()
                },
                targets: &[Some(self.target.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
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
