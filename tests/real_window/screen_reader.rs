//! What a screen reader sees and does: the tree of accessible widgets over AT-SPI.

use std::time::{Duration, Instant};

use pollster::block_on;
use zbus::zvariant::{OwnedObjectPath, OwnedValue, Value};
use zbus::{Connection, connection};

use crate::desktop::PATIENCE;

const ACCESSIBLE: &str = "org.a11y.atspi.Accessible";
const ROOT: &str = "/org/a11y/atspi/accessible/root";

/// Numbers of AT-SPI's roles.
pub const IMAGE: u32 = 27;
const LABEL: u32 = 29;

/// A widget.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Widget {
    owner: String,
    path: OwnedObjectPath,
    pub role: u32,
    pub name: String,
}

/// How many of the five steps show results of the set as it is, whatever they say of them.
pub fn steps_with_results(widgets: &[Widget]) -> usize {
    widgets.iter().filter(|widget| widget.name.ends_with("ready") || widget.name == "take care").count()
}

/// A connection to the accessibility bus.
pub struct ScreenReader {
    bus: Connection,
    program: Option<(String, OwnedObjectPath)>,
}

impl ScreenReader {
    /// Turns accessibility on, as a screen reader does when it starts.
    pub fn new(session_bus: &str) -> Self {
        block_on(async {
            let session = connection::Builder::address(session_bus).unwrap().build().await.unwrap();
            let (at, path) = ("org.a11y.Bus", "/org/a11y/bus");
            let on = ("org.a11y.Status", "IsEnabled", Value::from(true));
            session.call_method(Some(at), path, Some("org.freedesktop.DBus.Properties"), "Set", &on).await.unwrap();
            let reply = session.call_method(Some(at), path, Some(at), "GetAddress", &()).await.unwrap();
            let address: String = reply.body().deserialize().unwrap();
            let bus = connection::Builder::address(address.as_str()).unwrap().build().await.unwrap();
            Self { bus, program: None }
        })
    }

    /// Whether a program of this name shows a window.
    pub fn finds_program(&mut self, name: &str) -> bool {
        let registry = OwnedObjectPath::try_from(ROOT).unwrap();
        let programs = self.children("org.a11y.atspi.Registry", &registry).unwrap_or_default();
        self.program =
            programs.into_iter().find(|(owner, path)| self.text(owner, path, "Name").as_deref() == Some(name));
        self.program.as_ref().is_some_and(|(owner, path)| !self.children(owner, path).unwrap_or_default().is_empty())
    }

    /// Every widget of the window, top to bottom.
    pub fn widgets(&self) -> Vec<Widget> {
        let Some(program) = self.program.clone() else { return Vec::new() };
        let (mut found, mut ahead) = (Vec::new(), vec![program]);
        while let Some((owner, path)) = ahead.pop() {
            // A widget may go away while it is looked at.
            let Some(children) = self.children(&owner, &path) else { continue };
            ahead.extend(children.into_iter().rev());
            let role = self.call::<_, u32>(&owner, &path, ACCESSIBLE, "GetRole", &()).unwrap_or_default();
            let name = self.text(&owner, &path, "Name").unwrap_or_default();
            found.push(Widget { owner, path, role, name });
        }
        found
    }

    /// Waits for what `look` finds among the widgets.
    pub fn wait_for<T>(&self, what: &str, mut look: impl FnMut(&[Widget]) -> Option<T>) -> T {
        let since = Instant::now();
        loop {
            let widgets = self.widgets();
            if let Some(found) = look(&widgets) {
                return found;
            }
            let names: Vec<_> = widgets.iter().map(|widget| format!("{}: {}", widget.role, widget.name)).collect();
            assert!(since.elapsed() < PATIENCE, "waited in vain for {what} among\n{}", names.join("\n"));
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Waits for a widget of this name; one that can be used comes before the label that names it.
    pub fn find(&self, name: &str) -> Widget {
        self.wait_for(name, |widgets| {
            let named = || widgets.iter().filter(|widget| widget.name == name);
            named().find(|widget| widget.role != LABEL).or_else(|| named().next()).cloned()
        })
    }

    /// Waits for a widget whose name holds these words.
    pub fn read(&self, words: &str) -> Widget {
        self.wait_for(words, |widgets| widgets.iter().find(|widget| widget.name.contains(words)).cloned())
    }

    /// Waits for a widget of this name and does with it what a click does. A menu's entry tells its keys after its name.
    pub fn press(&self, name: &str) {
        let Widget { owner, path, .. } = self.wait_for(name, |widgets| {
            let usable = || widgets.iter().filter(|widget| widget.role != LABEL);
            let entry = || usable().find(|widget| widget.name.starts_with(&format!("{name} ")));
            usable().find(|widget| widget.name == name).or_else(entry).cloned()
        });
        let done = self.call::<_, bool>(&owner, &path, "org.a11y.atspi.Action", "DoAction", &0i32);
        assert_eq!(done, Some(true), "\"{name}\" cannot be pressed");
    }

    /// Sets a field to a number.
    pub fn set(&self, name: &str, value: f64) {
        let Widget { owner, path, .. } = self.find(name);
        let new = ("org.a11y.atspi.Value", "CurrentValue", Value::from(value));
        let set = self.bus.call_method(
            Some(owner.as_str()),
            path.as_str(),
            Some("org.freedesktop.DBus.Properties"),
            "Set",
            &new,
        );
        block_on(set).unwrap();
    }

    /// The number in a field.
    pub fn value(&self, name: &str) -> f64 {
        let Widget { owner, path, .. } = self.find(name);
        let value = self.property(&owner, &path, "org.a11y.atspi.Value", "CurrentValue").unwrap();
        value.try_into().unwrap()
    }

    /// Left, top, width and height of a widget on the screen, in pixels.
    pub fn place(&self, widget: &Widget) -> [i32; 4] {
        let Widget { owner, path, .. } = widget;
        let place: (i32, i32, i32, i32) =
            self.call(owner, path, "org.a11y.atspi.Component", "GetExtents", &0u32).unwrap();
        place.into()
    }

    fn children(&self, owner: &str, path: &OwnedObjectPath) -> Option<Vec<(String, OwnedObjectPath)>> {
        self.call(owner, path, ACCESSIBLE, "GetChildren", &())
    }

    fn text(&self, owner: &str, path: &OwnedObjectPath, property: &str) -> Option<String> {
        self.property(owner, path, ACCESSIBLE, property)?.try_into().ok()
    }

    fn property(&self, owner: &str, path: &OwnedObjectPath, interface: &str, property: &str) -> Option<OwnedValue> {
        self.call(owner, path, "org.freedesktop.DBus.Properties", "Get", &(interface, property))
    }

    fn call<B, R>(&self, owner: &str, path: &OwnedObjectPath, interface: &str, method: &str, body: &B) -> Option<R>
    where
        B: serde::Serialize + zbus::zvariant::DynamicType,
        R: for<'d> zbus::zvariant::DynamicDeserialize<'d>,
    {
        let reply = block_on(self.bus.call_method(Some(owner), path.as_str(), Some(interface), method, body)).ok()?;
        reply.body().deserialize().ok()
    }
}
