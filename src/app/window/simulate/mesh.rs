//! The mesh that is to be photographed, read off the UI thread.

use std::path::{Path, PathBuf};

use firstbounce_capture::mesh_file::read::LengthScale;
use firstbounce_lab::simulate::Scene;
use thiserror::Error;

use super::values::{SceneKind, Values};
use crate::app::base::jobs::JobError;
use crate::app::base::keyed::Keyed;
use crate::app::state::session::Session;
use crate::app::widgets::path_field::PathField;

/// A file, what one unit of it is, and whether its faces are turned round.
type Wanted = (PathBuf, LengthScale, bool);

/// Why there is no scene of a mesh.
#[derive(Clone, Debug, Error)]
pub enum NoScene {
    /// The file could not be read.
    #[error(transparent)]
    Unreadable(#[from] JobError),
    /// It is not read yet.
    #[error("{} is being read", path.display())]
    Reading {
        /// The file.
        path: PathBuf,
    },
    /// No file was chosen.
    #[error("choose a mesh file: OBJ, PLY or STL, z toward the camera")]
    NotChosen,
}

/// The mesh of the file that was chosen.
#[derive(Default)]
pub struct MeshChoice {
    /// Where the file is named.
    pub field: PathField,
    /// What is read, or was.
    wanted: Option<Wanted>,
    read: Keyed<Wanted, (Scene, Vec<String>)>,
    generation: u64,
}

impl MeshChoice {
    /// Chooses a file.
    pub fn choose(&mut self, path: &Path, values: &Values) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.want((path, values.scene.unit, values.scene.flip));
    }

    fn want(&mut self, wanted: Wanted) {
        self.wanted = Some(wanted);
        // The file may have changed since it was read last.
        self.read = Keyed::default();
        self.generation += 1;
    }

    /// Takes what was read, and reads what is wanted.
    pub fn update(&mut self, values: &Values, session: &mut Session) {
        if values.scene.kind != SceneKind::Mesh {
            return;
        }
        let now = self.wanted.clone().map(|(path, ..)| (path, values.scene.unit, values.scene.flip));
        if let Some(now) = now.filter(|now| self.wanted.as_ref() != Some(now)) {
            self.want(now);
        }
        if self.read.poll().is_some() {
            self.generation += 1;
        }
        if let Some(wanted) = self.wanted.clone().filter(|wanted| self.read.wants(wanted)) {
            let (path, unit, flip) = wanted.clone();
            let task = session.jobs.start("Read the mesh", move |_| Scene::read(&path, unit, flip));
            self.read.start(wanted, task);
        }
    }

    /// Grows whenever the scene has become another one.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// The scene.
    ///
    /// # Errors
    /// Why there is none yet.
    pub fn scene(&self) -> Result<Scene, NoScene> {
        match (self.read.last(), &self.wanted) {
            (Some((_, Ok(read))), _) => Ok(read.0.clone()),
            (Some((_, Err(error))), _) => Err(NoScene::Unreadable(error.clone())),
            (None, Some((path, ..))) => Err(NoScene::Reading { path: path.clone() }),
            (None, None) => Err(NoScene::NotChosen),
        }
    }

    /// What the user should know of the file.
    pub fn warnings(&self) -> &[String] {
        self.read.ready().map_or(&[], |read| read.1.as_slice())
    }
}
