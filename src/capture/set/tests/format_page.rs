//! FORMAT.md against the reader: its examples are right, and it describes every key and nothing else.

use std::collections::BTreeSet;

use toml_edit::{Document, Item};

use super::super::fields::Reader;
use super::super::read::read_set;
use super::super::{Naming, Subject, Word};
use super::parse;

const PAGE: &str = include_str!("../../FORMAT.md");

/// The header of a part and a key of it.
type Key = (String, String);

fn examples() -> Vec<&'static str> {
    let blocks = PAGE.split("```toml\n").skip(1);
    blocks.map(|block| block.split("```").next().unwrap()).collect()
}

/// The keys that an example has.
fn written(document: &Document<&str>) -> BTreeSet<Key> {
    let mut keys = BTreeSet::new();
    for (part, item) in document.iter() {
        keys.insert((String::new(), part.to_owned()));
        let (header, tables) = match item {
            Item::Table(table) => (format!("[{part}]"), vec![table]),
            Item::ArrayOfTables(tables) => (format!("[[{part}]]"), tables.iter().collect()),
            _ => continue,
        };
        keys.extend(tables.into_iter().flatten().map(|(key, _)| (header.clone(), key.to_owned())));
    }
    keys
}

/// The keys that the reader asks an example for.
fn known(text: &str, document: &Document<&str>) -> BTreeSet<Key> {
    let mut reader = Reader::new(text);
    read_set(&mut reader, document.as_table());
    reader.asked.into_iter().map(|(header, key)| (header.to_owned(), key.to_owned())).collect()
}

#[test]
fn the_examples_of_the_page_are_right_sets() {
    assert!(examples().len() > 1);
    examples().into_iter().for_each(|text| drop(parse(text)));
}

#[test]
fn the_page_shows_every_key_that_is_read_and_no_other() {
    let (mut shown, mut read) = (BTreeSet::new(), BTreeSet::new());
    for text in examples() {
        let document = Document::parse(text).unwrap();
        shown.extend(written(&document));
        read.extend(known(text, &document));
    }
    assert_eq!(shown, read);
}

#[test]
fn the_page_has_a_row_for_every_subject() {
    let word = |naming| match naming {
        Naming::Required => "required",
        Naming::Optional => "optional",
        Naming::Refused => "refused",
    };
    for subject in Subject::ALL {
        let row = PAGE.lines().find(|line| line.starts_with(&format!("| `{subject}` |"))).unwrap();
        assert!(row.ends_with(&format!("| {} | {} |", word(subject.light()), word(subject.colour()))), "{row}");
    }
}
