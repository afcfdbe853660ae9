//! Good files of every kind, and bad ones of every kind.

use firstbounce_core::mesh::topology::MeshFault;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;
use crate::mesh_file::gltf::glb_into;
use crate::mesh_file::stl::stl_into;
use crate::mesh_file::test_mesh::tetrahedron;
use crate::mesh_file::{Axes, MeshContents, OutputFormat, write_mesh};

const MM: LengthScale = LengthScale::Millimetre;

const OBJ: &str = "# a unit cube's lid in two objects, one of them a quad\no quad\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
    vn 0 0 2\nf 1//1 2//1 3//1 4//1\no triangle\nv 2 0.5 0\nf -4//-1 5//-1 -3//-1\n";

const PLY: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 5\nproperty float x\nproperty float y\n\
    property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n1.5 1 0 0 0 255\n\
    0.5 2 0 188 188 188\n-0.5 1 0 0 0 0\n5 0 1 2 3 4\n";

const STL: &str = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
    endsolid\n";

fn stl_binary() -> Vec<u8> {
    let mut bytes = Vec::new();
    stl_into(&mut bytes, &tetrahedron(), Axes::YUp).unwrap();
    bytes
}

fn glb() -> Vec<u8> {
    let mut bytes = Vec::new();
    glb_into(&mut bytes, &tetrahedron(), None).unwrap();
    bytes
}

/// The PLY above as its binary twin.
fn ply_binary(number: fn(f64, usize) -> Vec<u8>, name: &str) -> Vec<u8> {
    let (header, body) = PLY.split_once("end_header\n").unwrap();
    let mut bytes = format!("{}end_header\n", header.replace("ascii", name)).into_bytes();
    for line in body.lines() {
        let values: Vec<f64> = line.split(' ').map(|value| value.parse().unwrap()).collect();
        let sizes: &[usize] = if values[0] == 5.0 { &[1, 104, 104, 104, 104, 104] } else { &[4, 4, 8, 1, 1, 1] };
        values.iter().zip(sizes).for_each(|(&value, &size)| bytes.extend(number(value, size)));
    }
    bytes
}

/// One number in little-endian order: sizes 4 and 8 are floats, 1 and 104 integers of one and four bytes.
fn little(value: f64, size: usize) -> Vec<u8> {
    match size {
        1 => vec![value as u8],
        4 => (value as f32).to_le_bytes().to_vec(),
        8 => value.to_le_bytes().to_vec(),
        _ => (value as i32).to_le_bytes().to_vec(),
    }
}

fn big(value: f64, size: usize) -> Vec<u8> {
    little(value, size).into_iter().rev().collect()
}

fn read(bytes: &[u8], extension: &str) -> MeshFile {
    mesh_from_bytes(bytes, extension, MM).unwrap()
}

fn problem(bytes: impl AsRef<[u8]>, extension: &str) -> MeshProblem {
    let problem = mesh_from_bytes(bytes.as_ref(), extension, MM).unwrap_err();
    assert_eq!(problem.to_string().lines().count(), 1, "{problem}");
    problem
}

#[test]
fn obj_quads_objects_and_relative_indices_become_one_mesh() {
    let file = read(OBJ.as_bytes(), "obj");
    assert_eq!(file.format, MeshFormat::Obj);
    assert_eq!(file.mesh.positions.len(), 5, "objects share the corners at one position");
    assert_eq!(file.mesh.triangles.len(), 3);
    assert!(file.mesh.normals.iter().all(|n| (n - nalgebra::Vector3::z()).norm() < 1e-6), "the file's, made unit");
    assert!(file.mesh.area_weighted_normals().iter().all(|n| n.z > 0.99), "winding kept");
    assert!(file.warnings.contains(&MeshWarning::PolygonsSplit { count: 1 }));
}

