//! Status reports, and the overrides in them.
use crate::bench::{Talk, names, serial};
use crate::mm;
use glidepath_controller::{Config, Overrides, Signals};

#[test]
fn status_reports() {
    let mut talk = Talk::new();
    talk.mock.status.position = [mm(1.0005), mm(-2.0), mm(0.0)];
    let report = |talk: &mut Talk<'_>, text: &str| {
        talk.send("???");
        talk.poll();
        talk.said(&format!("{text}\r\n"));
    };
    // Offsets first, overrides in the next one, then both every tenth at rest.
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000>");
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|Ov:100,100,100>");
    for _ in 0..8 {
        report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0>");
    }
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000>");
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|Ov:100,100,100>");
    // Changes are told at once.
    talk.send([0x91, 0x91, 0x94, 0x97, 0x9b]);
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|Ov:119,25,90>");
    talk.ask("G92X0", "ok\n");
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,0|WCO:1.001,0.000,0.000>");
    talk.ask("M3S500M8", "ok\n");
    talk.send([0xa1]);
    report(&mut talk, "<Idle|MPos:1.001,-2.000,0.000|Bf:15,128|FS:0,450|Ov:119,25,90|A:SFM>");
    talk.ask("$10=0", "ok\n");
    report(&mut talk, "<Idle|WPos:0.000,-2.000,0.000|FS:0,450>");
    talk.signals = Signals::limit(0).and(Signals::limit(2)).and(Signals::PROBE);
    report(&mut talk, "<Idle|WPos:0.000,-2.000,0.000|FS:0,450|Pn:XZP>");
    talk.signals = Signals::default();
    // While it moves: every thirtieth and every twentieth.
    talk.ask("$10=3", "ok\n");
    talk.mock.frozen = true;
    talk.ask("G1F1200X5", "ok\n");
    let texts: Vec<String> = (0..61)
        .map(|_| {
            talk.send("?");
            talk.poll();
            talk.read()
        })
        .collect();
    let with = |word: &str| {
        texts.iter().enumerate().filter(|(_, text)| text.contains(word)).map(|(i, _)| i).collect::<Vec<_>>()
    };
    assert!(texts[0].starts_with("<Run|MPos:1.001,-2.000,0.000|Bf:14,128|FS:1200,450"), "{}", texts[0]);
    let (offsets, overrides) = (with("|WCO:"), with("|Ov:"));
    assert!(offsets.windows(2).all(|pair| pair[1] - pair[0] == 30), "{offsets:?}");
    assert!(overrides.windows(2).all(|pair| (20..=21).contains(&(pair[1] - pair[0]))), "{overrides:?}");
    assert!(offsets.len() >= 2 && overrides.len() >= 2 && !offsets.iter().any(|i| overrides.contains(i)));
}

#[test]
fn reports_in_inch_with_line_numbers() {
    let mut config = Config::new(names());
    (config.line_numbers, config.settings.inch) = (true, true);
    let mut talk = Talk::with(config, serial());
    talk.poll();
    talk.read();
    talk.mock.frozen = true;
    talk.ask("N7G1X25.4F254", "ok\n");
    talk.send("?");
    talk.poll();
    talk.said("<Run|MPos:0.0000,0.0000,0.0000|Bf:14,128|Ln:7|FS:10.0,0|WCO:0.0000,0.0000,0.0000>\r\n");
}

#[test]
fn overrides_stay_in_their_range() {
    let mut talk = Talk::new();
    talk.send([0x91; 30]);
    talk.send([0x9b; 30]);
    talk.poll();
    assert_eq!(talk.mock.overrides, Some(Overrides { feed: 200, rapid: 100, spindle: 10 }));
    talk.send([0x92; 30]);
    talk.send([0x9a; 30]);
    talk.send([0x96, 0x93]);
    talk.poll();
    assert_eq!(talk.mock.overrides, Some(Overrides { feed: 11, rapid: 50, spindle: 200 }));
    talk.send([0x90, 0x94, 0x95, 0x99, 0x9d, 0x9c, 0x9c]);
    talk.poll();
    assert_eq!(talk.mock.overrides, Some(Overrides { feed: 99, rapid: 100, spindle: 101 }));
    // The end of a program resets them.
    talk.ask("M30", "ok\n");
    talk.poll();
    assert_eq!(talk.mock.overrides, Some(Overrides::FULL));
}
