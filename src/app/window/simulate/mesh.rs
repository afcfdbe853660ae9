//! The mesh that is to be photographed, read off the UI thread.

use std::path::{Path, PathBuf};

use firstbounce_capture::mesh_file::read::LengthScale;
use firstbounce_lab::simulate::Scene;

use super::values::{SceneKind, Values};
use crate::app::base::jobs::Task;
use crate::app::state::session::Session;
use crate::app::widgets::path_field::PathField;

/// A file, what one unit of it is, and whether its faces are turned round.
type Wanted = (PathBuf, LengthScale, bool);

/// The mesh of the file that was chosen.
#[derive(Default)]
pub struct MeshChoice {
    /// Where the file is named.
    pub field: PathField,
    /// What is read, or was.
    wanted: Option<Wanted>,
    task: Option<Task<(Scene, Vec<String>)>>,
    read: Option<Result<(Scene, Vec<String>), String>>,
    generation: u64,
}

impl MeshChoice {
    /// Chooses a file.
    pub fn choose(&mut self, path: &Path, values: &Values) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.want((path, values.unit, values.flip));
        // The file may have changed since it was read last.
        self.task = None;
        self.read = None;
    }

    fn want(&mut self, wanted: Wanted) {
        self.wanted = Some(wanted);
        self.task = None;
        self.read = None;
        self.generation += 1;
    }

    /// Takes what was read, and reads what is wanted.
    pub fn update(&mut self, values: &Values, session: &mut Session) {
        if values.scene != SceneKind::Mesh {
            return;
        }
        let now = self.wanted.clone().map(|(path, ..)| (path, values.unit, values.flip));
        if let Some(now) = now.filter(|now| self.wanted.as_ref() != Some(now)) {
            self.want(now);
        }
        if let Some(outcome) = self.task.as_ref().and_then(Task::poll) {
            self.task = None;
            self.read = Some(outcome);
            self.generation += 1;
        }
        if let (Some((path, unit, flip)), None, None) = (self.wanted.clone(), &self.task, &self.read) {
            self.task =
                Some(session.jobs.start("Read the mesh", move |_| {
                    Scene::read(&path, unit, flip).map_err(|error| error.to_string())
                }));
        }
    }

    /// Grows whenever the scene has become another one.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// The scene.
    ///
    /// # Errors
    /// One line: why there is none yet.
    pub fn scene(&self) -> Result<Scene, String> {
        match (&self.read, &self.wanted) {
            (Some(read), _) => read.clone().map(|(scene, _)| scene),
            (None, Some((path, ..))) => Err(format!("{} is being read", path.display())),
            (None, None) => Err("choose a mesh file: OBJ, PLY or STL, z toward the camera".into()),
        }
    }

    /// What the user should know of the file.
    pub fn warnings(&self) -> &[String] {
        match &self.read {
            Some(Ok((_, warnings))) => warnings,
            _ => &[],
        }
    }
}
