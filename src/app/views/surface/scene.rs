//! From layers and a look to what the card draws.

use eframe::egui::{Color32, Visuals};

use super::profile::Seen;
use crate::app::state::document::Document;
use crate::app::state::results::Results;
use crate::app::state::session::Session;
use crate::app::state::surfaces::{LayerColours, LayerName, Shade, SurfaceLook};
use crate::gpu::mesh::{LayerDrawing, Shading, Shared};

/// Edges that are this long on the screen are drawn in full.
const OPEN_EDGE_PX: f64 = 8.0;

/// Values for the heat map, and its ends.
pub struct Heat {
    /// For each vertex that is shown, by layer.
    pub values: Vec<(LayerName, Shared<Vec<f32>>)>,
    /// The distance at the ends of the colours.
    pub largest_mm: f32,
}

impl Heat {
    /// Distances to the reference of both surfaces; the colours end where 95 % of those that are seen do. `None` without a
    /// comparison of what there is.
    pub fn of(session: &mut Session, look: &SurfaceLook, seen: &[Seen]) -> Option<Self> {
        let mut p95_mm = 0.0_f64;
        let mut values = Vec::new();
        for name in [LayerName::AFTER, LayerName::BEFORE] {
            let Some(prepared) = session.surfaces.layer(name) else { continue };
            let Some((of_layer, own_mm)) = session.reference.heat(name, prepared) else { continue };
            if seen.iter().any(|seen| seen.name == name) {
                p95_mm = p95_mm.max(own_mm);
            }
            values.push((name, of_layer));
        }
        let largest_mm = look.distance_mm.unwrap_or(p95_mm as f32).max(f32::MIN_POSITIVE);
        (!values.is_empty()).then_some(Self { values, largest_mm })
    }
}

/// What the shading of a view needs from the rest of the program.
pub struct Light {
    /// What the surfaces are lit by, or coloured with.
    pub shading: Shading,
    /// Why not as asked.
    pub missing: Option<String>,
}

/// The shading that a look asks for, as far as the set knows what it needs.
pub fn light(look: &SurfaceLook, document: &Document, results: &Results, heat: Option<&Heat>, seen: &[Seen]) -> Light {
    let as_asked = |shading| Light { shading, missing: None };
    let instead = |line: String| Light { shading: Shading::Matcap, missing: Some(line) };
    match look.shade {
        Shade::Matcap => as_asked(Shading::Matcap),
        Shade::Headlight => as_asked(Shading::Headlight),
        Shade::Normals => as_asked(Shading::Normals),
        Shade::Albedo => as_asked(Shading::Albedo),
        Shade::Height => as_asked(Shading::Height(heights(seen))),
        Shade::Drag => {
            let [x, y, z] = look.dragged.0;
            as_asked(Shading::Lamp([x, y, z, 0.0]))
        }
        Shade::Lamp => match lamp(look, document, results) {
            Some((_, lamp)) => as_asked(Shading::Lamp(lamp)),
            None => instead("the directions to the lamps are unknown: see Calibrate".into()),
        },
        Shade::Distance => match heat {
            Some(heat) => as_asked(Shading::Distance(heat.largest_mm)),
            None => instead("there is no distance yet: load a reference in Shape and compare".into()),
        },
    }
}

/// The lamp that lights the surfaces, and its name.
pub fn lamp(look: &SurfaceLook, document: &Document, results: &Results) -> Option<(String, [f32; 4])> {
    let lights = &document.set.lights;
    let light = lights.iter().find(|light| Some(&light.name) == look.lamp.as_ref()).or(lights.first())?;
    let four = |[x, y, z]: [f64; 3], w: f32| [x as f32, y as f32, z as f32, w];
    if let Some(position) = light.position_mm {
        return Some((light.name.clone(), four(position, 1.0)));
    }
    let calibration = results.calibration()?;
    let index = calibration.lights.iter().position(|name| *name == light.name)?;
    let direction = calibration.calibrated.direction.get(index)?.as_ref()?;
    Some((light.name.clone(), four(direction.value, 0.0)))
}

/// The least and the largest z of all that is seen.
fn heights(seen: &[Seen]) -> [f32; 2] {
    let all: Vec<_> = seen.iter().map(|seen| seen.prepared.geometry.bounds.moved(&seen.pose).along(2)).collect();
    let low = all.iter().map(|[low, _]| *low).fold(f64::INFINITY, f64::min);
    let high = all.iter().map(|[_, high]| *high).fold(f64::NEG_INFINITY, f64::max);
    if low < high { [low as f32, high as f32] } else { [low as f32 - 0.5, low as f32 + 0.5] }
}

/// What the card draws; `unit_px` is the length of a pixel in the middle of the view.
pub fn drawings(
    look: &SurfaceLook,
    seen: &[Seen],
    shading: Shading,
    heat: Option<&Heat>,
    visuals: &Visuals,
    unit_px: f64,
) -> Vec<LayerDrawing> {
    let coloured = match look.colours {
        LayerColours::Always => true,
        LayerColours::Never => false,
        LayerColours::Several => seen.len() > 1,
    };
    let ink = if visuals.dark_mode { [0.07, 0.07, 0.08] } else { [0.16, 0.16, 0.18] };
    // Edges that lie closer than a few pixels would cover all of the surface.
    let wire = |edge_px: f64| [ink[0], ink[1], ink[2], (edge_px / OPEN_EDGE_PX).powi(2).clamp(0.02, 0.9) as f32];
    seen.iter()
        .map(|seen| {
            let layer = look.layer(seen.name);
            let values = heat.and_then(|heat| heat.values.iter().find(|(name, _)| *name == seen.name));
            let shading = match shading {
                _ if !layer.shaded => Shading::Plain,
                // The reference has no distance to itself.
                Shading::Distance(_) if values.is_none() => Shading::Matcap,
                shading => shading,
            };
            let own =
                coloured || shading == Shading::Plain || (shading == Shading::Matcap && look.shade == Shade::Distance);
            LayerDrawing {
                values: values.map(|(_, values)| values.clone()).filter(|_| matches!(shading, Shading::Distance(_))),
                world_from_mesh: seen.pose,
                shading,
                base: own.then(|| layer.colour.map(|channel| f32::from(channel) / 255.0)),
                wire: look.wireframe.then(|| wire(seen.prepared.geometry.edge_length / unit_px)),
                ..LayerDrawing::new(seen.prepared.geometry.clone())
            }
        })
        .collect()
}

/// A layer's own colour, for plots.
pub fn ink(look: &SurfaceLook, name: LayerName) -> Color32 {
    let [r, g, b] = look.layer(name).colour;
    Color32::from_rgb(r, g, b)
}
