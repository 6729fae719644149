//! Carries out the words of a line of LinuxCNC, Grbl or Fanuc, in an order that all three share. The order of
//! words in the text has no effect.
use super::block::{Block, Said, skip_switch};
use super::course::{Course, Spiral, Turns};
use super::words::{Meaning, NOT_BUILT, OF_MILLS, group};
use super::{Interpreter, Note, Tools};
use crate::machine::{AxisKind, Dialect, functions};
use crate::nc::block::{Given, Item, ItemKind, Words};
use crate::nc::compose::in_range;
use crate::nc::cursor::Cursor;
use crate::nc::interpreter::{Bounds, Gathered, Next, Phase, QUIET_LINES, Refusal};
use crate::nc::line::Line;
use crate::nc::modal::{Before, Mode};
use crate::nc::number::Factor;
use crate::nc::{ArcBy, DwellTime, Fault, Motion, MotionKind, NcErrorKind, NcWarningKind, Span, real};
use crate::quantity::{Feed, Position};

/// Largest number of turns of an arc.
const TURNS: u32 = 10_000;

/// Largest difference of the radii of one arc, mm, for any radius.
const PIECE: f64 = 0.005;

/// Longest dwell without a warning, s. A longer value may be meant in milliseconds.
const LONG_DWELL: Position = Position::const_from_int(60);

impl<const AXES: usize> Interpreter<AXES> {
    /// Decodes a line of a program in another dialect than ISG's.
    #[inline(never)]
    pub fn foreign_line(&mut self, line: &Line, bounds: Bounds) -> Result<Next, Refusal> {
        let mut c = Cursor::new(line.bytes());
        if self.phase == Phase::Ended {
            self.foreign.note = None;
            return Ok(Next::Line);
        }
        self.before = Before::All(self.modal);
        self.foreign.before = self.foreign.now;
        self.queue.clear();
        (self.n, self.moves) = (0, false);
        if self.foreign.calls.skips() {
            self.foreign.note = None;
            c.eat(b'/');
            return Ok(self.o_word(&mut c, line, bounds)?.unwrap_or(Next::Line));
        }
        self.quiet = self.quiet.saturating_add(1);
        if self.quiet > QUIET_LINES {
            return Err(Refusal::Here(Fault { span: c.rest_of_word(), kind: NcErrorKind::Endless }));
        }
        if c.at_end() {
            return self.take_note().map(|()| Next::Line);
        }
        if c.peek() == b'%' {
            self.take_note()?;
            return Ok(self.percent(&mut c, line)?);
        }
        if self.phase == Phase::Start {
            self.phase = Phase::Running;
            self.flow.program = bounds.start;
        }
        if self.is_report(line) {
            self.foreign.note = None;
            self.warn(line, c.rest_of_word(), NcWarningKind::Report);
            return Ok(Next::Line);
        }
        if c.peek() == b'/' {
            if self.setup.foreign.block_delete {
                self.foreign.note = None;
                return Ok(Next::Line);
            }
            if self.setup.foreign.dialect() == Dialect::Grbl {
                self.warn(line, c.here(), NcWarningKind::BlockSkip);
            }
            if self.setup.foreign.dialect().is_fanuc() {
                skip_switch(&mut c);
            } else {
                c.bump();
            }
        }
        if let Some(next) = self.o_word(&mut c, line, bounds)? {
            self.take_note()?;
            return Ok(next);
        }
        // All values are read first. A line with much arithmetic continues in the next call.
        let mut block = self.read_block(&mut c)?;
        self.take_note()?;
        self.carry_out(&mut block, line)?;
        if functions::DIALECTS.is_built() {
            for (index, value) in &block.assigned {
                self.assign(*index, *value).map_err(|kind| Fault { span: Span::default(), kind })?;
            }
        }
        Ok(self.go_to(&block, line, bounds)?)
    }

    /// Whether the line is a command to Grbl that reports or unlocks, and moves no axis.
    fn is_report(&self, line: &Line) -> bool {
        const REPORTS: [&[u8]; 8] = [b"?", b"$", b"$$", b"$#", b"$G", b"$I", b"$N", b"$X"];
        self.setup.foreign.dialect() == Dialect::Grbl
            && REPORTS.iter().any(|report| {
                let bytes = line.bytes().iter().filter(|byte| **byte != b' ');
                bytes.map(u8::to_ascii_uppercase).eq(report.iter().copied())
            })
    }

