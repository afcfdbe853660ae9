//! When the graphics driver stops, the window goes on: with another adapter where there is one, else with the same again.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use eframe::egui_wgpu::{NativeAdapterSelectorMethod, RenderState};
use eframe::wgpu::{self, Backend, DeviceLostReason, DeviceType};

/// A second loss within this time is no accident: going on would end in a third.
const SOON: Duration = Duration::from_secs(60);

/// A graphics adapter by what distinguishes it from others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterName {
    /// As the driver calls it.
    pub name: String,
    /// How it is spoken to; one card may be spoken to in several ways.
    pub backend: Backend,
    /// A card, or the processor in its place.
    pub device_type: DeviceType,
}

impl AdapterName {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        Self { name: info.name, backend: info.backend, device_type: info.device_type }
    }

    /// "llvmpipe (Vulkan)"
    pub fn words(&self) -> String {
        let backend = match self.backend {
            Backend::Gl => "OpenGL",
            Backend::Vulkan => "Vulkan",
            Backend::Metal => "Metal",
            Backend::Dx12 => "Direct3D 12",
            _ => return self.name.clone(),
        };
        format!("{} ({backend})", self.name)
    }
}

/// Reports whether the window's graphics device is still there.
#[derive(Clone, Default)]
pub struct DeviceWatch {
    lost: Arc<AtomicBool>,
    adapter: Option<AdapterName>,
    #[cfg(debug_assertions)]
    device: Option<wgpu::Device>,
    #[cfg(debug_assertions)]
    is_doomed: bool,
}

impl DeviceWatch {
    /// Watches the device of a window; `wake` is called when it goes away.
    pub fn new(render_state: &RenderState, wake: impl Fn() + Send + 'static) -> Self {
        let lost = Arc::new(AtomicBool::new(false));
        let noticed = lost.clone();
        render_state.device.set_device_lost_callback(move |reason, _| {
            // A device that was destroyed is one that is not needed any more.
            if reason == DeviceLostReason::Unknown {
                noticed.store(true, Ordering::Relaxed);
                wake();
            }
        });
        Self {
            lost,
            adapter: Some(AdapterName::of(&render_state.adapter)),
            #[cfg(debug_assertions)]
            device: Some(render_state.device.clone()),
            #[cfg(debug_assertions)]
            is_doomed: false,
        }
    }

    /// Whether the device went away.
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    /// What the window draws with; `None` without a renderer.
    pub fn adapter(&self) -> Option<&AdapterName> {
        self.adapter.as_ref()
    }

    /// Has the device taken away before the next frame, to see what the program makes of it.
    #[cfg(debug_assertions)]
    pub fn lose(&mut self) {
        self.is_doomed = true;
    }

    /// Takes the device away, if that was asked for, as a driver does that stops.
    #[cfg(debug_assertions)]
    pub fn begin_frame(&mut self) {
        if let Some(device) = self.device.as_ref().filter(|_| self.is_doomed) {
            device.destroy();
            self.lost.store(true, Ordering::Relaxed);
        }
    }
}

/// What to do after a loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AfterLoss {
    /// Open the window again.
    GoOn,
    /// Keep the document for the next run, and say so.
    GiveUp,
}

/// The adapters that stopped in this run.
#[derive(Default)]
pub struct Losses {
    lost: Vec<AdapterName>,
    last: Option<Instant>,
}

impl Losses {
    /// Notes that an adapter stopped.
    pub fn note(&mut self, adapter: Option<AdapterName>, now: Instant) -> AfterLoss {
        self.lost.extend(adapter);
        let before = self.last.replace(now);
        let soon = before.is_some_and(|before| now.saturating_duration_since(before) < SOON);
        if soon { AfterLoss::GiveUp } else { AfterLoss::GoOn }
    }

    /// How the next window chooses its adapter; `None` for the system's own choice, as long as nothing was lost.
    pub fn selector(&self) -> Option<NativeAdapterSelectorMethod> {
        let lost = self.lost.clone();
        let choose = move |adapters: &[wgpu::Adapter], surface: Option<&wgpu::Surface<'_>>| {
            let can_show =
                |adapter: &&wgpu::Adapter| surface.is_none_or(|surface| adapter.is_surface_supported(surface));
            let best = adapters.iter().filter(can_show).min_by_key(|adapter| rank(&AdapterName::of(adapter), &lost));
            best.cloned().ok_or_else(|| "no graphics adapter can draw the window".to_owned())
        };
        (!self.lost.is_empty()).then(|| Arc::new(choose) as NativeAdapterSelectorMethod)
    }

    /// One line for the user, once the window is there again.
    pub fn words(&self, now: Option<&AdapterName>) -> String {
        let name = |adapter: Option<&AdapterName>| adapter.map_or("the graphics card".to_owned(), AdapterName::words);
        let last = self.lost.last();
        let with = if now == last { "again".to_owned() } else { format!("with {}", name(now)) };
        format!("The graphics driver of {} stopped. The window goes on {with}; nothing was lost", name(last))
    }
}

/// The least is the best: what did not stop before what did, a card before the processor.
fn rank(adapter: &AdapterName, lost: &[AdapterName]) -> (usize, u8) {
    let times_lost = lost.iter().filter(|lost| *lost == adapter).count();
    let by_type = match adapter.device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    };
    (times_lost, by_type)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, backend: Backend, device_type: DeviceType) -> AdapterName {
        AdapterName { name: name.into(), backend, device_type }
    }

    fn adapters() -> [AdapterName; 4] {
        [
            adapter("Mesa", Backend::Vulkan, DeviceType::Cpu),
            adapter("Card", Backend::Vulkan, DeviceType::DiscreteGpu),
            adapter("Card", Backend::Gl, DeviceType::DiscreteGpu),
            adapter("Chip", Backend::Vulkan, DeviceType::IntegratedGpu),
        ]
    }

    fn best<'a>(adapters: &'a [AdapterName], lost: &[AdapterName]) -> &'a AdapterName {
        adapters.iter().min_by_key(|adapter| rank(adapter, lost)).unwrap()
    }

    #[test]
    fn what_stopped_is_the_last_choice_and_still_one() {
        let all = adapters();
        let mut lost = Vec::new();
        for expected in [&all[1], &all[2], &all[3], &all[0], &all[1]] {
            assert_eq!(best(&all, &lost), expected, "after {lost:?}");
            lost.push(expected.clone());
        }
        assert_eq!(best(&all[..1], &all), &all[0], "the only one is taken again");
    }

    #[test]
    fn a_second_loss_ends_the_run_only_if_it_comes_soon() {
        let start = Instant::now();
        let mut losses = Losses::default();
        assert!(losses.selector().is_none());
        assert_eq!(losses.note(Some(adapters()[1].clone()), start), AfterLoss::GoOn);
        assert!(losses.selector().is_some());
        assert_eq!(losses.note(None, start + 2 * SOON), AfterLoss::GoOn);
        assert_eq!(losses.note(None, start + 2 * SOON + SOON / 2), AfterLoss::GiveUp);
    }

    #[test]
    fn the_line_names_what_stopped_and_what_goes_on() {
        let all = adapters();
        let mut losses = Losses::default();
        losses.note(Some(all[1].clone()), Instant::now());
        let other = losses.words(Some(&all[0]));
        assert!(other.contains("Card (Vulkan) stopped") && other.contains("goes on with Mesa (Vulkan)"), "{other}");
        assert!(losses.words(Some(&all[1])).contains("goes on again"));
    }
}
