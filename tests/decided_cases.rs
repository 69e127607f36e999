//! Each recorded decision, made again on its own, is the recorded one: by the mission, round
//! by round over many events, and by one call of `decide`, in two ways to the same result.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod random_mission;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use proptest::prelude::*;
use selfneg::case::{Case, Docket, NegotiatedCase, RecordedEvent, RecordedNegotiation, Worth};
use selfneg::run::run;
use selfneg::scenario::Scenario;
use selfneg::trace::{Recording, TraceWriter};
use selfneg::transcript::Event;

/// What the cases of a trace are like.
#[derive(Debug, Default, PartialEq)]
struct Seen {
    negotiated: usize,
    among_three: usize,
    emergencies: usize,
    rounds: usize,
}

/// Decides every case again, and holds every round against the recorded one.
fn decide_again(recording: &Recording) -> Seen {
    let mut seen = Seen::default();
    let cases = recording.cases();
    assert_eq!(u64::try_from(cases.len()).unwrap(), recording.decisions());
    for (number, case) in (1..).zip(&cases) {
        assert_eq!(case.decision(), number);
        match case {
            Case::Emergency(emergency) => {
                assert!(emergency.certain, "{emergency:?}");
                seen.emergencies += 1;
            }
            Case::Negotiated(case) => {
                seen.negotiated += 1;
                seen.among_three += usize::from(case.recorded.participants.len() > 2);
                seen.rounds += the_same_again(case);
            }
        }
    }
    seen
}

fn the_same_again(case: &NegotiatedCase) -> usize {
    let recorded = &case.recorded;
    let inputs = case.inputs.as_ref().unwrap();
    let decision = inputs.decide().unwrap();
    assert_eq!(recorded.policy, Some(inputs.policy));
    assert_eq!(recorded.served_place(), Some(decision.served), "{recorded:#?} {decision:#?}");
    assert_eq!(recorded.agreement_place(), decision.agreement);
    assert_eq!(recorded.outcome_name(), decision.outcome_name(recorded.participants.len()));
    let mut rounds = 0;
    for held in &decision.negotiations {
        let sides = [held.current, held.interrupting].map(|place| recorded.participants[place]);
        let same = |one: &&RecordedNegotiation| [one.current, one.interrupting] == sides;
        let found: Vec<_> = recorded.negotiations.iter().filter(same).collect();
        let [found] = found.as_slice() else { panic!("{sides:?}: {recorded:#?}") };
        assert_eq!(u32::from(held.options.willingness), found.willingness);
        assert_eq!(found.end.as_ref().unwrap().ending, held.conclusion.ending.name());
        assert_eq!(found.rounds.len(), held.rounds.len(), "{found:#?} {held:#?}");
        for (recorded, again) in found.rounds.iter().zip(&held.rounds) {
            assert_eq!(recorded.number, again.number);
            let (sender, place) = match again.sender {
                selfneg_core::Side::Current => (sides[0], held.current),
                selfneg_core::Side::Interrupting => (sides[1], held.interrupting),
            };
            assert_eq!(recorded.sender, sender);
            let event = match again.event {
                Event::Quit => RecordedEvent::Quit,
                Event::Offer { depth, discloses, weighing, ruling } => RecordedEvent::Offer {
                    depth: depth.try_into().unwrap(),
                    verdict: Some(ruling),
                    discloses: Some(inputs.disclosed(place, discloses)),
                    worth: Some(Worth { value: weighing.value.0, threshold: weighing.threshold.0 }),
                },
            };
            assert_eq!(recorded.event, event);
            rounds += 1;
        }
    }
    rounds
}

#[test]
fn every_decision_of_the_example_scenarios_is_made_again() {
    let mut all = Seen::default();
    for name in ["mall", "three_users", "emergency", "elevator", "withholding", "annotated"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/scenarios/{name}.toml"));
        let scenario = Scenario::open(&file).unwrap();
        let mut writer = TraceWriter::plain(Vec::new()).unwrap();
        run(&scenario, &mut [&mut writer]).unwrap();
        let recording = Recording::read(&writer.into_inner().unwrap()).unwrap();
        assert!(recording.is_complete());
        let docket = Docket::of(&recording);
        assert!(docket.stray.is_empty(), "{name}");
        let seen = decide_again(&recording);
        all.negotiated += seen.negotiated;
        all.among_three += seen.among_three;
        all.emergencies += seen.emergencies;
        all.rounds += seen.rounds;
    }
    assert!(all.negotiated >= 5 && all.among_three >= 1 && all.emergencies >= 1, "{all:?}");
}

static NEGOTIATED: AtomicUsize = AtomicUsize::new(0);
static AMONG_THREE: AtomicUsize = AtomicUsize::new(0);

#[test]
fn random_missions_are_decided_again_to_the_same_rounds() {
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig {
        cases: 192,
        failure_persistence: None,
        ..ProptestConfig::default()
    });
    let missions = (random_mission::choices(), random_mission::options(), random_mission::policy());
    runner
        .run(&missions, |(choices, options, policy)| {
            let recording = Recording::read(&random_mission::trace(choices, options, policy)).unwrap();
            prop_assert!(recording.is_complete());
            prop_assert_eq!(recording.replay().unwrap().difference, None);
            let seen = decide_again(&recording);
            NEGOTIATED.fetch_add(seen.negotiated, Ordering::Relaxed);
            AMONG_THREE.fetch_add(seen.among_three, Ordering::Relaxed);
            Ok(())
        })
        .unwrap();
    let (negotiated, among_three) = (NEGOTIATED.load(Ordering::Relaxed), AMONG_THREE.load(Ordering::Relaxed));
    println!("{negotiated} decisions, {among_three} of them among three or more");
    // The missions are not worth much if hardly any of them decides anything.
    assert!(negotiated >= 100 && among_three >= 15, "{negotiated}, {among_three}");
}
