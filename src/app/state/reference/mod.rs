//! The reference of the open set: reading it, registering the surfaces onto it, their distances.

mod compare;
mod of_session;
mod pairs;

use std::path::PathBuf;
use std::sync::Arc;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::mesh_file::read::{LengthScale, MeshError, MeshProblem};
use firstbounce_capture::pipeline::{Comparable, Frame, ReferenceError, read_comparable, truth_mesh};
use firstbounce_capture::set::{Projection, Truth};
use firstbounce_core::Mesh;

use crate::app::base::jobs::{Job, JobError, Jobs};
use crate::app::base::keyed::Keyed;
use crate::app::state::document::{Document, Poses, ReferenceSource};
use crate::app::state::results::Meshes;
use crate::app::state::surfaces::{LayerName, Prepared, thousands};
use crate::gpu::mesh::Shared;

pub use compare::{How, Outcome};
pub use pairs::Pairs;

/// A reference that was read.
pub struct Loaded {
    /// In mm.
    pub mesh: Arc<Mesh>,
    /// In whose frame it lies.
    pub frame: Frame,
    /// What it is, in words.
    pub words: String,
    /// What the user should know of it.
    pub warnings: Vec<String>,
}

/// What decides over the reference's mesh.
#[derive(Clone, Debug, PartialEq)]
struct LoadKey {
    source: ReferenceSource,
    unit: LengthScale,
    /// For the set's own truth: which files, seen by which camera.
    truth: Option<(PathBuf, Truth, Projection)>,
}

/// What was compared.
struct Basis {
    meshes: Arc<Meshes>,
    reference: Arc<Mesh>,
    /// Where the surfaces lay.
    poses: Option<Poses>,
}

impl PartialEq for Basis {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.meshes, &other.meshes)
            && Arc::ptr_eq(&self.reference, &other.reference)
            && self.poses == other.poses
    }
}

/// What a frame's update found that changes the document or is to be reported.
pub enum News {
    /// The surfaces were aligned.
    Aligned(Poses),
    /// Something was not done.
    Failed(JobError),
}

/// The reference of the open set.
#[derive(Default)]
pub struct Reference {
    key: Option<LoadKey>,
    loaded: Keyed<LoadKey, Loaded>,
    compared: Keyed<Basis, Outcome>,
    heat: Vec<HeatOf>,
    /// Pairs of points that are being picked.
    pub pairs: Option<Pairs>,
}

/// Distances as values of the vertices that are shown.
struct HeatOf {
    layer: LayerName,
    outcome: Arc<Outcome>,
    prepared: Arc<Prepared>,
    values: Shared<Vec<f32>>,
}

impl Reference {
    /// The reference, or why it could not be read; `None` without one, and while it is being read.
    pub fn loaded(&self) -> Option<&Result<Arc<Loaded>, JobError>> {
        Some(self.loaded.last()?.1)
    }

    /// Its mesh.
    pub fn mesh(&self) -> Option<Arc<Mesh>> {
        Some(self.loaded.ready()?.mesh.clone())
    }

    /// Whether it is being read.
    pub fn is_loading(&self) -> bool {
        self.loaded.running().is_some()
    }

    /// The comparison that is at work.
    pub fn comparing(&self) -> Option<&Job> {
        self.compared.running()
    }

    /// The last comparison, or why there is none.
    pub fn compared(&self) -> Option<&Result<Arc<Outcome>, JobError>> {
        Some(self.compared.last()?.1)
    }

    /// Whether the last comparison is of what there is now.
    pub fn is_current(&self, document: &Document, meshes: Option<&Arc<Meshes>>) -> bool {
        let poses = document.settings.reference.as_ref().and_then(|reference| reference.poses);
        self.compared.last().is_some_and(|(basis, _)| {
            meshes.is_some_and(|meshes| Arc::ptr_eq(meshes, &basis.meshes))
                && self.mesh().is_some_and(|mesh| Arc::ptr_eq(&mesh, &basis.reference))
                && basis.poses == poses
        })
    }

