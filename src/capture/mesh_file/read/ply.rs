//! Stanford PLY, text and binary of both byte orders.

use std::io::BufReader;

use firstbounce_core::image::colour::linear_from_srgb;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    DefaultElement, ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
    ScalarType,
};

use super::{MeshFormat, MeshProblem, RawMesh};

/// Reads vertices (x y z, nx ny nz, red green blue) and faces; other elements and properties are passed over.
pub(super) fn parse(bytes: &[u8]) -> Result<RawMesh, MeshProblem> {
    let mut reader = Reader::new(BufReader::new(bytes));
    let header = Parser::<DefaultElement>::new().read_header(&mut reader).map_err(malformed)?;
    check_room(&header, bytes.len())?;
    let mut raw = RawMesh::default();
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => {
                let vertices = Parser::<Vertex>::new().read_payload_for_element(&mut reader, element, &header);
                add_vertices(&mut raw, element, &vertices.map_err(malformed)?)?;
            }
            "face" => {
                let faces = Parser::<Face>::new().read_payload_for_element(&mut reader, element, &header);
                for face in faces.map_err(malformed)? {
                    raw.add_face(&face.corners.ok_or_else(|| reason("a face has a negative or broken vertex index"))?);
                }
            }
            _ => {
                Parser::<Passed>::new().read_payload_for_element(&mut reader, element, &header).map_err(malformed)?;
            }
        }
    }
    Ok(raw)
}

fn reason(reason: &str) -> MeshProblem {
    MeshProblem::Malformed { format: MeshFormat::Ply, reason: reason.to_owned() }
}

/// The parser's message goes over several lines; the first says what happened.
fn malformed(error: ParseError) -> MeshProblem {
    reason(error.to_string().lines().next().unwrap_or("the parser gave no reason").trim())
}

/// Refuses a header that promises more than the file can hold, before anything is made for it.
fn check_room(header: &Header, file_bytes: usize) -> Result<(), MeshProblem> {
    for element in header.elements.values() {
        let types = element.properties.values().map(|property| &property.data_type);
        let min_bytes: usize = match header.encoding {
            // A character and a space or line end for each.
            Encoding::Ascii => types.map(|_| 2).sum(),
            Encoding::BinaryBigEndian | Encoding::BinaryLittleEndian => types.map(min_size).sum(),
        };
        if min_bytes == 0 {
            return Err(reason(&format!("element {} has no property", element.name)));
        }
        // The last line of a text may lack its end.
        let found = (file_bytes + 1) / min_bytes;
        if element.count > found {
            let what = format!("elements \"{}\"", element.name);
            return Err(MeshProblem::Truncated { what, promised: element.count as u64, found: found as u64 });
        }
    }
    Ok(())
}

fn min_size(property: &PropertyType) -> usize {
    match property {
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => match scalar {
            ScalarType::Char | ScalarType::UChar => 1,
            ScalarType::Short | ScalarType::UShort => 2,
            ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
            ScalarType::Double => 8,
        },
    }
}

fn add_vertices(raw: &mut RawMesh, element: &ElementDef, vertices: &[Vertex]) -> Result<(), MeshProblem> {
    let has = |names: [&str; 3]| names.iter().all(|&name| element.properties.contains_key(name));
    if !has(["x", "y", "z"]) {
        return Err(reason("its vertices have no x, y and z"));
    }
    raw.positions = vertices.iter().map(|vertex| vertex.position).collect();
    if has(["nx", "ny", "nz"]) {
        raw.normals = vertices.iter().map(|vertex| vertex.normal).collect();
    }
    if has(["red", "green", "blue"]) {
        raw.colours = vertices.iter().map(|vertex| vertex.colour.map(linear_from_srgb)).collect();
    }
    Ok(())
}

/// A vertex as the parser fills it; colours encoded, 0 to 1.
#[derive(Default)]
struct Vertex {
    position: [f64; 3],
    normal: [f32; 3],
    colour: [f32; 3],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        // The type's range is the colour's range; a float colour is in 0 to 1 as it is.
        let (value, white) = match property {
            Property::Char(value) => (f64::from(value), f64::from(i8::MAX)),
            Property::UChar(value) => (f64::from(value), f64::from(u8::MAX)),
            Property::Short(value) => (f64::from(value), f64::from(i16::MAX)),
            Property::UShort(value) => (f64::from(value), f64::from(u16::MAX)),
            Property::Int(value) => (f64::from(value), f64::from(i32::MAX)),
            Property::UInt(value) => (f64::from(value), f64::from(u32::MAX)),
            Property::Float(value) => (f64::from(value), 1.0),
            Property::Double(value) => (value, 1.0),
            _ => return PropertyAccessResult::Ignored,
        };
        match name {
            "x" => self.position[0] = value,
            "y" => self.position[1] = value,
            "z" => self.position[2] = value,
            "nx" => self.normal[0] = value as f32,
            "ny" => self.normal[1] = value as f32,
            "nz" => self.normal[2] = value as f32,
            "red" => self.colour[0] = (value / white) as f32,
            "green" => self.colour[1] = (value / white) as f32,
            "blue" => self.colour[2] = (value / white) as f32,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

/// A face as the parser fills it; `None` for indices that are no whole numbers from 0.
struct Face {
    corners: Option<Vec<u32>>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self { corners: Some(vec![]) }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        // Two names are in use.
        if name != "vertex_indices" && name != "vertex_index" {
            return PropertyAccessResult::Ignored;
        }
        self.corners = property.to_u32_list();
        PropertyAccessResult::Set
    }
}

/// An element that is read over.
struct Passed;

impl PropertyAccess for Passed {
    fn new() -> Self {
        Self
    }
}
