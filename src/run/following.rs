//! A guided user walks where the robot has driven, some way behind it.

use std::collections::VecDeque;

use selfneg_sim::{Point, Waypoint, World};

/// How far behind, along the robot's way, in metres.
const BEHIND: f64 = 1.1;

/// How far apart the points of the way are, in metres.
const STRIDE: f64 = 0.2;

/// A user on the way behind the robot.
#[derive(Clone, Debug)]
pub(super) struct Following {
    person: String,
    floor: usize,
    /// Where the robot has been and the person has not, the oldest first.
    way: VecDeque<Point>,
    /// Where the person has been since the robot set out, the oldest first.
    walked: Vec<Point>,
}

impl Following {
    pub(super) fn new(person: &str, world: &World) -> Self {
        let robot = world.robot();
        Self {
            person: person.to_owned(),
            floor: robot.floor,
            way: VecDeque::from([robot.pose.position]),
            walked: Vec::new(),
        }
    }

    /// Sends the person on. False once the person can follow no longer: on another floor, or
    /// with a wall in between.
    pub(super) fn go_on(&mut self, world: &mut World) -> bool {
        let robot = *world.robot();
        let Some(person) = world.person(&self.person) else { return false };
        if person.floor != self.floor || robot.floor != self.floor {
            self.stay(world);
            return false;
        }
        let here = person.position;
        if self.way.back().is_none_or(|last| last.distance(robot.pose.position) >= STRIDE) {
            self.way.push_back(robot.pose.position);
        }
        while self.way.len() > 1 && self.way.front().is_some_and(|next| next.distance(here) < 1.5 * STRIDE) {
            self.walked.extend(self.way.pop_front());
        }
        let mut behind = 0.0;
        let mut last = robot.pose.position;
        let mut waypoints = Vec::new();
        for &point in self.way.iter().rev() {
            behind += last.distance(point);
            last = point;
            if behind >= BEHIND {
                waypoints.push(Waypoint { position: point, wait: 0.0 });
            }
        }
        waypoints.reverse();
        world.send_person(&self.person, waypoints).is_ok()
    }

    /// The robot turns to somebody else: the person walks back to where they met, but not onto
    /// the spot where the robot stood.
    pub(super) fn go_back(&self, world: &mut World) {
        let Some(met) = self.walked.first() else { return self.stay(world) };
        let far = self.walked.iter().rev().filter(|point| point.distance(*met) >= BEHIND);
        let waypoints = far.map(|&position| Waypoint { position, wait: 0.0 }).collect();
        if world.send_person(&self.person, waypoints).is_err() {
            self.stay(world);
        }
    }

    /// The person stays where the person is.
    pub(super) fn stay(&self, world: &mut World) {
        // Nobody walks nowhere through a wall, and a person who is gone need not stop.
        let _ = world.send_person(&self.person, Vec::new());
    }
}
