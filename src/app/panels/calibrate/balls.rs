//! The balls' circles: found by their edges, placed by the user, typed.

use std::sync::Arc;

use eframe::egui::{ComboBox, RichText, Ui};
use firstbounce_capture::set::{Circle, Number, Sphere, SphereKind, Subject, Word};
use firstbounce_core::sphere::{
    self, BallError, CircleOptions, CircleReport, circle_through, find_circle, refine_circle,
};

use super::{balls_of, title_of};
use crate::app::base::keyed::Keyed;
use crate::app::state::layout::Shown;
use crate::app::state::results::{Loaded, ShotName};
use crate::app::state::session::Session;
use crate::app::widgets::advice::advice;
use crate::app::widgets::number_field::fixed;
use crate::app::widgets::part::part;
use crate::app::widgets::theme::Weight;

/// A click may miss the ball by as many radii.
const NEAR_RADII: f64 = 2.0;

/// What a diameter begins with, in mm.
const FIRST_DIAMETER_MM: f64 = 40.0;

/// Where a ball is looked for.
#[derive(Clone, Copy, Debug)]
pub enum Look {
    /// In the whole picture.
    Anywhere,
    /// Near a click.
    Near([f64; 2]),
    /// By the edge under a rough circle.
    Under(Circle),
}

/// Circles on their way, and how clicks are taken.
pub struct Balls {
    finding: Keyed<(Subject, SphereKind), CircleReport>,
    /// Which ball a click in the object's scene means.
    pub in_scene: Option<SphereKind>,
    /// Whether a click on a ball's picture looks for its edge.
    pub click_finds: bool,
    /// The ball whose rim is being clicked, and the points so far.
    pub rim: Option<Rim>,
}

/// Points of a ball's rim, as they are clicked.
pub struct Rim {
    /// In which shots.
    pub subject: Subject,
    /// Of which ball.
    pub kind: SphereKind,
    /// In pixels of the photo.
    pub points: Vec<[f64; 2]>,
}

impl Default for Balls {
    fn default() -> Self {
        Self { finding: Keyed::default(), in_scene: None, click_finds: true, rim: None }
    }
}

