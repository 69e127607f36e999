//! What an observer sees of a run, and that seeing it changes nothing.
#![allow(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    reason = "clippy looks for tests only in functions marked so"
)]

mod naive;
mod situation;

use proptest::prelude::*;
use proptest::sample::Index;
use selfneg_core::{
    Case, Conclusion, Condition, Disclosure, Ending, Impact, Negotiation, Observer, Offer, Options, Party,
    Ruling, Side, Step, Turn, Verdict, Weighing, party::Role,
};

use situation::{Person, Situation, situations, variants};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Event {
    Offer { round: u32, sender: Side, depth: usize, discloses: Disclosure },
    Weighed { receiver: Side, weighing: Weighing },
    Ruled { receiver: Side, ruling: Ruling },
    Quit { round: u32, sender: Side },
    Concluded(Conclusion),
}

#[derive(Default)]
struct Record(Vec<Event>);

impl Observer for Record {
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        self.0.push(Event::Offer { round, sender, depth, discloses });
    }
    fn weighed(&mut self, receiver: Side, weighing: Weighing) {
        self.0.push(Event::Weighed { receiver, weighing });
    }
    fn ruled(&mut self, receiver: Side, ruling: Ruling) {
        self.0.push(Event::Ruled { receiver, ruling });
    }
    fn quit(&mut self, round: u32, sender: Side) {
        self.0.push(Event::Quit { round, sender });
    }
    fn concluded(&mut self, conclusion: Conclusion) {
        self.0.push(Event::Concluded(conclusion));
    }
}

fn recorded(negotiation: Negotiation<'_>) -> (Vec<Event>, Conclusion) {
    let mut record = Record::default();
    let conclusion = negotiation.run(&mut record);
    (record.0, conclusion)
}

/// One round of a record: an offer with what became of it, or a quit.
#[derive(Debug)]
enum Round {
    Offer { sender: Side, depth: usize, discloses: Disclosure, weighing: Weighing, ruling: Ruling },
    Quit { sender: Side },
}

/// Reads a record by its grammar: rounds numbered from 1, each offer-weighed-ruled with
/// one sender and one receiver, or a quit; the conclusion once, last.
fn rounds(events: &[Event]) -> Result<(Vec<Round>, Conclusion), TestCaseError> {
    let mut rounds = Vec::new();
    let mut rest = events;
    loop {
        let next = u32::try_from(rounds.len()).unwrap() + 1;
        match rest {
            [Event::Concluded(conclusion)] => return Ok((rounds, *conclusion)),
            [Event::Quit { round, sender }, later @ ..] => {
                prop_assert_eq!(*round, next);
                rounds.push(Round::Quit { sender: *sender });
                rest = later;
            }
            [
                Event::Offer { round, sender, depth, discloses },
                Event::Weighed { receiver: weigher, weighing },
                Event::Ruled { receiver: ruler, ruling },
                later @ ..,
            ] => {
                prop_assert_eq!(*round, next);
                prop_assert_eq!([*weigher, *ruler], [sender.other(); 2]);
                rounds.push(Round::Offer {
                    sender: *sender,
                    depth: *depth,
                    discloses: *discloses,
                    weighing: *weighing,
                    ruling: *ruling,
                });
                rest = later;
            }
            _ => return Err(TestCaseError::fail(format!("round {next} is malformed: {rest:?}"))),
        }
    }
}

/// What `side` discloses with its offer of depth `depth`.
fn disclosed_by(situation: &Situation, side: Side, depth: usize) -> Disclosure {
    match situation.person(side).status.get(depth - 1) {
        Some(&condition) => Disclosure::Condition(Condition(condition)),
        None => Disclosure::Willingness,
    }
}

fn impact(total: u128) -> Impact {
    Impact(u64::try_from(total).unwrap())
}

