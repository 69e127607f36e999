//! The world: a building, the robot, and people, as a state machine with a fixed step.

use core::time::Duration;

use crate::building::Building;
use crate::drive::{Twist, braked, chords, limited, reach_seconds, stopping_speed};
use crate::error::{RouteError, WorldError};
use crate::follow::{Follower, TOO_FAR_ASIDE, Wish};
use crate::geometry::{Point, Pose, Segment, normalize_angle};
use crate::joints::{JointTargets, Joints};
use crate::map::OccupancyGrid;
use crate::person::{Guard, Person, Walker, Waypoint};
use crate::reach::{Disc, Reach};
use crate::route::{Estimate, Leg, drive_estimate, route, turn_seconds};
use crate::settings::Settings;
use crate::story::{Activity, Command, Event, Progress, Robot};

/// Clearance beyond its radius that the robot keeps from walls where it can, in metres.
const WALL_CLEARANCE: f64 = 0.01;

/// What the robot keeps of that at least, in metres, against rounding.
const LEAST_CLEARANCE: f64 = 1e-6;

/// Gap between the robot and a person that the robot never closes, in metres.
const BODY_GAP: f64 = 0.01;

/// Gap to the robot, braking included, into which no person steps, in metres.
const STEP_GAP: f64 = 0.02;

/// Ways around people that are tried for one goal. Progress is measured along the present way, so
/// without this bound people could send the robot to and fro for ever.
const MAX_REROUTES: u32 = 30;

#[derive(Clone, Debug)]
struct Mission {
    place: String,
    heading: Option<f64>,
    /// The legs to go, the present one last.
    legs: Vec<Leg>,
    follower: Option<Follower>,
    paused: bool,
    travelled: f64,
    /// Least distance that was left on the present way, and when it last shrank.
    least_left: f64,
    progress_tick: u64,
    /// When it last shrank or the robot last had a reason to stand.
    free_tick: u64,
    /// Who is waited for, and when to look for a way around.
    waiting: Option<(usize, u64)>,
    /// Whether the robot passes people at the smaller gap.
    passing: bool,
    reroutes: u32,
    rerouted_when_stuck: bool,
    /// Who was waited for since the last progress.
    hindered_by: Option<String>,
}

/// A person near the robot.
#[derive(Clone, Copy, Debug)]
struct Near {
    person: usize,
    /// Distance of the middles that the robot never goes below.
    touch: f64,
}

#[derive(Clone, Debug)]
struct Ride {
    elevator: usize,
    to: usize,
    landing: Point,
    ends: u64,
}

/// A building with a robot and people in it, and a clock.
///
/// [`World::step`] is a function of the world and the command alone: no threads, no clock, no
/// randomness, no iteration over hash maps.
#[derive(Clone, Debug)]
pub struct World {
    building: Building,
    reaches: Vec<Reach>,
    settings: Settings,
    step: f64,
    tick: u64,
    robot: Robot,
    people: Vec<Walker>,
    mission: Option<Mission>,
    ride: Option<Ride>,
    hold: Option<JointTargets>,
    /// Bearing of what the robot is about, for the head.
    gaze: f64,
}

impl World {
    /// A world with the robot at a place.
    ///
    /// # Errors
    ///
    /// A [`WorldError`] if a setting is out of range, the robot does not fit at some place or
    /// elevator stop, or there is no place of the name.
    pub fn new(building: Building, settings: Settings, start: &str) -> Result<Self, WorldError> {
        settings.check()?;
        let reaches: Vec<Reach> =
            building.floors().iter().map(|f| Reach::new(&f.map, &settings.model)).collect();
        let stops =
            building.elevators().iter().flat_map(|e| e.stops.iter().map(|s| (&e.name, s.floor, s.position)));
        let places = building.places().map(|(floor, p)| (&p.name, floor, p.position));
        for (name, index, position) in places.chain(stops) {
            if let (Some(floor), Some(reach)) = (building.floors().get(index), reaches.get(index))
                && !reach.is_usable(&floor.map, position)
            {
                let (name, floor) = (name.clone(), floor.name.clone());
                return Err(WorldError::TooTight { name, floor, radius: settings.model.radius });
            }
        }
        let Some((floor, place)) = building.place(start) else {
            let known: Vec<&str> = building.places().map(|(_, p)| p.name.as_str()).collect();
            return Err(WorldError::UnknownPlace { name: start.to_owned(), known: known.join(", ") });
        };
        let pose = Pose { position: place.position, heading: normalize_angle(place.heading.unwrap_or(0.0)) };
        Ok(Self {
            reaches,
            step: settings.step.as_secs_f64(),
            settings,
            tick: 0,
            robot: Robot { floor, pose, twist: Twist::ZERO, joints: Joints::default() },
            people: Vec::new(),
            mission: None,
            ride: None,
            hold: None,
            gaze: 0.0,
            building,
        })
    }