    /// Carries out an active comment of the line.
    fn take_note(&mut self) -> Result<(), Refusal> {
        match self.foreign.note.take() {
            None => {}
            Some((Note::Message, place)) => {
                self.foreign.message = place;
                self.push(ItemKind::Message, Span::default())?;
            }
            Some((Note::Other, place)) => self.warn_at(place, NcWarningKind::ActiveComment),
            Some((Note::Abort, place)) => {
                return Err(Refusal::At(place, NcErrorKind::Aborted));
            }
        }
        Ok(())
    }

    /// Carries out M98 and M99.
    fn go_to(&mut self, block: &Block<AXES>, line: &Line, bounds: Bounds) -> Result<Next, Fault> {
        let said = block.said(group::USER).filter(|_| functions::DIALECTS.is_built());
        let Some(said) = said else { return Ok(Next::Line) };
        match said.word.meaning {
            Meaning::Call => {
                let (number, times) = self.foreign.called;
                self.call_program(number, times, said.span, line, bounds)
            }
            Meaning::Return => self.end_of_subprogram(said.span),
            _ => Ok(Next::Line),
        }
    }

    /// Reads P and L of M98. Refuses M2 and M30 in the block: they would end the program before the jump of
    /// M98 or M99.
    fn read_call(&mut self, block: &mut Block<AXES>) -> Result<(), Fault> {
        let goes = |said: &Said| matches!(said.word.meaning, Meaning::Call | Meaning::Return);
        let user = block.said(group::USER).filter(|_| functions::DIALECTS.is_built()).filter(goes);
        let Some(said) = user else { return Ok(()) };
        if block.said(group::STOP).is_some_and(|stop| stop.word.meaning == Meaning::End) {
            return said.span.fault(NcErrorKind::Conflict("M2 or M30"));
        }
        if said.word.meaning == Meaning::Return {
            return Ok(());
        }
        let Some(given) = block.take(b'P') else {
            return said.span.fault(NcErrorKind::Missing("P, the number of the subprogram"));
        };
        let mut number = self.whole(given, "P", 1_000_000_000)?;
        let mut times = 1;
        if self.setup.foreign.dialect().is_fanuc() {
            (number, times) = Self::called_by(number);
        }
        if let Some(given) = block.take(b'L') {
            times = self.whole(given, "L", 10_000)?;
        }
        if times == 0 {
            return said.span.fault(NcErrorKind::Expected("L of 1 and more"));
        }
        self.foreign.called = (number, times);
        Ok(())
    }

    /// Handles a line `%`: the first one begins a program, the next one ends it.
    fn percent(&mut self, c: &mut Cursor<'_>, line: &Line) -> Result<Next, Fault> {
        let span = c.here();
        c.bump();
        c.require_end("%")?;
        if self.phase == Phase::Start && !self.foreign.percent {
            self.foreign.percent = true;
            return Ok(Next::Line);
        }
        if !self.foreign.percent {
            self.warn(line, span, NcWarningKind::HeadEnds);
        }
        self.phase = Phase::Ended;
        Ok(Next::Line)
    }

    pub(super) fn push(&mut self, kind: ItemKind, span: Span) -> Result<(), Fault> {
        self.queue.push_back(Item { span, kind }).map_err(|_| Fault { span, kind: NcErrorKind::BlockTooFull })
    }

    fn carry_out(&mut self, block: &mut Block<AXES>, line: &Line) -> Result<(), Fault> {
        let converts =
            block.said(group::UNITS).is_some_and(|said| said.word.meaning != Meaning::Inch(self.modal.inch));
        let grbl = self.setup.foreign.dialect() != Dialect::LinuxCnc;
        if let Some(Said { word, span, .. }) = block.said(group::FEED) {
            let (by_time, per_turn) =
                (word.meaning == Meaning::ByTime(true), word.meaning == Meaning::PerTurn);
            let now = &mut self.foreign.now;
            if (now.by_time, now.per_turn) != (by_time, per_turn) {
                (now.by_time, now.per_turn, now.degrees, self.modal.feed) = (by_time, per_turn, None, None);
                if per_turn {
                    self.warn(line, span, NcWarningKind::FeedOfSpindle);
                }
            }
        }
        if let Some(said) = block.said(group::ONCE).filter(|said| said.word.meaning == Meaning::Mode) {
            self.warn(line, said.span, NcWarningKind::ModeWithoutEffect);
        }
        self.take_diameter(block)?;
        self.least_increments(block, self.modal.inch != converts, line);
        let feed = block.take(b'F');
        if let (Some(given), false) = (feed, grbl) {
            // LinuxCNC reads F before the change of unit.
            if converts {
                self.warn(line, given.span, NcWarningKind::FeedBeforeUnit);
            }
            self.set_feed(given)?;
        }
        self.functions(block, line)?;
        self.dwell(block, line)?;
        self.read_call(block)?;
        self.settings(block, line)?;
        if let (Some(given), true) = (feed, grbl) {
            self.set_feed(given)?;
        }
        let stops = self.modal.exact_stop;
        self.modal.exact_stop |=
            block.said(group::ONCE).is_some_and(|said| said.word.meaning == Meaning::StopOnce);
        self.follow_surface(block)?;
        let course = self.moves_of(block, line)?;
        self.modal.exact_stop = stops;
        self.drop_unused(block);
        block.is_used_up()?;
        if self.foreign.now.by_time {
            // F is valid only for its own block.
            self.modal.feed = None;
        }
        self.settle_plain();
        self.foreign.tail = match block.said(group::STOP) {
            Some(said) if said.word.meaning != Meaning::OptionalPause || self.setup.foreign.optional_stop => {
                Some((said.number, said.span))
            }
            _ => None,
        };
        if course.is_some() {
            self.foreign.course = course;
            self.moves = true;
        } else {
            self.end_block();
        }
        Ok(())
    }

