//! Contents of the records in flash: converts settings, offsets and texts to bytes and back.
use crate::controller::{STORED_BYTES, Stored};
use crate::settings::Settings;
use crate::store::log::LONGEST;
use glidepath::nc::StoredOffsets;
use glidepath::quantity::Position;
use heapless::Vec;

/// The content of a record.
pub type Content = Vec<u8, LONGEST>;

/// Kinds of records.
pub const SETTINGS: u8 = 1;
pub const OFFSETS: u8 = 2;
pub const TEXTS: u8 = 3;

/// Version of each content.
pub const VERSION: u8 = 1;

/// Bytes of the longest content for this number of axes.
pub const fn longest(axes: usize) -> usize {
    let settings = 5 * (Settings::<0>::COUNT + 4 * axes);
    let offsets = 8 * 11 * axes;
    let texts = 3 * (1 + STORED_BYTES);
    let most = if settings > offsets { settings } else { offsets };
    if most > texts { most } else { texts }
}

/// Number and value of each setting. A later build refuses numbers that it does not know; its additional
/// settings keep defaults.
pub fn settings<const AXES: usize>(settings: &Settings<AXES>) -> Option<Content> {
    let mut content = Content::new();
    settings.each_raw(|number, value| {
        content.push(number).ok()?;
        content.extend_from_slice(&value.to_le_bytes()).ok()
    })?;
    Some(content)
}

/// Reads the settings, if they fit this machine; settings that are not in the record keep `defaults`.
pub fn read_settings<const AXES: usize>(bytes: &[u8], defaults: &Settings<AXES>) -> Option<Settings<AXES>> {
    let mut settings = *defaults;
    let mut words = bytes.chunks_exact(5);
    for word in &mut words {
        let [number, value @ ..] = *word.first_chunk::<5>()?;
        settings.put_raw(number, u32::from_le_bytes(value))?;
    }
    (words.remainder().is_empty() && settings.is_permitted()).then_some(settings)
}

/// Zero offsets, then the positions of G28 and G30, as bits of positions.
pub fn offsets<const AXES: usize>(offsets: &StoredOffsets<AXES>) -> Option<Content> {
    let mut content = Content::new();
    for position in offsets.zero.iter().chain(&offsets.places).flatten() {
        content.extend_from_slice(&position.to_bits().to_le_bytes()).ok()?;
    }
    Some(content)
}

/// Reads the offsets, if their number fits this machine and all are in range.
pub fn read_offsets<const AXES: usize>(bytes: &[u8]) -> Option<StoredOffsets<AXES>> {
    let mut offsets = StoredOffsets::ZERO;
    let mut words = bytes.chunks_exact(8);
    for position in offsets.zero.iter_mut().chain(&mut offsets.places).flatten() {
        *position = Position::from_bits(i64::from_le_bytes(*words.next()?.first_chunk()?));
    }
    (words.next().is_none() && words.remainder().is_empty() && offsets.is_in_range()).then_some(offsets)
}

/// Each text, after a byte with its length.
pub fn texts(startup: [&[u8]; 2], info: &[u8]) -> Option<Content> {
    let mut content = Content::new();
    let [first, second] = startup;
    for text in [first, second, info] {
        content
            .push(u8::try_from(text.len()).ok().filter(|length| usize::from(*length) <= STORED_BYTES)?)
            .ok()?;
        content.extend_from_slice(text).ok()?;
    }
    Some(content)
}

/// Startup lines and the text of `$I`.
pub fn read_texts(mut bytes: &[u8]) -> Option<[Stored; 3]> {
    let mut texts = [const { Stored::new() }; 3];
    for text in &mut texts {
        let (length, rest) = bytes.split_first()?;
        let (this, rest) = rest.split_at_checked(usize::from(*length))?;
        *text = Stored::from_slice(this).ok()?;
        bytes = rest;
    }
    bytes.is_empty().then_some(texts)
}
