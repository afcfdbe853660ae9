//! Which part of a picture is seen, and the way between its pixels and the screen's points.

use eframe::egui::{Pos2, Rect, Vec2};

use crate::gpu::Placement;

/// Physical pixels of the screen for a pixel of the picture, at most.
pub const MAX_SCALE: f32 = 64.0;
/// The picture may be made this much smaller than it needs to fit.
const BELOW_FIT: f32 = 0.25;

/// Which part of a picture is seen. Linked canvases share one: it does not depend on their size.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum View {
    /// The whole picture, as large as it fits.
    #[default]
    Fit,
    /// The middle of the picture, one of its pixels for one of the screen's.
    OneToOne,
    /// A point of the picture in the middle of the canvas.
    At {
        /// That point, in pixels of the picture.
        centre_px: [f64; 2],
        /// Physical pixels of the screen for a pixel of the picture; 1 is one to one.
        scale: f32,
    },
}

impl View {
    /// The same place, one to one.
    pub fn one_to_one(self) -> Self {
        match self {
            Self::Fit | Self::OneToOne => Self::OneToOne,
            Self::At { centre_px, .. } => Self::At { centre_px, scale: 1.0 },
        }
    }

    /// The transform of this view on a canvas. `rect` is in points, `size` in pixels of the picture.
    pub fn transform(self, rect: Rect, size: (usize, usize), pixels_per_point: f32) -> Transform {
        let size = [size.0 as f64, size.1 as f64];
        let fit = fit_scale(rect, size, pixels_per_point);
        let (centre_px, scale) = match self {
            Self::Fit => ([0.5 * size[0], 0.5 * size[1]], fit),
            Self::OneToOne => ([0.5 * size[0], 0.5 * size[1]], 1.0),
            Self::At { centre_px, scale } => (centre_px, scale.clamp(min_scale(fit), MAX_SCALE)),
        };
        // Whole physical pixels: at one to one each pixel of the picture is one of the screen.
        let corner = |centre: f32, centre_px: f64| {
            (f64::from(centre * pixels_per_point) - centre_px * f64::from(scale)).round() as f32
        };
        let origin_px = [corner(rect.center().x, centre_px[0]), corner(rect.center().y, centre_px[1])];
        Transform { rect, size, placement: Placement { origin_px, scale }, centre_px, fit, pixels_per_point }
    }
}

fn fit_scale(rect: Rect, size: [f64; 2], pixels_per_point: f32) -> f32 {
    let across = rect.width() * pixels_per_point / size[0].max(1.0) as f32;
    let down = rect.height() * pixels_per_point / size[1].max(1.0) as f32;
    across.min(down).clamp(f32::MIN_POSITIVE.sqrt(), MAX_SCALE)
}

fn min_scale(fit: f32) -> f32 {
    (BELOW_FIT * fit).min(1.0)
}

/// The way between pixels of the picture (x right, y down, centres at .5) and points of the screen, for one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// The canvas, in points.
    pub rect: Rect,
    size: [f64; 2],
    placement: Placement,
    centre_px: [f64; 2],
    fit: f32,
    pixels_per_point: f32,
}

impl Transform {
    /// From pixels of the picture to points of the screen.
    pub fn to_screen(&self, image_px: [f64; 2]) -> Pos2 {
        let along = |axis: usize| {
            let pixel = f64::from(self.placement.origin_px[axis]) + image_px[axis] * f64::from(self.placement.scale);
            (pixel / f64::from(self.pixels_per_point)) as f32
        };
        Pos2::new(along(0), along(1))
    }

    /// From points of the screen to pixels of the picture, inside it or not.
    pub fn from_screen(&self, point: Pos2) -> [f64; 2] {
        let along = |coordinate: f32, axis: usize| {
            let pixel = f64::from(coordinate) * f64::from(self.pixels_per_point);
            (pixel - f64::from(self.placement.origin_px[axis])) / f64::from(self.placement.scale)
        };
        [along(point.x, 0), along(point.y, 1)]
    }

    /// The pixel `(x, y)` of the picture under a point of the screen.
    pub fn pixel_at(&self, point: Pos2) -> Option<(usize, usize)> {
        let [x, y] = self.from_screen(point);
        let inside = x >= 0.0 && y >= 0.0 && x < self.size[0] && y < self.size[1];
        inside.then_some((x as usize, y as usize))
    }

    /// A length in pixels of the picture, in points of the screen.
    pub fn points(&self, length_px: f64) -> f32 {
        length_px as f32 * self.points_per_px()
    }