    /// Puts a person into the world.
    ///
    /// # Errors
    ///
    /// A [`WorldError`] if the name is taken, a figure is out of range, there is no such floor,
    /// the person would stand in or walk through a wall, or overlaps the robot.
    pub fn add_person(&mut self, person: Person) -> Result<(), WorldError> {
        let name = || person.name.clone();
        if self.person(&person.name).is_some() {
            return Err(WorldError::DuplicatePerson { name: name() });
        }
        if let Some(what) = person.fault() {
            return Err(WorldError::BadPerson { name: name(), what });
        }
        let floors = self.building.floors().len();
        let Some(floor) = self.building.floors().get(person.floor) else {
            return Err(WorldError::UnknownFloor { floor: person.floor, floors });
        };
        check_walk(&floor.map, &person)?;
        let apart = self.settings.model.radius + person.radius + BODY_GAP;
        if person.floor == self.robot.floor && self.robot.pose.position.distance(person.position) < apart {
            return Err(WorldError::Overlap { name: name() });
        }
        self.people.push(Walker::new(person));
        Ok(())
    }

    /// Sends a person along other waypoints, from where the person is.
    ///
    /// # Errors
    ///
    /// As for [`World::add_person`], and [`WorldError::UnknownPerson`].
    pub fn send_person(&mut self, name: &str, waypoints: Vec<Waypoint>) -> Result<(), WorldError> {
        let Some(walker) = self.people.iter_mut().find(|w| w.person.name == name) else {
            return Err(WorldError::UnknownPerson { name: name.to_owned() });
        };
        let person = Person { waypoints, repeat: false, ..walker.person.clone() };
        if let Some(what) = person.fault() {
            return Err(WorldError::BadPerson { name: name.to_owned(), what });
        }
        if let Some(floor) = self.building.floors().get(person.floor) {
            check_walk(&floor.map, &person)?;
        }
        *walker = Walker::new(person);
        Ok(())
    }

    /// Takes a person out of the world.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownPerson`].
    pub fn remove_person(&mut self, name: &str) -> Result<Person, WorldError> {
        match self.people.iter().position(|w| w.person.name == name) {
            None => Err(WorldError::UnknownPerson { name: name.to_owned() }),
            Some(index) => {
                if let Some(mission) = &mut self.mission {
                    mission.waiting = None;
                }
                Ok(self.people.remove(index).person)
            }
        }
    }

