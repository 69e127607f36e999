//! Decisions as they are told to people, one snapshot for each way in which they end.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use scaffold::folders::Place;
use scaffold::program::negotiate;

fn told(place: &Place, users: &[&str], flags: &[&str]) -> String {
    let output = negotiate(place, users, flags).assert().code(0).get_output().clone();
    String::from_utf8(output.stdout).unwrap()
}

/// Rules with names that people use, and users of them.
struct Clinic(Place);

const CONDITIONS: [(char, &str); 4] =
    [('a', "elderly"), ('b', "in pain"), ('c', "with a baby"), ('d', "in a hurry")];

impl Clinic {
    fn new() -> Self {
        let place = Place::of_letters();
        place
            .write(
                "disposition_activation.json",
                r#"{"elderly": ["da"], "in pain": ["db"], "with a baby": ["dc"], "in a hurry": ["dd"]}"#,
            )
            .write(
                "ethical_implications.json",
                r#"{"find the doctor": ["da", "db", "dc", "dd"], "find the exit": ["da", "db", "dc", "dd"]}"#,
            );
        Self(place)
    }

    /// Who, what is true of them by letters, and their ranks as in [`Place::user`].
    fn with(self, name: &str, conditions: &str, ranks: &str) -> Self {
        self.with_goal(name, conditions, ranks, "find the exit")
    }

    fn with_goal(self, name: &str, conditions: &str, ranks: &str, goal: &str) -> Self {
        let entry = |letter: char| {
            let (_, name) = CONDITIONS.into_iter().find(|(other, _)| *other == letter).unwrap();
            format!("\"{name}\": true")
        };
        let status: Vec<String> = conditions.chars().map(entry).collect();
        self.0.user_with_status(name, &format!("{{{}}}", status.join(", ")), ranks);
        self.0.write(&format!("{name}/goal.json"), &format!("{{\"goal\": \"{goal}\"}}"));
        self
    }
}

#[test]
fn an_agreement() {
    let clinic =
        Clinic::new().with_goal("Ann", "ad", "a4 b5 d2", "find the doctor").with("Bob", "cb", "a1 b3 c1 d5");
    insta::assert_snapshot!(told(&clinic.0, &["Ann", "Bob"], &[]));
}

#[test]
fn no_agreement() {
    let clinic = Clinic::new().with("Ann", "a", "a5 b5").with("Bob", "bc", "a1 b5 c5");
    insta::assert_snapshot!(told(&clinic.0, &["Ann", "Bob"], &[]));
    insta::assert_snapshot!(
        "no_agreement_utilitarian",
        told(&clinic.0, &["Ann", "Bob"], &["--fallback", "utilitarian"])
    );
}

#[test]
fn nothing_to_offer() {
    let clinic = Clinic::new().with("Ann", "", "a5 b5").with("Bob", "", "a1 b5");
    insta::assert_snapshot!(told(&clinic.0, &["Ann", "Bob"], &[]));
    insta::assert_snapshot!(
        "nothing_to_offer_literal",
        told(&clinic.0, &["Ann", "Bob"], &["--quit", "literal"])
    );
}

fn each_would_take_the_others() -> Clinic {
    Clinic::new().with("Ann", "a", "a1 b2").with("Bob", "b", "a5 b1")
}

#[test]
fn a_held_tie_left_to_the_fallback() {
    insta::assert_snapshot!(told(&each_would_take_the_others().0, &["Ann", "Bob"], &["--tie", "fallback"]));
}

#[test]
fn a_held_offer_that_stands() {
    let clinic = Clinic::new().with("Ann", "a", "a1 b2").with("Bob", "b", "a1 b5");
    insta::assert_snapshot!(told(&clinic.0, &["Ann", "Bob"], &["--tie", "surplus"]));
}

#[test]
fn a_tie_won_by_surplus() {
    insta::assert_snapshot!(told(&each_would_take_the_others().0, &["Ann", "Bob"], &["--tie", "surplus"]));
}

#[test]
fn a_tie_of_equal_surplus() {
    let clinic = Clinic::new().with("Ann", "a", "a1 b2").with("Bob", "b", "a2 b1");
    insta::assert_snapshot!(told(&clinic.0, &["Ann", "Bob"], &["--tie", "surplus"]));
}

#[test]
fn a_literal_quit() {
    let clinic = Clinic::new().with("Ann", "a", "a3 b1").with("Bob", "b", "a5 b1");
    insta::assert_snapshot!(told(&clinic.0, &["Ann", "Bob"], &["--quit", "literal"]));
    let clinic = Clinic::new().with("Ann", "", "").with("Bob", "b", "a5 b1");
    insta::assert_snapshot!(
        "a_literal_quit_without_offers",
        told(&clinic.0, &["Ann", "Bob"], &["--quit", "literal"])
    );
}

#[test]
fn willingness() {
    let clinic = Clinic::new().with("Ann", "a", "a3 b4").with("Bob", "b", "a1 b1");
    insta::assert_snapshot!(told(&clinic.0, &["Ann", "Bob"], &["--willingness", "2"]));
}

#[test]
fn three_users_by_the_published_policy() {
    let clinic = Clinic::new()
        .with_goal("Ann", "a", "a1 c2", "find the doctor")
        .with("Bob", "b", "b1")
        .with("Cy", "c", "b1");
    insta::assert_snapshot!(told(&clinic.0, &["Ann", "Bob", "Cy"], &[]));
    // Each beats the next.
    let clinic = Clinic::new().with("Ann", "a", "a1 c2").with("Bob", "b", "a2 b1").with("Cy", "c", "b2 c1");
    insta::assert_snapshot!("three_users_without_agreement", told(&clinic.0, &["Ann", "Bob", "Cy"], &[]));
}

#[test]
fn four_users_by_condorcet() {
    let clinic = Clinic::new()
        .with("Ann", "a", "a1 d2")
        .with("Bob", "b", "b1 d2")
        .with("Cy", "c", "c1 d2")
        .with("Di", "d", "d1");
    insta::assert_snapshot!(told(&clinic.0, &["Ann", "Bob", "Cy", "Di"], &[]));
    // Ann, Bob and Cy each beat the next, and nobody decides about Di but Cy, who loses.
    let clinic = Clinic::new()
        .with("Ann", "a", "a1 c2")
        .with("Bob", "b", "a2 b1")
        .with("Cy", "c", "b2 c1")
        .with("Di", "d", "a1 d0");
    insta::assert_snapshot!(
        "four_users_without_agreement",
        told(&clinic.0, &["Ann", "Bob", "Cy", "Di"], &[])
    );
}
