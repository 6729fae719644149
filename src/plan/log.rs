//! Writes the log of the path ahead for a PLC (feature `plc`): each curve that enters the look-ahead, and the
//! log's commands between them.
use super::Planning;
use super::intake::{Entrance, Pass};
use crate::contour_log::{Crowded, Passed, Recorder};
use crate::machine::{FB_STORAGE_MIN, InterpolatorFunctions};
use crate::nc::ContourLog;
use crate::path::Piece;

/// Data of the intake for a PLC.
pub(super) struct Plc<'q> {
    pub recorder: Option<Recorder<'q>>,
    /// Whether a real-time loop is being taken. Long curves are then divided into two blocks.
    pub parts: bool,
}

impl Plc<'_> {
    pub const NONE: Self = Self { recorder: None, parts: false };
}

impl<const AXES: usize, const BLOCKS: usize> Entrance<'_, '_, AXES, BLOCKS> {
    /// Records the last curve that was put into the queue. `from`: the driven distance at its start.
    #[inline(never)]
    pub(super) fn record(&mut self, element: &Piece<'_, AXES>, from: i64, pass: &Pass) {
        let Some(recorder) = &mut self.plc.recorder else { return };
        let Piece { shape, entry, exit, .. } = *element;
        let driven = [from, self.segments.driven_end()];
        let Pass { n, number, .. } = *pass;
        recorder.pass(&Passed { shape, entry, exit, n, number, driven });
    }
}

impl<'q, const AXES: usize, const BLOCKS: usize> Planning<'q, AXES, BLOCKS> {
    /// Starts the log of the path ahead, if P-CHAN-00650 enables it (FCT_CONTOUR_LAH).
    pub fn set_recorder(&mut self, mut recorder: Recorder<'q>) {
        let interpolator = &self.intake.machine.channel.interpolator;
        if !interpolator.has(InterpolatorFunctions::CONTOUR_LAH) {
            return;
        }
        recorder.keep(interpolator.log_max);
        recorder.start(self.queue.segments.driven_end());
        self.intake.plc.recorder = Some(recorder);
    }

    /// Memory for stored blocks, in bytes, as the machine data limit it (P-STUP-00033). The log by index and
    /// real-time loops use this memory. 0: both are refused.
    pub const fn storage(&self) -> u32 {
        let bytes = self.intake.machine.channel.interpolator.fb_storage_size;
        if bytes == 0 || bytes > FB_STORAGE_MIN { bytes } else { FB_STORAGE_MIN }
    }

    /// Whether there is a log of the path ahead.
    pub fn has_recorder(&self) -> bool {
        self.intake.plc.recorder.is_some()
    }

    /// Starts the log for a new program: the distances in the log count from here.
    pub fn start_log(&mut self) {
        let driven = self.queue.segments.driven_end();
        if let Some(recorder) = &mut self.intake.plc.recorder {
            recorder.start(driven);
        }
    }

    /// Empties the log, because the lines that were read ahead of the motion are dropped. The known path then
    /// ends at the coming stop.
    pub fn cut_log(&mut self) {
        self.intake.plc.parts = false;
        let driven = self.queue.segments.driven_end();
        if let Some(recorder) = &mut self.intake.plc.recorder {
            recorder.cut(driven);
            recorder.leave_loop();
        }
    }

    /// Places the commands of the log on the path, as soon as all motion blocks before them are in the
    /// look-ahead.
    pub fn settle_log(&mut self) {
        use crate::smooth::Smoother;
        if self.intake.held.is_none() && self.intake.smoothing.is_empty() {
            let taken = self.intake.taken;
            if let Some(recorder) = &mut self.intake.plc.recorder {
                recorder.settle(taken);
            }
        }
    }

    /// Carries out `#CONTOUR LOOKAHEAD LOG CLEAR`: clears the log at a standstill before the next motion
    /// block. No block is taken until then.
    ///
    /// # Errors
    /// Too many commands wait for one motion block.
    pub fn clear_log(&mut self, n: u32) -> Result<(), Crowded> {
        self.log(n, ContourLog::Clear)
    }

    /// Whether `#DISTANCE PROG START CLEAR` still waits for a stop of the axes. At the stop, the call carries
    /// out the command and returns `false`. Call this function only after [`super::Work::Hungry`].
    pub fn waits_for_log(&mut self) -> bool {
        let waits = self.intake.plc.recorder.as_ref().is_some_and(Recorder::waits_for_rest);
        if waits && self.is_at_rest() {
            let taken = self.intake.taken;
            if let Some(recorder) = &mut self.intake.plc.recorder {
                recorder.clear_at_rest(taken);
            }
            return false;
        }
        waits
    }

    /// Takes a command of the log after the last motion block. Call this function only after
    /// [`super::Work::Hungry`].
    ///
    /// # Errors
    /// Too many commands wait for one motion block.
    pub fn log(&mut self, n: u32, log: ContourLog) -> Result<(), Crowded> {
        self.let_go();
        let taken = self.intake.taken;
        self.intake.plc.recorder.as_mut().map_or(Ok(()), |recorder| recorder.command(n, taken, log))?;
        self.settle_log();
        Ok(())
    }

    /// Takes `#DISTANCE PROG START CLEAR` after the last motion block. Call this function only after
    /// [`super::Work::Hungry`].
    ///
    /// # Errors
    /// Too many commands wait for one motion block.
    pub fn clear_distance(&mut self, n: u32) -> Result<(), Crowded> {
        self.let_go();
        let taken = self.intake.taken;
        self.intake.plc.recorder.as_mut().map_or(Ok(()), |recorder| recorder.clear_distance(n, taken))?;
        self.settle_log();
        Ok(())
    }
}