    /// Points of the screen for a pixel of the picture.
    pub fn points_per_px(&self) -> f32 {
        self.placement.scale / self.pixels_per_point
    }

    /// Physical pixels of the screen for a pixel of the picture.
    pub fn scale(&self) -> f32 {
        self.placement.scale
    }

    /// Where the picture lies on the window's physical pixels.
    pub fn placement(&self) -> Placement {
        self.placement
    }

    /// The picture's outline on the screen.
    pub fn image_rect(&self) -> Rect {
        Rect::from_min_max(self.to_screen([0.0, 0.0]), self.to_screen(self.size))
    }

    /// The view with everything `factor` times larger, `anchor` staying where it is.
    pub fn zoomed(&self, factor: f32, anchor: Pos2) -> View {
        let scale = (self.placement.scale * factor).clamp(min_scale(self.fit), MAX_SCALE);
        let fixed = self.from_screen(anchor);
        let kept = f64::from(self.placement.scale) / f64::from(scale);
        let centre = [0, 1].map(|axis| fixed[axis] + (self.centre_px[axis] - fixed[axis]) * kept);
        self.view(centre, scale)
    }

    /// The view one to one, its middle staying where it is.
    pub fn one_to_one(&self) -> View {
        self.view(self.centre_px, 1.0)
    }

    /// The view with the picture moved by `delta` points.
    pub fn panned(&self, delta: Vec2) -> View {
        let per_px = f64::from(self.points_per_px());
        let centre = [self.centre_px[0] - f64::from(delta.x) / per_px, self.centre_px[1] - f64::from(delta.y) / per_px];
        self.view(centre, self.placement.scale)
    }

    /// The picture cannot be lost: its pixels hold the middle of the canvas.
    fn view(&self, centre: [f64; 2], scale: f32) -> View {
        View::At { centre_px: [0, 1].map(|axis| centre[axis].clamp(0.0, self.size[axis])), scale }
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::{pos2, vec2};
    use proptest::prelude::*;

    use super::*;

    fn canvas() -> Rect {
        Rect::from_min_size(pos2(13.0, 27.5), vec2(641.0, 480.0))
    }

    #[test]
    fn fit_shows_the_whole_picture_and_no_more() {
        for pixels_per_point in [1.0, 1.25, 2.0] {
            let transform = View::Fit.transform(canvas(), (4000, 3000), pixels_per_point);
            let image = transform.image_rect();
            let pixel = 1.0 / pixels_per_point;
            assert!(canvas().expand(pixel).contains_rect(image));
            assert!((image.height() - 480.0).abs() < pixel || (image.width() - 641.0).abs() < pixel);
        }
    }

    #[test]
    fn one_to_one_means_physical_pixels() {
        let transform =
            View::Fit.transform(canvas(), (4001, 3000), 1.5).one_to_one().transform(canvas(), (4001, 3000), 1.5);
        assert_eq!(transform.scale(), 1.0);
        let corner = transform.to_screen([0.0, 0.0]) * 1.5;
        assert!((corner.x - corner.x.round()).abs() < 1e-3 && (corner.y - corner.y.round()).abs() < 1e-3);
    }

    proptest! {
        #[test]
        fn to_screen_and_back_is_the_same_pixel(
            x in 0.0..4000.0_f64, y in 0.0..3000.0_f64, scale in 0.1..64.0_f32, density in 1.0..3.0_f32,
        ) {
            let transform = View::At { centre_px: [x, y], scale }.transform(canvas(), (4000, 3000), density);
            let there = [x + 3.25, y - 2.5];
            let back = transform.from_screen(transform.to_screen(there));
            prop_assert!((back[0] - there[0]).hypot(back[1] - there[1]) * f64::from(scale) < 0.01);
        }

        #[test]
        fn zooming_keeps_what_is_under_the_cursor(
            x in 500.0..3500.0_f64, y in 500.0..2500.0_f64, scale in 0.5..20.0_f32, factor in 0.8..3.0_f32,
            right in 100.0..500.0_f32, down in 100.0..400.0_f32,
        ) {
            let before = View::At { centre_px: [x, y], scale }.transform(canvas(), (4000, 3000), 1.0);
            let cursor = canvas().min + vec2(right, down);
            let after = before.zoomed(factor, cursor).transform(canvas(), (4000, 3000), 1.0);
            let moved = after.to_screen(before.from_screen(cursor)) - cursor;
            // The picture is kept on whole physical pixels.
            prop_assert!(moved.length() < 1.5, "{moved:?}");
            prop_assert!(after.scale() <= MAX_SCALE);
        }
    }
}
