//! V. variables, #FLUSH and #MSG (feature `plc`).
use glidepath::variable::{Access, Variable};
use host_tests::cases::machines;
use host_tests::loops::run_with;

/// Runs a program. Where the axes stand at the end, and the error.
fn end_of(text: &str, variables: &[Variable]) -> ([f64; 3], Option<String>) {
    let mut end = [0.0; 3];
    let (_, refused) = run_with::<16>(text, &machines::even(1000), variables, |now| {
        end = now.status.set_points.map(|point| point.to_num());
        now.switch.disable();
    });
    (end, refused)
}

/// G-11: V.P. and V.L. in expressions, conditions and words. V.L. belongs to its subroutine.
#[test]
fn own_variables() {
    let text = "%L sub\nV.L.DEPTH = 7\nX=V.L.DEPTH\nM17\n%main\nG01 F6000\nV.P.WIDTH = 4\nV.L.DEPTH = 2\nLL sub\n\
        V.P.WIDTH = V.P.WIDTH * 2 + 1\n$IF V.P.WIDTH == 9\nY=V.P.WIDTH Z[v.l.depth*3]\n$ENDIF\nM30\n";
    assert_eq!(end_of(text, &[]), ([7.0, 9.0, 6.0], None));
    for (text, message) in [
        ("G01 F600 X=V.P.A\n", "variable V.P.A has no value yet"),
        ("%L sub\nV.L.A = 1\nM17\n%main\nLL sub\nG01 F600 X=V.L.A\n", "variable V.L.A has no value yet"),
        (
            "%L sub\nV.L.A = 1\nM17\n%L two\nX=V.L.A\nM17\n%main\nG01 F600\nLL sub\nLL two\n",
            "variable V.L.A has no",
        ),
        ("V.Q.A = 1\n", "no variable V.Q.A: expected V.E."),
        ("G01 F600 X=V.E.A\n", "no variable V.E.A: expected V.E. and a name of the application"),
        ("V.G.BLOCK_NR = 1\n", "variable V.G.BLOCK_NR is read only"),
        ("V.P.A[1] = 1\n", "array of V. variables"),
        ("V.P.A\n", "end of line: expected = behind the variable"),
    ] {
        let refused = end_of(text, &[]).1.unwrap_or_default();
        assert!(refused.contains(message), "{refused}: {text}");
    }
}

/// G-11: V.E. of the application, both ways, and V.G.
#[test]
fn variables_of_the_application() {
    let variables = [Variable::new("GAUGE", Access::Read), Variable::new("part.count", Access::ReadWrite)];
    variables[0].set(2.5);
    variables[1].set(40.0);
    let text = "N10 G01 F6000 X=V.E.GAUGE\nN20 V.E.PART.COUNT = V.E.PART.COUNT + 1\nN30 Y=V.E.Part.Count\n\
        N40 Z[V.G.BLOCK_NR/100 + V.G.FEEDRATE/1000]\nM30\n";
    let (end, refused) = end_of(text, &variables);
    assert_eq!(refused, None);
    // Z: N30 is the block before, and F 6000.
    assert_eq!((end[0], end[1]), (2.5, 41.0));
    assert!((end[2] - 6.3).abs() < 1e-9, "{end:?}");
    assert_eq!(variables[1].get(), 41.0);
    variables[1].set(3.0);
    assert_eq!(variables[1].get(), 3.0);
    let refused = end_of("V.E.GAUGE = 1\n", &variables).1.unwrap_or_default();
    assert!(refused.contains("variable V.E.GAUGE is read only"), "{refused}");
    // A line that is refused writes nothing.
    assert!(end_of("V.E.PART.COUNT = 9 FOO\n", &variables).1.is_some());
    assert_eq!(variables[1].get(), 3.0);
}

/// G-11: behind `#FLUSH WAIT` a variable is read when the motion stands there; without, when the line is read.
#[test]
fn flush_wait_before_a_variable() {
    for (flush, want) in [("", 1.0), ("#FLUSH\n", 1.0), ("#FLUSH WAIT\n", 5.0), ("#FLUSH&WAIT\n", 5.0)] {
        let variables = [Variable::new("A", Access::Read)];
        variables[0].set(1.0);
        let text = format!("G01 X20 F6000\n{flush}#MSG [\"level (1); read\"]\nY=V.E.A\nM30\n");
        let text = text.replace(" (1);", "");
        let mut y = 0.0;
        let (_, refused) = run_with::<1>(&text, &machines::even(1000), &variables, |now| {
            if now.status.set_points[0].to_num::<f64>() > 10.0 {
                variables[0].set(5.0);
            }
            y = now.status.set_points[1].to_num();
        });
        assert_eq!((refused, y), (None, want), "{flush}");
    }
}
