//! The planner's handle of the log: decides which entry goes into which table.
use super::entry::{BELOW, BlockType, Entry, ProgramDistance};
use super::geometry::describe;
use super::table::{Row, Table};
use crate::nc::ContourLog;
use crate::path::{End, Shape};

/// A curve that enters the look-ahead.
pub(crate) struct Passed<'a, const AXES: usize> {
    pub shape: &'a Shape<AXES>,
    pub entry: &'a End<AXES>,
    pub exit: &'a End<AXES>,
    /// Programmed N number.
    pub n: u32,
    /// Number of motion blocks before the curve.
    pub number: u32,
    /// Driven distance at the start and at the end of the curve, LSB 2^-44 mm.
    pub driven: [i64; 2],
}

/// The error of a program with more than 8 commands of the log before one motion block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Crowded;

/// Number of log commands that may wait for their place.
pub(super) const MARKS: usize = 8;

#[derive(Clone, Copy)]
enum Mark {
    Log(ContourLog),
    Distance,
    /// A pass of a real-time loop begins or ends. The flag is MODULO.
    Turn(Turn, bool),
}

/// An event of a real-time loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// The first pass begins.
    Begin,
    /// Another pass begins.
    Again,
    /// The last pass ends.
    End,
}

/// State of the current real-time loop.
#[derive(Clone, Copy, Debug, Default)]
struct Repeat {
    /// Number of begun passes, at most 3.
    passes: u32,
    /// Program distance at the start of the loop, LSB 2^-24 mm.
    start: i64,
    /// From the third pass on, if the loop is logged: end of the log before the pass, and number of entries
    /// without room.
    kept: Option<(u32, u32)>,
}

/// A command that acts before the curves of the motion block `number`.
#[derive(Clone, Copy)]
struct Waiting {
    number: u32,
    n: u32,
    mark: Mark,
}

/// State of the log: the program has switched the log on.
pub(super) const ACTIVE: u32 = 1;
/// State of the log: the program has switched the log off. Another LOG ON has no effect before CLEAR.
pub(super) const CLOSED: u32 = 2;

/// Number of axes whose direction is stored, to compute the change of direction at the next element. Further
/// axes do not count.
const DIRECTIONS: usize = 32;

/// Writes the log of the path. [`crate::Planner::log_contour`] gives the recorder to the planner.
pub struct Recorder<'a> {
    window: Table<'a>,
    log: Table<'a>,
    rows: [Row; 2],
    /// Program distance at the end of the known path, and the remainder below its LSB, in units of 2^-44 mm.
    end: (i64, i64),
    /// Driven distance of the end, LSB 2^-44 mm. `None`: no planner owns the recorder yet.
    driven: Option<i64>,
    /// Direction at the end of the last element.
    exit: Option<[i64; DIRECTIONS]>,
    marks: heapless::Deque<Waiting, MARKS>,
    /// Largest number of entries kept in each table: P-CHAN-00658.
    most: usize,
    repeat: Repeat,
}

impl<'a> Recorder<'a> {
    pub(super) fn new(window: Table<'a>, log: Table<'a>) -> Self {
        let rows = [window.row(), log.row()];
        Self {
            window,
            log,
            rows,
            end: (0, 0),
            driven: None,
            exit: None,
            marks: heapless::Deque::new(),
            most: usize::MAX,
            repeat: Repeat::default(),
        }
    }

    /// Limits the number of entries in each table.
    pub(crate) fn keep(&mut self, most: u32) {
        self.most = usize::try_from(most).unwrap_or(usize::MAX);
    }

    /// Starts a program at the driven distance `driven`: the program distance is 0, and the log is empty.
    pub(crate) fn start(&mut self, driven: i64) {
        self.marks.clear();
        self.repeat = Repeat::default();
        self.driven = Some(driven);
        self.forget();
        self.end = (0, 0);
        self.clear_log();
        self.show();
    }

    /// Drops elements beyond `driven`, because the axes will not reach them.
    pub(crate) fn cut(&mut self, driven: i64) {
        let Some(known) = self.driven.replace(driven) else { return };
        if known == driven {
            return;
        }
        self.marks.clear();
        self.repeat = Repeat::default();
        self.forget();
        self.extend(driven.wrapping_sub(known));
        self.show();
    }

