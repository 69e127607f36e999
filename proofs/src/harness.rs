//! Kani's proof harnesses, and the same bodies for anyone else to run.
//!
//! A body draws what it does not fix from a [`Source`]: under Kani every value at once,
//! on stable random ones. So a body that would not compile, would fail, or could not reach
//! an outcome that it claims to reach, is caught without Kani. Bolero does this too; it is
//! not used because its Kani backend would still need the covers, which are what guards
//! against a contradictory assumption, to be counted on stable, and that needs a source of
//! one's own.
//!
//! **None of these harnesses has been run under Kani where they were written.** Their
//! bounds follow what is known to work elsewhere: lists of fixed length chosen by a match
//! instead of slices of symbolic length, ranks below [`RANKS`], `unwind` one more than the
//! longest loop.
//!
//! Two layouts bound the users. *Apart*: up to three conditions a side, no disposition in
//! common. Users who share dispositions with one condition each are among its users: what
//! a run depends on is how much each offer is worth in the other's eyes and the own total,
//! and sharing only makes some of these equal. *Shared*: conditions in common, and several
//! that activate one disposition, which tells the aggregations apart. Two-run properties
//! use one and two conditions a side of the first.

mod body;
pub mod witness;

use selfneg_core::{
    Activation, Aggregation, Condition, Disposition, Fallback, Options, QuitRule, Rank, TieRule,
};

use crate::case::{OpenCase, OpenUser};

/// Ranks are drawn below this.
pub const RANKS: u8 = 6;

/// Where a body gets what it does not fix.
pub trait Source {
    /// A number below `bound`.
    fn below(&mut self, bound: u8) -> u8;

    /// An outcome of the body that it claims to reach was reached. (Under Kani,
    /// `kani::cover!` says so instead.)
    fn covered(&mut self, what: &'static str);
}

/// Every value at once.
#[cfg(kani)]
pub struct Symbolic;

#[cfg(kani)]
impl Source for Symbolic {
    fn below(&mut self, bound: u8) -> u8 {
        let value: u8 = kani::any();
        kani::assume(value < bound);
        value
    }

    fn covered(&mut self, _: &'static str) {}
}

/// A harness: what Kani proves, and what stable runs.
#[cfg(not(kani))]
#[derive(Clone, Copy)]
pub struct Harness {
    /// Its name; Kani's ends in it.
    pub name: &'static str,
    /// How many covers it has. Each must be reached.
    pub covers: usize,
    /// Its body.
    pub run: fn(&mut dyn Source),
}

macro_rules! harnesses {
    ($( $name:ident, unwind $unwind:tt, covers $covers:literal; )+) => {
        /// Every harness.
        #[cfg(not(kani))]
        pub const ALL: &[Harness] = &[
            $( Harness { name: stringify!($name), covers: $covers, run: |source| body::$name(source) }, )+
        ];

        #[cfg(kani)]
        mod proofs {
            $(
                #[kani::proof]
                #[kani::unwind($unwind)]
                #[kani::solver(cadical)]
                fn $name() {
                    super::body::$name(&mut super::Symbolic);
                }
            )+
        }
    };
}

harnesses! {
    termination, unwind 12, covers 4;
    exact_termination, unwind 12, covers 3;
    closed_form, unwind 12, covers 9;
    closed_form_shared, unwind 12, covers 5;
    determinism, unwind 12, covers 3;
    role_symmetry, unwind 12, covers 2;
    role_symmetry_exception, unwind 12, covers 3;
    unanimity, unwind 12, covers 4;
    one_sided_optimality, unwind 12, covers 2;
    decision_locality, unwind 12, covers 2;
    transcript_locality, unwind 12, covers 2;
    bounded_disclosure, unwind 12, covers 3;
    gaining_last, unwind 12, covers 2;
    hiding_needs_mutual_deference, unwind 12, covers 2;
    sorted_hide_proofness, unwind 12, covers 2;
    order_needs_mutual_deference, unwind 12, covers 2;
    no_overflow, unwind 12, covers 2;
    no_panic, unwind 12, covers 2;
    condorcet_consistency, unwind 12, covers 3;
    agreement_has_cause, unwind 12, covers 3;
    exact_termination_fails, unwind 24, covers 2;
    role_symmetry_fails, unwind 24, covers 3;
    role_symmetry_exception_fails, unwind 24, covers 3;
    unanimity_fails, unwind 24, covers 2;
    one_sided_optimality_fails, unwind 24, covers 1;
    hide_proofness_fails, unwind 24, covers 2;
    hiding_needs_mutual_deference_fails, unwind 24, covers 1;
    sorted_hide_proofness_fails, unwind 24, covers 1;
    order_independence_fails, unwind 24, covers 2;
    order_needs_mutual_deference_fails, unwind 24, covers 1;
    misreport_proofness_fails, unwind 24, covers 2;
    unbeaten_service_fails, unwind 12, covers 2;
}

/// Which users a body draws from: up to four lists of conditions a side, each of fixed
/// length.
struct Layout {
    rows: &'static [&'static [Disposition]],
    current: &'static [&'static [Condition]],
    interrupting: &'static [&'static [Condition]],
}

