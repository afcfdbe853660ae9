//! Every mesh format, y up and z up, whole and decimated, textured and not, as other people's readers see it.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use firstbounce_capture::image_file::{GreyBits, texture_png};
use firstbounce_capture::mesh_file::{Axes, Embedded, Material, MeshContents, OutputFormat, write_mesh};
use firstbounce_core::mesh::decimate::{DecimateOptions, decimate};
use firstbounce_core::mesh::{LengthUnit, MeshOptions, from_depth};
use firstbounce_core::{Camera, Mask, Mesh, Plane, Projection, Unwatched};
use nalgebra::{Point3, Vector3};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

const SIZE: (usize, usize) = (60, 40);

fn camera(mm_per_pixel: Option<f64>) -> Camera {
    Camera { projection: Projection::Orthographic { mm_per_pixel }, size: SIZE }
}

fn mask() -> Mask {
    Mask::from_fn(SIZE.0, SIZE.1, |x, y| (x as f32 - 30.0).hypot(1.5 * (y as f32 - 20.0)) < 27.0)
}

/// Waves over an ellipse that is wider than high, so that no two axes can be mistaken for each other.
fn surface(mm_per_pixel: Option<f64>) -> Mesh {
    let depth = Plane::from_fn(SIZE.0, SIZE.1, |x, y| (x as f32 * 0.2).sin() + 0.7 * (y as f32 * 0.3).cos());
    let albedo = Plane::from_fn(SIZE.0, SIZE.1, |x, _| x as f32 / 60.0);
    from_depth(&depth, &mask(), &camera(mm_per_pixel), None, Some(&albedo), &MeshOptions::default()).unwrap().0
}

fn decimated() -> Mesh {
    let options = DecimateOptions { triangles: 500 };
    let decimated = decimate(&surface(Some(0.25)), &options, &Unwatched).unwrap();
    assert!(decimated.report.triangles <= 500);
    decimated.mesh
}

/// What a reader found, in the file's own unit and axes.
struct Found {
    positions: Vec<Point3<f32>>,
    triangles: Vec<[u32; 3]>,
}

fn read(format: OutputFormat, path: &Path) -> Found {
    let points = |flat: &[f32]| flat.as_chunks().0.iter().map(|p: &[f32; 3]| Point3::from(*p)).collect();
    match format {
        OutputFormat::Obj => {
            let (models, _) = tobj::load_obj(path, &tobj::LoadOptions::default()).unwrap();
            assert_eq!(models.len(), 1);
            let mesh = &models[0].mesh;
            Found { positions: points(&mesh.positions), triangles: mesh.indices.as_chunks().0.to_vec() }
        }
        OutputFormat::Ply => {
            let mut file = BufReader::new(File::open(path).unwrap());
            let ply = Parser::<DefaultElement>::new().read_ply(&mut file).unwrap();
            let float = |element: &DefaultElement, name: &str| match element[name] {
                Property::Float(value) => value,
                ref other => panic!("{name} is {other:?}"),
            };
            let corner = |face: &DefaultElement| match &face["vertex_indices"] {
                Property::ListInt(corners) => [corners[0], corners[1], corners[2]].map(|corner| corner as u32),
                other => panic!("a face is {other:?}"),
            };
            let vertices = ply.payload["vertex"].iter();
            Found {
                positions: vertices.map(|v| Point3::from(["x", "y", "z"].map(|name| float(v, name)))).collect(),
                triangles: ply.payload["face"].iter().map(corner).collect(),
            }
        }
        OutputFormat::Stl => {
            let stl = stl_io::read_stl(&mut BufReader::new(File::open(path).unwrap())).unwrap();
            Found {
                positions: stl.vertices.iter().map(|vertex| Point3::from(vertex.0)).collect(),
                triangles: stl.faces.iter().map(|face| face.vertices.map(|vertex| vertex as u32)).collect(),
            }
        }
        OutputFormat::Glb => {
            let glb = gltf::Gltf::from_slice(&fs::read(path).unwrap()).expect("valid by the crate's own check");
            let blob = glb.blob.as_deref().unwrap();
            let primitive = glb.meshes().next().unwrap().primitives().next().unwrap();
            let reader = primitive.reader(|_| Some(blob));
            let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
            Found {
                positions: reader.read_positions().unwrap().map(Point3::from).collect(),
                triangles: indices.as_chunks().0.to_vec(),
            }
        }
    }
}