impl Balls {
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        self.take_found(session);
        let document = session.document();
        let balls = balls_of(&document.set);
        ui.label(RichText::new("Balls").semi_bold());
        if balls.is_empty() {
            advice(
                ui,
                "No ball is in this set: add photos of a grey ball, a ball of the object's paint and a mirror ball in \
                 Captures, or type the values below. If the balls are in the object's photos, choose which one below \
                 and click it there.",
            );
        }
        for (subject, kind) in balls {
            part(ui, (subject, kind), |ui| self.ball(ui, session, subject, kind));
        }
        part(ui, "clicks", |ui| self.clicks(ui));
        ui.separator();
    }

    /// What a click on a photo does.
    fn clicks(&mut self, ui: &mut Ui) {
        ui.checkbox(&mut self.click_finds, "A click on a ball's photo finds its edge");
        let words = |kind: Option<SphereKind>| kind.map_or("no ball", SphereKind::title);
        ComboBox::from_label("A click in the object's photo means").selected_text(words(self.in_scene)).show_ui(
            ui,
            |ui| {
                ui.selectable_value(&mut self.in_scene, None, "no ball");
                for &kind in SphereKind::ALL {
                    ui.selectable_value(&mut self.in_scene, Some(kind), kind.title());
                }
            },
        );
    }

    fn ball(&mut self, ui: &mut Ui, session: &mut Session, subject: Subject, kind: SphereKind) {
        let title = title_of(subject, kind);
        let document = session.document();
        let circle = circle_in_force(session, subject, kind);
        ui.horizontal_wrapped(|ui| {
            let shot = document.set.shots_of(subject).next().map(ShotName::of);
            if ui.button(format!("Show {}", title.to_lowercase())).clicked()
                && let Some(shot) = shot
            {
                session.views.show(Shown::Photo(shot));
            }
            ui.label(RichText::new(self.state_of(session, subject, kind)).weak());
        });
        let old = circle.unwrap_or_else(|| circle_to_start_with(session, subject));
        let mut new = old;
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for (what, short, value) in [("x", "x", 0), ("y", "y", 1), ("radius", "r", 2)] {
                let number = match value {
                    2 => &mut new.radius,
                    axis => &mut new.centre[axis],
                };
                let name = ui.label(short).on_hover_text("In pixels of the photo");
                let range = if value == 2 { Number::Radius } else { Number::Centre }.range();
                let field = fixed(number, 2, range).speed(0.05);
                let response = ui.add(field).labelled_by(name.id);
                response.widget_info(|| {
                    eframe::egui::WidgetInfo::labeled(eframe::egui::Role::SpinButton, true, format!("{title}, {what}"))
                });
            }
        });
        if let Some(circle) = circle {
            diameter(ui, session, (subject, kind), circle);
        }
        ui.horizontal_wrapped(|ui| self.buttons(ui, session, (subject, kind), circle));
        if new != old {
            move_ball(session, subject, kind, new);
        }
        ui.add_space(4.0);
    }

    /// The ways to a circle, and the way back.
    fn buttons(
        &mut self,
        ui: &mut Ui,
        session: &mut Session,
        (subject, kind): (Subject, SphereKind),
        circle: Option<Circle>,
    ) {
        let ball = title_of(subject, kind).to_lowercase();
        let button = |ui: &mut Ui, text: &str, name: String, hover: &str| {
            ui.button(text).accessible_name(name).on_hover_text(hover).clicked()
        };
        if button(ui, "Find", format!("Find {ball}"), "Looks for the ball's edge in the whole photo") {
            self.find(session, subject, kind, Look::Anywhere);
        }
        let snap = "Fits the circle to the edge nearby";
        if let Some(circle) = circle
            && button(ui, "Snap", format!("Snap {ball} to its edge"), snap)
        {
            self.find(session, subject, kind, Look::Under(circle));
        }
        let rim = "The next three clicks in its photo are points of its rim";
        if button(ui, "Three points", format!("Three rim points of {ball}"), rim) {
            self.rim = Some(Rim { subject, kind, points: Vec::new() });
            if let Some(shot) = session.document().set.shots_of(subject).next().map(ShotName::of) {
                session.views.show(Shown::Photo(shot));
            }
        }
        let grey = session.document().set.subject_with(SphereKind::Grey);
        let of_grey = grey.and_then(|grey| circle_in_force(session, grey, SphereKind::Grey));
        let same = "For a ball that stood where the grey ball stood";
        if kind != SphereKind::Grey
            && let Some(circle) = of_grey
            && button(ui, "As the grey ball", format!("Same circle as the grey ball, {ball}"), same)
        {
            move_ball(session, subject, kind, circle);
        }
        let forget = "Lets the program find the ball by itself";
        let placed = session.document().set.circle(subject, kind).is_some();
        if placed && button(ui, "Forget", format!("Forget {ball}"), forget) {
            session.edit(&format!("Forget the circle of the {ball}"), |document| {
                document.set.spheres.retain(|sphere| (sphere.subject, sphere.kind) != (subject, kind));
            });
        }
    }

    /// Takes a click as a point of a ball's rim; the third one makes its circle.
    pub fn click_on_rim(&mut self, session: &mut Session, at: [f64; 2]) {
        let Some(rim) = &mut self.rim else { return };
        rim.points.push(at);
        let &[a, b, c] = rim.points.as_slice() else { return };
        let (subject, kind) = (rim.subject, rim.kind);
        self.rim = None;
        match circle_through([a, b, c].map(|[x, y]| (x, y))) {
            Ok(sphere::Circle { centre_px: (x, y), radius_px: radius }) => {
                move_ball(session, subject, kind, Circle { centre: [x, y], radius });
            }
            Err(error) => session.error(format!("{}: {error}", kind.title())),
        }
    }

    fn state_of(&self, session: &Session, subject: Subject, kind: SphereKind) -> String {
        if self.finding.runs(&(subject, kind)) {
            return "looking for its edge ...".into();
        }
        if let Some(rim) = self.rim.as_ref().filter(|rim| (rim.subject, rim.kind) == (subject, kind)) {
            return format!("click on its rim: {} of 3 points", rim.points.len());
        }
        if session.document().set.circle(subject, kind).is_some() {
            return "placed".into();
        }
        let found = found_circle(session, subject, kind).and_then(|(_, report)| report);
        match found {
            Some(report) => format!("found by its edge, to {:.2} px", report.sd_px),
            None => "not found yet: click on it in its photo, on three points of its rim, or type its circle".into(),
        }
    }

    /// Starts to look for a ball, on a worker.
    pub fn find(&mut self, session: &mut Session, subject: Subject, kind: SphereKind, look: Look) {
        let Some(loaded) = session.results.loaded() else {
            session.warn("The photos are still being read: try again in a moment");
            return;
        };
        let name = format!("Find {}", kind.title().to_lowercase());
        let task = session.jobs.start(name, move |_| find(&loaded, subject, look));
        self.finding.start((subject, kind), task);
    }

    pub fn take_found(&mut self, session: &mut Session) {
        let Some(((subject, kind), outcome)) = self.finding.take() else { return };
        let title = kind.title();
        match outcome {
            Ok(report) => {
                let (x, y) = report.circle.centre_px;
                let circle = Circle { centre: [x, y], radius: report.circle.radius_px };
                move_ball(session, subject, kind, circle);
                session.done(format!(
                    "{title}: centre {x:.1}, {y:.1}, radius {:.1} px, by its edge to {:.2} px",
                    circle.radius, report.sd_px
                ));
            }
            Err(error) => session.error(format!("{title}: {error}")),
        }
    }
}

