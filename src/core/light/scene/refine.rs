//! Triangles small enough to be patches.

use std::collections::HashMap;

use nalgebra::center;

use crate::Mesh;

/// The mesh with its long edges halved until it has about `patches` triangles of similar size; one that has as many
/// already stays as it is. Neighbours share the new vertices, so that no gap opens. Normals and colours are dropped.
pub fn refined(mesh: Mesh, patches: usize) -> Mesh {
    if mesh.triangles.len() >= patches {
        return mesh;
    }
    let area: f64 = mesh.triangles.iter().map(|triangle| area_of(&mesh, triangle)).sum();
    // An even triangle of edge a covers sqrt(3)/4 a^2; halving leaves edges between half the limit and the limit.
    let limit = 1.3 * (4.0 * area / (3f64.sqrt() * patches as f64)).sqrt();
    let mut mesh = Mesh { normals: Vec::new(), colours: Vec::new(), ..mesh };
    // Each round halves the longest edges: two dozen rounds divide any edge by sixteen million.
    for _ in 0..24 {
        let middles = middles_of_long_edges(&mut mesh, limit);
        if middles.is_empty() || mesh.triangles.len() >= 2 * patches {
            break;
        }
        let triangles = mesh.triangles.iter().flat_map(|triangle| cut(*triangle, &middles)).collect();
        mesh.triangles = triangles;
    }
    mesh
}

type Edge = (u32, u32);

fn edge(a: u32, b: u32) -> Edge {
    (a.min(b), a.max(b))
}

fn edges([a, b, c]: [u32; 3]) -> [Edge; 3] {
    [edge(a, b), edge(b, c), edge(c, a)]
}

fn area_of(mesh: &Mesh, triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].cast::<f64>());
    (b - a).cross(&(c - a)).norm() / 2.0
}

/// A new vertex in the middle of every edge longer than `limit`.
fn middles_of_long_edges(mesh: &mut Mesh, limit: f64) -> HashMap<Edge, u32> {
    let mut middles = HashMap::new();
    for (a, b) in mesh.triangles.iter().flat_map(|triangle| edges(*triangle)) {
        let (from, to) = (mesh.positions[a as usize], mesh.positions[b as usize]);
        if !middles.contains_key(&(a, b)) && f64::from((to - from).norm()) > limit {
            middles.insert((a, b), mesh.positions.len() as u32);
            mesh.positions.push(center(&from, &to));
        }
    }
    middles
}

/// The triangle cut at the middles of its edges, wound as before.
fn cut(triangle: [u32; 3], middles: &HashMap<Edge, u32>) -> Vec<[u32; 3]> {
    let [a, b, c] = triangle;
    match edges(triangle).map(|edge| middles.get(&edge).copied()) {
        [None, None, None] => vec![triangle],
        [Some(ab), Some(bc), Some(ca)] => vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]],
        [Some(ab), None, None] => vec![[a, ab, c], [ab, b, c]],
        [Some(ab), Some(bc), None] => vec![[ab, b, bc], [a, ab, bc], [a, bc, c]],
        // Turned until the first edge is cut and, of two, the last is whole.
        [None, Some(_), _] => cut([b, c, a], middles),
        [_, None, Some(_)] => cut([c, a, b], middles),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::scene::Shape;

    #[test]
    fn refining_keeps_the_surface_whole_and_its_area() {
        let coarse = Shape::Corner { wall_mm: 60.0, roll_deg: 20.0 }.mesh(6).unwrap();
        let (coarse, _) = coarse.welded();
        let outline_mm = |mesh: &Mesh| {
            let at = |vertex: u32| mesh.positions[vertex as usize].cast::<f64>();
            mesh.open_edges().border.iter().map(|&[a, b]| (at(b) - at(a)).norm()).sum::<f64>()
        };
        let area = |mesh: &Mesh| mesh.triangles.iter().map(|triangle| area_of(mesh, triangle)).sum::<f64>();
        let fine = refined(coarse.clone(), 800);
        assert!((600..1700).contains(&fine.triangles.len()), "{}", fine.triangles.len());
        assert!((area(&fine) / area(&coarse) - 1.0).abs() < 1e-5);
        // The outline has six edges of 60 mm; a gap inside would add to it.
        assert!((outline_mm(&fine) - 360.0).abs() < 1e-3, "{}", outline_mm(&fine));
        let sizes: Vec<f64> = fine.triangles.iter().map(|triangle| area_of(&fine, triangle)).collect();
        let (least, most) = sizes.iter().fold((f64::MAX, 0.0_f64), |(a, b), &area| (a.min(area), b.max(area)));
        assert!(most / least < 5.0, "{least} {most}");
    }

    #[test]
    fn a_fine_mesh_stays_as_it_is() {
        let mesh = Shape::Corner { wall_mm: 60.0, roll_deg: 0.0 }.mesh(300).unwrap();
        assert_eq!(refined(mesh.clone(), 200), mesh);
    }
}
