//! Writes glTF 2.0 in its binary form (.glb).

use std::io::{self, Write};

use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use serde_json::{Value, json};

/// glTF measures in metres.
const MM_PER_METRE: f32 = 1000.0;

// Numbers from the specification, sections 3.6 (buffers and accessors) and 4.4 (GLB).
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const MAGIC: &[u8; 4] = b"glTF";
const CONTAINER_VERSION: u32 = 2;
const JSON_CHUNK: &[u8; 4] = b"JSON";
const BINARY_CHUNK: &[u8; 4] = b"BIN\0";
const LINEAR: u32 = 9729;
const LINEAR_MIPMAP_LINEAR: u32 = 9987;
const CLAMP_TO_EDGE: u32 = 33071;

/// A texture within a glTF file.
#[derive(Clone, Copy, Debug)]
pub struct Embedded<'a> {
    /// The picture of the colour, sRGB, as a PNG file.
    pub png: &'a [u8],
    /// For each vertex its place in the texture: right from the left edge, up from the lower edge, both 0 to 1.
    pub uv: &'a [[f32; 2]],
}

/// Writes the mesh as one glTF node, in metres (a mesh in pixels counts a pixel as a millimetre, and `asset.extras` says
/// so), with its normals and either the texture or linear vertex colours: glTF multiplies the two.
///
/// The object frame (x right, y up, z toward the camera) is glTF's own (+y up, the front faces +z), so nothing turns.
///
/// # Errors
/// What the writer says, or `InvalidInput` for a mesh of more than 4 GiB or a texture place that a vertex lacks.
pub(super) fn glb_into(out: &mut impl Write, mesh: &Mesh, texture: Option<Embedded>) -> io::Result<()> {
    let invalid = |reason: String| io::Error::new(io::ErrorKind::InvalidInput, reason);
    if let Some(Embedded { uv, .. }) = texture.filter(|texture| texture.uv.len() != mesh.positions.len()) {
        return Err(invalid(format!("{} texture places for {} vertices", uv.len(), mesh.positions.len())));
    }
    let mut parts = Parts::default();
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| (p / MM_PER_METRE).into()).collect();
    let mut attributes = json!({ "POSITION": parts.add_vectors(&positions, true) });
    if !mesh.normals.is_empty() {
        let normals: Vec<[f32; 3]> = mesh.normals.iter().map(|&normal| normal.into()).collect();
        attributes["NORMAL"] = parts.add_vectors(&normals, false);
    }
    // A surface without a back is seen from there too.
    let mut material =
        json!({ "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 1.0 }, "doubleSided": true });
    if let Some(Embedded { uv, .. }) = texture {
        // glTF counts downward from the upper edge.
        let uv: Vec<[f32; 2]> = uv.iter().map(|[u, v]| [*u, 1.0 - v]).collect();
        attributes["TEXCOORD_0"] = parts.add_vectors(&uv, false);
        material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
    } else if !mesh.colours.is_empty() {
        attributes["COLOR_0"] = parts.add_vectors(&mesh.colours, false);
    }
    let indices = parts.add_indices(&mesh.triangles);
    let unit = match mesh.unit {
        LengthUnit::Millimetre => "metre",
        LengthUnit::Pixel => "no scale is known: 0.001 is the width of a pixel",
    };
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "Firstbounce", "extras": { "unit": unit } },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": attributes, "indices": indices, "material": 0 }] }],
        "materials": [material],
    });
    if let Some(Embedded { png, .. }) = texture {
        document["images"] = json!([{ "bufferView": parts.add_picture(png), "mimeType": "image/png" }]);
        let filters = json!({
            "magFilter": LINEAR, "minFilter": LINEAR_MIPMAP_LINEAR, "wrapS": CLAMP_TO_EDGE, "wrapT": CLAMP_TO_EDGE
        });
        document["samplers"] = json!([filters]);
        document["textures"] = json!([{ "sampler": 0, "source": 0 }]);
    }
    document["buffers"] = json!([{ "byteLength": parts.binary.len() }]);
    document["bufferViews"] = json!(parts.views);
    document["accessors"] = json!(parts.accessors);
    let mut text = document.to_string().into_bytes();
    // Chunks end on a multiple of four bytes; the binary one does so already, as every part of it does.
    text.resize(text.len().next_multiple_of(4), b' ');

    let length = 12 + 8 + text.len() + 8 + parts.binary.len();
    let length =
        u32::try_from(length).map_err(|_| invalid(format!("the mesh needs {length} bytes; .glb ends at 4 GiB")))?;
    let mut header = [MAGIC.as_slice(), &CONTAINER_VERSION.to_le_bytes(), &length.to_le_bytes()].concat();
    header.extend((text.len() as u32).to_le_bytes());
    header.extend(JSON_CHUNK);
    out.write_all(&header)?;
    out.write_all(&text)?;
    out.write_all(&(parts.binary.len() as u32).to_le_bytes())?;
    out.write_all(BINARY_CHUNK)?;
    out.write_all(&parts.binary)
}

