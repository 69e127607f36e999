//! What the mission itself does, whatever its environment, is never found fault with.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod random_mission;
mod rewriting;

use proptest::prelude::*;
use selfneg::audit::{Keys, Redecided, Status, audit};
use selfneg::seal::{AuditorKey, Privacy, RobotKey, Seal};
use selfneg::trace::TraceWriter;

/// The same trace without everything personal.
fn without_personal(bytes: &[u8]) -> Vec<u8> {
    let mut pieces = rewriting::Pieces::of(bytes);
    pieces.messages.retain(|message| !message.topic.starts_with(selfneg::trace::PERSONAL));
    pieces.renumber();
    pieces.to_bytes()
}

/// Numbers that look random, and are the same in every run: all salts and keys differ.
fn random(seed: u64) -> impl FnMut(&mut [u8]) -> std::io::Result<()> + Send + 'static {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&seed.to_le_bytes());
    let mut stream = hasher.finalize_xof();
    move |bytes: &mut [u8]| {
        stream.fill(bytes);
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_honest_plain_trace_is_unsealed_and_nothing_else(
        choices in random_mission::choices(),
        options in random_mission::options(),
        policy in random_mission::policy(),
    ) {
        let bytes = random_mission::trace(choices, options, policy);
        let found = audit(&bytes, &Keys::default());
        prop_assert!(found.findings.iter().all(|finding| finding.status == Status::Unsealed), "{:#?}", found.findings);
        prop_assert_eq!(found.status, Status::Unsealed);
        prop_assert!(found.unchecked.is_empty(), "{:?}", found.unchecked);
        prop_assert!(found.decisions.iter().all(|decision| decision.redecided == Redecided::Same));
        for decision in &found.decisions {
            if let Some(welfare) = decision.welfare {
                prop_assert_eq!(welfare.optimum - welfare.served, welfare.regret);
            }
        }
        // Without what is personal the rest is found right as well.
        let open = without_personal(&bytes);
        let found = audit(&open, &Keys::default());
        prop_assert!(
            found.findings.iter().all(|finding| [Status::Unsealed, Status::Incomplete].contains(&finding.status)),
            "{:#?}", found.findings
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_honest_sealed_trace_is_ok(
        choices in random_mission::choices(),
        options in random_mission::options(),
        policy in random_mission::policy(),
        seed in any::<u64>(),
    ) {
        let mut random = random(seed);
        let (robot, auditor) = (RobotKey::generate(&mut random).unwrap(), AuditorKey::generate());
        let seal = Seal {
            privacy: Privacy::Sealed(vec![auditor.public()]),
            signer: Some(robot.clone()),
            random: Box::new(random),
        };
        let mut writer = TraceWriter::create(Vec::new(), seal).unwrap();
        random_mission::play(choices, options, policy, &mut writer);
        let bytes = writer.into_inner().unwrap();
        let keys = Keys { robots: vec![robot.public()], identities: vec![auditor] };
        let found = audit(&bytes, &keys);
        prop_assert_eq!(&found.findings, &[]);
        prop_assert_eq!(found.status, Status::Ok);
        prop_assert_eq!(found.redecided(), found.decisions.len());
        let without = audit(&bytes, &Keys { identities: Vec::new(), ..keys });
        prop_assert_eq!((without.status, without.redecided()), (Status::Ok, 0));
        prop_assert!(!without.unchecked.is_empty());
    }
}
