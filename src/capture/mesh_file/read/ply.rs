//! Stanford PLY, text and binary of both byte orders.

use std::borrow::Cow;
use std::io::{BufReader, Read};

use firstbounce_core::image::colour::linear_from_srgb;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    DefaultElement, ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
    ScalarType,
};

use super::{MeshFormat, MeshProblem, RawMesh};

/// Reads vertices (x y z, nx ny nz, red green blue) and faces; other elements and properties are passed over.
pub(super) fn parse(bytes: &[u8]) -> Result<RawMesh, MeshProblem> {
    let (header, payload) = parts(bytes);
    let mut reader = Reader::new(BufReader::new(header.as_slice().chain(&*payload)));
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
            "tristrips" => {
                let strips = Parser::<Strip>::new().read_payload_for_element(&mut reader, element, &header);
                strips.map_err(malformed)?.iter().try_for_each(|strip| add_strip(&mut raw, strip))?;
            }
            _ => {
                Parser::<Passed>::new().read_payload_for_element(&mut reader, element, &header).map_err(malformed)?;
            }
        }
    }
    Ok(raw)
}

const END_OF_HEADER: &[u8] = b"end_header";

/// The header and what follows it, without what the parser stumbles on: characters in other encodings, which comments may
/// hold, and blank lines.
fn parts(bytes: &[u8]) -> (Vec<u8>, Cow<'_, [u8]>) {
    let end = bytes.windows(END_OF_HEADER.len()).position(|words| words == END_OF_HEADER);
    let end = end.map_or(bytes.len(), |start| {
        let rest = &bytes[start..];
        let line_end = rest
            .iter()
            .position(|byte| *byte == b'\n' || *byte == b'\r')
            .map_or(rest.len(), |at| at + if rest[at..].starts_with(b"\r\n") { 2 } else { 1 });
        start + line_end
    });
    let (header, payload) = bytes.split_at(end);
    let header =
        without_blank_lines(&header.iter().map(|byte| if byte.is_ascii() { *byte } else { b'?' }).collect::<Vec<_>>());
    let is_text = header.windows(TEXT.len()).any(|words| words == TEXT);
    (header, if is_text { plain_lines(payload) } else { Cow::Borrowed(payload) })
}

const TEXT: &[u8] = b"\nformat ascii";

fn without_blank_lines(text: &[u8]) -> Vec<u8> {
    text.split_inclusive(|byte| *byte == b'\n')
        .filter(|line| !line.trim_ascii().is_empty())
        .flatten()
        .copied()
        .collect()
}

/// Lines of numbers as the parser takes them: without blank ones, and with what is no number as one that is too large.
fn plain_lines(text: &[u8]) -> Cow<'_, [u8]> {
    // An exponent is the one letter of a number.
    let is_plain = |line: &[u8]| {
        !line.trim_ascii().is_empty()
            && line.iter().all(|byte| matches!(byte, b'e' | b'E') || !(byte.is_ascii_alphabetic() || *byte == b'#'))
    };
    if text.split_inclusive(|byte| *byte == b'\n').all(is_plain) {
        return Cow::Borrowed(text);
    }
    let mut plain = Vec::with_capacity(text.len());
    for line in text.split_inclusive(|byte| *byte == b'\n').filter(|line| !line.trim_ascii().is_empty()) {
        if is_plain(line) {
            plain.extend(line);
            continue;
        }
        for word in line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
            plain.extend(if is_no_number(word) { TOO_LARGE } else { word });
            plain.push(b' ');
        }
        plain.push(b'\n');
    }
    Cow::Owned(plain)
}

const TOO_LARGE: &[u8] = b"1e999";

/// "nan", "-nan(ind)", "inf", "1.#QNAN"
fn is_no_number(word: &[u8]) -> bool {
    let word = word.strip_prefix(b"-").or_else(|| word.strip_prefix(b"+")).unwrap_or(word).to_ascii_lowercase();
    [b"nan".as_slice(), b"inf", b"1.#"].iter().any(|start| word.starts_with(start))
}

/// Adds the triangles of a strip: every corner makes one with the two before it, which wind the other way each time. -1
/// ends a strip.
fn add_strip(raw: &mut RawMesh, strip: &Strip) -> Result<(), MeshProblem> {
    for piece in strip.corners.split(|corner| *corner == -1) {
        let corners: Option<Vec<u32>> = piece.iter().map(|corner| u32::try_from(*corner).ok()).collect();
        let corners = corners.ok_or_else(|| reason("a strip has a negative vertex index"))?;
        for (index, three) in corners.windows(3).enumerate() {
            let [a, b, c] = [three[0], three[1], three[2]];
            let is_seam = a == b || b == c || a == c;
            if !is_seam {
                raw.triangles.push(if index % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }
    Ok(())
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

/// A strip of triangles as the parser fills it.
struct Strip {
    corners: Vec<i64>,
}

impl PropertyAccess for Strip {
    fn new() -> Self {
        Self { corners: vec![] }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if name != "vertex_indices" && name != "vertex_index" {
            return PropertyAccessResult::Ignored;
        }
        self.corners = match property {
            Property::ListInt(corners) => corners.into_iter().map(i64::from).collect(),
            other => other.to_u32_list().unwrap_or_default().into_iter().map(i64::from).collect(),
        };
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
