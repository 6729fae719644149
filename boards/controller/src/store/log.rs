//! Stores records in flash memory so that a power cut at any moment loses at most the record that is being
//! written.
//!
//! The memory has two halves, of which one is active. The first slot of the active half has a valid head with
//! a generation, a number that grows with each change of the active half. If both halves have a valid head,
//! the half with the higher generation is active.
//!
//! ```text
//!  half:  [ head | record | record | record | blank | blank ]    slots of equal size
//! ```
//!
//! A new record goes into the first slot after the last slot that is not blank. A record is valid if its
//! checksum is right. The last valid record of a kind counts. If a power cut interrupts a write, the new
//! record is not valid, so the record before it still counts.
//!
//! If no slot is left, the other half is erased and gets one record of each kind. Its head is written last,
//! so the old half stays active until then. The checksum of a record covers the generation, so what an
//! interrupted erase leaves is not valid.
use embedded_storage::nor_flash::NorFlash;

/// Bytes of the head of a record.
const HEAD: usize = 16;

/// First bytes of a record.
const MAGIC: [u8; 2] = *b"GP";

/// The kind of the first slot of a half.
const HALF: u8 = 0;

/// Kinds of the other records: 1…3.
pub const KINDS: usize = 3;

/// Bytes of the longest record with its head.
pub const LONGEST: usize = 1024;

/// Highest length of a flash word, in bytes.
const LONGEST_WORD: usize = 32;

/// Number of attempts in other slots if the memory does not keep a record.
const ATTEMPTS: u8 = 3;

/// Why a memory cannot hold the store.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Unfit {
    /// The words of the memory are longer than 32 bytes, or their length is no power of two.
    Word,
    /// The memory does not have two halves of whole erase blocks, with room for eight records each.
    Size,
    /// The memory cannot be read.
    Unreadable,
}

/// The memory does not take a record.
pub struct Failed;

/// A valid record: its version and the bytes of its content.
#[derive(Clone, Copy)]
pub struct Found {
    pub version: u8,
    pub length: usize,
}

/// The active half.
#[derive(Clone, Copy)]
struct Active {
    half: u32,
    generation: u32,
    /// First slot of the blank slots at the end.
    next: u32,
    /// Slots of the valid records, by kind - 1.
    slots: [Option<u32>; KINDS],
}

/// Records in a flash memory.
pub struct Log<F> {
    flash: F,
    slot_bytes: u32,
    slots: u32,
    half_bytes: u32,
    active: Option<Active>,
    buffer: [u8; LONGEST],
}

impl<F: NorFlash> Log<F> {
    /// Opens a memory for records with at most `content` bytes. A memory without records is empty.
    pub fn open(flash: F, content: usize) -> Result<Self, Unfit> {
        if F::WRITE_SIZE > LONGEST_WORD || !F::WRITE_SIZE.is_power_of_two() || F::READ_SIZE > LONGEST_WORD {
            return Err(Unfit::Word);
        }
        let slot_bytes = (HEAD + content).next_power_of_two().max(LONGEST_WORD);
        let half_bytes = flash.capacity() / 2;
        let is_whole = half_bytes.checked_rem(F::ERASE_SIZE) == Some(0);
        let slots = half_bytes.checked_div(slot_bytes).unwrap_or(0);
        if slot_bytes > LONGEST || !is_whole || slots < 8 || half_bytes > 1 << 30 {
            return Err(Unfit::Size);
        }
        let [slot_bytes, slots, half_bytes] = [slot_bytes, slots, half_bytes].map(|size| size as u32);
        let mut log = Self { flash, slot_bytes, slots, half_bytes, active: None, buffer: [0; LONGEST] };
        log.active = log.find_active()?;
        Ok(log)
    }

    /// Returns the memory.
    pub fn into_flash(self) -> F {
        self.flash
    }

    fn place(&self, half: u32, slot: u32) -> u32 {
        half * self.half_bytes + slot * self.slot_bytes
    }

    /// Reads a slot into the buffer.
    fn read(&mut self, half: u32, slot: u32) -> Result<&mut [u8], Unfit> {
        let place = self.place(half, slot);
        let bytes = self.buffer.get_mut(..self.slot_bytes as usize).ok_or(Unfit::Size)?;
        self.flash.read(place, bytes).map_err(|_| Unfit::Unreadable)?;
        Ok(bytes)
    }

    fn find_active(&mut self) -> Result<Option<Active>, Unfit> {
        let mut found: Option<(u32, u32)> = None;
        for half in [0, 1] {
            if let Some(generation) = generation_of(self.read(half, 0)?)
                && found.is_none_or(|(_, other)| generation.wrapping_sub(other) as i32 > 0)
            {
                found = Some((half, generation));
            }
        }
        let Some((half, generation)) = found else { return Ok(None) };
        let mut active = Active { half, generation, next: 1, slots: [None; KINDS] };
        for slot in 1..self.slots {
            let bytes = self.read(half, slot)?;
            if let Some((kind, _)) = valid(bytes, generation) {
                if let Some(place) = active.slots.get_mut(usize::from(kind).wrapping_sub(1)) {
                    *place = Some(slot);
                }
                active.next = slot + 1;
            } else if bytes.iter().any(|byte| *byte != 0xff) {
                active.next = slot + 1;
            }
        }
        Ok(Some(active))
    }