/// The whole record, given how many rounds it has: senders alternate until one quits, each
/// discloses its own conditions in order, one an offer, each receiver weighs exactly its
/// naive sums, accepts exactly what exceeds its own offer, and no offer follows one that
/// was accepted.
fn record_is_as_the_protocol_says(situation: &Situation, options: &Options) -> Result<(), TestCaseError> {
    let (events, conclusion) = situation.with(|case| recorded(case.negotiation(options)));
    let (rounds, concluded) = rounds(&events)?;
    prop_assert_eq!(concluded, conclusion);
    prop_assert_eq!(rounds.len(), conclusion.rounds as usize);

    let mut depths = [0, 0];
    let of = |side: Side| usize::from(side == Side::Interrupting);
    let mut sender_due = Side::Interrupting;
    let mut has_quit = None;
    let mut held = None;
    for (number, round) in rounds.iter().enumerate() {
        let last = number + 1 == rounds.len();
        match *round {
            Round::Offer { sender, depth, discloses, weighing, ruling } => {
                prop_assert_eq!(sender, sender_due);
                depths[of(sender)] += 1;
                prop_assert_eq!(depth, depths[of(sender)]);
                prop_assert!(depth <= naive::offers(situation, sender, options));
                prop_assert_eq!(discloses, disclosed_by(situation, sender, depth));

                prop_assert_eq!(weighing.value, impact(naive::value(situation, sender, depth, options)));
                prop_assert_eq!(
                    weighing.threshold,
                    impact(naive::threshold(situation, sender.other(), options))
                );
                let acceptable = weighing.value > weighing.threshold;
                prop_assert_eq!(acceptable, ruling != Ruling::Reject);
                prop_assert_eq!(weighing.surplus().map_or(0, |s| s.0.get()), {
                    if acceptable { weighing.value.0 - weighing.threshold.0 } else { 0 }
                });

                prop_assert!(ruling != Ruling::Accept || last);
                prop_assert!(held.is_none() || last, "a held offer is decided by the reply");
                if ruling == Ruling::Hold {
                    prop_assert!(has_quit.is_none() && sender == Side::Interrupting && !last);
                    held = Some(depth);
                }
                sender_due = if has_quit.is_some() { sender } else { sender.other() };
            }
            Round::Quit { sender } => {
                prop_assert_eq!(sender, sender_due);
                prop_assert_eq!(depths[of(sender)], naive::offers(situation, sender, options));
                prop_assert!(held.is_none());
                prop_assert_eq!(last, has_quit.is_some() || options.quit == selfneg_core::QuitRule::Literal);
                has_quit = Some(sender);
                sender_due = sender.other();
            }
        }
    }
    Ok(())
}

/// `run` with an observer, `run` without, `negotiate`, `decide` and stepping by hand.
fn however_it_is_run_it_is_the_same(situation: &Situation, options: &Options) -> Result<(), TestCaseError> {
    situation.with(|case| {
        let (events, conclusion) = recorded(case.negotiation(options));
        prop_assert_eq!(case.negotiation(options).run(&mut ()), conclusion);
        prop_assert_eq!(case.negotiate(options), conclusion);
        let mut record = Record::default();
        prop_assert_eq!(case.decide(options, &mut &mut record).conclusion, conclusion);
        prop_assert_eq!(&record.0, &events);

        let mut record = Record::default();
        let mut negotiation = case.negotiation(options);
        let mut made = [0, 0];
        loop {
            let rounds = negotiation.rounds();
            let sender = negotiation.turn().sender();
            let seen = record.0.len();
            for side in [Side::Current, Side::Interrupting] {
                prop_assert_eq!(negotiation.depth(side), made[usize::from(side == Side::Interrupting)]);
            }
            let holds = negotiation.holds();
            let clone = negotiation.clone();
            let step = negotiation.step(&mut record);
            let new = &record.0[seen..];
            match new[0] {
                Event::Offer { round, sender: who, .. } => {
                    prop_assert_eq!((round, who), (rounds + 1, sender));
                    made[usize::from(who == Side::Interrupting)] += 1;
                }
                Event::Quit { round, sender: who } => prop_assert_eq!((round, who), (rounds + 1, sender)),
                other => return Err(TestCaseError::fail(format!("a round begins with {other:?}"))),
            }
            // A clone goes on as the original does.
            prop_assert_eq!(clone.run(&mut ()), conclusion);
            match step {
                Step::Ongoing(next) => {
                    prop_assert!(holds.is_none());
                    let held_now = new.iter().any(|e| matches!(e, Event::Ruled { ruling: Ruling::Hold, .. }));
                    prop_assert_eq!(next.holds(), held_now.then_some(sender));
                    let quit_now = matches!(new, [Event::Quit { .. }]);
                    prop_assert_eq!(
                        matches!(next.turn(), Turn::Alone(_)),
                        quit_now || matches!(alone_after(&events, next.rounds()), Some(Turn::Alone(_)))
                    );
                    prop_assert_eq!(next.rounds(), rounds + 1);
                    negotiation = next;
                }
                Step::Concluded(last) => {
                    prop_assert_eq!(last, conclusion);
                    prop_assert_eq!(new.last(), Some(&Event::Concluded(last)));
                    prop_assert_eq!(&record.0, &events);
                    return Ok(());
                }
            }
        }
    })
}

