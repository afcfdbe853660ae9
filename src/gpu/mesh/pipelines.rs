//! The shader of the 3D view, made for one card.

use std::mem::size_of;

use eframe::wgpu;

use super::geometry::Vertex;

/// What the picture is drawn into: gamma space, encoded by the shader.
pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Its depth buffer.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Every pipeline of the view.
pub struct Pipelines {
    /// Of a layer, and of the blit.
    pub layout: wgpu::BindGroupLayout,
    pub surface: wgpu::RenderPipeline,
    pub surface_with_values: wgpu::RenderPipeline,
    pub wire: wgpu::RenderPipeline,
    pub copy: wgpu::RenderPipeline,
}

impl Pipelines {
    /// For pictures of so many samples a pixel, laid into targets of the given format.
    pub fn new(device: &wgpu::Device, target: wgpu::TextureFormat, samples: u32) -> Self {
        let layout = bind_group_layout(device);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("mesh"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(wgpu::include_wgsl!("mesh.wgsl"));
        let vertices = [
            wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x3, offset: 0, shader_location: 0 },
            wgpu::VertexAttribute { format: wgpu::VertexFormat::Snorm16x4, offset: 12, shader_location: 1 },
            wgpu::VertexAttribute { format: wgpu::VertexFormat::Unorm8x4, offset: 20, shader_location: 2 },
        ];
        let values = [wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32, offset: 0, shader_location: 3 }];
        let stream = |stride: usize, attributes| {
            Some(wgpu::VertexBufferLayout {
                array_stride: stride as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes,
            })
        };
        let plain = [stream(size_of::<Vertex>(), &vertices)];
        let valued = [stream(size_of::<Vertex>(), &vertices), stream(size_of::<f32>(), &values)];
        let make = |vertex: &str, fragment: &str, buffers: &[_], topology, picture: bool| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(vertex),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers,
                },
                primitive: wgpu::PrimitiveState { topology, ..wgpu::PrimitiveState::default() },
                depth_stencil: picture.then(|| wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::LessEqual),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState {
                    count: if picture { samples } else { 1 },
                    ..wgpu::MultisampleState::default()
                },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: if picture { COLOUR } else { target },
                        // Edges let the surface through where they lie close.
                        blend: (fragment == "wire").then_some(wgpu::BlendState::ALPHA_BLENDING),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let triangles = wgpu::PrimitiveTopology::TriangleList;
        Self {
            surface: make("surface", "shade", &plain, triangles, true),
            surface_with_values: make("surface_with_values", "shade", &valued, triangles, true),
            wire: make("lifted", "wire", &plain, wgpu::PrimitiveTopology::LineList, true),
            copy: make("cover", "copy", &[], triangles, false),
            layout,
        }
    }
}

/// Binding 0 is the uniforms, 1 the colour maps of a layer, or the picture of the blit.
fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let uniforms = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let entries: Vec<_> = [uniforms, texture]
        .into_iter()
        .zip(0..)
        .map(|(ty, binding)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty,
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("mesh"), entries: &entries })
}
