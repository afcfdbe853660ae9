//! The graphics card of the tests, and drawing into memory with it.

use std::io::Write;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use eframe::egui_wgpu::{RenderState, RendererOptions, WgpuSetup, WgpuSetupExisting};
use eframe::wgpu;
use firstbounce::gpu::mesh::{MeshGpu, Picture, Scene};
use firstbounce::gpu::{Bound, CanvasGpu, Drawing, Output, Resolution, Wake};
use image::RgbaImage;

const TARGET: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

pub struct Card {
    instance: wgpu::Instance,
    adapter: wgpu::Adapter,
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Shared, because making a pipeline takes longer than a drawing.
    colours: OnceLock<Mutex<CanvasGpu>>,
    values: OnceLock<Mutex<CanvasGpu>>,
}

/// The one device of all tests; `None`, with a line that names the test, on a machine without an adapter.
pub fn card(test: &str) -> Option<&'static Card> {
    static CARD: OnceLock<Option<Card>> = OnceLock::new();
    let card = CARD.get_or_init(|| {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).ok()?;
        let descriptor = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).ok()?;
        Some(Card { instance, adapter, device, queue, colours: OnceLock::new(), values: OnceLock::new() })
    });
    if card.is_none() {
        skip(test, "no wgpu adapter");
    }
    card.as_ref()
}

/// The same, if it can draw floats: OpenGL often cannot.
pub fn float_card(test: &str) -> Option<&'static Card> {
    let card = card(test)?;
    let usages = card.adapter.get_texture_format_features(TARGET).allowed_usages;
    if !usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
        skip(test, "no wgpu adapter that draws floats");
        return None;
    }
    Some(card)
}

/// Past the test's own captured output: a test that did not test must be seen.
fn skip(test: &str, missing: &str) {
    writeln!(std::io::stderr(), "{test}: skipped: {missing}").expect("the error output is open");
}

impl Card {
    /// A renderer for the window's harness, on the same device.
    pub fn render_state(&self) -> RenderState {
        let setup = WgpuSetup::Existing(WgpuSetupExisting {
            instance: self.instance.clone(),
            adapter: self.adapter.clone(),
            device: self.device.clone(),
            queue: self.queue.clone(),
        });
        egui_kittest::wgpu::create_render_state(setup, RendererOptions::PREDICTABLE)
    }

    /// Draws into a float target of `width * height` pixels and reads it back. `width` must be a multiple of 16.
    pub fn draw(&self, drawing: &Drawing<'_>, output: Output, size: (u32, u32)) -> Vec<[f32; 4]> {
        let mut canvas = self.canvas(output);
        self.draw_with(&mut canvas, drawing, size).0
    }

    /// Draws again and again while the picture is on its way to the card: every drawing, the last one complete.
    pub fn draw_until_loaded(&self, drawing: &Drawing<'_>, size: (u32, u32)) -> Vec<(Vec<[f32; 4]>, Resolution)> {
        let mut canvas = self.canvas(Output::Values);
        let mut drawn: Vec<(Vec<[f32; 4]>, Resolution)> = Vec::new();
        while drawn.last().is_none_or(|(_, resolution)| resolution.loading) {
            match self.bind(&mut canvas, drawing) {
                Some(_) => drawn.push(self.draw_with(&mut canvas, drawing, size)),
                None => std::thread::yield_now(),
            }
        }
        drawn
    }

    /// The numbers as drawn on a card whose textures have at most `max_side` pixels on a side.
    pub fn draw_limited(
        &self,
        drawing: &Drawing<'_>,
        size: (u32, u32),
        max_side: usize,
    ) -> (Vec<[f32; 4]>, Resolution) {
        let (device, queue) = (self.device.clone(), self.queue.clone());
        let mut canvas = CanvasGpu::with_max_side(device, queue, TARGET, Output::Values, max_side);
        self.draw_with(&mut canvas, drawing, size)
    }

    fn canvas(&self, output: Output) -> MutexGuard<'_, CanvasGpu> {
        let made = match output {
            Output::Colours => &self.colours,
            Output::Values => &self.values,
        };
        let make = || Mutex::new(CanvasGpu::new(self.device.clone(), self.queue.clone(), TARGET, output));
        made.get_or_init(make).lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn bind(&self, canvas: &mut CanvasGpu, drawing: &Drawing<'_>) -> Option<Bound> {
        let wake: Wake = Arc::new(|| ());
        canvas.begin_frame();
        canvas.bind(drawing, &wake)
    }

    fn draw_with(
        &self,
        canvas: &mut CanvasGpu,
        drawing: &Drawing<'_>,
        size: (u32, u32),
    ) -> (Vec<[f32; 4]>, Resolution) {
        let bound = self.bind(canvas, drawing).expect("small pictures are on the card at once");
        let target = self.target(size);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    resolve_target: None,
                    ops: wgpu::Operations::default(),
                    depth_slice: None,
                })],
                ..Default::default()
            });
            bound.draw(&mut pass);
        }
        (self.read_back(encoder, &target), bound.resolution)
    }

    /// Draws a scene and reads it back. Its width must be a multiple of 64.
    pub fn draw_scene(&self, scene: &Scene) -> RgbaImage {
        let mut picture = None;
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.mesh().draw(scene, &mut picture, &mut encoder);
        let picture: Picture = picture.expect("it was drawn");
        let bytes = self.bytes(encoder, &picture.colour, 4);
        RgbaImage::from_raw(picture.colour.width(), picture.colour.height(), bytes).expect("as many bytes as pixels")
    }

    /// Which of these scenes are drawn anew when they follow each other in one view.
    pub fn draws(&self, scenes: &[&Scene]) -> Vec<bool> {
        let (mut mesh, mut picture) = (self.mesh(), None);
        let mut draw = |scene: &Scene| {
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let drawn = mesh.draw(scene, &mut picture, &mut encoder);
            self.queue.submit([encoder.finish()]);
            drawn
        };
        scenes.iter().map(|scene| draw(scene)).collect()
    }

    fn mesh(&self) -> MeshGpu {
        MeshGpu::new(&self.adapter, &self.device, &self.queue, wgpu::TextureFormat::Rgba8Unorm)
    }

    fn target(&self, (width, height): (u32, u32)) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TARGET,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    fn read_back(&self, encoder: wgpu::CommandEncoder, target: &wgpu::Texture) -> Vec<[f32; 4]> {
        self.bytes(encoder, target, 16).chunks_exact(16).map(bytemuck::pod_read_unaligned).collect()
    }

    fn bytes(&self, mut encoder: wgpu::CommandEncoder, target: &wgpu::Texture, bytes_per_pixel: u32) -> Vec<u8> {
        let bytes_per_row = bytes_per_pixel * target.width();
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(bytes_per_row * target.height()),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(bytes_per_row), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            target.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            target.size(),
        );
        self.queue.submit([encoder.finish()]);
        buffer.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.expect("mapped"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the card answers");
        let mapped = buffer.slice(..).get_mapped_range().expect("mapped");
        mapped.to_vec()
    }
}
