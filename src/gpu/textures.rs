//! Planes on the graphics card.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use eframe::wgpu;

use super::pyramid::{Texel, level_count, level_size, smaller_copies};
use super::{CanvasMarks, CanvasPlane, PlaneKey};

/// Textures not seen for a while are given up when all of them together are larger than this: eight photos of 24 Mpx.
const BUDGET_BYTES: u64 = 1 << 30;
const A_WHILE: Duration = Duration::from_secs(2);
/// Pictures up to this many pixels go to the card at once, larger ones from a thread of their own.
const AT_ONCE_PIXELS: usize = 1 << 20;
/// Pixels handed over in one piece: the window's thread never waits for more than that.
const PIECE_PIXELS: usize = 1 << 20;

/// Called when there is more to draw.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// How much of a picture the card can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// 1 for the full resolution; 2, 4, ... for a half, a quarter, when the picture is larger than the card's textures.
    pub divisor: u32,
    /// Whether finer copies or newer numbers are still on their way to the card.
    pub loading: bool,
}

/// A picture and its smaller copies as one texture with mip levels.
pub struct CardTexture {
    pub view: wgpu::TextureView,
    texture: wgpu::Texture,
    size: (usize, usize),
    /// The picture's level that is mip level 0: more than 0 if the picture is larger than the card's textures.
    pub dropped: u32,
    /// The finest level that is on the card; `level_count` while there is none.
    finest: AtomicU32,
}

impl CardTexture {
    /// The finest level that can be read; `None` before the first has arrived.
    pub fn finest(&self) -> Option<u32> {
        let finest = self.finest.load(Ordering::Acquire);
        (finest < level_count(self.size)).then_some(finest)
    }

    fn is_complete(&self) -> bool {
        self.finest() == Some(self.dropped)
    }

    fn bytes(&self) -> u64 {
        let texel = self.texture.format().block_copy_size(None).unwrap_or(4);
        u64::from(self.texture.width()) * u64::from(self.texture.height()) * u64::from(texel) * 4 / 3
    }
}

struct Entry {
    version: u64,
    shown: Arc<CardTexture>,
    /// The next version, until it is complete.
    coming: Option<(u64, Arc<CardTexture>)>,
    last_used: Instant,
}

impl Entry {
    /// What to draw for `version`; `None` if its upload has to begin. While another version is on its way nothing is begun, so
    /// that a fast change of numbers skips versions instead of queueing them.
    fn shown_for(&mut self, version: u64) -> Option<OnCard> {
        self.last_used = Instant::now();
        if let Some((version, coming)) = self.coming.take_if(|(_, coming)| coming.is_complete()) {
            (self.version, self.shown) = (version, coming);
        }
        let is_current = self.version == version;
        (is_current || self.coming.is_some()).then(|| OnCard { texture: self.shown.clone(), is_current })
    }
}

/// A texture to draw with.
pub struct OnCard {
    pub texture: Arc<CardTexture>,
    /// Whether these are the numbers asked for, and not the ones before.
    pub is_current: bool,
}

/// All textures of planes and marks, by the id of their keys.
pub struct Textures {
    device: wgpu::Device,
    queue: wgpu::Queue,
    max_side: usize,
    entries: HashMap<u64, Entry>,
}

