//! How an M or H function is synchronised with the motion: P-CHAN-00041 `m_synch[n]`, P-CHAN-00027
//! `h_synch[n]`.

/// The point at which a function is output, and the point at which the function must be acknowledged. The motion waits
/// at the second point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Synch {
    /// NO_SYNCH: no output.
    NoSynch,
    /// MOS: output without acknowledgement.
    Mos,
    /// MVS_SVS: output before the motion of its block; the motion begins after the acknowledgement.
    MvsSvs,
    /// MVS_SNS: output before the motion of its block, acknowledged before the next motion.
    MvsSns,
    /// MNS_SNS: output after the motion of its block, acknowledged before the next motion.
    MnsSns,
    /// MNE_SNS: output at a measuring event.
    MneSns,
    /// MVS_SLM: output before the motion of its block, acknowledged before the next motion at feed (feature
    /// `plc`).
    MvsSlm,
    /// MVS_SLP: output before the motion of its block, acknowledged before the motion after #EXPL SYN
    /// (feature `plc`).
    MvsSlp,
    /// MOS_TS: output at a time before or after the motion.
    MosTs,
    /// BWD_SYNCH: acknowledged in backward motion too.
    BwdSynch,
    /// FWD_SYNCH: acknowledged in simulated forward motion too.
    FwdSynch,
    /// MEP_SVS: output before its place, at the distance of `SynchTable::with_shift`. The motion waits for
    /// the acknowledgement at the place itself, before the motion of its block (feature `plc`,
    /// FCT_SHIFT_NCBL).
    MepSvs,
    /// MEP_MOS: output as MEP_SVS, without acknowledgement (FCT_SHIFT_NCBL).
    #[cfg(feature = "plc")]
    MepMos,
    /// MET_SVS: output a programmed time before its place.
    MetSvs,
    /// FAW_SYNCH: the decoder waits too. A function has this kind in addition to another one:
    /// `SynchTable::with_flush`.
    FawSynch,
}

impl Synch {
    /// All kinds, with name and value in an ISG parameter list.
    pub const ALL: [(Self, &'static str, u32); 14 + cfg!(feature = "plc") as usize] = [
        (Self::NoSynch, "NO_SYNCH", 0),
        (Self::Mos, "MOS", 0x1),
        (Self::MvsSvs, "MVS_SVS", 0x2),
        (Self::MvsSns, "MVS_SNS", 0x4),
        (Self::MnsSns, "MNS_SNS", 0x8),
        (Self::MneSns, "MNE_SNS", 0x20),
        (Self::MvsSlm, "MVS_SLM", 0x4000),
        (Self::MvsSlp, "MVS_SLP", 0x8000),
        (Self::MosTs, "MOS_TS", 0x4_0000),
        (Self::BwdSynch, "BWD_SYNCH", 0x40_0000),
        (Self::FwdSynch, "FWD_SYNCH", 0x80_0000),
        (Self::MepSvs, "MEP_SVS", 0x100_0000),
        #[cfg(feature = "plc")]
        (Self::MepMos, "MEP_MOS", 0x10_0000),
        (Self::MetSvs, "MET_SVS", 0x200_0000),
        (Self::FawSynch, "FAW_SYNCH", 0x1000_0000),
    ];

    /// The name that ISG uses.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(synch, ..)| *synch == self).map_or("", |(_, name, _)| name)
    }

    /// Whether Glidepath supports this kind.
    pub const fn is_available(self) -> bool {
        matches!(self, Self::NoSynch | Self::Mos | Self::MvsSvs | Self::MvsSns | Self::MnsSns)
            || (cfg!(feature = "plc") && (self.is_late() || self.is_shifted()))
    }

    /// Whether the function is output at a distance before its place: `SynchTable::with_shift`.
    pub const fn is_shifted(self) -> bool {
        #[cfg(feature = "plc")]
        if matches!(self, Self::MepMos) {
            return true;
        }
        matches!(self, Self::MepSvs)
    }

    /// Whether a later word of the program decides where the acknowledgement is needed.
    pub const fn is_late(self) -> bool {
        matches!(self, Self::MvsSlm | Self::MvsSlp)
    }

    /// Whether #EXPL SYN decides where the acknowledgement is needed.
    pub const fn is_explicit(self) -> bool {
        matches!(self, Self::MvsSlp)
    }

    /// Whether the function is output before the motion of its block.
    pub const fn is_before(self) -> bool {
        matches!(self, Self::MvsSvs | Self::MvsSns)
            || (cfg!(feature = "plc") && (self.is_late() || self.is_shifted()))
    }

    /// Whether the motion waits for an acknowledgement.
    pub const fn waits(self) -> bool {
        matches!(self, Self::MvsSvs | Self::MvsSns | Self::MnsSns)
            || (cfg!(feature = "plc") && (self.is_late() || matches!(self, Self::MepSvs)))
    }
}

/// Largest shift of a function, 0.1 µm: 200 m.
#[cfg(feature = "plc")]
pub const SHIFT_MAX: u32 = 2_000_000_000;