    /// Empties the window. Entry numbers continue.
    const fn forget(&mut self) {
        let [window, _] = &mut self.rows;
        window.first = window.end;
        window.mark = window.end;
        self.exit = None;
    }

    const fn clear_log(&mut self) {
        let [_, log] = &mut self.rows;
        log.first = log.end;
        (log.mark, log.flags) = (0, 0);
    }

    /// Moves the end of the known path by a length, LSB 2^-44 mm.
    const fn extend(&mut self, length: i64) {
        let (whole, rest) = self.end;
        let (upper, lower) = (length >> BELOW, length & ((1 << BELOW) - 1));
        let rest = rest.wrapping_add(lower);
        self.end = (whole.wrapping_add(upper).wrapping_add(rest >> BELOW), rest & ((1 << BELOW) - 1));
    }

    fn show(&mut self) {
        let Self { window, log, rows: [w, l], end, driven, .. } = self;
        for row in [&mut *w, &mut *l] {
            (row.reach, row.driven) = (end.0, driven.unwrap_or(0).wrapping_sub(end.1));
        }
        window.show(w);
        let mut shown = *l;
        if let Some((end, without_room)) = self.repeat.kept {
            (shown.end, shown.mark) = (end, without_room);
        }
        log.show(&shown);
    }

    /// Takes a command of the log, for the place before the motion block `number`.
    ///
    /// # Errors
    /// Too many commands wait for one motion block.
    pub(crate) fn command(&mut self, n: u32, number: u32, log: ContourLog) -> Result<(), Crowded> {
        self.marks.push_back(Waiting { number, n, mark: Mark::Log(log) }).map_err(|_| Crowded)
    }

    /// Takes `#DISTANCE PROG START CLEAR` before the motion block `number`.
    ///
    /// # Errors
    /// Too many commands wait for one motion block.
    pub(crate) fn clear_distance(&mut self, n: u32, number: u32) -> Result<(), Crowded> {
        self.marks.push_back(Waiting { number, n, mark: Mark::Distance }).map_err(|_| Crowded)
    }

    /// Begins or ends a pass of a real-time loop before the motion block `number`.
    ///
    /// # Errors
    /// Too many commands wait for one motion block.
    pub(crate) fn turn(&mut self, number: u32, turn: Turn, modulo: bool) -> Result<(), Crowded> {
        self.marks.push_back(Waiting { number, n: 0, mark: Mark::Turn(turn, modulo) }).map_err(|_| Crowded)
    }

    /// Carries out the waiting commands whose place is before the motion block `number`, except CLEAR.
    pub(crate) fn settle(&mut self, number: u32) {
        let mut changed = false;
        let comes = |waiting: &mut Waiting| {
            !matches!(waiting.mark, Mark::Log(ContourLog::Clear))
                && (number.wrapping_sub(waiting.number) as i32) >= 0
        };
        while let Some(Waiting { n, mark, .. }) = self.marks.pop_front_if(comes) {
            self.set(n, number, mark);
            changed = true;
        }
        if changed {
            self.show();
        }
    }

    /// Whether the next command is CLEAR, which waits for a stop.
    pub(crate) fn waits_for_rest(&self) -> bool {
        self.marks.front().is_some_and(|waiting| matches!(waiting.mark, Mark::Log(ContourLog::Clear)))
    }

    /// Carries out CLEAR at standstill, and the commands that were given with it.
    pub(crate) fn clear_at_rest(&mut self, number: u32) {
        if self.waits_for_rest() {
            self.marks.pop_front();
            self.clear_log();
            self.show();
        }
        self.settle(number);
    }

