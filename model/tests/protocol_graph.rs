//! The protocol graph against the engine: random negotiations take its moves and end where
//! it says, and every way of small graphs is taken by some negotiation.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test may panic")]

use std::collections::BTreeSet;

use proptest::prelude::*;
use selfneg_core::{
    Activation, Aggregation, Case, Condition, Disposition, EthicalProfile, Fallback, Implication, Options,
    QuitRule, Rank, Status, TieRule, User,
};
use selfneg_model::protocol_graph::{Move, ProtocolGraph, State, moves_of};

fn options() -> impl Strategy<Value = Options> {
    let quit = prop::sample::select(QuitRule::ALL);
    let tie = prop::sample::select(TieRule::ALL);
    (quit, tie, 0_u8..3).prop_map(|(quit, tie, willingness)| Options {
        quit,
        tie,
        willingness,
        aggregation: Aggregation::PerCondition,
        fallback: Fallback::FirstCome,
    })
}

fn person() -> impl Strategy<Value = (Vec<u16>, Vec<u8>)> {
    (prop::collection::btree_set(0_u16..6, 0..=6), prop::collection::vec(0_u8..4, 6))
        .prop_map(|(conditions, ranks)| (conditions.into_iter().collect(), ranks))
}

fn run(people: &[(Vec<u16>, Vec<u8>); 2], options: &Options) -> (ProtocolGraph, Vec<Move>, State) {
    let rows: Vec<[Disposition; 1]> = (0..6).map(|d| [Disposition(d)]).collect();
    let rows: Vec<&[Disposition]> = rows.iter().map(|row| &row[..]).collect();
    let goal = [1; 6];
    let data = people.clone().map(|(conditions, ranks)| {
        (
            conditions.into_iter().map(Condition).collect::<Vec<_>>(),
            ranks.into_iter().map(Rank).collect::<Vec<_>>(),
        )
    });
    let [current, interrupting] = [0, 1].map(|side: usize| {
        let (conditions, ranks) = &data[side];
        User::new(EthicalProfile::new(ranks), Status::new(conditions).unwrap(), Implication::new(&goal))
    });
    let case = Case { activation: Activation::new(&rows).unwrap(), current, interrupting };
    let offers = people[0].0.len() + usize::from(options.willingness > 0);
    let graph = ProtocolGraph::of(offers, people[1].0.len(), options);
    (graph, moves_of(&case, options), State::Concluded(case.negotiate(options).outcome))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn the_engine_goes_a_way_of_the_graph(people in [person(), person()], options in options()) {
        let (graph, moves, conclusion) = run(&people, &options);
        let visited = graph.follow(&moves);
        prop_assert_eq!(visited.len(), moves.len() + 1, "{:?}", moves);
        prop_assert_eq!(graph.graph()[*visited.last().unwrap()], conclusion);
    }

    #[test]
    fn every_way_ends_within_as_many_rounds_as_there_are_offers_and_two(
        current in 0_usize..6, interrupting in 0_usize..6, options in options(),
    ) {
        let graph = ProtocolGraph::of(current, interrupting, &options);
        let ways = graph.ways();
        prop_assert!(!ways.is_empty());
        for (moves, _) in ways {
            prop_assert!(moves.len() <= current + interrupting + 2);
        }
    }
}

#[test]
fn every_way_of_disjoint_conditions_is_gone_by_somebody() {
    let tie = |tie| Options { tie, ..Options::default() };
    let literal = Options { quit: QuitRule::Literal, ..Options::default() };
    for options in [tie(TieRule::FirstSender), tie(TieRule::Fallback), tie(TieRule::Surplus), literal] {
        let mut gone = BTreeSet::new();
        let mut ways = BTreeSet::new();
        let ranks: Vec<Vec<u8>> =
            (0..81_u8).map(|code| (0..4).map(|d| code / 3_u8.pow(d) % 3).chain([0, 0]).collect()).collect();
        for mine in &ranks {
            for theirs in &ranks {
                let people = [(vec![0, 1], mine.clone()), (vec![2, 3], theirs.clone())];
                let (graph, moves, _) = run(&people, &options);
                ways = graph.ways().into_iter().map(|(moves, _)| moves).collect();
                gone.insert(moves);
            }
        }
        assert_eq!(gone, ways, "{options}");
    }
}