/// The ball's diameter in mm, where it is known: what gives the scale.
fn diameter(ui: &mut Ui, session: &mut Session, (subject, kind): (Subject, SphereKind), circle: Circle) {
    let title = title_of(subject, kind);
    let document = session.document();
    let placed = document.set.spheres.iter().position(|ball| (ball.subject, ball.kind) == (subject, kind));
    let old = placed.and_then(|index| document.set.spheres[index].diameter_mm);
    let mut new = old;
    ui.horizontal(|ui| {
        let mut is_known = old.is_some();
        let hover = "Gives the scale where the camera has none";
        let check = ui.checkbox(&mut is_known, "Diameter, mm").on_hover_text(hover);
        check.widget_info(|| {
            eframe::egui::WidgetInfo::selected(
                eframe::egui::Role::CheckBox,
                true,
                is_known,
                format!("{title}, diameter known"),
            )
        });
        new = is_known.then(|| old.unwrap_or(FIRST_DIAMETER_MM));
        if let Some(mm) = &mut new {
            let field = ui.add(fixed(mm, 3, Number::DiameterMm.range()).speed(0.05));
            field.widget_info(|| {
                eframe::egui::WidgetInfo::labeled(eframe::egui::Role::SpinButton, true, format!("{title}, diameter"))
            });
        }
    });
    if new != old {
        session.edit(&format!("Measure {}", title.to_lowercase()), |document| match placed {
            Some(index) => document.set.spheres[index].diameter_mm = new,
            None => document.set.put_sphere(Sphere { subject, kind, circle, diameter_mm: new }),
        });
    }
}

fn find(loaded: &Arc<Loaded>, subject: Subject, look: Look) -> Result<CircleReport, BallError> {
    let shots = loaded.shots.iter().filter(|shot| shot.name.subject == subject);
    let planes: Vec<_> = shots.filter_map(|shot| shot.photo.as_ref().ok()).map(|photo| &photo.linear).collect();
    let options = CircleOptions::default();
    match look {
        Look::Anywhere => find_circle(&planes, None, &options),
        Look::Under(Circle { centre: [x, y], radius }) => {
            refine_circle(&planes, &sphere::Circle { centre_px: (x, y), radius_px: radius }, &options)
        }
        // A click beside the ball means the ball all the same, if it is the only one near.
        Look::Near([x, y]) => find_circle(&planes, Some((x, y)), &options).or_else(|missed| {
            let anywhere = find_circle(&planes, None, &options).map_err(|_| missed.clone())?;
            if anywhere.circle.radii_from_centre(x, y) < NEAR_RADII { Ok(anywhere) } else { Err(missed) }
        }),
    }
}

/// What x, y and radius start with where no circle is known: the middle of the photo.
fn circle_to_start_with(session: &Session, subject: Subject) -> Circle {
    let loaded = session.results.loaded();
    let photos = loaded.iter().flat_map(|loaded| &loaded.shots).filter(|shot| shot.name.subject == subject);
    let size = photos.filter_map(|shot| shot.photo.as_ref().ok()).map(|photo| photo.linear.size()).next();
    let (width, height) = size.map_or((0.0, 0.0), |(width, height)| (width as f64, height as f64));
    Circle { centre: [width / 2.0, height / 2.0], radius: (0.25 * width.min(height)).max(1.0) }
}

/// Puts a ball's circle where the user wants it.
pub fn move_ball(session: &mut Session, subject: Subject, kind: SphereKind, circle: Circle) {
    let name = format!("Place {}", kind.title().to_lowercase());
    session.edit(&name, |document| document.set.put_sphere(Sphere { subject, kind, circle, diameter_mm: None }));
}

/// The circle of a ball: the one that was placed, else the one that was found.
pub fn circle_in_force(session: &Session, subject: Subject, kind: SphereKind) -> Option<Circle> {
    let placed = session.document().set.circle(subject, kind);
    placed.or_else(|| found_circle(session, subject, kind).map(|(circle, _)| circle))
}

fn found_circle(session: &Session, subject: Subject, kind: SphereKind) -> Option<(Circle, Option<CircleReport>)> {
    let results = [session.results.measured(), session.results.calibration()];
    results.into_iter().flatten().find_map(|calibration| {
        let mut circles = calibration.calibrated.circles.iter();
        let ball = circles.find(|ball| (ball.sphere.subject, ball.sphere.kind) == (subject, kind))?;
        Some((ball.sphere.circle, ball.found.clone()))
    })
}