    /// Where the memory has bytes that are no whole record: the offset of the first such slot. A memory whose changes are
    /// whole has none, wherever power is cut. In other memories a power cut leaves some.
    pub fn damage(&mut self) -> Result<Option<u32>, Unfit> {
        let (active, generation) = match self.active {
            Some(active) => (Some(active.half), active.generation),
            // Of the first change, which was cut.
            None => (None, 0),
        };
        for half in [0, 1] {
            // The other half may keep anything behind its head: it is erased before it counts.
            let slots = if active.is_some_and(|active| active != half) { 1 } else { self.slots };
            for slot in 0..slots {
                let place = self.place(half, slot);
                let bytes = self.read(half, slot)?;
                let is_blank = bytes.iter().all(|byte| *byte == 0xff);
                let is_whole = match slot {
                    0 => generation_of(bytes).is_some(),
                    _ => valid(bytes, generation).is_some(),
                };
                if !is_blank && !is_whole {
                    return Ok(Some(place));
                }
            }
        }
        Ok(None)
    }

    /// Whether there is a record of a kind, 1…3.
    pub fn has(&self, kind: u8) -> bool {
        let slot =
            self.active.and_then(|active| active.slots.get(usize::from(kind).wrapping_sub(1)).copied());
        slot.flatten().is_some()
    }

    /// The record of a kind, 1…3: its version and its content.
    pub fn get(&mut self, kind: u8) -> Option<(u8, &[u8])> {
        let Active { half, generation, slots, .. } = self.active?;
        let slot = (*slots.get(usize::from(kind).wrapping_sub(1))?)?;
        let bytes = self.read(half, slot).ok()?;
        let (_, found) = valid(bytes, generation)?;
        Some((found.version, bytes.get(HEAD..HEAD + found.length)?))
    }

    /// Writes a record. Until the new record is complete, the old one counts.
    pub fn put(&mut self, kind: u8, version: u8, content: &[u8]) -> Result<(), Failed> {
        for _ in 0..ATTEMPTS {
            let written = match self.active {
                Some(active) if active.next < self.slots => self.append(active, kind, version, content),
                _ => self.renew(kind, version, content),
            };
            if written.is_ok() {
                return Ok(());
            }
        }
        Err(Failed)
    }

    fn append(&mut self, active: Active, kind: u8, version: u8, content: &[u8]) -> Result<(), Failed> {
        let Active { half, generation, next, mut slots } = active;
        // From here on this slot is not blank, even if the write fails.
        self.active = Some(Active { next: next + 1, ..active });
        self.write(half, next, Label { kind, version, generation }, content)?;
        *slots.get_mut(usize::from(kind).wrapping_sub(1)).ok_or(Failed)? = Some(next);
        self.active = Some(Active { next: next + 1, slots, ..active });
        Ok(())
    }

    /// Makes the other half the active one, with one record of each kind.
    fn renew(&mut self, kind: u8, version: u8, content: &[u8]) -> Result<(), Failed> {
        let old = self.active;
        let half = old.map_or(0, |old| 1 - old.half);
        let generation = old.map_or(0, |old| old.generation.wrapping_add(1));
        let from = half * self.half_bytes;
        self.flash.erase(from, from + self.half_bytes).map_err(|_| Failed)?;
        let mut active = Active { half, generation, next: 1, slots: [None; KINDS] };
        for (slot, other) in active.slots.iter_mut().zip(1..) {
            let next = active.next;
            if other == kind {
                self.write(half, next, Label { kind, version, generation }, content)?;
            } else if !self.copy(old, other, (half, next, generation))? {
                continue;
            }
            *slot = Some(next);
            active.next = next + 1;
        }
        self.write(half, 0, Label { kind: HALF, version: 0, generation }, &[])?;
        self.active = Some(active);
        Ok(())
    }

    /// Copies the record of a kind to the new half. Returns whether such a record exists.
    fn copy(&mut self, old: Option<Active>, kind: u8, to: (u32, u32, u32)) -> Result<bool, Failed> {
        let slot = old.and_then(|old| Some((old, (*old.slots.get(usize::from(kind).wrapping_sub(1))?)?)));
        let Some((old, slot)) = slot else { return Ok(false) };
        let (half, next, generation) = to;
        let bytes = self.read(old.half, slot).map_err(|_| Failed)?;
        // The record was valid when the memory was opened. If it is no longer valid, the call fails, so that
        // the record is not lost.
        let (_, found) = valid(bytes, old.generation).ok_or(Failed)?;
        label(bytes, Label { kind, version: found.version, generation }, found.length).ok_or(Failed)?;
        self.write_buffer(half, next, found.length)?;
        Ok(true)
    }

