//! The canvas: its shader against the CPU twin, and the widget by its accessible name.

mod card;
mod mesh;
mod shader;
mod widget;