#[test]
fn all_three_plys_are_the_same_mesh() {
    let text = read(PLY.as_bytes(), "ply");
    assert_eq!((text.mesh.positions.len(), text.mesh.triangles.len()), (5, 3), "a pentagon is three triangles");
    assert_eq!(text.mesh.positions[3], nalgebra::Point3::new(0.5, 2.0, 0.0));
    assert_eq!(text.mesh.colours[0], [1.0, 0.0, 0.0]);
    assert!((text.mesh.colours[3][0] - 0.5029).abs() < 1e-3, "188 of sRGB is half the light");
    for binary in [ply_binary(little, "binary_little_endian"), ply_binary(big, "binary_big_endian")] {
        assert_eq!(read(&binary, "ply"), text);
    }
}

#[test]
fn stl_corners_are_joined_and_a_header_that_says_solid_changes_nothing() {
    let solid = tetrahedron();
    let mut bytes = stl_binary();
    let file = read(&bytes, "stl");
    assert_eq!((file.mesh.positions.len(), file.mesh.triangles.len()), (4, 4));
    assert_eq!(file.mesh.bounds(), solid.bounds());
    assert!(file.mesh.open_edges().border.is_empty() && file.warnings.is_empty());
    bytes[..6].copy_from_slice(b"solid ");
    let fooled = read(&bytes, "stl");
    assert_eq!((fooled.mesh, fooled.format, fooled.is_own), (file.mesh, file.format, false));
    assert_eq!(read(STL.as_bytes(), "stl").mesh.triangles, [[0, 1, 2]], "a nameless solid");
    assert_eq!(read(STL.as_bytes(), "stl").format, MeshFormat::StlText);
}

#[test]
fn a_text_stl_of_several_solids_is_all_of_them() {
    let other = STL.replace("solid", "solid lid of the box").replace("vertex 1 0 0", "vertex -1 0 0");
    let file = read(format!("{STL}\n{other}").as_bytes(), "stl");
    assert_eq!((file.mesh.positions.len(), file.mesh.triangles.len()), (4, 2), "two triangles that share an edge");
    // Cut off within the second, or between its end and that of the file.
    for end in [other.len() / 2, other.find("endsolid").unwrap()] {
        let cut = format!("{STL}{}", &other[..end]);
        assert!(problem(cut, "stl").to_string().contains("cut off"));
    }
    // Lines may end as on other systems.
    assert_eq!(read(format!("{STL}{other}").replace('\n', "\r\n").as_bytes(), "stl").mesh, file.mesh);
}

#[test]
fn lengths_become_mm() {
    for (scale, mm) in
        [(MM, 1.0), (LengthScale::Centimetre, 10.0), (LengthScale::Metre, 1e3), (LengthScale::Inch, 25.4)]
    {
        let mesh = mesh_from_bytes(STL.as_bytes(), "stl", scale).unwrap().mesh;
        assert_eq!(mesh.bounds().unwrap().1, nalgebra::Point3::new(mm, mm, 0.0));
    }
}

