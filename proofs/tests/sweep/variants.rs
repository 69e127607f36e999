//! Every variant of the protocol.

use selfneg_core::{Aggregation, Fallback, Options, QuitRule, TieRule};

pub(crate) fn variants(willingness: &[u8]) -> Vec<Options> {
    let mut variants = Vec::new();
    for &quit in QuitRule::ALL {
        for &aggregation in Aggregation::ALL {
            for &tie in TieRule::ALL {
                for &fallback in Fallback::ALL {
                    for &willingness in willingness {
                        variants.push(Options { quit, aggregation, tie, fallback, willingness });
                    }
                }
            }
        }
    }
    variants
}
