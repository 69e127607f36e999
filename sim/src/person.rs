//! People: discs that walk along the way they are given and do not step in front of the robot.

use crate::geometry::{Point, Segment};

/// A spot that a person walks to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Waypoint {
    /// Where, in metres.
    pub position: Point,
    /// How long the person stays there, in seconds, 0 to 86400.
    #[cfg_attr(feature = "serde", serde(default))]
    pub wait: f64,
}

/// A person as put into the world.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Person {
    /// Name, unique in the world.
    pub name: String,
    /// Index of the floor.
    pub floor: usize,
    /// Where, in metres.
    pub position: Point,
    /// Which way, in radians.
    #[cfg_attr(feature = "serde", serde(default))]
    pub heading: f64,
    /// Radius of the disc, in metres, 0.05 to 2.
    #[cfg_attr(feature = "serde", serde(default = "Person::default_radius"))]
    pub radius: f64,
    /// Walking speed, in m/s, over 0 and at most 3.
    #[cfg_attr(feature = "serde", serde(default = "Person::default_speed"))]
    pub speed: f64,
    /// Where the person walks, one after the other, straight.
    #[cfg_attr(feature = "serde", serde(default))]
    pub waypoints: Vec<Waypoint>,
    /// Whether the person begins again with the first waypoint after the last.
    #[cfg_attr(feature = "serde", serde(default))]
    pub repeat: bool,
}

impl Person {
    /// A person who stands still: radius 0.25 m, and 1.2 m/s once sent somewhere.
    #[must_use]
    pub fn standing(name: &str, floor: usize, position: Point) -> Self {
        Self {
            name: name.to_owned(),
            floor,
            position,
            heading: 0.0,
            radius: Self::default_radius(),
            speed: Self::default_speed(),
            waypoints: Vec::new(),
            repeat: false,
        }
    }

    /// The person, walking along `waypoints` without a stay.
    #[must_use]
    pub fn walking(mut self, waypoints: &[Point]) -> Self {
        self.waypoints = waypoints.iter().map(|&position| Waypoint { position, wait: 0.0 }).collect();
        self
    }

    fn default_radius() -> f64 {
        0.25
    }

    fn default_speed() -> f64 {
        1.2
    }

    /// What is wrong with the person's own figures, if anything.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        if !(0.05..=2.0).contains(&self.radius) {
            return Some("radius; expected 0.05 to 2 m");
        }
        if !(self.speed > 0.0 && self.speed <= 3.0) {
            return Some("speed; expected over 0, at most 3 m/s");
        }
        if !self.heading.is_finite() {
            return Some("heading; expected a finite number");
        }
        if self.waypoints.iter().any(|w| !(0.0..=86_400.0).contains(&w.wait)) {
            return Some("wait; expected 0 to 86400 s");
        }
        None
    }
}

/// A person on the way.
#[derive(Clone, Debug)]
pub(crate) struct Walker {
    pub(crate) person: Person,
    /// Index of the waypoint that the person walks to or stays at.
    next: usize,
    /// Seconds still to stay, once there.
    stay: Option<f64>,
}

impl Walker {
    pub(crate) fn new(person: Person) -> Self {
        Self { person, next: 0, stay: None }
    }

    /// Moves one step, unless that would come within `guard`. Gives true in the step in which the
    /// last waypoint has been dealt with.
    pub(crate) fn step(&mut self, step: f64, guard: Option<&Guard>) -> bool {
        let Some(&goal) = self.person.waypoints.get(self.next) else { return false };
        if let Some(stay) = &mut self.stay {
            *stay -= step;
            if *stay > 0.0 {
                return false;
            }
            self.stay = None;
            self.next += 1;
            if self.next < self.person.waypoints.len() {
                return false;
            }
            if self.person.repeat {
                self.next = 0;
                return false;
            }
            return true;
        }
        let here = self.person.position;
        let far = here.distance(goal.position);
        let stride = self.person.speed * step;
        let to = if far <= stride { goal.position } else { here.towards(goal.position, stride / far) };
        if far > 0.0 {
            self.person.heading = here.direction_to(goal.position);
        }
        if guard.is_some_and(|g| g.forbids(here, to, self.person.radius)) {
            return false;
        }
        self.person.position = to;
        if far <= stride {
            self.stay = Some(goal.wait);
        }
        false
    }
}

/// Where the robot is and will be while it brakes: people keep out of it.
#[derive(Clone, Debug)]
pub(crate) struct Guard {
    pub(crate) swept: Vec<Segment>,
    pub(crate) radius: f64,
}

impl Guard {
    /// Whether a step comes too near, and nearer than before.
    fn forbids(&self, from: Point, to: Point, radius: f64) -> bool {
        let off = |p| self.swept.iter().map(|s| s.distance_squared(p)).fold(f64::INFINITY, f64::min).sqrt();
        let (before, after) = (off(from), off(to));
        after < self.radius + radius && after <= before
    }
}
