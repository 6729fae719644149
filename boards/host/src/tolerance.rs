//! The permitted deviation from the programmed path, from the smoothing commands of the program.
use glidepath::nc::{Contour, ContourMethod, ContourSwitch, Hsc, HscMethod};
use glidepath::quantity::Position;

/// Tolerances that are monitored.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// Of the main axes, mm.
    pub path: Option<f64>,
    /// Of every other axis, mm or degrees.
    pub track: Option<f64>,
}

/// Contour mode: whether it is on, for one block, and its tolerances.
#[derive(Clone, Copy, Debug)]
struct ContourState {
    on: bool,
    once: bool,
    method: ContourMethod,
    path_dev: f64,
    /// 0: not monitored.
    track_dev: f64,
    /// PTP: PATH_DEV was given after PTP was selected.
    given: bool,
}

/// Tolerances of a method of #HSC, mm or degrees; without a tolerance for rapid motion, the other one
/// applies.
#[derive(Clone, Copy, Debug)]
struct Deviations {
    path: f64,
    path_g00: Option<f64>,
    track: f64,
    track_g00: Option<f64>,
}

/// #HSC: whether it is on, and the tolerances of its methods, which are separate.
#[derive(Clone, Copy, Debug)]
struct HscState {
    on: bool,
    /// The method named last.
    method: HscMethod,
    surface: Deviations,
    bspline: Deviations,
    /// CONTERROR.
    conterror: f64,
}

/// Smoothing in the program so far.
pub struct Smoothing {
    contour: ContourState,
    hsc: HscState,
}

/// The programmed value, without the rounding of a position.
fn decimal(value: Position) -> f64 {
    (value.to_num::<f64>() * 1e9).round() / 1e9
}

fn set(value: &mut f64, given: Option<Position>) {
    *value = given.map_or(*value, decimal);
}

impl Deviations {
    /// State at program start, with this TRACK_DEV.
    const fn unless_given(track: f64) -> Self {
        Self { path: 0.2, path_g00: None, track, track_g00: None }
    }

    /// Takes the values of a command; those of rapid motion are keywords of Surface only.
    fn take(&mut self, command: &Hsc, rapid: bool) {
        set(&mut self.path, command.path_dev);
        set(&mut self.track, command.track_dev);
        if rapid {
            self.path_g00 = command.path_dev_g00.map(decimal).or(self.path_g00);
            self.track_g00 = command.track_dev_g00.map(decimal).or(self.track_g00);
        }
    }

    /// The monitored tolerances; 0: not monitored.
    fn tolerance(&self, rapid: bool) -> Tolerance {
        let of = |feed: f64, of_rapid: Option<f64>| if rapid { of_rapid.unwrap_or(feed) } else { feed };
        let monitored = |value: f64| (value > 0.0).then_some(value);
        Tolerance {
            path: monitored(of(self.path, self.path_g00)),
            track: monitored(of(self.track, self.track_g00)),
        }
    }
}

impl Smoothing {
    /// State at program start.
    pub fn new() -> Self {
        let method = ContourMethod::Dev;
        Self {
            contour: ContourState {
                on: false,
                once: false,
                method,
                path_dev: 1.0,
                track_dev: 0.0,
                given: false,
            },
            hsc: HscState {
                on: false,
                method: HscMethod::Surface,
                surface: Deviations::unless_given(2.0),
                bspline: Deviations::unless_given(5.0),
                conterror: 0.1,
            },
        }
    }

    /// #CONTOUR MODE, G61, G261, G260.
    pub fn contour(&mut self, command: &Contour) {
        let state = &mut self.contour;
        if let Some(method) = command.method {
            state.given &= method == state.method;
            state.method = method;
        }
        state.given |= command.path_dev.is_some();
        set(&mut state.path_dev, command.path_dev);
        set(&mut state.track_dev, command.track_dev);
        match command.switch {
            Some(ContourSwitch::On) => state.on = true,
            Some(ContourSwitch::Off) => (state.on, state.once) = (false, false),
            Some(ContourSwitch::Block) => state.once = true,
            None => {}
        }
    }

    /// #HSC. While #HSC is on, its parameters do not change. For a command with parameters the library then
    /// gives warning 120542: `false`.
    pub fn hsc(&mut self, command: &Hsc) -> bool {
        let state = &mut self.hsc;
        if state.on && command.gives_parameters() && command.switch != Some(false) {
            return false;
        }
        state.on = command.switch.unwrap_or(state.on);
        state.method = command.method.unwrap_or(state.method);
        match (command.method, state.method) {
            (Some(HscMethod::Bspline), _) => state.bspline.take(command, false),
            (_, HscMethod::Surface) => state.surface.take(command, true),
            _ => {}
        }
        set(&mut state.conterror, command.conterror);
        true
    }

    /// Whether the corner after the next motion may be rounded.
    pub fn is_on(&self) -> bool {
        self.hsc.on || self.contour.on || self.contour.once
    }

