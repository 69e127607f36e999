//! Follows a way: where along it the robot is, and which twist it would like next.
//!
//! The follower steers towards a point of the way ahead that it can reach in a straight line. If
//! that point is far off to the side it stops and turns first. So, whatever happens, there is
//! always the slow way on: stop, turn, go straight.

use crate::drive::{Twist, stopping_speed};
use crate::geometry::{Point, Pose, Segment, normalize_angle};
use crate::map::OccupancyGrid;
use crate::reach::{Disc, off_discs};
use crate::tiago::RobotModel;

/// How near to the end of its way the robot has arrived, in metres.
pub(crate) const TOLERANCE: f64 = 0.08;

/// Off by more than this the robot stops and turns on the spot, until it is off by less than
/// [`AIMED`], in radians.
pub(crate) const TOO_FAR_ASIDE: f64 = 0.8;
const AIMED: f64 = 0.1;

#[derive(Clone, Debug)]
pub(crate) struct Follower {
    way: Vec<Point>,
    /// Distance along the way to each of its points.
    along: Vec<f64>,
    /// Distance along the way to the point that the robot is at.
    at: f64,
    turning: bool,
}

/// What the follower would like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Wish {
    Go {
        twist: Twist,
        aside: f64,
    },
    /// Stop; the bearing of what the robot turns to next.
    Brake {
        aside: f64,
    },
    Arrived,
    /// The disc of this index is in the way.
    Obstructed(usize),
    /// No point of the way can be reached in a straight line.
    Lost,
}

impl Follower {
    pub(crate) fn new(way: Vec<Point>) -> Self {
        let mut along = Vec::with_capacity(way.len());
        let mut length = 0.0;
        let mut last: Option<Point> = None;
        for &p in &way {
            length += last.map_or(0.0, |l| l.distance(p));
            along.push(length);
            last = Some(p);
        }
        Self { way, along, at: 0.0, turning: false }
    }

    pub(crate) fn way(&self) -> &[Point] {
        &self.way
    }

    fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// What is left of the way from `here`.
    pub(crate) fn rest(&self, here: Point) -> Vec<Point> {
        let ahead = self.way.iter().zip(&self.along).filter(|(_, s)| **s > self.at).map(|(p, _)| *p);
        core::iter::once(here).chain(ahead).collect()
    }

    /// Length of what is left of the way from `here`.
    pub(crate) fn left(&self, here: Point) -> f64 {
        let mut left = 0.0;
        let mut last = here;
        for (&p, _) in self.way.iter().zip(&self.along).filter(|(_, s)| **s > self.at) {
            left += last.distance(p);
            last = p;
        }
        left
    }

    fn segments(&self) -> impl Iterator<Item = (Segment, f64, f64)> {
        let points = self.way.iter().zip(self.way.iter().skip(1));
        let lengths = self.along.iter().zip(self.along.iter().skip(1));
        points.zip(lengths).map(|((&from, &to), (&a, &b))| (Segment { from, to }, a, b))
    }

    fn point_at(&self, s: f64) -> Option<Point> {
        let within = self.segments().find(|&(_, a, b)| s >= a && s < b);
        match within {
            Some((segment, a, b)) => Some(segment.from.towards(segment.to, (s - a) / (b - a))),
            None => self.way.last().copied(),
        }
    }

    /// Moves the point that the robot is at forward to the nearest one within a short window.
    fn advance(&mut self, here: Point) {
        let window = (self.at, self.at + 1.5);
        let nearest = self
            .segments()
            .filter(|&(_, a, b)| b >= window.0 && a <= window.1 && b > a)
            .map(|(segment, a, b)| {
                let s = (a + segment.nearest_fraction(here) * (b - a)).clamp(window.0, window.1);
                let p = segment.from.towards(segment.to, ((s - a) / (b - a)).clamp(0.0, 1.0));
                (p.distance_squared(here), s)
            })
            .min_by(|x, y| x.0.total_cmp(&y.0));
        if let Some((_, s)) = nearest {
            self.at = s;
        }
    }

