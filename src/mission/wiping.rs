//! Wiping, seen from inside: the very memory that held a user's data is read again.

use selfneg_core::Options;

use super::event::{AskId, Event, GoalId, Place, UserId};
use super::memory::{Cell, Cells, Name};
use super::specification::{Goal, Specification, Task};
use super::user_data::{LOCATION, Profile, Stated, UserData};
use super::{Mission, MissionRules};
use crate::input::{Rules, Truth};

/// Where a user's memory lies and what is in it.
fn memory(mission: &Mission) -> Vec<(usize, Vec<u8>)> {
    let users = mission.state.users.all().iter();
    users.map(|managers| (std::ptr::from_ref(managers).addr(), managers.bytes())).collect()
}

fn contains(bytes: &[u8], text: &str) -> bool {
    bytes.windows(text.len()).any(|window| window == text.as_bytes())
}

#[test]
fn the_memory_that_was_used_is_overwritten() {
    let rules = Rules::parse(("a", r#"{"listed": ["D"]}"#), ("i", r#"{"g": ["D"]}"#)).unwrap();
    let task = Task { name: "t".into(), actions: vec!["a".into()], interruptible: true };
    let goal = Goal { name: "g".into(), tasks: vec![task], ..Goal::default() };
    let specification = Specification { goals: vec![goal], ..Specification::default() };
    let rules = MissionRules::new(&rules, specification, Options::default(), None).unwrap();
    let (mut mission, _) = Mission::new(rules);
    let vacant = memory(&mission);
    assert!(vacant.iter().all(|(_, bytes)| bytes.iter().all(|&byte| byte == 0)));

    let data = UserData {
        profiles: vec![Profile { label: "ward 7".into(), ranks: vec![("D".into(), 211)] }],
        status: vec![Stated { condition: "allergic to nuts".into(), truth: Truth::True }],
        context: vec![(LOCATION.into(), "ward 7".into())],
    };
    let user = UserId(1);
    let _ = mission.handle(Event::Request { user, goal: GoalId(0), place: Place(1) });
    let _ = mission.handle(Event::Data { user, ask: AskId(0), data });
    let used = memory(&mission);
    let holding: Vec<&Vec<u8>> =
        used.iter().map(|(_, bytes)| bytes).filter(|bytes| contains(bytes, "allergic to nuts")).collect();
    assert_eq!(holding.len(), 1, "exactly one user's memory holds it");
    assert!(contains(holding[0], "ward 7") && holding[0].contains(&211));

    let _ = mission.handle(Event::Withdraw { user });
    assert_eq!(memory(&mission), vacant, "the same places, all zero");
}

/// Not only what is in use: a shorter name leaves nothing of a longer one.
#[test]
fn a_cell_is_overwritten_whole() {
    let mut cells: Cells<Name> = Cells::new(2);
    cells.all_mut()[1].write("a long name, sixty-four bytes at most").unwrap();
    let place = cells.all().as_ptr();
    cells.all_mut()[1].write("short").unwrap();
    let mut bytes = Vec::new();
    cells.bytes(&mut bytes);
    assert!(!contains(&bytes, "name"));
    assert_eq!(cells.residue(), "short".len() + 1);
    cells.wipe();
    assert_eq!((cells.residue(), cells.all().as_ptr()), (0, place));
    assert!(cells.all()[1].is_vacant() && cells.all()[1].residue() == 0);
    assert!(cells.all_mut()[0].write(&"x".repeat(65)).is_err());
}
