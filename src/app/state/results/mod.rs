//! The results of the document: stage by stage, off the UI thread, the last good result kept until the new one is
//! there.

mod engine;
mod error;
mod finished;
mod live;
mod pictures;
mod plain;
mod stages;

use std::any::Any;
use std::cell::RefCell;
use std::sync::Arc;
use std::time::Instant;

use firstbounce_capture::pipeline::{CaptureReport, Method, PhotoStore, Separated};
use firstbounce_core::Mesh;
use firstbounce_core::stereo::shape::Shape;

use crate::app::base::jobs::drop_aside;
use crate::app::state::document::Document;

pub use engine::{Next, StageState};
pub use error::StageError;
pub use finished::{Finished, last_stage_of};
pub use firstbounce_capture::pipeline::SurfaceName;
pub use live::Rig;
pub use pictures::{MarksName, Pictures, PlaneName, ShotName, Stored, stage_of};
pub use plain::{Of, Place, Plain, PlainPicture, Quantity, Range};
pub use stages::{ByMethod, Calibration, Loaded, LoadedShot, Meshes, MethodLight, Shapes, Step};

use engine::{Keys, Row, Running};
use stages::Checked;

/// Every stage.
pub struct Results {
    /// In the order of the table of stages.
    rows: Vec<Row>,
    running: Option<Running>,
    /// Each file decoded once, whatever is renamed or added.
    photos: Arc<PhotoStore>,
    pictures: Pictures,
    /// Counts the requests to read every file again.
    reloads: u64,
    settling: Option<(Arc<Document>, Instant)>,
    /// The keys that were asked for last: every panel asks for them in every frame.
    keys: RefCell<Option<(Document, Arc<Keys>)>>,
}

impl Default for Results {
    fn default() -> Self {
        Self {
            rows: engine::rows(),
            running: None,
            photos: Arc::default(),
            pictures: Pictures::default(),
            reloads: 0,
            settling: None,
            keys: RefCell::default(),
        }
    }
}

impl Results {
    /// The photos, once they were read.
    pub fn loaded(&self) -> Option<Arc<Loaded>> {
        self.last(Step::Load)
    }

    /// The rig in force: what the file gives, and what the balls say where it gives nothing.
    pub fn calibration(&self) -> Option<Arc<Calibration>> {
        self.last(Step::Calibrate)
    }

    /// What the balls alone say, whatever the file gives.
    pub fn measured(&self) -> Option<Arc<Calibration>> {
        self.last(Step::Measure)
    }

    /// What the method in force found.
    pub fn method_light(&self) -> Option<Arc<MethodLight>> {
        self.last(Step::Separate)
    }

    /// The bounces that it tells apart, as they would be saved.
    pub fn separated(&self) -> Option<Arc<Separated>> {
        Some(self.method_light()?.separated.clone())
    }

    /// Normals and depth, before and after.
    pub fn shapes(&self) -> Option<Arc<Shapes>> {
        self.last(Step::Shape)
    }

    /// Triangles, before and after.
    pub fn meshes(&self) -> Option<Arc<Meshes>> {
        self.last(Step::Mesh)
    }

    /// The same, where they are those of the document.
    pub fn current_meshes(&self, document: &Document) -> Option<Arc<Meshes>> {
        self.meshes().filter(|_| self.state(Step::Mesh, document) == StageState::Ready)
    }

    /// Normals and depth of a surface.
    pub fn shape(&self, name: SurfaceName) -> Option<Arc<Shape>> {
        match name {
            SurfaceName::Before => Some(self.shapes()?.before.clone()),
            SurfaceName::After => Some(self.shapes()?.after.clone()),
            SurfaceName::By(method) => Some(self.by_method(method)?.surface.shape.clone()),
        }
    }

    /// The triangles of a surface, where they are asked for.
    pub fn mesh(&self, name: SurfaceName, document: &Document) -> Option<Arc<Mesh>> {
        match name {
            SurfaceName::Before => Some(self.meshes()?.before.clone()),
            SurfaceName::After => Some(self.meshes()?.after.clone()),
            SurfaceName::By(method) => {
                let asked = document.is_compared(method);
                Some(self.by_method(method).filter(|_| asked)?.surface.mesh.clone())
            }
        }
    }

    /// What is wrong with the captures of this document, as far as it is known.
    pub fn captures(&self, document: &Document) -> CaptureReport {
        let is_ready = |step| self.state(step, document) == StageState::Ready;
        let checked: Option<Arc<Checked>> = self.last(Step::Check).filter(|_| is_ready(Step::Check));
        let of_rig = checked.map(|checked| checked.captures.clone());
        let of_photos = || self.loaded().map(|loaded| loaded.captures.report.clone());
        let of_surface = self.shapes().filter(|_| is_ready(Step::Shape)).map(|shapes| shapes.captures.clone());
        of_rig.or_else(of_photos).unwrap_or_default().with(of_surface.unwrap_or_default())
    }

    /// What another method found, where it was asked for.
    pub fn by_method(&self, method: Method) -> Option<Arc<ByMethod>> {
        self.last(Step::ByMethod(method))
    }

    /// Files decoded since they were last read afresh.
    pub fn decoded_files(&self) -> usize {
        self.photos.decoded_files()
    }

    /// Every plane that can be shown.
    pub fn pictures(&self) -> &Pictures {
        &self.pictures
    }

    /// Reads those files again that have changed.
    pub fn look_again(&mut self) {
        self.reloads += 1;
        self.keys.take();
    }

    /// Reads every file again.
    pub fn reload(&mut self) {
        self.reloads += 1;
        self.photos = Arc::default();
        self.keys.take();
    }

    /// Forgets everything: another set was opened.
    pub fn clear(&mut self) {
        if let Some(running) = &self.running {
            running.cancel();
        }
        let reloads = self.reloads + 1;
        drop_aside(std::mem::replace(self, Self { reloads, ..Self::default() }));
    }

    /// The last good result of a stage, which is a `T`.
    fn last<T: Any + Send + Sync>(&self, step: Step) -> Option<Arc<T>> {
        self.rows[self.index(step)?].slot.last.clone()?.downcast().ok()
    }

    /// The place of a stage in the table.
    fn index(&self, step: Step) -> Option<usize> {
        self.rows.iter().position(|row| row.stage.step() == step)
    }
}
