//! Traces that say something else than what happened, each in one respect, and put together
//! again so that checksums and numbering fit: what the auditor makes of them, with the personal
//! data and without.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod random_mission;
mod rewriting;

use std::fmt::Write as _;
use std::sync::OnceLock;

use prost::Message as _;
use random_mission::{Choice, data};
use rewriting::Pieces;
use selfneg::audit::{Audit, Keys, Property, Redecided, Status, Verdict as Checked, audit};
use selfneg::mission::Evidence;
use selfneg::seal::AuditorKey;
use selfneg::seal::chain::rules_digest;
use selfneg::trace::PERSONAL;
use selfneg::trace::schema::evidence::record::Record;
use selfneg::trace::schema::evidence::{self, Verdict, round, served};
use selfneg::trace::schema::personal::{self, reply};
use selfneg_core::Options;

/// The paper's Alice keeps precedence over Bob in two rounds; then an emergency is decided,
/// and another one only claimed; then Bob, who is deferred, is served, and Carol takes over
/// after three rounds.
fn story() -> Vec<Choice> {
    let alice = data([4, 2, 2, 3, 5, 3], &["with a small child", "in urgency"]);
    let bob = data([5, 4, 3, 3, 3, 1], &["elderly"]);
    let carol = data([0, 0, 0, 0, 0, 5], &["of nobody's rules", "in urgency", "with a small child"]);
    vec![
        Choice::Request(1, 0),
        Choice::Answer(alice),
        Choice::Request(2, 1),
        Choice::Answer(bob.clone()),
        Choice::Rounds(60),
        Choice::Emergency(0, Evidence::Claimed),
        Choice::Emergency(0, Evidence::Sensed),
        Choice::Done,
        Choice::Done,
        Choice::Done,
        Choice::Done,
        Choice::Done,
        Choice::Done,
        Choice::Answer(bob),
        Choice::Request(3, 0),
        Choice::Answer(carol),
        Choice::Rounds(60),
    ]
}

fn honest() -> &'static Pieces {
    static PIECES: OnceLock<Pieces> = OnceLock::new();
    PIECES.get_or_init(|| Pieces::of(&random_mission::trace(story(), Options::default(), None)))
}

/// The story goes on: Carol's goal is reached, Alice withdraws, and the mission is ended while
/// Bob waits.
fn honest_to_the_end() -> &'static Pieces {
    static PIECES: OnceLock<Pieces> = OnceLock::new();
    PIECES.get_or_init(|| {
        let mut choices = story();
        choices.extend(std::iter::repeat_n(Choice::Done, 6));
        choices.extend([Choice::Withdraw(1), Choice::Shutdown]);
        Pieces::of(&random_mission::trace(choices, Options::default(), None))
    })
}

fn audited(pieces: &Pieces) -> Audit {
    audit(&pieces.to_bytes(), &Keys::default())
}

/// The same, told by open records alone.
fn audited_openly(pieces: &Pieces) -> Audit {
    let mut pieces = pieces.clone();
    pieces.messages.retain(|message| !message.topic.starts_with(PERSONAL));
    pieces.renumber();
    audited(&pieces)
}

/// What the findings beyond those of an honest plain trace are.
fn findings(audit: &Audit) -> String {
    let worse = |status: Status| status != Status::Unsealed && status != Status::Incomplete;
    let told = audit.findings.iter().filter(|finding| worse(finding.status));
    told.map(|finding| format!("{} | {} | {}\n", finding.status, finding.at, finding.what)).collect()
}

/// What one falsification comes to, told both ways.
fn told(change: impl Fn(&mut Pieces)) -> (Status, Status, String) {
    let mut pieces = honest().clone();
    change(&mut pieces);
    let (whole, open) = (audited(&pieces), audited_openly(&pieces));
    let text = format!("with personal data\n{}without\n{}", findings(&whole), findings(&open));
    (whole.status, open.status, text)
}

/// What all falsifications of a kind come to.
#[derive(Default)]
struct Tale(String);

impl Tale {
    fn add(&mut self, name: &str, (whole, open, text): (Status, Status, String)) {
        // Nothing personal is ever told.
        for word in ["people", "child", "elderly", "urgency", "mall"] {
            assert!(!text.contains(word), "{word}: {text}");
        }
        let _ = writeln!(self.0, "{name}: {whole} with personal data, {open} without\n{text}");
    }
}

