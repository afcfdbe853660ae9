//! The layout: which views there are, how they are arranged, and what each shows.

mod arrangement;
mod look;
mod rebuild;
mod shown;
mod tree;

use std::mem;

use eframe::egui::Id;
use egui_tiles::{LinearDir, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

pub use look::{Look, Scale};
pub use shown::{Pane, Shown};

use crate::app::state::document::Document;
use crate::app::state::panel::PanelName;
use crate::app::state::surfaces::SurfaceLook;
use arrangement::Arrangement;

/// The key under which the arrangements are kept.
const STEPS: &str = "steps";

/// One view: what it shows and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Identifies the view for as long as the layout is kept.
    pub id: u64,
    /// What is shown.
    pub shown: Shown,
    /// What it is compared with.
    pub against: Option<Shown>,
    /// How.
    #[serde(default)]
    pub compare: Compare,
    /// How numbers become colours.
    pub look: Look,
    /// Whether zoom and pan follow the other linked views.
    pub linked: bool,
    /// How a surface in 3D is shown.
    #[serde(default)]
    pub surface: SurfaceLook,
}

/// How a view shows what it is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Compare {
    /// While B is held.
    #[default]
    Hold,
    /// A line divides the two.
    Wipe,
    /// The one minus the other.
    Difference,
}

impl Compare {
    /// All, in the order of the strip, with what they are called.
    pub const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Hold, "Hold B", "Shows the other picture while B is held"),
        (Self::Wipe, "Wipe", "A line divides the two"),
        (Self::Difference, "Difference", "This picture minus the other"),
    ];
}

impl View {
    fn showing(id: u64, shown: Shown) -> Self {
        Self {
            id,
            shown,
            against: None,
            compare: Compare::default(),
            look: Look::default(),
            linked: true,
            surface: SurfaceLook::default(),
        }
    }

    /// What is drawn: the picture, or its difference to the one that it is compared with.
    pub fn drawn(&self) -> Shown {
        match (&self.against, self.compare) {
            (Some(other), Compare::Difference) => Shown::difference(self.shown.clone(), other.clone()),
            _ => self.shown.clone(),
        }
    }
}

/// The pixel under the pointer or the keyboard's cursor, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Hover {
    /// What is shown there.
    pub shown: Shown,
    /// Column and row.
    pub pixel: (usize, usize),
}

/// All views and how they are arranged, each step's for itself.
pub struct Views {
    tree: Tree<View>,
    /// Whose tiles these are.
    step: PanelName,
    /// What they were made of, until they are changed by hand.
    begun_as: Option<Arrangement>,
    /// The tiles of the steps that were left.
    left: Vec<Left>,
    /// The view that has all of the centre for itself.
    maximised: Option<u64>,
    several: bool,
    /// The pixel that is looked at, in this frame or the last.
    pub hover: Option<Hover>,
    /// The view that commands act on: the one that was clicked last.
    active: Option<u64>,
    next_id: u64,
    arrangement: Vec<(u64, Arrange)>,
    /// What the active view is to show once the views are drawn.
    wanted: Option<Shown>,
}

