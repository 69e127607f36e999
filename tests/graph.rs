//! `selfneg graph`, through the program: what is on the pictures, and that they are XML.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::fs;

use scaffold::folders::Place;
use scaffold::program::selfneg;
use serde_json::{Value, json};

fn graph(place: &Place, users: &[&str], more: &[&str]) -> String {
    let mut command = selfneg();
    command.arg("graph").arg("--rules").arg(place.path());
    command.arg("--current").arg(place.of(users[0])).arg("--interrupting");
    command.args(users[1..].iter().map(|user| place.of(user))).args(more);
    String::from_utf8(command.assert().code(0).get_output().stdout.clone()).unwrap()
}

/// Three users of whom each beats the next.
fn cycle() -> Place {
    let place = Place::of_letters();
    place.user("A", "a", "a2 b1 c3").user("B", "b", "a3 b2 c1").user("C", "c", "a1 b3 c2");
    place
}

#[test]
fn the_protocol_of_the_papers_example_is_drawn() {
    let dot = graph(&Place::mall(), &["Alice", "Bob"], &[]);
    assert!(dot.starts_with("digraph protocol {"));
    assert!(dot.contains(r#"label="agreement for Alice""#));
    assert!(dot.contains("Bob offers 1: elderly"));
    assert_eq!(dot.matches("penwidth=2.5").count(), 2, "it took two rounds");
    let svg = graph(&Place::mall(), &["Alice", "Bob"], &["--format", "svg"]);
    insta::assert_snapshot!("protocol_svg", svg);
}

#[test]
fn cycles_and_sets_are_named() {
    let place = cycle();
    let text = graph(&place, &["A", "B", "C"], &["--json"]);
    let document: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["cycles"].as_array().unwrap().len(), 1);
    assert_eq!(document["smith_set"], json!(["A", "B", "C"]));
    assert_eq!(document["schwartz_set"], json!(["A", "B", "C"]));
    assert_eq!(document["beats_everyone"], Value::Null);
    for format in ["dot", "svg"] {
        let drawn = graph(&place, &["A", "B", "C"], &["--format", format]);
        assert!(drawn.contains("Cycle: A beats "), "{drawn}");
        assert!(drawn.contains("Smith set: A, B, C"));
        assert_eq!(drawn, graph(&place, &["A", "B", "C"], &["--format", format]));
    }
}

#[test]
fn names_cannot_break_the_picture() {
    let place = Place::of_letters();
    place.user("<b>&\"x\"", "a", "a1 b1").user("B\\", "b", "a1 b1");
    for what in ["protocol", "beats"] {
        let svg = graph(&place, &["<b>&\"x\"", "B\\"], &["--of", what, "--format", "svg"]);
        assert!(svg.contains("&lt;b&gt;&amp;&quot;x&quot;") && !svg.contains("<b>"));
        let dot = graph(&place, &["<b>&\"x\"", "B\\"], &["--of", what, "--format", "dot"]);
        assert!(dot.contains(r#"<b>&\"x\""#) && dot.contains(r"B\\"));
    }
}

#[test]
fn the_files_ending_says_the_format() {
    let place = Place::mall();
    let file = place.of("out.svg");
    graph(&place, &["Alice", "Bob"], &["-o", file.to_str().unwrap()]);
    assert!(fs::read_to_string(file).unwrap().starts_with("<svg"));
}

#[test]
fn a_protocol_graph_is_of_two_users() {
    let place = cycle();
    let mut command = selfneg();
    command.args(["graph", "--of", "protocol", "--rules"]).arg(place.path());
    command.arg("--current").arg(place.of("A")).arg("--interrupting").args([place.of("B"), place.of("C")]);
    command.assert().code(2);
}
