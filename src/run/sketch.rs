//! Draws a run: where the robot went, and what happened where.

use std::io;
use std::time::Duration;

use selfneg_sim::{Picture, Point, World, svg};

use super::storybook::clock;
use super::watcher::Watcher;
use crate::mission::{Event, Output, Record};

/// Watches a run and draws it: the robot's way, everybody as they were at the first
/// interruption, and numbered moments. It names users: personal.
#[derive(Clone, Debug, Default)]
pub struct Sketch {
    /// Where the robot has been.
    trail: Vec<(usize, Point)>,
    /// Numbered from 1.
    moments: Vec<Moment>,
    /// The world when the robot was first interrupted, or as it is.
    world: Option<World>,
    interrupted: bool,
    serving: bool,
    /// What the next sentence tells is a moment.
    expecting: bool,
}

#[derive(Clone, Debug)]
struct Moment {
    floor: usize,
    at: Point,
    time: Duration,
    sentence: String,
}

impl Sketch {
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
    fn event(&mut self, _: Duration, event: &Event) -> io::Result<()> {
        if let Event::Request { .. } | Event::Emergency { .. } = event {
            self.expecting = true;
            self.interrupted |= self.serving;
        }
        Ok(())
    }

    fn output(&mut self, _: Duration, output: &Output) -> io::Result<()> {
        if let Output::Record(record) = output {
            self.serving |= matches!(record, Record::GoalStarted { .. });
            self.expecting |= matches!(record, Record::Decided { .. } | Record::GoalEnded { .. });
        }
        Ok(())
    }

    fn world(&mut self, _: Duration, world: &World) -> io::Result<()> {
        let robot = world.robot();
        self.trail.push((robot.floor, robot.pose.position));
        if self.world.is_none() || !self.interrupted {
            self.world = Some(world.clone());
        }
        Ok(())
    }

    fn sentence(&mut self, at: Duration, sentence: &str) -> io::Result<()> {
        if std::mem::take(&mut self.expecting)
            && let Some((floor, here)) = self.trail.last().copied()
        {
            self.moments.push(Moment { floor, at: here, time: at, sentence: sentence.to_owned() });
        }
        Ok(())
    }
}
