//! The direct light of a lamp, and what the lab makes of that of all lamps.

use firstbounce_core::image::photo::CLIPPED;
use firstbounce_core::methods::colours_and_shape::{
    ColoursAndShape, ColoursAndShapeOptions, Photographed, SeparatedLight, separate_by_colours_and_shape,
};
use firstbounce_core::separate::{LightPhotos, Separation, UNSOLVED};
use firstbounce_core::stereo::normals::{DirectLight, Lamp, Normals, NormalsOptions, Paint, Surface, normals};
use firstbounce_core::stereo::shape::ShapeOptions;
use firstbounce_core::{Camera, Marks, Mask, Photo, Plane, Portion, Watch};

use super::LabError;

/// What photometric stereo takes of one light.
pub(crate) struct Direct {
    pub light: Plane,
    pub noise: Option<Plane>,
    pub marks: Marks,
}

impl Direct {
    /// A photo taken for direct light.
    pub fn of_photo(photo: Photo) -> Self {
        let marks = photo.marks.map(|marks| if marks & CLIPPED != 0 { marks | UNSOLVED } else { marks });
        Self { light: photo.linear, noise: None, marks }
    }

    /// Bounce 1.
    pub fn of_separation(separation: Separation) -> Self {
        let Separation { bounces, marks, .. } = separation;
        Self { light: bounces.into_iter().next().unwrap_or_default(), noise: None, marks }
    }
}

impl From<SeparatedLight> for Direct {
    fn from(SeparatedLight { direct, noise, marks, .. }: SeparatedLight) -> Self {
        Self { light: direct, noise: Some(noise), marks }
    }
}

/// Where the lamps are, with their intensities, and what sees the object.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    pub lamps: &'a [(Lamp, f64)],
    pub mask: &'a Mask,
    pub camera: &'a Camera,
}

impl Place<'_> {
    /// Separates by colours and shape together as the program does where it is left its choices: photometric stereo looks whether
    /// one paint will do ([`Paint::Auto`]).
    pub fn by_colours_and_shape(&self, lights: &[LightPhotos], watch: &dyn Watch) -> Result<ColoursAndShape, LabError> {
        let lamps: Vec<_> = self.lamps.iter().copied().map(Some).collect();
        let photographed =
            Photographed { lights, lamps: &lamps, mask: self.mask, camera: self.camera, white_light: None };
        let normals = NormalsOptions { paint: Paint::Auto, ..NormalsOptions::default() };
        let shape = ShapeOptions { normals, ..ShapeOptions::default() };
        let options = ColoursAndShapeOptions::default();
        Ok(separate_by_colours_and_shape(&photographed, &options, &shape, watch, &mut |_| {})?)
    }

    /// The normals that direct light shows.
    pub fn normals(
        &self,
        lights: &[Direct],
        depth_mm: Option<&Plane>,
        paint: Paint,
        watch: &dyn Watch,
    ) -> Result<Normals, LabError> {
        let placed = lights.iter().zip(self.lamps).map(|(light, &(lamp, intensity))| DirectLight {
            direct: &light.light,
            noise: light.noise.as_ref(),
            marks: &light.marks,
            lamp,
            intensity,
        });
        let placed: Vec<_> = placed.collect();
        let options = NormalsOptions { paint, ..NormalsOptions::default() };
        let surface = Surface { camera: self.camera, depth_mm };
        Ok(normals(&placed, self.mask, surface, &options, &Portion::still(watch, 0.0))?.0)
    }
}
