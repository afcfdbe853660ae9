//! The directory of a TIFF, read over before its decoder reads it, and changed where the decoder does not know a kind.

use std::io::{self, Cursor, Read, Seek, SeekFrom};

use tiff::tags::{IfdPointer, Tag};

/// Each tag has a number of 16 bits and stands once.
const MAX_ENTRIES: u64 = 1 << 16;
/// The numbers of the types of a tag that are text and a number of 32 bits.
const TEXT: u64 = 2;
const LONG: u16 = 4;

/// An entry of a directory: its value as it stands in the field, which may be the place of the value.
pub(super) struct Entry {
    pub tag: u64,
    kind: u64,
    count: u64,
    pub value: u64,
}

/// The longest text of the first directory, in bytes as it is stated. The decoder prints a line of its own to standard
/// error for one beyond its limit.
///
/// # Errors
/// As [`entries`].
pub(super) fn longest_text(file: impl Read + Seek) -> io::Result<u64> {
    let texts = entries(file)?.into_iter().filter(|entry| entry.kind == TEXT);
    Ok(texts.map(|entry| entry.count).max().unwrap_or(0))
}

/// The entries of the first directory.
///
/// # Errors
/// What the system says, the end of the file among it; and for a type that TIFF does not have.
pub(super) fn entries(mut file: impl Read + Seek) -> io::Result<Vec<Entry>> {
    let low_first = number(&mut file, 2, true)? == u64::from(u16::from_le_bytes(*b"II"));
    let mut number = |bytes: usize, at: Option<u64>| {
        at.map(|at| file.seek(SeekFrom::Start(at))).transpose()?;
        number(&mut file, bytes, low_first)
    };
    let is_big = number(2, None)? == 43;
    let (word, first) = if is_big { (8, 8) } else { (4, 4) };
    let directory = number(word, Some(first))?;
    let count = number(if is_big { 8 } else { 2 }, Some(directory))?;
    if count > MAX_ENTRIES {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a directory of more entries than there are tags"));
    }
    let mut entries = Vec::new();
    for _ in 0..count {
        let (tag, kind) = (number(2, None)?, number(2, None)?);
        // The decoder skips too few bytes of a big entry of an unknown type, and would see others than are seen here.
        if is_big && !matches!(kind, 1..=13 | 16..=18) {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a tag has no type"));
        }
        let (count, value) = (number(word, None)?, number(word, None)?);
        entries.push(Entry { tag, kind, count, value });
    }
    Ok(entries)
}

/// Sets tags of the directory at `place` to one number each; `None` if one of them is not there.
pub(super) fn set_tags(bytes: &mut [u8], IfdPointer(place): IfdPointer, changes: &[(Tag, u32)]) -> Option<()> {
    let low_first = bytes.starts_with(b"II");
    let is_big = number(&mut Cursor::new(bytes.get(2..)?), 2, low_first).ok()? == 43;
    let (word, count_bytes) = if is_big { (8, 8) } else { (4, 2) };
    let start = usize::try_from(place).ok()?;
    let entries = number(&mut Cursor::new(bytes.get(start..)?), count_bytes, low_first).ok()?;
    let entry_bytes = 4 + 2 * word;
    let mut changed = 0;
    let table = bytes.get_mut(start + count_bytes..)?;
    for entry in table.chunks_exact_mut(entry_bytes).take(usize::try_from(entries).ok()?) {
        let tag = number(&mut Cursor::new(&*entry), 2, low_first).ok()?;
        let Some((_, value)) = changes.iter().find(|(wanted, _)| u64::from(wanted.to_u16()) == tag) else { continue };
        let ordered = |value: u64, bytes: usize| match low_first {
            true => value.to_le_bytes()[..bytes].to_vec(),
            false => value.to_be_bytes()[8 - bytes..].to_vec(),
        };
        // The value stands at the start of its field, in either order.
        let mut field = ordered(u64::from(*value), 4);
        field.resize(word, 0);
        let written = [ordered(u64::from(LONG), 2), ordered(1, word), field].concat();
        entry[2..].copy_from_slice(&written);
        changed += 1;
    }
    (changed == changes.len()).then_some(())
}

fn number(file: &mut impl Read, bytes: usize, low_first: bool) -> io::Result<u64> {
    let mut value = [0; 8];
    if low_first {
        file.read_exact(&mut value[..bytes])?;
        return Ok(u64::from_le_bytes(value));
    }
    file.read_exact(&mut value[8 - bytes..])?;
    Ok(u64::from_be_bytes(value))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    #[test]
    fn the_longest_text_is_found_in_both_byte_orders_and_sizes() {
        let little = b"II*\0\x08\0\0\0\x02\0\x00\x01\x04\0\x01\0\0\0\x05\0\0\0\x0e\x01\x02\0\x09\0\0\0\0\0\0\0\0\0\0\0";
        assert_eq!(longest_text(Cursor::new(little)).unwrap(), 9);
        let big = [
            b"MM\0+\0\x08\0\0".as_slice(),
            &16_u64.to_be_bytes(),
            &1_u64.to_be_bytes(),
            b"\x01\x0e\0\x02",
            &(1_u64 << 40).to_be_bytes(),
            &[0; 8],
        ];
        assert_eq!(longest_text(Cursor::new(big.concat())).unwrap(), 1 << 40);
        assert!(longest_text(Cursor::new(b"II*\0\xff\0\0\0")).is_err());
    }
}
