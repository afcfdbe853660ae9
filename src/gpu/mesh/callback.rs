//! The 3D view inside egui's own drawing.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use eframe::egui::{PaintCallbackInfo, mutex::Mutex};
use eframe::egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use eframe::wgpu;

use super::pass::{Laid, MeshGpu, Picture};
use super::scene::Scene;

/// Makes 3D views draw with this renderer. Once, when the window opens; without it they stay flat.
pub fn install(render_state: &RenderState) {
    let RenderState { adapter, device, queue, target_format, renderer, .. } = render_state;
    let view = MeshGpu::new(adapter, device, queue, *target_format);
    renderer.write().callback_resources.insert(view);
}

/// What a view keeps on the card from frame to frame.
#[derive(Default)]
pub struct Kept {
    picture: Mutex<Option<Picture>>,
    drawn: AtomicU64,
}

impl Kept {
    /// How often the picture was redrawn.
    pub fn drawn(&self) -> u64 {
        self.drawn.load(Ordering::Relaxed)
    }
}

/// One scene in one frame.
pub struct MeshCallback {
    scene: Scene,
    /// The view's top left corner in the window, in physical pixels.
    origin_px: [f32; 2],
    kept: Arc<Kept>,
    laid: OnceLock<Laid>,
}

impl MeshCallback {
    /// Shows `scene` with its top left corner at `origin_px`.
    pub fn new(scene: Scene, origin_px: [f32; 2], kept: Arc<Kept>) -> Self {
        Self { scene, origin_px, kept, laid: OnceLock::new() }
    }
}

impl CallbackTrait for MeshCallback {
    fn prepare(
        &self,
        _: &wgpu::Device,
        _: &wgpu::Queue,
        _: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let Some(view) = resources.get_mut::<MeshGpu>() else { return Vec::new() };
        let mut picture = self.kept.picture.lock();
        if view.draw(&self.scene, &mut picture, encoder) {
            self.kept.drawn.fetch_add(1, Ordering::Relaxed);
        }
        if let Some(picture) = picture.as_ref() {
            self.laid.get_or_init(|| view.lay(picture, self.origin_px));
        }
        Vec::new()
    }

    fn paint(&self, _: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        if let Some(laid) = self.laid.get() {
            laid.draw(pass);
        }
    }
}