    /// Sets F per minute; 0 means none.
    fn set_feed(&mut self, given: Given) -> Result<(), Fault> {
        let range =
            NcErrorKind::Range { what: "F", min: 0, max: 2_147_483_647, unit: "mm/min", above: false };
        let of = |factor| given.number.fixed(factor).filter(|feed| *feed >= Feed::ZERO);
        let fault = Fault { span: given.span, kind: range };
        let feed = of(self.length_factor()).ok_or(fault)?;
        let degrees = of(Factor::ONE).ok_or(fault)?;
        let some = |feed| Some(feed).filter(|feed| *feed > Feed::ZERO);
        if self.foreign.now.by_time {
            self.modal.feed = some(degrees);
            return Ok(());
        }
        self.modal.feed = some(feed);
        self.foreign.now.degrees =
            if self.modal.inch && !self.foreign.now.per_turn { some(degrees) } else { None };
        Ok(())
    }

    /// Carries out S, T, M6, spindle, coolant and other M words.
    fn functions(&mut self, block: &mut Block<AXES>, line: &Line) -> Result<(), Fault> {
        self.speed(block, line)?;
        if let Some(given) = block.take(b'T') {
            self.foreign.now.tool.selected = self.whole(given, "T", 999_999_999)?;
            self.push(ItemKind::Tool(self.foreign.now.tool.selected), given.span)?;
        }
        self.outputs(block)?;
        if let Some(said) = block.said(group::OVERRIDE).filter(|said| said.word.meaning == Meaning::Override)
        {
            let _ = block.take(b'P');
            self.warn(line, said.span, NcWarningKind::OverridesStay);
        }
        for group in [group::TOOL, group::SPINDLE, group::MIST, group::FLOOD, group::USER] {
            let Some(Said { word, number, span }) = block.said(group) else { continue };
            let now = &mut self.foreign.now;
            match word.meaning {
                Meaning::Spindle => now.spindle = if number == 5 { 0 } else { number },
                Meaning::Orient => now.spindle = 0,
                Meaning::Coolant if number == 9 => now.coolant = 0,
                Meaning::Coolant => now.coolant |= if number == 7 { 1 } else { 2 },
                _ => {}
            }
            match word.meaning {
                Meaning::Call | Meaning::Return => continue,
                Meaning::Save(_) | Meaning::Forget | Meaning::Restore if functions::DIALECTS.is_built() => {
                    self.keep_state(word.meaning, span)?;
                    continue;
                }
                Meaning::Spindle | Meaning::Coolant
                    if matches!(number, 5 | 9) && self.setup.foreign.dialect().is_fanuc() =>
                {
                    // M5 and M9 are in different groups.
                    let [spindle, coolant] = &mut self.foreign.behind;
                    *(if number == 5 { spindle } else { coolant }) = Some((number, span));
                    continue;
                }
                Meaning::Orient => self.no_angle(block)?,
                Meaning::User if self.setup.foreign.dialect() == Dialect::LinuxCnc => {
                    if let Some(given) = block.take(b'P').or(block.take(b'Q')) {
                        self.warn(line, given.span, NcWarningKind::NoArguments);
                    }
                }
                Meaning::ToolNumber => {
                    let Some(given) = block.take(b'Q') else {
                        return span.fault(NcErrorKind::Missing("Q, the tool"));
                    };
                    let tool = self.whole(given, "Q", 999_999_999)?;
                    self.foreign.now.tool = Tools { selected: tool, loaded: tool };
                    self.push(ItemKind::Tool(tool), span)?;
                    continue;
                }
                _ => {}
            }
            let changes = word.meaning == Meaning::Change;
            if changes {
                self.foreign.now.tool.loaded = self.foreign.now.tool.selected;
            }
            self.push(if changes { ItemKind::Pause(number) } else { ItemKind::M(number) }, span)?;
        }
        Ok(())
    }

