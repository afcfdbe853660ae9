//! Meshes that were written are read back by other people's readers.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use firstbounce_capture::mesh_file::{MeshFileError, Quality, write_glb, write_obj, write_ply, write_stl};
use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::mesh::topology::MeshFault;
use nalgebra::{Point3, Vector3};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

/// A wavy surface of `n` x `n` vertices, more than one piece of the writers.
fn wavy(n: u32) -> Mesh {
    let at = |i: u32| (i % n, i / n);
    let height = |x: f32, y: f32| 3.0 * (0.2 * x).sin() + 0.01 * y * y;
    let position = |i| {
        let (x, y) = at(i);
        let (x, y) = (x as f32 * 0.137 - 4.0, y as f32 * 0.137);
        Point3::new(x, y, height(x, y))
    };
    let normal = |i| {
        let p: Point3<f32> = position(i);
        Vector3::new(-0.6 * (0.2 * p.x).cos(), -0.02 * p.y, 1.0).normalize()
    };
    let triangles = (0..n - 1).flat_map(|y| {
        (0..n - 1).flat_map(move |x| {
            let corner = y * n + x;
            [[corner, corner + 1, corner + n + 1], [corner, corner + n + 1, corner + n]]
        })
    });
    Mesh {
        positions: (0..n * n).map(position).collect(),
        normals: (0..n * n).map(normal).collect(),
        colours: (0..n * n).map(|i| [i as f32 / (n * n) as f32, 0.5, 1.0]).collect(),
        triangles: triangles.collect(),
        unit: LengthUnit::Millimetre,
    }
}

/// IEC 61966-2-1.
fn srgb(light: f32) -> f32 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

fn close(a: f32, b: f32) -> bool {
    (a - b).abs() <= 1e-5 * b.abs().max(1e-3)
}

fn bare(mesh: &Mesh) -> Mesh {
    Mesh { normals: vec![], colours: vec![], unit: LengthUnit::Pixel, ..mesh.clone() }
}

#[test]
fn obj_comes_back_through_tobj() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.obj");
    let mesh = wavy(80);
    write_obj(&path, &mesh, None).unwrap();
    assert!(fs::read_to_string(&path).unwrap().starts_with("# Firstbounce mesh\n# unit: mm\n# axes: x right, y up"));

    let (models, _) = tobj::load_obj(&path, &tobj::GPU_LOAD_OPTIONS).unwrap();
    assert_eq!(models.len(), 1);
    let read = &models[0].mesh;
    assert_eq!(read.positions.len(), 3 * mesh.positions.len());
    assert_eq!(read.vertex_color.len(), 3 * mesh.colours.len());
    assert_eq!(read.indices.len(), 3 * mesh.triangles.len());
    // tobj numbers vertices as faces name them; a corner is compared by what it points to.
    for (&found, &index) in read.indices.iter().zip(mesh.triangles.as_flattened()) {
        let (found, index) = (3 * found as usize, index as usize);
        for axis in 0..3 {
            assert!(close(read.positions[found + axis], mesh.positions[index][axis]));
            assert!((read.normals[found + axis] - mesh.normals[index][axis]).abs() < 1e-5);
            assert!((read.vertex_color[found + axis] - srgb(mesh.colours[index][axis])).abs() < 1e-4);
        }
    }
    for corners in read.indices.chunks_exact(3) {
        let at = |i: u32| Vector3::from_row_slice(&read.positions[3 * i as usize..3 * i as usize + 3]);
        let normal = Vector3::from_row_slice(&read.normals[3 * corners[0] as usize..3 * corners[0] as usize + 3]);
        let [a, b, c] = [corners[0], corners[1], corners[2]].map(at);
        assert!((b - a).cross(&(c - a)).dot(&normal) > 0.0, "winds outward");
    }
}

#[test]
fn an_obj_of_positions_alone_says_that_its_unit_is_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.obj");
    let mesh = bare(&wavy(3));
    write_obj(&path, &mesh, None).unwrap();
    assert!(fs::read_to_string(&path).unwrap().contains("# unit: pixels"));
    let (models, _) = tobj::load_obj(&path, &tobj::LoadOptions::default()).unwrap();
    let read = &models[0].mesh;
    assert_eq!(read.indices.len(), 3 * mesh.triangles.len());
    for (&found, &index) in read.indices.iter().zip(mesh.triangles.as_flattened()) {
        let found = &read.positions[3 * found as usize..][..3];
        assert_eq!(found, mesh.positions[index as usize].coords.as_slice());
    }
    assert!(read.normals.is_empty() && read.vertex_color.is_empty());
}

