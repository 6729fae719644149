//! Random programs of words that both dialects, or only LinuxCNC, have.
use crate::nc_decode::Random;

/// A program.
pub fn program(seed: u64, dialect: &str) -> String {
    let (grbl, fanuc) = (dialect != "linuxcnc", dialect == "fanuc");
    let random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let mut writer = Writer { random, grbl, fanuc, cycle: 0 };
    let mut text = String::from(if writer.once_in(3) { "%\n" } else { "" });
    text.push_str("F333\n");
    for _ in 0..writer.random.below(40) + 5 {
        let words = writer.block();
        text.push_str(&writer.line(words));
        text.push('\n');
    }
    if writer.once_in(2) {
        text.push_str(["M2\n", "M30\n", "%\n"][writer.random.below(3) as usize]);
        text.push_str("G0 X999\n");
    }
    text
}

struct Writer {
    random: Random,
    grbl: bool,
    fanuc: bool,
    /// The cycle in force, 0 none.
    cycle: u32,
}

impl Writer {
    fn once_in(&mut self, count: u64) -> bool {
        self.random.below(count) == 0
    }

    fn number(&mut self, most: u64) -> String {
        let scale = 10_u64.pow(self.random.below(5) as u32);
        let value = self.random.below(most * scale);
        let (whole, part) = (value / scale, value % scale);
        let sign = ["", "-", "+", ""][self.random.below(4) as usize];
        if scale == 1 {
            return format!("{sign}{whole}{}", ["", "."][self.random.below(2) as usize]);
        }
        let digits = scale.to_string().len() - 1;
        let whole = if whole == 0 && self.once_in(2) { String::new() } else { whole.to_string() };
        format!("{sign}{whole}.{part:0digits$}")
    }

    fn positive(&mut self, most: u64) -> String {
        format!("{}.{}", self.random.below(most), self.random.below(9) + 1)
    }

    fn axes(&mut self, letters: &[char]) -> Vec<String> {
        let mut words = Vec::new();
        for letter in letters {
            if self.once_in(2) {
                let number = self.number(30);
                words.push(format!("{letter}{number}"));
            }
        }
        words
    }

    fn block(&mut self) -> Vec<String> {
        let mut words = self.settings();
        let kind = self.random.below(14);
        match kind {
            0..=4 => {
                self.cycle = 0;
                words.push(["G0", "G1", "G00", "G01"][self.random.below(4) as usize].into());
                words.extend(self.axes(&['X', 'Y', 'Z']));
                if self.once_in(8) {
                    if self.fanuc {
                        words.retain(|word| !matches!(word.as_str(), "G90" | "G91"));
                        words.push("G90".into());
                    }
                    words.push("G53".into());
                }
            }
            5 | 6 => {
                self.cycle = 0;
                words.retain(|word| !matches!(word.as_str(), "G17" | "G18" | "G19"));
                words.push("G17".into());
                words.push(["G2", "G3"][self.random.below(2) as usize].into());
                words.extend(self.axes(&['X', 'Y', 'Z']));
                words.push(format!("I{}", self.number(9)));
                words.push(format!("J{}", self.number(9)));
                if !self.grbl && self.once_in(4) && !words.iter().any(|word| word.starts_with("G64")) {
                    words.push(format!("P{}", self.random.below(4) + 1));
                }
            }
            7 => {
                words.push(["G28", "G30"][self.random.below(2) as usize].into());
                words.extend(self.axes(&['X', 'Y', 'Z']));
            }
            8 if self.fanuc => words.push("G9".into()),
            8 => words.push(["G28.1", "G30.1"][self.random.below(2) as usize].into()),
            9 => {
                let axis = ['X', 'Y', 'Z'][self.random.below(3) as usize];
                let number = self.number(30);
                let many = if self.fanuc { 3 } else { 4 };
                words.push(["G92", "G92", "G10 L2 P", "G10 L20 P"][self.random.below(many) as usize].into());
                if words.last().is_some_and(|word| word.starts_with("G10")) {
                    words.retain(|word| !word.starts_with("G64"));
                    let set = if self.fanuc { self.random.below(6) + 1 } else { self.random.below(10) };
                    words.last_mut().unwrap().push_str(&set.to_string());
                }
                words.push(format!("{axis}{number}"));
            }
            10 if self.fanuc => words.push(format!("G4 X{}", self.number(3).trim_start_matches(['-', '+']))),
            10 => {
                let more = if self.grbl { 1 } else { 3 };
                words.push(["G92.1", "G92.2", "G92.3"][self.random.below(more) as usize].into());
            }
            11 => {
                if words.iter().all(|word| !word.starts_with("G64")) {
                    words.push(format!("G4 P{}", self.positive(5)));
                }
            }
            12 => {
                words.extend(self.functions());
                let free = words.iter().all(|word| !word.starts_with("G64"));
                if !self.fanuc && free && self.once_in(2) {
                    let outputs = [
                        "M62 P1",
                        "M63 P2",
                        "M64 P3",
                        "M65 P0",
                        "M66 P4 L3 Q2.5",
                        "M66 E1",
                        "M67 E2 Q-0.5",
                        "M68 E0 Q3",
                    ];
                    words.push(outputs[self.random.below(8) as usize].into());
                }
            }
            _ => {
                words.retain(|word| {
                    !matches!(word.as_str(), "G17" | "G18" | "G19") && !word.starts_with("G64")
                });
                words.push("G17".into());
                words.extend(self.holes());
            }
        }
        words
    }

