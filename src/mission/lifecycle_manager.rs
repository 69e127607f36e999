//! The *lifecycle manager*: takes components through their states, and wipes what they held
//! on the way out.

use super::command::Output;
use super::event::{GoalId, UserId};
use super::fault::{Fault, Faults};
use super::lifecycle::{Lifecycle, Transition};
use super::record::{Component, Record};
use super::specification::MissionRules;
use super::user_managers::UserManagers;

/// Makes a transition and tells of it. An illegal one is not made.
pub(super) fn transit(
    lifecycle: &mut Lifecycle,
    transition: Transition,
    component: Component,
    user: Option<UserId>,
    out: &mut Vec<Output>,
) {
    let from = *lifecycle;
    match from.after(transition) {
        Ok(to) => {
            *lifecycle = to;
            out.push(Output::Record(Record::Lifecycle { component, user, from, to }));
        }
        Err(refused) => out.push(Output::Record(Record::IllegalTransition { component, refused })),
    }
}

/// Takes a component of the whole mission into work, or out of it again.
pub(super) fn bring_up(lifecycle: &mut Lifecycle, component: Component, out: &mut Vec<Output>) {
    transit(lifecycle, Transition::Configure, component, None, out);
    transit(lifecycle, Transition::Activate, component, None, out);
}

/// Every user's components.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct LifecycleManager {
    users: Box<[UserManagers]>,
}

impl LifecycleManager {
    pub(super) fn new(rules: &MissionRules) -> Self {
        Self { users: (0..rules.limits().users).map(|_| UserManagers::new(rules)).collect() }
    }

    pub(super) fn of(&self, user: UserId) -> Option<&UserManagers> {
        self.users.iter().find(|managers| managers.user == Some(user))
    }

    pub(super) fn of_mut(&mut self, user: UserId) -> Option<&mut UserManagers> {
        self.users.iter_mut().find(|managers| managers.user == Some(user))
    }

    pub(super) fn all(&self) -> &[UserManagers] {
        &self.users
    }

    pub(super) fn has_room(&self) -> bool {
        self.users.iter().any(|managers| managers.user.is_none())
    }

    /// Assigns unconfigured components to a user; false if there are none.
    pub(super) fn assign(&mut self, user: UserId, out: &mut Vec<Output>) -> bool {
        let Some(managers) = self.users.iter_mut().find(|managers| managers.user.is_none()) else {
            return false;
        };
        managers.user = Some(user);
        for (lifecycle, component) in managers.lifecycles() {
            transit(lifecycle, Transition::Configure, component, Some(user), out);
        }
        true
    }

    /// The user's data are there.
    pub(super) fn activate_context(&mut self, user: UserId, out: &mut Vec<Output>) {
        if let Some(managers) = self.of_mut(user) {
            let component = Component::ContextEthicsManager;
            transit(&mut managers.context.lifecycle, Transition::Activate, component, Some(user), out);
        }
    }

    /// Takes the snapshot that the user's side negotiates with, unless there is one.
    pub(super) fn snapshot(
        &mut self,
        user: UserId,
        goal: GoalId,
        rules: &MissionRules,
        out: &mut Vec<Output>,
    ) {
        let Some(managers) = self.of_mut(user) else { return };
        if managers.offers.lifecycle == Lifecycle::Active {
            return;
        }
        managers.offers.snapshot(&managers.context, goal, rules);
        managers.impact.snapshot(&managers.context, rules);
        for (lifecycle, component) in managers.negotiating_lifecycles() {
            transit(lifecycle, Transition::Activate, component, Some(user), out);
        }
    }

    /// Wipes the snapshot of a user who stays.
    pub(super) fn drop_snapshot(&mut self, user: UserId, out: &mut Vec<Output>) {
        let Some(managers) = self.of_mut(user) else { return };
        if managers.offers.lifecycle != Lifecycle::Active {
            return;
        }
        for (lifecycle, component) in managers.negotiating_lifecycles() {
            transit(lifecycle, Transition::Deactivate, component, Some(user), out);
        }
        managers.wipe_snapshot(user, out);
    }

    /// Wipes everything of a user and takes the user's components back.
    pub(super) fn release(&mut self, user: UserId, faults: Faults, out: &mut Vec<Output>) {
        let Some(managers) = self.of_mut(user) else { return };
        if !faults.has(Fault::KeepLosersData) {
            managers.wipe_snapshot(user, out);
            managers.context.wipe();
            let (component, left) = (Component::ContextEthicsManager, managers.context.residue());
            out.push(Output::Record(Record::Wiped { user, component, left }));
        }
        for (lifecycle, component) in managers.lifecycles() {
            if *lifecycle == Lifecycle::Active {
                transit(lifecycle, Transition::Deactivate, component, Some(user), out);
            }
            if !faults.has(Fault::SkipCleanup) {
                transit(lifecycle, Transition::Cleanup, component, Some(user), out);
            }
        }
        managers.user = None;
    }

    /// Finalizes all users' components, which nobody has any more.
    pub(super) fn finalize(&mut self, out: &mut Vec<Output>) {
        for managers in &mut self.users {
            for (lifecycle, component) in managers.lifecycles() {
                transit(lifecycle, Transition::Shutdown, component, None, out);
            }
        }
    }
}

impl UserManagers {
    fn lifecycles(&mut self) -> [(&mut Lifecycle, Component); 3] {
        [
            (&mut self.context.lifecycle, Component::ContextEthicsManager),
            (&mut self.offers.lifecycle, Component::OfferGenerator),
            (&mut self.impact.lifecycle, Component::EthicalImpactAnalyzer),
        ]
    }

    fn negotiating_lifecycles(&mut self) -> [(&mut Lifecycle, Component); 2] {
        let [_, offers, impact] = self.lifecycles();
        [offers, impact]
    }

    fn wipe_snapshot(&mut self, user: UserId, out: &mut Vec<Output>) {
        self.offers.wipe();
        self.impact.wipe();
        let (offers, impact) = (self.offers.residue(), self.impact.residue());
        out.push(Output::Record(Record::Wiped { user, component: Component::OfferGenerator, left: offers }));
        let component = Component::EthicalImpactAnalyzer;
        out.push(Output::Record(Record::Wiped { user, component, left: impact }));
    }
}
