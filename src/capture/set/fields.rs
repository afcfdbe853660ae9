//! Reads the keys of one table, and remembers where each is.

use std::collections::HashMap;
use std::ops::Range;

use toml_edit::{Item, TableLike, Value};

use super::model::Encoding;
use super::problem::{Location, Problem, TextPosition};
use super::rule::{did_you_mean, nearest};
use super::word::Word;

/// The text being read: what is wrong with it so far, and where its keys are.
pub(super) struct Reader<'t> {
    text: &'t str,
    line_starts: Vec<usize>,
    places: HashMap<(Location, Option<String>), usize>,
    pub(super) problems: Vec<Problem>,
    /// Every key that was asked for, by the header of its part.
    #[cfg(test)]
    pub(super) asked: std::collections::BTreeSet<(&'static str, &'static str)>,
}

impl<'t> Reader<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let newlines = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let line_starts = std::iter::once(0).chain(newlines.map(|(at, _)| at + 1)).collect();
        Self {
            text,
            line_starts,
            places: HashMap::new(),
            problems: Vec::new(),
            #[cfg(test)]
            asked: Default::default(),
        }
    }

    /// The line and column of a byte of the text.
    pub(super) fn position(&self, offset: usize) -> TextPosition {
        let line = self.line_starts.partition_point(|start| *start <= offset).max(1);
        let start = self.line_starts.get(line - 1).copied().unwrap_or(0);
        let column = self.text.get(start..offset).map_or(0, |before| before.chars().count()) + 1;
        TextPosition { line, column }
    }

    /// Where a key is; where its part is if the key is absent.
    pub(super) fn place(&self, location: Location, key: Option<&str>) -> Option<TextPosition> {
        let of_key = key.and_then(|key| self.places.get(&(location, Some(key.into()))));
        of_key.or_else(|| self.places.get(&(location, None))).map(|offset| self.position(*offset))
    }

    pub(super) fn remember(&mut self, location: Location, key: Option<&str>, span: Option<Range<usize>>) {
        if let Some(span) = span {
            self.places.entry((location, key.map(str::to_owned))).or_insert(span.start);
        }
    }

    pub(super) fn report(&mut self, problem: Problem) {
        let position = problem.position.or_else(|| self.place(problem.location, problem.key.as_deref()));
        self.problems.push(Problem { position, ..problem });
    }

    /// What the file has, short enough for one line.
    fn found(&self, item: &Item) -> String {
        let written = item.as_value().and_then(|value| self.text.get(value.span()?));
        match written {
            Some(text) if text.chars().count() <= 40 && !text.contains(['\n', '\r']) => text.to_owned(),
            _ => format!("a value of type {}", item.type_name()),
        }
    }
}

/// One table of the file. Every key that is asked for is known; [`Fields::finish`] reports the others.
pub(super) struct Fields<'r, 't> {
    pub(super) reader: &'r mut Reader<'t>,
    table: &'r dyn TableLike,
    location: Location,
    known: Vec<&'static str>,
    missing: Vec<(&'static str, String)>,
}

impl<'r, 't> Fields<'r, 't> {
    pub(super) fn new(reader: &'r mut Reader<'t>, table: &'r dyn TableLike, location: Location) -> Self {
        Self { reader, table, location, known: Vec::new(), missing: Vec::new() }
    }