    /// The building.
    #[must_use]
    pub fn building(&self) -> &Building {
        &self.building
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Simulated time since the world began: the number of steps times their length, exactly.
    #[must_use]
    pub fn time(&self) -> Duration {
        let nanos = self.settings.step.as_nanos().saturating_mul(u128::from(self.tick));
        Duration::from_nanos(u64::try_from(nanos).unwrap_or(u64::MAX))
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// All people, in the order in which they came.
    pub fn people(&self) -> impl Iterator<Item = &Person> {
        self.people.iter().map(|w| &w.person)
    }

    /// The person of a name.
    #[must_use]
    pub fn person(&self, name: &str) -> Option<&Person> {
        self.people().find(|p| p.name == name)
    }

    /// What the robot is doing.
    #[must_use]
    pub fn activity(&self) -> Activity {
        if let Some(ride) = &self.ride {
            let elevator = self.building.elevators().get(ride.elevator).map(|e| e.name.clone());
            let seconds = self.seconds(ride.ends.saturating_sub(self.tick));
            return Activity::Riding { elevator: elevator.unwrap_or_default(), to: ride.to, seconds };
        }
        match &self.mission {
            None => Activity::Idle,
            Some(mission) if mission.paused => Activity::Paused,
            Some(mission) => match mission.waiting.and_then(|(i, _)| self.people.get(i)) {
                Some(walker) => Activity::Waiting { person: walker.person.name.clone() },
                None => Activity::Driving,
            },
        }
    }

    /// The way that the robot is following on its floor, from where it is; empty if there is none.
    #[must_use]
    pub fn way_ahead(&self) -> Vec<Point> {
        let follower = self.mission.as_ref().and_then(|m| m.follower.as_ref());
        follower.map_or_else(Vec::new, |f| f.rest(self.robot.pose.position))
    }

    /// How far the robot is with its goal, if it has one.
    #[must_use]
    pub fn progress(&self) -> Option<Progress> {
        let mission = self.mission.as_ref()?;
        let remaining = self.remaining(mission);
        let all = mission.travelled + remaining.distance;
        let fraction = if all > 0.0 { mission.travelled / all } else { 1.0 };
        Some(Progress { place: mission.place.clone(), travelled: mission.travelled, remaining, fraction })
    }

    /// What it would take to go to a place from here, if nobody is in the way.
    ///
    /// # Errors
    ///
    /// A [`RouteError`] if there is no such place, or no way to it.
    pub fn estimate(&self, place: &str) -> Result<Estimate, RouteError> {
        let heading = self.building.place(place).and_then(|(_, p)| p.heading);
        Ok(self.legs_estimate(&self.route(place)?, heading))
    }

    /// The legs of the quickest route to a place from here, people left out of account.
    ///
    /// # Errors
    ///
    /// A [`RouteError`] if there is no such place, or no way to it.
    pub fn route(&self, place: &str) -> Result<Vec<Leg>, RouteError> {
        let start = match &self.ride {
            Some(ride) => (ride.to, ride.landing),
            None => (self.robot.floor, self.robot.pose.position),
        };
        route(&self.building, &self.reaches, &self.settings.model, start, place)
    }

    /// One step: the command is obeyed, people walk, the robot moves, the clock goes on.
    pub fn step(&mut self, command: Command) -> Vec<Event> {
        let mut events = Vec::new();
        self.obey(command, &mut events);
        self.walk_people(&mut events);
        let twist = match self.ride {
            Some(_) => {
                self.go_on_riding(&mut events);
                Twist::ZERO
            }
            None => self.drive(&mut events),
        };
        self.robot.pose = self.robot.pose.moved(twist, self.step);
        self.robot.twist = twist;
        if let Some(mission) = &mut self.mission {
            mission.travelled += twist.linear * self.step;
        }
        let targets = self.hold.unwrap_or_else(|| self.expressive_joints());
        self.robot.joints.step(&self.settings.model, targets, twist, self.step);
        self.tick += 1;
        events
    }

    fn obey(&mut self, command: Command, events: &mut Vec<Event>) {
        match command {
            Command::Continue => {}
            Command::Hold { targets } => self.hold = targets,
            Command::GoTo { place } => {
                events.extend(self.mission.take().map(|m| Event::Dropped { place: m.place }));
                match self.route(&place) {
                    Ok(legs) => self.set_out(place, legs, events),
                    Err(reason) => events.push(Event::Unreachable { place, reason }),
                }
            }
            Command::Cancel => events.extend(self.mission.take().map(|m| Event::Dropped { place: m.place })),
            Command::Stop | Command::Resume => {
                let stop = command == Command::Stop;
                if let Some(mission) = self.mission.as_mut().filter(|m| m.paused != stop) {
                    mission.paused = stop;
                    mission.waiting = None;
                    let place = mission.place.clone();
                    events.push(if stop { Event::Paused { place } } else { Event::Resumed { place } });
                }
            }
        }
    }

    fn set_out(&mut self, place: String, mut legs: Vec<Leg>, events: &mut Vec<Event>) {
        let heading = self.building.place(&place).and_then(|(_, p)| p.heading);
        let estimate = self.legs_estimate(&legs, heading);
        events.push(Event::SetOut { place: place.clone(), estimate });
        legs.reverse();
        self.mission = Some(Mission {
            heading,
            place,
            legs,
            follower: None,
            paused: false,
            travelled: 0.0,
            least_left: f64::INFINITY,
            progress_tick: self.tick,
            free_tick: self.tick,
            waiting: None,
            passing: false,
            reroutes: 0,
            rerouted_when_stuck: false,
            hindered_by: None,
        });
    }

    fn walk_people(&mut self, events: &mut Vec<Event>) {
        let (model, twist) = (&self.settings.model, self.robot.twist);
        let seconds = reach_seconds(model, twist, self.step) - self.step;
        let (swept, strays) = chords(self.robot.pose, twist, seconds);
        let guard = Guard { swept: swept.collect(), radius: model.radius + STEP_GAP + strays };
        for walker in &mut self.people {
            let near = (walker.person.floor == self.robot.floor).then_some(&guard);
            if walker.step(self.step, near) {
                events.push(Event::PersonDone { person: walker.person.name.clone() });
            }
        }
    }

    fn go_on_riding(&mut self, events: &mut Vec<Event>) {
        let Some(ride) = self.ride.clone() else { return };
        if self.tick < ride.ends {
            return;
        }
        let apart = self.settings.model.radius + STEP_GAP;
        let in_the_way = self
            .people()
            .find(|p| p.floor == ride.to && p.position.distance(ride.landing) < apart + p.radius);
        if let Some(person) = in_the_way {
            let person = person.name.clone();
            // The doors stay closed for a while, and then the robot stays where it was.
            if self.seconds(self.tick - ride.ends) >= self.settings.give_up_after {
                self.ride = None;
                events.extend(
                    self.mission.take().map(|m| Event::Blocked { place: m.place, person: Some(person) }),
                );
            }
            return;
        }
        self.ride = None;
        self.robot.floor = ride.to;
        self.robot.pose.position = ride.landing;
        events.push(Event::FloorChanged { floor: ride.to });
    }

    /// The next twist, which leaves the robot able to stop without touching anything.
    fn drive(&mut self, events: &mut Vec<Event>) -> Twist {
        let now = self.robot.twist;
        let brake = braked(&self.settings.model, now, self.step);
        let Some(mut mission) = self.mission.take() else {
            self.gaze = 0.0;
            return brake;
        };
        let (twist, finished) = self.pursue(&mut mission, events);
        if !finished {
            self.mission = Some(mission);
        }
        twist
    }

    /// Gives the next twist, and whether the mission is over.
    fn pursue(&mut self, mission: &mut Mission, events: &mut Vec<Event>) -> (Twist, bool) {
        let model = self.settings.model;
        let now = self.robot.twist;
        let brake = braked(&model, now, self.step);
        if mission.paused {
            (mission.progress_tick, mission.free_tick) = (self.tick, self.tick);
            return (brake, false);
        }
        let follower = match (&mut mission.follower, mission.legs.last()) {
            (Some(_), _) => None,
            (None, Some(Leg::Drive { way, .. })) => Some(Follower::new(way.clone())),
            (None, Some(&Leg::Ride { elevator, from, to })) => {
                self.begin_ride(elevator, from, to, events);
                mission.legs.pop();
                (mission.progress_tick, mission.free_tick) = (self.tick, self.tick);
                mission.least_left = f64::INFINITY;
                return (Twist::ZERO, false);
            }
            (None, None) => {
                events.push(Event::Arrived { place: mission.place.clone() });
                return (Twist::ZERO, true);
            }
        };
        if let Some(follower) = follower {
            mission.follower = Some(follower);
        }
        if self.gives_up(mission, events) {
            return (brake, true);
        }
        let (people, discs) = self.discs(mission);
        let clearance = self.clearance();
        let map = match self.building.floors().get(self.robot.floor) {
            Some(floor) => &floor.map,
            None => return (brake, false),
        };
        let Some(follower) = &mut mission.follower else { return (brake, false) };
        let wish = follower.wish(&model, self.step, (self.robot.pose, now), map, clearance, &discs);
        let (twist, in_the_way) = match wish {
            Wish::Go { twist, aside } => {
                self.gaze = aside;
                self.permitted((twist, aside), clearance, &discs, &people)
            }
            Wish::Brake { aside } => {
                self.gaze = aside;
                (brake, None)
            }
            Wish::Obstructed(disc) => (brake, people.get(disc).map(|n| n.person)),
            Wish::Lost => (brake, None),
            Wish::Arrived => {
                let last = mission.legs.len() == 1;
                match self.settle(mission.heading.filter(|_| last)) {
                    Some(twist) => (twist, None),
                    None => {
                        mission.legs.pop();
                        mission.follower = None;
                        let done = mission.legs.is_empty();
                        if done {
                            events.push(Event::Arrived { place: mission.place.clone() });
                        }
                        return (Twist::ZERO, done);
                    }
                }
            }
        };
        self.mind_people(mission, in_the_way, twist, events);
        (twist, false)
    }

    fn begin_ride(&mut self, elevator: usize, from: usize, to: usize, events: &mut Vec<Event>) {
        let Some(lift) = self.building.elevators().get(elevator) else { return };
        let Some(stop) = lift.stops.iter().find(|s| s.floor == to) else { return };
        let mut ends = self.tick;
        while self.seconds(ends - self.tick) < lift.ride_seconds {
            ends += 1;
        }
        events.push(Event::RideBegun { elevator: lift.name.clone(), from, to });
        self.ride = Some(Ride { elevator, to, landing: stop.position, ends });
    }

    /// The twist that stops the robot and turns it to a heading; none once that is done.
    fn settle(&self, heading: Option<f64>) -> Option<Twist> {
        let (model, now) = (&self.settings.model, self.robot.twist);
        if now.linear > 0.0 {
            return Some(braked(model, now, self.step));
        }
        let off = heading.map_or(0.0, |h| normalize_angle(h - self.robot.pose.heading));
        if off.abs() < 0.03 {
            return (now != Twist::ZERO).then(|| braked(model, now, self.step));
        }
        let speed = stopping_speed(off.abs(), model.turn_acceleration, self.step).min(model.max_turn);
        Some(limited(model, now, Twist { linear: 0.0, angular: speed.copysign(off) }, self.step))
    }

    /// The clearance beyond walls that the robot insists on here: what it keeps, or has, if less.
    fn clearance(&self) -> f64 {
        let radius = self.settings.model.radius;
        let wanted = radius + WALL_CLEARANCE;
        let Some((map, reach)) = self.here() else { return wanted };
        if reach.clear_at_least(map, self.robot.pose.position) > wanted {
            return wanted;
        }
        let has = map.clearance(self.robot.pose.position, 2.0 * wanted) - LEAST_CLEARANCE;
        has.clamp(radius + LEAST_CLEARANCE, wanted)
    }

    fn here(&self) -> Option<(&OccupancyGrid, &Reach)> {
        let floor = self.building.floors().get(self.robot.floor)?;
        Some((&floor.map, self.reaches.get(self.robot.floor)?))
    }

    /// People near the robot, and the discs that it keeps off.
    fn discs(&self, mission: &mut Mission) -> (Vec<Near>, Vec<Disc>) {
        let here = self.robot.pose.position;
        let near = |w: &Walker, within: f64| {
            w.person.floor == self.robot.floor && here.distance(w.person.position) < within
        };
        if mission.passing && !self.people.iter().any(|w| near(w, 2.0)) {
            mission.passing = false;
        }
        let gap = if mission.passing { self.settings.passing_gap } else { self.settings.personal_gap };
        let apart = self.settings.model.radius + gap;
        let near = self.people.iter().enumerate().filter(|(_, w)| near(w, 6.0));
        near.map(|(person, w)| {
            let touch = self.settings.model.radius + w.person.radius + BODY_GAP;
            let disc = Disc { center: w.person.position, keep: apart + w.person.radius };
            (Near { person, touch }, disc)
        })
        .unzip()
    }

    /// Of the wish and slower versions of it the first after which the robot can still stop
    /// without touching anything. That holds for braking, because it held a step ago, and for
    /// turning on the spot. Also tells the person who stood against the wish.
    fn permitted(
        &self,
        (wish, aside): (Twist, f64),
        clearance: f64,
        discs: &[Disc],
        people: &[Near],
    ) -> (Twist, Option<usize>) {
        let (model, now) = (&self.settings.model, self.robot.twist);
        let mut in_the_way = None;
        for share in [1.0, 0.8, 0.6, 0.4, 0.2, 0.1, 0.0] {
            let slower = Twist { linear: wish.linear * share, angular: wish.angular * share };
            let twist = limited(model, now, slower, self.step);
            match self.obstacle(twist, clearance, discs, people) {
                // Standing is always free, but gets nobody anywhere.
                Ok(()) if twist.linear <= 0.0 && wish.linear > 0.0 => {}
                Ok(()) => return (twist, in_the_way),
                Err(disc) => in_the_way = in_the_way.or(disc.and_then(|d| people.get(d).map(|n| n.person))),
            }
        }
        if now.linear > 0.0 {
            return (braked(model, now, self.step), in_the_way);
        }
        // The line ahead is free, only the arc towards it is not: turn until it needs no arc.
        let speed = stopping_speed(aside.abs(), model.turn_acceleration, self.step).min(model.max_turn);
        let turn = Twist { linear: 0.0, angular: speed.copysign(aside) };
        (limited(model, now, turn, self.step), in_the_way)
    }

    /// Whether a step with this twist, and braking after it, is free; if not, the disc in the
    /// way, or none for a wall.
    fn obstacle(
        &self,
        twist: Twist,
        clearance: f64,
        discs: &[Disc],
        people: &[Near],
    ) -> Result<(), Option<usize>> {
        let Some((map, reach)) = self.here() else { return Err(None) };
        let here = self.robot.pose.position;
        let seconds = reach_seconds(&self.settings.model, twist, self.step);
        let (segments, strays) = chords(self.robot.pose, twist, seconds);
        let far_off = reach.clear_at_least(map, here) > twist.linear * seconds + clearance;
        for segment in segments {
            if !far_off && !map.capsule_is_free(segment, clearance + strays) {
                return Err(None);
            }
            let too_near = |(disc, near): (&Disc, &Near)| {
                let off = segment.distance_squared(disc.center).sqrt();
                off < disc.keep.min(here.distance(disc.center) - 1e-6) || off < near.touch + strays
            };
            if let Some(index) = discs.iter().zip(people).position(too_near) {
                return Err(Some(index));
            }
        }
        Ok(())
    }

    /// Starts or ends waiting, and looks for a way around whoever is waited for.
    fn mind_people(
        &self,
        mission: &mut Mission,
        in_the_way: Option<usize>,
        twist: Twist,
        events: &mut Vec<Event>,
    ) {
        match (mission.waiting, in_the_way) {
            (None, Some(person)) if twist.linear <= 0.0 => {
                let name = self.people.get(person).map(|w| w.person.name.clone()).unwrap_or_default();
                mission.waiting = Some((person, self.tick));
                events.push(Event::Waiting { person: name });
            }
            (Some(_), None) if twist.linear > 0.0 => {
                mission.waiting = None;
                events.push(Event::MovingOn);
            }
            (Some((person, since)), _) if self.seconds(self.tick - since) >= self.settings.patience => {
                // Whether there is a way or not, do not look again before as long a time.
                mission.waiting = Some((person, self.tick));
                if self.reroute(mission, true) {
                    mission.passing = true;
                    events.push(Event::Rerouted);
                }
            }
            _ => {}
        }
    }

    /// Another way to the end of the present leg; with `around`, one around everybody near.
    fn reroute(&self, mission: &mut Mission, around: bool) -> bool {
        let Some((map, reach)) = self.here() else { return false };
        let Some(&end) = mission.follower.as_ref().and_then(|f| f.way().last()) else { return false };
        let here = self.robot.pose.position;
        let gap = self.settings.model.radius + 2.0 * self.settings.passing_gap;
        let discs: Vec<Disc> = self
            .people()
            .filter(|p| around && p.floor == self.robot.floor && here.distance(p.position) < 6.0)
            .map(|p| Disc { center: p.position, keep: gap + p.radius })
            .collect();
        let way = reach.way(map, here, end, &discs);
        let found = way.is_some();
        if let Some(way) = way {
            mission.follower = Some(Follower::new(way));
            // The new way may be longer; progress is measured along it.
            mission.least_left = self.distance_left(mission);
            mission.reroutes += 1;
        }
        found
    }

    /// Watches that the robot gets on; gives true if the goal is given up.
    fn gives_up(&self, mission: &mut Mission, events: &mut Vec<Event>) -> bool {
        let left = self.distance_left(mission);
        if left < mission.least_left - 0.1 {
            mission.least_left = left;
            (mission.progress_tick, mission.free_tick) = (self.tick, self.tick);
            mission.rerouted_when_stuck = false;
            mission.hindered_by = None;
        }
        if let Some((index, _)) = mission.waiting {
            mission.free_tick = self.tick;
            mission.hindered_by = self.people.get(index).map(|w| w.person.name.clone());
        }
        let idle = self.seconds(self.tick - mission.progress_tick);
        let stuck = self.seconds(self.tick - mission.free_tick);
        let worn_out = mission.reroutes >= MAX_REROUTES && mission.waiting.is_some();
        if idle >= self.settings.give_up_after || stuck >= self.settings.stuck_after || worn_out {
            let person = mission.hindered_by.take();
            events.push(Event::Blocked { place: mission.place.clone(), person });
            return true;
        }
        if stuck >= self.settings.stuck_after / 2.0 && !mission.rerouted_when_stuck {
            mission.rerouted_when_stuck = true;
            if self.reroute(mission, true) || self.reroute(mission, false) {
                events.push(Event::Rerouted);
            }
        }
        false
    }

    fn distance_left(&self, mission: &Mission) -> f64 {
        let (now, later) = match &mission.follower {
            Some(f) => (f.left(self.robot.pose.position), mission.legs.len().saturating_sub(1)),
            None => (0.0, mission.legs.len()),
        };
        let later = mission.legs.iter().take(later).map(|leg| match leg {
            Leg::Drive { way, .. } => drive_estimate(&self.settings.model, way).distance,
            Leg::Ride { .. } => 0.0,
        });
        now + later.sum::<f64>()
    }

    fn remaining(&self, mission: &Mission) -> Estimate {
        // Of the present leg what is left of it, of the others all.
        let mut legs: Vec<Leg> = Vec::with_capacity(mission.legs.len());
        let mut ahead = mission.legs.iter().rev();
        if let Some(follower) = &mission.follower {
            ahead.next();
            let way = follower.rest(self.robot.pose.position);
            legs.push(Leg::Drive { floor: self.robot.floor, way });
        }
        legs.extend(ahead.cloned());
        let mut all = self.legs_estimate(&legs, mission.heading);
        if let Some(ride) = &self.ride {
            all.seconds += self.seconds(ride.ends.saturating_sub(self.tick));
        }
        all
    }

    /// What legs take from where the robot stands, with the turns on the spot at the beginning of
    /// each and, if a heading is wanted, at the end.
    fn legs_estimate(&self, legs: &[Leg], heading: Option<f64>) -> Estimate {
        let model = &self.settings.model;
        let mut all = Estimate::default();
        let mut faces = self.robot.pose.heading;
        let mut turn_to = |direction: f64, least: f64| {
            let turn = normalize_angle(direction - faces).abs();
            faces = direction;
            if turn > least { turn_seconds(model, turn) } else { 0.0 }
        };
        for leg in legs {
            match leg {
                Leg::Drive { way, .. } => {
                    let part = drive_estimate(model, way);
                    all.distance += part.distance;
                    all.seconds += part.seconds;
                    if let [first, second, ..] = way[..] {
                        all.seconds += turn_to(first.direction_to(second), TOO_FAR_ASIDE);
                    }
                    if let [.., last_but_one, last] = way[..] {
                        turn_to(last_but_one.direction_to(last), 0.0);
                    }
                }
                Leg::Ride { elevator, .. } => {
                    all.seconds += self.building.elevators().get(*elevator).map_or(0.0, |e| e.ride_seconds);
                }
            }
        }
        all.seconds += heading.map_or(0.0, |h| turn_to(h, 0.0));
        all
    }

    /// Torso down and eyes ahead while driving, a look at whoever is waited for, torso up when
    /// there is time for people.
    fn expressive_joints(&self) -> JointTargets {
        let waiting = self.mission.as_ref().and_then(|m| m.waiting).and_then(|(i, _)| self.people.get(i));
        match (waiting, self.activity()) {
            (Some(walker), _) => {
                let bearing = self.robot.pose.position.direction_to(walker.person.position);
                let head_pan = normalize_angle(bearing - self.robot.pose.heading);
                JointTargets { torso: 0.05, head_pan, head_tilt: 0.1 }
            }
            (None, Activity::Driving) => JointTargets { torso: 0.0, head_pan: self.gaze, head_tilt: -0.25 },
            (None, Activity::Idle | Activity::Paused) => {
                JointTargets { torso: 0.15, head_pan: 0.0, head_tilt: 0.0 }
            }
            (None, _) => JointTargets::default(),
        }
    }

    fn seconds(&self, ticks: u64) -> f64 {
        // More steps than 2^52 are some millions of years.
        #[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
        let ticks = ticks as f64;
        ticks * self.step
    }
}

fn check_walk(map: &OccupancyGrid, person: &Person) -> Result<(), WorldError> {
    let mut from = person.position;
    let first = person.waypoints.first().filter(|_| person.repeat);
    for to in core::iter::once(person.position)
        .chain(person.waypoints.iter().map(|w| w.position))
        .chain(first.map(|w| w.position))
    {
        if !map.capsule_is_free(Segment { from, to }, person.radius) {
            return Err(WorldError::PersonInWall { name: person.name.clone(), at: to });
        }
        from = to;
    }
    Ok(())
}
