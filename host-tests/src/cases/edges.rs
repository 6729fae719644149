//! Programs at the edges of the permitted range: shortest blocks, reversals, tangential and nearly tangential
//! transitions, rotary motion only, blocks without motion, largest coordinates.
use super::Program;

/// All edge programs for a three-axis machine.
pub fn three_axes() -> Vec<Program> {
    let new = |name: &str| Program::new(name, 3);
    let mut programs = vec![
        new("one nanometre").line(&[0.000_001], 1000.0),
        new("one micrometre").line(&[0.001], 1000.0),
        new("there and back").line(&[20.0], 6000.0).line(&[0.0], 6000.0).line(&[20.0], 6000.0),
        new("same direction")
            .line(&[10.0, 10.0], 6000.0)
            .line(&[30.0, 30.0], 6000.0)
            .line(&[31.0, 31.0], 6000.0),
        new("feed steps")
            .line(&[30.0], 12000.0)
            .line(&[31.0], 60.0)
            .line(&[60.0], 12000.0)
            .line(&[90.0], 600.0),
        new("nearly straight")
            .line(&[10.0, 0.0], 6000.0)
            .line(&[20.0, 0.000_001], 6000.0)
            .line(&[30.0, 0.0], 6000.0),
        new("nearly reversed").line(&[10.0, 0.0], 6000.0).line(&[0.0, 0.001], 6000.0),
        new("no motion between").line(&[10.0], 6000.0).line(&[10.0], 6000.0).line(&[20.0], 6000.0),
        new("slow").line(&[0.5, 0.5], 1.0),
        new("long way").line(&[30_000.0, -20_000.0, 10_000.0], 60_000.0),
        new("far away").line(&[90_000.0, -90_000.0], 60_000.0).rapid().arc(
            &[90_000.0, -90_000.0],
            [5.0, 0.0],
            true,
            3000.0,
        ),
        new("large circle").arc(&[0.0, 0.0], [2000.0, 0.0], false, 30_000.0),
        new("small circle").arc(&[0.0, 0.0], [0.01, 0.0], false, 3000.0).line(&[0.0, 5.0], 3000.0),
        new("short arc").arc(&[0.001, 0.0], [0.000_5, 40.0], false, 3000.0).line(&[5.0, 0.0], 3000.0),
        // The end is 1 µm off the circle through the start.
        new("radius changes")
            .line(&[5.0], 3000.0)
            .arc(&[15.001, 10.0], [0.0, 10.0], false, 3000.0)
            .line(&[15.001, 20.0], 3000.0),
        new("rapid and feed")
            .line(&[50.0], 3000.0)
            .rapid()
            .line(&[60.0], 3000.0)
            .line(&[100.0], 3000.0)
            .rapid(),
    ];
    let mut short = new("two hundred blocks of 1 µm");
    for i in 1..=200 {
        short = short.line(&[0.001 * f64::from(i)], 6000.0);
    }
    programs.push(short);
    let mut zigzag = new("zigzag of 10 µm");
    for i in 1..=100 {
        zigzag = zigzag.line(&[0.01 * f64::from(i), 0.01 * f64::from(i % 2)], 6000.0);
    }
    programs.push(zigzag);
    let mut sharp = new("fan").line(&[20.0, 0.0], 6000.0);
    for i in 1..=12 {
        let angle = f64::from(i) * 15.0_f64.to_radians();
        sharp = sharp.line(&[0.0, 0.0], 6000.0).line(&[20.0 * angle.cos(), 20.0 * angle.sin()], 6000.0);
    }
    programs.push(sharp);
    programs
}

/// Edge programs for tracking axes: machine X Y Z A.
pub fn rotary() -> Vec<Program> {
    let new = |name: &str| Program::new(name, 4);
    vec![
        new("rotary alone").line(&[0.0, 0.0, 0.0, 90.0], 3000.0).line(&[0.0, 0.0, 0.0, 0.0], 3000.0),
        new("rotary along").line(&[50.0, 0.0, 0.0, 30.0], 6000.0).line(&[100.0, 0.0, 0.0, 60.0], 6000.0),
        new("rotary starts").line(&[50.0, 0.0, 0.0, 0.0], 6000.0).line(&[100.0, 0.0, 0.0, 60.0], 6000.0),
        new("almost rotary alone")
            .line(&[0.01, 0.0, 0.0, 90.0], 6000.0)
            .line(&[20.0, 0.0, 0.0, 90.0], 6000.0),
        new("far more rotary")
            .line(&[0.000_1, 0.0, 0.0, 45.0], 6000.0)
            .line(&[0.0, 0.0, 0.0, 0.0], 6000.0)
            .rapid(),
        new("helix and rotary")
            .arc(&[0.0, 0.0, 3.0, 360.0], [8.0, 0.0], false, 3000.0)
            .line(&[0.0, 9.0, 3.0, 300.0], 3000.0),
    ]
}
