//! Pictures on their way to the graphics card.

use std::sync::{Arc, OnceLock};

use eframe::wgpu;

use super::pyramid::{Texel, level_count, level_size, smaller_copies};
use super::textures::CardTexture;

/// Pictures up to this many pixels are made ready at once, larger ones on a thread of their own.
const AT_ONCE_PIXELS: usize = 1 << 20;
/// Copies up to this many pixels are always sent, so that every plane of a drawing can be seen, if coarsely, from the start.
const FREE_PIXELS: usize = 1 << 18;

/// Called when there is more to draw.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// A picture with its smaller copies, as bytes.
trait Levels: Send + Sync {
    fn bytes(&self, level: u32) -> &[u8];
}

struct Pyramid<T, P> {
    picture: Arc<P>,
    texels: fn(&P) -> &[T],
    /// Levels 1, 2, and so on.
    copies: Vec<Vec<T>>,
}

impl<T: Texel, P: Send + Sync> Levels for Pyramid<T, P> {
    fn bytes(&self, level: u32) -> &[u8] {
        bytemuck::cast_slice(match level {
            0 => (self.texels)(&self.picture),
            _ => &self.copies[level as usize - 1],
        })
    }
}

/// Sends a picture in pieces, the smallest copy first, so that something can be seen at once.
///
/// The copies are computed on another thread, but the queue is only written on the thread that submits to it: with wgpu 30,
/// `write_texture` on one thread and `submit` on another wait for each other for ever when both meet at a new texture.
pub struct Transfer {
    levels: Arc<OnceLock<Box<dyn Levels>>>,
    wake: Wake,
    /// The finest level that is complete; `level_count` while there is none.
    pub finest: u32,
    /// Rows of the next level that are sent.
    rows_sent: usize,
}

impl Transfer {
    /// Makes the smaller copies of a picture; `wake` is called when they are ready.
    pub fn begin<T: Texel, P: Send + Sync + 'static>(
        size: (usize, usize),
        picture: Arc<P>,
        texels: fn(&P) -> &[T],
        wake: &Wake,
    ) -> Self {
        let levels: Arc<OnceLock<Box<dyn Levels>>> = Arc::default();
        let (ready, woken) = (levels.clone(), wake.clone());
        let prepare = move || {
            let copies = smaller_copies(size, texels(&picture));
            ready.get_or_init(|| Box::new(Pyramid { picture, texels, copies }));
        };
        if size.0 * size.1 <= AT_ONCE_PIXELS {
            prepare();
        } else {
            std::thread::spawn(move || {
                prepare();
                woken();
            });
        }
        Self { levels, wake: wake.clone(), finest: level_count(size), rows_sent: 0 }
    }

    /// Sends what is ready, as far as the allowance of bytes goes.
    pub fn send(&mut self, queue: &wgpu::Queue, texture: &CardTexture, allowance: &mut usize) {
        let ready = self.levels.clone();
        let Some(levels) = ready.get() else { return };
        while self.finest > texture.dropped {
            let level = self.finest - 1;
            let (width, height) = level_size(texture.size, level);
            let is_free = width * height <= FREE_PIXELS;
            let bytes_per_row = levels.bytes(level).len() / height;
            let rows = (height - self.rows_sent).min(if is_free { height } else { *allowance / bytes_per_row });
            if rows == 0 {
                (self.wake)();
                return;
            }
            texture.write_rows(queue, level, self.rows_sent, rows, levels.bytes(level));
            *allowance -= if is_free { 0 } else { rows * bytes_per_row };
            self.rows_sent += rows;
            if self.rows_sent == height {
                (self.finest, self.rows_sent) = (level, 0);
            }
        }
        // All is on the card. Giving the copies back takes a while when they are large.
        self.levels = Arc::default();
        if texture.size.0 * texture.size.1 > AT_ONCE_PIXELS {
            std::thread::spawn(move || drop(ready));
        }
    }
}