impl Textures {
    /// None yet. `max_side` is the largest width or height of a texture, in pixels.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue, max_side: usize) -> Self {
        Self { device, queue, max_side, entries: HashMap::new() }
    }

    /// The texture of a plane, its upload begun if the card does not have this version.
    pub fn plane(&mut self, plane: &CanvasPlane, wake: &Wake) -> OnCard {
        let format = wgpu::TextureFormat::R32Float;
        self.texture(plane.key, plane.plane.size(), format, plane.plane.clone(), |plane| plane.data(), wake)
    }

    /// The texture of marks, its upload begun if the card does not have this version.
    pub fn marks(&mut self, marks: &CanvasMarks, wake: &Wake) -> OnCard {
        let format = wgpu::TextureFormat::R8Uint;
        self.texture(marks.key, marks.size, format, marks.marks.clone(), |marks| marks.as_slice(), wake)
    }

    fn texture<T: Texel, P: Send + Sync + 'static>(
        &mut self,
        key: PlaneKey,
        size: (usize, usize),
        format: wgpu::TextureFormat,
        picture: Arc<P>,
        texels: fn(&P) -> &[T],
        wake: &Wake,
    ) -> OnCard {
        let known = self.entries.get_mut(&key.id).filter(|entry| entry.shown.size == size);
        if let Some(shown) = known.and_then(|entry| entry.shown_for(key.version)) {
            return shown;
        }
        let new = self.create(size, format);
        let fresh = Entry { version: key.version, shown: new.clone(), coming: None, last_used: Instant::now() };
        let entry = if size.0 * size.1 <= AT_ONCE_PIXELS {
            upload(&self.queue, &new, texels(&picture), || ());
            fresh
        } else {
            let (queue, texture, wake) = (self.queue.clone(), new.clone(), wake.clone());
            std::thread::spawn(move || upload(&queue, &texture, texels(&picture), || wake()));
            // The old numbers stay on screen until the new ones are complete.
            match self.entries.remove(&key.id).filter(|entry| entry.shown.size == size) {
                Some(old) => Entry { coming: Some((key.version, new)), ..old },
                None => fresh,
            }
        };
        let shown = OnCard { texture: entry.shown.clone(), is_current: entry.version == key.version };
        self.entries.insert(key.id, entry);
        self.forget_unused();
        shown
    }

    fn create(&self, size: (usize, usize), format: wgpu::TextureFormat) -> Arc<CardTexture> {
        let levels = level_count(size);
        let fits = |level: &u32| {
            let (width, height) = level_size(size, *level);
            width.max(height) <= self.max_side
        };
        let dropped = (0..levels).find(fits).unwrap_or(levels - 1);
        let (width, height) = level_size(size, dropped);
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("canvas plane"),
            size: wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 },
            mip_level_count: levels - dropped,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Arc::new(CardTexture { view, texture, size, dropped, finest: AtomicU32::new(levels) })
    }

    /// Gives up what was not drawn for a while, the longest unseen first, until the rest fits the budget.
    fn forget_unused(&mut self) {
        let mut bytes: u64 = self.entries.values().map(|entry| entry.shown.bytes()).sum();
        let mut unused: Vec<(Instant, u64)> = self
            .entries
            .iter()
            .filter(|(_, entry)| entry.last_used.elapsed() > A_WHILE)
            .map(|(&id, entry)| (entry.last_used, id))
            .collect();
        unused.sort_unstable();
        for (_, id) in unused {
            if bytes <= BUDGET_BYTES {
                return;
            }
            bytes -= self.entries.remove(&id).map_or(0, |entry| entry.shown.bytes());
        }
    }
}

/// Sends the copies to the card, the smallest first, so that something can be seen at once; `arrived` is called after each.
fn upload<T: Texel>(queue: &wgpu::Queue, texture: &CardTexture, texels: &[T], arrived: impl Fn()) {
    let copies = smaller_copies(texture.size, texels);
    for level in (texture.dropped..level_count(texture.size)).rev() {
        let copy = if level == 0 { texels } else { &copies[level as usize - 1] };
        upload_level(queue, texture, level, copy);
        texture.finest.store(level, Ordering::Release);
        arrived();
    }
}

fn upload_level<T: Texel>(queue: &wgpu::Queue, texture: &CardTexture, level: u32, texels: &[T]) {
    let (width, height) = level_size(texture.size, level);
    let rows = (PIECE_PIXELS / width).max(1);
    for (piece, texels) in texels.chunks(rows * width).enumerate() {
        let first_row = piece * rows;
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture.texture,
                mip_level: level - texture.dropped,
                origin: wgpu::Origin3d { x: 0, y: first_row as u32, z: 0 },
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some((width * size_of::<T>()) as u32),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: width as u32,
                height: rows.min(height - first_row) as u32,
                depth_or_array_layers: 1,
            },
        );
    }
}
