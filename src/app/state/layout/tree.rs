//! From an arrangement to tiles.

use eframe::egui::Id;
use egui_tiles::{Container, Tile, TileId, Tiles, Tree};

use super::arrangement::Arrangement;
use super::{Pane, Shown, View};

/// New views, numbered from `next_id` on in the order of the arrangement.
pub fn built(arrangement: &Arrangement, next_id: &mut u64) -> Tree<View> {
    let mut tiles = Tiles::default();
    let root = tile(arrangement, &mut tiles, next_id);
    Tree::new(Id::unique("views"), root, tiles)
}

fn tile(arrangement: &Arrangement, tiles: &mut Tiles<View>, next_id: &mut u64) -> TileId {
    let mut view = |shown: Shown| {
        let id = *next_id;
        *next_id += 1;
        View::showing(id, shown)
    };
    match arrangement {
        Arrangement::One(shown) => tiles.insert_pane(view(shown.clone())),
        Arrangement::Surface(layer) => {
            let mut view = view(Shown::Surface);
            view.surface.show_only(*layer);
            tiles.insert_pane(view)
        }
        Arrangement::Row(parts) => {
            let ids: Vec<TileId> = parts.iter().map(|part| tile(part, tiles, next_id)).collect();
            let row = tiles.insert_horizontal_tile(ids.clone());
            if let Some(Tile::Container(Container::Linear(row))) = tiles.get_mut(row) {
                for (part, id) in parts.iter().zip(ids) {
                    row.shares.set_share(id, share(part));
                }
            }
            row
        }
        Arrangement::Column(parts) => {
            let parts = parts.iter().map(|part| tile(part, tiles, next_id)).collect();
            tiles.insert_vertical_tile(parts)
        }
    }
}

/// Of a row's width: a drawing needs less than a table beside it.
fn share(part: &Arrangement) -> f32 {
    if *part == Arrangement::One(Shown::Pane(Pane::Dome)) { 0.5 } else { 1.0 }
}

/// These views, at most two beside each other.
pub fn grid(views: Vec<View>) -> Tree<View> {
    let mut tiles = Tiles::default();
    let mut ids: Vec<TileId> = views.into_iter().map(|view| tiles.insert_pane(view)).collect();
    let mut rows = Vec::new();
    while !ids.is_empty() {
        let rest = ids.split_off(ids.len().min(2));
        rows.push(tiles.insert_horizontal_tile(std::mem::replace(&mut ids, rest)));
    }
    let root = tiles.insert_vertical_tile(rows);
    Tree::new(Id::unique("views"), root, tiles)
}