#[test]
fn ply_comes_back_through_another_reader() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.ply");
    for mesh in [wavy(80), bare(&wavy(5))] {
        write_ply(&path, &mesh, None).unwrap();
        let mut file = BufReader::new(File::open(&path).unwrap());
        let ply = Parser::<DefaultElement>::new().read_ply(&mut file).unwrap();
        let unit = if mesh.unit == LengthUnit::Millimetre { "unit: mm" } else { "unit: pixels" };
        assert!(ply.header.comments.iter().any(|comment| comment.contains(unit)));
        let float = |element: &DefaultElement, name: &str| match element[name] {
            Property::Float(value) => value,
            ref other => panic!("{name} is {other:?}"),
        };
        assert_eq!(ply.payload["vertex"].len(), mesh.positions.len());
        for (index, vertex) in ply.payload["vertex"].iter().enumerate() {
            assert_eq!(["x", "y", "z"].map(|name| float(vertex, name)), mesh.positions[index].coords.data.0[0]);
            if let Some(normal) = mesh.normals.get(index) {
                assert_eq!(["nx", "ny", "nz"].map(|name| float(vertex, name)), normal.data.0[0]);
            }
            for (name, light) in ["red", "green", "blue"].iter().zip(mesh.colours.get(index).iter().copied().flatten())
            {
                let Property::UChar(value) = vertex[*name] else { panic!("{name} is no uchar") };
                assert!((f32::from(value) - 255.0 * srgb(*light)).abs() <= 0.501);
            }
        }
        let faces: Vec<Vec<i32>> = ply.payload["face"]
            .iter()
            .map(|face| match &face["vertex_indices"] {
                Property::ListInt(indices) => indices.clone(),
                other => panic!("face is {other:?}"),
            })
            .collect();
        assert!(faces.iter().flatten().map(|&i| i as u32).eq(mesh.triangles.as_flattened().iter().copied()));
    }
}

#[test]
fn quality_is_a_number_for_each_vertex() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.ply");
    let mesh = wavy(5);
    let values: Vec<f32> = (0..25).map(|i| i as f32 * 0.25 - 3.0).collect();
    write_ply(&path, &mesh, Some(Quality { values: &values, meaning: "distance in mm" })).unwrap();
    let mut file = BufReader::new(File::open(&path).unwrap());
    let ply = Parser::<DefaultElement>::new().read_ply(&mut file).unwrap();
    assert!(ply.header.comments.iter().any(|comment| comment.contains("quality: distance in mm")));
    let found = ply.payload["vertex"].iter().map(|vertex| match vertex["quality"] {
        Property::Float(value) => value,
        ref other => panic!("quality is {other:?}"),
    });
    assert!(found.eq(values.iter().copied()));
    assert_eq!(ply.payload["face"].len(), mesh.triangles.len(), "the faces come after it");
    assert!(write_ply(&path, &mesh, Some(Quality { values: &values[1..], meaning: "" })).is_err());
}

#[test]
fn meshes_that_do_not_hold_together_are_refused_and_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.obj");
    let sound = wavy(3);
    let mut few = sound.clone();
    few.normals.pop();
    let mut beyond = sound.clone();
    beyond.triangles[2][1] = 9;
    let mut nowhere = sound.clone();
    nowhere.positions[4].z = f32::NAN;
    let mut flat = sound.clone();
    flat.triangles.clear();
    let cases = [
        (few, MeshFault::Incomplete { what: "normals", found: 8, vertices: 9 }),
        (beyond, MeshFault::IndexOutOfRange { triangle: 2, index: 9, vertices: 9 }),
        (nowhere, MeshFault::NotFinite { what: "positions", count: 1, first: 4 }),
        (flat, MeshFault::NoTriangle { vertices: 9 }),
    ];
    for (mesh, expected) in cases {
        let refused = [
            write_obj(&path, &mesh, None),
            write_ply(&path, &mesh, None),
            write_stl(&path, &mesh),
            write_glb(&path, &mesh),
        ];
        for error in refused.map(Result::unwrap_err) {
            assert!(matches!(error, MeshFileError::Fault { fault, .. } if fault == expected), "{error}");
        }
    }
    assert!(!path.exists());
}

#[test]
fn a_full_disk_is_told() {
    let full = Path::new("/dev/full");
    if full.exists() {
        let mesh = wavy(3);
        let errors = [
            write_obj(full, &mesh, None),
            write_ply(full, &mesh, None),
            write_stl(full, &mesh),
            write_glb(full, &mesh),
        ];
        for error in errors.map(|written| written.unwrap_err().to_string()) {
            assert!(error.starts_with("/dev/full: cannot be written: No space left"), "{error}");
        }
    }
}
