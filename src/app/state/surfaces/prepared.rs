//! A surface made ready to be drawn, picked and cut, off the UI thread.

use std::sync::Arc;

use firstbounce_core::Mesh;
use firstbounce_core::mesh::{Coarse, LengthUnit, Pickable};
use thiserror::Error;

use crate::gpu::mesh::Geometry;

/// Meshes with more triangles are shown coarser.
const MAX_TRIANGLES: usize = 1_000_000;
/// How many triangles are shown of those.
const COARSE_TRIANGLES: usize = 500_000;

/// A surface of which nothing can be drawn.
#[derive(Clone, Copy, Debug, Error)]
#[error("this surface has no triangles")]
pub struct NoTriangles;

/// A surface made ready.
pub struct Prepared {
    /// The full mesh.
    pub source: Arc<Mesh>,
    /// As the card takes it.
    pub geometry: Arc<Geometry>,
    /// What is shown of a mesh that is too large: its numbers in the full one, and the mesh.
    pub coarse: Option<(Coarse, Mesh)>,
    /// The full mesh, to be clicked on.
    pub pickable: Option<Pickable>,
}

impl Prepared {
    /// Makes a mesh ready; an error for one without triangles.
    pub fn new(source: Arc<Mesh>) -> Result<Self, NoTriangles> {
        Self::with_limit(source, MAX_TRIANGLES, COARSE_TRIANGLES)
    }

    fn with_limit(source: Arc<Mesh>, most: usize, coarse: usize) -> Result<Self, NoTriangles> {
        let full = &*source;
        let coarse = (full.triangles.len() > most).then(|| {
            let coarse = Coarse::of(full, coarse);
            let mesh = coarse.mesh(full);
            (coarse, mesh)
        });
        let shown = coarse.as_ref().map_or(full, |(_, mesh)| mesh);
        let geometry = Geometry::new(shown).ok_or(NoTriangles)?;
        let pickable = Pickable::new(full);
        Ok(Self { geometry: Arc::new(geometry), coarse, pickable, source })
    }

    /// The triangles that are shown.
    pub fn shown(&self) -> &Mesh {
        self.coarse.as_ref().map_or(&self.source, |(_, mesh)| mesh)
    }

    /// Values of the full mesh's vertices as values of those that are shown; NaN for none.
    pub fn shown_values(&self, full: &[Option<f32>]) -> Vec<f32> {
        let value = |vertex: usize| full.get(vertex).copied().flatten().unwrap_or(f32::NAN);
        match &self.coarse {
            Some((coarse, _)) => coarse.kept.iter().map(|&vertex| value(vertex as usize)).collect(),
            None => (0..full.len()).map(value).collect(),
        }
    }

    /// What the user should know of a surface that is shown coarser than it is.
    pub fn words(&self) -> Option<String> {
        let (_, mesh) = self.coarse.as_ref()?;
        Some(format!(
            "shown with {} of {} triangles; export stays full",
            thousands(mesh.triangles.len()),
            thousands(self.source.triangles.len())
        ))
    }

    /// The name of its unit.
    pub fn unit(&self) -> &'static str {
        match self.source.unit {
            LengthUnit::Millimetre => "mm",
            LengthUnit::Pixel => "px",
        }
    }
}

/// A number in groups of three digits.
pub fn thousands(number: usize) -> String {
    let digits = number.to_string();
    let mut grouped = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;

    /// A flat square of `cells` x `cells` squares.
    fn square(cells: u32) -> Mesh {
        let side = cells + 1;
        Mesh {
            positions: (0..side * side).map(|i| Point3::new((i % side) as f32, (i / side) as f32, 0.0)).collect(),
            normals: vec![],
            colours: vec![],
            triangles: (0..cells * cells)
                .flat_map(|cell| {
                    let corner = cell / cells * side + cell % cells;
                    [[corner, corner + 1, corner + side + 1], [corner, corner + side + 1, corner + side]]
                })
                .collect(),
            unit: LengthUnit::Millimetre,
        }
    }

    #[test]
    fn a_large_mesh_is_shown_coarser_with_the_values_of_its_own_vertices() {
        let mesh = square(100);
        let values: Vec<_> = mesh.positions.iter().map(|p| Some(p.x + 1000.0 * p.y)).collect();
        let prepared = Prepared::with_limit(Arc::new(mesh), 10_000, 4_000).unwrap();
        let shown = prepared.shown();
        assert!(shown.triangles.len() <= 4_000 && shown.triangles.len() > 1_000);
        let shown_values = prepared.shown_values(&values);
        assert_eq!(shown_values.len(), shown.positions.len());
        assert!(shown.positions.iter().zip(&shown_values).all(|(p, value)| *value == p.x + 1000.0 * p.y));
        let words = prepared.words().unwrap();
        assert!(words.ends_with("of 20 000 triangles; export stays full"), "{words}");
    }

    #[test]
    fn digits_are_grouped_by_three() {
        assert_eq!([0, 999, 1000, 2_100_000].map(thousands), ["0", "999", "1 000", "2 100 000"]);
    }
}
