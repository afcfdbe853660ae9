//! The tiles on the screen.

use eframe::egui::{Ui, WidgetText};
use egui_tiles::{Behavior, EditAction, SimplificationOptions, TileId, Tiles, UiResponse};

use super::{Canvases, Overlay, pane};
use crate::app::state::layout::{Arrange, View, panes_mut};
use crate::app::state::session::Session;

/// All views, filling the space that is left.
pub fn ui(ui: &mut Ui, session: &mut Session, canvases: &mut Canvases, overlay: &mut dyn Overlay) {
    let alone = session.views.maximised();
    let mut tree = session.views.take_tree();
    session.views.hover = None;
    let mut behaviour = Behaviour { session, canvases, overlay };
    let alone = alone.and_then(|id| panes_mut(&mut tree.tiles).find(|view| view.id == id));
    match alone {
        Some(view) => behaviour.view(ui, view),
        None => tree.ui(&mut behaviour, ui),
    }
    session.views.put_back(tree);
    match canvases.saving.taken() {
        Some(Ok(Some(path))) => session.done(format!("Saved {}", path.display())),
        Some(Ok(None)) => session.done("Copied the picture"),
        Some(Err(error)) => session.error(error.to_string()),
        None => {}
    }
}

struct Behaviour<'a> {
    session: &'a mut Session,
    canvases: &'a mut Canvases,
    overlay: &'a mut dyn Overlay,
}

impl Behaviour<'_> {
    /// What the user chooses in a view is kept.
    fn view(&mut self, ui: &mut Ui, view: &mut View) {
        let mut before = view.clone();
        pane::ui(ui, view, self.session, self.canvases, self.overlay);
        // The eye alone moves with the others.
        before.surface.camera = view.surface.camera;
        if before != *view {
            self.session.views.note_change();
        }
    }
}

impl Behavior<View> for Behaviour<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, view: &mut View) -> UiResponse {
        self.view(ui, view);
        UiResponse::None
    }

    fn on_edit(&mut self, edit: EditAction) {
        if matches!(edit, EditAction::TileResized | EditAction::TileDropped) {
            self.session.views.note_change();
        }
    }

    fn tab_title_for_pane(&mut self, view: &View) -> WidgetText {
        view.shown.title().into()
    }

    fn is_tab_closable(&self, tiles: &Tiles<View>, _: TileId) -> bool {
        tiles.tiles().filter(|tile| matches!(tile, egui_tiles::Tile::Pane(_))).count() > 1
    }

    fn on_tab_close(&mut self, tiles: &mut Tiles<View>, tile: TileId) -> bool {
        if let Some(view) = tiles.get_pane(&tile) {
            self.session.views.arrange(view.id, Arrange::Close);
        }
        false
    }

    fn simplification_options(&self) -> SimplificationOptions {
        // A view alone needs no tab: its header says what it shows.
        SimplificationOptions { all_panes_must_have_tabs: false, ..SimplificationOptions::default() }
    }
}
