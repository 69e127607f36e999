//! What the statements are about: a thing that negotiates. They take it as a parameter so
//! that one can show that they notice a broken one.

use selfneg_core::{Conclusion, Fallback, Observer, Options, Side};

use crate::case::OpenCase;
use crate::measure;

/// An implementation of the protocol.
pub trait Engine {
    /// Negotiates to the end, telling `observer` each round.
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion;

    /// Whom the robot serves: the winner, or whom the fallback chooses.
    fn serve(&self, case: &OpenCase<'_>, options: &Options) -> Side {
        match (self.negotiate(case, options, &mut ()).outcome.winner(), options.fallback) {
            (Some(winner), _) => winner,
            (None, Fallback::FirstCome) => Side::Current,
            (None, Fallback::Utilitarian) => {
                let current = measure::welfare(case, options.aggregation, Side::Current);
                let interrupting = measure::welfare(case, options.aggregation, Side::Interrupting);
                if interrupting > current { Side::Interrupting } else { Side::Current }
            }
        }
    }
}

/// The engine that robots run: `selfneg_core`.
#[derive(Clone, Copy, Debug)]
pub struct Core;

impl Engine for Core {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        case.closed().negotiation(options).run(observer)
    }

    fn serve(&self, case: &OpenCase<'_>, options: &Options) -> Side {
        case.closed().decide(options, &mut ()).served
    }
}