fn record(change: impl Fn(&mut Record) -> bool) -> impl Fn(&mut Pieces) {
    move |pieces| pieces.change_record(&change)
}

#[test]
fn the_honest_trace_is_found_right() {
    let found = audited(honest());
    assert_eq!(findings(&found), "");
    assert_eq!(found.status, Status::Unsealed);
    assert_eq!((found.decisions.len(), found.redecided()), (3, 3));
    let outcomes: Vec<_> = found.decisions.iter().map(|one| one.outcome.as_str()).collect();
    assert_eq!(outcomes, ["current", "emergency", "interrupting"]);
    assert!(found.decisions.iter().any(|decision| decision.rounds > 2));
    assert_eq!(findings(&audited_openly(honest())), "");
}

#[test]
fn rounds() {
    let mut tale = Tale::default();
    let with = |verdict: Verdict, to: Verdict| {
        record(move |record| match record {
            Record::Round(evidence::Round { round: Some(round::Round::Offer(offer)), .. })
                if offer.verdict() == verdict =>
            {
                offer.set_verdict(to);
                true
            }
            _ => false,
        })
    };
    tale.add("rejected_is_accepted", told(with(Verdict::Reject, Verdict::Accept)));
    tale.add("accepted_is_rejected", told(with(Verdict::Accept, Verdict::Reject)));
    tale.add("accepted_is_held", told(with(Verdict::Accept, Verdict::Hold)));
    tale.add("no_verdict", told(with(Verdict::Accept, Verdict::Unspecified)));
    tale.add(
        "a_round_is_dropped",
        told(|pieces| pieces.take_out(|record| matches!(record, Record::Round(round) if round.number == 2))),
    );
    tale.add(
        "two_conditions_in_a_round",
        told(record(|record| match record {
            Record::Round(evidence::Round { round: Some(round::Round::Offer(offer)), .. }) => {
                offer.depth += 1;
                true
            }
            _ => false,
        })),
    );
    tale.add(
        "the_other_one_sends",
        told(record(|record| match record {
            Record::Round(round) => {
                std::mem::swap(&mut round.sender, &mut round.receiver);
                true
            }
            _ => false,
        })),
    );
    tale.add(
        "a_quit_instead_of_an_offer",
        told(record(|record| match record {
            Record::Round(round) => {
                round.round = Some(round::Round::Quit(evidence::Mark {}));
                true
            }
            _ => false,
        })),
    );
    insta::assert_snapshot!("rounds", tale.0);
}

#[test]
fn ends_and_decisions() {
    let mut tale = Tale::default();
    tale.add(
        "the_winner_is_swapped",
        told(record(|record| match record {
            Record::NegotiationEnded(ended) => {
                let loser =
                    if ended.winner == Some(ended.current) { ended.interrupting } else { ended.current };
                ended.winner = Some(loser);
                true
            }
            _ => false,
        })),
    );
    tale.add(
        "another_ending",
        told(record(|record| match record {
            Record::NegotiationEnded(ended) => {
                ended.ending = "both-quit".to_owned();
                true
            }
            _ => false,
        })),
    );
    tale.add(
        "willing_out_of_nothing",
        told(record(|record| match record {
            Record::NegotiationStarted(started) => {
                started.willingness = 2;
                true
            }
            _ => false,
        })),
    );
    let decided = |change: fn(&mut evidence::Decided)| {
        record(move |record| match record {
            Record::Decided(decided) => {
                change(decided);
                true
            }
            _ => false,
        })
    };
    tale.add("another_is_served", told(decided(|decided| decided.served = 2)));
    tale.add(
        "another_has_precedence",
        told(decided(|decided| (decided.agreement, decided.served) = (Some(2), 2))),
    );
    tale.add("no_agreement", told(decided(|decided| decided.agreement = None)));
    tale.add("more_rounds", told(decided(|decided| decided.rounds += 1)));
    tale.add(
        "by_other_rules",
        told(decided(|decided| {
            if let Some(options) = &mut decided.options {
                options.tie = "surplus".to_owned();
            }
        })),
    );
    tale.add(
        "the_robot_does_something_else",
        told(record(|record| match record {
            Record::GoalStarted(started) => {
                match started.served.as_mut().and_then(|served| served.served.as_mut()) {
                    Some(served::Served::User(user)) if *user == 3 => {
                        *user = 1;
                        true
                    }
                    _ => false,
                }
            }
            _ => false,
        })),
    );
    insta::assert_snapshot!("ends_and_decisions", tale.0);
}

