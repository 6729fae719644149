//! The programmed contour as JSON, for programs that compare a trace with it.
use crate::machine::Machine;
use crate::program::{Kind, Program, Segment};
use serde_json::{Map, Value, json};

/// Axes, main axes, start, and every block with absolute coordinates; feeds in mm/min along the main axes,
/// none for rapid motion.
pub fn to_json(machine: &Machine, program: &Program) -> String {
    let names: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
    let main: Vec<&str> = machine.main_axes().into_iter().map(|index| names[index]).collect();
    let mut out = String::from("{\n");
    let mut field =
        |name: &str, value: Value, end: &str| out.push_str(&format!("\"{name}\": {value}{end}\n"));
    field("axes", json!(names), ",");
    field("main", json!(main), ",");
    field("start", named(&names, &program.start), ",");
    out.push_str("\"segments\": [\n");
    // One block per line, so that people can read it.
    let mut at = program.start.as_slice();
    let line = |segment| {
        let feed = Program::feed_in_space(machine, at, segment);
        at = &segment.end;
        block(&names, segment, feed).to_string()
    };
    let lines: Vec<String> = program.segments.iter().map(line).collect();
    out.push_str(&lines.join(",\n"));
    out.push_str("\n]}\n");
    out
}

fn named(names: &[&str], values: &[f64]) -> Value {
    Value::Object(names.iter().zip(values).map(|(name, value)| ((*name).to_owned(), json!(value))).collect())
}

fn block(names: &[&str], segment: &Segment, feed: Option<f64>) -> Value {
    let mut fields = Map::new();
    fields.insert("n".into(), json!(segment.n));
    match &segment.kind {
        Kind::Dwell(time) => {
            fields.insert("type".into(), json!("dwell"));
            fields.insert("time".into(), json!(time));
            return Value::Object(fields);
        }
        Kind::Line => {
            fields.insert("type".into(), json!("line"));
        }
        Kind::Arc { plane, centre, clockwise } => {
            let [first, second] = plane.map(|index| names[index]);
            fields.insert("type".into(), json!("arc"));
            fields.insert("plane".into(), json!([first, second]));
            fields.insert("center".into(), json!({first: centre[0], second: centre[1]}));
            fields.insert("dir".into(), json!(if *clockwise { "cw" } else { "ccw" }));
            fields.insert("turns".into(), json!(0));
        }
    }
    fields.insert("end".into(), named(names, &segment.end));
    if let Some(feed) = feed {
        fields.insert("feed".into(), json!(feed));
    }
    fields.insert("stop".into(), json!(segment.stop));
    Value::Object(fields)
}