/// Number of functions that a table can hold.
pub const SYNCHRONISED: usize = 32;

/// The synchronisation of functions by their number. A function that is not in the table is [`Synch::Mos`].
///
/// ```
/// use glidepath::machine::{Synch, SynchTable};
/// const M_SYNCH: SynchTable = SynchTable::NONE.with(25, Synch::MvsSns).with(26, Synch::MvsSvs);
/// assert_eq!(M_SYNCH.of(26), Synch::MvsSvs);
/// assert_eq!(M_SYNCH.of(3), Synch::Mos);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SynchTable {
    // Codes and kinds are separate arrays: an array of pairs would be one quarter padding.
    codes: [u16; SYNCHRONISED],
    kinds: [Synch; SYNCHRONISED],
    len: u8,
    full: bool,
    /// FAW_SYNCH: one bit for each function of the table.
    #[cfg(feature = "plc")]
    flushes: u32,
    /// Shift of each function of the table (P-CHAN-00070, P-CHAN-00107), 0.1 µm.
    #[cfg(feature = "plc")]
    shifts: [u32; SYNCHRONISED],
}

impl SynchTable {
    /// An empty table with all bits zero.
    pub(crate) const BLANK: Self = Self {
        codes: [0; SYNCHRONISED],
        kinds: [Synch::NoSynch; SYNCHRONISED],
        len: 0,
        full: false,
        #[cfg(feature = "plc")]
        flushes: 0,
        #[cfg(feature = "plc")]
        shifts: [0; SYNCHRONISED],
    };

    /// An empty table.
    pub const NONE: Self = Self {
        codes: [0; SYNCHRONISED],
        kinds: [Synch::Mos; SYNCHRONISED],
        len: 0,
        full: false,
        #[cfg(feature = "plc")]
        flushes: 0,
        #[cfg(feature = "plc")]
        shifts: [0; SYNCHRONISED],
    };

    /// Adds function number `code` with its synchronisation. Machine data with more than [`SYNCHRONISED`]
    /// functions are refused.
    #[must_use]
    pub const fn with(mut self, code: u16, synch: Synch) -> Self {
        let len = self.len as usize;
        let mut k = 0;
        while k < len && k < SYNCHRONISED && self.codes[k] != code {
            k += 1;
        }
        if k < SYNCHRONISED {
            (self.codes[k], self.kinds[k]) = (code, synch);
            #[cfg(feature = "plc")]
            {
                self.flushes &= !(1 << k);
            }
            if k == len {
                self.len += 1;
            }
        } else {
            self.full = true;
        }
        self
    }

    /// As [`Self::with`], with FAW_SYNCH in addition: the program continues after the block of the function
    /// only when the motion has reached the function.
    #[cfg(feature = "plc")]
    #[must_use]
    pub const fn with_flush(mut self, code: u16, synch: Synch) -> Self {
        self = self.with(code, synch);
        let mut k = 0;
        while k < self.len as usize && k < SYNCHRONISED {
            if self.codes[k] == code {
                self.flushes |= 1 << k;
            }
            k += 1;
        }
        self
    }

    /// Sets P-CHAN-00070 `m_pre_outp[code]` or P-CHAN-00107 `h_pre_outp[code]` of function number `code`. The
    /// function is then output so many 0.1 µm of path before its place. Its kind must be [`Synch::MepSvs`] or
    /// [`Synch::MepMos`], and `shift` at most [`SHIFT_MAX`]; other kinds need 0.
    #[cfg(feature = "plc")]
    #[must_use]
    pub const fn with_shift(mut self, code: u16, shift: u32) -> Self {
        let len = self.len as usize;
        let mut k = 0;
        while k < len && self.codes[k] != code {
            k += 1;
        }
        if k == len {
            self = self.with(code, Synch::Mos);
        }
        if k < SYNCHRONISED {
            self.shifts[k] = shift;
        }
        self
    }

    /// The shift of function number `code`, 0.1 µm.
    #[cfg(feature = "plc")]
    pub fn shift(&self, code: u16) -> u32 {
        let at = self.entries().position(|entry| entry.0 == code);
        at.and_then(|k| self.shifts.get(k)).copied().unwrap_or(0)
    }

    /// Whether function number `code` has FAW_SYNCH.
    #[cfg(feature = "plc")]
    pub fn flushes(&self, code: u16) -> bool {
        let at = self.entries().position(|entry| entry.0 == code);
        at.is_some_and(|k| self.flushes & (1 << k) != 0)
    }

    /// The synchronisation of function number `code`.
    pub fn of(&self, code: u16) -> Synch {
        self.entries().find(|entry| entry.0 == code).map_or(Synch::Mos, |entry| entry.1)
    }

    /// Number and synchronisation of each function in the table.
    pub fn entries(&self) -> impl Iterator<Item = (u16, Synch)> {
        let kinds = self.kinds.iter().copied();
        self.codes.iter().copied().zip(kinds).take(self.len.into())
    }

    /// Whether more than [`SYNCHRONISED`] functions were added.
    pub const fn overflows(&self) -> bool {
        self.full
    }
}