#[test]
fn a_mesh_of_our_own_comes_back_in_its_unit_and_its_axes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh");
    for (format, unit, axes) in OutputFormat::ALL
        .into_iter()
        .flat_map(|format| [LengthUnit::Millimetre, LengthUnit::Pixel].map(|unit| (format, unit)))
        .flat_map(|(format, unit)| [Axes::YUp, Axes::ZUp].map(|axes| (format, unit, axes)))
    {
        let mesh = firstbounce_core::Mesh { unit, ..tetrahedron() };
        write_mesh(&path, format, &MeshContents { axes, ..MeshContents::of(&mesh) }).unwrap();
        let file = read_mesh(&path, MM).unwrap();
        assert_eq!(file.mesh.unit, unit, "{format} {axes:?}");
        let corner_off = |(found, made): (nalgebra::Point3<f32>, nalgebra::Point3<f32>)| (found - made).norm();
        let (found, made) = (file.mesh.bounds().unwrap(), mesh.bounds().unwrap());
        assert!(corner_off((found.0, made.0)) < 1e-5 && corner_off((found.1, made.1)) < 1e-5, "{format} {axes:?}");
        assert!(file.is_own, "{format}");
        assert!(file.mesh.area_weighted_normals().iter().zip(&file.mesh.normals).all(|(a, b)| a.dot(b) > 0.5));
        assert_eq!(file.warnings.contains(&MeshWarning::InPixels), unit == LengthUnit::Pixel);
        let turns = axes == Axes::ZUp && format != OutputFormat::Glb;
        assert_eq!(file.warnings.contains(&MeshWarning::TurnedBack), turns);
        // A unit that the user gives is believed, but for glTF, which states its own.
        let given = read_mesh(&path, LengthScale::Metre).unwrap().mesh;
        assert_eq!(given.unit, if format == OutputFormat::Glb { unit } else { LengthUnit::Millimetre });
    }
    // Words of other programs turn nothing.
    let foreign = format!("# unit: pixels\n# axes: x right, z up, y away from the camera\n{OBJ}");
    assert_eq!(read(foreign.as_bytes(), "obj"), read(OBJ.as_bytes(), "obj"));
}

#[test]
fn the_contents_win_over_the_extension() {
    let file = read(PLY.as_bytes(), "obj");
    assert_eq!(file.format, MeshFormat::Ply);
    assert_eq!(file.warnings[0].to_string(), "named .obj, but it is PLY");
}

#[test]
fn odd_meshes_are_read_with_a_warning() {
    let fan = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
    assert!(read(fan.as_bytes(), "obj").warnings.contains(&MeshWarning::NonManifold { edges: 1 }));
    let doubled = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 4 6 5\nf 2 4 6\n";
    let file = read(doubled.as_bytes(), "obj");
    assert_eq!(file.warnings, [MeshWarning::DuplicatesJoined { count: 2 }, MeshWarning::CollapsedDropped { count: 1 }]);
    let far = "v 4000000 0 0\nv 4000100 0 0\nv 4000000 100 0\nf 1 2 3\n";
    let warning = &read(far.as_bytes(), "obj").warnings[0];
    assert!(matches!(warning, MeshWarning::CoarseCoordinates { step_mm: 0.25, .. }), "{warning}");
}

#[test]
fn bad_files_say_what_is_wrong() {
    assert_eq!(problem("", "obj"), MeshProblem::EmptyFile);
    assert_eq!(problem("hello", "obj"), MeshProblem::UnknownFormat { looks_like: "a text without any vertex" });
    assert_eq!(problem(b"\x89PNG\r\n\x1a\n\0\0", "ply"), MeshProblem::UnknownFormat { looks_like: "a PNG picture" });
    assert_eq!(problem("v 0 0 0\nv 1 1 1\n", "obj"), MeshProblem::Fault(MeshFault::NoTriangle { vertices: 0 }));
    let cloud = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        end_header\n1 2 3\n";
    let path = std::env::temp_dir().join(format!("firstbounce-cloud-{}.ply", std::process::id()));
    std::fs::write(&path, cloud).unwrap();
    let refused = read_mesh(&path, MM).unwrap_err();
    let points = read_mesh_or_points(&path, MM).unwrap().mesh;
    std::fs::remove_file(&path).unwrap();
    assert_eq!(refused.problem, MeshProblem::Fault(MeshFault::NoTriangle { vertices: 1 }));
    assert_eq!((points.positions.len(), points.normals.len(), points.triangles.len()), (1, 0, 0));
    let flat = "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n";
    assert!(matches!(problem(flat, "obj"), MeshProblem::Fault(MeshFault::NoTriangle { .. })));
    for bad in ["nan", "inf", "1e39"] {
        let obj = format!("v 0 0 0\nv 1 0 {bad}\nv 0 1 0\nf 1 2 3\n");
        let expected = MeshFault::NotFinite { what: "positions", count: 1, first: 1 };
        assert_eq!(problem(obj, "obj"), MeshProblem::Fault(expected));
    }
}

