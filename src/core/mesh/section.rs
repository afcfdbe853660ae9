//! The line along which a plane cuts a mesh.

use std::collections::HashMap;

use nalgebra::{Point3, UnitVector3};
use rayon::prelude::*;

use super::Mesh;

/// No segment.
const NONE: u32 = u32::MAX;

/// An edge of the mesh that the plane crosses, the smaller vertex first.
type Edge = (u32, u32);

/// Cuts `mesh` with the plane through `point` across `normal`: lines from one border to another, or closed, in the mesh's
/// unit. A line that is closed ends where it began.
pub fn section(mesh: &Mesh, point: &Point3<f64>, normal: &UnitVector3<f64>) -> Vec<Vec<Point3<f64>>> {
    let heights: Vec<f32> = mesh.positions.par_iter().map(|p| normal.dot(&(p.cast::<f64>() - point)) as f32).collect();
    let height = |vertex: u32| heights.get(vertex as usize).copied().unwrap_or(0.0);
    // A vertex on the plane counts as above it: no triangle is then touched in a corner alone.
    let above = |vertex: u32| height(vertex) >= 0.0;
    let crossed = |a: u32, b: u32| (above(a) != above(b)).then_some((a.min(b), a.max(b)));
    let segments: Vec<[Edge; 2]> = mesh
        .triangles
        .par_iter()
        .filter_map(|&[a, b, c]| {
            let mut edges = [crossed(a, b), crossed(b, c), crossed(c, a)].into_iter().flatten();
            Some([edges.next()?, edges.next()?])
        })
        .collect();
    let place = |(a, b): Edge| {
        let (low, high) = (f64::from(height(a)), f64::from(height(b)));
        let at = |vertex: u32| mesh.positions[vertex as usize].cast::<f64>();
        at(a) + (at(b) - at(a)) * (low / (low - high))
    };
    chains(&segments).into_iter().map(|chain| chain.into_iter().map(place).collect()).collect()
}

/// Joins segments that share an edge into lines.
fn chains(segments: &[[Edge; 2]]) -> Vec<Vec<Edge>> {
    let mut meeting: HashMap<Edge, [u32; 2]> = HashMap::with_capacity(segments.len());
    for (number, ends) in (0..).zip(segments) {
        for end in ends {
            let there = meeting.entry(*end).or_insert([NONE; 2]);
            // A third triangle at an edge begins a line of its own.
            if let Some(free) = there.iter_mut().find(|slot| **slot == NONE) {
                *free = number;
            }
        }
    }
    let is_open = |end: &Edge| meeting.get(end).is_some_and(|there| there[1] == NONE);
    let mut used = vec![false; segments.len()];
    let mut lines = Vec::new();
    // Lines that end at a border begin there; what is left is closed.
    let from_border = (0..segments.len()).filter(|&number| segments[number].iter().any(is_open));
    for start in from_border.chain(0..segments.len()) {
        if std::mem::replace(&mut used[start], true) {
            continue;
        }
        let [one, other] = segments[start];
        let (first, mut end) = if is_open(&other) && !is_open(&one) { (other, one) } else { (one, other) };
        let mut line = vec![first, end];
        let next = |end: &Edge, used: &[bool]| {
            let there = meeting.get(end)?;
            there.iter().copied().find(|&number| number != NONE && !used[number as usize])
        };
        while let Some(number) = next(&end, &used) {
            used[number as usize] = true;
            let [one, other] = segments[number as usize];
            end = if one == end { other } else { one };
            line.push(end);
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::mesh::compare::test_meshes::{bumps, cut, relief};

    #[test]
    fn a_relief_is_cut_into_one_line_with_its_heights() {
        let mesh = relief(60, 0.5, bumps);
        let lines = section(&mesh, &Point3::new(0.0, 2.25, 0.0), &Vector3::y_axis());
        assert_eq!(lines.len(), 1);
        assert!(lines[0].len() > 60);
        let mut xs: Vec<_> = lines[0].iter().map(|p| p.x).collect();
        if xs[0] > 0.0 {
            xs.reverse();
        }
        assert!(xs.windows(2).all(|pair| pair[0] <= pair[1]), "in order");
        assert!((xs[0] + 15.0).abs() < 1e-5 && (xs[xs.len() - 1] - 15.0).abs() < 1e-5);
        for p in &lines[0] {
            assert!((p.y - 2.25).abs() < 1e-5 && (p.z - bumps(p.x, p.y)).abs() < 0.05, "{p}");
        }
    }

    #[test]
    fn a_hole_makes_two_lines_and_a_peak_a_closed_one() {
        let holed = cut(relief(60, 0.5, |_, _| 0.0), |p| p.coords.norm() > 4.0);
        assert_eq!(section(&holed, &Point3::origin(), &Vector3::x_axis()).len(), 2);
        let peak = relief(60, 0.5, |x, y| 10.0 - 0.1 * (x * x + y * y));
        let rings = section(&peak, &Point3::new(0.0, 0.0, 5.0), &Vector3::z_axis());
        assert_eq!(rings.len(), 1);
        assert_eq!(rings[0].first(), rings[0].last());
        let radius = 50f64.sqrt();
        assert!(rings[0].iter().all(|p| (p.x.hypot(p.y) - radius).abs() < 0.02));
        assert!(section(&peak, &Point3::new(0.0, 0.0, 50.0), &Vector3::z_axis()).is_empty());
    }
}
