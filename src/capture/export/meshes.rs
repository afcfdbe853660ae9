//! A surface's meshes in the formats that were asked for.

use firstbounce_core::mesh::decimate::{DecimateOptions, Decimated, decimate};
use firstbounce_core::{Camera, Mesh, Plane};

use super::{Files, OutputOptions, write_bytes, write_text};
use crate::image_file::{GreyBits, texture_png};
use crate::mesh_file::{Embedded, Material, MeshContents, OutputFormat, Quality, write_mesh};
use crate::pipeline::{PipelineError, Surface, relative_albedo};
use crate::report::{DecimationRecord, ExportRecord};

/// What the quality of a vertex is.
const QUALITY: &str = "predicted noise of the normal in degrees, 0 where unknown";

/// Writes the mesh of a surface, and what goes with it; `suffix` goes into the names, `origin` into what is said of them.
pub(super) fn write_meshes(
    surface: &Surface,
    (suffix, origin): (&str, &str),
    camera: &Camera,
    options: &OutputOptions,
    files: &mut Files,
    export: &mut ExportRecord,
    watch: &dyn firstbounce_core::Watch,
) -> Result<(), PipelineError> {
    if options.formats.is_empty() {
        return Ok(());
    }
    let decimated = match options.triangles {
        Some(triangles) => Some(decimate(&surface.mesh, &DecimateOptions { triangles }, watch)?),
        None => None,
    };
    if let Some(Decimated { report, mesh, .. }) = &decimated {
        export.decimation.insert(format!("mesh{suffix}"), DecimationRecord::of(report, mesh.unit));
    }
    let mesh = decimated.as_ref().map_or(&*surface.mesh, |decimated| &decimated.mesh);
    let pixels: Vec<_> = mesh.positions.iter().map(|position| camera.pixel_px(&position.cast())).collect();

    let albedo = relative_albedo(&surface.shape.normals.albedo);
    let texture = |bits| texture_png(&albedo, &surface.shape.depth.mask, bits);
    let uv = places(&pixels, camera.size);
    let noise = values_at(&pixels, &surface.shape.normals.noise_deg);
    let library = format!("mesh{suffix}.mtl");
    for &format in &options.formats {
        let mut contents = MeshContents { axes: options.axes, ..MeshContents::of(mesh) };
        let picture;
        match (format, options.texture) {
            (OutputFormat::Obj, Some(bits)) => {
                let material = Material { library: &library, name: "albedo", uv: &uv };
                contents.material = Some(material);
                let name = format!("albedo{suffix}.png");
                let text = material.library_text(&name);
                write_text(&files.add(&library, format!("material of mesh{suffix}.obj"))?, &text)?;
                write_bytes(
                    &files.add(&name, format!("relative albedo{origin}, sRGB, texture of the OBJ"))?,
                    &texture(bits)?,
                )?;
            }
            (OutputFormat::Glb, Some(_)) => {
                picture = texture(GreyBits::Eight)?;
                contents.embedded = Some(Embedded { png: &picture, uv: &uv });
            }
            (OutputFormat::Ply, _) => contents.quality = Some(Quality { values: &noise, meaning: QUALITY }),
            _ => {}
        }
        let name = format!("mesh{suffix}.{}", format.extension());
        let what = what(format, mesh, origin, options);
        write_mesh(&files.add(name, what)?, format, &contents)?;
    }
    Ok(())
}

/// "mesh in mm, 20000 triangles, x right, y up, z toward the camera"
fn what(format: OutputFormat, mesh: &Mesh, origin: &str, options: &OutputOptions) -> String {
    let axes = format.axes(options.axes).words();
    format!("mesh{origin}, {} triangles, in {}, {axes}", mesh.triangles.len(), format.unit(mesh.unit))
}

/// Pixel positions as places in a texture: right from the left edge, up from the lower edge, both 0 to 1.
fn places(pixels: &[(f64, f64)], (width, height): (usize, usize)) -> Vec<[f32; 2]> {
    let place = |&(x, y): &(f64, f64)| [(x / width as f64) as f32, (1.0 - y / height as f64) as f32];
    pixels.iter().map(place).collect()
}

/// The values of the pixels in which these positions lie.
fn values_at(pixels: &[(f64, f64)], plane: &Plane) -> Vec<f32> {
    let index = |position: f64, size: usize| (position.max(0.0) as usize).min(size.saturating_sub(1));
    let value = |&(x, y): &(f64, f64)| plane.at(index(x, plane.width()), index(y, plane.height()));
    pixels.iter().map(value).collect()
}
