//! The canvas inside egui's own drawing.

use std::sync::{Arc, OnceLock};

use eframe::egui::{Context, PaintCallbackInfo, mutex::Mutex};
use eframe::egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use eframe::wgpu;

use super::drawing::{Drawing, Placement};
use super::transfer::Wake;
use super::{Bound, CanvasGpu, Display, Output, Resolution, Source};

/// Makes canvases draw with this renderer. Once, when the window opens; without it they stay flat.
pub fn install(render_state: &RenderState) {
    let RenderState { device, queue, target_format, renderer, .. } = render_state;
    let canvas = CanvasGpu::new(device.clone(), queue.clone(), *target_format, Output::Colours);
    renderer.write().callback_resources.insert(canvas);
}

/// What the last drawing of a canvas found on the card.
#[derive(Default)]
pub struct CanvasStatus {
    resolution: Mutex<Option<Resolution>>,
}

impl CanvasStatus {
    /// `None` before the first drawing, and without a renderer.
    pub fn resolution(&self) -> Option<Resolution> {
        *self.resolution.lock()
    }
}

/// One picture of one frame.
pub struct CanvasCallback {
    source: Source,
    display: Display,
    placement: Placement,
    background: [f32; 3],
    status: Arc<CanvasStatus>,
    wake: Wake,
    bound: OnceLock<Bound>,
}

impl CanvasCallback {
    /// Draws `drawing` once; `status` is told what could be shown, and `context` repaints when there is more.
    pub fn new(drawing: &Drawing<'_>, status: Arc<CanvasStatus>, context: Context) -> Self {
        Self {
            source: drawing.source.clone(),
            display: drawing.display.clone(),
            placement: drawing.placement,
            background: drawing.background,
            status,
            wake: Arc::new(move || context.request_repaint()),
            bound: OnceLock::new(),
        }
    }
}

impl CallbackTrait for CanvasCallback {
    fn prepare(
        &self,
        _: &wgpu::Device,
        _: &wgpu::Queue,
        _: &ScreenDescriptor,
        _: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let Some(canvas) = resources.get_mut::<CanvasGpu>() else { return Vec::new() };
        let Self { source, display, placement, background, .. } = self;
        let drawing = Drawing { source, display, placement: *placement, background: *background };
        if let Some(bound) = canvas.bind(&drawing, &self.wake) {
            let before = self.status.resolution.lock().replace(bound.resolution);
            if before.is_none_or(|before| before.divisor != bound.resolution.divisor) {
                // What is said about it was laid out before.
                (self.wake)();
            }
            self.bound.get_or_init(|| bound);
        }
        Vec::new()
    }

    fn finish_prepare(
        &self,
        _: &wgpu::Device,
        _: &wgpu::Queue,
        _: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        // Every drawing of this frame was prepared.
        if let Some(canvas) = resources.get_mut::<CanvasGpu>() {
            canvas.begin_frame();
        }
        Vec::new()
    }

    fn paint(&self, _: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        if let Some(bound) = self.bound.get() {
            bound.draw(pass);
        }
    }
}
