//! Whether emergencies went first, as far as the open records tell: this is all of it, since
//! nothing of an emergency but its place is personal.

use super::finding::{Log, Place};
use super::property::Property;
use super::turn::Turn;
use crate::trace::schema::evidence::{
    EmergencyClaim, Evidence, GoalEnd, Header, Proof, Staff, event::Event, record::Record, served::Served,
};

/// No robot keeps more: their number is one byte of its limits.
const MAX_EMERGENCIES: u32 = 255;

/// Checks all turns of a trace.
pub(super) fn check(header: &Header, turns: &[Turn<'_>], log: &mut Log) {
    let mut watch = Watch {
        header,
        waiting: Vec::new(),
        pursued: Pursued::Nothing,
        safe: true,
        over: false,
        told: Vec::new(),
        log,
    };
    for turn in turns {
        watch.turn(turn);
    }
}

/// What the robot is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pursued {
    Nothing,
    /// A user's goal, or one that nobody wants any more.
    Goal,
    Emergency(u32),
}

struct Watch<'a> {
    header: &'a Header,
    /// Categories of certain emergencies, by arrival.
    waiting: Vec<u32>,
    pursued: Pursued,
    /// Whether the robot may leave its goal now.
    safe: bool,
    /// The mission is ending: nothing is acted on any more.
    over: bool,
    /// Those waiting of which it was told already that they should not.
    told: Vec<u32>,
    log: &'a mut Log,
}

