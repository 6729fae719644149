//! Writes answers as text: status, settings, offsets, modal words. Line ends are CR LF.
use crate::motion::{Modal, Motion, Offsets, Overrides, Spindle, Status};
use crate::number::{feed, position};
use crate::settings::Settings;
use crate::state::{Signals, State};
use core::fmt::{self, Write as _};
use glidepath::machine::AxisName;
use glidepath::quantity::Position;

/// The destination of answers. After an error of `out`, nothing more is written; [`Self::finish`] returns the
/// error.
pub struct Text<'w, W: embedded_io::Write> {
    out: &'w mut W,
    error: Option<W::Error>,
}

impl<'w, W: embedded_io::Write> Text<'w, W> {
    pub fn new(out: &'w mut W) -> Self {
        Self { out, error: None }
    }

    pub fn finish(self) -> Result<(), W::Error> {
        self.error.map_or(Ok(()), Err)
    }

    /// Writes text without a line end.
    pub fn part(&mut self, text: fmt::Arguments<'_>) {
        // `error` keeps a failure.
        let _ = self.write_fmt(text);
    }

    /// Writes a line.
    pub fn line(&mut self, text: fmt::Arguments<'_>) {
        self.part(text);
        self.part(format_args!("\r\n"));
    }

    /// Writes bytes of a received line: ASCII only.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.part(format_args!("{}", char::from(*byte & 0x7f)));
        }
    }
}

impl<W: embedded_io::Write> fmt::Write for Text<'_, W> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        if self.error.is_none()
            && let Err(error) = self.out.write_all(text.as_bytes())
        {
            self.error = Some(error);
        }
        Ok(())
    }
}

/// Positions of all axes, separated by commas.
struct Point<'a> {
    axes: &'a [Position],
    inch: bool,
}

impl fmt::Display for Point<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (axis, index) in self.axes.iter().zip(0..) {
            let comma = if index == 0 { "" } else { "," };
            write!(f, "{comma}{}", position(axis.to_bits(), self.inch))?;
        }
        Ok(())
    }
}

/// Number of reports until the next one with work offsets, or with overrides.
#[derive(Clone, Copy)]
pub struct Due {
    offsets: u8,
    overrides: u8,
}

/// Data of a report in addition to the status.
pub struct Shown<'a, const AXES: usize> {
    pub state: State,
    pub status: &'a Status<AXES>,
    pub offset: [Position; AXES],
    pub room: usize,
    pub signals: Signals,
    pub overrides: Overrides,
    pub names: &'a [AxisName; AXES],
    pub settings: &'a Settings<AXES>,
    /// Spindle speed with its override, as output.
    pub spindle: (Spindle, u32),
    pub mist: bool,
    pub flood: bool,
    pub line_numbers: bool,
}

impl Due {
    /// Work offsets and overrides appear in the next reports.
    pub const NOW: Self = Self { offsets: 0, overrides: 0 };

    /// Records that an offset has changed.
    pub fn offsets_changed(&mut self) {
        self.offsets = 0;
    }

    /// Records that an override or an output has changed.
    pub fn overrides_changed(&mut self) {
        self.overrides = 0;
    }

    /// Writes the status report.
    pub fn report<const AXES: usize, W: embedded_io::Write>(
        &mut self,
        out: &mut Text<'_, W>,
        shown: &Shown<'_, AXES>,
    ) {
        let Shown { state, status, offset, settings, .. } = shown;
        let inch = settings.inch;
        out.part(format_args!("<{state}|"));
        if settings.report_mask & 1 != 0 {
            out.part(format_args!("MPos:{}", Point { axes: &status.position, inch }));
        } else {
            let mut work = status.position;
            for (axis, offset) in work.iter_mut().zip(offset) {
                *axis = axis.saturating_sub(*offset);
            }
            out.part(format_args!("WPos:{}", Point { axes: &work, inch }));
        }
        if settings.report_mask & 2 != 0 {
            // A sender may use the number as size of its window, so the report has at most Grbl's size.
            out.part(format_args!("|Bf:{},{}", status.free_blocks, shown.room.min(RECEIVE_BYTES)));
        }
        if shown.line_numbers && status.line > 0 {
            out.part(format_args!("|Ln:{}", status.line));
        }
        let (spindle, rpm) = shown.spindle;
        out.part(format_args!("|FS:{},{rpm}", feed(status.feed.to_bits(), inch)));
        pins(out, shown.signals, shown.names);
        let is_moving = !matches!(state, State::Idle | State::Alarm | State::Check | State::Sleep);
        if self.offsets > 0 {
            self.offsets -= 1;
        } else {
            self.offsets = if is_moving { 29 } else { 9 };
            // A report never has both fields.
            self.overrides = self.overrides.max(1);
            out.part(format_args!("|WCO:{}", Point { axes: offset, inch }));
        }
        if self.overrides > 0 {
            self.overrides -= 1;
        } else {
            self.overrides = if is_moving { 19 } else { 9 };
            let Overrides { feed, rapid, spindle: percent } = shown.overrides;
            out.part(format_args!("|Ov:{feed},{rapid},{percent}"));
            let letters = [
                (spindle == Spindle::Clockwise, 'S'),
                (spindle == Spindle::CounterClockwise, 'C'),
                (shown.flood, 'F'),
                (shown.mist, 'M'),
            ];
            if letters.iter().any(|(is_on, _)| *is_on) {
                out.part(format_args!("|A:"));
            }
            for (_, letter) in letters.iter().filter(|(is_on, _)| *is_on) {
                out.part(format_args!("{letter}"));
            }
        }
        out.line(format_args!(">"));
    }
}