    /// S: with G96, the surface speed. The spindle speed that results is output.
    fn speed(&mut self, block: &mut Block<AXES>, line: &Line) -> Result<(), Fault> {
        let said = block.said(group::SPINDLE_MODE).filter(|_| functions::DIALECTS.is_built());
        if let Some(said) = said {
            let on = said.word.meaning == Meaning::Surface(true);
            if on && self.foreign.now.surface.is_none() {
                self.warn(line, said.span, NcWarningKind::SpeedByBlock);
            }
            self.choose_surface(on, block, said.span)?;
        }
        let Some(given) = block.take(b'S') else { return Ok(()) };
        let said = [group::SCALING, group::SPINDLE, group::MOTION].map(|group| block.said(group));
        if let [Some(Said { span, .. }), None, None] = said {
            // G50 S is the highest spindle speed of a lathe, whose X is a diameter.
            return span
                .fault(NcErrorKind::Known { what: "the highest spindle speed of a lathe", hint: OF_MILLS });
        }
        let speed = given.number.fixed(Factor::ONE).filter(|speed| *speed >= Position::ZERO);
        let kind = NcErrorKind::Range { what: "S", min: 0, max: 2_147_483_647, unit: "1/min", above: false };
        let mut speed = speed.ok_or(Fault { span: given.span, kind })?;
        if let (Some(surface), true) = (&mut self.foreign.now.surface, functions::DIALECTS.is_built()) {
            // Metres or feet per minute.
            let unit = block
                .said(group::UNITS)
                .map_or(self.modal.inch, |said| said.word.meaning == Meaning::Inch(true));
            surface.speed = given.number.real() * if unit { 304.8 } else { 1000.0 };
            let surface = *surface;
            speed = self.speed_of_surface(surface, given.span)?;
        }
        self.foreign.now.speed = speed;
        self.push(ItemKind::Spindle(speed), given.span)
    }

    /// With G96, a block with axis words begins with the spindle speed for its start position.
    fn follow_surface(&mut self, block: &Block<AXES>) -> Result<(), Fault> {
        let surface = self.foreign.now.surface.filter(|_| functions::DIALECTS.is_built());
        let (Some(surface), Some(span)) = (surface, block.first) else { return Ok(()) };
        let speed = self.speed_of_surface(surface, span)?;
        if core::mem::replace(&mut self.foreign.now.speed, speed) != speed {
            self.push(ItemKind::Spindle(speed), span)?;
        }
        Ok(())
    }

    /// Accepts M19 only without an angle, or with the angle 0.
    fn no_angle(&self, block: &mut Block<AXES>) -> Result<(), Fault> {
        match block.take(b'R') {
            Some(given) if given.number.real() != 0.0 => given
                .span
                .fault(NcErrorKind::Known { what: "orientation to an angle", hint: "M19 without R" }),
            _ => Ok(()),
        }
    }

    /// Carries out G4.
    fn dwell(&mut self, block: &mut Block<AXES>, line: &Line) -> Result<(), Fault> {
        let Some(said) = block.said(group::NON_MODAL) else { return Ok(()) };
        if said.word.meaning != Meaning::Dwell {
            return Ok(());
        }
        let by_letter = block.take(b'P').map(|given| (given, block.is_pointless(b'P')));
        let Some((given, is_ms)) = by_letter.or_else(|| self.dwell_by_axis(block)) else {
            return said.span.fault(NcErrorKind::Missing("P, seconds"));
        };
        if let (Some(first), true) = (block.first, self.setup.foreign.dialect().is_fanuc()) {
            return first.fault(NcErrorKind::Conflict("G4"));
        }
        let time = self.seconds(given, is_ms)?;
        if time > LONG_DWELL {
            self.warn(line, given.span, NcWarningKind::LongDwell);
        }
        self.push(ItemKind::Dwell(DwellTime::Seconds(time)), said.span)
    }