#[test]
fn wiping() {
    let mut tale = Tale::default();
    tale.add(
        "bytes_are_left",
        told(record(|record| match record {
            Record::Wiped(wiped) => {
                wiped.left = 3;
                true
            }
            _ => false,
        })),
    );
    let is = |component: evidence::Component, user: u32| move |record: &Record| matches!(record, Record::Wiped(wiped) if wiped.component() == component && wiped.user == user);
    tale.add(
        "the_wipe_is_missing",
        told(|pieces| pieces.take_out(is(evidence::Component::ContextEthicsManager, 2))),
    );
    tale.add(
        "the_snapshot_is_kept",
        told(|pieces| pieces.take_out(is(evidence::Component::OfferGenerator, 1))),
    );
    insta::assert_snapshot!("wiping", tale.0);
}

#[test]
fn emergencies() {
    let mut tale = Tale::default();
    let claim = |pieces: &mut Pieces, from: evidence::Evidence, to: evidence::Evidence| {
        for message in &mut pieces.messages {
            if &*message.schema == "selfneg.v1.Event" {
                let mut event = evidence::Event::decode(message.data.as_slice()).unwrap();
                if let Some(evidence::event::Event::Emergency(claim)) = &mut event.event
                    && claim.evidence() == from
                {
                    claim.set_evidence(to);
                    message.data = event.encode_to_vec();
                }
            }
        }
    };
    use evidence::Evidence::{Claimed, Sensed};
    tale.add(
        "a_claim_is_believed",
        told(|pieces| {
            claim(pieces, Sensed, Claimed);
            pieces.change_record(|record| match record {
                Record::EmergencyDecided(known) => {
                    known.set_evidence(Claimed);
                    true
                }
                _ => false,
            });
        }),
    );
    tale.add("a_certain_one_is_left", told(|pieces| claim(pieces, Claimed, Sensed)));
    tale.add(
        "it_is_not_decided",
        told(|pieces| pieces.take_out(|record| matches!(record, Record::EmergencyDecided(_)))),
    );
    tale.add(
        "the_robot_does_not_act_on_it",
        told(|pieces| {
            pieces.take_out(|record| {
                matches!(record, Record::GoalStarted(started) if matches!(
                    started.served.as_ref().and_then(|served| served.served.as_ref()),
                    Some(served::Served::Emergency(_))
                ))
            });
        }),
    );
    insta::assert_snapshot!("emergencies", tale.0);
}

