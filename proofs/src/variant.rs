//! The variants of the protocol that the tables list.

use selfneg_core::{Aggregation, Fallback, Options, QuitRule, TieRule};

/// The willingness that the tables go up to.
pub const MOST_WILLINGNESS: u8 = 2;

/// Every variant: 2 quit rules x 2 aggregations x 3 tie rules x 2 fallbacks x willingness
/// 0..=2, 72 in all, the default first.
pub fn variants() -> impl Iterator<Item = Options> {
    QuitRule::ALL.iter().flat_map(|&quit| {
        Aggregation::ALL.iter().flat_map(move |&aggregation| {
            TieRule::ALL.iter().flat_map(move |&tie| {
                Fallback::ALL.iter().flat_map(move |&fallback| {
                    (0..=MOST_WILLINGNESS).map(move |willingness| Options {
                        quit,
                        aggregation,
                        tie,
                        fallback,
                        willingness,
                    })
                })
            })
        })
    })
}
