//! The tiles on the screen.

use eframe::egui::{Ui, WidgetText};
use egui_tiles::{Behavior, SimplificationOptions, TileId, Tiles, UiResponse};

use super::{Canvases, Overlay, pane};
use crate::app::state::layout::{Arrange, View};
use crate::app::state::session::Session;

/// All views, filling the space that is left.
pub fn ui(ui: &mut Ui, session: &mut Session, canvases: &mut Canvases, overlay: &mut dyn Overlay) {
    let mut tree = session.views.take_tree();
    session.views.hover = None;
    tree.ui(&mut Behaviour { session, canvases, overlay }, ui);
    session.views.put_back(tree);
}

struct Behaviour<'a> {
    session: &'a mut Session,
    canvases: &'a mut Canvases,
    overlay: &'a mut dyn Overlay,
}

impl Behavior<View> for Behaviour<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, view: &mut View) -> UiResponse {
        pane::ui(ui, view, self.session, self.canvases, self.overlay);
        UiResponse::None
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
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }
}