    /// The item at `key` as it is.
    pub(super) fn item(&mut self, key: &'static str) -> Option<&'r Item> {
        self.known.push(key);
        #[cfg(test)]
        self.reader.asked.insert((self.location.header(), key));
        let item = self.table.get(key).filter(|item| !item.is_none())?;
        let span = self.key_span(key).or_else(|| item.span());
        self.reader.remember(self.location, Some(key), span);
        Some(item)
    }

    /// Where `key` is.
    pub(super) fn key_span(&self, key: &str) -> Option<Range<usize>> {
        self.table.key(key).and_then(|key| key.span())
    }

    /// The value at `key`; `None` if it is absent or is not `expected`, which is reported.
    pub(super) fn get<T>(
        &mut self,
        key: &'static str,
        expected: &str,
        convert: impl Fn(&Item) -> Option<T>,
    ) -> Option<T> {
        let item = self.item(key)?;
        self.convert(key, expected, item, convert)
    }

    /// The value at `key`, which must be there.
    pub(super) fn require<T>(
        &mut self,
        key: &'static str,
        expected: &str,
        convert: impl Fn(&Item) -> Option<T>,
    ) -> Option<T> {
        if self.item(key).is_none() {
            self.missing.push((key, format!("missing; expected {expected}")));
        }
        self.get(key, expected, convert)
    }

    /// The values of a table of this table: by light, the light's name and what belongs to it.
    pub(super) fn by_light<T>(
        &mut self,
        key: &'static str,
        expected: &str,
        convert: impl Fn(&Item) -> Option<T>,
    ) -> Vec<(String, T)> {
        let Some(item) = self.item(key) else { return Vec::new() };
        let Some(table) = item.as_table_like() else {
            let found = self.reader.found(item);
            self.problem(key, format!("expected a table of lights, found {found}"));
            return Vec::new();
        };
        let mut values = Vec::new();
        for (light, item) in table.iter() {
            let path = format!("{key}.{light}");
            let span = table.key(light).and_then(|key| key.span()).or_else(|| item.span());
            self.reader.remember(self.location, Some(&path), span);
            values.extend(self.convert(&path, expected, item, &convert).map(|value| (light.to_owned(), value)));
        }
        values
    }

    fn convert<T>(
        &mut self,
        key: &str,
        expected: &str,
        item: &Item,
        convert: impl Fn(&Item) -> Option<T>,
    ) -> Option<T> {
        let value = convert(item);
        if value.is_none() {
            let found = self.reader.found(item);
            self.problem(key, format!("expected {expected}, found {found}"));
        }
        value
    }

    pub(super) fn problem(&mut self, key: &str, message: String) {
        self.reader.report(Problem::of_key(self.location, key, message));
    }

    /// Reports every key that was not asked for, and every required one that is neither there nor misspelt.
    pub(super) fn finish(mut self) {
        for (key, item) in self.table.iter().filter(|(key, _)| !self.known.contains(key)) {
            let meant = nearest(key, self.known.iter().copied());
            self.missing.retain(|(missing, _)| meant != Some(missing));
            let message = format!("unknown key {key:?}{}", did_you_mean(key, self.known.iter().copied()));
            let span = self.key_span(key).or_else(|| item.span());
            let position = span.map(|span| self.reader.position(span.start));
            self.reader.report(Problem { position, ..Problem::of_part(self.location, message) });
        }
        for (key, message) in std::mem::take(&mut self.missing) {
            self.problem(key, message);
        }
    }
}

pub(super) fn text(item: &Item) -> Option<String> {
    item.as_str().map(str::to_owned)
}

pub(super) fn word<W: Word>(item: &Item) -> Option<W> {
    W::from_word(item.as_str()?)
}

pub(super) fn count(item: &Item) -> Option<usize> {
    item.as_integer().and_then(|integer| usize::try_from(integer).ok())
}

/// TOML knows `nan` and `inf`; neither is a number of this format.
pub(super) fn number(item: &Item) -> Option<f64> {
    item.as_value().and_then(finite)
}

fn finite(value: &Value) -> Option<f64> {
    number_of(value).filter(|number| number.is_finite())
}

pub(super) fn number_of(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|integer| integer as f64))
}

pub(super) fn numbers(item: &Item) -> Option<Vec<f64>> {
    item.as_array()?.iter().map(finite).collect()
}

pub(super) fn rows(item: &Item) -> Option<Vec<Vec<f64>>> {
    item.as_array()?.iter().map(|row| row.as_array()?.iter().map(finite).collect()).collect()
}

pub(super) fn tuple<const N: usize>(item: &Item) -> Option<[f64; N]> {
    numbers(item)?.try_into().ok()
}

pub(super) fn texts(item: &Item) -> Option<Vec<String>> {
    item.as_array()?.iter().map(|value| value.as_str().map(str::to_owned)).collect()
}

/// What an encoding may be, in the words of the file.
pub(super) const ENCODING: &str = "\"linear\", \"srgb\" or { gamma = 2.2 }";

pub(super) fn encoding(item: &Item) -> Option<Encoding> {
    match item.as_str() {
        Some("linear") => Some(Encoding::Linear),
        Some("srgb") => Some(Encoding::Srgb),
        Some(_) => None,
        None => {
            let table = item.as_table_like().filter(|table| table.len() == 1)?;
            number(table.get("gamma")?).map(Encoding::Gamma)
        }
    }
}
