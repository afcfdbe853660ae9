//! Planes on the graphics card.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::wgpu;

use super::pyramid::{Texel, level_count, level_size};
use super::transfer::{Transfer, Wake};
use super::{CanvasMarks, CanvasPlane, PlaneKey};

/// Textures not seen for a while are given up when all of them together are larger than this: eight photos of 24 Mpx.
const BUDGET_BYTES: u64 = 1 << 30;
const A_WHILE: Duration = Duration::from_secs(2);
/// Bytes sent to the card in one frame, by all pictures together: the window waits a few milliseconds for them, and never for a
/// whole picture.
const FRAME_BYTES: usize = 1 << 22;

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
    pub size: (usize, usize),
    /// The picture's level that is mip level 0: more than 0 if the picture is larger than the card's textures.
    pub dropped: u32,
}

impl CardTexture {
    /// Writes whole rows of one level; `bytes` is all of that level.
    pub fn write_rows(&self, queue: &wgpu::Queue, level: u32, first_row: usize, rows: usize, bytes: &[u8]) {
        let (width, height) = level_size(self.size, level);
        let bytes_per_row = bytes.len() / height;
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &self.texture,
                mip_level: level - self.dropped,
                origin: wgpu::Origin3d { x: 0, y: first_row as u32, z: 0 },
                aspect: wgpu::TextureAspect::All,
            },
            &bytes[first_row * bytes_per_row..][..rows * bytes_per_row],
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(bytes_per_row as u32), rows_per_image: None },
            wgpu::Extent3d { width: width as u32, height: rows as u32, depth_or_array_layers: 1 },
        );
    }

    fn bytes(&self) -> u64 {
        let texel = self.texture.format().block_copy_size(None).unwrap_or(4);
        u64::from(self.texture.width()) * u64::from(self.texture.height()) * u64::from(texel) * 4 / 3
    }
}

/// A texture to draw with.
pub struct OnCard {
    pub texture: Arc<CardTexture>,
    /// The finest level that can be read; `None` before the first has arrived.
    pub finest: Option<u32>,
    /// Whether these are the numbers asked for, and not the ones before.
    pub is_current: bool,
}

/// A version of a picture, on the card or on its way.
struct Version {
    number: u64,
    texture: Arc<CardTexture>,
    transfer: Transfer,
}

impl Version {
    fn is_complete(&self) -> bool {
        self.transfer.finest == self.texture.dropped
    }

    fn on_card(&self, wanted: u64) -> OnCard {
        let finest = Some(self.transfer.finest).filter(|&finest| finest < level_count(self.texture.size));
        OnCard { texture: self.texture.clone(), finest, is_current: self.number == wanted }
    }
}

struct Entry {
    shown: Version,
    /// The next version, until it is complete.
    coming: Option<Version>,
    last_used: Instant,
}

impl Entry {
    /// Sends more of what is on its way, and shows the next version when it is complete.
    fn advance(&mut self, queue: &wgpu::Queue, allowance: &mut usize) {
        self.last_used = Instant::now();
        let sent = self.coming.as_mut().unwrap_or(&mut self.shown);
        sent.transfer.send(queue, &sent.texture, allowance);
        if let Some(complete) = self.coming.take_if(|coming| coming.is_complete()) {
            self.shown = complete;
        }
    }

    /// Whether the upload of `version` has to wait or is not needed. While another version is on its way nothing is begun, so
    /// that a fast change of numbers skips versions instead of queueing them.
    fn serves(&self, version: u64) -> bool {
        self.shown.number == version || self.coming.is_some()
    }
}

/// All textures of planes and marks, by the id of their keys.
pub struct Textures {
    device: wgpu::Device,
    queue: wgpu::Queue,
    max_side: usize,
    /// Bytes that this frame may still send.
    allowance: usize,
    entries: HashMap<u64, Entry>,
}

impl Textures {
    /// None yet. `max_side` is the largest width or height of a texture, in pixels.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue, max_side: usize) -> Self {
        Self { device, queue, max_side, allowance: FRAME_BYTES, entries: HashMap::new() }
    }

    /// The texture of a plane, its upload begun if the card does not have this version.
    pub fn plane(&mut self, plane: &CanvasPlane, wake: &Wake) -> OnCard {
        let format = wgpu::TextureFormat::R32Float;
        self.texture(plane.key, plane.plane.size(), format, plane.plane.clone(), |plane| plane.data(), wake)
    }

    /// The texture of marks, its upload begun if the card does not have this version.
    pub fn marks(&mut self, marks: &CanvasMarks, wake: &Wake) -> OnCard {
        let format = wgpu::TextureFormat::R8Uint;
        self.texture(marks.key, marks.marks.size(), format, Arc::new(marks.marks.clone()), |marks| marks.data(), wake)
    }

    /// Allows the transfers of one frame.
    pub fn begin_frame(&mut self) {
        self.allowance = FRAME_BYTES;
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
        let entry = self.entries.get_mut(&key.id).filter(|entry| entry.shown.texture.size == size);
        if let Some(entry) = entry {
            entry.advance(&self.queue, &mut self.allowance);
            if entry.serves(key.version) {
                return entry.shown.on_card(key.version);
            }
        }
        let transfer = Transfer::begin(size, picture, texels, wake);
        let new = Version { number: key.version, texture: self.create(size, format), transfer };
        // The old numbers stay on screen until the new ones are complete.
        let mut entry = match self.entries.remove(&key.id).filter(|entry| entry.shown.texture.size == size) {
            Some(old) => Entry { coming: Some(new), ..old },
            None => Entry { shown: new, coming: None, last_used: Instant::now() },
        };
        entry.advance(&self.queue, &mut self.allowance);
        let on_card = entry.shown.on_card(key.version);
        self.entries.insert(key.id, entry);
        self.forget_unused();
        on_card
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
        Arc::new(CardTexture { view, texture, size, dropped })
    }

    /// Gives up what was not drawn for a while, the longest unseen first, until the rest fits the budget.
    fn forget_unused(&mut self) {
        let mut bytes: u64 = self.entries.values().map(|entry| entry.shown.texture.bytes()).sum();
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
            bytes -= self.entries.remove(&id).map_or(0, |entry| entry.shown.texture.bytes());
        }
    }
}
