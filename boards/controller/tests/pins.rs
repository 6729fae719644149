//! Inputs and outputs through embedded-hal, with its mock.
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as PwmTransaction};
use glidepath_controller::pins::{Input, Tool, limits};
use glidepath_controller::{Outputs, Signals, Spindle};

fn reads(levels: &[u8]) -> Pin {
    let transactions: Vec<_> = levels
        .iter()
        .map(|level| Transaction::get(if *level == 1 { State::High } else { State::Low }))
        .collect();
    Pin::new(&transactions)
}

#[test]
fn an_input_is_believed_after_equal_looks() {
    let mut pin = reads(&[0, 1, 0, 1, 1, 1, 1, 0, 0, 1, 0, 0, 0]);
    let mut input = Input::new(pin.clone(), false, 3);
    let seen: Vec<u8> = (0..13).map(|_| u8::from(input.look().expect("the mock reads"))).collect();
    assert_eq!(seen, [0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 0]);
    pin.done();
}

#[test]
fn limit_switches_have_the_order_of_the_axes() {
    let mut pins = [reads(&[1]), reads(&[0]), reads(&[1])];
    // Normally closed: on where the pin is low.
    let mut inputs = pins.clone().map(|pin| Input::new(pin, true, 1));
    assert_eq!(limits(&mut inputs), Ok(Signals::limit(1)));
    for pin in &mut pins {
        pin.done();
    }
}

fn writes(levels: &[u8]) -> Pin {
    let transactions: Vec<_> = levels
        .iter()
        .map(|level| Transaction::set(if *level == 1 { State::High } else { State::Low }))
        .collect();
    Pin::new(&transactions)
}

#[test]
fn spindle_and_coolant_are_put_out() {
    const MOST: u16 = 1000;
    let pwm = [
        PwmTransaction::max_duty_cycle(MOST),
        PwmTransaction::set_duty_cycle(500),
        // The other direction at another speed.
        PwmTransaction::max_duty_cycle(MOST),
        PwmTransaction::set_duty_cycle(1000),
        // Off before anything else.
        PwmTransaction::set_duty_cycle(0),
        // At its lowest speed.
        PwmTransaction::set_duty_cycle(0),
    ];
    let mut tool = Tool {
        pwm: Pwm::new(&pwm),
        enable: writes(&[1, 1, 0, 1]),
        direction: writes(&[0, 1, 0]),
        mist: writes(&[0, 1, 0, 0]),
        flood: writes(&[1, 0, 0, 0]),
    };
    let off = Outputs::default();
    let clockwise = Outputs { spindle: Spindle::Clockwise, ..off };
    for outputs in [
        Outputs { duty: 32_768, flood: true, ..clockwise },
        Outputs { spindle: Spindle::CounterClockwise, duty: 65_535, mist: true, ..off },
        off,
        clockwise,
    ] {
        tool.put_out(&outputs).expect("the mock writes");
    }
    tool.pwm.done();
    for pin in [&mut tool.enable, &mut tool.direction, &mut tool.mist, &mut tool.flood] {
        pin.done();
    }
}