    /// Takes what is finished, and reads the reference that the document names. Once a frame.
    pub(in crate::app) fn update(&mut self, document: &Document, jobs: &mut Jobs) -> Vec<News> {
        let mut news = Vec::new();
        if let Some(Err(error)) = self.loaded.poll() {
            news.push(News::Failed(error.clone()));
        }
        self.take_compared(&mut news);
        let key = LoadKey::of(document);
        if key != self.key {
            // What was of another reference goes with it.
            if let Some(job) = self.comparing() {
                job.cancel();
            }
            *self = Self { key: key.clone(), ..Self::default() };
            if let Some(key) = key {
                let set = document.set.clone();
                let of = key.clone();
                self.loaded.start(key, jobs.start("Read the reference", move |_| load(&of, &set)));
            }
        }
        news
    }

    /// The distances of a surface as values of the vertices that are shown; `None` where they are of another mesh.
    pub(in crate::app) fn heat(
        &mut self,
        layer: LayerName,
        prepared: &Arc<Prepared>,
    ) -> Option<(Shared<Vec<f32>>, f64)> {
        let (basis, outcome) = self.compared.last()?;
        let outcome = outcome.as_ref().ok()?;
        let of = outcome.of(layer)?;
        let is_result = |mesh: &Arc<Mesh>| Arc::ptr_eq(mesh, &prepared.source);
        if !is_result(&basis.meshes.after) && !is_result(&basis.meshes.before) {
            return None;
        }
        let p95_mm = of.comparison.p95_mm;
        let is = |heat: &&HeatOf| Arc::ptr_eq(&heat.outcome, outcome) && Arc::ptr_eq(&heat.prepared, prepared);
        if let Some(known) = self.heat.iter().find(|heat| heat.layer == layer && is(heat)) {
            return Some((known.values.clone(), p95_mm));
        }
        let values = Shared(Arc::new(prepared.shown_values(&of.comparison.signed_mm)));
        let (outcome, prepared) = (outcome.clone(), prepared.clone());
        self.heat.retain(|heat| heat.layer != layer);
        self.heat.push(HeatOf { layer, outcome, prepared, values: values.clone() });
        Some((values, p95_mm))
    }
}

impl LoadKey {
    fn of(document: &Document) -> Option<Self> {
        let reference = document.settings.reference.as_ref()?;
        let set = &document.set;
        let truth = matches!(reference.source, ReferenceSource::Truth)
            .then(|| (set.folder.clone(), set.truth.clone(), set.camera.projection));
        Some(Self { source: reference.source.clone(), unit: reference.unit, truth })
    }
}

fn load(key: &LoadKey, set: &CaptureSet) -> Result<Loaded, ReferenceError> {
    let (name, Comparable { mesh, warnings, frame }) = match &key.source {
        ReferenceSource::Truth => {
            let truth = Comparable { mesh: truth_mesh(set)?, frame: Frame::Truth, warnings: Vec::new() };
            ("the set's own truth".into(), truth)
        }
        ReferenceSource::File(path) => {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
            let read = read_comparable(path, key.unit)?;
            // What is drawn needs a surface.
            if let Some(fault) = read.mesh.fault() {
                let problem = MeshProblem::Fault(fault);
                return Err(MeshError { path: path.clone(), problem }.into());
            }
            // The truth of another set lies in that set's frame.
            (name, Comparable { frame: Frame::Unknown, ..read })
        }
    };
    let size = mesh.bounds().map(|(low, high)| high - low).unwrap_or_default();
    let words = format!(
        "{name}: {} triangles, {:.1} x {:.1} x {:.1} mm",
        thousands(mesh.triangles.len()),
        size.x,
        size.y,
        size.z
    );
    Ok(Loaded { mesh: Arc::new(mesh), frame, words, warnings })
}