    /// Tolerances of the next motion.
    pub fn tolerance(&self, rapid: bool) -> Tolerance {
        if self.hsc.on {
            let HscState { surface, bspline, method, conterror, .. } = self.hsc;
            return match method {
                HscMethod::Surface => surface.tolerance(rapid),
                HscMethod::Bspline => bspline.tolerance(rapid),
                HscMethod::Op(mode) => Tolerance { path: (mode == 1).then_some(conterror), track: None },
            };
        }
        if !self.is_on() {
            return Tolerance::default();
        }
        let ContourState { method, path_dev, track_dev, given, .. } = self.contour;
        let path = match method {
            ContourMethod::Dev => true,
            ContourMethod::Ptp => given,
            _ => false,
        };
        let track = matches!(method, ContourMethod::Dev | ContourMethod::Dist) && track_dev > 0.0;
        Tolerance { path: path.then_some(path_dev), track: track.then_some(track_dev) }
    }

    /// A motion has been decoded.
    pub fn passes(&mut self) {
        self.contour.once = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_those_in_force() {
        let mm = |value: f64| Some(Position::from_num(value));
        let mut smoothing = Smoothing::new();
        assert_eq!((smoothing.is_on(), smoothing.tolerance(false)), (false, Tolerance::default()));
        smoothing.contour(&Contour {
            path_dev: mm(0.5),
            switch: Some(ContourSwitch::Block),
            ..Contour::default()
        });
        assert_eq!(smoothing.tolerance(false), Tolerance { path: Some(0.5), track: None });
        smoothing.passes();
        assert!(!smoothing.is_on());
        let on = Some(ContourSwitch::On);
        smoothing.contour(&Contour {
            method: Some(ContourMethod::Dist),
            track_dev: mm(2.0),
            switch: on,
            ..Contour::default()
        });
        assert_eq!(smoothing.tolerance(true), Tolerance { path: None, track: Some(2.0) });
        smoothing.hsc(&Hsc { switch: Some(true), path_dev_g00: mm(1.0), ..Hsc::default() });
        assert_eq!(smoothing.tolerance(false), Tolerance { path: Some(0.2), track: Some(2.0) });
        assert_eq!(smoothing.tolerance(true), Tolerance { path: Some(1.0), track: Some(2.0) });
        smoothing.hsc(&Hsc { switch: Some(false), ..Hsc::default() });
        smoothing.contour(&Contour { switch: Some(ContourSwitch::Off), ..Contour::default() });
        assert!(!smoothing.is_on());
    }
    #[test]
    fn parameters_of_hsc_stay_while_it_is_on() {
        let mut smoothing = Smoothing::new();
        let mut with = |switch, mm: Option<f64>| {
            let path_dev = mm.map(Position::from_num);
            let taken = smoothing.hsc(&Hsc { switch, path_dev, ..Hsc::default() });
            (taken, smoothing.tolerance(false).path)
        };
        assert_eq!(with(None, Some(0.05)), (true, None));
        assert_eq!(with(Some(true), None), (true, Some(0.05)));
        for switch in [None, Some(true)] {
            assert_eq!(with(switch, Some(0.001)), (false, Some(0.05)));
        }
        assert_eq!(with(Some(true), None), (true, Some(0.05)));
        // Parameters given while switched off apply to the next time.
        assert_eq!(with(Some(false), Some(0.001)), (true, None));
        assert_eq!(with(Some(true), None), (true, Some(0.001)));
    }

    #[test]
    fn each_method_of_hsc_has_its_own_deviations() {
        let mut smoothing = Smoothing::new();
        let mut with = |method, mm: Option<f64>| {
            let (method, path_dev) = (Some(method), mm.map(Position::from_num));
            smoothing.hsc(&Hsc { switch: Some(true), method, path_dev, ..Hsc::default() });
            let Tolerance { path, track } = smoothing.tolerance(false);
            smoothing.hsc(&Hsc { switch: Some(false), ..Hsc::default() });
            (path, track)
        };
        assert_eq!(with(HscMethod::Bspline, Some(0.05)), (Some(0.05), Some(5.0)));
        assert_eq!(with(HscMethod::Surface, None), (Some(0.2), Some(2.0)));
        assert_eq!(with(HscMethod::Surface, Some(0.01)), (Some(0.01), Some(2.0)));
        assert_eq!(with(HscMethod::Bspline, None), (Some(0.05), Some(5.0)));
    }

    #[test]
    fn opmode_1_has_conterror_and_opmode_2_nothing() {
        let mut smoothing = Smoothing::new();
        let mut with = |mode, mm: f64| {
            let method = Some(HscMethod::Op(mode));
            let conterror = Some(Position::from_num(mm));
            smoothing.hsc(&Hsc { switch: Some(true), method, conterror, ..Hsc::default() });
            let tolerance = smoothing.tolerance(false);
            smoothing.hsc(&Hsc { switch: Some(false), ..Hsc::default() });
            tolerance
        };
        assert_eq!(with(1, 0.02), Tolerance { path: Some(0.02), track: None });
        assert_eq!(with(2, 0.02), Tolerance::default());
    }
}