    /// Carries out words that stay in force, except for the motion word.
    fn settings(&mut self, block: &mut Block<AXES>, line: &Line) -> Result<(), Fault> {
        const ORDER: [u8; 8] = [
            group::PLANE,
            group::UNITS,
            group::LATHE,
            group::LENGTH,
            group::OFFSET,
            group::PATH,
            group::DISTANCE,
            group::CENTRE,
        ];
        for group in ORDER.into_iter().chain([group::LEVEL]) {
            let Some(said) = block.said(group) else { continue };
            match said.word.meaning {
                Meaning::Plane(plane) => self.modal.plane = plane,
                Meaning::Inch(inch) => self.modal.inch = inch,
                Meaning::Diameter(diameter) => self.modal.diameter = diameter,
                Meaning::Length | Meaning::LengthMinus | Meaning::LengthNow | Meaning::NoLength => {
                    self.set_length(said, block, line)?;
                }
                Meaning::Offset(set) => self.modal.zero_set = Some(usize::from(set)),
                Meaning::ExactPath => self.path_mode(false, said.span)?,
                Meaning::ExactStop => self.path_mode(true, said.span)?,
                Meaning::Blend => self.blend(block, said.span, line)?,
                Meaning::Relative(relative) => self.modal.relative = relative,
                Meaning::CentreAbsolute(absolute) => self.modal.centre_absolute = absolute,
                Meaning::ToLevel(to_level) => self.foreign.now.to_level = to_level,
                _ => {}
            }
        }
        Ok(())
    }

    /// G61 and G61.1: exact corners, passed without or with a stop.
    pub(super) fn path_mode(&mut self, stops: bool, span: Span) -> Result<(), Fault> {
        if self.foreign.now.blend.take().is_some() {
            self.push(ItemKind::Switch(260), span)?;
        }
        if core::mem::replace(&mut self.modal.exact_stop, stops) != stops {
            self.push(ItemKind::Switch(if stops { 360 } else { 359 }), span)?;
        }
        Ok(())
    }

    /// G64: P is the largest deviation. Without P, or with P0, the machine data give it.
    fn blend(&mut self, block: &mut Block<AXES>, span: Span, line: &Line) -> Result<(), Fault> {
        span.needs(functions::CONTOUR)?;
        let given = block.take(b'P');
        let deviation = match given {
            None => Position::ZERO,
            Some(given) => {
                let value = given.number.fixed(self.length_factor());
                let kind = NcErrorKind::Range { what: "P", min: 0, max: 1000, unit: "mm", above: false };
                let fits =
                    |value: &Position| (Position::ZERO..=Position::const_from_int(1000)).contains(value);
                value.filter(fits).ok_or(Fault { span: given.span, kind })?
            }
        };
        if let Some(given) = block.take(b'Q') {
            self.warn(line, given.span, NcWarningKind::NoMerging);
        }
        let told = deviation == Position::ZERO;
        let deviation = if told { self.setup.foreign.blend } else { deviation };
        if told {
            let um = (i128::from(deviation.to_bits()) * 1000 + (1 << 31)) >> 32;
            self.warn(line, span, NcWarningKind::BlendTolerance(um as u32));
        }
        self.blend_by(deviation, span)
    }

    /// Rounds corners with this largest deviation.
    pub(super) fn blend_by(&mut self, deviation: Position, span: Span) -> Result<(), Fault> {
        if core::mem::take(&mut self.modal.exact_stop) {
            self.push(ItemKind::Switch(359), span)?;
        }
        self.foreign.now.blend = Some(deviation);
        self.push(ItemKind::Blend(deviation), span)
    }