/// What nobody tells, and what happened otherwise, shows in the open records alone.
#[test]
fn the_course_of_goals_and_requests() {
    let mut tale = Tale::default();
    assert_eq!(findings(&audited(honest_to_the_end())), "");
    assert_eq!(findings(&audited_openly(honest_to_the_end())), "");
    // What the mission run again replies is long, and told of other records elsewhere.
    let told = |change: &dyn Fn(&mut Pieces)| {
        let mut pieces = honest_to_the_end().clone();
        change(&mut pieces);
        let (whole, open) = (audited(&pieces), audited_openly(&pieces));
        (whole.status, open.status, findings(&open))
    };
    let drop_all = |is: fn(&Record) -> bool| {
        move |pieces: &mut Pieces| {
            let mut left = pieces.count(is);
            assert!(left > 0);
            while left > 0 {
                pieces.take_out(is);
                left -= 1;
            }
        }
    };
    tale.add(
        "neither_data_nor_wipes_are_told",
        told(&drop_all(|record| {
            matches!(record, Record::DataAccepted(_) | Record::Wiped(_) | Record::Lifecycle(_))
        })),
    );
    tale.add(
        "no_wipe_of_a_snapshot_is_told",
        told(&drop_all(|record| match record {
            Record::Wiped(wiped) => wiped.component() != evidence::Component::ContextEthicsManager,
            Record::Lifecycle(_) => true,
            _ => false,
        })),
    );
    tale.add("nobody_is_put_off", told(&drop_all(|record| matches!(record, Record::Deferred(_)))));
    tale.add("no_request_is_closed", told(&drop_all(|record| matches!(record, Record::Closed(_)))));
    let ended = |from: evidence::GoalEnd, to: evidence::GoalEnd| {
        record(move |record| match record {
            Record::GoalEnded(ended) if ended.end() == from => {
                ended.set_end(to);
                true
            }
            _ => false,
        })
    };
    use evidence::GoalEnd::{Failed, Preempted, Reached};
    tale.add("preempted_is_reached", told(&ended(Preempted, Reached)));
    tale.add("reached_is_preempted", told(&ended(Reached, Preempted)));
    tale.add("reached_is_failed", told(&ended(Reached, Failed)));
    tale.add("no_goal_ends", told(&drop_all(|record| matches!(record, Record::GoalEnded(_)))));
    tale.add(
        "put_off_too_often",
        told(&record(|record| match record {
            Record::Deferred(deferred) => {
                deferred.times = 99;
                true
            }
            _ => false,
        })),
    );
    tale.add(
        "closed_for_another_reason",
        told(&record(|record| match record {
            Record::Closed(closed) => {
                closed.set_how(evidence::Closing::StaffDeferredTooOften);
                true
            }
            _ => false,
        })),
    );
    let ending = |pieces: &mut Pieces| {
        pieces.change_record(|record| match record {
            Record::EmergencyUnverified(_) => {
                *record = Record::ShuttingDown(evidence::Mark {});
                true
            }
            _ => false,
        });
    };
    tale.add("an_end_that_nobody_asked_for", told(&ending));
    tale.add(
        "an_end_that_excuses_an_emergency",
        told(&|pieces: &mut Pieces| {
            ending(pieces);
            pieces.take_out(|record| {
                matches!(record, Record::GoalStarted(started) if matches!(
                    started.served.as_ref().and_then(|served| served.served.as_ref()),
                    Some(served::Served::Emergency(_))
                ))
            });
        }),
    );
    insta::assert_snapshot!("the_course_of_goals_and_requests", tale.0);
}

#[test]
fn what_is_personal() {
    let mut tale = Tale::default();
    let reply = |change: fn(&mut reply::Reply) -> bool| {
        move |pieces: &mut Pieces| {
            for message in &mut pieces.messages {
                if &*message.schema == "selfneg.personal.v1.Reply" {
                    let mut personal = personal::Reply::decode(message.data.as_slice()).unwrap();
                    if personal.reply.as_mut().is_some_and(change) {
                        message.data = personal.encode_to_vec();
                        return;
                    }
                }
            }
            panic!("there is no such reply");
        }
    };
    tale.add(
        "another_condition",
        told(reply(|reply| match reply {
            reply::Reply::Disclosed(disclosed) => {
                disclosed.disclosed = Some(personal::disclosed::Disclosed::Listed(5));
                true
            }
            _ => false,
        })),
    );
    tale.add(
        "another_worth",
        told(reply(|reply| match reply {
            reply::Reply::Worth(worth) => {
                worth.value += 1;
                true
            }
            _ => false,
        })),
    );
    tale.add(
        "another_rank_was_told",
        told(|pieces| {
            for message in &mut pieces.messages {
                if &*message.schema == "selfneg.personal.v1.Input" {
                    let mut input = personal::Input::decode(message.data.as_slice()).unwrap();
                    if let Some(personal::input::Input::Data(data)) = &mut input.input {
                        data.profiles[0].ranks.iter_mut().for_each(|rank| rank.rank = 5 - rank.rank);
                        message.data = input.encode_to_vec();
                        return;
                    }
                }
            }
            panic!("nobody gave any data");
        }),
    );
    insta::assert_snapshot!("what_is_personal", tale.0);
}

fn result(audit: &Audit, property: Property) -> Checked {
    audit.properties.iter().find(|one| one.name == property.name()).unwrap().result
}

