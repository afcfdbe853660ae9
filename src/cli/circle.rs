//! Circles of balls from the command line: `--circle mirror=100,100,83`.

use std::str::FromStr;

use anyhow::bail;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{PipelineWatch, circle_of};
use firstbounce_capture::set::{Circle, SetError, Sphere, SphereKind, Word};
use firstbounce_core::sphere::circle_through;

/// The circle that the user gives for a ball.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenCircle {
    ball: SphereKind,
    place: Place,
}

#[derive(Clone, Debug, PartialEq)]
enum Place {
    Circle(Circle),
    Rim([(f64, f64); 3]),
    SameAs(SphereKind),
}

impl FromStr for GivenCircle {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> anyhow::Result<Self> {
        let kind = |name: &str| SphereKind::from_word(name.trim().trim_end_matches("-sphere"));
        let given = text.split_once('=').and_then(|(ball, place)| Some((kind(ball)?, place)));
        let Some((ball, place)) = given else { bail!("it names no ball: write grey=.., material=.. or mirror=..") };
        if let Some(other) = kind(place).filter(|other| *other != ball) {
            return Ok(Self { ball, place: Place::SameAs(other) });
        }
        let numbers = place.split([',', ' ']).filter(|part| !part.is_empty()).map(|part| part.parse::<f64>().ok());
        let numbers: Option<Vec<f64>> = numbers.map(|number| number.filter(|number| number.is_finite())).collect();
        let place = match numbers.as_deref() {
            Some(&[x, y, radius]) => Place::Circle(Circle { centre: [x, y], radius }),
            Some(&[ax, ay, bx, by, cx, cy]) => Place::Rim([(ax, ay), (bx, by), (cx, cy)]),
            _ => bail!(
                "\"{place}\" is no circle: write X,Y,RADIUS in pixels, three points of the rim as X,Y,X,Y,X,Y, or another \
                 ball in the same place"
            ),
        };
        Ok(Self { ball, place })
    }
}

impl GivenCircle {
    /// Puts it in force.
    pub fn put_into(&self, set: &mut CaptureSet, watch: &dyn PipelineWatch) -> anyhow::Result<()> {
        let Some(subject) = set.subject_with(self.ball) else {
            bail!("the set has no {} ball: add its shots", self.ball)
        };
        let circle = match self.place {
            Place::Circle(circle) => circle,
            Place::Rim(points) => {
                let circle = circle_through(points)?;
                Circle { centre: [circle.centre_px.0, circle.centre_px.1], radius: circle.radius_px }
            }
            Place::SameAs(other) => circle_of(set, other, watch)?,
        };
        set.put_sphere(Sphere { subject, kind: self.ball, circle, diameter_mm: None });
        let problems = set.check();
        if problems.is_empty() { Ok(()) } else { Err(SetError::Invalid { path: set.file_path(), problems }.into()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_are_read_as_they_are_written() {
        let place = |text: &str| text.parse::<GivenCircle>().map(|given| (given.ball, given.place)).ok();
        let circle = Circle { centre: [10.0, 20.5], radius: 8.0 };
        assert_eq!(place("mirror=10,20.5,8"), Some((SphereKind::Mirror, Place::Circle(circle))));
        let rim = Place::Rim([(1.0, 2.0), (3.0, 4.0), (5.0, 7.0)]);
        assert_eq!(place("grey-sphere=1,2, 3,4, 5,7"), Some((SphereKind::Grey, rim)));
        assert_eq!(place("mirror=grey"), Some((SphereKind::Mirror, Place::SameAs(SphereKind::Grey))));
        for wrong in
            ["", "mirror", "mirror=", "mirror=1,2", "mirror=mirror", "ball=1,2,3", "grey=1,2,nan", "grey=1,2,3,4"]
        {
            assert_eq!(place(wrong), None, "{wrong}");
        }
    }
}