    /// Carries out the word that uses the axes of the block; there is at most one.
    fn moves_of(&mut self, block: &mut Block<AXES>, line: &Line) -> Result<Course<AXES>, Fault> {
        let single = block.said(group::NON_MODAL);
        let end = block.said(group::CYCLE_END);
        if let (Some(Said { word, span, .. }), Some(_)) = (block.said(group::MOTION), end)
            && matches!(word.meaning, Meaning::Cycle(_))
        {
            return span.fault(NcErrorKind::Conflict("G80"));
        }
        let motion = block.said(group::MOTION).or(end);
        if let Some(said) = motion {
            self.choose_motion(said, block)?;
        }
        let length = block.said(group::LENGTH).filter(|said| said.word.meaning == Meaning::LengthNow);
        let other = single.filter(|said| !matches!(said.word.meaning, Meaning::Dwell | Meaning::Machine));
        if let Some(user) = other.or(length) {
            let moves = motion.filter(|said| said.word.meaning != Meaning::NoMotion);
            // Fanuc's programs choose the next motion beside G28.
            let straight =
                |said: &Said| matches!(said.word.meaning, Meaning::Motion(Mode::Rapid | Mode::Line));
            let homes = matches!(user.word.meaning, Meaning::Home(_));
            let beside = homes && self.setup.foreign.dialect().is_fanuc();
            if let Some(said) = moves.filter(|said| !(beside && straight(said))) {
                return said.span.fault(NcErrorKind::Conflict("another use of its axis words"));
            }
            return match user.word.meaning {
                Meaning::LengthNow => Ok(Course::None),
                Meaning::Home(place) => {
                    self.second_place(place, block)?;
                    self.home(place, block, user.span)
                }
                _ => self.store(user, block).map(|()| Course::None),
            };
        }
        let machine = single.filter(|said| said.word.meaning == Meaning::Machine);
        if let (Some(said), Some(_)) = (machine, block.first) {
            let fanuc = self.setup.foreign.dialect().is_fanuc();
            if self.foreign.now.cycle.is_some()
                || self.foreign.now.no_motion
                || !fanuc && !matches!(self.modal.mode, Mode::Rapid | Mode::Line)
                || motion.is_some_and(|said| matches!(said.word.meaning, Meaning::Cycle(_)))
            {
                return said.span.fault(NcErrorKind::Missing("G0 or G1"));
            }
            if fanuc && self.modal.relative {
                return said.span.fault(NcErrorKind::Missing("G90, without which Fanuc passes over G53"));
            }
        }
        let said = motion.map(|said| said.word.meaning);
        let cycle = match (said, self.foreign.now.cycle) {
            _ if !functions::DIALECTS.is_built() => None,
            (Some(Meaning::Cycle(kind)), _) => Some(kind),
            (None, Some(cycle)) => Some(cycle.kind),
            _ => None,
        };
        if let Some(kind) = cycle {
            let Some(span) = motion.map(|said| said.span).or(block.first) else { return Ok(Course::None) };
            if block.first.is_none() {
                return span.fault(NcErrorKind::Missing("axis words"));
            }
            if self.foreign.now.by_time {
                return span.fault(NcErrorKind::Conflict("inverse time feed, G93"));
            }
            self.foreign.span = span;
            return self.drill(kind, block, span);
        }
        let course = self.move_by(block, machine.is_some(), line)?;
        if let Some(Meaning::Probe(tenth)) = said {
            self.probe(tenth, motion.map(|said| said.span).unwrap_or_default())?;
        }
        Ok(course)
    }

    /// G38.2…G38.5: makes the motion of the block a probing motion. The next block needs a motion word.
    fn probe(&mut self, tenth: u8, span: Span) -> Result<(), Fault> {
        // Without a motion in this block, the motion of an earlier line is still stored.
        if !self.moves || self.gathered.motion().is_none() {
            return span.fault(NcErrorKind::Missing("axis words"));
        }
        let _ = self.queue.pop_back();
        self.foreign.now.no_motion = true;
        self.push(ItemKind::Probe(tenth), span)
    }

    /// Carries out a word of the motion group.
    fn choose_motion(&mut self, said: Said, block: &Block<AXES>) -> Result<(), Fault> {
        let now = &mut self.foreign.now;
        match said.word.meaning {
            Meaning::Motion(mode) => {
                self.modal.mode = mode;
                (now.cycle, now.no_motion) = (None, false);
            }
            Meaning::Probe(_) => {
                self.modal.mode = Mode::Line;
                (now.cycle, now.no_motion) = (None, false);
            }
            Meaning::NoMotion => {
                // Fanuc continues with the motion word from before the cycle.
                (now.cycle, now.no_motion) = (None, !self.setup.foreign.dialect().is_fanuc());
                if !now.no_motion {
                    return Ok(());
                }
                let user = block.said(group::NON_MODAL);
                if let (Some(first), None) = (block.first, user) {
                    return first.fault(NcErrorKind::Missing("G0, G1, G2 or G3 behind G80"));
                }
            }
            _ => now.no_motion = false,
        }
        Ok(())
    }

    /// Carries out G28 and G30.
    fn home(&mut self, place: u8, block: &Block<AXES>, span: Span) -> Result<Course<AXES>, Fault> {
        let stored = self.setup.foreign.stored.get(usize::from(place)).copied();
        let stored = stored.unwrap_or([Position::ZERO; AXES]);
        self.foreign.span = span;
        if block.first.is_none() {
            self.rests = [0; AXES];
            return Ok(Course::Home { way: None, to: stored });
        }
        let (mut way, mut to) = (self.position, self.position);
        for (axis, given) in block.axes.iter().enumerate() {
            let Some(given) = *given else { continue };
            let value = self.axis_value(axis, given)?;
            let base =
                if self.modal.relative { self.position.get(axis).copied() } else { Some(self.offset(axis)) };
            let slots = (way.get_mut(axis), to.get_mut(axis), stored.get(axis), self.rests.get_mut(axis));
            let (Some(way), Some(to), Some(stored), Some(rest)) = slots else { continue };
            *way = value.saturating_add(base.unwrap_or_default());
            (*to, *rest) = (*stored, 0);
            if !in_range(*way) {
                return given.span.fault(self.coordinate_of(axis));
            }
        }
        for (axis, given) in block.axes.iter().enumerate() {
            if let (None, Some(way), Some(to)) = (given, way.get(axis), to.get_mut(axis)) {
                *to = *way;
            }
        }
        Ok(Course::Home { way: Some(way), to })
    }

