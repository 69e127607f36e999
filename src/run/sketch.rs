//! Draws a run: where the robot went, and what happened where.

use std::io;
use std::time::Duration;

use selfneg_sim::{Picture, Point, World, svg};

use super::storybook::clock;
use super::watcher::{Setup, Watcher};
use crate::mission::{Event, Output, Record, UserId};

/// Watches a run and draws it: the robot's way, everybody as they were at the first
/// interruption, and numbered moments. It names users: personal.
#[derive(Clone, Debug, Default)]
pub struct Sketch {
    /// Where the robot has been.
    trail: Vec<(usize, Point)>,
    /// Numbered from 1.
    moments: Vec<Moment>,
    /// The world when the robot was first interrupted, or at first if it was not.
    world: Option<World>,
    interrupted: bool,
    /// `world` is that of the first interruption.
    settled: bool,
    serving: bool,
    /// What the next sentence tells is a moment; it happens there.
    expecting: Option<(usize, Point)>,
    /// Where the robot was last seen: floor and position.
    robot: Option<(usize, Point)>,
    /// Everybody else as last seen.
    seen: Vec<(String, usize, Point)>,
    /// Pseudonyms and people.
    people: Vec<(UserId, String)>,
    /// Floor and position of each meeting place.
    places: Vec<Option<(usize, Point)>>,
}

#[derive(Clone, Debug)]
struct Moment {
    floor: usize,
    at: Point,
    time: Duration,
    sentence: String,
}

impl Sketch {
    /// Where a user was last seen.
    fn person(&self, user: UserId) -> Option<(usize, Point)> {
        let (_, name) = self.people.iter().find(|(pseudonym, _)| *pseudonym == user)?;
        self.seen.iter().find(|(seen, ..)| seen == name).map(|(_, floor, at)| (*floor, *at))
    }

    /// All floors where the robot has been, as an SVG document; empty before the run began.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let Some(world) = &self.world else { return String::new() };
        let mut pictures = Vec::new();
        for floor in 0..world.building().floors().len() {
            let trail: Vec<Point> =
                self.trail.iter().filter(|(on, _)| *on == floor).map(|(_, at)| *at).collect();
            if trail.is_empty() {
                continue;
            }
            let mut picture = Picture::of(world, floor).trail(&trail);
            for (nth, moment) in self.moments.iter().enumerate().filter(|(_, moment)| moment.floor == floor) {
                let number = nth.saturating_add(1);
                let caption = format!("{} {}", clock(moment.time), moment.sentence);
                picture = picture.mark(moment.at, &number.to_string(), &caption);
            }
            pictures.push(picture);
        }
        svg(&pictures)
    }
}

impl Watcher for Sketch {
    fn begin(&mut self, setup: &Setup<'_>) -> io::Result<()> {
        let known = setup.participants.iter();
        self.people = known.map(|known| (known.pseudonym, known.person.clone())).collect();
        let place = |name: &String| setup.building.place(name).map(|(floor, place)| (floor, place.position));
        self.places = setup.places.iter().map(place).collect();
        Ok(())
    }

    fn event(&mut self, _: Duration, event: &Event) -> io::Result<()> {
        self.expecting = match event {
            Event::Request { user, .. } => {
                self.interrupted |= self.serving;
                self.person(*user).or(self.robot)
            }
            Event::Emergency { place, .. } => {
                let at = usize::try_from(place.0).ok();
                at.and_then(|at| self.places.get(at)).copied().flatten()
            }
            _ => return Ok(()),
        };
        Ok(())
    }

    fn output(&mut self, _: Duration, output: &Output) -> io::Result<()> {
        match output {
            Output::Record(Record::GoalStarted { .. }) => self.serving = true,
            Output::Record(Record::EmergencyDecided { .. }) => self.interrupted |= self.serving,
            Output::Record(Record::Decided { .. } | Record::GoalEnded { .. }) => self.expecting = self.robot,
            _ => {}
        }
        Ok(())
    }

    fn world(&mut self, _: Duration, world: &World) -> io::Result<()> {
        let robot = world.robot();
        self.robot = Some((robot.floor, robot.pose.position));
        self.trail.extend(self.robot);
        self.seen =
            world.people().map(|person| (person.name.clone(), person.floor, person.position)).collect();
        let first_interruption = self.interrupted && !std::mem::replace(&mut self.settled, self.interrupted);
        if self.world.is_none() || first_interruption {
            self.world = Some(world.clone());
        }
        Ok(())
    }

    fn sentence(&mut self, at: Duration, sentence: &str) -> io::Result<()> {
        if let Some((floor, place)) = self.expecting.take() {
            self.moments.push(Moment { floor, at: place, time: at, sentence: sentence.to_owned() });
        }
        Ok(())
    }
}