    fn set(&mut self, n: u32, id: u32, mark: Mark) {
        match mark {
            Mark::Distance => self.count_from(0, n, id),
            Mark::Turn(turn, modulo) => self.go_round(turn, modulo, id),
            Mark::Log(ContourLog::On(parameter)) if self.rows[1].flags == 0 => {
                self.rows[1].flags = ACTIVE;
                self.put(Entry { id, ..Entry::mark(BlockType::LogOn, n, parameter) });
            }
            Mark::Log(ContourLog::Parameter(value)) if self.rows[1].flags == ACTIVE => {
                self.put(Entry { id, ..Entry::mark(BlockType::LogParam, n, Some(value)) });
            }
            Mark::Log(ContourLog::Off(parameter)) if self.rows[1].flags == ACTIVE => {
                self.put(Entry { id, ..Entry::mark(BlockType::LogOff, n, parameter) });
                self.rows[1].flags = CLOSED;
            }
            // Only the first part can be logged. Marks of another part have no effect before CLEAR, which is
            // handled elsewhere.
            Mark::Log(_) => {}
        }
    }

    /// Lets the program distance continue from `start`. The remainder below its LSB stays.
    fn count_from(&mut self, start: i64, n: u32, id: u32) {
        let entry = Entry { id, ..Entry::mark(BlockType::Clear, n, None) };
        let end = ProgramDistance::from_bits(self.end.0);
        self.window.push(
            &mut self.rows[0],
            &Entry { start: end, ..entry },
            self.window.room().min(self.most),
        );
        self.end.0 = start;
        self.rows[0].mark = self.rows[0].end;
    }

    /// Begins or ends a pass of a real-time loop. If a log is active around the loop, the log contains three
    /// passes: the first, the second and the last. From the third pass on, each pass replaces the one before.
    /// The log shows the last pass when the loop ends.
    fn go_round(&mut self, turn: Turn, modulo: bool, id: u32) {
        if turn == Turn::Begin {
            self.repeat = Repeat { start: self.end.0, ..Repeat::default() };
        } else if modulo {
            self.count_from(self.repeat.start, 0, id);
        }
        let Repeat { passes, kept, .. } = &mut self.repeat;
        if turn == Turn::End {
            *kept = None;
            return;
        }
        *passes = passes.saturating_add(1).min(3);
        let log = &mut self.rows[1];
        match *kept {
            Some((end, without_room)) => (log.end, log.mark) = (end, without_room),
            None if *passes == 3 && log.flags == ACTIVE => *kept = Some((log.end, log.mark)),
            None => {}
        }
    }

    /// Drops the current loop.
    pub(crate) fn leave_loop(&mut self) {
        self.repeat = Repeat::default();
        self.show();
    }

    /// Appends an entry to the log. An entry without room is counted.
    fn put(&mut self, entry: Entry) {
        let row = &mut self.rows[1];
        let room = self.log.room().min(self.most);
        if row.end.wrapping_sub(row.first) as usize >= room {
            row.mark = row.mark.saturating_add(1);
            return;
        }
        let start =
            if entry.block_type.is_element() { entry.start } else { ProgramDistance::from_bits(self.end.0) };
        self.log.push(row, &Entry { start, ..entry }, room);
    }

    /// Records a curve that enters the look-ahead.
    pub(crate) fn pass<const AXES: usize>(&mut self, passed: &Passed<'_, AXES>) {
        let Passed { shape, entry, exit, n, number, driven: [from, to] } = *passed;
        self.cut(from);
        self.settle(number);
        let before = self.exit.map(|exit| {
            let mut axes = [0; AXES];
            axes.iter_mut().zip(exit).for_each(|(to, from)| *to = from);
            axes
        });
        if self.driven.replace(to).is_none() {
            return;
        }
        let made = describe(shape, entry, before.as_ref());
        let start = self.end.0;
        self.extend(to.wrapping_sub(from));
        let length = ProgramDistance::from_bits(self.end.0.wrapping_sub(start));
        let start = ProgramDistance::from_bits(start);
        let made = Entry { n, id: number, start, length, ..made };
        self.window.push(&mut self.rows[0], &made, self.window.room().min(self.most));
        if self.rows[1].flags == ACTIVE {
            self.put(made);
        }
        let mut kept = [0; DIRECTIONS];
        kept.iter_mut().zip(exit.tangent).for_each(|(to, from)| *to = from);
        self.exit = Some(kept);
        self.show();
    }
}
