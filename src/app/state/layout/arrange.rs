//! Changes of the arrangement: tiles split, put into tabs, closed.

use std::mem;

use eframe::egui::Id;
use egui_tiles::{LinearDir, TileId, Tree};

use super::{View, Views, panes};

/// A change of the arrangement, made after all views were drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrange {
    /// The same view once more, right of it.
    SplitRight,
    /// The same view once more, below it.
    SplitDown,
    /// The same view once more, as a tab.
    NewTab,
    /// Takes the view away; the last one stays.
    Close,
}

impl Views {
    pub(super) fn apply_arrangement(&mut self) {
        for (id, arrange) in mem::take(&mut self.arrangement) {
            self.note_change();
            self.maximised = None;
            let tile = |(tile, of): (&TileId, &egui_tiles::Tile<View>)| match of {
                egui_tiles::Tile::Pane(view) if view.id == id => Some((*tile, view.clone())),
                _ => None,
            };
            let Some((tile, view)) = self.tree.tiles.iter().find_map(tile) else { continue };
            match arrange {
                Arrange::Close => self.close(tile),
                Arrange::NewTab => self.insert_tab(tile, view),
                Arrange::SplitRight => self.split(tile, view, LinearDir::Horizontal),
                Arrange::SplitDown => self.split(tile, view, LinearDir::Vertical),
            }
        }
    }

    fn copy_of(&mut self, view: View) -> View {
        let id = self.next_id;
        self.next_id += 1;
        self.active = Some(id);
        View { id, ..view }
    }

    fn close(&mut self, tile: TileId) {
        if panes(&self.tree.tiles).count() > 1 {
            self.tree.remove_recursively(tile);
            self.active = panes(&self.tree.tiles).map(|view| view.id).min();
        }
    }

    fn insert_tab(&mut self, tile: TileId, view: View) {
        let view = self.copy_of(view);
        let id = view.id;
        let new = self.tree.tiles.insert_pane(view);
        let tabs = self.tabs_of(tile);
        if let Some(egui_tiles::Tile::Container(container)) = self.tree.tiles.get_mut(tabs) {
            container.add_child(new);
        }
        self.bring_to_front(id);
    }

    /// The tabs that a view lies in: a view alone gets tabs of its own.
    fn tabs_of(&mut self, tile: TileId) -> TileId {
        let parent = self.tree.tiles.parent_of(tile);
        match parent.and_then(|parent| Some((parent, self.tree.tiles.get(parent)?))) {
            Some((parent, egui_tiles::Tile::Container(egui_tiles::Container::Tabs(_)))) => parent,
            _ => {
                let tabs = self.tree.tiles.insert_tab_tile(vec![tile]);
                self.put_in_place_of(parent, tile, tabs);
                tabs
            }
        }
    }

    /// Puts a row or a column in the place of the view's tabs, with those tabs and a new view in it.
    fn split(&mut self, tile: TileId, view: View, direction: LinearDir) {
        let view = self.copy_of(view);
        let tabs = self.tabs_of(tile);
        let outer = self.tree.tiles.parent_of(tabs);
        let new = self.tree.tiles.insert_pane(view);
        let children = vec![tabs, new];
        let both = match direction {
            LinearDir::Horizontal => self.tree.tiles.insert_horizontal_tile(children),
            LinearDir::Vertical => self.tree.tiles.insert_vertical_tile(children),
        };
        self.put_in_place_of(outer, tabs, both);
    }

    /// In the container, or as the root.
    fn put_in_place_of(&mut self, container: Option<TileId>, old: TileId, new: TileId) {
        match container.and_then(|container| self.tree.tiles.get_mut(container)) {
            Some(egui_tiles::Tile::Container(container)) => replace_child(container, old, new),
            _ => self.tree = Tree::new(Id::unique("views"), new, mem::take(&mut self.tree.tiles)),
        }
    }
}

fn replace_child(container: &mut egui_tiles::Container, old: TileId, new: TileId) {
    use egui_tiles::Container;
    let swap = |children: &mut Vec<TileId>| children.iter_mut().filter(|child| **child == old).for_each(|c| *c = new);
    match container {
        Container::Tabs(tabs) => {
            swap(&mut tabs.children);
            tabs.active = Some(new);
        }
        Container::Linear(linear) => {
            swap(&mut linear.children);
            linear.shares.replace_with(old, new);
        }
        // Grids are not made here; a new place at their end is as good.
        Container::Grid(_) => {
            container.remove_child(old);
            container.add_child(new);
        }
    }
}