/// Twice the sum of the triangles' areas as vectors: which way the surface faces, and how much of it there is.
fn facing(positions: &[Point3<f32>], triangles: &[[u32; 3]]) -> Vector3<f64> {
    let area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| positions[corner as usize].cast::<f64>());
        (b - a).cross(&(c - a))
    };
    triangles.iter().map(area).sum()
}

fn bounds(positions: &[Point3<f32>]) -> [Point3<f32>; 2] {
    let first = positions[0];
    let (low, high) = positions.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    [low, high]
}

#[test]
fn every_format_has_the_same_vertices_bounds_and_winding() {
    let folder = tempfile::tempdir().unwrap();
    for (name, mesh) in [("whole", surface(Some(0.25))), ("decimated", decimated()), ("px", surface(None))] {
        for format in OutputFormat::ALL {
            for axes in [Axes::YUp, Axes::ZUp] {
                let path = folder.path().join(format!("{name}.{}", format.extension()));
                write_mesh(&path, format, &MeshContents { axes, ..MeshContents::of(&mesh) }).unwrap();
                let found = read(format, &path);
                let case = format!("{name}, {format}, {axes:?}");
                assert_eq!(found.positions.len(), mesh.positions.len(), "{case}");
                assert_eq!(found.triangles.len(), mesh.triangles.len(), "{case}");

                // Where each axis of the object frame is found: z up, it is a quarter turn about x.
                let scale = if format == OutputFormat::Glb { 1e-3 } else { 1.0 };
                let turned = axes == Axes::ZUp && format != OutputFormat::Glb;
                let expect = |v: Vector3<f64>| if turned { Vector3::new(v.x, -v.z, v.y) } else { v };
                let [low, high] = bounds(&mesh.positions).map(|p| expect(p.coords.cast()) * scale);
                let [found_low, found_high] = bounds(&found.positions).map(|p| p.coords.cast::<f64>());
                let tolerance = 1e-5 * scale;
                assert!((found_low - low.inf(&high)).amax() < tolerance, "{case}: {found_low} for {low}");
                assert!((found_high - low.sup(&high)).amax() < tolerance, "{case}: {found_high} for {high}");
                let truth = expect(facing(&mesh.positions, &mesh.triangles)) * scale * scale;
                let found = facing(&found.positions, &found.triangles);
                assert!((found - truth).norm() < 1e-4 * truth.norm(), "{case}: {found} for {truth}");
            }
        }
    }
}

#[test]
fn the_files_say_their_unit_and_axes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh");
    for (mesh, unit, metres) in [(surface(Some(0.25)), "mm", "metre"), (surface(None), "pixels (no scale", "no scale")]
    {
        for format in OutputFormat::ALL {
            write_mesh(&path, format, &MeshContents { axes: Axes::ZUp, ..MeshContents::of(&mesh) }).unwrap();
            let bytes = fs::read(&path).unwrap();
            let start = String::from_utf8_lossy(&bytes[..bytes.len().min(1000)]).into_owned();
            match format {
                OutputFormat::Glb => assert!(start.contains(metres), "{start}"),
                _ => assert!(start.contains(unit) && start.contains("z up"), "{format}: {start}"),
            }
            assert!(!start.starts_with("solid"));
        }
    }
    assert_eq!(surface(None).unit, LengthUnit::Pixel);
}

/// For each vertex its pixel, as the texture counts: right from the left edge, up from the lower edge.
fn uv(mesh: &Mesh, camera: &Camera) -> Vec<[f32; 2]> {
    let place = |p: &Point3<f32>| {
        let (x, y) = camera.pixel_px(&p.cast());
        [(x / 60.0) as f32, (1.0 - y / 40.0) as f32]
    };
    mesh.positions.iter().map(place).collect()
}