    /// Moves by the G0…G3 word in force, with the axis words of the block.
    fn move_by(
        &mut self,
        block: &mut Block<AXES>,
        machine: bool,
        line: &Line,
    ) -> Result<Course<AXES>, Fault> {
        let arc = matches!(self.modal.mode, Mode::Clockwise | Mode::Counterclockwise);
        let mut words = Words::new();
        words.axes = block.axes;
        words.first = block.first;
        words.mode_span = block.said(group::MOTION).map(|said| said.span);
        words.before = self.queue.len() as u8;
        let has_centre = [b'I', b'J', b'K'].iter().any(|letter| block.value(*letter).is_some());
        if self.foreign.now.no_motion {
            return match block.first {
                Some(first) => first.fault(NcErrorKind::Missing("G0, G1, G2 or G3 behind G80")),
                None => Ok(Course::None),
            };
        }
        if !arc || machine {
            // On Fanuc, G53 is rapid motion.
            let mode = self.modal.mode;
            if machine && self.setup.foreign.dialect().is_fanuc() {
                self.modal.mode = Mode::Rapid;
            }
            let moved = self.move_straight(&mut words, machine, line);
            if machine {
                self.modal.mode = mode;
            }
            moved?;
            return Ok(Course::None);
        }
        if block.first.is_none() && !has_centre {
            return Ok(Course::None);
        }
        for (slot, letter) in words.centre.iter_mut().zip([b'I', b'J', b'K']) {
            *slot = block.take(letter);
        }
        // Grbl ignores the centre word outside the plane. Postprocessors write K0, which has no effect in
        // LinuxCNC either.
        let [first, second] = self.modal.plane.main_axes();
        let grbl = self.setup.foreign.dialect() == Dialect::Grbl;
        if let Some(slot) = words.centre.get_mut(3 - first - second)
            && slot.is_some_and(|given| grbl || given.number.real() == 0.0)
        {
            *slot = None;
        }
        words.radius = block.take(b'R');
        words.first = words.first.or(words.centre_span());
        self.move_round(&mut words, block.take(b'P'), line)
    }

    fn move_straight(&mut self, words: &mut Words<AXES>, machine: bool, line: &Line) -> Result<(), Fault> {
        let (modal, start) = (self.modal, self.position);
        if machine {
            (self.modal.zero_set, self.modal.relative) = (None, false);
            self.modal.shift = [Position::ZERO; AXES];
        }
        let moved = self.motion_of(words, line);
        let (zero_set, relative, shift) = (modal.zero_set, modal.relative, modal.shift);
        (self.modal.zero_set, self.modal.relative, self.modal.shift) = (zero_set, relative, shift);
        moved?;
        self.feed_in_degrees(&start);
        self.feed_of_time(&start);
        self.feed_of_turns(words.first.unwrap_or_default())
    }

    /// With G93, sets the feed so that the motion takes the programmed time.
    fn feed_of_time(&mut self, start: &[Position; AXES]) {
        if let (true, true, Gathered::Motion(cell)) = (self.foreign.now.by_time, self.moves, &self.gathered) {
            let motion = cell.get();
            if motion.kind != MotionKind::Rapid {
                cell.set(Motion { feed: self.feed_by_time(&motion, start), ..motion });
            }
        }
    }

    /// If only rotary axes move, F counts in degrees, also with inches.
    fn feed_in_degrees(&mut self, start: &[Position; AXES]) {
        let (Some(feed), Gathered::Motion(cell)) = (self.foreign.now.degrees, &self.gathered) else { return };
        let mut motion = cell.get();
        let moved = self.setup.kinds.iter().zip(&motion.target).zip(start);
        let mut moved = moved.filter(|((_, to), from)| to != from).map(|((kind, _), _)| *kind);
        if self.moves && moved.next() == Some(AxisKind::Rotary) && moved.all(|kind| kind == AxisKind::Rotary)
        {
            motion.feed = feed;
            cell.set(motion);
        }
    }