    /// The twist that the robot would like, given where it is and what is around it. `clearance`
    /// is what straight lines ahead must keep from walls.
    pub(crate) fn wish(
        &mut self,
        model: &RobotModel,
        step: f64,
        (pose, now): (Pose, Twist),
        map: &OccupancyGrid,
        clearance: f64,
        discs: &[Disc],
    ) -> Wish {
        let here = pose.position;
        self.advance(here);
        let left = self.length() - self.at;
        let Some(&end) = self.way.last() else { return Wish::Arrived };
        let to_end = here.distance(end);
        if left <= 4.0 * TOLERANCE && to_end <= TOLERANCE {
            return Wish::Arrived;
        }
        let aim = match self.aim(here, now, map, clearance, discs) {
            Ok(aim) => aim,
            Err(wish) => return wish,
        };
        let aside = normalize_angle(here.direction_to(aim) - pose.heading);
        self.turning = aside.abs() > if self.turning { AIMED } else { TOO_FAR_ASIDE };
        if self.turning {
            if now.linear > 0.0 {
                return Wish::Brake { aside };
            }
            let speed = stopping_speed(aside.abs(), model.turn_acceleration, step).min(model.max_turn);
            return Wish::Go { twist: Twist { linear: 0.0, angular: speed.copysign(aside) }, aside };
        }
        let bend = 2.0 * crate::geometry::sin_cos(aside).0 / here.distance(aim);
        let mut linear = model.cruise_speed * (1.0 - aside.abs() / 0.9).max(0.2);
        linear = linear.min(stopping_speed(left.max(to_end) - TOLERANCE / 2.0, model.acceleration, step));
        linear = linear.min(self.corner_speed(model, step));
        if bend.abs() * linear > model.max_turn {
            linear = model.max_turn / bend.abs();
        }
        Wish::Go { twist: Twist { linear, angular: bend * linear }, aside }
    }

    /// The farthest point of the way, up to a distance that grows with the speed, to which the
    /// robot can go straight.
    fn aim(
        &self,
        here: Point,
        now: Twist,
        map: &OccupancyGrid,
        clearance: f64,
        discs: &[Disc],
    ) -> Result<Point, Wish> {
        let ahead = (0.3 + 0.8 * now.linear).min(1.0);
        let mut obstructed = None;
        for share in [1.0, 0.8, 0.6, 0.45, 0.3, 0.2, 0.1, 0.0] {
            let Some(p) = self.point_at(self.at + share * ahead) else { continue };
            let segment = Segment { from: here, to: p };
            if here.distance(p) < 1e-3 || !map.capsule_is_free(segment, clearance) {
                continue;
            }
            match discs.iter().position(|d| !off_discs(segment, &[*d])) {
                None => return Ok(p),
                Some(disc) => obstructed = obstructed.or(Some(disc)),
            }
        }
        Err(obstructed.map_or(Wish::Lost, Wish::Obstructed))
    }

    /// The speed that leaves room to slow down for the corners ahead.
    fn corner_speed(&self, model: &RobotModel, step: f64) -> f64 {
        let corners = self.way.iter().zip(self.way.iter().skip(1)).zip(self.way.iter().skip(2));
        let mut speed = model.cruise_speed;
        for (((a, b), c), &s) in corners.zip(self.along.iter().skip(1)) {
            if s < self.at || s > self.at + 2.0 {
                continue;
            }
            let turn = normalize_angle(b.direction_to(*c) - a.direction_to(*b)).abs();
            let through = model.cruise_speed * (1.0 - turn / 1.6).max(0.25);
            let braking = stopping_speed(s - self.at, model.acceleration, step);
            speed = speed.min((through * through + braking * braking).sqrt());
        }
        speed
    }
}
