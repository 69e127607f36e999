//! Model checking: the mission's own state machine, every order of events.
//!
//! | what | how far |
//! | --- | --- |
//! | `two_users_exhaustively` | all reachable situations |
//! | `three_users_in_bound` | all situations within a number of events |
//! | `three_users_exhaustively` | all; for `cargo test --release -- --ignored` |
//!
//! Every request, answer, timeout, withdrawal, emergency, success, failure and shutdown may
//! come at any moment at which the environment can send it, any number of times; so may news
//! of what is over. What is small is the data: two conditions of each user, one profile, goals
//! of two actions, two deferrals, room for one waiting emergency.
//!
//! `SELFNEG_CHECK_DEPTH=8 cargo test --lib three_users_in_bound -- --nocapture` goes deeper.

mod environment;
mod model;
mod sabotage;
mod ways_to_idle;

use std::time::Instant;

use selfneg_core::{Aggregation, Fallback, Options, QuitRule, TieRule};
use stateright::{Checker, HasDiscoveries, Model};

use crate::precedence::Policy;
use model::MissionModel;
use ways_to_idle::stranded;

/// The published variant and policy.
fn published(users: usize, deferrals: u8) -> MissionModel {
    MissionModel::new(users, deferrals, Options::default(), None)
}

/// What a run came to.
struct Run {
    /// Names of the properties that do not hold, and what led there.
    violated: Vec<(&'static str, String)>,
    /// How many situations have no way to idle by the environment's duties alone.
    stranded: usize,
}

/// How far to explore.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Extent {
    Everything,
    /// Within this many events.
    Events(usize),
    /// Within five events, until a property is violated.
    FirstFailure,
}

/// Explores breadth first.
fn explore(name: &str, model: MissionModel, extent: Extent) -> Run {
    let began = Instant::now();
    let checker = model.checker();
    // `All` ends early only once every property has failed or been witnessed.
    let checker = match extent {
        Extent::Everything => checker.finish_when(HasDiscoveries::All),
        Extent::Events(events) => checker.finish_when(HasDiscoveries::All).target_max_depth(events + 1),
        Extent::FirstFailure => checker.finish_when(HasDiscoveries::AnyFailures).target_max_depth(6),
    };
    let checker = checker.spawn_bfs().join();
    let mut violated = Vec::new();
    for property in checker.model().properties() {
        let found = checker.discovery(property.name);
        match (property.expectation, found) {
            (stateright::Expectation::Always, Some(path)) => {
                violated.push((property.name, format!("{:?}", path.into_actions())));
            }
            (stateright::Expectation::Sometimes, None) if extent == Extent::Everything => {
                violated.push((property.name, "never".to_owned()));
            }
            _ => {}
        }
    }
    let explored = checker.model().explored.lock().unwrap();
    let complete = extent == Extent::Everything;
    if complete {
        assert_eq!(explored.states.len(), checker.unique_state_count());
    }
    let stranded = if complete { stranded(&explored) } else { 0 };
    println!(
        "{name}: {} situations, {} transitions, depth {}, {} idle, {stranded} stranded, {:.1?}",
        checker.unique_state_count(),
        explored.transitions,
        checker.max_depth().saturating_sub(1),
        explored.idle.len(),
        began.elapsed()
    );
    drop(explored);
    Run { violated, stranded }
}

fn assert_sound(run: &Run) {
    assert_eq!(run.violated, []);
    assert_eq!(run.stranded, 0);
}

#[test]
fn two_users_exhaustively() {
    assert_sound(&explore("two users", published(2, 2), Extent::Everything));
}

#[test]
fn three_users_in_bound() {
    let bound = std::env::var("SELFNEG_CHECK_DEPTH").map_or(5, |depth| depth.parse().unwrap());
    assert_sound(&explore("three users", published(3, 2), Extent::Events(bound)));
}

#[test]
#[ignore = "half a minute with: cargo test --release --lib mission::check -- --ignored --nocapture"]
fn three_users_exhaustively() {
    assert_sound(&explore("three users", published(3, 2), Extent::Everything));
}

#[test]
#[ignore = "minutes with: cargo test --release --lib mission::check -- --ignored --nocapture"]
fn other_variants_exhaustively() {
    let surplus = Options {
        tie: TieRule::Surplus,
        fallback: Fallback::Utilitarian,
        aggregation: Aggregation::PerDisposition,
        willingness: 2,
        ..Options::default()
    };
    let literal = Options { quit: QuitRule::Literal, ..Options::default() };
    let model = MissionModel::new(3, 2, surplus, Some(Policy::Condorcet));
    assert_sound(&explore("three users, condorcet, surplus", model, Extent::Everything));
    let model = MissionModel::new(2, 2, literal, None);
    assert_sound(&explore("two users, literal", model, Extent::Everything));
    assert_sound(&explore("two users, four deferrals", published(2, 4), Extent::Everything));
    assert_sound(&explore("three users, three deferrals", published(3, 3), Extent::Everything));
}