#[test]
fn what_cannot_be_checked_is_told_from_what_is_not_there() {
    use Checked::{Held, NotChecked, NothingToCheck};
    let found = audited(honest());
    for property in Property::ALL {
        assert_eq!(result(&found, property), Held, "{}", property.name());
    }
    let found = audited_openly(honest());
    for property in [Property::Redecision, Property::Replay, Property::Commitments] {
        assert_eq!(result(&found, property), NotChecked, "{}", property.name());
    }
    assert!(found.decisions.iter().all(|one| one.redecided == Redecided::Unchecked), "{found:#?}");
    // Nobody negotiates, so there is no decision to make again.
    let choices = vec![Choice::Request(1, 0), Choice::Answer(data([1; 6], &[]))];
    let alone = Pieces::of(&random_mission::trace(choices, Options::default(), None));
    let found = audited(&alone);
    assert_eq!(result(&found, Property::Redecision), NothingToCheck);
    assert_eq!(result(&found, Property::Replay), Held);
    let found = audited_openly(&alone);
    assert_eq!(result(&found, Property::Redecision), NothingToCheck);
    assert_eq!(result(&found, Property::Replay), NotChecked);
}

#[test]
fn what_is_said_to_be_sealed_and_is_not_there_is_not_sealed_to_others() {
    let mut pieces = honest().clone();
    pieces.messages.retain(|message| !message.topic.starts_with(PERSONAL));
    pieces.renumber();
    let place = pieces.messages.iter().position(|message| &*message.schema == "selfneg.v1.Header").unwrap();
    let mut header = evidence::Header::decode(pieces.messages[place].data.as_slice()).unwrap();
    header.set_privacy(evidence::Privacy::Sealed);
    pieces.messages[place].data = header.encode_to_vec();
    let identities = vec![AuditorKey::generate()];
    for identities in [Vec::new(), identities] {
        let found = audit(&pieces.to_bytes(), &Keys { robots: Vec::new(), identities });
        let said = found.tell("run.mcap");
        assert!(said.contains("its personal data are said to be sealed, and none are in it"), "{said}");
        assert!(said.contains("no personal data are in it"), "{said}");
        assert!(!said.contains("other keys"), "{said}");
    }
}

/// The honest trace as if its robot had been given other limits.
fn with_limits(change: impl Fn(&mut evidence::Limits)) -> Pieces {
    let mut pieces = honest().clone();
    let forge = |specification: &mut Option<evidence::Specification>| {
        change(specification.as_mut().unwrap().limits.as_mut().unwrap());
    };
    let of = |pieces: &Pieces, schema: &str| {
        pieces.messages.iter().position(|message| &*message.schema == schema).unwrap()
    };
    let (header_at, rules_at) = (of(&pieces, "selfneg.v1.Header"), of(&pieces, "selfneg.personal.v1.Rules"));
    let mut rules = personal::Rules::decode(pieces.messages[rules_at].data.as_slice()).unwrap();
    forge(&mut rules.specification);
    pieces.messages[rules_at].data = rules.encode_to_vec();
    let mut header = evidence::Header::decode(pieces.messages[header_at].data.as_slice()).unwrap();
    forge(&mut header.specification);
    let options = header.options.clone().unwrap();
    header.rules_digest = rules_digest(&options, &header.policy, &rules.encode_to_vec()).to_vec();
    pieces.messages[header_at].data = header.encode_to_vec();
    pieces
}

#[test]
fn limits_that_no_memory_holds_are_not_run() {
    let found = audited(&with_limits(|limits| {
        (limits.users, limits.requests, limits.conditions, limits.profiles) = (255, 255, 65_000, 255);
    }));
    assert_eq!(found.redecided(), 0, "not the emergency either: {:#?}", found.findings);
    assert_eq!(result(&found, Property::Replay), Checked::NotChecked);
    assert!(found.findings.iter().any(|finding| finding.what.contains("limits")), "{found:#?}");
}

/// Whatever limits a robot takes, the auditor takes.
#[test]
fn the_largest_limits_of_a_robot_are_run() {
    let found = audited(&with_limits(|limits| {
        (limits.users, limits.requests, limits.conditions, limits.profiles) = (255, 255, 3_000, 255);
    }));
    assert_eq!(found.redecided(), 3);
    assert_eq!(findings(&found), "");
    assert!(found.unchecked.is_empty(), "{:?}", found.unchecked);
}

#[test]
fn no_more_emergencies_wait_than_the_robot_keeps() {
    let found = audited_openly(&with_limits(|limits| limits.emergencies = 0));
    assert_eq!(found.status, Status::Violation);
    let told = findings(&found);
    assert!(told.contains("more emergencies wait than the robot keeps"), "{told}");
}
