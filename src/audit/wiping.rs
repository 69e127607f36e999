//! Whether everybody's data were wiped in time, as far as the open records tell.
//!
//! The mission holds a user's data from the record that it has accepted them. Whoever is put
//! off, or whose request is closed, must hold nothing any more when the event that did it is
//! over; after a decision, or when it is called off, nobody may have a snapshot left; and
//! every wipe must have left no byte. Who negotiates or is served must have data accepted that
//! were not wiped since, so that leaving out what was told of them is found as well.

use std::collections::{BTreeMap, BTreeSet};

use super::finding::{Log, Place};
use super::property::Property;
use super::turn::Turn;
use crate::trace::schema::evidence::{Component, Lifecycle, event::Event, record::Record, served::Served};

/// What is held of whom.
#[derive(Debug, Default)]
struct Held {
    /// Users whose data were accepted and not wiped.
    data: BTreeSet<u32>,
    /// Users with a snapshot, and in which components.
    snapshots: BTreeMap<u32, BTreeSet<i32>>,
}

/// Who holds the snapshot that a user negotiates with.
const NEGOTIATING: [Component; 2] = [Component::OfferGenerator, Component::EthicalImpactAnalyzer];

impl Held {
    fn needs_data(&self, user: u32, what: &str, at: Place, log: &mut Log) {
        if !self.data.contains(&user) {
            let what = format!("user {user} {what}, and its data were not accepted, or are wiped");
            log.broken(Property::WipedInTime, at, what);
        }
    }
}

/// Checks all turns of a trace.
pub(super) fn check(turns: &[Turn<'_>], log: &mut Log) {
    let mut held = Held::default();
    for turn in turns {
        let mut done_with: BTreeMap<u32, Place> = BTreeMap::new();
        let mut decided = None;
        for (entry, record) in turn.records() {
            let at = Place::entry(entry.index, entry.at);
            match record {
                Record::DataAccepted(subject) => {
                    let given =
                        matches!(turn.happened(), Some(Event::Data(data)) if data.user == subject.user);
                    if !given {
                        let what = format!("data of user {} are accepted that it did not give", subject.user);
                        log.broken(Property::WipedInTime, at, what);
                    }
                    held.data.insert(subject.user);
                    done_with.remove(&subject.user);
                }
                Record::Lifecycle(change) => {
                    if let (Some(user), Lifecycle::Active) = (change.user, change.to())
                        && change.component() != Component::ContextEthicsManager
                    {
                        held.snapshots.entry(user).or_default().insert(change.component);
                    }
                }
                Record::Wiped(wiped) => {
                    if wiped.left > 0 {
                        let what = format!(
                            "{} bytes of user {} were left after the wipe of the {}",
                            wiped.left,
                            wiped.user,
                            component(wiped.component())
                        );
                        log.broken(Property::WipedInTime, at, what);
                        continue;
                    }
                    log.held(Property::WipedInTime);
                    if wiped.component() == Component::ContextEthicsManager {
                        held.data.remove(&wiped.user);
                    } else if let Some(components) = held.snapshots.get_mut(&wiped.user) {
                        components.remove(&wiped.component);
                        if components.is_empty() {
                            held.snapshots.remove(&wiped.user);
                        }
                    }
                }
                Record::Deferred(deferred) => {
                    done_with.insert(deferred.user, at);
                }
                Record::Closed(closed) => {
                    done_with.insert(closed.user, at);
                }
                Record::Decided(_) | Record::NegotiationsDropped(_) => decided = Some(at),
                Record::NegotiationStarted(started) => {
                    decided = None;
                    for user in [started.current, started.interrupting] {
                        held.needs_data(user, "negotiates", at, log);
                        held.snapshots.entry(user).or_default().extend(NEGOTIATING.map(i32::from));
                    }
                }
                Record::GoalStarted(started) => {
                    if let Some(Served::User(user)) = started.served.as_ref().and_then(|served| served.served)
                    {
                        held.needs_data(user, "is served", at, log);
                    }
                }
                _ => {}
            }
        }
        if turn.may_be_cut {
            continue;
        }
        for (user, at) in done_with {
            if held.data.remove(&user) {
                let what = format!("user {user} is put off or done with, and was not wiped");
                log.broken(Property::WipedInTime, at, what);
            } else {
                log.held(Property::WipedInTime);
            }
            if held.snapshots.remove(&user).is_some() {
                let what = format!("user {user} is put off or done with, and the snapshot was not wiped");
                log.broken(Property::WipedInTime, at, what);
            }
        }
        if let Some(at) = decided {
            for user in std::mem::take(&mut held.snapshots).into_keys() {
                let what = format!("the decision is over, and the snapshot of user {user} was not wiped");
                log.broken(Property::WipedInTime, at, what);
            }
            log.held(Property::WipedInTime);
        }
    }
}

fn component(component: Component) -> &'static str {
    match component {
        Component::ContextEthicsManager => "context and ethics manager",
        Component::OfferGenerator => "offer generator",
        Component::EthicalImpactAnalyzer => "ethical impact analyzer",
        Component::MissionController => "mission controller",
        Component::InterruptionManager => "interruption manager",
        Component::NegotiationManager => "negotiation manager",
        Component::Unspecified => "unknown component",
    }
}
