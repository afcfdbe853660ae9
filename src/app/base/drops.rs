//! Whether files can be dropped on the window.

/// Under Wayland the window library (winit 0.30) hears nothing of drops.
pub fn reach_window() -> bool {
    let named = |variable: &str| std::env::var_os(variable).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || !["WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(named)
}

/// What to add to a field that takes files, and to what can be dropped: "it", "them".
pub fn words(what: &str) -> String {
    if reach_window() {
        format!("you can also drop {what} on this window")
    } else {
        "drops do not reach a window under Wayland: type the path, or browse".into()
    }
}
