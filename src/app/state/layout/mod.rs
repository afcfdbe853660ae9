//! The layout: which views there are, how they are arranged, and what each shows.

mod arrange;
mod arrangement;
mod look;
mod rebuild;
mod shown;
mod tree;
mod view;

use std::mem;

use eframe::egui::Id;
use egui_tiles::{Tiles, Tree};
use serde_json::{Map, Value};

pub use arrange::Arrange;
pub use look::{Look, Scale};
pub use shown::{Pane, Shown};
pub use view::{Compare, Hover, View};

use crate::app::state::document::Document;
use crate::app::state::panel::PanelName;
use arrangement::Arrangement;

/// The key under which the arrangements are kept.
const STEPS: &str = "steps";

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
        panes_mut(&mut self.tree.tiles).find(|view| Some(view.id) == active)
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
    pub fn change_linked(&mut self, change: impl FnMut(&mut View)) {
        self.note_change();
        panes_mut(&mut self.tree.tiles).filter(|view| view.linked).for_each(change);
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
        panes_mut(&mut self.tree.tiles).for_each(|view| view.surface.camera = None);
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
}

fn panes(tiles: &Tiles<View>) -> impl Iterator<Item = &View> {
    tiles.tiles().filter_map(|tile| match tile {
        egui_tiles::Tile::Pane(view) => Some(view),
        egui_tiles::Tile::Container(_) => None,
    })
}

/// The views, to be changed.
pub fn panes_mut(tiles: &mut Tiles<View>) -> impl Iterator<Item = &mut View> {
    tiles.tiles_mut().filter_map(|tile| match tile {
        egui_tiles::Tile::Pane(view) => Some(view),
        egui_tiles::Tile::Container(_) => None,
    })
}
