//! The layout: which views there are, how they are arranged, and what each shows.

mod look;
mod rebuild;
mod shown;

use eframe::egui::Id;
use egui_tiles::{LinearDir, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

pub use look::Look;
pub use shown::Shown;

use crate::app::state::surfaces::SurfaceLook;

/// One view: what it shows and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Identifies the view for as long as the layout is kept.
    pub id: u64,
    /// What is shown.
    pub shown: Shown,
    /// What it is compared with, by holding B or by a wipe.
    pub against: Option<Shown>,
    /// Whether a line divides the two.
    pub wipe: bool,
    /// How numbers become colours.
    pub look: Look,
    /// Whether zoom and pan follow the other linked views.
    pub linked: bool,
    /// How a surface in 3D is shown.
    #[serde(default)]
    pub surface: SurfaceLook,
}

/// The pixel under the pointer or the keyboard's cursor, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Hover {
    /// What is shown there.
    pub shown: Shown,
    /// Column and row.
    pub pixel: (usize, usize),
}

/// All views and how they are arranged.
pub struct Views {
    tree: Tree<View>,
    /// The pixel that is looked at, in this frame or the last.
    pub hover: Option<Hover>,
    /// The view that commands act on: the one that was clicked last.
    active: Option<u64>,
    next_id: u64,
    arrangement: Vec<(u64, Arrange)>,
    /// What the active view is to show once the views are drawn.
    wanted: Option<Shown>,
}

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

impl Default for Views {
    fn default() -> Self {
        Self::showing(Shown::default())
    }
}

impl Views {
    /// One view of one picture.
    pub fn showing(shown: Shown) -> Self {
        let view = View {
            id: 0,
            shown,
            against: None,
            wipe: false,
            look: Look::default(),
            linked: true,
            surface: SurfaceLook::default(),
        };
        Self::of(Tree::new_tabs(Id::unique("views"), vec![view]))
    }

    fn of(tree: Tree<View>) -> Self {
        let next_id = panes(&tree.tiles).map(|view| view.id + 1).max().unwrap_or(0);
        let active = panes(&tree.tiles).map(|view| view.id).min();
        Self { tree, hover: None, active, next_id, arrangement: Vec::new(), wanted: None }
    }

    /// The arrangement as it is kept beside the set.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::to_value(&self.tree).unwrap_or_default()
    }

    /// The arrangement that was kept; `None` if it holds no view.
    pub fn from_json(kept: serde_json::Value) -> Option<Self> {
        let tree: Tree<View> = serde_json::from_value(kept).ok()?;
        rebuild::rebuilt(&tree).map(Self::of)
    }

    /// The view that commands act on.
    pub fn active(&self) -> Option<&View> {
        panes(&self.tree.tiles).find(|view| Some(view.id) == self.active)
    }

    /// The same, to be changed.
    pub fn active_mut(&mut self) -> Option<&mut View> {
        let active = self.active;
        self.tree.tiles.tiles_mut().find_map(|tile| match tile {
            egui_tiles::Tile::Pane(view) if Some(view.id) == active => Some(view),
            _ => None,
        })
    }

    /// Every view.
    pub fn all(&self) -> impl Iterator<Item = &View> {
        panes(&self.tree.tiles)
    }

    /// Makes the active view show this.
    pub fn show(&mut self, shown: impl Into<Shown>) {
        let shown = shown.into();
        if self.tree.root().is_none() {
            self.wanted = Some(shown);
        } else if let Some(view) = self.active_mut()
            && view.shown != shown
        {
            view.shown = shown;
            view.look = Look::default();
        }
    }

    /// Shows this in a tab of its own, or brings the view that shows it to the front.
    pub fn open(&mut self, shown: Shown) {
        let there = panes(&self.tree.tiles).find(|view| view.shown == shown).map(|view| view.id);
        match there {
            Some(there) => self.bring_to_front(there),
            None => {
                let Some(active) = self.active else { return };
                self.arrange(active, Arrange::NewTab);
                self.apply_arrangement();
                self.show(shown);
            }
        }
    }

    /// Changes the arrangement around the active view.
    pub fn arrange_active(&mut self, arrange: Arrange) {
        if let Some(active) = self.active {
            self.arrange(active, arrange);
            self.apply_arrangement();
        }
    }

    /// Makes the next view the active one.
    pub fn activate_next(&mut self) {
        let mut ids: Vec<_> = panes(&self.tree.tiles).map(|view| view.id).collect();
        ids.sort_unstable();
        let next = ids.iter().copied().find(|id| Some(*id) > self.active).or(ids.first().copied());
        if let Some(next) = next {
            self.bring_to_front(next);
        }
    }

    /// Everything in sight in every 3D view.
    pub fn fit_surfaces(&mut self) {
        for tile in self.tree.tiles.tiles_mut() {
            if let egui_tiles::Tile::Pane(view) = tile {
                view.surface.camera = None;
            }
        }
    }

    /// Makes this view the one that commands act on.
    pub fn activate(&mut self, id: u64) {
        self.active = Some(id);
    }

    /// The tiles, to be drawn: what is shown or arranged meanwhile waits until [`Views::put_back`].
    pub fn take_tree(&mut self) -> Tree<View> {
        std::mem::replace(&mut self.tree, Tree::empty(Id::unique("views")))
    }

    /// The tiles after they were drawn, and what was asked for meanwhile.
    pub fn put_back(&mut self, tree: Tree<View>) {
        self.tree = tree;
        self.apply_arrangement();
        if let Some(shown) = self.wanted.take() {
            self.show(shown);
        }
    }

    fn bring_to_front(&mut self, id: u64) {
        self.active = Some(id);
        self.tree.make_active(|_, tile| matches!(tile, egui_tiles::Tile::Pane(view) if view.id == id));
    }

    /// Changes the arrangement around a view once all views are drawn.
    pub fn arrange(&mut self, id: u64, arrange: Arrange) {
        self.arrangement.push((id, arrange));
    }

    fn apply_arrangement(&mut self) {
        for (id, arrange) in std::mem::take(&mut self.arrangement) {
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
        let parent = self.tree.tiles.parent_of(tile);
        if let Some(egui_tiles::Tile::Container(container)) = parent.and_then(|parent| self.tree.tiles.get_mut(parent))
        {
            container.add_child(new);
        }
        self.bring_to_front(id);
    }

    /// Puts a row or a column in the place of the view's tabs, with those tabs and a new view in it.
    fn split(&mut self, tile: TileId, view: View, direction: LinearDir) {
        let view = self.copy_of(view);
        let tabs = self.tree.tiles.parent_of(tile).unwrap_or(tile);
        let outer = self.tree.tiles.parent_of(tabs);
        let new = self.tree.tiles.insert_pane(view);
        let new_tabs = self.tree.tiles.insert_tab_tile(vec![new]);
        let children = vec![tabs, new_tabs];
        let both = match direction {
            LinearDir::Horizontal => self.tree.tiles.insert_horizontal_tile(children),
            LinearDir::Vertical => self.tree.tiles.insert_vertical_tile(children),
        };
        match outer.and_then(|outer| self.tree.tiles.get_mut(outer)) {
            Some(egui_tiles::Tile::Container(container)) => replace_child(container, tabs, both),
            _ => self.tree = Tree::new(Id::unique("views"), both, std::mem::take(&mut self.tree.tiles)),
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

fn panes(tiles: &Tiles<View>) -> impl Iterator<Item = &View> {
    tiles.tiles().filter_map(|tile| match tile {
        egui_tiles::Tile::Pane(view) => Some(view),
        egui_tiles::Tile::Container(_) => None,
    })
}