/// As many ranks as the layouts have dispositions.
const DISPOSITIONS: usize = 6;

const GOAL: &[u8] = &[1; DISPOSITIONS];

const D0: Disposition = Disposition(0);
const D1: Disposition = Disposition(1);
const D2: Disposition = Disposition(2);
const D3: Disposition = Disposition(3);
const D4: Disposition = Disposition(4);
const D5: Disposition = Disposition(5);
const C0: Condition = Condition(0);
const C1: Condition = Condition(1);
const C2: Condition = Condition(2);
const C3: Condition = Condition(3);
const C4: Condition = Condition(4);
const C5: Condition = Condition(5);

const APART: Layout = Layout {
    rows: &[&[D0], &[D1], &[D2], &[D3], &[D4], &[D5]],
    current: &[&[], &[C0], &[C0, C1], &[C0, C1, C2]],
    interrupting: &[&[], &[C3], &[C3, C4], &[C3, C4, C5]],
};

/// For two runs: the lists of [`APART`] that have something to alter, and are short.
const SHORT: Layout =
    Layout { rows: APART.rows, current: &[&[C0], &[C0, C1]], interrupting: &[&[C3], &[C3, C4]] };

const SHARED: Layout = Layout {
    rows: &[&[D0], &[D0], &[D1], &[D0, D1], &[D2]],
    current: &[&[C0], &[C0, C1], &[C3, C0], &[C4, C2]],
    interrupting: &[&[C4], &[C1, C2], &[C2, C3], &[C0, C4, C1]],
};

fn draw_options<S: Source + ?Sized>(source: &mut S) -> Options {
    Options {
        quit: match source.below(2) {
            0 => QuitRule::Exhausted,
            _ => QuitRule::Literal,
        },
        aggregation: match source.below(2) {
            0 => Aggregation::PerCondition,
            _ => Aggregation::PerDisposition,
        },
        tie: match source.below(3) {
            0 => TieRule::FirstSender,
            1 => TieRule::Fallback,
            _ => TieRule::Surplus,
        },
        fallback: match source.below(2) {
            0 => Fallback::FirstCome,
            _ => Fallback::Utilitarian,
        },
        willingness: source.below(3),
    }
}

fn draw_ranks<S: Source + ?Sized>(source: &mut S) -> [Rank; DISPOSITIONS] {
    let mut ranks = [Rank(0); DISPOSITIONS];
    let mut i = 0;
    while let Some(rank) = ranks.get_mut(i) {
        *rank = Rank(source.below(RANKS));
        i += 1;
    }
    ranks
}

/// Draws a number below `bound` (up to 4) and hands it on. The match makes it a constant
/// for whoever gets it, and so the length of a list chosen by it.
fn choose<S: Source + ?Sized, T>(source: &mut S, bound: u8, go_on: impl FnOnce(&mut S, u8) -> T) -> T {
    match source.below(bound) {
        0 => go_on(source, 0),
        1 => go_on(source, 1),
        2 => go_on(source, 2),
        _ => go_on(source, 3),
    }
}

/// Draws two users of `layout` and hands the case on, with the source for more.
fn draw_case<S: Source + ?Sized, T>(
    source: &mut S,
    layout: &Layout,
    go_on: impl FnOnce(&mut S, &OpenCase<'_>) -> T,
) -> Option<T> {
    let current_ranks = draw_ranks(source);
    let interrupting_ranks = draw_ranks(source);
    let activation = Activation::new(layout.rows).ok()?;
    let count = |lists: &[&[Condition]]| u8::try_from(lists.len()).unwrap_or(4);
    choose(source, count(layout.current), |source, current| {
        choose(source, count(layout.interrupting), |source, interrupting| {
            let current = layout.current.get(usize::from(current))?;
            let interrupting = layout.interrupting.get(usize::from(interrupting))?;
            let current = OpenUser::new(&current_ranks, current, GOAL).ok()?;
            let interrupting = OpenUser::new(&interrupting_ranks, interrupting, GOAL).ok()?;
            Some(go_on(source, &OpenCase { activation, current, interrupting }))
        })
    })
}
