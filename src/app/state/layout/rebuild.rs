//! An arrangement of views that was read from a file: the file may say anything.

use std::collections::HashSet;

use eframe::egui::Id;
use egui_tiles::{Container, Linear, Tabs, Tile, TileId, Tiles, Tree};

use super::View;

/// Rows within columns within tabs, deeper than anybody can see.
const MAX_DEPTH: usize = 12;
/// More than fit on any screen.
const MAX_VIEWS: u64 = 64;
/// The widest view beside the narrowest.
const SHARES: (f32, f32) = (0.02, 50.0);

/// The same arrangement, built anew: no part of it contains itself, every view has an identity of its own and a look
/// within its ranges, and every share of a row or column is a positive number. Views are numbered from `next_id` on. `None` if
/// it holds no view.
pub fn rebuilt(kept: &Tree<View>, next_id: &mut u64) -> Option<Tree<View>> {
    let (seen, tiles) = (HashSet::new(), Tiles::default());
    let mut building = Building { kept: &kept.tiles, seen, tiles, views: 0, next_id };
    let root = building.tile(kept.root()?, MAX_DEPTH)?;
    Some(Tree::new(Id::unique("views"), root, building.tiles))
}

struct Building<'k> {
    kept: &'k Tiles<View>,
    seen: HashSet<TileId>,
    tiles: Tiles<View>,
    views: u64,
    next_id: &'k mut u64,
}

impl Building<'_> {
    fn tile(&mut self, id: TileId, depth: usize) -> Option<TileId> {
        if depth == 0 || !self.seen.insert(id) {
            return None;
        }
        match self.kept.get(id)? {
            Tile::Pane(view) => self.view(view),
            Tile::Container(container) => self.container(container, depth - 1),
        }
    }

    fn view(&mut self, view: &View) -> Option<TileId> {
        if self.views == MAX_VIEWS {
            return None;
        }
        let (look, surface) = (view.look.within_ranges(), view.surface.within_ranges());
        let id = *self.next_id;
        (self.views, *self.next_id) = (self.views + 1, id + 1);
        Some(self.tiles.insert_pane(View { id, look, surface, ..view.clone() }))
    }

    fn container(&mut self, container: &Container, depth: usize) -> Option<TileId> {
        let old: Vec<TileId> = container.children().copied().collect();
        let children: Vec<_> = old.into_iter().filter_map(|old| Some((old, self.tile(old, depth)?))).collect();
        if children.is_empty() {
            return None;
        }
        let new = children.iter().map(|(_, new)| *new).collect();
        let container: Container = match container {
            Container::Tabs(tabs) => {
                let mut rebuilt = Tabs::new(new);
                let active = children.iter().find(|(old, _)| Some(*old) == tabs.active).or(children.first());
                rebuilt.active = active.map(|(_, new)| *new);
                rebuilt.into()
            }
            Container::Linear(linear) => {
                let mut rebuilt = Linear::new(linear.dir, new);
                for (old, new) in &children {
                    let share = linear.shares[*old];
                    let (low, high) = SHARES;
                    rebuilt.shares.set_share(*new, if share.is_finite() { share.clamp(low, high) } else { 1.0 });
                }
                rebuilt.into()
            }
            // Grids are not made here.
            Container::Grid(_) => Tabs::new(new).into(),
        };
        Some(self.tiles.insert_container(container))
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use crate::app::state::layout::{Arrange, Shown, Views};

    fn kept() -> Value {
        let mut views = Views::showing(Shown::default());
        views.arrange_active(Arrange::SplitRight);
        views.arrange_active(Arrange::NewTab);
        views.to_json()
    }

    /// Every number of the text, replaced by `number`.
    fn with_numbers(value: &mut Value, number: &Value) {
        match value {
            Value::Number(_) => *value = number.clone(),
            Value::Array(items) => items.iter_mut().for_each(|item| with_numbers(item, number)),
            Value::Object(items) => items.values_mut().for_each(|item| with_numbers(item, number)),
            _ => {}
        }
    }

    #[test]
    fn an_arrangement_comes_back_as_it_was_kept() {
        let views = Views::from_json(kept()).unwrap();
        assert_eq!(views.all().count(), 3);
        let again = Views::from_json(views.to_json()).unwrap();
        let ids = |views: &Views| views.all().map(|view| view.id).collect::<std::collections::BTreeSet<_>>();
        assert_eq!(ids(&views), ids(&again));
    }

    #[test]
    fn no_number_of_a_kept_arrangement_makes_it_contain_itself() {
        for number in [json!(0), json!(1), json!(7), json!(u64::MAX), json!(1e300), json!(-1e-300)] {
            let mut text = kept();
            with_numbers(&mut text, &number);
            let Some(mut views) = Views::from_json(text) else { continue };
            assert!(views.all().all(|view| view.id < 64));
            views.arrange_active(Arrange::NewTab);
        }
    }
}
