//! Figure 3: errors against the ratio of albedos.

use firstbounce_core::{Portion, Watch};

use super::rendered::{Rendered, Rig, polynomial};
use super::{AllBouncesPoint, FIGURE3_BITS, Figure3Point, RATIOS};
use crate::{LabError, Sensor};

/// Bits, and the index of a ratio.
fn points() -> Vec<(u32, usize)> {
    FIGURE3_BITS.into_iter().flat_map(|bits| (0..RATIOS.len()).map(move |index| (bits, index))).collect()
}

impl Rendered {
    /// Two bounces of the scene's light, for any ratio of albedos.
    pub fn figure3(&self, watch: &dyn Watch) -> Result<Vec<Figure3Point>, LabError> {
        let point = |(bits, index): (u32, usize)| {
            let rig = Rig { alpha: vec![1.0; 2], beta: vec![1.0, RATIOS[index]] };
            let light = |lamp: usize, colour: usize| polynomial(self.bounces(lamp), rig.beta[colour]);
            let photos = self.photos(Some(Sensor::noiseless(bits)), &rig, light)?;
            let found = self.bounce_one(&photos, &rig, watch)?;
            let (error, truth) = self.direct_error(&found, &self.solved(&found));
            Ok(Figure3Point { ratio: RATIOS[index], bits, error_percent: 100.0 * error / truth })
        };
        points().into_iter().map(point).collect()
    }

    /// Light of every bounce, for any ratio of albedos: what separation makes of the normals.
    pub fn figure3_all_bounces(&self, watch: &dyn Watch) -> Result<Vec<AllBouncesPoint>, LabError> {
        let all = points();
        let point = |(done, &(bits, index)): (usize, &(u32, usize))| {
            let (ratio, sensor) = (RATIOS[index], Some(Sensor::noiseless(bits)));
            // A brighter paint sends on more often what it receives: without a dimmer lamp its photo clips in the cavity.
            let rig = Rig { alpha: vec![1.0, ratio.max(1.0).powi(-2)], beta: vec![1.0, ratio] };
            let light = |lamp: usize, colour: usize| match colour {
                0 => self.all_bounces(lamp).clone(),
                _ => self.all_bounces_of_ratio(lamp, index).clone(),
            };
            let photos = self.photos(sensor, &rig, light)?;
            let part = Portion::of(watch, done, all.len());
            let raw = self.reference(&photos, &Portion::still(&part, 0.0))?;
            let separated = self.by_bounces(&photos, &rig, &Portion::still(&part, 0.0))?;
            let together = self.by_colours_and_shape(&photos, &rig, sensor, &part)?;
            let compared = self.compared([Some(&raw), Some(&separated), Some(&together)]);
            Ok(AllBouncesPoint {
                ratio,
                bits,
                raw_deg: self.degrees(&raw, &compared)?,
                separated_deg: self.degrees(&separated, &compared)?,
                colours_and_shape_deg: self.degrees(&together, &compared)?,
            })
        };
        all.iter().enumerate().map(point).collect()
    }
}
