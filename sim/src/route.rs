//! Routes through a building: ways on floors, and rides between them.

use pathfinding::prelude::dijkstra;

use crate::building::Building;
use crate::error::RouteError;
use crate::geometry::{Point, normalize_angle};
use crate::map::floor_to_i64;
use crate::reach::Reach;
use crate::tiago::RobotModel;

/// A part of a route.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
pub enum Leg {
    /// Driving on one floor.
    Drive {
        /// Index of the floor.
        floor: usize,
        /// Points joined by straight lines, in metres; at least one.
        way: Vec<Point>,
    },
    /// Riding an elevator.
    Ride {
        /// Index of the elevator.
        elevator: usize,
        /// Index of the floor where the ride begins.
        from: usize,
        /// Index of the floor where it ends.
        to: usize,
    },
}

/// Distance and time, as estimated beforehand or still to go.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// Metres to drive.
    pub distance: f64,
    /// Seconds for driving, turning and riding, if nobody is in the way. An estimate: see the
    /// crate's page for how good it is.
    pub seconds: f64,
}

/// Where a route may change from one leg to the next.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
enum Knot {
    Start,
    Stop { elevator: usize, stop: usize },
    Goal,
}

/// The quickest route, by the estimate of its time; equally quick ones are told apart by the order
/// of elevators and stops in the building.
pub(crate) fn route(
    building: &Building,
    reaches: &[Reach],
    model: &RobotModel,
    start: (usize, Point),
    place: &str,
) -> Result<Vec<Leg>, RouteError> {
    let Some((goal_floor, goal)) = building.place(place) else {
        return Err(RouteError::UnknownPlace { place: place.to_owned() });
    };
    let goal = (goal_floor, goal.position);
    let spot = |knot: &Knot| match *knot {
        Knot::Start => Some(start),
        Knot::Goal => Some(goal),
        Knot::Stop { elevator, stop } => {
            let stop = building.elevators().get(elevator)?.stops.get(stop)?;
            Some((stop.floor, stop.position))
        }
    };
    let way = |a: &Knot, b: &Knot| {
        let ((floor, from), (other, to)) = (spot(a)?, spot(b)?);
        if floor != other {
            return None;
        }
        let map = &building.floors().get(floor)?.map;
        reaches.get(floor)?.way(map, from, to, &[])
    };
    let stops: Vec<Knot> = building
        .elevators()
        .iter()
        .enumerate()
        .flat_map(|(elevator, e)| (0..e.stops.len()).map(move |stop| Knot::Stop { elevator, stop }))
        .collect();
    let next = |knot: &Knot| {
        let mut next: Vec<(Knot, i64)> = Vec::new();
        for other in stops.iter().chain([&Knot::Goal]) {
            if let Some(way) = way(knot, other) {
                next.push((*other, milliseconds(drive_estimate(model, &way).seconds)));
            }
            if let (Knot::Stop { elevator, .. }, Knot::Stop { elevator: same, .. }) = (knot, other)
                && elevator == same
                && knot != other
                && let Some(elevator) = building.elevators().get(*elevator)
            {
                next.push((*other, milliseconds(elevator.ride_seconds)));
            }
        }
        next
    };
    // On one floor there is no need to look at elevators, unless there is no way without.
    let knots = match way(&Knot::Start, &Knot::Goal) {
        Some(_) => vec![Knot::Start, Knot::Goal],
        None => {
            dijkstra(&Knot::Start, next, |k| *k == Knot::Goal)
                .ok_or_else(|| RouteError::NoWay { place: place.to_owned() })?
                .0
        }
    };
    let mut legs = Vec::new();
    for (a, b) in knots.iter().zip(knots.iter().skip(1)) {
        match (a, b, way(a, b)) {
            (_, _, Some(way)) => {
                let floor = spot(a).map_or(0, |s| s.0);
                legs.push(Leg::Drive { floor, way });
            }
            (&Knot::Stop { elevator, .. }, _, None) => {
                let floor = |knot| spot(knot).map_or(0, |s: (usize, Point)| s.0);
                legs.push(Leg::Ride { elevator, from: floor(a), to: floor(b) });
            }
            _ => return Err(RouteError::NoWay { place: place.to_owned() }),
        }
    }
    Ok(legs)
}

fn milliseconds(seconds: f64) -> i64 {
    floor_to_i64(seconds * 1000.0).max(0)
}

/// Length of a way, and the time it takes: cruising, speeding up and slowing down once, and half
/// of each turn (the rest of it happens while driving).
pub(crate) fn drive_estimate(model: &RobotModel, way: &[Point]) -> Estimate {
    let distance: f64 = way.iter().zip(way.iter().skip(1)).map(|(a, b)| a.distance(*b)).sum();
    let turning: f64 = way
        .iter()
        .zip(way.iter().skip(1))
        .zip(way.iter().skip(2))
        .map(|((a, b), c)| normalize_angle(b.direction_to(*c) - a.direction_to(*b)).abs())
        .sum();
    let cruise = distance / model.cruise_speed;
    let start_and_stop =
        (model.cruise_speed / model.acceleration).min((distance / model.acceleration).sqrt());
    let seconds = if distance > 0.0 { cruise + start_and_stop + turning / model.max_turn / 2.0 } else { 0.0 };
    Estimate { distance, seconds }
}

/// How long it takes to turn on the spot, from standing to standing.
pub(crate) fn turn_seconds(model: &RobotModel, turn: f64) -> f64 {
    let (speed, rate) = (model.max_turn, model.turn_acceleration);
    if turn < speed * speed / rate { 2.0 * (turn / rate).sqrt() } else { turn / speed + speed / rate }
}