/// Receive bytes and planner blocks in `$I`. The values are Grbl's, because some senders fill the reported
/// room completely.
pub const RECEIVE_BYTES: usize = 128;

/// Writes the letters of inputs that are on.
fn pins<W: embedded_io::Write>(out: &mut Text<'_, W>, signals: Signals, names: &[AxisName]) {
    if signals == Signals::default() {
        return;
    }
    out.part(format_args!("|Pn:"));
    for (name, axis) in names.iter().zip(0..8) {
        if signals.has(Signals::limit(axis)) {
            out.part(format_args!("{}", name.as_str()));
        }
    }
    let others = [
        (Signals::PROBE, 'P'),
        (Signals::DOOR, 'D'),
        (Signals::HOLD, 'H'),
        (Signals::RESET, 'R'),
        (Signals::START, 'S'),
    ];
    for (_, letter) in others.iter().filter(|(signal, _)| signals.has(*signal)) {
        out.part(format_args!("{letter}"));
    }
}

/// Answers `$$`.
pub fn settings<const AXES: usize, W: embedded_io::Write>(out: &mut Text<'_, W>, settings: &Settings<AXES>) {
    let shown = settings.each(|number, value| {
        out.line(format_args!("${number}={value}"));
        Ok::<(), core::convert::Infallible>(())
    });
    let Ok(()) = shown;
}

/// Answers `$#`.
pub fn offsets<const AXES: usize, W: embedded_io::Write>(
    out: &mut Text<'_, W>,
    offsets: &Offsets<AXES>,
    inch: bool,
) {
    for (system, number) in offsets.systems.iter().zip(54..=59) {
        out.line(format_args!("[G{number}:{}]", Point { axes: system, inch }));
    }
    for (name, axes) in [("G28", &offsets.g28), ("G30", &offsets.g30), ("G92", &offsets.g92)] {
        out.line(format_args!("[{name}:{}]", Point { axes, inch }));
    }
    let tool = offsets.tool.get(2).copied().unwrap_or(Position::ZERO);
    out.line(format_args!("[TLO:{}]", position(tool.to_bits(), inch)));
    // `[PRB:` comes last, because grbl-streamer treats this line as the end of the answer.
    probe(out, offsets, inch);
}

/// Writes the end position of the last probing motion in machine coordinates, and whether the probe had
/// contact.
pub fn probe<const AXES: usize, W: embedded_io::Write>(
    out: &mut Text<'_, W>,
    offsets: &Offsets<AXES>,
    inch: bool,
) {
    let place = Point { axes: &offsets.probe, inch };
    out.line(format_args!("[PRB:{place}:{}]", u8::from(offsets.probed)));
}

/// Answers `$G`.
pub fn modal<const AXES: usize, W: embedded_io::Write>(
    out: &mut Text<'_, W>,
    motion: &impl Motion<AXES>,
    inch: bool,
) {
    let modal: Modal = motion.modal();
    out.part(format_args!("[GC:G"));
    match (modal.motion, modal.motion % 10) {
        (whole @ 100.., part @ 1..) => out.part(format_args!("{}.{part}", whole / 10)),
        (whole, _) => out.part(format_args!("{whole}")),
    }
    let units = if modal.inch { 20 } else { 21 };
    let distance = if modal.incremental { 91 } else { 90 };
    let mode = if modal.inverse_time { 93 } else { 94 };
    match modal.system.checked_sub(59) {
        Some(more @ 1..) => out.part(format_args!(" G59.{more}")),
        _ => out.part(format_args!(" G{}", modal.system)),
    }
    out.part(format_args!(" G{} G{units} G{distance} G{mode}", modal.plane));
    if let Some(program) = modal.program {
        out.part(format_args!(" M{program}"));
    }
    let spindle = match modal.spindle {
        Spindle::Clockwise => 3,
        Spindle::CounterClockwise => 4,
        Spindle::Off => 5,
    };
    out.part(format_args!(" M{spindle}"));
    let coolant = [(modal.mist, 7), (modal.flood, 8), (!modal.mist && !modal.flood, 9)];
    for (_, number) in coolant.iter().filter(|(is_on, _)| *is_on) {
        out.part(format_args!(" M{number}"));
    }
    out.line(format_args!(" T{} F{} S{}]", modal.tool, feed(modal.feed.to_bits(), inch), modal.rpm));
}