impl Watch<'_> {
    fn gravity(&self, category: u32) -> u32 {
        self.category(category).map_or(0, |(gravity, _)| gravity)
    }

    fn category(&self, category: u32) -> Option<(u32, Proof)> {
        let emergencies = &self.header.specification.as_ref()?.emergencies;
        let category = emergencies.get(usize::try_from(category).ok()?)?;
        Some((category.gravity, category.proof()))
    }

    fn is_certain(&self, claim: &EmergencyClaim) -> bool {
        match self.category(claim.category) {
            Some((_, Proof::Sensed)) => claim.evidence() == Evidence::Sensed,
            Some((_, Proof::Verified)) => claim.evidence() == Evidence::Verified,
            Some((_, Proof::Unspecified)) | None => false,
        }
    }

    fn broken(&mut self, at: Place, what: impl Into<String>) {
        self.log.broken(Property::HardEthics, at, what);
    }

    fn turn(&mut self, turn: &Turn<'_>) {
        let claim = match turn.happened() {
            Some(Event::Emergency(claim)) => Some(claim),
            _ => None,
        };
        let at = turn.event.map_or(Place::WHOLE, |event| Place::entry(event.index, event.at));
        if let Some(claim) = claim
            && !(turn.may_be_cut && turn.replies.is_empty())
        {
            self.claimed(claim, turn, at);
        }
        let mut records = turn.records().peekable();
        while let Some((entry, record)) = records.next() {
            let at = Place::entry(entry.index, entry.at);
            // Human staff is called in the next record, if at all.
            let staff = match records.peek() {
                Some((_, Record::StaffCalled(called))) if called.user.is_none() => Some(called.why()),
                _ => None,
            };
            match record {
                Record::EmergencyDecided(known) => {
                    let claimed = claim.is_some_and(|claim| {
                        claim.category == known.category && claim.evidence == known.evidence
                    });
                    if !claimed {
                        self.broken(at, "an emergency is decided that nobody claimed so");
                    }
                    if !staff.is_some_and(|why| self.is_handed_over(why)) {
                        if self.is_full() {
                            self.broken(at, "more emergencies wait than the robot keeps");
                        } else {
                            self.waiting.push(known.category);
                        }
                    }
                }
                Record::GoalStarted(started) => {
                    let served = started.served.as_ref().and_then(|served| served.served.as_ref());
                    self.started(served, at);
                }
                Record::GoalEnded(ended) => {
                    if let (Pursued::Emergency(category), GoalEnd::Preempted) = (self.pursued, ended.end())
                        && !(staff == Some(Staff::NoRoom) && self.is_full())
                    {
                        self.waiting.insert(0, category);
                    }
                    self.pursued = Pursued::Nothing;
                    self.safe = true;
                }
                Record::TaskStarted(started) => self.safe = started.interruptible,
                Record::Held(_) => self.safe = true,
                // Without the event it excuses nothing; `course` finds fault with it.
                Record::ShuttingDown(_) if matches!(turn.happened(), Some(Event::Shutdown(_))) => {
                    self.over = true;
                    self.waiting.clear();
                }
                _ => {}
            }
        }
        if !turn.may_be_cut {
            self.still_waiting(at);
        }
    }

    /// Whether human staff may be called for a certain emergency instead. What the robot is
    /// capable of is personal.
    fn is_handed_over(&self, why: Staff) -> bool {
        match why {
            Staff::Shutdown => self.over,
            Staff::NoRoom => self.is_full(),
            Staff::EmergencyBeyondRobot => true,
            Staff::DeferredTooOften | Staff::Unspecified => false,
        }
    }

    /// Whether as many emergencies wait as the robot keeps.
    fn is_full(&self) -> bool {
        let limits = self.header.specification.as_ref().and_then(|one| one.limits.as_ref());
        let waiting = u32::try_from(self.waiting.len()).unwrap_or(u32::MAX);
        limits.is_none_or(|limits| waiting >= limits.emergencies.min(MAX_EMERGENCIES))
    }

    /// What the mission makes of a claim.
    fn claimed(&mut self, claim: &EmergencyClaim, turn: &Turn<'_>, at: Place) {
        let certain = self.is_certain(claim);
        let decided = turn.records().any(|(_, record)| matches!(record, Record::EmergencyDecided(_)));
        if certain && !decided {
            self.broken(at, "a certain emergency was not decided at once");
        } else if !certain && decided {
            self.broken(at, "an emergency was taken for certain without the evidence that it asks for");
        } else if !certain && (turn.records().count() != 1 || turn.commands().count() != 0) {
            self.broken(at, "a claim without evidence had an effect");
        } else {
            self.log.held(Property::HardEthics);
        }
    }

    fn started(&mut self, served: Option<&Served>, at: Place) {
        if self.pursued != Pursued::Nothing {
            let what = match self.pursued {
                Pursued::Emergency(_) => "a goal starts while an emergency is being acted on",
                _ => "a goal starts before the one before it has ended",
            };
            self.broken(at, what);
        }
        match served {
            Some(Served::Emergency(category)) => {
                let most = self.waiting.iter().map(|&waits| self.gravity(waits)).max();
                let gravest = self.waiting.iter().position(|&waits| Some(self.gravity(waits)) == most);
                let next = gravest.and_then(|place| self.waiting.get(place).copied());
                if next == Some(*category) {
                    self.log.held(Property::HardEthics);
                } else {
                    let what = match next {
                        Some(next) => {
                            format!("an emergency of category {category} goes before one of category {next}")
                        }
                        None => {
                            format!("an emergency of category {category} is acted on that was never decided")
                        }
                    };
                    self.broken(at, what);
                }
                let place = self.waiting.iter().position(|waits| waits == category);
                if let Some(place) = place {
                    self.waiting.remove(place);
                }
                self.pursued = Pursued::Emergency(*category);
            }
            _ => {
                if !self.waiting.is_empty() {
                    self.broken(at, "a user's goal starts while a certain emergency waits");
                }
                self.pursued = Pursued::Goal;
            }
        }
        self.safe = true;
    }

    /// At the end of a turn nothing may wait that could be acted on.
    fn still_waiting(&mut self, at: Place) {
        let Some(gravest) = self.waiting.iter().map(|&waits| self.gravity(waits)).max() else { return };
        let graver = match self.pursued {
            Pursued::Emergency(now) => gravest > self.gravity(now),
            Pursued::Goal | Pursued::Nothing => true,
        };
        if graver && self.safe && !self.over {
            if self.told == self.waiting {
                return;
            }
            self.told.clone_from(&self.waiting);
            self.broken(at, "a certain emergency waits, though the robot could act on it");
        } else {
            self.log.held(Property::HardEthics);
        }
    }
}
