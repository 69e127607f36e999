//! Lifecycle states as in ROS 2 managed nodes.

use serde::Serialize;
use zeroize::Zeroize;

/// The state of a component.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lifecycle {
    /// It holds nothing.
    #[default]
    Unconfigured,
    /// It is assigned and does not work yet.
    Inactive,
    /// It works.
    Active,
    /// It will not work again.
    Finalized,
}

/// A change of state that a component can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transition {
    /// Unconfigured to inactive.
    Configure,
    /// Inactive to active.
    Activate,
    /// Active to inactive.
    Deactivate,
    /// Inactive to unconfigured.
    Cleanup,
    /// Anything but finalized to finalized.
    Shutdown,
}

/// A transition that the state does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, thiserror::Error)]
#[error("no transition {transition:?} from the lifecycle state {from:?}")]
pub struct IllegalTransition {
    /// The state, which stays.
    pub from: Lifecycle,
    /// What was asked for.
    pub transition: Transition,
}

impl Lifecycle {
    /// The state after `transition`.
    ///
    /// # Errors
    /// [`IllegalTransition`] if this state does not have it.
    pub const fn after(self, transition: Transition) -> Result<Self, IllegalTransition> {
        match (self, transition) {
            (Self::Unconfigured, Transition::Configure) | (Self::Active, Transition::Deactivate) => {
                Ok(Self::Inactive)
            }
            (Self::Inactive, Transition::Activate) => Ok(Self::Active),
            (Self::Inactive, Transition::Cleanup) => Ok(Self::Unconfigured),
            (Self::Unconfigured | Self::Inactive | Self::Active, Transition::Shutdown) => Ok(Self::Finalized),
            (from, transition) => Err(IllegalTransition { from, transition }),
        }
    }
}

/// The state is nobody's data: wiping leaves it.
impl Zeroize for Lifecycle {
    fn zeroize(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::{Lifecycle, Transition};

    #[test]
    fn exactly_the_transitions_of_ros_2() {
        use Lifecycle::{Active, Finalized, Inactive, Unconfigured};
        use Transition::{Activate, Cleanup, Configure, Deactivate, Shutdown};
        let legal = [
            (Unconfigured, Configure, Inactive),
            (Inactive, Activate, Active),
            (Active, Deactivate, Inactive),
            (Inactive, Cleanup, Unconfigured),
            (Unconfigured, Shutdown, Finalized),
            (Inactive, Shutdown, Finalized),
            (Active, Shutdown, Finalized),
        ];
        for from in [Unconfigured, Inactive, Active, Finalized] {
            for transition in [Configure, Activate, Deactivate, Cleanup, Shutdown] {
                let expected =
                    legal.iter().find(|(f, t, _)| (*f, *t) == (from, transition)).map(|(_, _, to)| *to);
                assert_eq!(from.after(transition).ok(), expected, "{from:?} {transition:?}");
            }
        }
    }
}
