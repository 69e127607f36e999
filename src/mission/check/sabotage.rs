//! Each property is seen to fail: one rule is taken out of the same machine.

use super::super::fault::Fault;
use super::{Extent, MissionModel, Run, explore, published};

fn sabotaged(fault: Fault, extent: Extent) -> Run {
    let model = MissionModel { fault: Some(fault), ..published(2, 2) };
    explore(&format!("two users, {fault:?}"), model, extent)
}

/// The properties that the first failing exploration step found violated.
fn violates(fault: Fault, property: &str) {
    let run = sabotaged(fault, Extent::FirstFailure);
    let names: Vec<&str> = run.violated.iter().map(|(name, _)| *name).collect();
    assert!(names.contains(&property), "{fault:?} violates only {names:?}");
}

#[test]
fn a_loser_who_is_not_wiped_is_found_in_memory() {
    violates(Fault::KeepLosersData, "never data of a user who should be wiped");
}

#[test]
fn a_goal_that_is_not_stopped_is_a_second_one() {
    violates(Fault::LeaveGoalRunning, "never two active goals");
}

#[test]
fn a_request_forgotten_on_timeout_is_lost() {
    violates(Fault::ForgetOnTimeout, "no request lost");
}

#[test]
fn a_second_interruption_that_is_dropped_is_not_answered() {
    violates(Fault::DropSecondInterruption, "every request is answered at once");
}

#[test]
fn data_that_come_late_are_not_to_be_taken() {
    violates(Fault::TakeLateData, "late news have no effect");
}

#[test]
fn components_that_are_not_cleaned_up_cannot_be_configured() {
    violates(Fault::SkipCleanup, "only transitions that the lifecycle has");
}

#[test]
fn a_claim_that_is_believed_has_an_effect() {
    violates(Fault::BelieveClaims, "emergencies are decided at once, claims have no effect");
}

#[test]
fn a_negotiation_that_hangs_has_no_way_to_idle() {
    let run = sabotaged(Fault::HangWithoutConditions, Extent::Everything);
    assert!(run.stranded > 0);
}
