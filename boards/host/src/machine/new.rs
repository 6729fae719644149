//! Makes machine files of common kinds from a few options.
use super::sheet::{Axis, Sheet, Taken};

/// A kind of machine.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
pub enum Kind {
    /// A desktop router of the 3018 kind: lead screws, Grbl.
    Router,
    /// A milling machine of a workshop: ball screws.
    Mill,
    /// A laser on a gantry: belts, fast and light.
    Laser,
    /// A milling machine with a rotary axis A.
    #[value(name = "4axis")]
    FourAxis,
}

/// What is asked for in place of what its kind has.
#[derive(clap::Args)]
pub struct Options {
    /// Kind of machine.
    #[arg(long, value_enum)]
    pub kind: Kind,
    /// Largest speed of X and Y, mm/min; that of Z keeps its share.
    #[arg(long, value_name = "MM_MIN", value_parser = within::<1, 1_000_000>)]
    speed: Option<f64>,
    /// Acceleration of X and Y, mm/s²; that of Z keeps its share.
    #[arg(long, value_name = "MM_S2", value_parser = within::<1, 1_000_000>)]
    acceleration: Option<f64>,
    /// Time in which acceleration rises or falls, ms.
    #[arg(long, value_name = "MS", value_parser = within::<1, 10_000>)]
    ramp: Option<f64>,
    /// Travel of X, Y and Z, mm.
    #[arg(long, value_name = "X,Y,Z", value_parser = travel)]
    travel: Option<Travel>,
}

/// Lengths of three axes.
#[derive(Clone, Copy, Debug)]
struct Travel([f64; 3]);

/// A number of the command line in a range.
fn within<const LEAST: u32, const MOST: u32>(text: &str) -> Result<f64, String> {
    let range = f64::from(LEAST)..=f64::from(MOST);
    let value = text.parse().ok().filter(|value| range.contains(value));
    value.ok_or_else(|| format!("expected a number of {LEAST} to {MOST}"))
}

fn travel(text: &str) -> Result<Travel, String> {
    let lengths: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    let lengths = <[f64; 3]>::try_from(lengths).ok().filter(|_| text.split(',').count() == 3);
    let lengths = lengths.filter(|all| all.iter().all(|length| (1.0..=100_000.0).contains(length)));
    lengths
        .map(Travel)
        .ok_or_else(|| "expected three lengths of 1 to 100000 mm, for example 300,180,45".into())
}

/// Numbers of a kind: mm/min, mm/s², ms, mm.
struct Preset {
    title: &'static str,
    speed: [f64; 3],
    acceleration: [f64; 3],
    ramp: f64,
    travel: [f64; 3],
    /// Z counts from its upper end down.
    hangs: bool,
    dialect: Option<&'static str>,
    /// Degrees/min, degrees/s².
    rotary: Option<[f64; 2]>,
}

fn preset(kind: Kind) -> Preset {
    match kind {
        Kind::Router => Preset {
            title: "A desktop router of the 3018 kind: 300 x 180 x 45 mm, lead screws, small motors.",
            speed: [2000.0, 2000.0, 800.0],
            acceleration: [100.0, 100.0, 50.0],
            ramp: 20.0,
            travel: [300.0, 180.0, 45.0],
            hangs: true,
            dialect: Some("grbl"),
            rotary: None,
        },
        Kind::Mill => Preset {
            title: "A milling machine of a workshop: 600 x 400 x 400 mm, ball screws, servo drives.",
            speed: [12_000.0, 12_000.0, 8000.0],
            acceleration: [1500.0, 1500.0, 1000.0],
            ramp: 60.0,
            travel: [600.0, 400.0, 400.0],
            hangs: true,
            dialect: None,
            rotary: None,
        },
        Kind::Laser => Preset {
            title: "A laser on a gantry: 600 x 400 mm, belts, a light head; Z sets the focus.",
            speed: [30_000.0, 30_000.0, 600.0],
            acceleration: [5000.0, 4000.0, 100.0],
            ramp: 10.0,
            travel: [600.0, 400.0, 50.0],
            hangs: false,
            dialect: Some("grbl"),
            rotary: None,
        },
        Kind::FourAxis => Preset {
            title: "A milling machine with a rotary axis A along X: 600 x 400 x 120 mm, ball screws, stepper motors.",
            speed: [5000.0, 5000.0, 3000.0],
            acceleration: [500.0, 500.0, 300.0],
            ramp: 40.0,
            travel: [600.0, 400.0, 120.0],
            hangs: true,
            dialect: None,
            rotary: Some([5400.0, 500.0]),
        },
    }
}

/// Returns the text of the machine file for these options.
pub fn new(options: &Options) -> String {
    let preset = preset(options.kind);
    let typical = "typical of the kind: put yours here";
    let scaled = |given: Option<f64>, of: [f64; 3], axis: usize| match given {
        Some(value) if axis < 2 => Taken::new(value, "as asked for"),
        Some(value) => Taken::new(value * of[axis] / of[0], "as asked for, with the share of Z"),
        None => Taken::new(of[axis], typical),
    };
    let ramp = match options.ramp {
        Some(ramp) => Taken::new(ramp, "as asked for: jerk is acceleration / ramp time"),
        None => Taken::new(preset.ramp, "jerk is acceleration / ramp time"),
    };
    let linear = |axis: usize| {
        let speed = scaled(options.speed, preset.speed, axis);
        let speed = Taken::new(speed.value / 60.0, speed.from);
        let travel = options.travel.map_or(preset.travel[axis], |travel| travel.0[axis]);
        let [least, most] = if axis == 2 && preset.hangs { [-travel, 0.0] } else { [0.0, travel] };
        let from = if axis == 2 && preset.hangs { "0 is its upper end" } else { "" };
        Axis {
            name: ["X", "Y", "Z"][axis].into(),
            rotary: false,
            rapid: speed.clone(),
            speed,
            acceleration: scaled(options.acceleration, preset.acceleration, axis),
            ramp: ramp.clone(),
            travel: Some([Taken::new(least, from), Taken::new(most, "")]),
            steps: Vec::new(),
        }
    };
    let mut axes: Vec<Axis> = (0..3).map(linear).collect();
    if let Some([speed, acceleration]) = preset.rotary {
        let speed = Taken::new(speed / 60.0, typical);
        axes.push(Axis {
            name: "A".into(),
            rotary: true,
            rapid: speed.clone(),
            speed,
            acceleration: Taken::new(acceleration, typical),
            ramp,
            travel: None,
            steps: Vec::new(),
        });
    }
    let name = clap::ValueEnum::to_possible_value(&options.kind).map(|value| value.get_name().to_owned());
    let sheet = Sheet {
        title: vec![
            preset.title.into(),
            format!("Written by `glidepath machine new --kind {}`.", name.unwrap_or_default()),
        ],
        cycle: None,
        dialect: preset.dialect.map(|dialect| (dialect, "the language of its programs".into())),
        axes,
        left: Vec::new(),
    };
    sheet.text()
}
