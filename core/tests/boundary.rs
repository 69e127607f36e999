//! The wall between the two users: what the compiler refuses, each beside a twin that it
//! takes, and why the engine is refused the same.
#![allow(clippy::panic, reason = "clippy looks for tests only in functions marked so")]

use std::collections::BTreeSet;
use std::path::Path;

use selfneg_core::{Case, Conclusion, EthicalProfile, Interrupting, Negotiation, Offer, Party, Status, User};

/// Code that must not compile, in `boundary/NAME.rs`; its twin is `NAME_twin.rs`.
const REFUSED: [&str; 14] = [
    "concluded",
    "current_twice",
    "forge",
    "invent",
    "negotiation",
    "own_offer",
    "party",
    "profile",
    "same_side",
    "third_role",
    "threshold",
    "totals",
    "undisclosed",
    "user",
];

fn source(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn compiler_refuses_what_crosses_the_wall() {
    let cases = trybuild::TestCases::new();
    for name in REFUSED {
        cases.compile_fail(format!("tests/boundary/{name}.rs"));
        cases.pass(format!("tests/boundary/{name}_twin.rs"));
    }
}

#[test]
fn every_case_has_a_twin_and_is_run() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/boundary");
    let found: BTreeSet<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let expected: BTreeSet<String> = REFUSED
        .iter()
        .flat_map(|name| [format!("{name}.rs"), format!("{name}.stderr"), format!("{name}_twin.rs")])
        .collect();
    assert_eq!(found, expected);
}

/// The code of a source file without its comments.
fn code(path: &str) -> String {
    let source = source(path);
    assert!(!source.contains("/*"), "{path}: this reader knows line comments only");
    source.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

fn words(code: &str) -> BTreeSet<&str> {
    code.split(|c: char| !c.is_alphanumeric() && c != '_').collect()
}

/// Then the engine, in the same crate, sees of a party what a program outside sees, and
/// what is refused above is refused in the engine.
#[test]
fn nothing_of_a_party_is_visible_to_the_crate_alone() {
    let party = code("src/party.rs");
    assert!(!party.contains("pub(") && !party.contains("pub ("), "src/party.rs has restricted visibility");
    let words = words(&party);
    for inner in ["include", "unsafe", "macro_rules"] {
        assert!(!words.contains(inner), "src/party.rs has `{inner}`");
    }
    // What is private to a module is visible to the modules in it: there is one, of traits.
    assert_eq!(party.matches("mod ").count(), 1);
    assert!(party.contains("mod sealed {"));
}

/// The engine names nothing from which a user could be read, and watches nobody: the
/// totals go to an observer, so the engine must not be one.
#[test]
fn engine_names_nothing_of_a_user_and_no_totals() {
    let engine = code("src/protocol.rs");
    let words = words(&engine);
    for secret in [
        "User",
        "EthicalProfile",
        "Status",
        "Rank",
        "Activation",
        "Implication",
        "Disclosed",
        "Impact",
        "Weighing",
        "weighed",
        "welfare",
        "Welfare",
        "Case",
        "conditions",
        "goal",
        "include",
    ] {
        assert!(!words.contains(secret), "src/protocol.rs mentions `{secret}`");
    }
    assert!(!engine.contains("Observer for"), "src/protocol.rs makes something an observer");
    assert!(!engine.contains("::*"), "src/protocol.rs imports what it does not name");
    for glob in ["crate::user", "crate::welfare", "crate::impact", "crate::rules", "crate::decision"] {
        assert!(!engine.contains(glob), "src/protocol.rs reaches into {glob}");
    }
    // The engine asks a sender for one offer and a receiver for one verdict a round.
    assert_eq!(engine.matches(".offer()").count(), 1);
    assert_eq!(engine.matches(".judge(").count(), 1);
    assert_eq!(engine.matches("clone()").count(), 0);
}

/// Whether a type has `Debug`: the inherent function is taken if its bound holds, else
/// the trait's.
macro_rules! can_be_printed {
    ($type:ty) => {{
        struct Probe<T>(std::marker::PhantomData<T>);
        impl<T: std::fmt::Debug> Probe<T> {
            #[allow(dead_code, reason = "used for a type that has `Debug`")]
            const DEBUG: bool = true;
        }
        #[allow(dead_code, reason = "used for a type that has none")]
        trait Otherwise {
            const DEBUG: bool = false;
        }
        impl<T> Otherwise for Probe<T> {}
        let _ = Probe::<$type>(std::marker::PhantomData).0;
        <Probe<$type>>::DEBUG
    }};
}

#[test]
fn nothing_that_holds_a_user_can_be_printed() {
    assert!(can_be_printed!(Conclusion));
    assert!(!can_be_printed!(User<'static>));
    assert!(!can_be_printed!(EthicalProfile<'static>));
    assert!(!can_be_printed!(Status<'static>));
    assert!(!can_be_printed!(Party<'static, Interrupting>));
    assert!(!can_be_printed!(Offer<'static, Interrupting>));
    assert!(!can_be_printed!(Negotiation<'static>));
    assert!(!can_be_printed!(Case<'static>));
}
