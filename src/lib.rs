//! Selfneg: a service robot's ethical decisions between interrupting users, decided exactly
//! as published and made to be proved, measured and audited.
//!
//! The engine is [`selfneg_core`]; this crate is the toolkit around it, and the program
//! `selfneg`. To decide one case from folders of the published form:
//!
//! ```
//! use std::path::Path;
//!
//! use selfneg::binding::{BoundRules, GoalChoice};
//! use selfneg::input::{Rules, User};
//! use selfneg::precedence::{Policy, decide};
//! use selfneg::story;
//! use selfneg_core::Options;
//!
//! let mall = Path::new("examples/mall");
//! let mut rules = BoundRules::new(Rules::read(mall)?)?;
//! let alice = rules.bind(&User::read(&mall.join("Alice"))?, &GoalChoice::OwnFile)?;
//! let bob = rules.bind(&User::read(&mall.join("Bob"))?, &GoalChoice::OwnFile)?;
//!
//! // The first user is being served, the others interrupt.
//! let users = [alice, bob];
//! let decision = decide(&rules, &users, Options::default(), Policy::Published)?;
//!
//! assert_eq!(users[decision.served].name, "Alice");
//! assert_eq!(decision.rounds(), 2);
//! println!("{}", story::tell(&decision, &users, &rules));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | job |
//! | --- | --- |
//! | [`input`] | read the published folders, refuse what is not as expected |
//! | [`binding`] | names to the engine's indices, and back |
//! | [`precedence`] | one decision among a current user and any number of interrupters |
//! | [`mod@optimum`] | what would have been best for all, and how much a decision lost |
//! | [`mod@regret`] | how much a protocol variant loses at most, over a whole domain |
//! | [`mod@policies`] | how often the policies for many users serve somebody whom another beats |
//! | [`counterfactual`], [`disclosure`] | what would have changed a decision; how much was disclosed for it |
//! | [`transcript`], [`story`], [`record`] | what was observed, told to people, as JSON |
//! | [`lint`] | what is legal but surely not meant |
//! | [`mod@replicate`] | rerun the published package against its own logs |
//! | [`mod@verify`] | every property under every variant, against the expected verdicts |
//! | [`scenario`] | who asks for what, when and where: the file format |
//! | [`run`] | the mission drives the simulated robot |
//! | [`trace`] | a run as evidence: written, read back, replayed |
//! | [`report`] | a trace as a page for people |
//! | [`mod@case`] | a trace's decisions, each with what it takes to make it again |
//! | [`mod@explain`] | why was Bob made to wait? For anybody, one user, the auditor |
//! | [`seal`] | signatures, encryption and commitments of traces |
//! | [`audit`] | whether a trace is whole and unchanged, and the robot kept its rules |
//! | [`fleet`] | thousands of audited traces as tables |
//! | [`demo`] | the paper's mall |
//! | [`mission`] | the robot architecture as a state machine, around the decision |
//! | [`printable`] | names of files as one line on a terminal |
//! | [`command`] | the command line |
#![forbid(unsafe_code)]

pub mod audit;
pub mod binding;
pub mod case;
pub mod command;
pub mod counterfactual;
pub mod demo;
pub mod disclosure;
pub mod explain;
pub mod fleet;
pub mod input;
pub mod lint;
pub mod mission;
pub mod optimum;
pub mod policies;
pub mod precedence;
pub mod printable;
pub mod record;
pub mod regret;
pub mod replicate;
pub mod report;
pub mod run;
pub mod scenario;
pub mod seal;
pub mod story;
pub mod trace;
pub mod transcript;
pub mod verify;