#[test]
fn indices_that_lead_nowhere_are_refused_with_their_line() {
    for face in ["1 2 4", "1 2 0", "-1 -2 -4", "1//1 2//1 3//1", "1/9/ 2 3", "1 2 x", "1 2 9223372036854775808"] {
        let text = problem(format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {face}\n"), "obj").to_string();
        assert!(text.contains("line 4"), "{face}: {text}");
    }
    let lost = PLY.replace("5 0 1 2 3 4", "3 0 1 5");
    let expected = MeshFault::IndexOutOfRange { triangle: 0, index: 5, vertices: 5 };
    assert_eq!(problem(lost, "ply"), MeshProblem::Fault(expected));
    assert!(matches!(problem(PLY.replace("5 0 1", "5 -1 1"), "ply"), MeshProblem::Malformed { .. }));
}

#[test]
fn no_line_but_a_checked_face_names_a_vertex() {
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for index in ["-9223372036854775808", "9223372036854775807", "-4", "18446744073709551616"] {
        for face in [format!("f {index} 2 3"), format!("f\t1 2 {index}"), format!("f 1//1 2//{index} 3//1")] {
            let text = problem(format!("{corners}{face}\n"), "obj").to_string();
            assert!(text.contains("line 4"), "{face}: {text}");
        }
        // Lines and points are no surface, and are read over.
        let text = format!("{corners}l {index} 2\np {index}\nmtllib {index}\nf 1 2 3 # {index}\n");
        assert_eq!(read(text.as_bytes(), "obj").mesh.triangles.len(), 1);
    }
}

#[test]
fn coordinates_that_single_precision_cannot_compute_with_are_refused_with_their_vertex() {
    for far in ["1e38", "-2e9", "1.1e9"] {
        let obj = format!("v 0 0 0\nv 1 0 {far}\nv 0 1 0\nf 1 2 3\n");
        let stl = STL.replace("vertex 1 0 0", &format!("vertex 1 0 {far}"));
        let ply = PLY.replace("1.5 1 0", &format!("1.5 1 {far}"));
        for (text, extension, first) in [(obj, "obj", 1), (stl, "stl", 1), (ply, "ply", 2)] {
            match problem(&text, extension) {
                MeshProblem::Fault(MeshFault::TooFar { vertex, .. }) => assert_eq!(vertex, first, "{text}"),
                other => panic!("{far} in {extension}: {other}"),
            }
        }
    }
    // In metres a million is too far, in millimetres it is a kilometre.
    let far = OBJ.replace("v 2 0.5 0", "v 2e6 0.5 0");
    assert!(mesh_from_bytes(far.as_bytes(), "obj", MM).is_ok());
    assert!(mesh_from_bytes(far.as_bytes(), "obj", LengthScale::Metre).is_err());
    let small = "v 0 0 0\nv 1e-20 0 0\nv 0 1e-20 0\nf 1 2 3\n";
    assert!(matches!(problem(small, "obj"), MeshProblem::Fault(MeshFault::TooSmall { .. })));
}

#[test]
fn files_that_are_cut_off_say_so() {
    let stl = stl_binary();
    let expected = MeshProblem::Truncated { what: "bytes".to_owned(), promised: 284, found: 200 };
    assert_eq!(problem(&stl[..200], "stl"), expected);
    assert!(problem(&STL[..60], "stl").to_string().contains("cut off"));
    let ply = ply_binary(little, "binary_little_endian");
    assert!(matches!(problem(&ply[..ply.len() - 3], "ply"), MeshProblem::Malformed { .. }));
    let many = PLY.replace("vertex 5", "vertex 999999999999");
    assert!(matches!(problem(many, "ply"), MeshProblem::Truncated { promised: 999_999_999_999, .. }));
    assert!(matches!(problem(&PLY[..200], "ply"), MeshProblem::Malformed { .. }));
    assert!(matches!(problem(&OBJ[..OBJ.len() - 24], "obj"), MeshProblem::Malformed { .. }));
}

#[test]
fn folders_and_missing_files_are_named() {
    let folder = std::env::temp_dir();
    assert_eq!(read_mesh(&folder, MM).unwrap_err().problem, MeshProblem::Directory);
    let missing = folder.join("firstbounce-there-is-no-such-file.ply");
    let error = read_mesh(&missing, MM).unwrap_err();
    assert!(matches!(error.problem, MeshProblem::Unreadable { .. }));
    assert!(error.to_string().starts_with(&missing.display().to_string()));
}

#[test]
fn text_stls_of_every_program_are_read() {
    let expected = read(STL.as_bytes(), "stl").mesh;
    let variants = [
        STL.to_uppercase(),
        STL.replace("endsolid", "end solid"),
        STL.replace("solid\nfacet", "solid box\ncolor 0.5 0.5 0.5\nfacet"),
        STL.replace("normal 0 0 1", "normal nan nan nan"),
        STL.replace("normal 0 0 1", "normal"),
        STL.replace("solid\nfacet", "SOLID \"a b\"\nfacet"),
        format!("\u{feff}{STL}"),
    ];
    for text in variants {
        let file = read(text.as_bytes(), "stl");
        assert_eq!((file.format, file.mesh), (MeshFormat::StlText, expected.clone()), "{text}");
    }
    assert!(problem(STL.replace("vertex 1 0 0", "vertex 1 0"), "stl").to_string().contains("line 5"));
}

#[test]
fn a_binary_stl_with_normals_that_are_no_numbers_is_read_by_its_triangles() {
    let expected = read(&stl_binary(), "stl");
    let mut bytes = stl_binary();
    for triangle in bytes[84..].chunks_mut(50) {
        triangle[..12].copy_from_slice(&[0xff; 12]);
    }
    assert_eq!(read(&bytes, "stl"), expected);
}

#[test]
fn objs_of_every_program_are_read() {
    let plain = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    let expected = read(plain.as_bytes(), "obj").mesh;
    let variants = [
        format!("\u{feff}{plain}"),
        plain.replace("f 1 2 3 4", "f 1 2 \\\n3 4"),
        plain.replace("v 1 0 0", "v 1 0 0 # a corner"),
        plain.replace("v 1 0 0", "v 1 0 0 0.5 0.5 0.5"),
        plain.replace("v 1 0 0", "v 1 0 0 1.0"),
        plain.replace("f 1 2 3 4", "vt 0 0\nf 1/ 2/ 3/ 4/"),
        plain.replace("f 1 2 3 4", "vt 0 0\nf 1/1 2/1 3 4/"),
        plain.replace("f 1 2 3 4", "f 1// 2// 3// 4//"),
    ];
    for text in variants {
        assert_eq!(read(text.as_bytes(), "obj").mesh, expected, "{text}");
    }
}

#[test]
fn plys_of_every_program_are_read() {
    let expected = read(PLY.as_bytes(), "ply").mesh;
    let (header, body) = PLY.split_once("end_header\n").unwrap();
    let latin = header.replace("made by hand", "gr\u{f6}\u{df}e").chars().map(|c| c as u8).collect::<Vec<u8>>();
    let with_comment = [&latin, b"end_header\n".as_slice(), body.as_bytes()].concat();
    assert_eq!(read(&with_comment, "ply").mesh, expected, "a comment in another encoding");
    let binary = ply_binary(little, "binary_little_endian");
    let at = binary.windows(7).position(|words| words == b"by hand").unwrap();
    let binary_with_comment = [&binary[..at], b"\xe9\xff".as_slice(), &binary[at..]].concat();
    assert_eq!(read(&binary_with_comment, "ply").mesh, expected);
    let blank =
        PLY.replace("end_header\n", "end_header\n\n").replace("comment", "\ncomment").replace("\n5 0", "\n\n5 0");
    assert_eq!(read(blank.as_bytes(), "ply").mesh, expected, "blank lines");
}

#[test]
fn vertices_that_are_no_numbers_and_unused_are_left_out() {
    let ply = PLY.replace("vertex 5", "vertex 7").replace("end_header\n", "end_header\nnan nan nan 0 0 0\n");
    let ply = ply.replace("\n5 0 1 2 3 4", "\nnan 0 inf 0 0 0\n5 1 2 3 4 5");
    let file = read(ply.as_bytes(), "ply");
    assert_eq!(file.mesh, read(PLY.as_bytes(), "ply").mesh);
    assert!(file.warnings.contains(&MeshWarning::UnusedDropped { count: 2 }), "{:?}", file.warnings);
    let used = PLY.replace("0.5 2 0", "0.5 nan 0");
    assert!(matches!(problem(used, "ply"), MeshProblem::Fault(MeshFault::NotFinite { first: 3, .. })));
}

#[test]
fn strips_of_triangles_are_triangles_that_face_one_way() {
    let (header, _) = PLY.split_once("element face").unwrap();
    let header = header.replace("vertex 5", "vertex 6");
    let points = "0 0 0 0 0 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n1 1 0 0 0 0\n0 2 0 0 0 0\n1 2 0 0 0 0\n";
    let element = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    let ply = format!("{header}{element}{points}9 0 1 2 3 -1 2 3 4 5\n");
    let mesh = read(ply.as_bytes(), "ply").mesh;
    assert_eq!(mesh.triangles.len(), 4);
    assert!(mesh.normals.iter().all(|normal| normal.z > 0.99), "{:?}", mesh.normals);
    assert!(matches!(problem(ply.replace("-1 2", "-2 2"), "ply"), MeshProblem::Malformed { .. }));
}

#[test]
fn normals_that_oppose_their_triangles_are_computed_and_not_believed() {
    let file = read(OBJ.replace("vn 0 0 2", "vn 0 0 -2").as_bytes(), "obj");
    assert!(file.mesh.normals.iter().all(|normal| normal.z > 0.99), "{:?}", file.mesh.normals);
    assert!(file.warnings.contains(&MeshWarning::NormalsComputed { opposing: 5 }), "{:?}", file.warnings);
}

#[test]
fn a_damaged_glb_is_refused_in_one_line() {
    let whole = glb();
    assert_eq!(read(&whole, "glb").mesh.triangles.len(), 4);
    for cut in (0..whole.len()).step_by(7).skip(1) {
        problem(&whole[..cut], "glb");
    }
    let text = problem("{\"asset\": {\"version\": \"2.0\"}}", "gltf").to_string();
    assert!(text.contains("export it as .glb"), "{text}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]
    #[test]
    fn no_damage_makes_a_reader_panic(
        kind in 0..7usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        digits in prop::collection::vec(
            (any::<prop::sample::Index>(), prop::sample::select(b"-0189 /.e
".as_slice())), 0..4,
        ),
        cut in any::<prop::sample::Index>(),
        is_cut in any::<bool>(),
        extension in prop::sample::select(vec!["obj", "ply", "stl", ""]),
    ) {
        let mut bytes = match kind {
            0 => OBJ.as_bytes().to_vec(),
            1 => PLY.as_bytes().to_vec(),
            2 => STL.as_bytes().to_vec(),
            3 => stl_binary(),
            4 => ply_binary(little, "binary_little_endian"),
            5 => ply_binary(big, "binary_big_endian"),
            _ => glb(),
        };
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        for (at, digit) in digits {
            let at = at.index(bytes.len());
            bytes.insert(at, digit);
        }
        if is_cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        match mesh_from_bytes(&bytes, extension, MM) {
            Ok(file) => prop_assert_eq!(file.mesh.fault_of_points(), None),
            Err(problem) => {
                let text = problem.to_string();
                prop_assert!(text.lines().count() == 1 && !text.contains("gave up"), "{}", text);
            }
        }
    }
}