/// The arrays of a file, one after the other in one buffer.
#[derive(Default)]
struct Parts {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Parts {
    /// Appends `N` floats a vertex and returns the accessor's index. glTF wants the bounds of positions only.
    fn add_vectors<const N: usize>(&mut self, vectors: &[[f32; N]], with_bounds: bool) -> Value {
        let bytes = vectors.iter().flatten().flat_map(|x| x.to_le_bytes());
        let mut accessor = json!({ "componentType": FLOAT, "count": vectors.len(), "type": format!("VEC{N}") });
        if with_bounds && let Some(&first) = vectors.first() {
            let bound = |pick: fn(f32, f32) -> f32| {
                vectors.iter().fold(first, |so_far, v| std::array::from_fn(|axis| pick(so_far[axis], v[axis])))
            };
            accessor["min"] = json!(bound(f32::min).as_slice());
            accessor["max"] = json!(bound(f32::max).as_slice());
        }
        self.add(bytes, ARRAY_BUFFER, accessor)
    }

    fn add_indices(&mut self, triangles: &[[u32; 3]]) -> Value {
        let bytes = triangles.iter().flatten().flat_map(|index| index.to_le_bytes());
        let accessor = json!({ "componentType": UNSIGNED_INT, "count": triangles.len() * 3, "type": "SCALAR" });
        self.add(bytes, ELEMENT_ARRAY_BUFFER, accessor)
    }

    /// Appends a file and returns the view's index; what follows starts on a multiple of four bytes.
    fn add_picture(&mut self, file: &[u8]) -> Value {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": file.len() }));
        self.binary.extend(file);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        json!(self.views.len() - 1)
    }

    fn add(&mut self, bytes: impl Iterator<Item = u8>, target: u32, mut accessor: Value) -> Value {
        let start = self.binary.len();
        self.binary.extend(bytes);
        accessor["bufferView"] = json!(self.views.len());
        let length = self.binary.len() - start;
        self.views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": length, "target": target }));
        self.accessors.push(accessor);
        json!(self.accessors.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh_file::test_mesh::tetrahedron;

    #[test]
    fn another_reader_sees_the_same_mesh_in_metres() {
        let mesh = tetrahedron();
        let mut file = Vec::new();
        glb_into(&mut file, &mesh, None).unwrap();
        let glb = gltf::Gltf::from_slice(&file).expect("valid by the gltf crate's own check");
        let blob = glb.blob.as_deref().unwrap();
        let read = glb.meshes().next().unwrap().primitives().next().unwrap();

        let bounds = read.bounding_box();
        assert_eq!((bounds.min, bounds.max), ([0.0; 3], [0.01, 0.02, 0.03]));
        let reader = read.reader(|_| Some(blob));
        let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        let expected: Vec<[f32; 3]> = mesh.positions.iter().map(|p| (p / 1000.0).into()).collect();
        assert_eq!(positions, expected);
        let normals: Vec<[f32; 3]> = reader.read_normals().unwrap().collect();
        assert_eq!(normals, mesh.normals.iter().map(|&n| n.into()).collect::<Vec<[f32; 3]>>());
        let colours: Vec<[f32; 3]> = reader.read_colors(0).unwrap().into_rgb_f32().collect();
        assert_eq!(colours, mesh.colours, "glTF's vertex colours are linear, as ours");
        let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        assert_eq!(indices, mesh.triangles.concat(), "same order, so same winding");
    }

    #[test]
    fn what_a_mesh_has_not_is_left_out() {
        let bare = Mesh { normals: vec![], colours: vec![], ..tetrahedron() };
        let mut file = Vec::new();
        glb_into(&mut file, &bare, None).unwrap();
        assert_eq!(file.len() % 4, 0);
        let glb = gltf::Gltf::from_slice(&file).unwrap();
        let read = glb.meshes().next().unwrap().primitives().next().unwrap();
        assert_eq!(read.attributes().count(), 1);
    }
}
