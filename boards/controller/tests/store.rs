//! The parameter store: power cuts at every word, and the data that the controller keeps over a restart.
mod bench;

use bench::corruption::Random;
use bench::world::{World, mm, settings, with_store};
use bench::{AXES, fresh_seed, names};
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use glidepath::nc::StoredOffsets;
use glidepath::quantity::Position;
use glidepath_controller::store::{MemoryFlash, Parameters, Store, Unfit};
use glidepath_controller::{Config, Settings, Stored};

/// Bytes of a word.
const WORD: usize = 4;

/// Parts in which an erase block is erased: a cut leaves some of them as they were.
const PARTS: usize = 4;

/// Flash memory whose power goes after so many words and parts of erase blocks. What is under way then is torn: each bit
/// of it may have changed or not.
#[derive(Clone)]
struct Flash<const BLOCK: usize> {
    bytes: Vec<u8>,
    /// Changes until power goes; `None`: it has gone.
    left: Option<u32>,
    random: Random,
}

#[derive(Debug)]
struct Off;

impl NorFlashError for Off {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl<const BLOCK: usize> Flash<BLOCK> {
    fn new(seed: u64) -> Self {
        Self { bytes: vec![0xff; 2 * BLOCK], left: Some(u32::MAX), random: Random(seed) }
    }

    /// Changes bytes in one go, or tears them where power goes.
    fn change(&mut self, at: usize, to: &[u8]) -> Result<(), Off> {
        let left = self.left.ok_or(Off)?;
        for (byte, to) in self.bytes[at..].iter_mut().zip(to) {
            let changed = if left == 0 { self.random.next() as u8 } else { 0xff };
            *byte = (*byte & !changed) | (to & changed);
        }
        self.left = left.checked_sub(1);
        self.left.map(|_| ()).ok_or(Off)
    }
}

impl<const BLOCK: usize> ErrorType for Flash<BLOCK> {
    type Error = Off;
}

impl<const BLOCK: usize> ReadNorFlash for Flash<BLOCK> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Off> {
        let from = offset as usize;
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl<const BLOCK: usize> NorFlash for Flash<BLOCK> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = BLOCK;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Off> {
        assert!((from as usize).is_multiple_of(BLOCK) && (to as usize).is_multiple_of(BLOCK));
        let part = BLOCK / PARTS;
        (from as usize..to as usize).step_by(part).try_for_each(|at| self.change(at, &vec![0xff; part]))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Off> {
        assert!((offset as usize).is_multiple_of(WORD) && bytes.len().is_multiple_of(WORD));
        bytes.chunks(WORD).zip((offset as usize..).step_by(WORD)).try_for_each(|(word, at)| {
            let blank = [0xff; WORD];
            assert_eq!(self.bytes[at..at + WORD], blank, "a word is written twice without an erase");
            self.change(at, word)
        })
    }
}

/// All three sets.
#[derive(Clone, PartialEq, Debug)]
struct Sets {
    settings: Settings<AXES>,
    offsets: StoredOffsets<AXES>,
    texts: [Stored; 3],
}

impl Sets {
    fn new() -> Self {
        let texts = [const { Stored::new() }; 3];
        Self { settings: Settings::new(), offsets: StoredOffsets::ZERO, texts }
    }

    /// What a store that is opened now holds.
    fn read<F: NorFlash>(flash: F) -> (Self, Parameters<F, AXES>) {
        let mut store = Parameters::open(flash).expect("large enough");
        let mut config = Config::new(names());
        let offsets = store.load(&mut config);
        assert_eq!(config.notice, "");
        let Config { settings, startup: [first, second], info, .. } = config;
        (Self { settings, offsets, texts: [first, second, info] }, store)
    }

    /// Another value in every place of a set.
    fn change(&mut self, set: u8, random: &mut Random) {
        match set {
            0 => {
                let settings = &mut self.settings;
                settings.pulse_us = 3 + random.below(250) as u8;
                settings.idle_ms = random.next() as u8;
                settings.hard_limits = random.below(2) == 0;
                settings.limits_cut_steps = settings.hard_limits && random.below(2) == 0;
                settings.junction_milli = random.next() as u32;
                settings.pull_off_milli = random.next() as u32;
                for axis in &mut settings.axes {
                    axis.rate_milli = 1_000_000 + random.below(1_000_000) as u32;
                    axis.accel_milli = 1_000_000 + random.below(1_000_000) as u32;
                    axis.travel_milli = random.below(1_000_000) as u32;
                    axis.counts_milli = 1 + random.below(1_000_000) as u32;
                }
            }
            1 => {
                let offsets = &mut self.offsets;
                for place in offsets.zero.iter_mut().chain(&mut offsets.places).flatten() {
                    *place = Position::from_bits(random.next() as i64 >> 12);
                }
            }
            _ => {
                for text in &mut self.texts {
                    let length = random.below(81) as usize;
                    *text = (0..length).map(|_| b' ' + random.below(95) as u8).collect();
                }
            }
        }
    }

