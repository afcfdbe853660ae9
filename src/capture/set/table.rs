//! The light x colour tables of a capture set: which photos there are, which are missing, what is wrong with each.

use super::model::Subject;
use super::model::{CaptureSet, Shot};
use super::problem::{Location, Problem};

/// The table of one subject.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShotTable {
    /// What the shots show.
    pub subject: Subject,
    /// Names of the colours; `None` for shots that name none.
    pub columns: Vec<Option<String>>,
    /// One for each light; without a light for dark frames, say.
    pub rows: Vec<ShotRow>,
}

/// The shots of one subject under one light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShotRow {
    /// The light's name.
    pub light: Option<String>,
    /// In the order of the columns.
    pub cells: Vec<ShotCell>,
}

/// One photo of the table, or where it is missing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShotCell {
    /// Indices of the set's shots; more than one is a problem that the cell names.
    pub shots: Vec<usize>,
    /// What is wrong with them, in words; of a missing photo that is needed, that it is missing.
    pub problems: Vec<String>,
}

impl CaptureSet {
    /// The table of every subject that the set shows, the object's always. `problems` are those of the set, of its file
    /// or of [`Self::check`]; those of shots go into their cells.
    pub fn tables(&self, problems: &[Problem]) -> Vec<ShotTable> {
        let mut subjects = self.subjects();
        if !subjects.contains(&Subject::Object) {
            subjects.insert(0, Subject::Object);
        }
        subjects.into_iter().map(|subject| self.table(subject, problems)).collect()
    }

    fn table(&self, subject: Subject, problems: &[Problem]) -> ShotTable {
        let matte = subject.is_matte();
        let named = |name: &String| Some(name.clone());
        let mut lights: Vec<_> = self.lights.iter().map(|light| named(&light.name)).collect();
        let mut columns: Vec<_> = self.colours.iter().map(|colour| named(&colour.name)).collect();
        // Names that no light or colour has get their place too: their shots must not vanish.
        for shot in self.shots_of(subject) {
            push_new(&mut lights, &shot.light);
            push_new(&mut columns, &shot.colour);
        }
        let used =
            |of: fn(&Shot) -> &Option<String>, name: &Option<String>| self.shots_of(subject).any(|s| of(s) == name);
        if !matte {
            lights.retain(|light| used(|shot| &shot.light, light));
            columns.retain(|colour| used(|shot| &shot.colour, colour));
        }
        let rows = lights.into_iter().map(|light| {
            let lit = subject == Subject::Object || used(|shot| &shot.light, &light);
            let cells =
                columns.iter().map(|colour| self.cell(subject, &light, colour, problems, matte && lit)).collect();
            ShotRow { light, cells }
        });
        ShotTable { subject, rows: rows.collect(), columns }
    }

    fn cell(
        &self,
        subject: Subject,
        light: &Option<String>,
        colour: &Option<String>,
        problems: &[Problem],
        needed: bool,
    ) -> ShotCell {
        let here = |shot: &Shot| shot.subject == subject && shot.light == *light && shot.colour == *colour;
        let shots: Vec<usize> = self.shots.iter().enumerate().filter(|(_, shot)| here(shot)).map(|(i, _)| i).collect();
        let of_shot = |problem: &&Problem| matches!(problem.location, Location::Shot(index) if shots.contains(&index));
        let mut words: Vec<String> = problems.iter().filter(of_shot).map(ToString::to_string).collect();
        if let (true, true, Some(light), Some(colour)) = (shots.is_empty(), needed, light, colour) {
            words.push(format!(
                "no {subject} photo under \"{light}\" in \"{colour}\": add it, or remove the light or the colour"
            ));
        }
        ShotCell { shots, problems: words }
    }
}

fn push_new(names: &mut Vec<Option<String>>, name: &Option<String>) {
    if !names.contains(name) {
        names.push(name.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::super::model::{Colour, Light};
    use super::*;

    fn set(shots: &[(Subject, Option<&str>, Option<&str>)]) -> CaptureSet {
        let light = |name: &str| Light { name: name.into(), ..Light::default() };
        let colour = |name: &str| Colour { name: name.into(), ..Colour::default() };
        let shot = |(subject, light, colour): &(Subject, Option<&str>, Option<&str>)| Shot {
            subject: *subject,
            light: light.map(str::to_owned),
            colour: colour.map(str::to_owned),
            files: vec!["a.png".into()],
            ..Shot::default()
        };
        CaptureSet {
            lights: vec![light("left"), light("right")],
            colours: vec![colour("blue"), colour("green")],
            shots: shots.iter().map(shot).collect(),
            ..CaptureSet::default()
        }
    }

    #[test]
    fn every_shot_stands_in_one_cell_and_a_missing_one_is_named() {
        let set = set(&[
            (Subject::Object, Some("left"), Some("blue")),
            (Subject::Object, Some("left"), Some("red")),
            (Subject::Object, Some("left"), Some("blue")),
            (Subject::MirrorSphere, Some("right"), None),
            (Subject::Dark, None, None),
        ]);
        let tables = set.tables(&set.check());
        let mut seen: Vec<usize> = tables
            .iter()
            .flat_map(|t| &t.rows)
            .flat_map(|row| &row.cells)
            .flat_map(|cell| cell.shots.clone())
            .collect();
        seen.sort_unstable();
        assert_eq!(seen, [0, 1, 2, 3, 4]);
        let object = &tables[0];
        assert_eq!(object.columns.len(), 3, "blue, green and the unknown red");
        assert!(object.rows[0].cells[0].problems.iter().any(|words| words.contains("number 3")), "given twice");
        assert!(object.rows[0].cells[2].problems.iter().any(|words| words.contains("unknown colour \"red\"")));
        assert!(object.rows[1].cells[1].problems[0].starts_with("no object photo under \"right\" in \"green\""));
        assert_eq!((tables[1].rows.len(), tables[1].columns.len()), (1, 1), "one mirror photo");
    }

    #[test]
    fn a_ball_without_photos_under_a_light_lacks_nothing_there() {
        let set = set(&[(Subject::GreySphere, Some("left"), Some("blue"))]);
        let tables = set.tables(&[]);
        let grey = &tables[1];
        assert!(grey.rows[0].cells[1].problems[0].contains("grey-sphere"));
        assert!(grey.rows[1].cells.iter().all(|cell| cell.problems.is_empty()));
    }
}