/// A texel of the PNG at a place that counts downward, as light.
fn sampled(picture: &image::DynamicImage, [u, v]: [f32; 2]) -> f32 {
    let grey = picture.to_luma32f();
    let texel = |along: f32, size: u32| ((along * size as f32) as u32).min(size - 1);
    let encoded = grey.get_pixel(texel(u, grey.width()), texel(v, grey.height())).0[0];
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[test]
fn the_textures_of_obj_and_gltf_show_each_vertex_its_own_albedo() {
    let folder = tempfile::tempdir().unwrap();
    let albedo = Plane::from_fn(SIZE.0, SIZE.1, |x, _| x as f32 / 60.0);
    let png = texture_png(&albedo, &mask(), GreyBits::Eight).unwrap();
    let at = |name: &str| folder.path().join(name);
    for mesh in [surface(Some(0.25)), decimated()] {
        let uv = uv(&mesh, &camera(Some(0.25)));
        let material = Material { library: "mesh.mtl", name: "albedo", uv: &uv };
        let embedded = Some(Embedded { png: &png, uv: &uv });
        let contents = MeshContents { material: Some(material), embedded, ..MeshContents::of(&mesh) };
        write_mesh(&at("mesh.obj"), OutputFormat::Obj, &contents).unwrap();
        write_mesh(&at("mesh.glb"), OutputFormat::Glb, &contents).unwrap();
        fs::write(at("mesh.mtl"), material.library_text("albedo.png")).unwrap();
        fs::write(at("albedo.png"), &png).unwrap();

        // OBJ: the material names the picture, and texture places count upward.
        let (models, materials) = tobj::load_obj(at("mesh.obj"), &tobj::GPU_LOAD_OPTIONS).unwrap();
        let materials = materials.unwrap();
        assert_eq!(materials[models[0].mesh.material_id.unwrap()].diffuse_texture.as_deref(), Some("albedo.png"));
        let picture = image::open(at("albedo.png")).unwrap();
        let read = &models[0].mesh;
        assert_eq!(read.positions.len(), 3 * mesh.positions.len(), "one place for each vertex");
        assert!(read.vertex_color.is_empty(), "programs multiply texture and colours");
        for (position, place) in read.positions.chunks(3).zip(read.texcoords.chunks(2)) {
            let truth = (position[0] / 0.25 + 30.0).floor() / 60.0;
            assert!((sampled(&picture, [place[0], 1.0 - place[1]]) - truth).abs() < 0.01);
        }

        // glTF: the picture lies within, and texture places count downward.
        let glb = gltf::Gltf::from_slice(&fs::read(at("mesh.glb")).unwrap()).unwrap();
        let blob = glb.blob.as_deref().unwrap();
        let primitive = glb.meshes().next().unwrap().primitives().next().unwrap();
        let texture = primitive.material().pbr_metallic_roughness().base_color_texture().unwrap().texture();
        let gltf::image::Source::View { view, mime_type } = texture.source().source() else { panic!("outside") };
        assert_eq!(mime_type, "image/png");
        let picture = image::load_from_memory(&blob[view.offset()..view.offset() + view.length()]).unwrap();
        let reader = primitive.reader(|_| Some(blob));
        assert!(reader.read_colors(0).is_none());
        let places: Vec<[f32; 2]> = reader.read_tex_coords(0).unwrap().into_f32().collect();
        assert_eq!(places.len(), mesh.positions.len());
        for (position, place) in reader.read_positions().unwrap().zip(places) {
            let truth = (position[0] / 0.25e-3 + 30.0).floor() / 60.0;
            assert!((sampled(&picture, place) - truth).abs() < 0.01);
        }
        let (one_less, few) = (&uv[1..], Embedded { png: &png, uv: &uv[1..] });
        let few = MeshContents { embedded: Some(few), ..MeshContents::of(&mesh) };
        assert!(write_mesh(&at("few.glb"), OutputFormat::Glb, &few).is_err());
        let material = Some(Material { uv: one_less, ..material });
        assert!(
            write_mesh(&at("few.obj"), OutputFormat::Obj, &MeshContents { material, ..MeshContents::of(&mesh) })
                .is_err()
        );
    }
}
