//! A set of variants in few words.

use std::collections::BTreeSet;

use selfneg_core::{Aggregation, Fallback, Options, QuitRule, TieRule};

/// Some values of each option: the variants that have one of each.
#[derive(Clone)]
struct Block {
    quit: Vec<QuitRule>,
    aggregation: Vec<Aggregation>,
    tie: Vec<TieRule>,
    fallback: Vec<Fallback>,
    willingness: Vec<u8>,
}

/// Describes the variants of `some`, all of which are in `all`, by blocks joined by "; ".
pub(super) fn describe(some: &BTreeSet<Options>, all: &BTreeSet<Options>) -> String {
    let whole = Block::spanning(all);
    let mut left = some.clone();
    let mut blocks = Vec::new();
    while let Some(&first) = left.first() {
        let block = Block::around(first, some, &whole);
        left.retain(|options| !block.holds(options));
        blocks.push(block.describe(&whole));
    }
    blocks.join("; ")
}

impl Block {
    fn of(options: Options) -> Self {
        Self {
            quit: vec![options.quit],
            aggregation: vec![options.aggregation],
            tie: vec![options.tie],
            fallback: vec![options.fallback],
            willingness: vec![options.willingness],
        }
    }

    fn spanning(all: &BTreeSet<Options>) -> Self {
        fn values<T: Ord>(all: &BTreeSet<Options>, of: impl Fn(&Options) -> T) -> Vec<T> {
            all.iter().map(of).collect::<BTreeSet<T>>().into_iter().collect()
        }
        Self {
            quit: values(all, |options| options.quit),
            aggregation: values(all, |options| options.aggregation),
            tie: values(all, |options| options.tie),
            fallback: values(all, |options| options.fallback),
            willingness: values(all, |options| options.willingness),
        }
    }

    /// The block around one variant, widened value by value while it stays in `some`.
    fn around(first: Options, some: &BTreeSet<Options>, whole: &Self) -> Self {
        let mut block = Self::of(first);
        let candidates = whole
            .members()
            .into_iter()
            .flat_map(|options| {
                [
                    Self { quit: vec![options.quit], ..Self::of(first) },
                    Self { aggregation: vec![options.aggregation], ..Self::of(first) },
                    Self { tie: vec![options.tie], ..Self::of(first) },
                    Self { fallback: vec![options.fallback], ..Self::of(first) },
                    Self { willingness: vec![options.willingness], ..Self::of(first) },
                ]
            })
            .collect::<Vec<_>>();
        for candidate in candidates {
            let wider = block.joined(&candidate);
            if wider.members().iter().all(|options| some.contains(options)) {
                block = wider;
            }
        }
        block
    }

    fn joined(&self, other: &Self) -> Self {
        fn union<T: Ord + Copy>(a: &[T], b: &[T]) -> Vec<T> {
            a.iter().chain(b).copied().collect::<BTreeSet<T>>().into_iter().collect()
        }
        Self {
            quit: union(&self.quit, &other.quit),
            aggregation: union(&self.aggregation, &other.aggregation),
            tie: union(&self.tie, &other.tie),
            fallback: union(&self.fallback, &other.fallback),
            willingness: union(&self.willingness, &other.willingness),
        }
    }

    fn holds(&self, options: &Options) -> bool {
        self.quit.contains(&options.quit)
            && self.aggregation.contains(&options.aggregation)
            && self.tie.contains(&options.tie)
            && self.fallback.contains(&options.fallback)
            && self.willingness.contains(&options.willingness)
    }

    fn members(&self) -> Vec<Options> {
        let mut members = Vec::new();
        for &quit in &self.quit {
            for &aggregation in &self.aggregation {
                for &tie in &self.tie {
                    for &fallback in &self.fallback {
                        for &willingness in &self.willingness {
                            members.push(Options { quit, aggregation, tie, fallback, willingness });
                        }
                    }
                }
            }
        }
        members
    }

    /// The options that the block restricts; "all" if none.
    fn describe(&self, whole: &Self) -> String {
        let mut words = Vec::new();
        let mut say = |restricted: bool, text: String| {
            if restricted {
                words.push(text);
            }
        };
        let or = |names: Vec<String>| names.join(" or ");
        let names = |values: Vec<&'static str>| or(values.into_iter().map(str::to_owned).collect());
        say(self.quit.len() < whole.quit.len(), names(self.quit.iter().map(|value| value.name()).collect()));
        say(
            self.aggregation.len() < whole.aggregation.len(),
            names(self.aggregation.iter().map(|value| value.name()).collect()),
        );
        say(
            self.tie.len() < whole.tie.len(),
            format!("tie {}", names(self.tie.iter().map(|value| value.name()).collect())),
        );
        say(
            self.fallback.len() < whole.fallback.len(),
            names(self.fallback.iter().map(|value| value.name()).collect()),
        );
        say(
            self.willingness.len() < whole.willingness.len(),
            or(self.willingness.iter().map(|willingness| format!("w{willingness}")).collect()),
        );
        if words.is_empty() { "all variants".to_owned() } else { words.join(", ") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use selfneg_proofs::variant::variants;

    fn described(keep: impl Fn(&Options) -> bool) -> String {
        let all: BTreeSet<Options> = variants().collect();
        describe(&all.iter().copied().filter(keep).collect(), &all)
    }

    #[test]
    fn blocks_say_what_they_restrict() {
        assert_eq!(described(|_| true), "all variants");
        assert_eq!(described(|options| options.willingness < 2), "w0 or w1");
        assert_eq!(
            described(|options| options.quit == QuitRule::Exhausted
                && options.tie != TieRule::FirstSender
                && options.willingness == 0),
            "exhausted, tie fallback or surplus, w0"
        );
        assert_eq!(
            described(|options| options.fallback == Fallback::Utilitarian
                || (options.quit == QuitRule::Exhausted && options.willingness == 0)),
            "exhausted, w0; utilitarian"
        );
    }

    /// Whatever the set, the blocks hold exactly its members.
    #[test]
    fn blocks_hold_exactly_the_set() {
        let all: BTreeSet<Options> = variants().collect();
        let whole = Block::spanning(&all);
        for salt in 0..50usize {
            let some: BTreeSet<Options> = all
                .iter()
                .enumerate()
                .filter(|(nth, _)| (nth * 31 + salt * 17) % 7 < 3)
                .map(|(_, o)| *o)
                .collect();
            for &first in &some {
                let block = Block::around(first, &some, &whole);
                assert!(block.holds(&first));
                assert!(block.members().iter().all(|options| some.contains(options)));
            }
        }
    }
}
