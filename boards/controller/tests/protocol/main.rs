//! Every byte, line and state of the protocol, with answers compared character for character.
#[path = "../bench/mod.rs"]
mod bench;
mod bytes;
mod lines;
mod reports;
mod settings;
mod states;

use bench::{Talk, names, serial};
use glidepath::quantity::Position;
use glidepath_controller::{Config, Signals, Spindle};

fn mm(value: f64) -> Position {
    Position::from_num(value)
}

/// A controller in a state of that name.
fn in_state(name: &str) -> Talk<'static> {
    let mut config = Config::new(names());
    config.settings.homing = true;
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.said("\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n");
    if name != "Alarm" {
        talk.ask("$X", "[MSG:Caution: Unlocked]\nok\n");
    }
    match name {
        "Run" => {
            talk.mock.frozen = true;
            talk.ask("G0X1", "ok\n");
        }
        "Hold:0" => talk.send("!"),
        "Hold:1" => {
            talk.mock.frozen = true;
            talk.ask("G0X1", "ok\n");
            talk.send("!");
        }
        "Jog" => {
            talk.mock.frozen = true;
            talk.ask("$J=X1F100", "ok\n");
        }
        "Door:0" => talk.send([0x84]),
        "Door:1" => talk.signals = Signals::DOOR,
        "Door:2" => {
            talk.mock.frozen = true;
            talk.ask("G0X1", "ok\n");
            talk.send([0x84]);
        }
        "Door:3" => {
            talk.mock.modal.spindle = Spindle::Clockwise;
            talk.mock.step();
            talk.send([0x84]);
            talk.poll();
            talk.send("~");
        }
        "Check" => talk.ask("$C", "[MSG:Enabled]\nok\n"),
        "Home" => {
            talk.send("$H\n");
            talk.poll();
            talk.said("");
        }
        "Sleep" => talk.ask("$SLP", "ok\n[MSG:Sleeping]\n"),
        _ => {}
    }
    talk.poll();
    talk.said("");
    assert_eq!(talk.state(), name);
    talk
}

const STATES: [&str; 13] = [
    "Idle", "Run", "Hold:0", "Hold:1", "Jog", "Alarm", "Door:0", "Door:1", "Door:2", "Door:3", "Check",
    "Home", "Sleep",
];
