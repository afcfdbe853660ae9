//! Parts of a panel that keep their identity while others come and go.

use std::hash::Hash;

use eframe::egui::{Ui, UiBuilder};

/// Shows a part of a panel under a name of its own. egui counts widgets to distinguish them: without this a line that
/// appears above a field takes the focus, and a drag, from the hand that holds it.
pub fn part<R>(ui: &mut Ui, name: impl Hash + std::fmt::Debug, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let id = ui.scope_id().with(("part", name));
    ui.scope_builder(UiBuilder::new().scope_id(id), contents).inner
}