    /// Carries out G2 and G3; `turns` is P.
    fn move_round(
        &mut self,
        words: &mut Words<AXES>,
        turns: Option<Given>,
        line: &Line,
    ) -> Result<Course<AXES>, Fault> {
        let start = self.position;
        let span = words.first.unwrap_or_default();
        let plane = self.modal.plane;
        if self.modal.centre_absolute && words.centre_span().is_some() && words.radius.is_none() {
            let both = plane.main_axes().iter().all(|k| words.centre.get(*k).is_some_and(Option::is_some));
            if !both {
                return span.fault(NcErrorKind::Missing("both coordinates of the centre with G90.1"));
            }
        }
        self.modal.radius = match words.radius {
            Some(given) => Some(self.radius_of(given)?),
            None => None,
        };
        let moved = self.motion_of(words, line);
        self.modal.radius = None;
        moved?;
        self.feed_of_time(&start);
        self.feed_of_turns(span)?;
        let Some(given) = turns else { return Ok(self.spiral(&start, span)) };
        if !functions::DIALECTS.is_built() {
            return given.span.fault(NcErrorKind::Known { what: "an arc of several turns", hint: NOT_BUILT });
        }
        let turns = self.whole(given, "P", TURNS)?;
        if turns == 0 {
            return given.span.fault(NcErrorKind::Expected("P of 1 and more"));
        }
        if turns == 1 {
            return Ok(self.spiral(&start, span));
        }
        if self.foreign.now.by_time {
            return given.span.fault(NcErrorKind::Conflict("inverse time feed, G93"));
        }
        let Some(motion) = self.gathered.motion() else { return Ok(Course::None) };
        let MotionKind::Arc { clockwise, by: ArcBy::Centre(centre), .. } = motion.kind else {
            return given.span.fault(NcErrorKind::Conflict("R: turns need I, J or K"));
        };
        let [first, second, _] = self.axes_of_plane(span)?;
        let _ = self.queue.pop_back();
        self.gathered = Gathered::Nothing;
        self.position = start;
        self.foreign.span = span;
        let (axes, end) = ([first, second], motion.target);
        Ok(Course::Turns(Turns { start, end, axes, centre, plane, clockwise, full: turns - 1, done: 0 }))
    }

    /// An arc whose radii at both ends differ by more than one motion permits: a spiral of several arcs. If
    /// the arc is so small that the difference leaves no arc, it becomes a straight line.
    fn spiral(&mut self, start: &[Position; AXES], span: Span) -> Course<AXES> {
        let Gathered::Motion(cell) = &self.gathered else { return Course::None };
        let motion = cell.get();
        let MotionKind::Arc { plane, clockwise, by: ArcBy::Centre(centre) } = motion.kind else {
            return Course::None;
        };
        let Ok([first, second, _]) = self.axes_of_plane(span) else { return Course::None };
        let (axes, end) = ([first, second], motion.target);
        let turns = Turns { start: *start, end, axes, centre, plane, clockwise, full: 0, done: 0 };
        let [from, to] = [start, &end].map(|point| turns.radius(point));
        let difference = real::abs(to - from);
        let small = if from < to { from } else { to };
        // For a program in inches, LinuxCNC permits half a thousandth of an inch.
        let inches = self.modal.inch && self.setup.foreign.dialect() == Dialect::LinuxCnc;
        let least = if inches { 0.0127 } else { PIECE };
        if small > 0.0 && difference <= PIECE && difference > small / 4.0 {
            cell.set(Motion { kind: MotionKind::Line, ..motion });
            return Course::None;
        }
        let one = if small < 50.0 { small / 1000.0 } else { 0.05 };
        let too_much = difference > least && (difference > 0.5 || difference > from / 1000.0);
        if difference <= one || difference <= PIECE || too_much || self.foreign.now.by_time {
            return Course::None;
        }
        let piece = if difference > small / 1000.0 { 0.9 * PIECE } else { 0.045 };
        let count = real::ceil(difference / piece);
        let _ = self.queue.pop_back();
        self.gathered = Gathered::Nothing;
        (self.position, self.foreign.span) = (*start, span);
        Course::Spiral(Spiral { turns, radii: [from, to], count })
    }

    /// Reads R of an arc.
    fn radius_of(&self, given: Given) -> Result<Position, Fault> {
        let radius = given.number.fixed(self.length_factor());
        let radius = radius.filter(|r| *r != Position::ZERO && in_range(*r));
        radius.ok_or(Fault { span: given.span, kind: NcErrorKind::Expected("a radius that is not 0") })
    }
}
