//! A kinematic TIAGo in a mapped building: it drives to named places, waits for people, rides
//! elevators, and never touches an obstacle. A pure state machine: same world, same commands,
//! same bits.
//!
//! # A worked example
//!
//! The robot is at its charging station. Ann needs something from the pharmacy; on the way the
//! robot is told to stop for a moment.
//!
//! ```
//! use selfneg_sim::{Activity, Building, Command, Event, Person, Picture, Point, Settings, World};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut world = World::new(Building::mall()?, Settings::default(), "charging station")?;
//! world.add_person(
//!     Person::standing("Ann", 0, Point::new(12.0, 6.0)).walking(&[Point::new(19.0, 6.4)]),
//! )?;
//!
//! // What it would take, if nobody were in the way.
//! let foretold = world.estimate("pharmacy")?;
//! assert!(foretold.distance > 8.0 && foretold.seconds > 10.0);
//!
//! // One command; then step after step until the robot has no goal any more.
//! let mut story = world.step(Command::go_to("pharmacy"));
//! let mut trail = Vec::new();
//! while world.activity() != Activity::Idle {
//!     // Tell it to stop after four seconds, and to go on two seconds later.
//!     let command = match world.time().as_millis() {
//!         4_000 => Command::Stop,
//!         6_000 => Command::Resume,
//!         _ => Command::Continue,
//!     };
//!     story.extend(world.step(command));
//!     trail.push(world.robot().pose.position);
//!     if let Some(progress) = world.progress() {
//!         assert!(progress.fraction <= 1.0);
//!     }
//! }
//! assert!(matches!(&story[0], Event::SetOut { place, .. } if place == "pharmacy"));
//! assert!(story.contains(&Event::Paused { place: "pharmacy".into() }));
//! assert_eq!(story.last(), Some(&Event::Arrived { place: "pharmacy".into() }));
//!
//! // A picture of it, and the walls as points for a 3D viewer.
//! let svg = Picture::of(&world, 0).trail(&trail).to_svg();
//! assert!(svg.starts_with("<svg"));
//! assert!(world.building().floors()[0].map.wall_points().count() > 1000);
//! # Ok(())
//! # }
//! ```
//!
//! # What is where
//!
//! | item | job |
//! | --- | --- |
//! | [`OccupancyGrid`] | a map in the format of ROS `map_server`: YAML, and PGM ([`pgm`], P2 and P5) |
//! | [`Building`] | floors with maps and places, elevators; read from a YAML file, or [`Building::mall`] |
//! | [`tiago`] | the robot's dimensions and limits, with where each comes from |
//! | [`Person`] | a disc that walks along waypoints |
//! | [`World`] | all of it, and a clock: [`World::step`] obeys a [`Command`] and tells [`Event`]s |
//! | [`Picture`] | a floor from above, as SVG |
//!
//! The building file looks like this; a map is as `map_server` has it, trinary mode only, and a
//! rotated one is refused rather than turned back silently:
//!
//! ```yaml
//! name: Small house
//! floors:                            # from the lowest to the highest
//!   - name: ground
//!     map: ground.yaml               # relative to this file
//!     places:                        # metres; heading in radians, optional
//!       - {name: door, x: 1.0, y: 2.5, heading: 1.57}
//! elevators:                         # optional
//!   - name: lift
//!     ride_seconds: 12               # doors and ride, between any two stops
//!     stops:
//!       - {floor: ground, x: 4.0, y: 1.0}
//! ```
//!
//! # How it drives
//!
//! A\* over the cells where the robot fits, dearer near walls; then straight lines between the
//! points that see each other; then a follower that steers towards a point of the way ahead to
//! which it can go straight, slows down for corners, and turns on the spot where it must.
//! Within a step the robot moves on an exact circular arc.
//!
//! **Why it touches nothing.** Whatever the follower wishes, a step is permitted only if the
//! robot can brake to a stop after it without touching a cell that is not free, or a person.
//! Braking shrinks both speeds alike, so the braking path is the rest of the present arc, known
//! exactly beforehand, and it was found free a step ago. So braking is always permitted, and by
//! induction the robot never touches anything: maps do not change, and people do not step onto
//! the robot or its braking path. That is a model of polite people, not a claim about real ones.
//! The argument is on paper; the tests check its conclusion after every step of random worlds.
//!
//! **People.** Nobody plans around a moving person. The robot waits at [`Settings::personal_gap`];
//! after [`Settings::patience`] it looks for a way around whoever stands there, at
//! [`Settings::passing_gap`]; without getting on for [`Settings::give_up_after`], or after 30 detours, it
//! gives the goal up with [`Event::Blocked`]. People do not avoid walls or each other: waypoints that lead
//! through a wall are an error, and people may overlap people.
//!
//! # Determinism
//!
//! *By construction*, the same world and commands give the same bits: no clock, no threads, no
//! random numbers, no iteration over hash maps; sines and arc tangents come from the pure-Rust
//! `libm`, all other arithmetic is IEEE 754 double precision. It rests on equal versions of
//! `libm`, of `pathfinding` and of the standard library's heap (ties in A\* follow their order),
//! and on a target without excess precision (not on x87). *Tested*: equal runs give equal bits
//! here, and a recorded run gives the recorded bits; never run on another kind of machine.
//!
//! # Figures
//!
//! Measured on one core of a shared two-core x86-64 machine, in release mode (example `speed`): a
//! tour of all places of the mall, 486 s of simulated time in 20 ms steps, took 0.14 to 0.2 s, that
//! is 2400 to 3400 times real time depending on what else the machine did; with 8 people in the
//! way about the same. On that tour, with nobody in the way, the robot took 0.95 to 1.05 times what
//! [`World::estimate`] foretold (a test holds it to 0.85 to 1.15).
//!
//! # Left out
//!
//! Dynamics, sensors and localisation: the robot knows where it is. Its arm. Reversing. Maps that
//! change. People who ride elevators.

mod building;
mod drive;
mod error;
mod follow;
mod geometry;
mod joints;
mod mall;
mod map;
mod person;
pub mod pgm;
mod picture;
mod reach;
mod route;
mod settings;
mod story;
pub mod tiago;
mod world;
mod yaml;

pub use building::{Building, Elevator, Floor, Place, Stop};
pub use drive::Twist;
pub use error::{BuildingError, MapError, PgmError, RouteError, WorldError, YamlError};
pub use geometry::{Point, Pose, normalize_angle};
pub use joints::{JointState, JointTargets, Joints};
pub use map::{Cell, MAX_RESOLUTION, MIN_RESOLUTION, OccupancyGrid};
pub use person::{Person, Waypoint};
pub use picture::{Picture, svg};
pub use route::{Estimate, Leg};
pub use settings::Settings;
pub use story::{Activity, Command, Event, Progress, Robot};
pub use tiago::{JointLimits, RobotModel};
pub use world::World;
pub use yaml::MAX_BYTES as MAX_YAML_BYTES;
