//! glTF 2.0 in its binary form (.glb): all surfaces of its scene as one mesh, in metres.

use gltf::mesh::Mode;
use gltf::{Gltf, Node, Primitive};
use nalgebra::{Matrix4, Point3, Vector3};

use super::own::Header;
use super::{MeshFormat, MeshProblem, RawMesh};

/// Nodes hang within each other no deeper than this; more would be a circle.
const MAX_DEPTH: usize = 64;

/// Reads a file, and whether this program wrote it.
pub(super) fn parse(bytes: &[u8]) -> Result<(RawMesh, Header), MeshProblem> {
    let file = Gltf::from_slice(bytes).map_err(|error| malformed(error.to_string()))?;
    let blob = file.blob.as_deref().unwrap_or_default();
    let mut mesh = Surfaces { raw: RawMesh::default(), blob, all_have: Attributes { normals: true, colours: true } };
    let scene = file.default_scene().or_else(|| file.scenes().next());
    match scene {
        Some(scene) => scene.nodes().try_for_each(|node| mesh.add_node(&node, &Matrix4::identity(), 0))?,
        // A library of meshes without a scene.
        None => file.meshes().flat_map(|of| of.primitives()).try_for_each(|p| mesh.add(&p, &Matrix4::identity()))?,
    }
    Ok((mesh.finish(), header_of(bytes)))
}

/// Where the JSON of a file begins, and where its length stands.
const JSON_START: usize = 20;
const JSON_LENGTH: std::ops::Range<usize> = 12..16;

/// Who wrote a file, and in which unit.
fn header_of(bytes: &[u8]) -> Header {
    let json = || {
        let length = u32::from_le_bytes(*bytes.get(JSON_LENGTH)?.first_chunk()?);
        let text = bytes.get(JSON_START..JSON_START.checked_add(length as usize)?)?;
        serde_json::from_slice::<serde_json::Value>(text).ok()
    };
    let asset = json().map(|json| json["asset"].clone()).unwrap_or_default();
    let is_own = asset["generator"] == "Firstbounce";
    let in_pixels = is_own && asset["extras"]["unit"].as_str().is_some_and(|unit| unit.contains("pixel"));
    Header { is_own, in_pixels, z_up: false }
}

fn malformed(reason: String) -> MeshProblem {
    MeshProblem::Malformed { format: MeshFormat::Glb, reason }
}

/// What all surfaces of a file have.
struct Attributes {
    normals: bool,
    colours: bool,
}

struct Surfaces<'b> {
    raw: RawMesh,
    blob: &'b [u8],
    all_have: Attributes,
}

impl Surfaces<'_> {
    fn add_node(&mut self, node: &Node<'_>, parent: &Matrix4<f64>, depth: usize) -> Result<(), MeshProblem> {
        if depth > MAX_DEPTH {
            return Err(malformed("its nodes lie within each other too deeply".into()));
        }
        let own = Matrix4::from_fn(|row, column| f64::from(node.transform().matrix()[column][row]));
        let placed = parent * own;
        for primitive in node.mesh().into_iter().flat_map(|mesh| mesh.primitives()) {
            self.add(&primitive, &placed)?;
        }
        node.children().try_for_each(|child| self.add_node(&child, &placed, depth + 1))
    }

    fn add(&mut self, primitive: &Primitive<'_>, placed: &Matrix4<f64>) -> Result<(), MeshProblem> {
        if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        self.check_buffers(primitive)?;
        let blob = self.blob;
        let reader = primitive.reader(|buffer| (buffer.index() == 0).then_some(blob));
        let positions = reader.read_positions().ok_or_else(|| malformed("a surface has no positions".into()))?;
        let first = self.raw.positions.len() as u32;
        let point = |p: [f32; 3]| -> [f64; 3] { placed.transform_point(&Point3::from(p).cast()).into() };
        self.raw.positions.extend(positions.map(point));
        let vertices = self.raw.positions.len() as u32 - first;

        let turned = placed.fixed_view::<3, 3>(0, 0).into_owned();
        match reader.read_normals() {
            // Right for turns and even scales; others contradict the triangles, and are computed.
            Some(normals) => {
                let normal = |n: [f32; 3]| -> [f32; 3] { (turned * Vector3::from(n).cast()).cast::<f32>().into() };
                self.raw.normals.extend(normals.map(normal));
            }
            None => self.all_have.normals = false,
        }
        match reader.read_colors(0) {
            Some(colours) => self.raw.colours.extend(colours.into_rgb_f32()),
            None => self.all_have.colours = false,
        }
        let corners: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().map(|index| first.saturating_add(index)).collect(),
            None => (first..first + vertices).collect(),
        };
        self.add_triangles(&corners, primitive.mode(), turned.determinant() < 0.0);
        Ok(())
    }

    /// Adds triangles; those that were mirrored wind the other way.
    fn add_triangles(&mut self, corners: &[u32], mode: Mode, is_mirrored: bool) {
        let triangles: Vec<[u32; 3]> = match mode {
            Mode::TriangleStrip => {
                let turned =
                    |(index, t): (usize, &[u32])| if index % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
                corners.windows(3).enumerate().map(turned).collect()
            }
            Mode::TriangleFan => {
                corners.get(1..).unwrap_or_default().windows(2).map(|edge| [corners[0], edge[0], edge[1]]).collect()
            }
            _ => corners.as_chunks::<3>().0.to_vec(),
        };
        self.raw
            .triangles
            .extend(triangles.into_iter().map(|[a, b, c]| if is_mirrored { [a, c, b] } else { [a, b, c] }));
    }

    /// Refuses numbers that lie outside the file, or beyond its end: their reader would compute with them.
    fn check_buffers(&self, primitive: &Primitive<'_>) -> Result<(), MeshProblem> {
        let accessors = primitive.attributes().map(|(_, accessor)| accessor).chain(primitive.indices());
        for accessor in accessors {
            let Some(view) = accessor.view() else {
                return Err(malformed("it has packed (sparse) numbers; export it without compression".into()));
            };
            if view.buffer().index() != 0 || !matches!(view.buffer().source(), gltf::buffer::Source::Bin) {
                return Err(malformed("its numbers lie in another file; export it as one .glb".into()));
            }
            let stride = view.stride().unwrap_or_else(|| accessor.size());
            let last = accessor.count().saturating_sub(1).saturating_mul(stride).saturating_add(accessor.size());
            let end = accessor.offset().saturating_add(last);
            let file_end = view.offset().saturating_add(view.length());
            if accessor.sparse().is_some() || end > view.length() || file_end > self.blob.len() {
                return Err(malformed("its numbers reach beyond its end; export or copy it again".into()));
            }
        }
        Ok(())
    }

    fn finish(mut self) -> RawMesh {
        if !self.all_have.normals {
            self.raw.normals.clear();
        }
        if !self.all_have.colours {
            self.raw.colours.clear();
        }
        self.raw
    }
}