    fn write<F: NorFlash>(&self, set: u8, store: &mut Parameters<F, AXES>) -> bool {
        match set {
            0 => store.settings(&self.settings),
            1 => store.offsets(&self.offsets),
            _ => store.texts([&self.texts[0], &self.texts[1]], &self.texts[2]),
        }
    }
}

/// So many updates of each set in random order; each is cut at every word that it writes and every part that it erases.
/// Number of cuts, and of those that left the new set.
fn cut<const BLOCK: usize>(updates: u32, seed: u64) -> (u32, u32) {
    let mut random = Random(seed);
    let (mut flash, mut sets) = (Flash::<BLOCK>::new(seed), Sets::new());
    let mut left = [updates; 3];
    let (mut cuts, mut new) = (0, 0);
    while left != [0; 3] {
        let set = random.below(3) as u8;
        if left[usize::from(set)] == 0 {
            continue;
        }
        left[usize::from(set)] -= 1;
        let mut changed = sets.clone();
        changed.change(set, &mut random);
        for words in 0.. {
            let mut torn = flash.clone();
            (torn.left, torn.random) = (Some(words), Random(random.next()));
            let (before, mut store) = Sets::read(torn);
            assert_eq!(before, sets, "seed {seed}");
            if changed.write(set, &mut store) {
                let mut whole = store.into_flash();
                whole.left = Some(u32::MAX);
                flash = whole;
                break;
            }
            cuts += 1;
            let mut torn = store.into_flash();
            torn.left = Some(u32::MAX);
            let (found, mut store) = Sets::read(torn);
            assert!(found == sets || found == changed, "seed {seed}: mixed or lost behind {words} words");
            new += u32::from(found == changed);
            // It works on.
            let mut next = found;
            next.change(2 - set, &mut random);
            assert!(next.write(2 - set, &mut store), "seed {seed}");
            assert_eq!(Sets::read(store.into_flash()).0, next, "seed {seed}");
        }
        sets = changed;
        assert_eq!(Sets::read(flash.clone()).0, sets, "seed {seed}");
    }
    (cuts, new)
}

#[test]
fn a_power_cut_leaves_the_old_set_or_the_new_one() {
    for seed in [1, 2, fresh_seed()] {
        let (cuts, _) = cut::<4096>(15, seed);
        assert!(cuts > 1500, "{cuts}");
    }
}

/// 1,000 updates of each set, cut at every word: some 170,000 cuts in half a minute.
#[test]
#[ignore = "half a minute"]
fn a_power_cut_leaves_the_old_set_or_the_new_one_long() {
    let seed = fresh_seed();
    let (cuts, new) = cut::<4096>(1000, seed);
    println!("{cuts} cuts, {new} of them left the new set");
    assert!(cuts >= 100_000, "{cuts}");
    let (cuts, new) = cut::<16_384>(100, seed);
    println!("{cuts} cuts with halves of 16 KiB, {new} of them left the new set");
}

/// Cuts one behind the other, never a whole update: the sets stay.
#[test]
fn many_cuts_in_a_row_lose_nothing() {
    let seed = fresh_seed();
    let mut random = Random(seed);
    let mut flash = Flash::<4096>::new(seed);
    let mut sets = Sets::new();
    for _ in 0..3000 {
        let set = random.below(3) as u8;
        let mut changed = sets.clone();
        changed.change(set, &mut random);
        flash.left = Some(random.below(40) as u32);
        let (before, mut store) = Sets::read(flash);
        assert_eq!(before, sets, "seed {seed}");
        changed.write(set, &mut store);
        flash = store.into_flash();
        flash.left = Some(u32::MAX);
        let (found, store) = Sets::read(flash);
        flash = store.into_flash();
        assert!(found == sets || found == changed, "seed {seed}");
        sets = found;
    }
}

#[test]
fn a_memory_that_is_too_small_is_refused() {
    let open = |flash: MemoryFlash<4096>| Parameters::<_, AXES>::open(flash).err();
    assert_eq!(open(MemoryFlash::new()), Some(Unfit::Size));
    assert_eq!(Parameters::<_, AXES>::open(MemoryFlash::<8192>::new()).err(), None);
    assert_eq!(Parameters::<_, 8>::open(MemoryFlash::<8192>::new()).err(), Some(Unfit::Size));
    assert_eq!(Parameters::<_, 8>::open(MemoryFlash::<16_384>::new()).err(), None);
}

/// A memory full of something else is one without records.
#[test]
fn a_memory_with_other_content_is_empty() {
    let mut random = Random(7);
    let mut flash = MemoryFlash::<8192>::new();
    flash.0.fill_with(|| random.next() as u8);
    let (mut sets, mut store) = Sets::read(flash);
    assert_eq!(sets, Sets::new());
    sets.change(0, &mut random);
    assert!(sets.write(0, &mut store));
    assert_eq!(Sets::read(store.into_flash()).0, sets);
}

/// The sets of a machine with other axes are told, and not taken.
#[test]
fn sets_of_another_machine_are_told() {
    let mut store = Parameters::<_, 2>::open(MemoryFlash::<8192>::new()).expect("large enough");
    assert!(store.offsets(&StoredOffsets::ZERO));
    assert!(store.settings(&Settings::new()));
    let mut four = Parameters::<_, 4>::open(store.into_flash()).expect("large enough");
    assert!(four.settings(&Settings::new()));
    let mut store = Parameters::<_, AXES>::open(four.into_flash()).expect("large enough");
    let mut config = Config::new(names());
    assert_eq!(store.load(&mut config), StoredOffsets::ZERO);
    assert_eq!(config.notice, "stored settings, work offsets cannot be read: defaults are in force");
    assert_eq!(config.settings, Settings::new());
}

/// A conversation, power off, and another one with the same memory.
#[test]
fn what_is_stored_outlives_a_restart() {
    let mut config = Config::new(names());
    (config.settings, config.defaults) = (settings(), settings());
    let flash = with_store(config.clone(), MemoryFlash::new(), World::new(1), |rig| {
        for line in ["$0=5", "$110=5000", "$I=MILL", "$N1=G55", "G10L2P2X1Y2Z3", "G0X4", "G4P0", "G28.1"] {
            assert_eq!(rig.ask(line), "ok\n", "{line}");
        }
        // In motion it is stored at the next standstill.
        rig.send("G1F600X4.5\nG10L2P3Z-1\n");
        rig.ticks(3);
        rig.until("Idle");
        std::mem::replace(&mut rig.store, Parameters::open(MemoryFlash::new()).expect("large enough"))
            .into_flash()
    });
    let flash = with_store(config.clone(), flash, World::new(1), |rig| {
        assert_eq!(rig.banner, "\r\nGrbl 1.1h ['$' for help]\r\n>G55:ok\r\n");
        let said = rig.ask("$#");
        for line in ["[G55:1.000,2.000,3.000]", "[G56:0.000,0.000,-1.000]", "[G28:4.000,0.000,0.000]"] {
            assert!(said.contains(line), "{line}: {said}");
        }
        let said = rig.ask("$$");
        assert!(said.contains("$0=5\n") && said.contains("$110=5000.000\n"), "{said}");
        assert!(rig.ask("$I").starts_with("[VER:1.1h.20190825:MILL]\n"));
        for line in ["$RST=#", "$RST=$"] {
            assert!(rig.ask(line).starts_with("[MSG:Restoring defaults]\n"));
            rig.ticks(5);
            rig.read();
        }
        std::mem::replace(&mut rig.store, Parameters::open(MemoryFlash::new()).expect("large enough"))
            .into_flash()
    });
    let flash = with_store(config.clone(), flash, World::new(1), |rig| {
        let said = rig.ask("$#");
        assert!(
            said.contains("[G55:0.000,0.000,0.000]") && said.contains("[G28:0.000,0.000,0.000]"),
            "{said}"
        );
        let said = rig.ask("$$");
        assert!(said.contains("$0=10\n") && said.contains("$110=6000.000\n"), "{said}");
        assert!(rig.ask("$N").contains("$N1=G55\n"));
        assert!(rig.ask("$RST=*").starts_with("[MSG:Restoring defaults]\n"));
        std::mem::replace(&mut rig.store, Parameters::open(MemoryFlash::new()).expect("large enough"))
            .into_flash()
    });
    with_store(config, flash, World::new(1), |rig| {
        assert_eq!(rig.ask("$N"), "$N0=\n$N1=\nok\n");
        assert!(rig.ask("$I").starts_with("[VER:1.1h.20190825:]\n"));
        assert_eq!(rig.points, [mm(0.0); AXES]);
    });
}

/// The same sets in a file, which is opened again.
#[cfg(feature = "file")]
#[test]
fn a_file_keeps_the_sets() {
    use glidepath_controller::store::FileFlash;
    let path = std::env::temp_dir().join(format!("glidepath-store-{}", std::process::id()));
    let mut random = Random(fresh_seed());
    let mut sets = Sets::new();
    for round in 0..40 {
        let (found, mut store) = Sets::read(FileFlash::open(&path).expect("a file"));
        assert_eq!(found, sets, "round {round}");
        assert_eq!(store.damage(), Ok(None));
        assert!(FileFlash::open(&path).is_err(), "two have the file at the same time");
        let set = random.below(3) as u8;
        sets.change(set, &mut random);
        assert!(sets.write(set, &mut store));
    }
    for length in [1, 4096, 8191, 8193, 9000] {
        std::fs::write(&path, vec![0; length]).expect("a file");
        assert!(FileFlash::open(&path).is_err(), "{length}");
    }
    std::fs::remove_file(&path).expect("a file");
}

/// A changed bit in any byte of a store that was written whole is damage, or lies behind what counts.
#[test]
fn a_changed_bit_is_damage() {
    let mut random = Random(fresh_seed());
    let mut store = Parameters::open(MemoryFlash::<8192>::new()).expect("large enough");
    let mut sets = Sets::new();
    for change in 0..12 {
        assert_eq!(store.damage(), Ok(None));
        sets.change(change % 3, &mut random);
        assert!(sets.write(change % 3, &mut store));
    }
    let flash = store.into_flash();
    let found = |flash: &MemoryFlash<8192>| {
        let mut store = Parameters::<_, AXES>::open(flash.clone()).expect("large enough");
        (store.damage().expect("readable"), store.load(&mut Config::new(names())))
    };
    assert_eq!(found(&flash).0, None);
    for byte in 0..8192 {
        let bit = random.below(8);
        let mut changed = flash.clone();
        changed.0[byte] ^= 1 << bit;
        let (damage, offsets) = found(&changed);
        assert!(damage.is_some() || offsets == sets.offsets, "bit {bit} of byte {byte}");
    }
    // A file of another program.
    let text = MemoryFlash(std::array::from_fn(|at| b"G1 X1\n"[at % 6]));
    assert_eq!(found(&text).0, Some(0));
}

/// Where power is cut between two changes of a memory that takes each change whole, nothing is damaged.
#[test]
fn whole_changes_leave_no_damage() {
    let mut random = Random(fresh_seed());
    for cut in 0..60 {
        let mut store =
            Parameters::open(Whole { bytes: MemoryFlash::new(), left: cut }).expect("large enough");
        let mut sets = Sets::new();
        while store.damage() == Ok(None) && {
            sets.change(random.below(3) as u8, &mut random);
            sets.write(random.below(3) as u8, &mut store)
        } {}
        let mut after = Parameters::<_, AXES>::open(store.into_flash().bytes).expect("large enough");
        assert_eq!(after.damage(), Ok(None), "cut {cut}");
    }
}

/// Takes so many changes, each of them whole.
struct Whole {
    bytes: MemoryFlash<8192>,
    left: u32,
}

impl ErrorType for Whole {
    type Error = Off;
}

impl ReadNorFlash for Whole {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Off> {
        self.bytes.read(offset, bytes).map_err(|_| Off)
    }

    fn capacity(&self) -> usize {
        self.bytes.capacity()
    }
}

impl NorFlash for Whole {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 4096;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Off> {
        self.left = self.left.checked_sub(1).ok_or(Off)?;
        self.bytes.erase(from, to).map_err(|_| Off)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Off> {
        self.left = self.left.checked_sub(1).ok_or(Off)?;
        self.bytes.write(offset, bytes).map_err(|_| Off)
    }
}