/// The tiles of a step that was left.
struct Left {
    step: PanelName,
    tree: Tree<View>,
    begun_as: Option<Arrangement>,
    active: Option<u64>,
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
        let begun_as = Some(Arrangement::One(shown.clone()));
        let views = Self::of(Tree::new_tabs(Id::unique("views"), vec![View::showing(0, shown)]));
        Self { begun_as, ..views }
    }

    fn of(tree: Tree<View>) -> Self {
        let next_id = panes(&tree.tiles).map(|view| view.id + 1).max().unwrap_or(0);
        let active = panes(&tree.tiles).map(|view| view.id).min();
        Self {
            tree,
            step: PanelName::Captures,
            begun_as: None,
            left: Vec::new(),
            maximised: None,
            several: false,
            hover: None,
            active,
            next_id,
            arrangement: Vec::new(),
            wanted: None,
        }
    }

    /// The arrangements that were changed, as they are kept beside the set.
    pub fn to_json(&self) -> Value {
        let own = [(self.step, &self.tree, &self.begun_as)].into_iter();
        let all = own.chain(self.left.iter().map(|left| (left.step, &left.tree, &left.begun_as)));
        let changed = all.filter(|(_, _, begun_as)| begun_as.is_none());
        let steps =
            changed.map(|(step, tree, _)| (step.title().to_owned(), serde_json::to_value(tree).unwrap_or_default()));
        Value::Object(Map::from_iter([(STEPS.to_owned(), Value::Object(steps.collect()))]))
    }

    /// The arrangements that were kept; `None` where there is none. That of a version that had one for all steps is the first
    /// step's.
    pub fn from_json(kept: Value) -> Option<Self> {
        let of_step = |step: PanelName| match kept.get(STEPS) {
            Some(steps) => steps.get(step.title()),
            None => Some(&kept).filter(|_| step == PanelName::Captures),
        };
        let mut views = Self::default();
        for step in PanelName::ALL {
            let Some(tree) = of_step(step).and_then(|kept| serde_json::from_value::<Tree<View>>(kept.clone()).ok())
            else {
                continue;
            };
            let Some(tree) = rebuild::rebuilt(&tree, &mut views.next_id) else { continue };
            let active = panes(&tree.tiles).map(|view| view.id).min();
            if step == views.step {
                (views.tree, views.begun_as, views.active) = (tree, None, active);
            } else {
                views.left.push(Left { step, tree, begun_as: None, active });
            }
        }
        (views.begun_as.is_none() || !views.left.is_empty()).then_some(views)
    }

    /// Shows the tiles of a step: as they were left, or else as the set has them.
    pub fn turn_to(&mut self, step: PanelName, document: &Document) {
        if step != self.step {
            self.maximised = None;
            let known = self.left.iter().position(|left| left.step == step).map(|index| self.left.swap_remove(index));
            let known = known.unwrap_or_else(|| Left {
                step,
                tree: Tree::empty(Id::unique("views")),
                begun_as: Some(Arrangement::Row(Vec::new())),
                active: None,
            });
            self.left.push(Left {
                step: mem::replace(&mut self.step, known.step),
                tree: mem::replace(&mut self.tree, known.tree),
                begun_as: mem::replace(&mut self.begun_as, known.begun_as),
                active: mem::replace(&mut self.active, known.active),
            });
        }
        let Some(begun_as) = &self.begun_as else { return };
        let arrangement = Arrangement::of(step, document);
        if *begun_as != arrangement {
            self.begin_as(arrangement);
        }
    }

    /// Brings back what the step begins with.
    pub fn reset(&mut self, document: &Document) {
        self.begin_as(Arrangement::of(self.step, document));
    }

    fn begin_as(&mut self, arrangement: Arrangement) {
        self.maximised = None;
        self.tree = tree::built(&arrangement, &mut self.next_id);
        let mut ids: Vec<_> = panes(&self.tree.tiles).map(|view| view.id).collect();
        ids.sort_unstable();
        self.active = ids.get(Arrangement::main(self.step)).or(ids.first()).copied();
        self.begun_as = Some(arrangement);
    }

    /// Notes that the tiles were changed by hand: they stay as they are now.
    pub fn note_change(&mut self) {
        self.begun_as = None;
    }

    /// This many views in place of what there is: one, two side by side, or four.
    pub fn preset(&mut self, count: usize) {
        let mut views: Vec<View> = panes(&self.tree.tiles).cloned().collect();
        views.sort_by_key(|view| (Some(view.id) != self.active, view.id));
        let Some(first) = views.first().cloned() else { return };
        while views.len() < count {
            views.push(View { id: self.next_id, ..first.clone() });
            self.next_id += 1;
        }
        views.truncate(count);
        self.tree = tree::grid(views);
        self.maximised = None;
        self.note_change();
    }

    /// The view that has the centre for itself.
    pub fn maximised(&self) -> Option<u64> {
        self.maximised
    }

    /// Gives a view all of the centre, or gives it back.
    pub fn maximise(&mut self, id: u64) {
        self.maximised = if self.maximised == Some(id) { None } else { Some(id) };
        self.active = Some(id);
    }

    /// The view that commands act on.
    pub fn active(&self) -> Option<&View> {
        panes(&self.tree.tiles).find(|view| Some(view.id) == self.active)
    }

    /// The same, to be changed.
    pub fn active_mut(&mut self) -> Option<&mut View> {
        self.note_change();
        let active = self.active;
        self.tree.tiles.tiles_mut().find_map(|tile| match tile {
            egui_tiles::Tile::Pane(view) if Some(view.id) == active => Some(view),
            _ => None,
        })
    }

    /// Which view commands act on.
    pub fn active_id(&self) -> Option<u64> {
        self.active
    }

    /// Whether there is more than one view; while they are drawn, whether there was.
    pub fn has_several(&self) -> bool {
        self.several
    }

    /// Every view.
    pub fn all(&self) -> impl Iterator<Item = &View> {
        panes(&self.tree.tiles)
    }

    /// Makes the active view show this, or activates the one that does already.
    pub fn show(&mut self, shown: impl Into<Shown>) {
        let shown = shown.into();
        let there = panes(&self.tree.tiles).find(|view| view.shown == shown).map(|view| view.id);
        if self.tree.root().is_none() {
            self.wanted = Some(shown);
        } else if let Some(there) = there {
            if self.active().is_none_or(|view| view.shown != shown) {
                self.bring_to_front(there);
            }
        } else if let Some(view) = self.active_mut() {
            view.shown = shown;
            view.look = Look::default();
        }
    }

    /// Changes every linked view of a picture at once.
    pub fn change_linked(&mut self, mut change: impl FnMut(&mut View)) {
        self.note_change();
        for tile in self.tree.tiles.tiles_mut() {
            if let egui_tiles::Tile::Pane(view) = tile
                && view.linked
            {
                change(view);
            }
        }
    }

    /// Shows this in a tab of its own, or brings the view that shows it to the front.
    pub fn open(&mut self, shown: Shown) {
        let shows = |id: &u64| panes(&self.tree.tiles).any(|view| view.id == *id && view.shown == shown);
        // Of several the last: beside the surface before that is the one after.
        let there = panes(&self.tree.tiles).filter(|view| view.shown == shown).map(|view| view.id).max();
        match self.active.filter(shows).or(there) {
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
        self.several = panes(&self.tree.tiles).count() > 1;
        mem::replace(&mut self.tree, Tree::empty(Id::unique("views")))
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

fn panes(tiles: &Tiles<View>) -> impl Iterator<Item = &View> {
    tiles.tiles().filter_map(|tile| match tile {
        egui_tiles::Tile::Pane(view) => Some(view),
        egui_tiles::Tile::Container(_) => None,
    })
}
