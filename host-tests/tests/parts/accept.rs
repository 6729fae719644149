//! Accepting a table needs a reason, stores the reason in the table's head, and always fails.
use host_tests::accept::{Head, compare, compare_file};

const REASON: &str = "ramps of SIN2 are shorter";

#[test]
fn a_table_is_accepted_with_a_reason_by_a_run_that_fails() {
    let folder = std::env::temp_dir().join(format!("glidepath-accept-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("table.csv");
    let content = || std::fs::read_to_string(&path).unwrap_or_default();

    let refused = compare_file(&path, "a,b\n1,2\n", None).expect_err("nothing is accepted yet");
    assert!(refused.contains("a,b"), "{refused}");
    for none in ["", "1", "yes", "accept", "new new new", "x"] {
        compare_file(&path, "a,b\n1,2\n", Some(none)).expect_err("no reason");
        assert_eq!(content(), "", "{none:?}");
    }
    compare_file(&path, "a,b\n1,2\n", Some(REASON)).expect_err("a run that accepts fails");
    assert_eq!(content(), format!("# accepted: {REASON}\na,b\n1,2\n"));
    compare_file(&path, "a,b\n1,2\n", None).expect("as accepted");

    // What is as accepted keeps its reason.
    compare_file(&path, "a,b\n1,2\n", Some("another reason than before")).expect("as accepted");
    assert!(content().contains(REASON));

    let refused = compare_file(&path, "a,b\n1,3\n", None).expect_err("another figure");
    assert!(refused.contains("1,3") && refused.contains("1,2"), "{refused}");
    for longer in ["a,b\n", "a,b\n1,2\n3,4\n"] {
        compare_file(&path, longer, None).expect_err("other lines");
    }
    compare_file(&path, "a,b\n1,3\n", Some("the second reason counts")).expect_err("it accepts");
    assert_eq!(content(), "# accepted: the second reason counts\na,b\n1,3\n");
    std::fs::remove_dir_all(&folder).expect("its own folder");
}

#[test]
fn a_reason_stays_in_its_line() {
    for reason in ["two lines\nare too many here", "a mark --> within the reason"] {
        compare("figures", "1\n", "2\n", Head::MARKDOWN, Some(reason), |_| panic!("written"))
            .expect_err(reason);
    }
    let mut written = String::new();
    let write = |text: &str| {
        written.push_str(text);
        Ok(())
    };
    compare("figures", "1\n", "2\n", Head::MARKDOWN, Some(REASON), write).expect_err("it accepts");
    assert_eq!(written, format!("<!-- accepted: {REASON} -->\n1\n"));
    assert_eq!(Head::MARKDOWN.strip(&written), "1\n");
    assert_eq!(Head::MARKDOWN.strip("1\n"), "1\n");
}
