//! Commands that go from one picture to the next, and change how pictures are drawn and compared.

use super::Target;
use crate::app::state::document::Document;
use crate::app::state::layout::{Compare, Look, Scale, Shown, View, Views};
use crate::app::state::results::{Of, Plain, SurfaceName};

/// What a press of the key changes the exposure by.
const STOPS: f32 = 0.5;

/// The picture before or after this one in its group of the menu.
pub fn in_group(target: Target<'_>, forward: bool) {
    let session = target.session;
    let Some(view) = session.views.active() else { return };
    let groups = Shown::offered(&session.document());
    let group = groups.iter().map(|(_, pictures)| pictures).find(|pictures| pictures.contains(&view.shown));
    let Some(next) = group.and_then(|pictures| around(pictures, Some(&view.shown), forward)) else { return };
    let next = next.clone();
    session.views.show(next);
}

/// Every linked view shows the same of the next light.
pub fn next_light(target: Target<'_>) {
    let session = target.session;
    let document = session.document();
    let lights: Vec<String> = document.set.lights.iter().map(|light| light.name.clone()).collect();
    let current = session.views.active().and_then(|view| view.shown.light()).map(str::to_owned);
    let first = || session.views.all().find_map(|view| view.shown.light()).map(str::to_owned);
    let Some(next) = around(&lights, current.or_else(first).as_ref(), true) else { return };
    change_all(&mut session.views, |shown| shown.with_light(next));
}

/// The same of the next colour.
pub fn next_colour(target: Target<'_>) {
    let session = target.session;
    let document = session.document();
    let colours: Vec<String> = document.set.colours.iter().map(|colour| colour.name.clone()).collect();
    let current = session.views.active().and_then(|view| view.shown.colour()).map(str::to_owned);
    let Some(next) = around(&colours, current.as_ref(), true) else { return };
    change_all(&mut session.views, |shown| shown.with_colour(next));
}

/// The next bounce of the light that the view shows; the first after the last.
pub fn next_bounce(target: Target<'_>) {
    let session = target.session;
    let document = session.document();
    let Some(view) = session.views.active() else { return };
    let light = view.shown.light().or(document.set.lights.first().map(|light| light.name.as_str()));
    let Some(light) = light.map(str::to_owned) else { return };
    let k = match view.shown {
        Shown::Bounce { k, .. } => k % document.set.bounces() + 1,
        _ => 1,
    };
    session.views.show(Shown::Bounce { light, k });
}

/// Linked pictures are compared: they are made brighter together.
pub fn expose(target: Target<'_>, sign: f32) {
    let within = |stops: f32| stops.clamp(*Look::EXPOSURE_STOPS.start(), *Look::EXPOSURE_STOPS.end());
    target.session.views.change_linked(|view| {
        view.look.exposure_stops = within(view.look.exposure_stops + sign * STOPS);
    });
}

/// The picture's own range, or the one that it shares.
pub fn normalise(target: Target<'_>) {
    if let Some(view) = target.session.views.active_mut() {
        view.look.range = None;
        view.look.scale = match view.look.scale {
            Scale::Locked => Scale::Own,
            Scale::Own => Scale::Locked,
        };
    }
}

/// Compares by a line or by numbers, or no longer; what with is proposed where it was not chosen.
pub fn compare(target: Target<'_>, by: Compare) {
    let session = target.session;
    let document = session.document();
    let Some(view) = session.views.active_mut() else { return };
    if view.against.is_some() && view.compare == by {
        view.compare = Compare::Hold;
        return;
    }
    if view.against.is_none() {
        view.against = partner(&view.shown, &document);
    }
    view.compare = by;
}

/// What a picture is best compared with.
fn partner(shown: &Shown, document: &Document) -> Option<Shown> {
    let other = |name| if name == SurfaceName::After { SurfaceName::Before } else { SurfaceName::After };
    match shown {
        Shown::Normals(name) => Some(Shown::Normals(other(*name))),
        Shown::Plain(picture) if picture.surface().is_some() => {
            Some(picture.plain.of(other(picture.surface()?)).into())
        }
        Shown::Photo(_) => Some(Plain::Direct.of(Of::light(shown.light()?)).into()),
        _ => Some(Shown::object(shown.light()?, &document.set.colours.first()?.name)),
    }
}

fn change_all(views: &mut Views, other: impl Fn(&Shown) -> Shown) {
    views.change_linked(|view: &mut View| {
        view.shown = other(&view.shown);
        view.against = view.against.as_ref().map(&other);
    });
}

/// The next of a list, the first after the last and where none is known.
fn around<'l, T: PartialEq>(list: &'l [T], current: Option<&T>, forward: bool) -> Option<&'l T> {
    let place = current.and_then(|current| list.iter().position(|item| item == current));
    let step = if forward { 1 } else { list.len().saturating_sub(1) };
    list.get(place.map_or(0, |place| (place + step) % list.len().max(1)))
}