    fn settings(&mut self) -> Vec<String> {
        let mut words = Vec::new();
        let mut may = |writer: &mut Self, choices: &[&str]| {
            if writer.once_in(6) {
                words.push(choices[writer.random.below(choices.len() as u64) as usize].to_owned());
            }
        };
        may(self, &["G20", "G21"]);
        may(self, &["G90", "G91"]);
        may(self, &["G17", "G18", "G19"]);
        let sets = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];
        may(self, if self.fanuc { &sets[..6] } else { &sets });
        may(self, &["G94"]);
        may(self, &["G40"]);
        may(self, &["G97"]);
        may(self, &["M48"]);
        may(self, &["G49", "G43 H1", "G43 H2", "G43 H3"]);
        may(
            self,
            if self.fanuc {
                &["G61", "G64"]
            } else if self.grbl {
                &["G61"]
            } else {
                &["G61", "G61.1", "G64 P0.5", "G64 P0.01"]
            },
        );
        may(self, &["G98", "G99"]);
        if self.once_in(4) {
            words.push(format!("F{}", self.positive(900)));
        }
        words
    }

    fn functions(&mut self) -> Vec<String> {
        let mut words = vec![format!("S{}", self.random.below(9999))];
        let mut may = |writer: &mut Self, choices: &[&str]| {
            if writer.once_in(2) {
                words.push(choices[writer.random.below(choices.len() as u64) as usize].to_owned());
            }
        };
        may(self, &["M3", "M4", "M5", "M05"]);
        may(self, &["M8", "M9"]);
        may(self, &["M7"]);
        may(self, &["M6"]);
        may(self, &["T0", "T1", "T2"]);
        may(self, &["M0", "M60", "M1"]);
        words
    }

    /// A block of a cycle whose levels are right in absolute and in incremental coordinates: R is 0 to 9, Z below it.
    fn holes(&mut self) -> Vec<String> {
        const CYCLES: [u32; 9] = [81, 82, 83, 73, 85, 89, 84, 86, 74];
        let cycle = CYCLES[self.random.below(if self.grbl && !self.fanuc { 8 } else { 9 }) as usize];
        self.cycle = cycle;
        let mut words = vec![format!("G{cycle}"), format!("R{}", self.positive(9))];
        words.push(format!("Z-{}", self.positive(9)));
        words.extend(self.axes(&['X', 'Y']));
        match cycle {
            82 | 89 => words.push(format!("P{}", self.positive(2))),
            84 | 74 | 86 => {
                words.push(if cycle == 74 { "M4".into() } else { "M3".into() });
                if self.once_in(2) {
                    words.push(format!("P{}", self.positive(2)));
                }
            }
            83 | 73 => words.push(format!("Q{}", self.positive(4))),
            _ => {}
        }
        if self.once_in(4) {
            let letter = if self.fanuc { 'K' } else { 'L' };
            words.push(format!("{letter}{}", self.random.below(3) + 1));
        }
        words
    }

    /// Words in any order and look.
    fn line(&mut self, words: Vec<String>) -> String {
        let mut words: Vec<String> =
            words.iter().flat_map(|word| word.split(' ')).map(str::to_owned).collect();
        for k in (1..words.len()).rev() {
            words.swap(k, self.random.below(k as u64 + 1) as usize);
        }
        if self.once_in(4) {
            let at = self.random.below(words.len() as u64 + 1) as usize;
            words.insert(at, format!("N{}", self.random.below(99_999)));
        }
        let gap = ["", " ", "  ", "\t", " (note) "]
            [self.random.below(if words.len() < 9 { 5 } else { 4 }) as usize];
        let mut line = words.join(gap);
        if self.once_in(5) {
            line = line.to_lowercase();
        }
        if self.once_in(9) {
            line = line.chars().map(|c| format!("{c} ")).collect();
        }
        if self.once_in(9) {
            line.push_str(" ; G0 X5");
        }
        if self.once_in(9) {
            line.insert_str(0, "(MSG, one (two)");
        }
        line
    }
}
