//! What result files are called.

use super::file_names::is_one_of;

pub(super) const REPORT: &str = "report.json";
pub(super) const PAGE: &str = "report.html";
pub(super) const OVERVIEW: &str = "overview.png";
pub(super) const BOUNCES: &str = "bounces-{light}.exr";
pub(super) const BOUNCE: &str = "bounce{k}-{light}.exr";
pub(super) const SEPARATED: &str = "separated-{light}.exr";
pub(super) const DIRECT: &str = "direct-{light}.exr";
pub(super) const INDIRECT: &str = "indirect-{light}.exr";
pub(super) const LIGHTS: &str = "lights.lp";
pub(super) const LIGHTS_OF_COLOUR: &str = "lights-{colour}.lp";
pub(super) const NORMALS_PNG: &str = "normals{surface}.png";
pub(super) const NORMALS_EXR: &str = "normals{surface}.exr";
pub(super) const ALBEDO: &str = "albedo{surface}.exr";
pub(super) const NORMAL_NOISE: &str = "normal-noise{surface}.exr";
pub(super) const DEPTH: &str = "depth{surface}.exr";
pub(super) const DEPTH_PNG: &str = "depth{surface}.png";
pub(super) const MESH: &str = "mesh{surface}.{format}";
pub(super) const MATERIAL: &str = "mesh{surface}.mtl";
pub(super) const TEXTURE: &str = "albedo{surface}.png";

const ALL: [&str; 19] = [
    REPORT,
    PAGE,
    OVERVIEW,
    BOUNCES,
    BOUNCE,
    SEPARATED,
    DIRECT,
    INDIRECT,
    LIGHTS,
    LIGHTS_OF_COLOUR,
    NORMALS_PNG,
    NORMALS_EXR,
    ALBEDO,
    NORMAL_NOISE,
    DEPTH,
    DEPTH_PNG,
    MESH,
    MATERIAL,
    TEXTURE,
];

/// Whether a result file can be called so: one plain name that this program makes.
pub fn is_result_name(name: &str) -> bool {
    is_one_of(&ALL, name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_that_the_program_makes_are_names_of_results() {
        for name in
            ["report.json", "bounces-left.exr", "bounce12-a.b-c.exr", "mesh-raw.glb", "lights-blue.lp", "bounces-..exr"]
        {
            assert!(is_result_name(name), "{name}");
        }
        for name in [
            "",
            ".",
            "..",
            "d/thesis.tex",
            "thesis.tex",
            "../report.json",
            "./report.json",
            "/etc/x",
            "bounces-.exr",
            "bounces-a/b.exr",
            "bounces-../../x.exr",
            "bounces-a\\b.exr",
            "bounces- a.exr",
            "bounce0-a.exr",
            "bounce+1-a.exr",
            "bounce-a.exr",
            "mesh-old.obj",
            "mesh.tex",
            "report.json\n",
            "REPORT.JSON",
        ] {
            assert!(!is_result_name(name), "{name:?}");
        }
        assert!(!is_result_name(&format!("bounces-{}.exr", "a".repeat(1 << 20))));
    }
}