    fn write(&mut self, half: u32, slot: u32, name: Label, content: &[u8]) -> Result<(), Failed> {
        self.buffer.fill(0xff);
        let room = self.buffer.get_mut(HEAD..HEAD + content.len()).ok_or(Failed)?;
        room.copy_from_slice(content);
        label(&mut self.buffer, name, content.len()).ok_or(Failed)?;
        self.write_buffer(half, slot, content.len())
    }

    /// Writes the record in the buffer, and compares the memory with it.
    fn write_buffer(&mut self, half: u32, slot: u32, length: usize) -> Result<(), Failed> {
        let place = self.place(half, slot);
        let whole = (HEAD + length).next_multiple_of(F::WRITE_SIZE.max(1));
        let bytes = self.buffer.get(..whole).ok_or(Failed)?;
        let sum = check_sum(bytes);
        self.flash.write(place, bytes).map_err(|_| Failed)?;
        let bytes = self.read(half, slot).map_err(|_| Failed)?;
        let (bytes, rest) = bytes.split_at_checked(whole).ok_or(Failed)?;
        let is_kept = check_sum(bytes) == sum && rest.iter().all(|byte| *byte == 0xff);
        if is_kept { Ok(()) } else { Err(Failed) }
    }
}

/// Fields in the head of a record.
#[derive(Clone, Copy)]
struct Label {
    kind: u8,
    version: u8,
    generation: u32,
}

/// Writes the head of a record whose content is in place.
fn label(bytes: &mut [u8], label: Label, length: usize) -> Option<()> {
    let Label { kind, version, generation } = label;
    let (head, rest) = bytes.split_at_mut_checked(HEAD)?;
    let [first, second] = MAGIC;
    let [g0, g1, g2, g3] = generation.to_le_bytes();
    let [l0, l1] = u16::try_from(length).ok()?.to_le_bytes();
    let words = [first, second, kind, version, g0, g1, g2, g3, l0, l1, 0, 0];
    let sum = finish(add(add(START, &words), rest.get(..length)?)).to_le_bytes();
    for (to, from) in head.iter_mut().zip(words.into_iter().chain(sum)) {
        *to = from;
    }
    Some(())
}

/// Kind and content of a record, if its checksum is right.
fn valid(bytes: &[u8], generation: u32) -> Option<(u8, Found)> {
    let (head, rest) = bytes.split_at_checked(HEAD)?;
    let (words, sum) = head.split_at_checked(HEAD - 4)?;
    let [first, second, kind, version, g0, g1, g2, g3, l0, l1, 0, 0] = *words else { return None };
    let length = usize::from(u16::from_le_bytes([l0, l1]));
    let is_this = [first, second] == MAGIC && u32::from_le_bytes([g0, g1, g2, g3]) == generation;
    let is_right = is_this && finish(add(add(START, words), rest.get(..length)?)).to_le_bytes() == *sum;
    is_right.then_some((kind, Found { version, length }))
}

/// Generation of a half, from its first slot.
fn generation_of(bytes: &[u8]) -> Option<u32> {
    let generation = u32::from_le_bytes(*bytes.get(4..)?.first_chunk()?);
    matches!(valid(bytes, generation)?, (HALF, Found { length: 0, .. })).then_some(generation)
}

/// CRC-32 (polynomial 0xedb88320, reflected), four bits at a time: the table is small, and speed does not
/// matter here.
const START: u32 = u32::MAX;

static TABLE: [u32; 16] = {
    let mut table = [0; 16];
    let mut nibble = 0;
    while nibble < 16 {
        let mut crc = nibble as u32;
        let mut bit = 0;
        while bit < 4 {
            crc = if crc & 1 == 0 { crc >> 1 } else { (crc >> 1) ^ 0xedb8_8320 };
            bit += 1;
        }
        table[nibble] = crc;
        nibble += 1;
    }
    table
};

fn add(mut crc: u32, bytes: &[u8]) -> u32 {
    for byte in bytes {
        for nibble in [byte & 15, byte >> 4] {
            let entry = TABLE.get(((crc ^ u32::from(nibble)) & 15) as usize).copied().unwrap_or(0);
            crc = (crc >> 4) ^ entry;
        }
    }
    crc
}

const fn finish(crc: u32) -> u32 {
    !crc
}

fn check_sum(bytes: &[u8]) -> u32 {
    finish(add(START, bytes))
}

#[cfg(test)]
mod tests {
    /// The check value of this CRC in published catalogues.
    #[test]
    fn check_value() {
        assert_eq!(super::check_sum(b"123456789"), 0xcbf4_3926);
    }
}