/// Who sends after `rounds` rounds, `Alone` if a quit is among them.
fn alone_after(events: &[Event], rounds: u32) -> Option<Turn> {
    events.iter().find_map(|event| match event {
        Event::Quit { round, sender } if *round <= rounds => Some(Turn::Alone(sender.other())),
        _ => None,
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn record_of_every_variant_is_as_the_protocol_says(situation in situations(6)) {
        for options in variants() {
            record_is_as_the_protocol_says(&situation, &options)?;
        }
    }

    #[test]
    fn every_way_to_run_a_negotiation_is_the_same(situation in situations(6)) {
        for options in variants() {
            however_it_is_run_it_is_the_same(&situation, &options)?;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn record_of_long_negotiations_is_as_the_protocol_says(situation in situations(60)) {
        for options in variants() {
            record_is_as_the_protocol_says(&situation, &options)?;
        }
    }
}

/// The totals a receiver notes, with its verdict.
fn judged<'a, R: Role>(receiver: &mut Party<'a, R>, offer: &Offer<'a, R::Other>) -> (Vec<Event>, Verdict) {
    let mut record = Record::default();
    let verdict = receiver.judge(offer, &mut record);
    (record.0, verdict)
}

/// All offers of a party, the shallowest first.
fn all_offers<'a, R: Role>(mut party: Party<'a, R>) -> Vec<Offer<'a, R>> {
    std::iter::from_fn(|| party.offer()).collect()
}

/// A party that has heard anything before judges as one that has heard nothing, and both
/// as the naive sums say.
fn verdict_is_a_function_of_receiver_and_offer<'a, R: Role>(
    fresh: &Party<'a, R>,
    offers: &[(Offer<'a, R::Other>, Weighing)],
    sequence: &[Index],
) -> Result<(), TestCaseError> {
    if offers.is_empty() {
        return Ok(());
    }
    let mut used = fresh.clone();
    for index in sequence {
        let (offer, weighing) = index.get(offers);
        let by_used = judged(&mut used, offer);
        let event = Event::Weighed { receiver: R::SIDE, weighing: *weighing };
        let verdict = weighing.surplus().map_or(Verdict::Rejected, Verdict::Acceptable);
        prop_assert_eq!(&by_used, &(vec![event], verdict));
        prop_assert_eq!(&by_used, &judged(&mut fresh.clone(), offer));
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    /// The senders share their memory in every way that could mislead a receiver that
    /// recognises what it has heard: the same conditions under another goal or a goal cut
    /// short, and statuses that are a part of another one's from its start or its middle.
    #[test]
    fn running_totals_of_a_receiver_never_show(
        situation in situations(12),
        other_mentions in proptest::collection::vec(0..=3u8, 12),
        cut in any::<Index>(),
        sequence in proptest::collection::vec(any::<Index>(), 1..40),
        willingness in 0..=2u8,
    ) {
        use selfneg_core::{EthicalProfile, Implication, Rank, Status, User};
        let rows = &situation.rows;
        let sender = &situation.interrupting;
        let receiver = &situation.current;
        let status: Vec<Condition> = sender.status.iter().copied().map(Condition).collect();
        let profile = EthicalProfile::new(&[Rank(0)]);
        let cut_status = cut.index(status.len() + 1);
        let cut_goal = cut.index(sender.mentions.len() + 1);
        let statuses = [0..status.len(), 0..cut_status, cut_status..status.len()];
        let goals = [&sender.mentions[..], &sender.mentions[..cut_goal], &other_mentions[..]];
        for options in variants().filter(|o| o.willingness == willingness) {
            situation.with(|case: &Case<'_>| {
                // The senders' memory outlives the receiver, who never reads beyond it.
                let receiving_current = Party::current(case.current, case.activation, &options);
                let receiving_interrupter = Party::interrupting(case.current, case.activation, &options);
                let mut to_current = Vec::new();
                let mut to_interrupter = Vec::new();
                for range in &statuses {
                    for goal in goals {
                        let user =
                            User::new(profile, Status::new(&status[range.clone()]).unwrap(), Implication::new(goal));
                        let person = Person {
                            ranks: vec![0],
                            status: sender.status[range.clone()].to_vec(),
                            mentions: goal.to_vec(),
                        };
                        let weighing = |depth: usize, willingness: u8| {
                            let own = receiver.status.len();
                            Weighing {
                                value: impact(naive::impact(rows, &person, depth, receiver, options.aggregation)),
                                threshold: impact(
                                    naive::impact(rows, receiver, own, receiver, options.aggregation)
                                        + u128::from(willingness),
                                ),
                            }
                        };
                        for offer in all_offers(Party::interrupting(user, case.activation, &options)) {
                            let weighing = weighing(offer.depth(), options.willingness);
                            to_current.push((offer, weighing));
                        }
                        for offer in all_offers(Party::current(user, case.activation, &options)) {
                            let weighing = weighing(offer.depth(), 0);
                            to_interrupter.push((offer, weighing));
                        }
                    }
                }
                verdict_is_a_function_of_receiver_and_offer(&receiving_current, &to_current, &sequence)?;
                verdict_is_a_function_of_receiver_and_offer(&receiving_interrupter, &to_interrupter, &sequence)
            })?;
        }
    }

    /// An offer holds a prefix of its sender's conditions and its goal, and a party makes
    /// exactly as many as it has.
    #[test]
    fn offers_are_the_prefixes_in_order(situation in situations(12), willingness in 0..=2u8) {
        let options = Options { willingness, ..Options::default() };
        situation.with(|case| {
            offers_are_prefixes(Party::current(case.current, case.activation, &options), &situation, &options)?;
            offers_are_prefixes(
                Party::interrupting(case.interrupting, case.activation, &options),
                &situation,
                &options,
            )
        })?;
    }
}

fn offers_are_prefixes<R: Role>(
    mut party: Party<'_, R>,
    situation: &Situation,
    options: &Options,
) -> Result<(), TestCaseError> {
    let person = situation.person(R::SIDE);
    let offers = naive::offers(situation, R::SIDE, options);
    for depth in 1..=offers {
        prop_assert!(party.has_offer(depth) && party.has_yet_to_offer(depth));
        let offer = party.offer().unwrap();
        prop_assert!(party.has_offer(depth) && !party.has_yet_to_offer(depth));
        prop_assert_eq!([offer.depth(), party.offers_made()], [depth; 2]);
        prop_assert_eq!(offer.discloses(), disclosed_by(situation, R::SIDE, depth));
        let prefix: Vec<Condition> = person.status.iter().copied().take(depth).map(Condition).collect();
        prop_assert_eq!(offer.conditions(), &prefix[..]);
        for d in 0..20 {
            let mentions = person.mentions.get(usize::from(d)).copied().unwrap_or(0);
            prop_assert_eq!(offer.goal().mentions(selfneg_core::Disposition(d)), mentions);
        }
    }
    prop_assert!(!party.has_offer(offers + 1));
    for _ in 0..2 {
        prop_assert!(party.offer().is_none());
        prop_assert_eq!(party.offers_made(), offers);
    }
    Ok(())
}

#[test]
fn rulings_have_names() {
    assert_eq!(
        [Ruling::Accept, Ruling::Reject, Ruling::Hold].map(Ruling::name),
        ["accept", "reject", "hold"]
    );
}

#[test]
fn endings_have_names() {
    use Ending::{Accepted, BothQuit, HeldOfferStands, LiteralQuit, Tie};
    assert_eq!(
        [Accepted, HeldOfferStands, Tie, BothQuit].map(Ending::name),
        ["accepted", "held-offer-stands", "tie", "both-quit"]
    );
    for side in [Side::Current, Side::Interrupting] {
        assert_eq!(LiteralQuit(side).name(), "literal-quit");
    }
}
