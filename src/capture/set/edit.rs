//! Changes values in a TOML text and leaves everything else, comments and layout, as it is.

use std::collections::HashMap;

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike, Value};

use super::fields::number_of;

/// Sets `key`, keeping the spaces and comments around an old value, and the old value itself if it is the same.
pub(super) fn put(table: &mut dyn TableLike, key: &str, value: impl Into<Value>) {
    let value = value.into();
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => replace(old, value),
        None => {
            table.insert(key, Item::Value(value));
        }
    }
}

/// Sets `key`, or takes it away.
pub(super) fn put_or_remove(table: &mut dyn TableLike, key: &str, value: Option<impl Into<Value>>) {
    match value {
        Some(value) => put(table, key, value),
        None => {
            table.remove(key);
        }
    }
}

/// Sets `key` unless it is absent and `value` is what the format takes for absent.
pub(super) fn put_unless_default<V: Into<Value> + PartialEq>(
    table: &mut dyn TableLike,
    key: &str,
    value: V,
    default: V,
) {
    if value != default || table.contains_key(key) {
        put(table, key, value);
    }
}

fn replace(old: &mut Value, new: Value) {
    if same(old, &new) {
        return;
    }
    match (old, new) {
        (Value::Array(old), Value::Array(new)) => replace_items(old, new),
        (old, mut new) => {
            *new.decor_mut() = old.decor().clone();
            *old = new;
        }
    }
}

/// Item by item, so that the comments of a list of several lines survive.
fn replace_items(old: &mut Array, new: Array) {
    while old.len() > new.len() {
        old.remove(old.len() - 1);
    }
    for (index, value) in new.into_iter().enumerate() {
        match old.get_mut(index) {
            Some(old) => replace(old, value),
            None => old.push(value),
        }
    }
}

/// Whether two values mean the same to the reader.
fn same(old: &Value, new: &Value) -> bool {
    match (old, new) {
        (Value::String(old), Value::String(new)) => old.value() == new.value(),
        (Value::Array(old), Value::Array(new)) => {
            old.len() == new.len() && old.iter().zip(new.iter()).all(|(old, new)| same(old, new))
        }
        (Value::InlineTable(old), Value::InlineTable(new)) => {
            let matches = |(key, new)| old.get(key).is_some_and(|old| same(old, new));
            old.len() == new.len() && new.iter().all(matches)
        }
        _ => number_of(old).is_some() && number_of(old) == number_of(new),
    }
}

/// A list of numbers, or of anything else that is a value.
pub(super) fn list<V: Into<Value>>(values: impl IntoIterator<Item = V>) -> Value {
    Value::Array(values.into_iter().map(Into::into).collect())
}

/// `{ key = value }`
pub(super) fn inline(key: &str, value: impl Into<Value>) -> Value {
    Value::InlineTable(InlineTable::from_iter([(key, value.into())]))
}

/// Changes the `[key]` table; one that does not exist is made, at the end of the text, if `write` puts anything there.
pub(super) fn edit_table(document: &mut DocumentMut, key: &str, write: impl FnOnce(&mut Table)) {
    match document.get_mut(key) {
        Some(Item::Table(table)) => write(table),
        Some(item) => {
            let mut table = std::mem::take(item).into_table().unwrap_or_default();
            write(&mut table);
            *item = Item::Table(table);
        }
        None => {
            let mut table = Table::new();
            write(&mut table);
            if !table.is_empty() {
                begin_at_end(document, &mut table);
                document.insert(key, Item::Table(table));
            }
        }
    }
}

/// Changes the table at `key` inside `table` to hold `values`, likewise.
pub(super) fn edit_subtable<'k>(table: &mut Table, key: &str, values: impl Iterator<Item = (&'k str, Value)>) {
    let mut values = values.peekable();
    if values.peek().is_none() {
        table.remove(key);
        return;
    }
    let mut new = Table::new();
    new.set_dotted(table.is_dotted());
    let item = table.entry(key).or_insert(Item::Table(new));
    let Some(inner) = item.as_table_like_mut() else { return };
    let mut stale: Vec<String> = inner.iter().map(|(key, _)| key.to_owned()).collect();
    for (key, value) in values {
        put(inner, key, value);
        stale.retain(|old| old != key);
    }
    for key in stale {
        inner.remove(&key);
    }
}

/// Puts `table` behind everything, comments included, that the text holds.
fn begin_at_end(document: &mut DocumentMut, table: &mut Table) {
    table.set_position(Some(last_position(document.as_table()) + 1));
    let trailing = document.trailing().as_str().unwrap_or_default().to_owned();
    if !trailing.is_empty() {
        let gap = if trailing.ends_with('\n') { "\n" } else { "\n\n" };
        table.decor_mut().set_prefix(trailing + gap);
        document.set_trailing("");
    }
}

fn last_position(table: &Table) -> isize {
    let inner = table.iter().flat_map(|(_, item)| match item {
        Item::Table(table) => vec![last_position(table)],
        Item::ArrayOfTables(tables) => tables.iter().map(last_position).collect(),
        Item::None | Item::Value(_) => Vec::new(),
    });
    inner.chain(table.position()).max().unwrap_or(0)
}

/// Changes the `[[key]]` tables to `items`. A table survives where `identity`, some of its keys, stays the same; else
/// where it alone was changed at its place.
pub(super) fn edit_tables<T>(
    document: &mut DocumentMut,
    key: &str,
    identity: &[&str],
    items: &[T],
    write: impl Fn(&mut Table, &T),
) {
    let old_tables: Vec<Table> = match document.get_mut(key).map(std::mem::take).map(Item::into_array_of_tables) {
        Some(Ok(tables)) => tables.into_iter().collect(),
        Some(Err(_)) | None => Vec::new(),
    };
    let mut positions: Vec<isize> = old_tables.iter().filter_map(Table::position).collect();
    positions.sort_unstable();
    let existed = !old_tables.is_empty();

    // First every item takes the table of the same identity, then the table that is left over at its place.
    let mut olds: Vec<Option<Table>> = old_tables.into_iter().map(Some).collect();
    let mut by_identity: HashMap<Vec<Option<String>>, usize> = HashMap::new();
    for (index, table) in olds.iter().enumerate() {
        by_identity.entry(identity_of(table.as_ref(), identity)).or_insert(index);
    }
    let mut tables: Vec<Option<Table>> = Vec::with_capacity(items.len());
    for item in items {
        let mut fresh = Table::new();
        write(&mut fresh, item);
        let index = by_identity.remove(&identity_of(Some(&fresh), identity));
        tables.push(index.and_then(|index| olds.get_mut(index)).and_then(Option::take));
    }

    let mut positions = positions.into_iter();
    let mut array = ArrayOfTables::new();
    for (index, item) in items.iter().enumerate() {
        let survivor = tables.get_mut(index).and_then(Option::take);
        let mut table = survivor.or_else(|| olds.get_mut(index).and_then(Option::take)).unwrap_or_default();
        write(&mut table, item);
        table.set_position(positions.next());
        if index == 0 && !existed {
            begin_at_end(document, &mut table);
        }
        array.push(table);
    }
    if array.is_empty() {
        document.remove(key);
    } else {
        *document.entry(key).or_insert(Item::None) = Item::ArrayOfTables(array);
    }
}

fn identity_of(table: Option<&Table>, keys: &[&str]) -> Vec<Option<String>> {
    keys.iter().map(|key| table?.get(key)?.as_str().map(str::to_owned)).collect()
}
